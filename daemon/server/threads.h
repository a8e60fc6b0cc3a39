/* threads.h - how many threads the system grants.
 *
 * Room:     server. May include: the C library, the engine's headers.
 * Does:     try, before anything depends on it: OpenMP's runtime ends the process when it
 *           gets fewer threads than it asks for.
 * Threads:  [loop], before any other thread is made.
 */
#ifndef SRV_THREADS_H
#define SRV_THREADS_H

#include <stdint.h>

/* The size of the team that can be had beside the server's own threads: `wanted`, or
 * less, and then it is said; at least 1. */
uint32_t srv_threads_granted(uint32_t wanted);

#endif
