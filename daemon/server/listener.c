/* listener.c - the socket that clients connect to. */
#include "listener.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "allow.h"
#include "conn.h"
#include "dispatch.h"
#include "host.h"
#include "invariant.h"
#include "lifeline.h"
#include "log.h"
#include "pccd_types.h"
#include "server.h"
#include "session.h"
#include "socketfile.h"
#include "watch.h"

#define ACCEPTS_PER_TURN 16
#define ACCEPTS_LAST     4096 /* of a socket that is given up */
#define RETRY_MS         100u
#define REFUSED_MIN      16u /* clients that are refused and have not closed yet */
#define REFUSED_PER_TURN 16u
#define FDS_BESIDE       512u /* descriptors of the daemon that are no connections */

/* ---- accepting --------------------------------------------------------------------- */

static void on_readable(uv_poll_t *poll, int status, int events);
static void on_retry(uv_timer_t *timer);

static void watch(struct srv_listener *listener, bool watching)
{
    if (listener->fd < 0 || watching == listener->watching) {
        return;
    }
    listener->watching = watching;
    if (!watching) {
        uv_poll_stop(&listener->poll);
    } else if (srv_watch_start(&listener->poll, listener->fd, UV_READABLE, on_readable) !=
               0) {
        listener->watching = false;
        uv_timer_start(&listener->retry, on_retry, RETRY_MS, 0);
    }
}

static uint32_t refused_max(const struct srv_options *options)
{
    return options->connections_max > REFUSED_MIN ? options->connections_max
                                                  : REFUSED_MIN;
}

/* Those of clients that are refused have places of their own. */
bool srv_host_is_full(const struct srv_service *service)
{
    const struct srv_server *server = (const struct srv_server *)(const void *)service;
    return server->conn_count - server->refused.count >=
           service->options->connections_max;
}

void srv_listener_room(struct srv_listener *listener)
{
    if (!uv_is_active((uv_handle_t *)&listener->retry)) {
        watch(listener, true);
    }
}

/* Have a descriptor to give up, again where one could not be had at once. Any will do;
 * the sandbox lets nothing be opened. */
static void keep_reserve(struct srv_listener *listener)
{
    if (listener->reserve_fd < 0) {
        listener->reserve_fd = fcntl(listener->fd, F_DUPFD_CLOEXEC, 0);
    }
}

static void on_retry(uv_timer_t *timer)
{
    struct srv_listener *listener = timer->data;
    keep_reserve(listener);
    srv_listener_room(listener);
}

static void pause_for_retry(struct srv_listener *listener)
{
    watch(listener, false);
    uv_timer_start(&listener->retry, on_retry, RETRY_MS, 0);
}

/* Close the oldest connections of refused clients until at most `count` are left; what
 * they have sent is answered first, and who has said nothing is told why. */
static void shrink_refused(struct srv_server *server, uint32_t count)
{
    struct srv_refused *refused = &server->refused;
    while (refused->count > count) {
        const struct srv_refused_link *link = refused->first;
        struct srv_conn *conn = link->conn;
        if (conn->state == SRV_CONN_OPEN) {
            srv_conn_read(conn); /* it may have spoken; it may even find a place */
        }
        if (link->conn != NULL && conn->fd >= 0 && conn->state == SRV_CONN_OPEN) {
            srv_dispatch_refuse_silent(conn->session);
        }
        if (link->conn != NULL) {
            srv_conn_close(conn); /* takes it out */
        }
        PCCD_ASSERT(link != refused->first);
    }
}

/* No descriptor is left: have some of those back that refused clients hold, or else turn
 * the next client away with the reserve, so that it does not wait for nothing; then
 * pause. */
static void turn_away(struct srv_listener *listener)
{
    struct srv_server *server = listener->server;
    uint32_t refused = server->refused.count;
    if (refused > 0) {
        shrink_refused(server,
                       refused > REFUSED_PER_TURN ? refused - REFUSED_PER_TURN : 0);
        pause_for_retry(listener);
        return;
    }
    srv_log(SRV_LOG_WARN, 0, "no descriptor for a new connection");
    server->service.metrics.counters.sessions_refused++;
    if (listener->reserve_fd >= 0) {
        close(listener->reserve_fd);
        listener->reserve_fd = -1;
        int fd = accept4(listener->fd, NULL, NULL, SOCK_CLOEXEC);
        if (fd >= 0) {
            shutdown(fd, SHUT_RDWR);
            srv_closer_push(listener->server->closer, fd);
        }
    }
    keep_reserve(listener);
    pause_for_retry(listener);
}

