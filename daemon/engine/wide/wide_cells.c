/* wide_cells.c - the grid of the sieve, and the cells of quantised boxes. */
#include "wide_cells.h"

#include <assert.h>
#include <float.h>
#include <math.h>

#include "box_frames.h"
#include "thickness.h"
#include "world.h"

/* ---- the grid of the sieve --------------------------------------------------------- */

/* Half a side of the grid is at least twice what the scene needs when it is made, and
 * that is at most an eighth of it when it is kept. */
#define GRID_ROOM  2.0
#define USED_LEAST 0.125
#define USED_MOST  0.75

/* Exponents of half a side, so that neither it nor the scale leaves the numbers. */
#define EXPONENT_MIN (-900)

bool eng_wide_extent(const struct eng_wide *wide, const struct eng_scene *scene,
                     double low[3], double high[3])
{
    const struct eng_extents *box = &wide->around;
    if (wide->boxes_are_old || wide->lacks_apart ||
        scene->framing.number != wide->frames) {
        return eng_box_frames_extent(scene, low, high);
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
    frexp(GRID_ROOM * half, &exponent);
    grid->scale = ldexp(1, 30 - (exponent > EXPONENT_MIN ? exponent : EXPONENT_MIN));
    return false;
}

/* ---- quantised boxes --------------------------------------------------------------- */

/* Half of what the numbers span along an axis holds half of the scene this many times,
 * and of its longest side the part beside it: a flat scene moves, too. And a part of how
 * far it is from the origin: floats are off by more, the farther away (SLACK). */
#define ROOM      1.25
#define ROOM_SIDE 0.25
#define ROOM_FAR  0x1p-18

/* Scales that floats can be multiplied by, with as much again to either side. The least
 * is that of the largest coordinates and distances (ENG_GROWTH_MOST): nowhere is far
 * below all numbers by it, too. */
#define EXPONENT_MOST  60
#define EXPONENT_LEAST (-70)

/* Numbers up to which a coordinate is certainly among those that there are. The bound of
 * a box, a float, is off by 2^-23 of itself, with what it grows by by 2^-21, and what is
 * added for the middle by 2^-23 of that. Together this is less than SLACK of the object's
 * two bounds, in cells, which are as far away as the middle. The rest takes a few cells
 * (BOUNDS.md, "Boxes in whole numbers"). */
#define REACH_SURELY (ENG_QUANTISED_REACH - 64.0)
#define SLACK        0x1p-20

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

/* Powers of two that bring a scene into reach that is between these, and what is added
 * for its middle. */
static void lay_cells(const double low[3], const double high[3],
                      struct eng_quantising *quantising)
{
    double side = 0;
    for (int k = 0; k < 3; k++) {
        side = fmax(side, 0.5 * (high[k] - low[k]));
    }
    for (int k = 0; k < 3; k++) {
        double half = ROOM * 0.5 * (high[k] - low[k]) + ROOM_SIDE * side +
                      ROOM_FAR * fmax(fabs(low[k]), fabs(high[k]));
        int exponent = EXPONENT_MOST + 1; /* of no size, or less than has a quotient */
        if (half > 0x1p-900) {
            frexp(ENG_QUANTISED_REACH / half, &exponent);
        }
        exponent = exponent > EXPONENT_MOST ? EXPONENT_MOST : exponent - 1;
        assert(exponent >= EXPONENT_LEAST);
        double scale = ldexp(1, exponent); /* scale half <= ENG_QUANTISED_REACH */
        eng_wide_quantised_set(quantising, k, scale, 0.5 * (low[k] + high[k]));
    }
}

/* The bounds of an object's boxes along an axis at an end of the step, in its frame. */
static void bounds_of(const struct eng_scene *scene, const struct eng_object *object,
                      int end, int axis, double *low, double *high)
{
    const struct eng_bounds *bounds =
        &object->bounds[end == 0 ? 1 - scene->now : scene->now];
    double origin = object->frame.origin[4 * end + axis];
    double growth =
        scene->thickness.is_on ? (double)eng_thickness_reach_growth(scene) : 0;
    *low = (bounds->low[axis] - origin) * object->frame.scale - growth;
    *high = (bounds->high[axis] - origin) * object->frame.scale + growth;
}

/* Return whether both ends of an object are so far within the numbers that no rounding
 * leads out. */
static bool is_within(const struct eng_quantising *quantising,
                      const struct eng_scene *scene, const struct eng_object *object)
{
    for (int j = 0; j < 6; j++) {
        double low;
        double high;
        double scale = (double)quantising->scale[j % 3];
        double middle = (double)quantising->below[j % 3];
        bounds_of(scene, object, j / 3, j % 3, &low, &high);
        if (low > high) {
            continue; /* it has no boxes */
        }
        double slack = SLACK * scale * (fabs(low) + fabs(high));
        if (!(low * scale - middle - slack > -REACH_SURELY &&
              high * scale - middle + slack < REACH_SURELY)) {
            return false;
        }
    }
    return true;
}

/* The same of all objects, or of those of which something moves. */
static bool are_within(const struct eng_quantising *quantising,
                       const struct eng_scene *scene, bool movers)
{
    for (uint32_t i = 0; i < scene->object_capacity; i++) {
        const struct eng_object *object = &scene->objects[i];
        if (object->mesh && !(movers && object->moves == ENG_STANDS) &&
            !is_within(quantising, scene, object)) {
            return false;
        }
    }
    return true;
}

/* Lay the cells by where the step goes. */
static void choose_cells(const struct eng_scene *scene, struct eng_quantising *quantising)
{
    double low[3] = {INFINITY, INFINITY, INFINITY};
    double high[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (uint32_t i = 0; i < scene->object_capacity; i++) {
        for (int j = 0; scene->objects[i].mesh && j < 6; j++) {
            double least;
            double most;
            bounds_of(scene, &scene->objects[i], j / 3, j % 3, &least, &most);
            low[j % 3] = least < low[j % 3] ? least : low[j % 3];
            high[j % 3] = most > high[j % 3] ? most : high[j % 3];
        }
    }
    for (int k = 0; k < 3 && low[k] > high[k]; k++) {
        low[k] = high[k] = 0; /* nothing is in the scene */
    }
    lay_cells(low, high, quantising);
    assert(are_within(quantising, scene, false));
}

/* The longest side of a block's box at t = 0, in cells; negative: it is nowhere. */
static float cells_of(struct eng_extents box,
                      const struct eng_quantising *quantising)
{
    float most = -1;
    for (int k = 0; k < 3; k++) {
        float side = box.side[ENG_LOW0][k] + box.side[ENG_HIGH0][k];
        most = fmaxf(most, side * quantising->scale[k]);
    }
    return most;
}

/* The same of a block of edges that has no box yet, from where they are at t = 0. */
static float cells_of_edges(const struct eng_wide *wide, const struct eng_scene *scene,
                            uint32_t block, const struct eng_quantising *quantising)
{
    const struct eng_wide_tree *tree = &wide->trees[PCCD_TREE_EDGES];
    const double(*x)[3] = (const double(*)[3])scene->x[1 - scene->now];
    double low[3] = {INFINITY, INFINITY, INFINITY};
    double high[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (uint32_t i = 0; i < 2 * ENG_WIDE; i++) {
        uint32_t slot = tree->corner[i / ENG_WIDE][block * ENG_WIDE + i % ENG_WIDE];
        uint64_t owner = wide->points[slot].word0;
        for (int k = 0; owner != ENG_WIDE_NOBODY && k < 3; k++) {
            low[k] = fmin(low[k], x[(uint32_t)owner][k]);
            high[k] = fmax(high[k], x[(uint32_t)owner][k]);
        }
    }
    float most = -1;
    for (int k = 0; k < 3; k++) {
        double side = (high[k] - low[k]) * scene->framing.scale;
        most = fmaxf(most, (float)side * quantising->scale[k]);
    }
    return most;
}

/* Return whether the boxes of the last step have the scale that those of this one get. */
static bool have_kept_scale(const struct eng_wide *wide, const struct eng_scene *scene)
{
    return !wide->boxes_are_old && wide->frame_scale == scene->framing.scale;
}

/* By the boxes of the last step, if they tell, as a rule. */
static bool features_are_large(const struct eng_wide *wide, const struct eng_scene *scene,
                               const struct eng_quantising *quantising)
{
    const struct eng_wide_tree *tree = &wide->trees[PCCD_TREE_EDGES];
    bool has_boxes = have_kept_scale(wide, scene);
    uint32_t count = tree->block_count[0];
    uint32_t samples = count < SAMPLES ? count : SAMPLES;
    float sum = 0;
    float seen = 0;
    for (uint32_t i = 0; i < samples; i++) {
        uint32_t block = (uint32_t)((uint64_t)count * i / samples);
        float cells = has_boxes
                          ? cells_of(eng_wide_box(wide, tree, 0, block), quantising)
                          : cells_of_edges(wide, scene, block, quantising);
        if (cells >= 0) {
            sum += fminf(cells, CELLS_MAX);
            seen += 1;
        }
    }
    return seen > 0 && sum >= CELLS_MIN * seen;
}

bool eng_wide_quantised_choose(struct eng_wide *wide, const struct eng_scene *scene,
                               bool may, bool is_current)
{
    bool were_quantised = wide->has_quantised;
    if (is_current && may && were_quantised &&
        are_within(&wide->quantising, scene, true)) {
        return true;
    }
    struct eng_quantising quantising = {{0}, {0}, {0}};
    choose_cells(scene, &quantising);
    bool are_large = features_are_large(wide, scene, &quantising);
    atomic_store_explicit(&wide->farthest, 0, memory_order_relaxed);
    /* Without memory for floats they serve small features, too. */
    wide->has_quantised = may && (are_large || eng_wide_reserve_floats(wide) != PCCD_OK);
    wide->quantising = quantising;
    return is_current && !were_quantised && !wide->has_quantised;
}
