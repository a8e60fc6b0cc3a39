/* now.h - the one clock of the server.
 *
 * Room:     server. May include: the C library.
 * Does:     CLOCK_MONOTONIC in nanoseconds, the clock of the engine's deadlines.
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

#endif
