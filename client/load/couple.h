/* couple.h - two simulated clients that share one scene.
 *
 * Let the first client hold the motion of its sheet, and let the second, which owns the
 * floor, step the scene until the first is answered. One answer has the records, the
 * other the numbers of the same step: both are checked as one.
 *
 * Threads: as actor_state.h.
 */
#ifndef LOAD_COUPLE_H
#define LOAD_COUPLE_H

#include "actor_state.h"

/* The scene, with a name that nothing else has, and the second client in it. Returns 0 or
 * a status. */
int load_couple_open(struct load_actor *actor, const struct pccd_options *options);
/* Both have added what is theirs to the same daemon's scene. Returns 0 or a status. */
int load_couple_settle(struct load_actor *actor);
void load_couple_close(struct load_actor *actor);

/* Before the sheet's way is written, and after it was held. Return 0 or a status. */
int load_couple_set(struct load_actor *actor, bool may_meet);
int load_couple_step(struct load_actor *actor);

/* Everything that has arrived for either. Returns 0 or a status. */
int load_couple_take(struct load_actor *actor, bool *moved);

#endif
