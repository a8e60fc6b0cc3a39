/* limit.h - answers that are too long.
 *
 * Threads: one.
 *
 * The limit is of the whole answer, as in one process: the first records in canonical
 * order are kept. Each rank's libpccd keeps as many of its own, so those are among them.
 */
#ifndef RANKS_LIMIT_H
#define RANKS_LIMIT_H

#include "world.h"

/* Collective, where the ranks have more than world->record_limit records together, all
 * of them sorted. */
int ranks_limit_keep(struct pccd_mpi *world);

#endif
