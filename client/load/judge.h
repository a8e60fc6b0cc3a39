/* judge.h - checks that an answer is the right one.
 *
 * Threads: one process for one actor.
 */
#ifndef LOAD_JUDGE_H
#define LOAD_JUDGE_H

#include "actor_state.h"

/* The request does not wait any more. Of an actor that is alone: note the truth. */
void load_judge(struct load_actor *actor, const struct pccd_answer *answer);

/* The same of a batch: each scene has the answer of a lone client's step, and counts as a
 * request. */
void load_judge_batch(struct load_actor *actor, const struct pccd_batch_answer *answer);

#endif