/* Take one connection over. Returns whether to try for another at once. */
static bool accept_one(struct srv_listener *listener)
{
    struct srv_server *server = listener->server;
    keep_reserve(listener);
    int fd = accept4(listener->fd, NULL, NULL, SOCK_CLOEXEC | SOCK_NONBLOCK);
    if (fd < 0) {
        switch (errno) {
        case EINTR:
        case ECONNABORTED:
            return true;
        case EMFILE:
        case ENFILE:
            turn_away(listener);
            return false;
        case EAGAIN:
            return false;
        default:
            srv_log(SRV_LOG_WARN, 0, "accept: %s", strerror(errno));
            pause_for_retry(listener);
            return false;
        }
    }
    struct ucred peer;
    socklen_t bytes = sizeof peer;
    if ((uint32_t)fd >= listener->fd_count) {
        srv_closer_push(server->closer, fd); /* libuv has no room for it */
        turn_away(listener);
        return false;
    }
    if (getsockopt(fd, SOL_SOCKET, SO_PEERCRED, &peer, &bytes) != 0) {
        srv_closer_push(server->closer, fd);
        return true;
    }
    shrink_refused(server, refused_max(server->service.options) - 1);
    const struct srv_peer client = {
        .uid = peer.uid,
        .pid = peer.pid,
        .is_stranger = !srv_allow_peer(&server->service.options->allow, fd, &peer),
        .came_when_full = srv_host_is_full(&server->service)};
    if (srv_conn_new(server, fd, &client) != 0) {
        server->service.metrics.counters.sessions_refused++;
        srv_log(SRV_LOG_WARN, 0, "a connection of user %u was turned away",
                (unsigned)peer.uid);
    }
    return true;
}

static void on_readable(uv_poll_t *poll, int status, int events)
{
    struct srv_listener *listener = poll->data;
    (void)events;
    if (status < 0) {
        srv_log(SRV_LOG_ERROR, 0, "listener: %s", uv_strerror(status));
        listener->watching = false; /* libuv has stopped it */
        pause_for_retry(listener);
        return;
    }
    srv_conn_send_kept(listener->server); /* each accept takes longer than a message */
    for (int i = 0; i < ACCEPTS_PER_TURN && accept_one(listener); i++) {
    }
}

/* ---- the file of the socket -------------------------------------------------------- */

static void drop_reserve(struct srv_listener *listener)
{
    if (listener->reserve_fd >= 0) {
        close(listener->reserve_fd);
        listener->reserve_fd = -1;
    }
}

/* Listen on another socket, under the same number. Who came to the former one before its
 * file went is still taken over, if there is room. */
static void replace_socket(struct srv_listener *listener, int fd)
{
    for (int i = 0; i < ACCEPTS_LAST && accept_one(listener); i++) {
    }
    watch(listener, false);
    uv_timer_stop(&listener->retry);
    drop_reserve(listener); /* it is of the former one */
    int made = dup3(fd, listener->fd, O_CLOEXEC);
    close(fd);
    if (made < 0) {
        listener->server->path_lost(listener->server, strerror(errno));
        return;
    }
    keep_reserve(listener);
    srv_listener_room(listener);
}

/* Our own file is not there any more. */
static void bind_anew(struct srv_listener *listener, enum srv_socketfile_state state)
{
    struct srv_server *server = listener->server;
    int fd = -1;
    if (state == SRV_SOCKETFILE_TAKEN) {
        server->path_lost(server, "something else is there now");
    } else if (!srv_lockfile_is_held(server->lockfile)) {
        server->path_lost(server, "it was removed, and its lock file too");
    } else if (srv_socketfile_bind(&listener->file, server->service.options, &fd) != 0) {
        server->path_lost(server, strerror(errno));
    } else {
        srv_log(SRV_LOG_WARN, 0, "%s was removed; listening there again",
                listener->file.path);
        replace_socket(listener, fd);
    }
}

static void on_look(uv_timer_t *timer)
{
    struct srv_listener *listener = timer->data;
    enum srv_socketfile_state state = srv_socketfile_look(&listener->file);
    if (state != SRV_SOCKETFILE_OURS &&
        listener->server->service.options->listen_fd < 0) {
        bind_anew(listener, state);
    } else if (state != SRV_SOCKETFILE_OURS) {
        srv_log(SRV_LOG_ERROR, 0,
                "%s was removed: new clients cannot find the daemon until whoever made "
                "it makes it anew (systemctl restart pccdd.socket)",
                listener->file.path);
    }
}

