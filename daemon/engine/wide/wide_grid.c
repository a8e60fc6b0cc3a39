/* wide_grid.c - the grid of the sieve, from where the scene was. */
#include "wide_grid.h"

#include <math.h>

#include "frames.h"
#include "world.h"

/* Half a side of the grid is at least twice what the scene needs when it is made, and
 * that is at most an eighth of it when it is kept. */
#define ROOM       2.0
#define USED_LEAST 0.125
#define USED_MOST  0.75

/* Exponents of half a side, so that neither it nor the scale leaves the numbers. */
#define EXPONENT_MIN (-900)

bool eng_wide_extent(const struct eng_wide *wide, const struct eng_scene *scene,
                     double low[3], double high[3])
{
    const struct eng_wide_tree *tree = &wide->trees[PCCD_TREE_VERTICES];
    const struct eng_extents *box = eng_wide_boxes(tree, wide->level_count - 1);
    if (wide->boxes_are_old || scene->framing.number != wide->frames) {
        return eng_frames_extent(scene, low, high);
    }
    for (int k = 0; k < 3; k++) {
        low[k] = -fmax(box->side[ENG_LOW0][k], box->side[ENG_LOW1][k]);
        high[k] = fmax(box->side[ENG_HIGH0][k], box->side[ENG_HIGH1][k]);
    }
    return low[0] <= high[0];
}

static bool still_fits(const struct eng_grid *grid, const double low[3],
                       const double high[3])
{
    double reach = ENG_GRID_REACH / grid->scale;
    double half = 0;
    for (int k = 0; k < 3; k++) {
        if (grid->origin[k] - low[k] > USED_MOST * reach ||
            high[k] - grid->origin[k] > USED_MOST * reach) {
            return false;
        }
        half = fmax(half, 0.5 * (high[k] - low[k]));
    }
    return half >= USED_LEAST * reach;
}

void eng_wide_forget_near(struct eng_wide *wide, uint32_t end)
{
    for (uint32_t i = 0; i < wide->trees[PCCD_TREE_VERTICES].slot_count; i++) {
        struct eng_mark *mark = &wide->marks[i];
        atomic_store_explicit(end == 0 ? &mark->less0 : &mark->less1, 0,
                              memory_order_relaxed);
    }
}

struct eng_sieve eng_wide_sieve(const struct eng_wide *wide, enum pccd_kind kind)
{
    const struct eng_wide_tree *a = &wide->trees[eng_wide_tree_of(kind, 0)];
    const struct eng_wide_tree *b = &wide->trees[eng_wide_tree_of(kind, 1)];
    return (struct eng_sieve){.marks = wide->marks,
                              .a_corner = {a->corner[0], a->corner[1]},
                              .b_corner = {b->corner[0], b->corner[1], b->corner[2]},
                              .t_end = 1};
}

bool eng_wide_grid_choose(struct eng_wide *wide, const struct eng_scene *scene)
{
    struct eng_grid *grid = &wide->grid;
    bool was_left = atomic_load_explicit(&wide->left_grid, memory_order_relaxed);
    double low[3];
    double high[3];
    double half = 0;
    if (!eng_wide_extent(wide, scene, low, high)) {
        grid->scale = 0;
        return false;
    }
    atomic_store_explicit(&wide->left_grid, false, memory_order_relaxed);
    if (!was_left && grid->scale > 0 && still_fits(grid, low, high)) {
        return true;
    }
    for (int k = 0; k < 3; k++) {
        grid->origin[k] = 0.5 * (low[k] + high[k]);
        half = fmax(half, 0.5 * (high[k] - low[k]));
    }
    int exponent;
    frexp(ROOM * half, &exponent);
    grid->scale = ldexp(1, 30 - (exponent > EXPONENT_MIN ? exponent : EXPONENT_MIN));
    return false;
}
