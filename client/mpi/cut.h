/* cut.h - which rank computes for which leaves.
 *
 * Room:     client/mpi. May include: world.h.
 * Does:     order the leaves of all objects along a curve and cut it into pieces of equal
 *           weight, one for each rank.
 * Threads:  one.
 */
#ifndef RANKS_CUT_H
#define RANKS_CUT_H

#include "world.h"

/* Collective: deal out the leaves by where their given vertices are (object->x), and by
 * their weights (weigh.h), which are of no use then. Afterwards there are no ghosts. */
int ranks_cut(struct pccd_mpi *world);

#endif
