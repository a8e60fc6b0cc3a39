/* rooms.h - how much room boxes leave around what moves, so that ghosts stay right for
 * some steps.
 *
 * Threads: one.
 */
#ifndef RANKS_ROOMS_H
#define RANKS_ROOMS_H

#include "world.h"

/* Before ghosts are chosen: more or less room than the last time. has_missed: a vertex
 * has left the box that was made for it then, or that was long ago. In this rank alone;
 * the same in all. */
void ranks_rooms_choose(struct pccd_mpi *world, bool has_missed);
/* Collective: object->room of each, and world->lasts, for a step from object->from to
 * object->to; x: where it begins, of local vertices. is_still: all stands where the last
 * step ended. */
int ranks_rooms_find(struct pccd_mpi *world, bool is_still, double (*const *x)[3]);
/* Collective: ghosts were chosen: what that took, and how many ghosts all have. */
int ranks_rooms_learn(struct pccd_mpi *world);

#endif
