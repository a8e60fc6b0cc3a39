/* daemon/engine/wide/wide_grid.h - chooses the grid of the sieve (sieve.h) from where the
 * scene was in the last step.
 *
 * Room:     engine. May include: wide.h.
 * Does:     lay the grid over the scene before its vertices are placed on it: by the
 *           boxes of the last step, because those of this step are made together with the
 *           marks. A step that leaves the grid does without the sieve.
 * Threads:  as marked.
 */
#ifndef ENG_WIDE_GRID_H
#define ENG_WIDE_GRID_H

#include "wide.h"

/* Before the refit of a step, when objects have their frames; keeps the grid that it had
 * where that still fits: true. O(1), with frames O(objects). [compute] */
bool eng_wide_grid_choose(struct eng_wide *wide, const struct eng_scene *scene);

/* Around all vertices, as their boxes are measured in the step to come: as known from
 * both ends of the last step, or exactly if there was none or it had other frames. False:
 * there are none. [compute] */
bool eng_wide_extent(const struct eng_wide *wide, const struct eng_scene *scene,
                     double low[3], double high[3]);

/* For all pairs of a kind over the whole step. [any] */
struct eng_sieve eng_wide_sieve(const struct eng_wide *wide, enum pccd_kind kind);

/* After the refit: may a sieve use the marks? [any] */
static inline bool eng_wide_has_marks(const struct eng_wide *wide)
{
    return wide->grid.scale > 0 &&
           !atomic_load_explicit(&wide->left_grid, memory_order_relaxed);
}

#endif
