/* conn.c - the socket of one client.
 *
 * The life of a connection:
 *
 *     OPEN -- fatal error answered --> FLUSHING -- queue empty --> LINGERING --> closed
 *      |                                  `-- peer gone, 1 s --> closed
 *      |                                           (LINGERING: at the peer's end, 1 s)
 *      `-- send failed, too many replies --> BROKEN --> closed
 *
 *     OPEN, from the client's end of file or hangup, which is seen when all that it said
 *     before has been read, also where a send has failed meanwhile --> closed
 *
 * Lingering matters: closing a socket with unread messages makes the peer see a reset
 * before it sees the last reply.
 */
#include "conn.h"

#include <errno.h>
#include <stdlib.h>
#include <sys/socket.h>

#include "allow.h"
#include "dispatch.h"
#include "invariant.h"
#include "linger.h"
#include "pccd_types.h"
#include "proto_limits.h"
#include "request.h"
#include "seqpacket.h"
#include "server.h"
#include "session.h"
#include "shared.h"
#include "watch.h"
#include "watcher.h"

#define HELLO_MS  10000u /* for a client to say hello */
#define LINGER_MS 1000u  /* for a client to read its last reply */

static void on_poll(uv_poll_t *poll, int status, int events);
static void on_timer(uv_timer_t *timer);

/* Nothing tells any more what the peer does: close, but not inside (see "Does not"). */
static void close_soon(struct srv_conn *conn)
{
    srv_log(SRV_LOG_WARN, conn->session->id, "closing: the socket cannot be watched");
    conn->state = SRV_CONN_BROKEN;
    conn->events = 0;
    shutdown(conn->fd, SHUT_RDWR);
    uv_timer_start(&conn->timer, on_timer, 0, 0);
}

/* Watch for what the state needs. Disconnection is watched always, also while reading is
 * paused. */
static void watch(struct srv_conn *conn)
{
    int events = UV_DISCONNECT;
    if (conn->state != SRV_CONN_FLUSHING && conn->deferred.message == NULL &&
        (conn->state != SRV_CONN_OPEN ||
         conn->replies.count < PROTO_REPLIES_QUEUED_MAX)) {
        events |= UV_READABLE;
    }
    if (conn->replies.count > 0 && conn->state != SRV_CONN_BROKEN) {
        events |= UV_WRITABLE;
    }
    if (events != conn->events) {
        conn->events = events;
        if (srv_watch_start(&conn->poll, conn->fd, events, on_poll) != 0) {
            close_soon(conn);
        }
    }
}

/* ---- what waits for room ----------------------------------------------------------- */

int srv_conn_put_off(struct srv_conn *conn, const void *message, size_t bytes)
{
    srv_assert_loop();
    PCCD_ASSERT(bytes <= PROTO_MESSAGE_BYTES_MAX);
    int status = srv_deferred_keep(&conn->deferred, message, bytes);
    conn->server->put_off_count += status == 0;
    return status;
}

static struct srv_message *take_put_off(struct srv_conn *conn)
{
    struct srv_message *message = srv_deferred_take(&conn->deferred);
    conn->server->put_off_count -= message != NULL;
    return message;
}

/* It may be put off once more, as another copy. */
static void come_back(struct srv_conn *conn)
{
    struct srv_message *message = take_put_off(conn);
    srv_dispatch(conn->session, message->data, message->bytes);
    free(message);
    watch(conn);
}

void srv_conn_room(struct srv_service *service, const struct srv_quota_user *user)
{
    const struct srv_server *server = srv_server_of(service);
    srv_assert_loop();
    if (server->put_off_count == 0) {
        return;
    }
    for (struct srv_conn *conn = server->conns; conn != NULL; conn = conn->next) {
        if (conn->deferred.message != NULL && conn->state == SRV_CONN_OPEN &&
            conn->session->owner.user == user) {
            uv_timer_start(&conn->timer, on_timer, 0, 0);
        }
    }
}

/* ---- closing ----------------------------------------------------------------------- */

static void on_closed(uv_handle_t *handle)
{
    struct srv_conn *conn = handle->data;
    PCCD_ASSERT(conn->open_count > 0);
    if (--conn->open_count == 0) {
        free(conn);
    }
}

