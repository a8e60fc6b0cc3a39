/* motions.h - takes the motions of a step that a caller gives.
 *
 * Room:     client/mpi. May include: world.h.
 * Does:     check them, and write both ends of this rank's given vertices.
 * Threads:  one.
 */
#ifndef RANKS_MOTIONS_H
#define RANKS_MOTIONS_H

#include "world.h"

/* In this rank alone: object->from and object->to, of each object; both are object->x
 * where nothing was said. Errors: those of pccd_step. */
int ranks_motions_take(struct pccd_mpi *world, const struct pccd_motion *motions,
                       uint32_t motion_count);

#endif
