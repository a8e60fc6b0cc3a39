/* weigh.h - how much work a leaf is in a step.
 *
 * Threads: one.
 */
#ifndef RANKS_WEIGH_H
#define RANKS_WEIGH_H

#include "world.h"

/* Collective, while there are ghosts, which may be those of another step:
 * object->weights, for a step from object->from to object->to, and this rank's sum. */
int ranks_weigh(struct pccd_mpi *world, double separation, uint64_t *sum);
/* In this rank alone: all leaves weigh the same again. */
void ranks_weights_forget(struct pccd_mpi *world);

#endif
