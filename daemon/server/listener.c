/* listener.c - the socket that clients connect to.
 *
 * Room:     server. See listener.h.
 * Does:     binds itself, because libuv cuts long paths silently; accepts a bounded
 *           number of connections per event.
 * Does not: watch the socket while a connection could not be served: at the limit until
 *           one goes, after a refusal of the system for RETRY_MS. The backlog waits
 *           meanwhile.
 * Threads:  [loop]
 */
#include "listener.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include "allow.h"
#include "closer.h"
#include "conn.h"
#include "invariant.h"
#include "pccd_types.h"
#include "reactor.h"
#include "session.h"
#include "watch.h"

#define BACKLOG          4096 /* clients that all come back after a crash */
#define ACCEPTS_PER_TURN 16
#define RETRY_MS         100u
#define FDS_BESIDE       512u /* descriptors of the daemon that are no connections */

/* ---- the path ---------------------------------------------------------------------- */

int srv_listener_prepare_folder(const struct srv_options *options)
{
    const char *socket_path = options->socket_path;
    mode_t mode = srv_allow_has_list(&options->allow) ? 0711 : 0700;
    char folder[SRV_SOCKET_PATH_BYTES];
    const char *slash = strrchr(socket_path, '/');
    if (slash == NULL || slash == socket_path) {
        return 0; /* the current folder, or the root */
    }
    snprintf(folder, sizeof folder, "%.*s", (int)(slash - socket_path), socket_path);
    mode_t before = umask(0); /* no other thread creates files */
    int failed = mkdir(folder, mode);
    umask(before);
    if (failed != 0 && errno != EEXIST) {
        srv_log(SRV_LOG_ERROR, 0, "%s: %s", folder, strerror(errno));
        return PCCD_E_SYSTEM;
    }
    struct stat info;
    if (lstat(folder, &info) != 0) {
        srv_log(SRV_LOG_ERROR, 0, "%s: %s", folder, strerror(errno));
        return PCCD_E_SYSTEM;
    }
    /* In a folder where others may rename, they could put their socket in place of ours.
     * A link is judged by what it leads to, unless somebody else made it. */
    bool ours = info.st_uid == geteuid() || info.st_uid == 0;
    if (ours && S_ISLNK(info.st_mode)) {
        ours = stat(folder, &info) == 0 && (info.st_uid == geteuid() || info.st_uid == 0);
    }
    bool open_to_all =
        (info.st_mode & (S_IWGRP | S_IWOTH)) != 0 && (info.st_mode & S_ISVTX) == 0;
    if (!ours || !S_ISDIR(info.st_mode) || open_to_all) {
        srv_log(
            SRV_LOG_ERROR, 0,
            "%s must be a folder of this user or of root that nobody else can write to",
            folder);
        return PCCD_E_SYSTEM;
    }
    return 0;
}

/* Remove what a dead daemon left; anything but a socket stays. */
static int remove_stale(const char *path)
{
    struct stat info;
    if (lstat(path, &info) != 0) {
        return errno == ENOENT ? 0 : PCCD_E_SYSTEM;
    }
    if (!S_ISSOCK(info.st_mode)) {
        errno = EEXIST;
        return PCCD_E_SYSTEM;
    }
    return unlink(path) == 0 ? 0 : PCCD_E_SYSTEM;
}

int srv_listener_bind(const struct srv_options *options, int *fd)
{
    const char *path = options->socket_path;
    struct sockaddr_un address = {.sun_family = AF_UNIX};
    PCCD_ASSERT(strlen(path) < sizeof address.sun_path); /* checked with the options */
    strcpy(address.sun_path, path);
    int made = socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    if (made < 0) {
        return PCCD_E_SYSTEM;
    }
    int status = remove_stale(path);
    if (status == 0) {
        mode_t mask = srv_allow_has_list(&options->allow) ? 0111 : 0177;
        mode_t before = umask(mask); /* no other thread creates files */
        status = bind(made, (const struct sockaddr *)&address, sizeof address) == 0
                     ? 0
                     : PCCD_E_SYSTEM;
        umask(before);
    }
    if (status == 0 && listen(made, BACKLOG) != 0) {
        status = PCCD_E_SYSTEM;
    }
    if (status != 0) {
        int saved = errno;
        close(made);
        errno = saved;
        return status;
    }
    *fd = made;
    return 0;
}

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

