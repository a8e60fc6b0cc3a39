/* daemon/engine/wide/wide_refit.c - the boxes of the trees of the method `wide`.
 *
 * Room:     engine.
 * Does:     copy the positions to the slots, let the kernels make boxes of them.
 * Threads:  wide.h.
 */
#include <string.h>

#include "wide.h"
#include "world.h"

void eng_wide_refit_vertices(struct eng_wide *wide, const struct eng_scene *scene,
                             uint32_t first, uint32_t count, bool swept)
{
    const struct eng_kernels *kernels = wide->kernels;
    const double(*x0)[3] = (const double(*)[3])scene->x[1 - scene->now];
    const double(*x1)[3] = (const double(*)[3])scene->x[scene->now];
    struct eng_wide_tree *tree = &wide->trees[ENG_WIDE_VERTICES];
    uint32_t end = first + count;
    for (uint32_t slot = first; slot < end;) {
        uint32_t run = slot; /* of vertices without a gap */
        for (; slot < end && wide->points[slot].word0 != ENG_WIDE_NOBODY; slot++) {
            struct eng_point *point = &wide->points[slot];
            memcpy(point->x0, x0[point->word0], sizeof point->x0);
            memcpy(point->x1, x1[point->word0], sizeof point->x1);
        }
        kernels->box_points(wide->points + run, slot - run, swept,
                            wide->point_boxes + run);
        for (; slot < end && wide->points[slot].word0 == ENG_WIDE_NOBODY; slot++) {
        }
    }
    uint32_t block = first / ENG_WIDE;
    kernels->box_fold(wide->point_boxes + first, count / ENG_WIDE, tree->blocks + block,
                      tree->boxes + block);
}

void eng_wide_refit_features(struct eng_wide *wide, enum eng_wide_kind kind,
                             uint32_t first, uint32_t count)
{
    struct eng_wide_tree *tree = &wide->trees[kind];
    const uint32_t *const corner[3] = {tree->corner[0] + first, tree->corner[1] + first,
                                       tree->corner[2] ? tree->corner[2] + first : NULL};
    uint32_t block = first / ENG_WIDE;
    wide->kernels->box_unite(wide->point_boxes, corner, count / ENG_WIDE,
                             tree->blocks + block, tree->boxes + block);
}

void eng_wide_refit_levels(struct eng_wide *wide, enum eng_wide_kind kind, uint32_t level)
{
    struct eng_wide_tree *tree = &wide->trees[kind];
    for (; level < wide->level_count; level++) {
        wide->kernels->box_fold(eng_wide_boxes(tree, level - 1), tree->block_count[level],
                                eng_wide_blocks(tree, level),
                                eng_wide_boxes(tree, level));
    }
}

void eng_wide_refit(struct eng_wide *wide, const struct eng_scene *scene, bool swept)
{
    eng_wide_refit_vertices(wide, scene, 0, wide->trees[ENG_WIDE_VERTICES].slot_count,
                            swept);
    for (enum eng_wide_kind kind = 0; kind < ENG_WIDE_KINDS; kind++) {
        if (kind != ENG_WIDE_VERTICES) {
            eng_wide_refit_features(wide, kind, 0, wide->trees[kind].slot_count);
        }
        eng_wide_refit_levels(wide, kind, 1);
    }
}
