/* timers.h - what is due at a time, without a thread that waits for it.
 *
 * Keep the service's timers (host.h). Nothing is left undone between two messages but
 * frames that are held for the step of another session: a step is computed before its
 * deadline can come in the queue, and no session waits. When such a frame's deadline has
 * come, the descriptors of all clients are readable, and who looks for a message first
 * does what is due.
 *
 * Threads: whoever has the turn; direct_timers_are_due and _due_ns any, which take a turn
 * to be sure.
 */
#ifndef DIRECT_TIMERS_H
#define DIRECT_TIMERS_H

#include <stdbool.h>
#include <stdint.h>

bool direct_timers_are_due(void);
/* Return when the first one is due, by CLOCK_MONOTONIC; 0: none is set. */
uint64_t direct_timers_due_ns(void);
/* Fire each that is due. */
void direct_timers_fire(void);

#endif
