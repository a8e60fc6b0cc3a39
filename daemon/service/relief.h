/* relief.h - another thread computes while a job takes long.
 *
 * Room:     service. May include: the C library.
 * Does:     look when the job that runs has become long (compute.h), as long as others
 *           wait for it, and start a runner with a team when all are busy.
 * Does not: wake anything while nobody waits.
 * Threads:  [loop]
 */
#ifndef SRV_RELIEF_H
#define SRV_RELIEF_H

#include <stdbool.h>
#include <stdint.h>

struct srv_loop;
struct srv_timer;

struct srv_relief {
    struct srv_timer *timer;
    bool is_set;       /* the timer */
    uint64_t retry_ns; /* a runner could not be started: not before */
};

/* Returns 0 or PCCD_E_NOMEM. */
int srv_relief_init(struct srv_loop *loop);
/* A second time is nothing. */
void srv_relief_deinit(struct srv_loop *loop);

/* The queue of what is computed has been started: help it from now on. */
void srv_relief_begin(struct srv_loop *loop);

#endif
