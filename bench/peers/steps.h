/* steps.h - what all compared libraries are asked for: boxes, pairs, tests of pairs. */
#ifndef PEERS_STEPS_H
#define PEERS_STEPS_H

#include "peer.h"
#include "resident.h"

/* ---- The swept boxes of a step, the input that all compared libraries get. */

/* Features have the engine's global indices; the world's last step is the one. */
void peers_swept_init(struct peer_input *input, const struct bench_world *world);
void peers_swept_deinit(struct peer_input *input);

/* The engine's global index of a feature of so many points (1: vertex, 2: edge, 3: face)
 * that records give as this one of this object. */
uint32_t peers_index(const struct bench_world *world, uint32_t points, uint32_t object_id,
                     uint32_t feature);

/* ---- Asks the method `wide` for candidate pairs, in the same way as the other
 * libraries are asked. */

/* The scene for the next open; it must outlive what is opened. */
void peers_ours_scene(const struct bench_world *world);

/* Pairs of slots, as the elementary tests read them: written to a chunk, read once. */
extern const struct peer peers_ours;
/* Every pair under its features' names too. */
extern const struct peer peers_ours_named;

/* ---- The elementary tests of the pairs that a compared library has found.
 *
 * Test every pair that goes into a sink, 1024 of a kind at a time, by the engine's own
 * exact tests with its filters before them. These are the fastest available, so that no
 * library looks slower because of somebody else's tests. */

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
