/* flock.h - a simulated client that steps many scenes by one request.
 *
 * Give the client further scenes like its first, whose objects have the same handles;
 * step all of them as a batch. Each must be answered as the step of a lone client, who
 * makes no batch.
 *
 * Threads: as actor_state.h.
 */
#ifndef LOAD_FLOCK_H
#define LOAD_FLOCK_H

#include "actor_state.h"

/* The first scene has its objects: the others, and the batch of all. Returns 0 or a
 * status. */
int load_flock_open(struct load_actor *actor);
void load_flock_close(struct load_actor *actor);

/* Write the positions of all scenes; of mischief only to the last one. The slot is begun
 * then. Returns 0 or a status. */
int load_flock_write(struct load_actor *actor, const struct load_pending *pending);
/* Everything that has arrived. Returns 0 or a status. */
int load_flock_take(struct load_actor *actor, bool *moved);

#endif
