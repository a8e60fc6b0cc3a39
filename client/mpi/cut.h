/* cut.h - which rank computes for which leaves.
 *
 * Threads: one.
 */
#ifndef RANKS_CUT_H
#define RANKS_CUT_H

#include "world.h"

/* Collective: deal out the leaves by where their given vertices are (object->x), and by
 * their weights (weigh.h), which are of no use then. Afterwards there are no ghosts. */
int ranks_cut(struct pccd_mpi *world);

#endif
