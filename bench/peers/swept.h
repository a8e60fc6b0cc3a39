/* swept.h - the swept boxes of a step, the input that all compared libraries get.
 *
 * Threads: one.
 */
#ifndef PEERS_SWEPT_H
#define PEERS_SWEPT_H

#include "peer.h"
#include "resident.h"

/* Features have the engine's global indices; the world's last step is the one. */
void peers_swept_init(struct peer_input *input, const struct bench_world *world);
void peers_swept_deinit(struct peer_input *input);

/* The engine's global index of a feature of so many points (1: vertex, 2: edge, 3: face)
 * that records give as this one of this object. */
uint32_t peers_index(const struct bench_world *world, uint32_t points, uint32_t object_id,
                     uint32_t feature);

#endif
