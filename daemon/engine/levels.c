/* levels.c - the boxes of one level of a scene's hierarchies. */
#include "step.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "aabb.h"
#include "trees.h"
#include "wide.h"
#include "wide_cells.h"

/* Copy bounds kept as distances outward: minus the lower bound, plus the upper. */
static void copy_extents(const struct eng_extents *from, struct pccd_box *to)
{
    for (uint32_t axis = 0; axis < 3; axis++) {
        to->low0[axis] = -from->side[ENG_LOW0][axis];
        to->high0[axis] = from->side[ENG_HIGH0][axis];
        to->low1[axis] = -from->side[ENG_LOW1][axis];
        to->high1[axis] = from->side[ENG_HIGH1][axis];
    }
}

/* ---- out of frames ----------------------------------------------------------------- */

static const struct pccd_box nothing = {{INFINITY, INFINITY, INFINITY},
                                        {-INFINITY, -INFINITY, -INFINITY},
                                        {INFINITY, INFINITY, INFINITY},
                                        {-INFINITY, -INFINITY, -INFINITY}};

/* The bounds of one end, measured in a frame, as coordinates: rounded outward. */
static void unite_end(const float low[3], const float high[3],
                      const struct eng_box_frame *frame, int end, float to_low[3],
                      float to_high[3])
{
    for (int axis = 0; axis < 3; axis++) {
        double origin = frame->origin[4 * end + axis];
        double bounds[2] = {(double)low[axis] / frame->scale,
                            (double)high[axis] / frame->scale};
        float outward[2] = {
            eng_round_down_sum(bounds[0] + origin,
                               eng_rest_of_difference(bounds[0], -origin)),
            eng_round_up_sum(bounds[1] + origin,
                             eng_rest_of_difference(bounds[1], -origin))};
        to_low[axis] = outward[0] < to_low[axis] ? outward[0] : to_low[axis];
        to_high[axis] = outward[1] > to_high[axis] ? outward[1] : to_high[axis];
    }
}

/* Widen `to` by a box of an object. */
static void unite(const struct pccd_box *box, const struct eng_box_frame *frame,
                  struct pccd_box *to)
{
    unite_end(box->low0, box->high0, frame, 0, to->low0, to->high0);
    unite_end(box->low1, box->high1, frame, 1, to->low1, to->high1);
}

/* ---- the method wide --------------------------------------------------------------- */

/* The frame of the object whose features are in a block of level 0; NULL: nobody's. */
static const struct eng_box_frame *frame_of_block(const struct eng_scene *scene,
                                                  enum pccd_tree kind, uint32_t block)
{
    const struct eng_wide *wide = eng_wide_of(scene);
    const struct eng_wide_tree *tree = &wide->trees[kind];
    uint32_t slot = block * ENG_WIDE;
    if (kind != PCCD_TREE_VERTICES) {
        slot = tree->corner[0][slot];
    }
    uint64_t owner = wide->points[slot].word0;
    return owner == ENG_WIDE_NOBODY ? NULL : &scene->objects[owner >> 32].frame;
}

/* Return the box of what is below a block of a level, object by object: they may have
 * different frames. */
static struct pccd_box out_of_frames(const struct eng_scene *scene, enum pccd_tree kind,
                                     uint32_t level, uint32_t block)
{
    const struct eng_wide_tree *tree = &eng_wide_of(scene)->trees[kind];
    struct pccd_box all = nothing;
    uint64_t first = (uint64_t)block << level * ENG_WIDE_BITS;
    uint64_t end = (uint64_t)(block + 1) << level * ENG_WIDE_BITS;
    for (uint64_t i = first; i < end && i < tree->block_count[0]; i++) {
        const struct eng_box_frame *frame = frame_of_block(scene, kind, (uint32_t)i);
        if (frame) {
            struct pccd_box box;
            struct eng_extents around =
                eng_wide_box(eng_wide_of(scene), tree, 0, (uint32_t)i);
            copy_extents(&around, &box);
            unite(&box, frame, &all);
        }
    }
    return all;
}

