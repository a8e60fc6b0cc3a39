/* daemon/engine/tree/refit.h - bottom-up update of every box.
 *
 * Room:     engine. May include: team.h.
 * Does:     make every box of vertices, edges and nodes contain what it stands for at t =
 *           0 and at t = 1.
 * Does not: change the shape of a tree (build.h) or allocate inside a region.
 * Threads:  [compute], [team] where it says so.
 * Source:   paper section 6.1.
 */
#ifndef ENG_REFIT_H
#define ENG_REFIT_H

#include "team.h"

/* How a team divides the objects' trees: nodes[0 .. opened-1] come after the subtrees
 * whose roots are nodes[opened .. count-1], in reverse order; the tree over the objects
 * is last. Memory stays for the next step. */
struct eng_refit_plan {
    uint32_t *nodes; /* breadth-first: parents before children */
    uint32_t opened;
    uint32_t count;
    uint32_t capacity;
};

/* Walk breadth-first from the roots of all objects until there are `wanted` subtrees. The
 * paper takes two for each thread (section 6.1). ENG_E_NOMEM. */
int eng_refit_plan(struct eng_refit_plan *plan, const struct eng_scene *scene,
                   uint32_t wanted);
void eng_refit_plan_deinit(struct eng_refit_plan *plan);

/* Boxes of one object's vertices, edges and nodes from x[1 - now] (t = 0), x[now] (t =
 * 1). */
void eng_refit_object(struct eng_scene *scene, const struct eng_object *object);

/* All objects, then the tree over them, by one thread. */
void eng_refit(struct eng_scene *scene);

/* The same by all threads of the region, each of which calls it. All boxes are up to date
 * when it returns to the first worker; the others need a barrier. [team] */
void eng_refit_by_team(struct eng_team *team, struct eng_worker *worker);

#endif
