/* daemon/engine/clock.h - time of phases.
 *
 * Room:     engine. May include: the C library.
 * Does:     read CLOCK_MONOTONIC.
 * Threads:  [any]; about 25 ns a call.
 */
#ifndef ENG_CLOCK_H
#define ENG_CLOCK_H

#include <stdint.h>
#include <time.h>

/* CLOCK_MONOTONIC in nanoseconds. */
static inline uint64_t eng_now_ns(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (uint64_t)now.tv_sec * 1000000000u + (uint64_t)now.tv_nsec;
}

#endif
