/* table.c - the kernels of one instruction set, for kernel.h. */
#include "table.h"

#define TEXT2(x) #x
#define TEXT(x)  TEXT2(x)

extern const struct eng_kernels ENG_KERNEL(kernels);

const struct eng_kernels ENG_KERNEL(kernels) = {
    .isa = ENG_ISA_NUMBER,
    .name = TEXT(ENG_ISA),
    .all_within = ENG_KERNEL(all_within),
    .widen_within = ENG_KERNEL(widen_within),
    .bound_positions = ENG_KERNEL(bound_positions),
    .box_points = ENG_KERNEL(box_points),
    .place_points = ENG_KERNEL(place_points),
    .box_fold = ENG_KERNEL(box_fold),
    .box_unite = ENG_KERNEL(box_unite),
    .quantised_blocks = ENG_KERNEL(quantised_blocks),
    .come_before = ENG_KERNEL(come_before),
    .box_gaps = ENG_KERNEL(box_gaps),
    .join_nodes = ENG_KERNEL(join_nodes),
#define JOIN_FEATURES(NAME, value, name, ...)                                            \
    .join_features[PCCD_##NAME] = ENG_KERNEL(join_##name),
    PCCD_KIND_LIST(JOIN_FEATURES) JOIN_FEATURES(EF, 4, ef, )
#undef JOIN_FEATURES
        .reject_axes = ENG_KERNEL(reject_axes),
    .sift = ENG_KERNEL(sift),
    .sift_near = ENG_KERNEL(sift_near),
    .filter = ENG_KERNEL(filter),
    .bracket = ENG_KERNEL(bracket),
    .reject_at_end = ENG_KERNEL(reject_at_end),
    .measure = ENG_KERNEL(measure),
    .reject_thick = ENG_KERNEL(reject_thick),
    .sift_thick = ENG_KERNEL(sift_thick),
    .advance = ENG_KERNEL(advance),
    .describe = ENG_KERNEL(describe),
    .cross_faces = ENG_KERNEL(cross_faces),
};
