/* balance.h - how evenly the work of steps lies on the ranks, and when it is cut anew.
 *
 * Threads: one.
 */
#ifndef RANKS_BALANCE_H
#define RANKS_BALANCE_H

#include "world.h"

/* After a step of libpccd in this rank. */
void balance_note(struct pccd_mpi *world, const struct pccd_step_counters *counters);
/* Collective: are the weights of what the ranks have so uneven that a cut pays? */
int balance_guess(struct pccd_mpi *world, uint64_t weight, bool *is_uneven);
/* Collective, after a step that each rank did all its work for: world->share.imbalance,
 * and what this rank's work was to world->known_work; the most work of a rank goes to
 * world->right_work. */
int balance_tell(struct pccd_mpi *world);

/* The same on every rank: is the scene to be cut anew before the next step? step_ns,
 * cut_ns: how long the last step and the last cut took the slowest rank. */
bool balance_wants_cut(const struct pccd_mpi *world);
void balance_note_times(struct pccd_mpi *world, uint64_t step_ns, uint64_t cut_ns);

#endif
