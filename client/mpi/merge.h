/* merge.h - closest features that several ranks have found.
 *
 * Threads: one.
 *
 * A pair is found by the rank that owns its first feature. The closest features of the
 * pair may begin with another one: an end of its second edge, say.
 */
#ifndef RANKS_MERGE_H
#define RANKS_MERGE_H

#include "world.h"

/* Collective: world->strays of all ranks, to the records of those that own them. */
int ranks_merge(struct pccd_mpi *world);

#endif
