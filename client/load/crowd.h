/* crowd.h - a process that simulates many clients in turn.
 *
 * Threads: one in each process.
 */
#ifndef LOAD_CROWD_H
#define LOAD_CROWD_H

#include <sys/types.h>

#include "load.h"

/* Returns its process id, or -1. It exits with 0 unless it could not do its part. It dies
 * with its parent. */
pid_t load_crowd_start(struct load *load, uint32_t index);

/* Every client, and those that will be killed, alone for one round, in a process of its
 * own, as the engine may be in it (direct:) and its threads do not outlive a fork. Sets
 * truth and truth_records of what is shared. False: it did not work. */
bool load_crowd_find_truth(struct load *load);

#endif
