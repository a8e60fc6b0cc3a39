/* wide_refit.c - the boxes of the trees of the method `wide`.
 *
 * A chunk is a few whole nodes of level 1: their boxes are made while those of their
 * features are in the first cache.
 */
#include <assert.h>
#include <string.h>

#include "thickness.h"
#include "wide.h"
#include "wide_cells.h"
#include "wide_state.h"
#include "world.h"

/* Blocks at a time whose floats are only made to become whole numbers: 14 KiB. */
#define FLOAT_BLOCKS 8u

static uint32_t smaller(uint32_t a, uint32_t b)
{
    return a < b ? a : b;
}

uint32_t eng_wide_refit_chunks(const struct eng_wide *wide, enum pccd_tree kind)
{
    return (wide->trees[kind].block_count[0] + ENG_WIDE_CHUNK_BLOCKS - 1) /
           ENG_WIDE_CHUNK_BLOCKS;
}

/* Slots first .. behind which a slot is nobody's or, where objects have frames or
 * thickness, another object's. */
static uint32_t end_of_run(const struct eng_wide *wide, const struct eng_scene *scene,
                           uint32_t first, uint32_t end)
{
    uint64_t object = wide->points[first].word0 >> 32;
    bool of_one = scene->framing.number > 0 || scene->thickness.is_on;
    uint32_t slot = first;
    for (; slot < end && wide->points[slot].word0 != ENG_WIDE_NOBODY; slot++) {
        if (of_one && wide->points[slot].word0 >> 32 != object) {
            break;
        }
    }
    return slot;
}

#define SIDE                                                                             \
    {                                                                                    \
        ENG_NOWHERE, ENG_NOWHERE, ENG_NOWHERE, ENG_NOWHERE                               \
    }
static const struct eng_extents nowhere = {{SIDE, SIDE, SIDE, SIDE}};

/* Boxes of vertices of one object, with its thickness. */
static void grow(const struct eng_scene *scene, const struct eng_point *points,
                 uint32_t count, struct eng_extents *boxes)
{
    const struct eng_object *object = &scene->objects[points->word0 >> 32];
    bool by_vertex = eng_thickness_is_by_vertex(object);
    float growth = eng_thickness_growth(scene, object, 0);
    for (uint32_t i = 0; i < count; i++) {
        if (by_vertex) {
            growth = eng_thickness_growth(scene, object, (uint32_t)points[i].word1);
        }
        float *side = boxes[i].side[0];
        for (uint32_t k = 0; k < sizeof boxes[i].side / sizeof *side; k++) {
            side[k] = eng_thickness_grown(side[k], growth);
        }
    }
}

/* Positions, boxes and, unless they are swept, marks of the vertices in slots first ..
 * end - 1; those of nobody are nowhere. */
static void refit_points(struct eng_wide *wide, const struct eng_scene *scene,
                         uint32_t first, uint32_t end, struct eng_extents *boxes)
{
    const double(*x0)[3] = (const double(*)[3])scene->x[1 - scene->now];
    const double(*x1)[3] = (const double(*)[3])scene->x[scene->now];
    for (uint32_t slot = first; slot < end;) {
        if (wide->points[slot].word0 == ENG_WIDE_NOBODY) {
            boxes[slot - first] = nowhere;
            slot++;
            continue;
        }
        uint32_t run = slot;
        struct eng_extents *run_boxes = boxes + (run - first);
        const struct eng_box_frame *frame =
            scene->framing.number > 0
                ? &scene->objects[wide->points[run].word0 >> 32].frame
                : NULL;
        uint32_t run_end = end_of_run(wide, scene, run, end);
        for (; slot < run_end; slot++) {
            struct eng_point *point = &wide->points[slot];
            memcpy(point->x0, x0[(uint32_t)point->word0], sizeof point->x0);
            memcpy(point->x1, x1[(uint32_t)point->word0], sizeof point->x1);
        }
        wide->kernels->box_points(wide->points + run, slot - run, frame, wide->is_swept,
                                  run_boxes);
        if (scene->thickness.is_on) {
            grow(scene, wide->points + run, slot - run, run_boxes);
        }
        if (!wide->is_swept &&
            !wide->kernels->place_points(wide->points + run, slot - run, frame,
                                         &wide->grid, wide->marks + run)) {
            atomic_store_explicit(&wide->left_grid, true, memory_order_relaxed);
        }
    }
}

/* Set the corners of edges or faces from a slot on, as the kernels take them. */
static void corners_of(const struct eng_wide_tree *tree, enum pccd_tree kind,
                       uint32_t slot, const uint32_t *corner[3])
{
    for (uint32_t k = 0; k < 3; k++) {
        corner[k] = k < 2 || kind == PCCD_TREE_FACES ? tree->corner[k] + slot : NULL;
    }
}

