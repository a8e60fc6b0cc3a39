/* daemon/engine/wide/wide_narrow.h - the cells of boxes in whole numbers.
 *
 * Room:     engine. May include: wide.h.
 * Does:     decide, from where the scene was, whether a step compares the boxes of its
 *           features in numbers of 16 bits, and what a number stands for.
 * Threads:  as marked.
 */
#ifndef ENG_WIDE_NARROW_H
#define ENG_WIDE_NARROW_H

#include "wide.h"

/* Before the refit of a step, which `may` do so, when objects have their frames. A step
 * that goes farther than the last one let expect, and a scene whose features are small in
 * cells, do without. O(1), with frames O(objects). [compute] */
void eng_wide_narrow_choose(struct eng_wide *wide, const struct eng_scene *scene,
                            bool may);

/* Cells of 1 / scale, a power of two, 2^-60 .. 2^60, around `middle` along an axis: what
 * is added for it is rounded, together never to less than ENG_NARROW_ROUND. [any] */
void eng_wide_narrow_set(struct eng_narrowing *narrowing, int axis, double scale,
                         double middle);

/* After the refit: may boxes of features be compared in whole numbers? [any] */
static inline bool eng_wide_has_narrow(const struct eng_wide *wide)
{
    return wide->makes_narrow &&
           !atomic_load_explicit(&wide->left_narrow, memory_order_relaxed);
}

#endif
