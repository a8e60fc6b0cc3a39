/* tests.h - the elementary tests of the pairs that a compared library has found.
 *
 * Test every pair that goes into a sink, 1024 of a kind at a time, by the engine's own
 * exact tests with its filters before them. These are the fastest available, so that no
 * library looks slower because of somebody else's tests.
 *
 * Threads: one thread a sink.
 */
#ifndef PEERS_TESTS_H
#define PEERS_TESTS_H

#include "peer.h"
#include "resident.h"

struct peers_tests;

/* Positions are those of the world's last step; the input must outlive the tests. */
struct peers_tests *peers_tests_new(const struct peer_input *input,
                                    const struct bench_world *world);
void peers_tests_free(struct peers_tests *tests);

/* Before a library is asked: pairs go from the sinks to the tests. */
void peers_tests_begin(struct peers_tests *tests, struct peer_sink sinks[PEER_SINK_MAX]);
/* After it: test what is left in the rings; returns the number of contacts. */
uint64_t peers_tests_end(struct peers_tests *tests,
                         struct peer_sink sinks[PEER_SINK_MAX]);

#endif