/* Boxes of `count` blocks of features from `block` on, in floats. */
static void box_features(struct eng_wide *wide, enum pccd_tree kind, uint32_t block,
                         uint32_t count)
{
    const struct eng_kernels *kernels = wide->kernels;
    struct eng_wide_tree *tree = &wide->trees[kind];
    uint32_t slot = block * ENG_WIDE;
    if (kind == PCCD_TREE_VERTICES) {
        kernels->box_fold(wide->point_boxes + slot, count, wide->is_swept,
                          tree->floats + block, tree->float_boxes + block);
        return;
    }
    const uint32_t *corner[3];
    corners_of(tree, kind, slot, corner);
    kernels->box_unite(wide->point_boxes, corner, count, wide->is_swept,
                       tree->floats + block, tree->float_boxes + block);
}

static void keep_most(atomic_uint *most, uint32_t value)
{
    uint32_t others = atomic_load_explicit(most, memory_order_relaxed);
    while (others < value &&
           !atomic_compare_exchange_weak_explicit(
               most, &others, value, memory_order_relaxed, memory_order_relaxed)) {
    }
}

/* Vertices in whole numbers: of floats that do not leave the first cache. */
static void quantised_points(struct eng_wide *wide, const struct eng_scene *scene,
                             uint32_t block, uint32_t count)
{
    struct eng_wide_tree *tree = &wide->trees[PCCD_TREE_VERTICES];
    struct eng_extents points[FLOAT_BLOCKS * ENG_WIDE];
    struct eng_wide_block floats[FLOAT_BLOCKS];
    struct eng_extents around[FLOAT_BLOCKS];
    uint32_t farthest = 0;
    uint32_t end = block + count;
    for (uint32_t i = block; i < end; i += FLOAT_BLOCKS) {
        uint32_t part = smaller(FLOAT_BLOCKS, end - i);
        refit_points(wide, scene, i * ENG_WIDE, (i + part) * ENG_WIDE, points);
        wide->kernels->box_fold(points, part, false, floats, around);
        bool fits = wide->kernels->quantised_blocks(
            floats, around, part, &wide->quantising,
            &(struct eng_quantised_to){tree->quantised + i, tree->quantised_boxes + i,
                                       &farthest});
        assert(fits); /* eng_wide_quantised_choose */
        (void)fits;
    }
    keep_most(&wide->farthest, farthest);
}

static void refit_blocks(struct eng_wide *wide, const struct eng_scene *scene,
                         enum pccd_tree kind, uint32_t block, uint32_t end)
{
    const uint32_t count = end - block;
    uint32_t slot = block * ENG_WIDE;
    bool is_quantised = wide->has_quantised && !wide->is_swept;
    if (kind == PCCD_TREE_VERTICES && is_quantised) {
        quantised_points(wide, scene, block, count);
    } else if (kind == PCCD_TREE_VERTICES) {
        refit_points(wide, scene, slot, slot + count * ENG_WIDE,
                     wide->point_boxes + slot);
        box_features(wide, kind, block, count);
    } else if (!is_quantised) {
        box_features(wide, kind, block, count);
    } else {
        const struct eng_wide_tree *tree = &wide->trees[kind];
        const uint32_t *corner[3];
        corners_of(tree, kind, slot, corner);
        wide->kernels->quantised_unite(wide->trees[PCCD_TREE_VERTICES].quantised, corner,
                                       count, tree->quantised + block,
                                       tree->quantised_boxes + block);
    }
}

/* Return whether nothing asks for boxes of a block: it is of an object that turns. The
 * last one of vertices has the slot that is nobody's, too, which others ask for. */
static bool is_left_out(const struct eng_wide *wide, const struct eng_scene *scene,
                        enum pccd_tree kind, uint32_t block)
{
    bool is_last = block + 1 == wide->trees[kind].block_count[0];
    return !(is_last && kind == PCCD_TREE_VERTICES) &&
           eng_wide_owners_is_apart(&eng_wide_state_of(scene)->owners, kind, block);
}

/* Blocks first .. end - 1; those that are left out are nowhere, so that nodes above them
 * are around the others. */
static void refit_others(struct eng_wide *wide, const struct eng_scene *scene,
                         enum pccd_tree kind, uint32_t first, uint32_t end)
{
    while (first < end) {
        bool leaves_out = is_left_out(wide, scene, kind, first);
        uint32_t next = first + 1;
        while (next < end && is_left_out(wide, scene, kind, next) == leaves_out) {
            next++;
        }
        if (leaves_out) {
            eng_wide_put_nowhere(&wide->trees[kind], first, next,
                                 !wide->has_quantised || wide->is_swept);
        } else {
            refit_blocks(wide, scene, kind, first, next);
        }
        first = next;
    }
}

/* The next blocks, *first .. *end - 1, in which something moves, from *end on; false:
 * there are no more below `limit`. */
static bool next_moving(const uint16_t *moving, uint32_t limit, uint32_t *first,
                        uint32_t *end)
{
    uint32_t block = *end;
    while (block < limit && moving[block] == 0) {
        block++;
    }
    *first = block;
    while (block < limit && moving[block] != 0) {
        block++;
    }
    *end = block;
    return *first < block;
}

