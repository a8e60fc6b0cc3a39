/* steps.h - compares whole steps: another library's pairs with our elementary tests,
 * against the engine.
 *
 * Room:     bench/peers. May include: peer.h, bench, engine headers.
 * Does:     time in turn what a library takes for its refit, its pairs and the tests of
 *           these, and what the method `wide` takes for a step of mode `all`; check that
 *           all find the same number of contacts.
 * Does not: charge a library for everything that it would need: boxes around the features
 *           and copies of the positions are made beforehand; contacts are counted, and
 *           not sorted, named or delivered. The engine's step does all of that.
 * Threads:  one opens them; they have their own.
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
