/* runners.h - the threads that compute: their scratch memory, and one more in need. */
#ifndef SRV_RUNNERS_H
#define SRV_RUNNERS_H

#include <stdbool.h>
#include <stdint.h>

#include "codec.h"
#include "compute.h"
#include "engine.h"
#include "shm.h"

/* ---- The scratch memory of each thread that computes. */

struct srv_workspace {
    struct eng_affinity *affinity; /* processors that may be used; NULL: no team */
    struct proto_encoder
        *encoder; /* of answers that are sent from here; NULL: no workspace */
    struct proto_segment *segments; /* PROTO_SEGMENTS_MAX: the step's table */
};

_Static_assert(SRV_PLACES <= ENG_TEAMS_MAX, "each has a team");

/* Make the workspace of that number, if there is none. Returns 0 or PCCD_E_NOMEM.
 * [loop] */
int srv_workspace_init(struct srv_workspace workspaces[SRV_RUNNERS_MAX], uint32_t number);
void srv_workspace_deinit(struct srv_workspace workspaces[SRV_RUNNERS_MAX]);

/* Return the workspace of the calling thread. [compute] */
static inline struct srv_workspace *
srv_workspace_of_thread(struct srv_workspace workspaces[SRV_RUNNERS_MAX])
{
    return &workspaces[eng_payer()->number];
}

struct srv_compute;
struct srv_workspace;
struct srv_service;
struct srv_timer;

/* Watches the queue, and has one more runner started when all are long at work. Begun
 * with srv_spare_runner_init; zeroed before. */
struct srv_spare_runner {
    struct srv_service *service;      /* whom the host starts a runner for */
    struct srv_compute *compute;      /* the queue that is helped */
    struct srv_workspace *workspaces; /* of its runners */
    struct srv_timer *timer;
    bool is_set;       /* the timer */
    uint64_t retry_ns; /* a runner could not be started: not before */
};

/* Prepare to help `compute`, whose runners have these workspaces. Returns 0 or
 * PCCD_E_NOMEM. */
int srv_spare_runner_init(struct srv_spare_runner *spare, struct srv_service *service,
                          struct srv_compute *compute, struct srv_workspace *workspaces);
/* Free its timer. Does nothing a second time. */
void srv_spare_runner_deinit(struct srv_spare_runner *spare);

/* Help the queue from now on, which has been started. */
void srv_spare_runner_begin(struct srv_spare_runner *spare);

#endif
