/* answer.h - makes one answer of what the ranks found.
 *
 * Threads: one.
 */
#ifndef RANKS_ANSWER_H
#define RANKS_ANSWER_H

#include "world.h"

/* Collective. `answer` is libpccd's in this rank, without records; the kept ones are
 * world->records. cut_ns: how long a cut took before this step; 0: there was none. */
int ranks_answer_make(struct pccd_mpi *world, const struct pccd_step_settings *settings,
                      uint64_t cut_ns, struct pccd_answer *answer);
/* The same of what is near. */
int ranks_answer_make_near(struct pccd_mpi *world, const struct pccd_near_settings *near,
                           struct pccd_answer *answer);

#endif
