/* conn.h - the socket of one client.
 *
 * Room:     server. May include: libuv, the protocol's headers.
 * Does:     receive messages for dispatch.h and send replies, never waiting for the
 *           client.
 * Does not: know what a message means.
 * Threads:  [loop]
 */
#ifndef SRV_CONN_H
#define SRV_CONN_H

#include <stddef.h>
#include <stdint.h>
#include <uv.h>

#include "codec.h"

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
struct srv_message;
struct srv_quota_user;
struct srv_reply;

struct srv_conn {
    struct srv_conn *prev;
    struct srv_conn *next;
    struct srv_loop *loop;
    struct srv_session *session; /* NULL: it went on over another connection */
    int fd;
    enum srv_conn_state state;
    int events;          /* being watched for */
    uint32_t open_count; /* libuv handles not closed yet */
    uv_poll_t poll;
    uv_timer_t timer; /* for hello, then for what was put off, or the peer's end */
    struct srv_message *put_off; /* NULL: none; nothing is read meanwhile */
    uint32_t put_off_turns;      /* how often, the message that was read last */
    struct srv_reply *reply_first;
    struct srv_reply *reply_last;
    uint32_t reply_count;
    bool is_new;    /* nothing has been read yet */
    bool is_corked; /* replies wait until what has come first is read */
};

/* A connection on an accepted, non-blocking socket. Takes `fd` over, also on failure.
 * Returns 0, PCCD_E_NOMEM or PCCD_E_SYSTEM. */
int srv_conn_new(struct srv_loop *loop, int fd, const struct srv_peer *peer);

/* Send a message, now or when the client reads. Takes over fds[fd_count] in any case.
 * What cannot be sent any more is dropped; the connection then closes soon, never
 * inside. */
void srv_conn_send(struct srv_conn *conn, const struct proto_encoder *message,
                   const int *fds, int fd_count);

/* No more messages either way: send what is queued, let the peer read it, close. */
void srv_conn_finish(struct srv_conn *conn);

/* The client has said hello: it may be silent now. */
void srv_conn_established(struct srv_conn *conn);

/* Read what has arrived, as after an event. Must not be called from inside a handler. */
void srv_conn_read(struct srv_conn *conn);

/* A message comes back that often at most: sessions of its user may leave for ever. */
#define SRV_PUT_OFF_MAX 64u

/* Come back to the message that is being handled when a session of the user has left.
 * Nothing else is read before it. Returns 0, PCCD_E_LIMIT or PCCD_E_NOMEM. */
int srv_conn_put_off(struct srv_conn *conn, const void *message, size_t bytes);
/* A session of the user has left: come back to what was put off, soon, never inside. */
void srv_conn_room(struct srv_loop *loop, const struct srv_quota_user *user);

/* Its session goes on over another connection: close soon. [loop], also from inside the
 * handler of another connection's message. */
void srv_conn_orphan(struct srv_conn *conn);

/* Close now; its session waits or ends. Must not be called from inside a handler. */
void srv_conn_close(struct srv_conn *conn);

#endif
