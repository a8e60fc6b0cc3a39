/* conn.h - the socket of one client, and the messages that wait on it. */
#ifndef SRV_CONN_H
#define SRV_CONN_H

#include <stddef.h>
#include <stdint.h>
#include <uv.h>

#include "host.h"
#include "proto_limits.h"
#include "seqpacket.h"
#include "server.h"

/* ---- The replies that wait until their client reads. */

struct srv_reply {
    struct srv_reply *next;
    size_t bytes;
    int fd_count;
    int fds[PROTO_FDS_MAX]; /* the queue's */
    uint8_t data[];
};

/* Zeroed: empty. */
struct srv_replyqueue {
    struct srv_reply *first;
    struct srv_reply *last;
    uint32_t count;
};

/* Queue a reply. Takes the descriptors over, whatever it returns: 0 or PCCD_E_NOMEM. */
int srv_replyqueue_push(struct srv_replyqueue *queue, const void *message, size_t bytes,
                        const int *fds, int fd_count);

/* Give the first up, and close its descriptors; there must be one. */
void srv_replyqueue_pop(struct srv_replyqueue *queue);

void srv_reply_close_fds(const int *fds, int fd_count);

/* ---- One message of a client that cannot be handled yet because a queue is
 * full. */

/* A message comes back that often at most: sessions of its user may leave for ever. */
#define SRV_DEFERRED_MAX 64u

struct srv_message {
    size_t bytes;
    uint8_t data[];
};

/* Zeroed: nothing waits. */
struct srv_deferred {
    struct srv_message *message; /* NULL: none */
    uint32_t turns;              /* how often, the message that was read last */
};

/* Keep a copy; there must be none. Returns 0, PCCD_E_LIMIT (too often) or
 * PCCD_E_NOMEM. */
int srv_deferred_keep(struct srv_deferred *deferred, const void *message, size_t bytes);

/* Take what was kept, for the caller to free; NULL: nothing. */
struct srv_message *srv_deferred_take(struct srv_deferred *deferred);

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

/* Make a connection on an accepted, non-blocking socket. Takes `fd` over, also on
 * failure. Returns 0, PCCD_E_NOMEM or PCCD_E_SYSTEM. */
int srv_conn_new(struct srv_server *server, int fd, const struct srv_peer *peer);

/* Send what is kept of answers (outbox.c); before each wait, and before what takes its
 * time. */
void srv_conn_send_kept(struct srv_server *server);

/* Read what has arrived, as after an event. Must not be called from inside a handler. */
void srv_conn_read(struct srv_conn *conn);

/* Close now; its session waits or ends. Must not be called from inside a handler. */
void srv_conn_close(struct srv_conn *conn);

/* ---- Lets a thread that computes send an answer itself, while the event loop may
 * be closing the socket. */

/* Make the outlet of the socket `fd`, with one reference, the caller's. NULL: no memory.
 * [loop] */
struct srv_outlet *srv_outlet_new(int fd);

/* Send nothing from here on: the socket is about to be closed. Waits for one message that
 * is just being sent. Gives up the caller's reference. [loop] */
void srv_outlet_close(struct srv_outlet *outlet);

/* Say whether the loop has messages that wait for the socket: what comes from here must
 * not overtake them. [loop] */
void srv_outlet_block(struct srv_outlet *outlet, bool is_blocked);

/* Add a reference, and return the outlet. [loop] */
struct srv_outlet *srv_outlet_hold(struct srv_outlet *outlet);

#endif
