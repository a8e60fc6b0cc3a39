/* relief.h - starts another computing thread when a job takes long and others wait for
 * it.
 */
#ifndef SRV_RELIEF_H
#define SRV_RELIEF_H

#include <stdbool.h>
#include <stdint.h>

struct srv_compute;
struct srv_workspace;
struct srv_service;
struct srv_timer;

/* Begun with srv_relief_init; zeroed before. */
struct srv_relief {
    struct srv_service *service;      /* whom the host starts a runner for */
    struct srv_compute *compute;      /* the queue that is helped */
    struct srv_workspace *workspaces; /* of its runners */
    struct srv_timer *timer;
    bool is_set;       /* the timer */
    uint64_t retry_ns; /* a runner could not be started: not before */
};

/* Returns 0 or PCCD_E_NOMEM. */
int srv_relief_init(struct srv_relief *relief, struct srv_service *service,
                    struct srv_compute *compute, struct srv_workspace *workspaces);
/* A second time is nothing. */
void srv_relief_deinit(struct srv_relief *relief);

/* The queue of what is computed has been started: help it from now on. */
void srv_relief_begin(struct srv_relief *relief);

#endif
