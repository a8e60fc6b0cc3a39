/* loop.h - the event loop, and everything there is one of.
 *
 * Room:     service. May include: libuv and every header of the room.
 * Does:     own uv_loop_t, the compute thread, quotas, counters and the shared buffers;
 *           run until told to stop, then stop in order.
 * Does not: know sockets (listener.h, conn.h) or messages (dispatch.h).
 * Threads:  [loop], but for `segments` and `step_trace`.
 */
#ifndef SRV_LOOP_H
#define SRV_LOOP_H

#include <stdbool.h>
#include <stdint.h>
#include <uv.h>

#include "bell.h"
#include "codec.h"
#include "compute.h"
#include "laststep.h"
#include "linger.h"
#include "listener.h"
#include "log.h"
#include "metrics.h"
#include "options.h"
#include "overdue.h"
#include "place.h"
#include "quota.h"
#include "shm.h"
#include "tracing.h"

struct srv_closer;

enum srv_phase {
    SRV_PHASE_RUNNING = 0,
    SRV_PHASE_DRAINING = 1, /* nobody is accepted; requests in flight are answered */
    SRV_PHASE_CLOSING = 2,  /* connections are closed; what they had is being freed */
    SRV_PHASE_CLOSED = 3    /* the compute thread has ended; handles are closing */
};

struct srv_loop {
    uv_loop_t uv;
    const struct srv_options *options;
    struct srv_listener listener;
    struct srv_compute compute;
    struct srv_compute pages;  /* a thread that makes and frees rings: 2 us a page */
    struct srv_closer *closer; /* of descriptors that have to do with clients */
    struct eng_places places;  /* processors that may be used; constant */
    bool is_pinned;            /* threads of steps are bound to them; constant */
    struct srv_quota quota;
    struct srv_metrics metrics;
    struct srv_linger linger;
    struct srv_overdue overdue;
    struct srv_laststep *last_step; /* of any session; NULL: none yet */
    struct srv_tracing *tracing;    /* the one recording; NULL: none */
    struct eng_trace *step_trace;   /* [compute] what steps record to; NULL: nothing */
    struct proto_decoder *decoder;  /* one message is decoded at a time */
    struct proto_encoder *encoder;  /* and one encoded */
    uint8_t *buffer;                /* PROTO_MESSAGE_BYTES_MAX: the message being read */
    struct proto_segment *segments; /* [compute] PROTO_SEGMENTS_MAX: the step's table */
    struct srv_conn *conns;         /* newest first */
    struct srv_session *sessions;   /* newest first, closed ones included */
    uint32_t closed_since_trim;     /* connections */
    uint32_t conn_count;
    uint32_t client_count;  /* open sessions */
    uint32_t refused_count; /* sessions that wait to hear they are refused */
    uint32_t request_count; /* in flight, of all sessions */
    uint32_t reply_count;   /* queued, of all connections */
    uint32_t put_off_count; /* messages that wait for room, of all connections */
    uint64_t session_last;  /* number of the newest session */
    uint64_t mesh_last;     /* number of the newest mesh */
    uint64_t step_last;     /* number of the newest step */
    uint64_t epoch;         /* of this start of the daemon */
    uint64_t start_ns;
    enum srv_phase phase;
    bool grace_over;      /* requests in flight have been cancelled */
    struct srv_bell bell; /* rung when a thread has finished jobs */
    uv_signal_t sigterm;
    uv_signal_t sigint;
    uv_timer_t idle;  /* until we go because nobody is here */
    uv_timer_t grace; /* until requests in flight are cancelled, then until we give up */
    uv_prepare_t stopper; /* looks, before each wait, whether the next phase can begin */
};

/* Serve until a signal, the last client or the idle time ends it. The socket path's lock
 * is held by the caller. Returns the exit status of the program. */
int srv_loop_run(const struct srv_options *options);

/* Begin to stop: no new connections or requests. Further calls do nothing. */
void srv_loop_shutdown(struct srv_loop *loop, const char *why);

/* A session was opened; an open session's connection is gone. */
void srv_loop_client_joined(struct srv_loop *loop);
void srv_loop_client_left(struct srv_loop *loop);
/* A connection is gone, open or not. */
void srv_loop_conn_closed(struct srv_loop *loop);

#endif
