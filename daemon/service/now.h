/* now.h - the clocks of the server.
 *
 * Room:     service. May include: the C library.
 * Does:     CLOCK_MONOTONIC in nanoseconds, the clock of the engine's deadlines; and what
 *           a thread has worked.
 * Threads:  [any].
 */
#ifndef SRV_NOW_H
#define SRV_NOW_H

#include <stdint.h>
#include <time.h>

static inline uint64_t srv_now_ns(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (uint64_t)now.tv_sec * 1000000000u + (uint64_t)now.tv_nsec;
}

/* What the calling thread has had of a processor. */
static inline uint64_t srv_now_thread_ns(void)
{
    struct timespec now;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return (uint64_t)now.tv_sec * 1000000000u + (uint64_t)now.tv_nsec;
}

#endif
