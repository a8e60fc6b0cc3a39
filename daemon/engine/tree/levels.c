/* levels.c - the boxes of a level of a scene's hierarchies, to be looked at.
 *
 * Room:     engine. May include: levels.h, worker.h, world.h.
 * Does:     find the nodes of a level: a range of blocks, or by walking down to it.
 * Does not: see more of a tree than that level and what is above it.
 * Threads:  [compute].
 * Source:   levels.h; wide.h, build.h for the trees.
 */
#include "levels.h"

#include <assert.h>
#include <string.h>

#include "worker.h"
#include "world.h"

/* What is kept as a distance outward: minus the lower bound, plus the upper. */
static void copy_extents(const struct eng_extents *from, struct eng_level_box *to)
{
    for (uint32_t axis = 0; axis < 3; axis++) {
        to->low0[axis] = -from->side[ENG_LOW0][axis];
        to->high0[axis] = from->side[ENG_HIGH0][axis];
        to->low1[axis] = -from->side[ENG_LOW1][axis];
        to->high1[axis] = from->side[ENG_HIGH1][axis];
    }
}

static uint32_t wide_boxes(const struct eng_wide *wide, enum eng_wide_kind kind,
                           uint32_t level, uint32_t first, uint32_t count,
                           struct eng_level_box *to)
{
    const struct eng_wide_tree *tree = &wide->trees[kind];
    if (level >= wide->level_count) {
        return 0;
    }
    uint32_t below = wide->level_count - 1 - level; /* there the lowest is level 0 */
    uint32_t boxes = tree->block_count[below];
    for (uint32_t i = 0; i < count && first + i < boxes; i++) {
        copy_extents(eng_wide_boxes(tree, below) + first + i, &to[i]);
    }
    return boxes;
}

static void copy_node(const struct eng_node *from, struct eng_level_box *to)
{
    memcpy(to->low0, from->lo0, sizeof(to->low0));
    memcpy(to->high0, from->hi0, sizeof(to->high0));
    memcpy(to->low1, from->lo1, sizeof(to->low1));
    memcpy(to->high1, from->hi1, sizeof(to->high1));
}

/* In pre-order; of each level at most one node waits. */
static uint32_t binary_boxes(const struct eng_scene *scene, uint32_t level,
                             uint32_t first, uint32_t count, struct eng_level_box *to)
{
    struct {
        uint32_t node, level;
    } stack[ENG_LEVELS_MAX + 1], at = {scene->root, 0};
    uint32_t waiting = 0, boxes = 0;
    if (scene->top_is_stale || scene->root == ENG_NO_NODE || level > ENG_LEVELS_MAX) {
        return 0;
    }
    for (;;) {
        const struct eng_node *node = &scene->nodes[at.node];
        if (at.level == level) {
            if (boxes >= first && boxes - first < count) {
                copy_node(node, &to[boxes - first]);
            }
            boxes++;
        } else if (node->left != ENG_LEAF) {
            assert(waiting <= ENG_LEVELS_MAX);
            stack[waiting].node = node->right;
            stack[waiting++].level = at.level + 1;
            at.node = node->left;
            at.level++;
            continue;
        }
        if (waiting == 0) {
            return boxes;
        }
        at.node = stack[--waiting].node;
        at.level = stack[waiting].level;
    }
}

uint32_t eng_level_boxes(const struct eng_scene *scene, enum eng_tree tree,
                         uint32_t level, uint32_t first, uint32_t count,
                         struct eng_level_box *to)
{
    static_assert((int)ENG_TREE_VERTICES == (int)ENG_WIDE_VERTICES &&
                      (int)ENG_TREE_EDGES == (int)ENG_WIDE_EDGES &&
                      (int)ENG_TREE_FACES == (int)ENG_WIDE_FACES,
                  "one order");
    assert(tree < ENG_TREES);
    return tree == ENG_TREE_TRIANGLES ? binary_boxes(scene, level, first, count, to)
                                      : wide_boxes(&scene->wide, (enum eng_wide_kind)tree,
                                                   level, first, count, to);
}