/* Give the libuv handles up, and the memory with the last of them. */
static void close_handles(struct srv_conn *conn)
{
    uv_close((uv_handle_t *)&conn->poll, on_closed);
    uv_close((uv_handle_t *)&conn->timer, on_closed);
    shutdown(conn->fd, SHUT_RDWR); /* now, whenever it is closed */
    srv_outlet_close(conn->outlet);
    conn->outlet = NULL;
    srv_closer_push(conn->server->closer, conn->fd);
    conn->fd = -1;
}

static void drop_reply(struct srv_conn *conn)
{
    srv_replyqueue_pop(&conn->replies);
    conn->server->reply_count--;
    srv_outlet_block(conn->outlet, conn->replies.count > 0);
}

void srv_conn_close(struct srv_conn *conn)
{
    srv_assert_loop();
    struct srv_server *server = conn->server;
    PCCD_ASSERT(conn->fd >= 0);
    srv_conn_send_kept(server);
    srv_refused_remove(&server->refused, &conn->refused);
    while (conn->replies.count > 0) {
        drop_reply(conn);
    }
    free(take_put_off(conn));
    if (conn->prev != NULL) {
        conn->prev->next = conn->next;
    } else {
        server->conns = conn->next;
    }
    if (conn->next != NULL) {
        conn->next->prev = conn->prev;
    }
    struct srv_session *session = conn->session;
    conn->session = NULL;
    close_handles(conn);
    if (session != NULL) {
        srv_log(SRV_LOG_DEBUG, session->id, "disconnected");
        srv_linger_lost(session);
    }
    server->conn_closed(server);
}

/* Give up on the peer; see "Does not" above. */
static void fail(struct srv_conn *conn, const char *why)
{
    if (conn->state != SRV_CONN_BROKEN) {
        srv_log(SRV_LOG_INFO, conn->session->id, "closing: %s", why);
        conn->state = SRV_CONN_BROKEN;
        shutdown(conn->fd, SHUT_RDWR);
        watch(conn);
    }
}

void srv_conn_orphan(struct srv_conn *conn)
{
    srv_assert_loop();
    fail(conn, "its session goes on over another connection");
    conn->session = NULL;
}

void srv_conn_adopt(struct srv_conn *conn, struct srv_session *session)
{
    conn->session = session;
    srv_refused_remove(&conn->server->refused, &conn->refused);
}

static void on_timer(uv_timer_t *timer)
{
    struct srv_conn *conn = timer->data;
    if (conn->state == SRV_CONN_OPEN && conn->deferred.message != NULL) {
        come_back(conn);
        return;
    }
    if (conn->state == SRV_CONN_OPEN) {
        srv_log(SRV_LOG_WARN, conn->session->id, "closing: no hello within %u s",
                HELLO_MS / 1000);
        conn->server->service.metrics.counters.sessions_dropped++;
    }
    srv_conn_close(conn);
}

static void linger_if_flushed(struct srv_conn *conn)
{
    if (conn->state == SRV_CONN_FLUSHING && conn->replies.count == 0) {
        shutdown(conn->fd, SHUT_WR);
        conn->state = SRV_CONN_LINGERING;
    }
}

void srv_conn_finish(struct srv_conn *conn)
{
    srv_assert_loop();
    srv_conn_send_kept(conn->server);
    if (conn->state == SRV_CONN_OPEN) {
        conn->state = SRV_CONN_FLUSHING;
        uv_timer_start(&conn->timer, on_timer, LINGER_MS, 0);
        linger_if_flushed(conn);
        watch(conn);
    }
}

void srv_conn_established(struct srv_conn *conn)
{
    uv_timer_stop(&conn->timer);
    srv_refused_remove(&conn->server->refused, &conn->refused);
}

/* ---- sending ----------------------------------------------------------------------- */

/* Keep a message that the socket does not take now. Takes the descriptors over. */
static int queue_reply(struct srv_conn *conn, const void *message, size_t bytes,
                       const int *fds, int fd_count)
{
    int status = srv_replyqueue_push(&conn->replies, message, bytes, fds, fd_count);
    if (status == 0) {
        conn->server->reply_count++;
        srv_outlet_block(conn->outlet, true);
    }
    return status;
}