void srv_listener_room(struct srv_listener *listener)
{
    struct srv_reactor *reactor = listener->reactor;
    if (reactor->conn_count < reactor->loop.options->connections_max &&
        !uv_is_active((uv_handle_t *)&listener->retry)) {
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

/* No descriptor is left: turn the next client away with the reserve, so that it does not
 * wait for nothing, then pause. */
static void turn_away(struct srv_listener *listener)
{
    srv_log(SRV_LOG_WARN, 0, "no descriptor for a new connection");
    listener->reactor->loop.metrics.counters.sessions_refused++;
    if (listener->reserve_fd >= 0) {
        close(listener->reserve_fd);
        listener->reserve_fd = -1;
        int fd = accept4(listener->fd, NULL, NULL, SOCK_CLOEXEC);
        if (fd >= 0) {
            shutdown(fd, SHUT_RDWR);
            srv_closer_push(listener->reactor->closer, fd);
        }
    }
    keep_reserve(listener);
    pause_for_retry(listener);
}

/* Take one connection over. Returns whether to try for another at once. */
static bool accept_one(struct srv_listener *listener)
{
    struct srv_reactor *reactor = listener->reactor;
    if (reactor->conn_count >= reactor->loop.options->connections_max) {
        watch(listener, false); /* srv_listener_room goes on */
        return false;
    }
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
        srv_closer_push(reactor->closer, fd); /* libuv has no room for it */
        turn_away(listener);
        return false;
    }
    if (getsockopt(fd, SOL_SOCKET, SO_PEERCRED, &peer, &bytes) != 0) {
        srv_closer_push(reactor->closer, fd);
        return true;
    }
    const struct srv_peer client = {
        .uid = peer.uid,
        .pid = peer.pid,
        .is_stranger = !srv_allow_peer(&reactor->loop.options->allow, fd, &peer)};
    if (srv_conn_new(reactor, fd, &client) != 0) {
        reactor->loop.metrics.counters.sessions_refused++;
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
    srv_conn_send_kept(listener->reactor); /* each accept takes longer than a message */
    for (int i = 0; i < ACCEPTS_PER_TURN && accept_one(listener); i++) {
    }
}

/* ---- life -------------------------------------------------------------------------- */

/* Remove our socket; one that was given to us goes on to listen. */
static void remove_path(const struct srv_options *options)
{
    if (options->listen_fd < 0) {
        unlink(options->socket_path);
    }
}

static void tell(int fd, const char *byte)
{
    if (fd >= 0) {
        if (write(fd, byte, 1) != 1) {
            srv_log(SRV_LOG_WARN, 0, "nobody waits on --ready-fd %d", fd);
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
    return 2 * options->connections_max + FDS_BESIDE;
}

void srv_listener_make_room(const struct srv_options *options)
{
    srv_watch_widen(fd_count_of(options));
}

int srv_listener_open(struct srv_listener *listener, struct srv_reactor *reactor)
{
    const char *path = reactor->loop.options->socket_path;
    *listener = (struct srv_listener){.reactor = reactor, .fd = -1, .reserve_fd = -1};
    int fd = reactor->loop.options->listen_fd;
    int status = fd >= 0 ? 0 : srv_listener_bind(reactor->loop.options, &fd);
    if (status != 0) {
        srv_log(SRV_LOG_ERROR, 0, "%s: %s", path, strerror(errno));
        return status;
    }
    listener->fd_count = fd_count_of(reactor->loop.options);
    if (srv_watch_reserve(&reactor->uv, &listener->spare, fd, &listener->fd_count) != 0 ||
        uv_poll_init(&reactor->uv, &listener->poll, fd) != 0) {
        srv_log(SRV_LOG_ERROR, 0, "%s: the socket cannot be watched", path);
        remove_path(reactor->loop.options);
        close(fd);
        return PCCD_E_SYSTEM;
    }
    uv_timer_init(&reactor->uv, &listener->retry);
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
    remove_path(listener->reactor->loop.options);
    watch(listener, false);
    uv_close((uv_handle_t *)&listener->poll, NULL);
    uv_close((uv_handle_t *)&listener->retry, NULL);
    close(listener->fd);
    listener->fd = -1;
    if (listener->reserve_fd >= 0) {
        close(listener->reserve_fd);
        listener->reserve_fd = -1;
    }
}
