/* subtree.c - which nodes are below which. */
#include "subtree.h"

#include <assert.h>

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

/* Is `node` in the object whose root is `root`? No, if `root` is none. */
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