/* The socket refuses a message. A client that has closed it ends as it would without one:
 * what it said before, as that it goes for good, is read first, its end comes behind. */
static void not_sent(struct srv_conn *conn, int status)
{
    if (status != PCCD_E_DISCONNECTED || !srv_watch_has_ended(conn->fd)) {
        fail(conn, "the client cannot be sent to");
    }
}

/* Send, or queue what the socket does not take now; takes the descriptors over. */
static void send_now(struct srv_conn *conn, const void *message, size_t bytes,
                     const int *fds, int fd_count)
{
    bool waits = conn->replies.count > 0 || conn->is_corked;
    int status =
        waits ? PCCD_E_AGAIN : proto_send(conn->fd, message, bytes, fds, fd_count);
    if (status != PCCD_E_AGAIN) {
        srv_reply_close_fds(fds, fd_count);
        if (status != 0) {
            not_sent(conn, status);
        }
        return;
    }
    if (conn->replies.count >= SRV_REPLIES_HARD_MAX) {
        srv_reply_close_fds(fds, fd_count);
        conn->server->service.metrics.counters.sessions_dropped++;
        fail(conn, "the client does not read its replies");
    } else if (queue_reply(conn, message, bytes, fds, fd_count) != 0) {
        fail(conn, "no memory to queue a reply");
    } else if (!conn->is_corked) {
        watch(conn);
    }
}

/* Send what is kept, which the thread that computes must not overtake: it may send again
 * when all is on its way. */
void srv_conn_send_kept(struct srv_server *server)
{
    struct srv_outbox *outbox = &server->outbox;
    srv_assert_loop();
    for (uint32_t i = 0; i < outbox->count; i++) {
        struct srv_conn *conn = outbox->entries[i].conn;
        if (conn->state == SRV_CONN_OPEN) {
            send_now(conn, outbox->entries[i].data, outbox->entries[i].bytes, NULL, 0);
        }
    }
    for (uint32_t i = 0; i < outbox->count; i++) {
        struct srv_conn *conn = outbox->entries[i].conn;
        srv_outlet_block(conn->outlet, conn->replies.count > 0);
    }
    srv_outbox_clear(outbox);
}

void srv_conn_send(struct srv_conn *conn, const struct proto_encoder *message,
                   const int *fds, int fd_count)
{
    srv_assert_loop();
    PCCD_ASSERT(fd_count >= 0 && fd_count <= PROTO_FDS_MAX);
    struct srv_server *server = conn->server;
    if (conn->state != SRV_CONN_OPEN) {
        srv_reply_close_fds(fds, fd_count);
        return;
    }
    if (fd_count == 0 && conn->replies.count == 0 && !conn->is_corked &&
        srv_outbox_add(&server->outbox, conn, message->data, message->bytes)) {
        srv_outlet_block(conn->outlet, true);
        return;
    }
    srv_conn_send_kept(server); /* what is kept for this one comes first */
    if (conn->state != SRV_CONN_OPEN) {
        srv_reply_close_fds(fds, fd_count);
        return;
    }
    send_now(conn, message->data, message->bytes, fds, fd_count);
}

void srv_conn_send_all(struct srv_service *service, const struct proto_encoder *message)
{
    const struct srv_server *server = srv_server_of(service);
    for (struct srv_conn *conn = server->conns; conn != NULL; conn = conn->next) {
        srv_conn_send(conn, message, NULL, 0);
    }
}

bool srv_conn_is_free(const struct srv_conn *conn)
{
    return conn->state == SRV_CONN_OPEN && conn->replies.count == 0;
}

struct srv_outlet *srv_conn_outlet(struct srv_conn *conn)
{
    srv_assert_loop();
    return srv_conn_is_free(conn) && !conn->is_corked ? srv_outlet_hold(conn->outlet)
                                                      : NULL;
}

gid_t srv_conn_group(const struct srv_conn *conn)
{
    return srv_peer_group(conn->fd);
}

bool srv_conn_has_group(const struct srv_conn *conn, gid_t gid)
{
    return srv_peer_has_group(conn->fd, gid);
}

/* Send what is queued, as far as the socket takes it, and then what else the client is to
 * hear. */
