/* affinity.h - binds each thread of a team to a processor of its own (thread affinity).
 *
 * Choose among the processors that the process may use. Without this, the kernel was seen
 * to leave two threads on one processor. The OpenMP runtime's own binding would bind the
 * other threads too.
 */
#ifndef ENG_AFFINITY_H
#define ENG_AFFINITY_H

#include <stdint.h>

#include "processors.h"

/* Bind the calling thread, the `thread`-th of a team, to a processor of its own, unless
 * it is bound there already; in a team larger than `places`, to all of them. NULL:
 * nothing. The runtime may replace threads when a team shrinks and grows, and a new one
 * begins where the thread that opened the region is bound, so every region calls it.
 * Costs a comparison once a thread is where it belongs. [team] */
void eng_affinity_bind_thread(const struct eng_affinity *affinity, uint32_t thread,
                              uint32_t team_count);

/* It was lent a processor (seat.h), and others no longer wait for it: back to its own.
 * Costs a comparison otherwise. [team] */
void eng_affinity_return(const struct eng_affinity *affinity, uint32_t thread,
                         uint32_t team_count);

/* Open one region, so that the team exists and is placed before the first step.
 * [compute] */
void eng_affinity_warm_up(const struct eng_affinity *affinity, uint32_t threads);

#endif
