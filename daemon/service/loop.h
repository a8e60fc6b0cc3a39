/* loop.h - everything there is one of.
 *
 * Room:     service. May include: every header of the room.
 * Does:     own the queues of what is computed, quotas, counters, the shared buffers and
 *           the list of sessions.
 * Does not: wait for anything or talk to anybody: that is the host's (host.h).
 * Threads:  [loop], but for the desks.
 */
#ifndef SRV_LOOP_H
#define SRV_LOOP_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

#include "codec.h"
#include "compute.h"
#include "desk.h"
#include "host.h"
#include "laststep.h"
#include "linger.h"
#include "log.h"
#include "metrics.h"
#include "monitor.h"
#include "options.h"
#include "overdue.h"
#include "quota.h"
#include "relief.h"
#include "shm.h"
#include "tracing.h"

enum srv_phase {
    SRV_PHASE_RUNNING = 0,
    SRV_PHASE_DRAINING = 1, /* nobody is accepted; requests in flight are answered */
    SRV_PHASE_CLOSING = 2,  /* connections are closed; what they had is being freed */
    SRV_PHASE_CLOSED = 3    /* the compute thread has ended; handles are closing */
};

struct srv_loop {
    const struct srv_options *options;       /* as they are now */
    const struct srv_options *start_options; /* as they were when it started */
    struct srv_options live;                 /* where `options` points: config.set */
    struct srv_compute compute;
    struct srv_compute pages;               /* makes and frees rings: 2 us a page */
    struct srv_desk desks[SRV_RUNNERS_MAX]; /* of the threads that compute, by number */
    struct srv_relief relief;
    bool does_brief;        /* what is brief is done on [loop]; constant */
    uint64_t brief_from_ns; /* not before */
    bool is_pinned;         /* threads of steps are put on them; constant */
    struct srv_quota quota;
    struct srv_metrics metrics;
    struct srv_linger linger;
    struct srv_overdue overdue;
    struct srv_laststep *last_step; /* of any session; NULL: none yet */
    struct srv_laststep_spare spare_step;
    struct srv_tracing *tracing;         /* the one recording; NULL: none */
    struct proto_decoder *decoder;       /* one message is decoded at a time */
    struct proto_encoder *encoder;       /* and one encoded */
    atomic_uint_least64_t replies_tried; /* [compute] answers that it has tried to send */
    uint64_t replies_done;               /* of these, concluded */
    struct srv_monitor *monitors;        /* of the sessions that watch; NULL: none does */
    struct srv_session *sessions;        /* newest first, closed ones included */
    struct srv_shared *shared;           /* scenes that sessions share, newest first */
    uint32_t client_count;               /* open sessions */
    uint32_t request_count;              /* in flight, of all sessions */
    uint64_t session_last;               /* number of the newest session */
    uint64_t mesh_last;                  /* number of the newest mesh */
    uint64_t step_last;                  /* number of the newest step */
    uint64_t epoch;                      /* of this start of the daemon */
    uint64_t start_ns;
    enum srv_phase phase;
};

/* All but the queues, which the host starts, and is_pinned. `loop` is zeroed, and
 * srv_loop_deinit follows in any case. Returns 0 or PCCD_E_NOMEM. */
int srv_loop_init(struct srv_loop *loop, const struct srv_options *options);
/* No session is left. */
void srv_loop_deinit(struct srv_loop *loop);

#endif