static void flush(struct srv_conn *conn)
{
    while (conn->replies.count > 0) { /* at most SRV_REPLIES_HARD_MAX */
        const struct srv_reply *reply = conn->replies.first;
        int status =
            proto_send(conn->fd, reply->data, reply->bytes, reply->fds, reply->fd_count);
        if (status == PCCD_E_AGAIN) {
            return;
        }
        if (status != 0) {
            not_sent(conn, status);
            return;
        }
        drop_reply(conn);
    }
    linger_if_flushed(conn);
    if (conn->state == SRV_CONN_OPEN && conn->session != NULL) {
        srv_shared_catch_up(conn->session);
        srv_watcher_flush(conn->session);
    }
}

/* ---- receiving --------------------------------------------------------------------- */

/* The next message, in the loop's buffer; descriptors with it are closed and counted.
 * Returns as proto_receive. Where they are refused, those that came before can only be
 * in front of the first time that there is nothing. */
static int receive(struct srv_conn *conn, size_t *bytes, int *fd_count)
{
    struct srv_server *server = conn->server;
    int fds[PROTO_FDS_RECEIVED_MAX];
    if (conn->is_bare) {
        *fd_count = 0;
        return proto_receive_bare(conn->fd, server->buffer, PROTO_MESSAGE_BYTES_MAX,
                                  bytes);
    }
    int status = proto_receive_all(conn->fd, server->buffer, PROTO_MESSAGE_BYTES_MAX,
                                   bytes, fds, fd_count);
    for (int i = 0; i < *fd_count; i++) {
        srv_closer_push(server->closer, fds[i]);
    }
    conn->is_bare = conn->refuses_fds && status == PCCD_E_AGAIN;
    return status;
}

/* One message for dispatch. Returns whether there may be more; closes at end of file. */
static bool read_one(struct srv_conn *conn)
{
    struct srv_server *server = conn->server;
    size_t bytes = 0;
    int fd_count = 0;
    errno = 0;
    int status = receive(conn, &bytes, &fd_count);
    if (status == PCCD_E_DISCONNECTED && errno == ECONNRESET) {
        /* A client that closed with answers unread is a reset first; what it had said
         * before, as that it goes for good, can still be read after it. */
        status = receive(conn, &bytes, &fd_count);
    }
    if (status == PCCD_E_AGAIN) {
        return false;
    }
    if (fd_count > 0 && status != PCCD_E_DISCONNECTED) {
        srv_dispatch_violation(conn->session, PCCD_E_BADMSG,
                               "clients may not send descriptors");
        return false;
    }
    if (status == PCCD_E_BADMSG) {
        srv_dispatch_violation(conn->session, PCCD_E_BADMSG,
                               "a message is longer than 65536");
        return false;
    }
    if (status != 0) {
        srv_conn_close(conn);
        return false;
    }
    server->service.metrics.counters.messages++;
    conn->deferred.turns = 0;
    srv_request_catch_up(&server->service);
    srv_dispatch(conn->session, server->buffer, bytes);
    if (srv_outbox_is_due(&server->outbox)) {
        srv_conn_send_kept(server);
    }
    return conn->state == SRV_CONN_OPEN && conn->deferred.message == NULL &&
           conn->replies.count < PROTO_REPLIES_QUEUED_MAX;
}

/* Messages of a client that has gone: all that its session may have had in flight. */
#define LAST_WORDS_MAX 64u

/* Turns of a client until it is asked again whether it sends ahead. */
#define ASK_AHEAD_EVERY 32u

/* Few at a turn: 16 of them would serve two fifths more of messages that are sent many
 * ahead, and as many of others; but others' answers would be later by half.
 *
 * Of a client that waits for each answer there is one: to ask for a second would be the
 * third system call of a ping. What it does not tell, the loop's next turn does.
 *
 * A client that comes back sends behind hello what had no answer. It is woken once for
 * the answers to both, and not for that to hello alone: with a thousand clients at once a
 * sixth of all switches between processes. */
