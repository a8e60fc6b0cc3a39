/* actor.h - simulates one client of a load test.
 *
 * Connect, register its shape, keep some steps in flight, and check each answer: does it
 * belong to a request that waits, and is it what a lone client got?
 *
 * Threads: one process for one actor.
 */
#ifndef LOAD_ACTOR_H
#define LOAD_ACTOR_H

#include <poll.h>

#include "actor_state.h"

/* Connect and register; `is_alone`: for the truth, as is who adds the sheet first.
 * Returns 0 or a status, after saying why if `loud`; close it in either case. */
int load_actor_open(struct load_actor *actor, const struct load *load, uint32_t number,
                    struct load_tally *tally, bool is_alone, bool sheet_first, bool loud);

/* What it waits for. */
void load_actor_fds(const struct load_actor *actor, struct pollfd fds[2]);

/* Submit what is due, if `more`, and take what has arrived, if its descriptor is readable
 * or something was submitted. Returns whether anything was. */
bool load_actor_turn(struct load_actor *actor, bool more, bool readable);

/* When it wants a turn even if its descriptor is silent; UINT64_MAX: not at all. */
uint64_t load_actor_wake_ns(const struct load_actor *actor, bool more);

/* Begin anew if an answer has not come for very long. */
void load_actor_check(struct load_actor *actor, uint64_t now_ns);

/* What waits for an answer is lost. */
void load_actor_close(struct load_actor *actor);

#endif
