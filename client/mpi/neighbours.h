/* neighbours.h - leaves of other ranks that few edges join to a rank's own.
 *
 * Threads: one.
 *
 * A pair loses its thickness if at most n = rest_rings edges lead from a vertex of one
 * feature to a vertex of the other. libpccd walks over the edges of its own mesh, so the
 * rank that owns the first feature needs all edges that a walk of n edges from it can
 * take: those at vertices that are at most n - 1 edges away.
 */
#ifndef RANKS_NEIGHBOURS_H
#define RANKS_NEIGHBOURS_H

#include "world.h"

/* Collective: object->neighbours, for as many rings as the object has now, unless they
 * are there. */
int ranks_neighbours_find(struct pccd_mpi *world, struct ranks_object *object);

#endif
