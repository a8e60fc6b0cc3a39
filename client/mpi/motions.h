/* motions.h - takes the motions of a step that a caller gives.
 *
 * Threads: one.
 */
#ifndef RANKS_MOTIONS_H
#define RANKS_MOTIONS_H

#include "world.h"

/* In this rank alone: may these motions be? Nothing changes. Errors: those of
 * pccd_step, but for positions and vertices that two motions have. */
int ranks_motions_check(struct pccd_mpi *world, const struct pccd_motion *motions,
                        uint32_t motion_count);
/* In this rank alone, after that: object->from and object->to, of each object; both are
 * object->x where nothing was said. Where the named objects began before is forgotten.
 * PCCD_E_NOTFINITE, PCCD_E_SEGMENT, PCCD_E_NOMEM. */
int ranks_motions_take(struct pccd_mpi *world, const struct pccd_motion *motions,
                       uint32_t motion_count);

#endif