/* From the supervisor: another socket, or none any more. */
static void on_supervisor(struct srv_listener *listener)
{
    int fd = -1;
    int status = srv_lifeline_hear(&fd);
    if (status == PCCD_E_AGAIN) {
        return;
    }
    if (status != 0) {
        uv_poll_stop(&listener->news); /* it is gone: a signal comes, too */
    } else if (fd >= 0) {
        replace_socket(listener, fd);
    } else {
        listener->server->path_lost(listener->server, "its supervisor has");
    }
}

static void on_news(uv_poll_t *poll, int status, int events)
{
    struct srv_listener *listener = poll->data;
    (void)events;
    if (status < 0) {
        uv_poll_stop(poll);
    } else if (srv_lifeline_fd() >= 0) {
        on_supervisor(listener);
    } else if (srv_socketfile_look(&listener->file) != SRV_SOCKETFILE_OURS) {
        uv_timer_start(&listener->look, on_look, SRV_SOCKETFILE_SETTLE_MS, 0);
    }
}

int srv_listener_follow(struct srv_listener *listener)
{
    struct srv_server *server = listener->server;
    int fd = srv_lifeline_fd();
    if (fd < 0 && server->service.options->listen_fd >= 0) {
        srv_socketfile_adopt(&listener->file, server->service.options->socket_path);
    }
    if (fd < 0) {
        fd = listener->file.notify_fd;
    }
    if (fd < 0) {
        return 0; /* nobody tells */
    }
    if ((uint32_t)fd >= listener->fd_count ||
        uv_poll_init(&server->uv, &listener->news, fd) != 0) {
        return PCCD_E_SYSTEM;
    }
    uv_timer_init(&server->uv, &listener->look);
    listener->news.data = listener;
    listener->look.data = listener;
    listener->is_following = true;
    return srv_watch_start(&listener->news, fd, UV_READABLE, on_news);
}

/* Follow it no more, and remove it, if it is our own; one that was given to us goes on to
 * listen. */
static void drop_file(struct srv_listener *listener)
{
    if (listener->is_following) {
        uv_close((uv_handle_t *)&listener->news, NULL);
        uv_close((uv_handle_t *)&listener->look, NULL);
        listener->is_following = false;
    }
    if (listener->server->service.options->listen_fd < 0) {
        srv_socketfile_remove(&listener->file);
    } else {
        srv_socketfile_leave(&listener->file);
    }
}

/* ---- life -------------------------------------------------------------------------- */

static void tell(int fd, const char *byte)
{
    if (fd >= 0) {
        if (write(fd, byte, 1) != 1) {
            srv_log(SRV_LOG_WARN, 0, "cannot write to --ready-fd %d: its reader is gone",
                    fd);
        }
        close(fd);
    }
}

void srv_listener_tell_ready(int fd)
{
    tell(fd, "1");
}

void srv_listener_tell_held(int fd)
{
    tell(fd, "0");
}

static uint32_t fd_count_of(const struct srv_options *options)
{
    /* A client has a descriptor and two of its ring, and for a moment two more. */
    return 5 * options->connections_max + refused_max(options) + FDS_BESIDE;
}

void srv_listener_make_room(const struct srv_options *options)
{
    srv_watch_widen(fd_count_of(options));
}

int srv_listener_open(struct srv_listener *listener, struct srv_server *server)
{
    const char *path = server->service.options->socket_path;
    *listener = (struct srv_listener){.server = server, .fd = -1, .reserve_fd = -1};
    int fd = server->service.options->listen_fd;
    int status =
        fd >= 0 ? 0 : srv_socketfile_bind(&listener->file, server->service.options, &fd);
    if (status != 0) {
        srv_log(SRV_LOG_ERROR, 0, "%s: %s", path, strerror(errno));
        return status;
    }
    listener->fd_count = fd_count_of(server->service.options);
    if (srv_watch_reserve(&server->uv, &listener->spare, fd, &listener->fd_count) != 0 ||
        uv_poll_init(&server->uv, &listener->poll, fd) != 0) {
        srv_log(SRV_LOG_ERROR, 0, "%s: the socket cannot be watched", path);
        srv_socketfile_remove(&listener->file);
        close(fd);
        return PCCD_E_SYSTEM;
    }
    uv_timer_init(&server->uv, &listener->retry);
    listener->poll.data = listener;
    listener->retry.data = listener;
    listener->fd = fd;
    keep_reserve(listener);
    return 0;
}

void srv_listener_close(struct srv_listener *listener)
{
    if (listener->fd < 0) {
        return;
    }
    drop_file(listener);
    watch(listener, false);
    uv_close((uv_handle_t *)&listener->poll, NULL);
    uv_close((uv_handle_t *)&listener->retry, NULL);
    close(listener->fd);
    listener->fd = -1;
    drop_reserve(listener);
}
