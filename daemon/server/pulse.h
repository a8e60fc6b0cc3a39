/* pulse.h - what the service manager is told while the loop turns.
 *
 * Room:     server. May include: libuv, notify.h, the service's headers.
 * Does:     say that it serves, how many it serves, that it is alive.
 * Does not: wake a daemon that nobody talks to, unless the manager has a watchdog.
 * Threads:  [loop]
 */
#ifndef SRV_PULSE_H
#define SRV_PULSE_H

#include <stdbool.h>
#include <stdint.h>
#include <uv.h>

#include "stuck.h"

struct srv_loop;

struct srv_pulse {
    struct srv_loop *loop;
    uv_timer_t timer; /* to the next beat, or to the next word about clients */
    bool beats;       /* the manager has a watchdog: the timer never stops */
    struct srv_stuck stuck;
    bool is_stuck; /* a thread that computes; said once */
    uint32_t told_clients;
    uint64_t told_steps;
};

/* Before anything else of it; the timer is closed with the reactor's. */
void srv_pulse_init(struct srv_pulse *pulse, uv_loop_t *uv, struct srv_loop *loop);

/* Clients are served from now on: READY=1, and the beats begin. */
void srv_pulse_ready(struct srv_pulse *pulse);

/* A client has come or gone: told a second later, with what else has happened. */
void srv_pulse_change(struct srv_pulse *pulse);

#endif
