/* bounds.h - bounds of vertices: for each, the least distance of the pairs that it is
 * part of.
 *
 * Threads: one.
 *
 * A pair is found by the rank that owns its first feature. A vertex of it may have been
 * given to another rank. So bounds go the way back on which positions came (places.h).
 */
#ifndef RANKS_BOUNDS_H
#define RANKS_BOUNDS_H

#include "world.h"

/* Collective, after a question whose bounds of local vertices are world->records: to
 * world->bounds and world->bound_values, of the objects that were asked for. answer:
 * total, hash and distance_max are written, which all ranks have then. */
int ranks_bounds_make(struct pccd_mpi *world, const struct pccd_near_settings *near,
                      struct pccd_answer *answer);

#endif
