/* daemon/engine/wide/wide_quantised.c - the cells of boxes in whole numbers.
 *
 * Room:     engine.
 * Does:     see wide_quantised.h.
 * Threads:  [compute].
 */
#include "wide_quantised.h"

#include <float.h>
#include <math.h>

#include "wide_grid.h"
#include "world.h"

/* Half of what the numbers span along an axis holds half of the scene this many times,
 * and of its longest side the part beside it: a flat scene moves, too. */
#define ROOM      1.25
#define ROOM_SIDE 0.25

/* Scales that floats can be multiplied by, with as much again to either side. */
#define EXPONENT_MOST 60

/* Numbers up to which a coordinate is certainly among those that there are: rounding and
 * the cells around it take a few. */
#define REACH_SURELY (ENG_QUANTISED_REACH - 64.0)

/* Blocks that are looked at, and the cells that the longest side of one takes at least on
 * average. A box is larger by about a cell for its rounding, that of a feature a fourth
 * of its block's: so it grows by a twentieth at most, where a comparison costs a third
 * less. One that takes more than CELLS_MAX counts as such: a few large ones, as a ground
 * has, make up for no small ones. */
#define SAMPLES   64u
#define CELLS_MIN 80.0f
#define CELLS_MAX (2 * CELLS_MIN)

void eng_wide_quantised_set(struct eng_quantising *quantising, int axis, double scale,
                            double middle)
{
    float below = (float)(middle * scale);
    float above = (float)(ENG_QUANTISED_ROUND - (double)below);
    if ((double)above + (double)below < ENG_QUANTISED_ROUND) {
        above = nextafterf(above, FLT_MAX);
    }
    quantising->scale[axis] = (float)scale;
    quantising->below[axis] = below;
    quantising->above[axis] = above;
}

/* Powers of two that bring the scene into reach, and what is added for its middle. False:
 * there is nothing in the scene, or it is too far from the numbers that floats hold. */
static bool quantising_of(const struct eng_wide *wide, const struct eng_scene *scene,
                          struct eng_quantising *quantising)
{
    double low[3];
    double high[3];
    double side = 0;
    if (!eng_wide_extent(wide, scene, low, high)) {
        return false;
    }
    for (int k = 0; k < 3; k++) {
        side = fmax(side, 0.5 * (high[k] - low[k]));
    }
    if (!(side > 0)) {
        return false;
    }
    for (int k = 0; k < 3; k++) {
        double half = ROOM * 0.5 * (high[k] - low[k]) + ROOM_SIDE * side;
        int exponent;
        frexp(ENG_QUANTISED_REACH / half, &exponent);
        if (exponent > EXPONENT_MOST || exponent < -EXPONENT_MOST) {
            return false;
        }
        double scale = ldexp(1, exponent - 1); /* scale half <= ENG_QUANTISED_REACH */
        eng_wide_quantised_set(quantising, k, scale, 0.5 * (low[k] + high[k]));
    }
    return true;
}

/* The longest side of a block's box at t = 0, in cells; negative: it is nowhere. */
static float cells_of(const struct eng_extents *box,
                      const struct eng_quantising *quantising)
{
    float most = -1;
    for (int k = 0; k < 3; k++) {
        float side = box->side[ENG_LOW0][k] + box->side[ENG_HIGH0][k];
        most = fmaxf(most, side * quantising->scale[k]);
    }
    return most;
}

static bool features_are_large(const struct eng_wide_tree *tree,
                               const struct eng_quantising *quantising)
{
    uint32_t count = tree->block_count[0];
    uint32_t samples = count < SAMPLES ? count : SAMPLES;
    float sum = 0;
    float seen = 0;
    for (uint32_t i = 0; i < samples; i++) {
        float cells = cells_of(&tree->boxes[(uint64_t)count * i / samples], quantising);
        if (cells >= 0) {
            sum += fminf(cells, CELLS_MAX);
            seen += 1;
        }
    }
    return seen > 0 && sum >= CELLS_MIN * seen;
}

/* Did the boxes of the last step have the scale that those of this one get? Then their
 * sizes tell how large features are. */
static bool has_kept_scale(const struct eng_wide *wide, const struct eng_scene *scene)
{
    return !wide->boxes_are_old && wide->frame_scale == scene->framing.scale;
}

/* Are both ends of what moves so far within the numbers that no rounding leads out? */
static bool movers_are_within(const struct eng_wide *wide, const struct eng_scene *scene)
{
    for (uint32_t i = 0; i < scene->object_capacity; i++) {
        const struct eng_object *object = &scene->objects[i];
        if (!object->mesh || object->movement == ENG_STANDS) {
            continue;
        }
        for (int j = 0; j < 6; j++) {
            int k = j % 3;
            const struct eng_bounds *bounds =
                &object->bounds[j < 3 ? 1 - scene->now : scene->now];
            double origin = object->frame.origin[j < 3 ? k : 4 + k];
            double scale = (double)wide->quantising.scale[k];
            double middle = (double)wide->quantising.below[k];
            double low = (bounds->low[k] - origin) * object->frame.scale * scale - middle;
            double high =
                (bounds->high[k] - origin) * object->frame.scale * scale - middle;
            if (!(low > -REACH_SURELY && high < REACH_SURELY)) {
                return false;
            }
        }
    }
    return true;
}

bool eng_wide_quantised_choose(struct eng_wide *wide, const struct eng_scene *scene,
                               bool may, bool is_current)
{
    bool were_quantised = eng_wide_has_quantised(wide);
    if (is_current && may && were_quantised && movers_are_within(wide, scene)) {
        return true;
    }
    struct eng_quantising quantising = {{0}, {0}, {0}};
    atomic_store_explicit(&wide->left_quantised, false, memory_order_relaxed);
    atomic_store_explicit(&wide->farthest, 0, memory_order_relaxed);
    wide->makes_quantised =
        may && has_kept_scale(wide, scene) && quantising_of(wide, scene, &quantising) &&
        features_are_large(&wide->trees[PCCD_TREE_EDGES], &quantising);
    wide->quantising = quantising;
    return is_current && !were_quantised && !wide->makes_quantised;
}
