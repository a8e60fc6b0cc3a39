/* judge.h - is it the answer?
 *
 * Room:     client/load. May include: actor.h.
 * Does:     find the request that an answer belongs to, compare the answer's hash, and a
 *           sum over its records, with what a lone client got; count what comes of it.
 * Threads:  one process for one actor.
 */
#ifndef LOAD_JUDGE_H
#define LOAD_JUDGE_H

#include "actor.h"

/* The request does not wait any more. Of an actor that is alone: note the truth. */
void load_judge(struct load_actor *actor, const struct pccd_answer *answer);

#endif
