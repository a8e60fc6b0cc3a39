/* ours.h - asks the method `wide` for candidate pairs, in the same way as the other
 * libraries are asked.
 *
 * Threads: one opens it; a team of as many as are asked for does the work.
 */
#ifndef PEERS_OURS_H
#define PEERS_OURS_H

#include "peer.h"
#include "resident.h"

/* The scene for the next open; it must outlive what is opened. */
void peers_ours_scene(const struct bench_world *world);

/* Pairs of slots, as the elementary tests read them: written to a chunk, read once. */
extern const struct peer peers_ours;
/* Every pair under its features' names too. */
extern const struct peer peers_ours_named;

#endif
