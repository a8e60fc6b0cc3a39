/* daemon/engine/tree/rebuild.h - selective, lazy reconstruction.
 *
 * Room:     engine. May include: world.h, worker.h.
 * Does:     look at the nodes below the one that a traversal is about to open, and build
 *           anew what has become poor; the same for the tree over the objects, after the
 *           refit.
 * Does not: rebuild what is too large for one go (aside.h).
 * Threads:  [team] where it says so.
 * Source:   paper sections 6.2 (selective, lazy reconstruction) and 5.1 (lock); metric.h.
 *
 * Regions. A region is a largest subtree of an object with at most
 * settings.rebuild_triangles_max triangles: every node is in one region, or is a high
 * node above them. A reconstruction stays inside a region: a subtree of n triangles keeps
 * its 2n - 1 nodes, its root and its box.
 *
 * The gate. Whoever needs the children of a region's root calls eng_node_open first. The
 * first to do so in a step examines the region and reconstructs what is poor; who comes
 * meanwhile waits; after that the region stays as it is until the step's end. This is the
 * lock of section 5.1, with the advantage that it is taken once a step for each region
 * that is touched at all.
 *
 * Why nobody sees a region change: pairs and task units name a node only after its
 * parent was opened, so a node below a region's root is named only after its root was
 * opened in this step, whatever scheduler and thread named it and however it was handed
 * on: hand-over orders memory. The root itself may be in use in other threads meanwhile,
 * so no byte of it is written: where it is rebuilt, its children keep their sizes and so
 * their places, and its box, the union of the same leaves, stays.
 *
 * A step that is stopped ends no reconstruction half-way: who has taken a gate finishes
 * the region first, at most rebuild_triangles_max triangles.
 */
#ifndef ENG_REBUILD_H
#define ENG_REBUILD_H

#include "worker.h"

/* Subtrees with fewer triangles are not looked at: what they could save is less than
 * looking costs (bench/rebuild.c). */
#define ENG_EXAMINE_MIN 16u

/* What the gate of a region says when its examination in this step has ended; one less
 * while it is going on; anything else before. Step numbers go round after 2^31 steps: a
 * region not touched for as long is taken as examined, which harms nothing. */
static inline uint32_t eng_gate_ready(const struct eng_scene *scene)
{
    return 2 * scene->step + 1;
}

/* Slow path of eng_node_open. [team] */
void eng_region_enter(struct eng_worker *worker, uint32_t root);

/* The node, whose children may be looked at now. [team] */
static inline const struct eng_node *eng_node_open(struct eng_worker *worker,
                                                   uint32_t node_idx)
{
    const struct eng_scene *scene = worker->scene;
    const struct eng_node *node = &scene->nodes[node_idx];
    /* Acquire: pairs with the release of whoever examined the region. */
    if (node->gate != ENG_GATE_NONE &&
        atomic_load_explicit(&scene->upkeep[node_idx].gate, memory_order_acquire) !=
            eng_gate_ready(scene)) {
        eng_region_enter(worker, node_idx);
    }
    return node;
}

/* Find the regions of a subtree that was built; `nodes`: all of its nodes. */
void eng_regions_mark(struct eng_scene *scene, struct eng_range nodes);

/* Note the metric of these nodes, whole subtrees with up-to-date boxes, as that of a
 * fresh hierarchy. */
void eng_rebuild_note(struct eng_scene *scene, struct eng_range nodes);

/* Put right what is poor in the tree over the objects. After the refit, before anybody
 * looks at the tree; by one thread. [team] */
void eng_rebuild_top(struct eng_worker *worker);

#endif
