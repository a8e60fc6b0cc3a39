/* swept.h - the swept boxes of a step, the input that all compared libraries get.
 *
 * Room:     bench/peers. May include: peer.h, bench, engine headers.
 * Does:     list vertices, edges and faces of a resident scene with one box each around
 *           both ends of its last step, rounded outward as the engine rounds.
 * Threads:  one.
 */
#ifndef PEERS_SWEPT_H
#define PEERS_SWEPT_H

#include "peer.h"
#include "resident.h"

/* Features have the engine's global indices; the world's last step is the one. */
void peers_swept_init(struct peer_input *input, const struct bench_world *world);
void peers_swept_deinit(struct peer_input *input);

#endif
