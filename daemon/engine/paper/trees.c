/* trees.c - the binary hierarchies over the triangles of a scene. */
#include "trees.h"

#include <assert.h>
#include <string.h>

#include "memory.h"

void eng_trees_init(struct eng_trees *trees)
{
    memset(trees, 0, sizeof *trees);
    eng_ranges_init(&trees->edge_ranges, PROTO_COUNT_MAX);
    eng_ranges_init(&trees->triangle_ranges, PROTO_COUNT_MAX);
    eng_ranges_init(&trees->node_ranges, UINT32_MAX - 1);
    trees->root = ENG_NO_NODE;
}

void eng_trees_deinit(struct eng_trees *trees)
{
    eng_ranges_deinit(&trees->edge_ranges);
    eng_ranges_deinit(&trees->triangle_ranges);
    eng_ranges_deinit(&trees->node_ranges);
    eng_free(trees->vertices);
    eng_free(trees->edges);
    eng_free(trees->triangles);
    eng_free(trees->nodes);
    eng_free(trees->upkeep);
    eng_free(trees->top_items);
}

uint64_t eng_trees_bytes(const struct eng_trees *trees)
{
    return (uint64_t)trees->box_capacity * sizeof *trees->vertices +
           (uint64_t)trees->edge_capacity * sizeof *trees->edges +
           (uint64_t)trees->triangle_capacity * sizeof *trees->triangles +
           (uint64_t)trees->node_capacity *
               (sizeof *trees->nodes + sizeof *trees->upkeep) +
           (uint64_t)trees->top_item_capacity * sizeof *trees->top_items;
}

struct eng_range eng_subtree_above_objects(const struct eng_scene *scene, uint32_t root)
{
    assert(eng_is_above_objects(scene, root));
    struct eng_trees *trees = eng_trees_of(scene);
    uint32_t last = root; /* in pre-order it lies as far right as it can */
    for (;;) {
        const struct eng_node *node = &trees->nodes[last];
        if (eng_is_above_objects(scene, node->right)) {
            last = node->right;
        } else if (eng_is_above_objects(scene, node->left)) {
            last = node->left;
        } else {
            return (struct eng_range){root, last - root + 1};
        }
    }
}

static bool is_in(uint32_t node, struct eng_range range)
{
    return node >= range.first && node - range.first < range.count;
}

/* Return whether `node` is in the object whose root is `root`. No, if `root` is none. */
static bool is_in_object(const struct eng_scene *scene, uint32_t root, uint32_t node)
{
    return !eng_is_above_objects(scene, root) &&
           is_in(node, eng_subtree_in_object(scene, root));
}

bool eng_node_is_below(const struct eng_scene *scene, uint32_t root, uint32_t node)
{
    const struct eng_trees *trees = eng_trees_of(scene);
    if (!eng_is_above_objects(scene, root)) {
        return is_in_object(scene, root, node);
    }
    struct eng_range range = eng_subtree_above_objects(scene, root);
    bool found = is_in(node, range);
    for (uint32_t i = range.first; i < range.first + range.count && !found; i++) {
        found = is_in_object(scene, trees->nodes[i].left, node) ||
                is_in_object(scene, trees->nodes[i].right, node);
    }
    return found;
}
