/* refit.h - updates every box of the trees to the new positions, from the leaves up.
 *
 * Threads: [compute], [team] where it says so.
 * Source: paper section 6.1.
 */
#ifndef ENG_REFIT_H
#define ENG_REFIT_H

#include "refit_box.h"
#include "refit_plan.h"
#include "team.h"

/* Boxes from x[1 - now] (t = 0), x[now] (t = 1): vertices from positions; edges from
 * vertices; nodes from vertices or their children, the last of the range first. [any] */
void eng_refit_vertices(struct eng_scene *scene, struct eng_range range);
void eng_refit_edges(struct eng_scene *scene, struct eng_range range);
void eng_refit_nodes(struct eng_scene *scene, struct eng_range range);

/* The nodes of a subtree, which may hold nodes above objects. [any] */
void eng_refit_subtree(struct eng_scene *scene, uint32_t root);

/* All boxes of one object; of all objects and the tree over them. By one thread. */
void eng_refit_object(struct eng_scene *scene, const struct eng_object *object);
void eng_refit(struct eng_scene *scene);

/* eng_refit, or eng_still_refit in a step that marks what moves (refit_still.h), by all
 * threads of the region, each of which calls it, as the plan says. True
 * for the one thread that ended last, and sees every box (team.h says how it lets the
 * others go on). A thread that comes late holds nobody up: there is no barrier, work is
 * taken on demand. [team] */
bool eng_refit_by_team(struct eng_team *team, struct eng_worker *worker,
                       struct eng_refit_plan *plan);

#endif
