/* now.h - how much processor time the calling thread has used. */
#ifndef SRV_NOW_H
#define SRV_NOW_H

#include <stdint.h>
#include <time.h>

#include "clock.h"

/* Return the processor time of the calling thread. */
static inline uint64_t srv_now_thread_ns(void)
{
    struct timespec now;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return (uint64_t)now.tv_sec * 1000000000u + (uint64_t)now.tv_nsec;
}

#endif
