/* rebuild.h - rebuilds a small subtree that has become poor, when a traversal is about to
 * enter it (selective, lazy reconstruction).
 *
 * Examine the nodes below the one that a traversal is about to open, and rebuild those
 * that have become poor; the same for the tree over the objects, after the refit.
 *
 * Threads: [team] where it says so.
 * Source: paper sections 6.2 (selective, lazy reconstruction) and 5.1 (lock).
 *
 * Regions. A region is a largest subtree of an object with at most
 * settings.region_triangles triangles: every node is in one region, or is a high node
 * above them. A reconstruction stays inside a region: it puts the triangles of a subtree
 * in other leaves, and every node keeps its place, its children and its count (grow.h).
 *
 * The gate. A thread that needs the children of a region's root calls eng_node_open
 * first. The first one to do so in a step examines the region and rebuilds what is poor;
 * a thread that comes meanwhile waits. After that the region stays as it is until the end
 * of the step. This is the lock of section 5.1, but taken only once a step for each
 * region that is touched at all.
 *
 * Why nobody sees a region change: pairs and task units name a node only after its parent
 * was opened. So a node below a region's root is named only after its root was opened in
 * this step, whichever scheduler and thread named it; handing it on orders memory. Other
 * threads may be using the root itself, so none of its bytes is written: its children
 * keep their sizes and so their places, and its box, the union of the same leaves, stays.
 *
 * A step that is stopped leaves no reconstruction half done: the thread that holds a gate
 * finishes the region first, at most region_triangles triangles.
 */
#ifndef ENG_REBUILD_H
#define ENG_REBUILD_H

#include "trees.h"
#include "worker.h"

/* Subtrees with fewer triangles are not looked at: what they could save is less than
 * looking costs (`bench/tables.sh rebuild`). */
#define ENG_EXAMINE_MIN 16u

/* ---- the metric -------------------------------------------------------------------- */

/* The quality of a node (Larsson and Akenine-Moeller 2006): poor, if its children overlap
 * much. A moving box has a volume at each end of the step; they are added. Boxes of a
 * flat sheet have none: where one of the three is zero, half of the surface takes its
 * place. */
struct eng_extent {
    double volume; /* 1e54 at most */
    double area;   /* of half the surface */
};

static inline struct eng_extent eng_extent_of(const struct eng_box *box)
{
    eng_f4 size0 = eng_bounds(box, 1) - eng_bounds(box, 0);
    eng_f4 size1 = eng_bounds(box, 3) - eng_bounds(box, 2);
    double x0 = (double)size0[0];
    double y0 = (double)size0[1];
    double z0 = (double)size0[2];
    double x1 = (double)size1[0];
    double y1 = (double)size1[1];
    double z1 = (double)size1[2];
    return (struct eng_extent){x0 * y0 * z0 + x1 * y1 * z1,
                               x0 * y0 + y0 * z0 + z0 * x0 + x1 * y1 + y1 * z1 + z1 * x1};
}

/* Return the ratio for an inner node; 1 if it is a point. Children that overlap much make
 * it small. */
static inline float eng_metric(const struct eng_node *nodes, const struct eng_node *node)
{
    struct eng_extent whole = eng_extent_of(eng_box_of_const(node));
    struct eng_extent left = eng_extent_of(eng_box_of_const(&nodes[node->left]));
    struct eng_extent right = eng_extent_of(eng_box_of_const(&nodes[node->right]));
    if (whole.volume > 0 && left.volume > 0 && right.volume > 0) {
        return (float)(whole.volume / (left.volume + right.volume));
    }
    double parts = left.area + right.area;
    return parts > 0 ? (float)(whole.area / parts) : 1.0f;
}

/* Return whether it is worth building anew: less than `threshold`, and less than that
 * times what it was when it was built: children that overlap by nature do so again. */
static inline bool eng_metric_is_poor(float ratio, float built_ratio, float threshold)
{
    return ratio < threshold && ratio < threshold * built_ratio;
}

/* ---- the gates --------------------------------------------------------------------- */

/* Return what the gate of a region says when its examination in this step has ended; one
 * less while it is going on; anything else before. Step numbers go round after 2^31
 * steps: a region not touched for as long is taken as examined, which harms nothing. */
static inline uint32_t eng_gate_ready(const struct eng_scene *scene)
{
    return 2 * scene->step + 1;
}

/* Examine a region, or wait until another thread has: the slow path of eng_node_open.
 * [team] */
void eng_region_enter(struct eng_worker *worker, uint32_t root);

/* Return the node, whose children may be looked at now. [team] */
static inline const struct eng_node *eng_node_open(struct eng_worker *worker,
                                                   uint32_t node_idx)
{
    const struct eng_scene *scene = worker->scene;
    struct eng_trees *trees = eng_trees_of(scene);
    const struct eng_node *node = &trees->nodes[node_idx];
    if (eng_asks_near(worker->question)) {
        return node; /* nothing is rebuilt for what is asked about a moment */
    }
    /* Acquire: pairs with the release of whoever examined the region. */
    if (node->gate != ENG_GATE_NONE &&
        atomic_load_explicit(&trees->upkeep[node_idx].gate, memory_order_acquire) !=
            eng_gate_ready(scene)) {
        eng_region_enter(worker, node_idx);
    }
    return node;
}

/* Find the regions of a subtree that was built; `nodes`: all of its nodes. */
void eng_regions_mark(struct eng_scene *scene, struct eng_range nodes);

/* Note the metric of these nodes, whole subtrees with up-to-date boxes, as that of a
 * fresh hierarchy. */
void eng_metric_note_built(struct eng_scene *scene, struct eng_range nodes);

/* Put right what is poor in the tree over the objects. After the refit, before anybody
 * looks at the tree; by one thread. [team] */
void eng_rebuild_top(struct eng_worker *worker);

#endif
