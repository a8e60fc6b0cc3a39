/* subtree.h - tells which nodes lie below a node, by their places in pre-order.
 *
 * Compare places in the pre-order of the nodes. A subtree of an object with n triangles
 * is 2 n - 1 consecutive nodes; in a subtree of the tree over the objects, the nodes
 * above objects are consecutive.
 */
#ifndef ENG_SUBTREE_H
#define ENG_SUBTREE_H

#include "trees.h"

/* All nodes of the subtree of a node that belongs to an object. */
static inline struct eng_range eng_subtree_in_object(const struct eng_scene *scene,
                                                     uint32_t root)
{
    const struct eng_trees *trees = eng_trees_of(scene);
    return (struct eng_range){root, 2 * trees->nodes[root].count - 1};
}

/* The nodes above objects in the subtree of one of them. */
struct eng_range eng_subtree_above_objects(const struct eng_scene *scene, uint32_t root);

/* Is `node` in the subtree of `root`, or `root` itself? O(objects below root). */
bool eng_node_is_below(const struct eng_scene *scene, uint32_t root, uint32_t node);

#endif