void srv_conn_read(struct srv_conn *conn)
{
    if (conn->deferred.message != NULL) {
        return;
    }
    conn->is_corked = conn->is_new;
    conn->is_new = false;
    bool asks = conn->is_corked || conn->is_ahead || conn->turns++ % ASK_AHEAD_EVERY == 0;
    uint32_t count = 0;
    while (count < (asks ? PROTO_MESSAGES_PER_TURN : 1) && read_one(conn)) {
        count++;
    }
    conn->is_ahead = asks && count > 1;
    if (conn->is_corked) {
        conn->is_corked = false;
        if (conn->fd >= 0 && conn->state != SRV_CONN_BROKEN) {
            flush(conn);
        }
    }
}

/* Messages that come after the last reply are nobody's any more. */
static void discard(struct srv_conn *conn)
{
    for (uint32_t i = 0; i < PROTO_MESSAGES_PER_TURN; i++) {
        size_t bytes = 0;
        int fd_count = 0;
        int status = receive(conn, &bytes, &fd_count);
        if (status == PCCD_E_AGAIN) {
            return;
        }
        if (status == PCCD_E_DISCONNECTED || status == PCCD_E_SYSTEM) {
            srv_conn_close(conn);
            return;
        }
    }
}

/* A client that closed with something unread: libuv calls that an error. What it had said
 * before, as that it goes for good, is still there. */
static void read_last_words(struct srv_conn *conn)
{
    uint32_t count = 0;
    while (conn->fd >= 0 && conn->state == SRV_CONN_OPEN &&
           conn->deferred.message == NULL && count < LAST_WORDS_MAX && read_one(conn)) {
        count++;
    }
}

static void on_poll(uv_poll_t *poll, int status, int events)
{
    struct srv_conn *conn = poll->data;
    if (status < 0) {
        read_last_words(conn);
    }
    if (status < 0 || conn->state == SRV_CONN_BROKEN) {
        if (conn->fd >= 0) {
            srv_conn_close(conn);
        }
        return;
    }
    if ((events & UV_WRITABLE) != 0) {
        flush(conn);
    }
    bool reading = (conn->events & UV_READABLE) != 0;
    if ((events & UV_READABLE) != 0 && conn->state == SRV_CONN_OPEN) {
        srv_conn_read(conn);
    } else if ((events & UV_READABLE) != 0 && conn->state == SRV_CONN_LINGERING) {
        discard(conn);
    } else if ((events & UV_DISCONNECT) != 0 && !reading) {
        /* While reading, the end of file comes after the messages. */
        srv_conn_close(conn);
    }
    if (conn->fd >= 0) { /* freed later, by libuv's close callback */
        watch(conn);
    }
}

/* ---- creation ---------------------------------------------------------------------- */

int srv_conn_new(struct srv_server *server, int fd, const struct srv_peer *peer)
{
    srv_assert_loop();
    struct srv_conn *conn = calloc(1, sizeof *conn);
    if (conn == NULL) {
        srv_closer_push(server->closer, fd);
        return PCCD_E_NOMEM;
    }
    conn->server = server;
    conn->fd = fd;
    conn->is_new = true;
    conn->refuses_fds = proto_refuse_fds(fd);
    conn->outlet = srv_outlet_new(fd);
    if (conn->outlet == NULL || uv_poll_init(&server->uv, &conn->poll, fd) != 0) {
        int status = conn->outlet == NULL ? PCCD_E_NOMEM : PCCD_E_SYSTEM;
        if (conn->outlet != NULL) {
            srv_outlet_close(conn->outlet);
        }
        srv_closer_push(server->closer, fd);
        free(conn);
        return status;
    }
    uv_timer_init(&server->uv, &conn->timer);
    conn->open_count = 2;
    conn->poll.data = conn;
    conn->timer.data = conn;
    conn->session = srv_session_new(&server->service, conn, peer);
    if (conn->session == NULL) {
        close_handles(conn);
        return PCCD_E_NOMEM;
    }
    conn->next = server->conns;
    if (conn->next != NULL) {
        conn->next->prev = conn;
    }
    server->conns = conn;
    server->conn_count++;
    if (conn->session->state == SRV_SESSION_REFUSED) {
        srv_refused_add(&server->refused, &conn->refused, conn);
    }
    uv_timer_start(&conn->timer, on_timer, HELLO_MS, 0);
    watch(conn);
    srv_log(SRV_LOG_DEBUG, conn->session->id, "connected, user %u", (unsigned)peer->uid);
    return 0;
}
