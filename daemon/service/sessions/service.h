/* service.h - what all sessions of a daemon share: queues, quotas, counters, lists.
 *
 * Threads: [loop], but for the desks and what says otherwise.
 */
#ifndef SRV_SERVICE_H
#define SRV_SERVICE_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

#include "compute.h"
#include "deadlines.h"
#include "laststep.h"
#include "metrics.h"
#include "options.h"
#include "quota.h"
#include "ringio.h"
#include "runners.h"

struct proto_decoder;
struct proto_encoder;
struct proto_error;
struct srv_config_kept;
struct srv_watcher;
struct srv_session;
struct srv_shared;
struct srv_timer;
struct srv_tracing;

enum srv_phase {
    SRV_PHASE_RUNNING = 0,
    SRV_PHASE_DRAINING = 1, /* nobody is accepted; requests in flight are answered */
    SRV_PHASE_CLOSING = 2,  /* connections are closed; what they had is being freed */
    SRV_PHASE_CLOSED = 3    /* the compute thread has ended; handles are closing */
};

struct srv_service {
    const struct srv_options *options;       /* as they are now */
    const struct srv_options *start_options; /* as they were when it started */
    struct srv_options live;                 /* where `options` points: config.set */
    struct srv_config_kept *kept; /* that outlives us (config.h); NULL: nothing does */
    struct srv_compute compute;
    struct srv_compute pages; /* makes and frees rings: 2 us a page */
    struct srv_workspace
        workspaces[SRV_RUNNERS_MAX]; /* of the threads that compute, by number */
    struct srv_spare_runner spare_runner;
    struct srv_reclaim reclaim;
    bool does_brief;        /* what is brief is done on [loop]; constant */
    uint64_t brief_from_ns; /* not before */
    bool is_pinned;         /* threads of steps are put on them; constant */
    bool lends_pages;       /* to steps, as no client does harm there; constant */
    struct srv_quota quota;
    struct srv_metrics metrics;
    /* Whether the client whose message is handled wants no more: asked by the thread that
     * computes; NULL: nobody is asked. */
    bool (*is_stopped)(void *asked);
    void *asked;
    /* Copies the records of its steps to their page, where that client does so itself and
     * reads no hash of them; NULL: it does not. */
    void (*write)(void *writer, void *to, const void *from, uint64_t count);
    void *writer;
    /* Tells of candidates, in the place of records (question.h); NULL: nobody. */
    void (*weigh)(void *weigher, const struct pccd_pair *pairs, uint32_t count);
    void *weigher;
    struct srv_timer *stray;  /* looks at what rings hold (stray.h); NULL: nobody does */
    bool is_stray_soon;       /* it fires within a second */
    struct srv_timer *linger; /* runs while sessions wait for their clients (linger.h) */
    uint32_t waiting_count;   /* of these */
    struct srv_deadlines deadlines; /* of requests */
    struct srv_laststep *last_step; /* of any session; NULL: none yet */
    struct srv_laststep_spare spare_step;
    struct srv_tracing *tracing;         /* the one recording; NULL: none */
    struct proto_decoder *decoder;       /* one message is decoded at a time */
    struct proto_encoder *encoder;       /* and one encoded */
    atomic_uint_least64_t replies_tried; /* [compute] answers that it has tried to send */
    uint64_t replies_done;               /* of these, concluded */
    atomic_bool has_open; /* the loop is to send an answer of [compute] (request.h) */
    struct srv_watcher *watchers;        /* of the sessions that watch; NULL: none does */
    struct srv_session *sessions;        /* newest first, closed ones included */
    struct srv_shared *shared;           /* scenes that sessions share, newest first */
    uint32_t client_count;               /* open sessions */
    uint32_t request_count;              /* in flight, of all sessions */
    uint64_t session_last;               /* number of the newest session */
    uint64_t mesh_last;                  /* number of the newest mesh */
    uint64_t step_last;                  /* number of the newest step */
    uint64_t batch_last;                 /* number of the newest batch */
    uint64_t epoch;                      /* of this start of the daemon */
    uint64_t start_ns;
    enum srv_phase phase;
    /* A session ends: let go of its requests, scenes, meshes, ring and what it watches
     * (requests/dispatch.h). Constant. */
    void (*let_go)(struct srv_session *session);
    /* It may not go on: tell its client, if it has one, and end it. Constant. */
    void (*refuse)(struct srv_session *session, const struct proto_error *error);
};

#endif
