/* conn.h - the socket of one client. */
#ifndef SRV_CONN_H
#define SRV_CONN_H

#include <stddef.h>
#include <stdint.h>
#include <uv.h>

#include "deferred.h"
#include "host.h"
#include "proto_limits.h"
#include "refused.h"
#include "replyqueue.h"

/* Replies of one client that may wait for it to read. From PROTO_REPLIES_QUEUED_MAX on it
 * is not read; answers of requests in flight still arrive, and beyond this it is
 * dropped. */
#define SRV_REPLIES_HARD_MAX (2u * PROTO_REPLIES_QUEUED_MAX)

enum srv_conn_state {
    SRV_CONN_OPEN = 0,
    SRV_CONN_FLUSHING = 1,  /* a fatal error was answered: send what is queued */
    SRV_CONN_LINGERING = 2, /* our side is shut; wait for the peer's end, discard input */
    SRV_CONN_BROKEN = 3     /* shut down; closes on its next event */
};

struct srv_peer;
struct srv_outlet;
struct srv_server;

struct srv_conn {
    struct srv_conn *prev;
    struct srv_conn *next;
    struct srv_server *server;
    struct srv_session *session; /* NULL: it went on over another connection */
    struct srv_refused_link refused;
    int fd;
    struct srv_outlet *outlet; /* of fd */
    enum srv_conn_state state;
    int events;          /* being watched for */
    uint32_t open_count; /* libuv handles not closed yet */
    uv_poll_t poll;
    uv_timer_t timer; /* for hello, then for what was put off, or the peer's end */
    struct srv_deferred deferred;  /* while something is, nothing is read */
    struct srv_replyqueue replies; /* that the socket does not take yet */
    uint32_t turns;                /* at which something was read */
    bool is_ahead;                 /* its client sends before it has an answer */
    bool is_new;                   /* nothing has been read yet */
    bool refuses_fds;              /* none can be sent any more (seqpacket.h) */
    bool is_bare;                  /* and none is on its way */
    bool is_corked;                /* replies wait until what has come first is read */
};

/* A connection on an accepted, non-blocking socket. Takes `fd` over, also on failure.
 * Returns 0, PCCD_E_NOMEM or PCCD_E_SYSTEM. */
int srv_conn_new(struct srv_server *server, int fd, const struct srv_peer *peer);

/* Send what is kept of answers (outbox.h); before each wait, and before what takes its
 * time. */
void srv_conn_send_kept(struct srv_server *server);

/* Read what has arrived, as after an event. Must not be called from inside a handler. */
void srv_conn_read(struct srv_conn *conn);

/* Close now; its session waits or ends. Must not be called from inside a handler. */
void srv_conn_close(struct srv_conn *conn);

#endif
