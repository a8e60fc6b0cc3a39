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

/* Choose whether a step has quantised boxes, and their cells, before its refit, when
 * objects have their frames: it has none unless it `may`, and then there is room for
 * floats. A scene whose features are small in cells does without, if there is memory for
 * floats. O(objects). [compute]
 *
 * `is_current`: the boxes of what stands are there from the last step. True: they may
 * stay, as cells and what is made of them are the same. */
bool eng_wide_quantised_choose(struct eng_wide *wide, const struct eng_scene *scene,
                               bool may, bool is_current);

/* Set cells of 1 / scale, a power of two, 2^-70 .. 2^60, around `middle` along an axis:
 * what is added for it is rounded, together never to less than ENG_QUANTISED_ROUND.
 * [any] */
void eng_wide_quantised_set(struct eng_quantising *quantising, int axis, double scale,
                            double middle);

/* Return what is added to a number for its cells: `origin` was added, and what rounding
 * took. */
static inline float eng_wide_back_by(float origin)
{
    float back = 0.5F + 0x1p-8F - origin;
    return back + fabsf(back) * 0x1p-22F;
}

/* One side of a box: three axes, and nowhere. */
typedef float eng_wide_side __attribute__((vector_size(16), may_alias));
typedef int32_t eng_wide_bits __attribute__((vector_size(16), may_alias));

/* Keep what makes distances of all numbers of a step. */
struct eng_wide_back {
    eng_wide_side cell;
    eng_wide_side below;
    eng_wide_side above;
};

static inline struct eng_wide_back
eng_wide_back_of(const struct eng_quantising *quantising)
{
    struct eng_wide_back back = {.cell = {0}};
    for (int k = 0; k < 3; k++) {
        back.cell[k] = 1 / quantising->scale[k];
        back.below[k] = eng_wide_back_by(quantising->below[k]);
        back.above[k] = eng_wide_back_by(quantising->above[k]);
    }
    return back;
}

/* Return for each number a distance outward that is not less than any which has it, in
 * cells that are powers of two long; `back`: eng_wide_back_by. It is at most half a cell
 * and 2^-8, 2^-21 of the origin and 2^-21 of itself above what the number says. */
static inline eng_wide_bits eng_wide_distances(eng_wide_bits numbers, eng_wide_side cell,
                                               eng_wide_side back)
{
    eng_wide_side distance =
        (__builtin_convertvector(numbers, eng_wide_side) + back) * cell;
    eng_wide_side size = (eng_wide_side)((eng_wide_bits)distance & INT32_MAX);
    return (eng_wide_bits)(distance + size * 0x1p-22F);
}

/* Write the box that has these numbers. */
static inline void eng_wide_unquantise(const struct eng_quantised_box *from,
                                       const struct eng_wide_back *back,
                                       struct eng_extents *box)
{
    const eng_wide_bits nowhere = (eng_wide_bits)((eng_wide_side){0} + ENG_NOWHERE);
    for (int end = 0; end < 2; end++) {
        eng_wide_bits both; /* above: the lower half; below: the upper one */
        memcpy(&both, from->half[end], sizeof both);
        eng_wide_bits low = eng_wide_distances(both >> 16, back->cell, back->below);
        eng_wide_bits high =
            eng_wide_distances((both << 16) >> 16, back->cell, back->above);
        eng_wide_bits is_out =
            (both == (int32_t)0x80008000) | (eng_wide_bits){0, 0, 0, -1};
        low = (is_out & nowhere) | (~is_out & low);
        high = (is_out & nowhere) | (~is_out & high);
        memcpy(box->side[ENG_LOW0 + end], &low, sizeof low);
        memcpy(box->side[ENG_HIGH0 + end], &high, sizeof high);
    }
}

/* Return the box around a block of a level, in floats, whatever the step compares. */
static inline struct eng_extents eng_wide_box(const struct eng_wide *wide,
                                              const struct eng_wide_tree *tree,
                                              uint32_t level, uint32_t block)
{
    if (!wide->has_quantised) {
        return eng_wide_boxes(tree, level)[block];
    }
    struct eng_extents box;
    struct eng_wide_back back = eng_wide_back_of(&wide->quantising);
    eng_wide_unquantise(&tree->quantised_boxes[tree->first[level] + block], &back, &box);
    return box;
}

/* ---- the grid of the sieve --------------------------------------------------------- */

/* Choose cells and origin of the grid, before the refit of a step, when objects have
 * their frames. Return whether the grid that was there fits and stays. O(1), with frames
 * O(objects). [compute] */
bool eng_wide_grid_choose(struct eng_wide *wide, const struct eng_scene *scene);

/* Write the bounds of all vertices, as their boxes are measured in the step to come: as
 * known from both ends of the last step, or exactly if there was none or it had other
 * frames. False: there are none. [compute] */
bool eng_wide_extent(const struct eng_wide *wide, const struct eng_scene *scene,
                     double low[3], double high[3]);

/* Return a sieve for all pairs of a kind over the whole step. [any] */
struct eng_sieve eng_wide_sieve(const struct eng_wide *wide, enum pccd_kind kind);

/* Forget what is known of all marks at an end of the step. [compute] */
void eng_wide_forget_near(struct eng_wide *wide, uint32_t end);

/* Return a distance in cells, 0 .. ENG_GRID_REACH, as a float above it. */
static inline float eng_wide_cells_of(double distance)
{
    float cells = (float)distance;
    uint32_t bits;
    memcpy(&bits, &cells, sizeof bits);
    bits++; /* the next one */
    memcpy(&cells, &bits, sizeof cells);
    return cells;
}

/* Note for each of four marks that something is known to be as near to it as `cells`, at
 * most the reach that the sieve is asked with. Of two that two threads tell at once
 * either may stay. Returns bit k if it was not known of point k. */
static inline uint32_t eng_wide_mark_near(struct eng_mark *marks, const uint32_t quad[4],
                                          uint32_t end, float reach, float cells)
{
    int32_t bits[2];
    memcpy(&bits[0], &reach, sizeof bits[0]);
    memcpy(&bits[1], &cells, sizeof bits[1]);
    int32_t less = bits[0] - bits[1];
    uint32_t is_new = 0;
    for (int k = 0; k < 4; k++) {
        struct eng_mark *mark = &marks[quad[k]];
        _Atomic int32_t *known = end == 0 ? &mark->less0 : &mark->less1;
        if (atomic_load_explicit(known, memory_order_relaxed) < less) {
            atomic_store_explicit(known, less, memory_order_relaxed);
            is_new |= 1u << k;
        }
    }
    return is_new;
}

/* Return, after the refit, whether a sieve may use the marks. [any] */
static inline bool eng_wide_has_marks(const struct eng_wide *wide)
{
    return wide->grid.scale > 0 &&
           !atomic_load_explicit(&wide->left_grid, memory_order_relaxed);
}

#endif
