/* watch.c - libuv's polls, without its ways to end the process. */
#include "watch.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stddef.h>
#include <sys/epoll.h>
#include <sys/resource.h>
#include <unistd.h>

#include "invariant.h"
#include "pccd_types.h"

int srv_watch_start(uv_poll_t *poll, int fd, int events, uv_poll_cb on_poll)
{
    int failed = uv_poll_start(poll, events, on_poll); /* takes it out of epoll first */
    PCCD_ASSERT(failed == 0);
    struct epoll_event none = {.data.fd = fd};
    if (epoll_ctl(uv_backend_fd(poll->loop), EPOLL_CTL_ADD, fd, &none) == 0 ||
        errno == EEXIST) {
        return 0;
    }
    uv_poll_stop(poll);
    return PCCD_E_SYSTEM;
}

/* At most as many descriptors as this process may have. */
static uint32_t allowed(uint32_t count)
{
    struct rlimit limit;
    return getrlimit(RLIMIT_NOFILE, &limit) == 0 && limit.rlim_cur < count
               ? (uint32_t)limit.rlim_cur
               : count;
}

void srv_watch_widen(uint32_t count)
{
    int last = fcntl(STDERR_FILENO, F_DUPFD_CLOEXEC, (int)allowed(count) - 1);
    if (last >= 0) {
        close(last);
    }
}

int srv_watch_reserve(uv_loop_t *loop, uv_poll_t *poll, int fd, uint32_t *count)
{
    *count = allowed(*count);
    /* The table grows to the largest number that is watched, and never shrinks. */
    int last = fcntl(fd, F_DUPFD_CLOEXEC, (int)*count - 1);
    if (last < 0 || uv_poll_init(loop, poll, last) != 0) {
        if (last >= 0) {
            close(last);
        }
        return PCCD_E_SYSTEM;
    }
    int failed = uv_poll_start(poll, UV_READABLE, NULL);
    PCCD_ASSERT(failed == 0);
    uv_close((uv_handle_t *)poll, NULL); /* stops it, too: NULL is never called */
    close(last);
    return 0;
}

bool srv_watch_has_ended(int fd)
{
    struct pollfd socket = {.fd = fd};
    return poll(&socket, 1, 0) == 1 && (socket.revents & POLLHUP) != 0;
}
