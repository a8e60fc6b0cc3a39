/* ghosts.h - which leaves of others a rank has to know, and how long that stays right.
 *
 * A pair is found by the rank that owns its first feature, so that rank needs a leaf
 * with the second one. If the two features come together, so do the boxes of all leaves
 * that have them, at that time. So it suffices that each leaf goes to each rank of which
 * a block, some leaves one behind the other on the curve, meets it. A box is larger than
 * the leaf by what that reaches beyond itself, and then by some more. Where vertices go
 * on as they went it moves with them, else it stands around the whole step. So
 * ghosts are right for later steps, too, until a vertex leaves the box that was made for
 * it, or boxes have moved for long enough.
 *
 * Mode `pairs` asks which boxes of the whole step meet: once it was used, boxes that move
 * are those.
 */
#ifndef RANKS_GHOSTS_H
#define RANKS_GHOSTS_H

#include "world.h"

/* ---- How much margin boxes leave around what moves, so that ghosts stay right for
 * some steps. */

/* Choose more or less margin than the last time, before ghosts are chosen. has_missed: a
 * vertex has left the box that was made for it then, or that was long ago. In this rank
 * alone; the same in all. */
void ranks_margins_choose(struct pccd_mpi *world, bool has_missed);
/* Collective. Find object->margin of each, and world->lasts, for a step from object->from
 * to object->to; x: where it begins, of local vertices. is_still: all stands where the
 * last step ended. */
int ranks_margins_find(struct pccd_mpi *world, bool is_still, double (*const *x)[3]);
/* Collective. Note what a choice of ghosts took, after it, and how many ghosts all
 * have. */
int ranks_margins_learn(struct pccd_mpi *world);

/* Collective. Choose ghosts for a step from object->from to object->to and a separation;
 * afterwards world->is_covered, object->cover and the plan are right. is_still: all
 * stands where the last step ended. has_missed: a vertex has left the box that was made
 * for it the last time. */
int ranks_ghosts_choose(struct pccd_mpi *world, double separation, bool is_still,
                        bool has_missed);
/* Collective. Give libpccd the ghosts that were chosen, and own leaves, where it has
 * others. */
int ranks_ghosts_build(struct pccd_mpi *world);

/* Set misses[] of each object, in this rank alone, if its given vertices would leave
 * their boxes in the step from object->from to object->to, else clear it. from, to: how
 * many steps have been made there since ghosts were chosen. No box says where a vertex
 * was before that. */
void ranks_ghosts_look(const struct pccd_mpi *world, double from, double to,
                       uint8_t *misses);

/* ---- Leaves of other ranks that few edges join to a rank's own.
 *
 * A pair loses its thickness if at most n = rest_rings edges lead from a vertex of one
 * feature to a vertex of the other. libpccd walks over the edges of its own mesh, so the
 * rank that owns the first feature needs all edges that a walk of n edges from it can
 * take: those at vertices that are at most n - 1 edges away. */

/* Collective. Find object->neighbours, for as many rings as the object has now, unless
 * they are there. */
int ranks_neighbours_find(struct pccd_mpi *world, struct ranks_object *object);

#endif
