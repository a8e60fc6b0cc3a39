/* lifeline.c - a pair of sockets between a supervisor and its worker. */
#include "lifeline.h"

#include <fcntl.h>
#include <limits.h>
#include <stdlib.h>
#include <sys/socket.h>
#include <unistd.h>

#include "log.h"
#include "notify.h"
#include "pccd_types.h"
#include "seqpacket.h"

#define NAME "PCCD_LIFELINE"

static int held_fd = -1; /* -1: nobody supervises us */

int srv_lifeline_make(int ends[2])
{
    return socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends) == 0
               ? 0
               : PCCD_E_SYSTEM;
}

int srv_lifeline_give(int fd)
{
    return srv_number_give(NAME, fd);
}

void srv_lifeline_take(void)
{
    long fd = srv_number_of(NAME);
    unsetenv(NAME);
    if (fd >= SRV_GIVEN_FD_FLOOR && fd <= INT_MAX &&
        fcntl((int)fd, F_SETFD, FD_CLOEXEC) == 0) {
        held_fd = (int)fd;
    }
}

void srv_lifeline_raise(uint32_t count)
{
    /* Where the number is taken nothing is lost but time. */
    int raised = held_fd < 0 || count == 0 || count > INT_MAX
                     ? -1
                     : fcntl(held_fd, F_DUPFD_CLOEXEC, (int)count - 1);
    if (raised >= 0) {
        close(held_fd);
        held_fd = raised;
    }
}

int srv_lifeline_fd(void)
{
    return held_fd;
}

int srv_lifeline_tell(int lifeline, int listen_fd)
{
    return proto_send(lifeline, "l", 1, &listen_fd, listen_fd >= 0 ? 1 : 0);
}

int srv_lifeline_hear(int *fd)
{
    char byte;
    size_t bytes = 0;
    int fds[PROTO_FDS_MAX];
    int fd_count = 0;
    int status = proto_receive(held_fd, &byte, 1, &bytes, fds, &fd_count);
    *fd = status == 0 && fd_count > 0 ? fds[0] : -1;
    return status;
}

void srv_lifeline_say_end(void)
{
    if (held_fd >= 0 && write(held_fd, "e", 1) != 1) {
        srv_log(SRV_LOG_WARN, 0, "the supervisor cannot be told of the end");
    }
}
