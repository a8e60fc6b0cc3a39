/* wide_quantised.h - decides whether a step compares quantised boxes (quantised.h), and
 * how large a cell is.
 *
 * Decide from the boxes of the last step, or from where a scene without such boxes
 * begins, whether the boxes of its features are compared as numbers of 16 bits, and what
 * a number stands for.
 *
 * Threads: as marked.
 */
#ifndef ENG_WIDE_QUANTISED_H
#define ENG_WIDE_QUANTISED_H

#include "wide.h"

/* Before the refit of a step, which `may` do so, when objects have their frames. A step
 * that goes farther than the last one let expect, and a scene whose features are small in
 * cells, do without. O(1), with frames O(objects). [compute]
 *
 * `is_current`: the boxes of what stands are there from the last step. True: they may
 * stay, as cells and what is made of them are the same. */
bool eng_wide_quantised_choose(struct eng_wide *wide, const struct eng_scene *scene,
                               bool may, bool is_current);

/* Cells of 1 / scale, a power of two, 2^-60 .. 2^60, around `middle` along an axis: what
 * is added for it is rounded, together never to less than ENG_QUANTISED_ROUND. [any] */
void eng_wide_quantised_set(struct eng_quantising *quantising, int axis, double scale,
                            double middle);

/* After the refit: may boxes of features be compared in whole numbers? [any] */
static inline bool eng_wide_has_quantised(const struct eng_wide *wide)
{
    return wide->makes_quantised &&
           !atomic_load_explicit(&wide->left_quantised, memory_order_relaxed);
}

#endif
