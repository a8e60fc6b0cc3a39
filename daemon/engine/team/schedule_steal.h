/* schedule_steal.h - shares out the tasks of a step by work stealing.
 *
 * Threads: [team]: every thread of the region calls it.
 */
#ifndef ENG_SCHEDULE_STEAL_H
#define ENG_SCHEDULE_STEAL_H

#include "team.h"

/* Stealing: moments (wait.h) of a pause between two rounds over all victims, doubled from
 * 1: up to some 3 us. */
#define ENG_STEAL_RELAXES_MAX 64u

/* Work stealing over the tasks of team->method. Returns when no task is left or the step
 * was stopped. `worker` is the calling thread's. */
void eng_schedule_steal(struct eng_team *team, struct eng_worker *worker);

/* Inside the region, by one thread, before any other works: hand out the first tasks. */
void eng_schedule_steal_begin(struct eng_team *team, struct eng_worker *worker);

#endif
