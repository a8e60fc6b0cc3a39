/* table.h - the list of kernels that each instruction set must define; kernel.h says what
 * they do. */
#ifndef ENG_TABLE_H
#define ENG_TABLE_H

#include "kernel.h"
#include "lanes.h"

#define ENG_KERNEL_NAMES(K)                                                              \
    K(all_within)                                                                        \
    K(widen_within)                                                                      \
    K(bound_positions)                                                                   \
    K(box_points)                                                                        \
    K(place_points)                                                                      \
    K(box_fold)                                                                          \
    K(box_unite)                                                                         \
    K(quantised_blocks)                                                                  \
    K(quantised_unite)                                                                   \
    K(come_before)                                                                       \
    K(box_gaps)                                                                          \
    K(join_nodes)                                                                        \
    K(reject_axes)                                                                       \
    K(sift)                                                                              \
    K(sift_near)                                                                         \
    K(filter)                                                                            \
    K(bracket)                                                                           \
    K(reject_at_end)                                                                     \
    K(measure)                                                                           \
    K(reject_thick)                                                                      \
    K(sift_thick)                                                                        \
    K(advance)                                                                           \
    K(describe)                                                                          \
    K(cross_faces)

#define ENG_DECLARE(name) __typeof__(*((struct eng_kernels *)0)->name) ENG_KERNEL(name);
ENG_KERNEL_NAMES(ENG_DECLARE)
#undef ENG_DECLARE

/* .join_features of struct eng_kernels, by kind. */
#define ENG_DECLARE_JOIN(NAME, value, name, ...)                                         \
    __typeof__(*((struct eng_kernels *)0)->join_nodes) ENG_KERNEL(join_##name);
PCCD_KIND_LIST(ENG_DECLARE_JOIN)
ENG_DECLARE_JOIN(EF, 4, ef, )
#undef ENG_DECLARE_JOIN

#endif