/* A node of boxes in whole numbers, whose halves change places, and the box around it. */
static void fold_numbers(const struct eng_quantised_box below[ENG_WIDE],
                         struct eng_quantised_block *block,
                         struct eng_quantised_box *around)
{
    /* One end: a larger vector would be compared number by number. */
    typedef int16_t numbers __attribute__((vector_size(sizeof around->half[0])));
    numbers most[2];
    memcpy(most, &below[0], sizeof most);
    for (uint32_t i = 0; i < ENG_WIDE; i++) {
#pragma GCC unroll 2
        for (uint32_t end = 0; end < 2; end++) {
            numbers box;
            memcpy(&box, below[i].half[end], sizeof box);
            numbers is_larger = box > most[end];
            most[end] = (box & is_larger) | (most[end] & ~is_larger);
#pragma GCC unroll 3
            for (uint32_t k = 0; k < 3; k++) {
                uint32_t both;
                memcpy(&both, &below[i].half[end][2 * k], sizeof both);
                block->row[end][k][i] = both << 16 | both >> 16;
            }
        }
    }
    memcpy(around, most, sizeof *around);
}

/* Blocks first .. end - 1 of a level from 1 on. */
static void fold(const struct eng_wide *wide, const struct eng_wide_tree *tree,
                 uint32_t level, uint32_t first, uint32_t end)
{
    const struct eng_quantised_box *below =
        tree->quantised_boxes + tree->first[level - 1] + first * ENG_WIDE;
    if (!wide->has_quantised || wide->is_swept) {
        wide->kernels->box_fold(eng_wide_boxes(tree, level - 1) + first * ENG_WIDE,
                                end - first, wide->is_swept,
                                eng_wide_blocks(tree, level) + first,
                                eng_wide_boxes(tree, level) + first);
        return;
    }
    for (uint32_t i = tree->first[level] + first; i < tree->first[level] + end; i++) {
        fold_numbers(below, &tree->quantised[i], &tree->quantised_boxes[i]);
        below += ENG_WIDE;
    }
}

void eng_wide_refit_chunk(struct eng_wide *wide, const struct eng_scene *scene,
                          enum pccd_tree kind, uint32_t chunk)
{
    struct eng_wide_tree *tree = &wide->trees[kind];
    uint32_t block = chunk * ENG_WIDE_CHUNK_BLOCKS;
    uint32_t count = smaller(ENG_WIDE_CHUNK_BLOCKS, tree->block_count[0] - block);
    bool moves = !wide->has_moving || eng_wide_still_mark_chunk(wide, kind, chunk);
    void (*refit)(struct eng_wide *, const struct eng_scene *, enum pccd_tree,
                  uint32_t first, uint32_t end) =
        wide->lacks_apart ? refit_others : refit_blocks;
    if (wide->keeps) {
        if (!moves) {
            return;
        }
        uint32_t first, end = block;
        while (next_moving(tree->moving, block + count, &first, &end)) {
            refit(wide, scene, kind, first, end);
        }
    } else {
        refit(wide, scene, kind, block, block + count);
    }
    if (wide->level_count > 1) {
        uint32_t node = chunk * ENG_WIDE_CHUNK_NODES;
        fold(wide, tree, 1, node,
             smaller(node + ENG_WIDE_CHUNK_NODES, tree->block_count[1]));
    }
}

/* All of them, or those in which something moves. */
static void fold_level(const struct eng_wide *wide, enum pccd_tree kind, uint32_t level)
{
    const struct eng_wide_tree *tree = &wide->trees[kind];
    uint32_t count = tree->block_count[level], first, end = 0;
    if (!wide->keeps) {
        fold(wide, tree, level, 0, count);
        return;
    }
    while (next_moving(tree->moving + tree->first[level], count, &first, &end)) {
        fold(wide, tree, level, first, end);
    }
}

void eng_wide_refit_above(struct eng_wide *wide)
{
    wide->boxes_are_old = false;
    wide->boxes_of = wide->is_swept ? 0 : wide->refit_of;
    if (wide->has_moving) {
        eng_wide_still_mark_above(wide);
    }
    for (enum pccd_tree kind = 0; kind < ENG_WIDE_TREES; kind++) {
        for (uint32_t level = 2; level < wide->level_count; level++) {
            fold_level(wide, kind, level);
        }
    }
    const struct eng_wide_tree *vertices = &wide->trees[PCCD_TREE_VERTICES];
    uint32_t top = wide->level_count - 1;
    if (wide->is_swept) { /* one end is that of both, and the other one not written */
        const struct eng_extents *box = eng_wide_boxes(vertices, top);
        for (uint32_t side = 0; side < ENG_SIDES; side++) {
            memcpy(wide->around.side[side], box->side[side & ~1u], sizeof box->side[0]);
        }
    } else {
        wide->around = eng_wide_box(wide, vertices, top, 0);
    }
}
