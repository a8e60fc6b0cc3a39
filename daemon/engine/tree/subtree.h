/* daemon/engine/tree/subtree.h - which nodes are below which.
 *
 * Room:     engine. May include: world.h.
 * Does:     compare places in the pre-order of the nodes: a subtree of an object with n
 *           triangles is the 2 n - 1 nodes that follow each other; of a subtree of the
 *           tree over the objects, the nodes above objects follow each other.
 * Threads:  [any].
 */
#ifndef ENG_SUBTREE_H
#define ENG_SUBTREE_H

#include "world.h"

/* All nodes of the subtree of a node that belongs to an object. */
static inline struct eng_range eng_subtree_in_object(const struct eng_scene *scene,
                                                     uint32_t root)
{
    return (struct eng_range){root, 2 * scene->nodes[root].count - 1};
}

/* The nodes above objects in the subtree of one of them. */
struct eng_range eng_subtree_above_objects(const struct eng_scene *scene, uint32_t root);

/* Is `node` in the subtree of `root`, or `root` itself? O(objects below root). */
bool eng_node_is_below(const struct eng_scene *scene, uint32_t root, uint32_t node);

#endif
