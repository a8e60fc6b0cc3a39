/* heartbeat.h - tells the service manager (systemd) regularly that the daemon is
 * alive.
 */
#ifndef SRV_HEARTBEAT_H
#define SRV_HEARTBEAT_H

#include <stdbool.h>
#include <stdint.h>
#include <uv.h>

#include "compute.h"

struct srv_service;

struct srv_heartbeat {
    struct srv_service *service;
    uv_timer_t timer; /* to the next beat, or to the next word about clients */
    bool beats;       /* the manager has a watchdog: the timer never stops */
    bool is_stuck;    /* a thread that computes; said once */
    uint32_t told_clients;
    uint64_t told_steps;
};

/* Before anything else of it; the timer is closed with the reactor's. */
void srv_heartbeat_init(struct srv_heartbeat *heartbeat, uv_loop_t *uv,
                        struct srv_service *service);

/* Clients are served from now on: READY=1, and the beats begin. */
void srv_heartbeat_ready(struct srv_heartbeat *heartbeat);

/* A client has come or gone: told a second later, with what else has happened. */
void srv_heartbeat_change(struct srv_heartbeat *heartbeat);

#endif
