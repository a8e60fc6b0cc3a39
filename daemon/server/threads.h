/* threads.h - finds out how many threads the system grants this process.
 *
 * Threads: [loop], before the threads are made.
 */
#ifndef SRV_THREADS_H
#define SRV_THREADS_H

#include <stdint.h>

#define SRV_OWN_THREADS 3u /* the compute thread, that of pages and that of descriptors */

/* The size of the team that can be had with `own` threads besides, of which the one that
 * computes belongs to it: `wanted`, or less, and then it is said; at least 1. */
uint32_t srv_threads_granted(uint32_t wanted, uint32_t own);

/* On how many processors they could run if whoever started the process had not bound it
 * to fewer: those of its cpuset. 0: not known. */
uint32_t srv_processors_allowed(void);

#endif
