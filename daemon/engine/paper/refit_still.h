/* refit_still.h - the refit of a step in which most stands still.
 *
 * Mark what moves (moving.h) in the trees while their boxes are made, so that pairs of
 * nodes or features of which neither moves can be left out; keep boxes of the last step
 * where nothing moves.
 *
 * Threads: as marked.
 *
 * A record moves if `moved` in it is the mark of this step: a vertex that moves, an edge
 * or a triangle with such a vertex, a node above such a triangle. Each step that marks
 * has a mark of its own, so that nobody needs to take marks away: of an object that
 * stands nothing is looked at.
 */
#ifndef ENG_REFIT_STILL_H
#define ENG_REFIT_STILL_H

#include "trees.h"

/* The positions have moved on and `keeps` says whether boxes of the last step are those
 * of what stands: get ready to mark what moves. `prunes`: marks are wanted without that,
 * too. All boxes are those of this step from its refit on. [compute] */
void eng_still_begin(struct eng_scene *scene, bool keeps, bool prunes);

/* In a step that marks. Each returns the features whose boxes were kept.
 *
 * All boxes, by one thread. */
uint64_t eng_still_refit(struct eng_scene *scene);

/* Those of a range of vertices or edges, of as many objects as there are in it; when all
 * vertices are done, the nodes of a subtree, which may hold nodes above objects.
 * [team] */
uint64_t eng_still_refit_vertices(struct eng_scene *scene, struct eng_range range);
uint64_t eng_still_refit_edges(struct eng_scene *scene, struct eng_range range);
uint64_t eng_still_refit_subtree(struct eng_scene *scene, uint32_t root);

/* In any step: nodes that have other children than in the last step, which are up to
 * date; of a range the last first. [team] */
void eng_still_refit_anew(struct eng_scene *scene, struct eng_range nodes);

#endif