static uint32_t wide_boxes(const struct eng_scene *scene, enum pccd_tree kind,
                           uint32_t level, uint32_t first, uint32_t count,
                           struct pccd_box *to)
{
    const struct eng_wide *wide = eng_wide_of(scene);
    const struct eng_wide_tree *tree = &wide->trees[kind];
    /* Trees may be put together by a step that makes no boxes, if all objects turn. */
    if (level >= wide->level_count || wide->boxes_are_old || wide->boxes_of == 0 ||
        (wide->frames > 0 && wide->frames != scene->framing.number)) {
        return 0;
    }
    uint32_t below = wide->level_count - 1 - level; /* there the lowest is level 0 */
    uint32_t boxes = tree->block_count[below];
    for (uint32_t i = 0; i < count && first + i < boxes; i++) {
        if (wide->frames > 0) {
            to[i] = out_of_frames(scene, kind, below, first + i);
        } else {
            struct eng_extents around = eng_wide_box(wide, tree, below, first + i);
            copy_extents(&around, &to[i]);
        }
    }
    return boxes;
}

/* ---- the method paper -------------------------------------------------------------- */

static void copy_node(const struct eng_node *from, struct pccd_box *to)
{
    memcpy(to->low0, from->lo0, sizeof to->low0);
    memcpy(to->high0, from->hi0, sizeof to->high0);
    memcpy(to->low1, from->lo1, sizeof to->low1);
    memcpy(to->high1, from->hi1, sizeof to->high1);
}

/* The same of a node, which may be above several objects. */
static void copy_out_of_frames(const struct eng_scene *scene, uint32_t node,
                               struct pccd_box *to)
{
    struct eng_trees *trees = eng_trees_of(scene);
    uint32_t stack[ENG_LEVELS_MAX + 1] = {node};
    uint32_t waiting = 1;
    *to = nothing;
    while (waiting > 0) {
        uint32_t at = stack[--waiting];
        struct pccd_box box;
        if (trees->upkeep[at].object == ENG_NO_OBJECT) {
            assert(waiting + 2 <= ENG_LEVELS_MAX + 1);
            stack[waiting++] = trees->nodes[at].right;
            stack[waiting++] = trees->nodes[at].left;
            continue;
        }
        copy_node(&trees->nodes[at], &box);
        unite(&box, &scene->objects[trees->upkeep[at].object].frame, to);
    }
}

/* In pre-order; of each level at most one node waits. */
static uint32_t binary_boxes(const struct eng_scene *scene, uint32_t level,
                             uint32_t first, uint32_t count, struct pccd_box *to)
{
    struct eng_trees *trees = eng_trees_of(scene);
    struct {
        uint32_t node, level;
    } stack[ENG_LEVELS_MAX + 1], at = {trees->root, 0};
    uint32_t waiting = 0, boxes = 0;
    if (trees->top_is_stale || trees->boxes_are_old || trees->root == ENG_NO_NODE ||
        level > ENG_LEVELS_MAX ||
        (trees->frames > 0 && trees->frames != scene->framing.number)) {
        return 0;
    }
    for (;;) {
        const struct eng_node *node = &trees->nodes[at.node];
        if (at.level == level) {
            if (boxes >= first && boxes - first < count && trees->frames > 0) {
                copy_out_of_frames(scene, at.node, &to[boxes - first]);
            } else if (boxes >= first && boxes - first < count) {
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

uint32_t eng_level_boxes(const struct eng_scene *scene, enum pccd_tree tree,
                         uint32_t level, uint32_t first, uint32_t count,
                         struct pccd_box *to)
{
    assert(to || count == 0);
    assert(tree < PCCD_TREE_COUNT);
    return tree == PCCD_TREE_TRIANGLES ? binary_boxes(scene, level, first, count, to)
                                       : wide_boxes(scene, tree, level, first, count, to);
}
