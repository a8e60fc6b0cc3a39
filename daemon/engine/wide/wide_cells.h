/* wide_cells.h - what whole numbers stand for in a step: the grid of the sieve
 * (kernel.h), and the quantised boxes (quantised.h), if there are to be any.
 *
 * Both are laid over the scene before its vertices are placed: cells of boxes by where
 * the step goes, as the bounds of the objects say; the grid, which stays where it fits,
 * by the boxes of the last step, and in a scene without such boxes by where it begins. A
 * step that leaves the grid does without the sieve. No step leaves the whole numbers.
 *
 * Threads: as marked.
 * Source: elementary/BOUNDS.md, "Boxes in whole numbers".
 */
#ifndef ENG_WIDE_CELLS_H
#define ENG_WIDE_CELLS_H

#include <math.h>
#include <string.h>

#include "wide.h"

/* ---- quantised boxes --------------------------------------------------------------- */

/* Before the refit of a step, which `may` do so, or else has room for floats, when
 * objects have their frames. A scene whose features are small in cells does without, if
 * there is memory for floats. O(objects). [compute]
 *
 * `is_current`: the boxes of what stands are there from the last step. True: they may
 * stay, as cells and what is made of them are the same. */
bool eng_wide_quantised_choose(struct eng_wide *wide, const struct eng_scene *scene,
                               bool may, bool is_current);

/* Cells of 1 / scale, a power of two, 2^-70 .. 2^60, around `middle` along an axis: what
 * is added for it is rounded, together never to less than ENG_QUANTISED_ROUND. [any] */
void eng_wide_quantised_set(struct eng_quantising *quantising, int axis, double scale,
                            double middle);

/* Return a distance outward that is not less than any which has this number, where
 * `origin` was added, and a cell is a power of two long. It is at most half a cell, and
 * for its rounding 2^-9, above what the number says; a float of it is off by 2^-24 of
 * itself. */
static inline float eng_wide_distance_of(int16_t number, double cell, float origin)
{
    double cells = (double)number - (double)origin + (0.5 + 0x1p-8);
    double distance = cells * cell;
    return (float)(distance + fabs(distance) * 0x1p-23);
}

/* Return the box around a block of a level, in floats, whatever the step compares. */
static inline struct eng_extents eng_wide_box(const struct eng_wide *wide,
                                              const struct eng_wide_tree *tree,
                                              uint32_t level, uint32_t block)
{
    if (level > 0 || !wide->has_quantised) {
        return eng_wide_boxes(tree, level)[block];
    }
    const struct eng_quantising *quantising = &wide->quantising;
    const struct eng_quantised_box *from = &tree->quantised_boxes[block];
    struct eng_extents box;
    for (int k = 0; k < 3; k++) {
        double cell = 1 / (double)quantising->scale[k];
        for (int end = 0; end < 2; end++) {
            int16_t above = from->half[end][2 * k];
            int16_t below = from->half[end][2 * k + 1];
            bool is_nowhere = above == INT16_MIN && below == INT16_MIN;
            box.side[ENG_LOW0 + end][k] =
                is_nowhere ? ENG_NOWHERE
                           : eng_wide_distance_of(below, cell, quantising->below[k]);
            box.side[ENG_HIGH0 + end][k] =
                is_nowhere ? ENG_NOWHERE
                           : eng_wide_distance_of(above, cell, quantising->above[k]);
        }
    }
    for (int side = 0; side < ENG_SIDES; side++) {
        box.side[side][3] = ENG_NOWHERE;
    }
    return box;
}

/* ---- the grid of the sieve --------------------------------------------------------- */

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

/* Nothing is known of any mark at an end of the step. [compute] */
void eng_wide_forget_near(struct eng_wide *wide, uint32_t end);

/* A distance in cells, 0 .. ENG_GRID_REACH, as a float above it. */
static inline float eng_wide_cells_of(double distance)
{
    float cells = (float)distance;
    uint32_t bits;
    memcpy(&bits, &cells, sizeof bits);
    bits++; /* the next one */
    memcpy(&cells, &bits, sizeof cells);
    return cells;
}

/* To each of four marks something is known to be as near as `cells`, at most the reach
 * that the sieve is asked with. Of two that two threads tell at once either may stay. */
static inline void eng_wide_mark_near(struct eng_mark *marks, const uint32_t quad[4],
                                      uint32_t end, float reach, float cells)
{
    int32_t bits[2];
    memcpy(&bits[0], &reach, sizeof bits[0]);
    memcpy(&bits[1], &cells, sizeof bits[1]);
    int32_t less = bits[0] - bits[1];
    for (int k = 0; k < 4; k++) {
        struct eng_mark *mark = &marks[quad[k]];
        _Atomic int32_t *known = end == 0 ? &mark->less0 : &mark->less1;
        if (atomic_load_explicit(known, memory_order_relaxed) < less) {
            atomic_store_explicit(known, less, memory_order_relaxed);
        }
    }
}

/* Return, after the refit, whether a sieve may use the marks. [any] */
static inline bool eng_wide_has_marks(const struct eng_wide *wide)
{
    return wide->grid.scale > 0 &&
           !atomic_load_explicit(&wide->left_grid, memory_order_relaxed);
}

#endif
