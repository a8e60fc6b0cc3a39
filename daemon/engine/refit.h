/* daemon/engine/refit.h - bottom-up update of every box.
 *
 * Room:     engine. May include: world.h.
 * Does:     make every box of vertices, edges and nodes contain what it stands for at t = 0
 *           and at t = 1.
 * Does not: change the shape of a tree (build.h) or allocate.
 * Threads:  [compute].
 * Source:   paper section 6.1.
 */
#ifndef ENG_REFIT_H
#define ENG_REFIT_H

#include "world.h"

/* Boxes of one object's vertices, edges and nodes from x[1 - now] (t = 0), x[now] (t = 1). */
void eng_refit_object(struct eng_scene *scene, const struct eng_object *object);

/* All objects, then the tree over them. */
void eng_refit(struct eng_scene *scene);

#endif
