/* steps.h - compares whole steps: another library's pairs with our elementary tests,
 * against the engine.
 *
 * Time in turn what a library takes for its refit, its pairs and the tests of these, and
 * what the method `wide` takes for a step of mode `all`; check that all find the same
 * number of contacts.
 *
 * Threads: one opens them; they have their own.
 */
#ifndef PEERS_STEPS_H
#define PEERS_STEPS_H

#include "peer.h"
#include "resident.h"

#define PEERS_BUDGET_NS 4000000000u /* for one library; it has two repeats at least */

/* Of the step that `frames` holds, which the world has taken last. */
void peers_steps(const struct peer *const *peers, unsigned peer_count,
                 struct bench_world *world, const struct bench_frames *frames,
                 const struct peer_input *input, uint32_t threads, unsigned repeats);

#endif
