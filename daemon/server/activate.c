/* activate.c - a listening socket that somebody else has opened for us. */
#include "notify.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "log.h"
#include "pccd_types.h"

long srv_number_of(const char *name)
{
    const char *text = getenv(name);
    char *end = NULL;
    long value =
        text != NULL && text[0] >= '0' && text[0] <= '9' ? strtol(text, &end, 10) : -1;
    return end != NULL && *end == '\0' ? value : -1;
}

int srv_number_give(const char *name, int fd)
{
    char number[32];
    if (fd < 0) {
        return 0;
    }
    int kept = fcntl(fd, F_DUPFD, SRV_GIVEN_FD_FLOOR); /* open across exec */
    if (kept < 0) {
        return PCCD_E_SYSTEM;
    }
    snprintf(number, sizeof number, "%d", kept);
    return setenv(name, number, 1) == 0 ? 0 : PCCD_E_SYSTEM;
}

static int int_option(int fd, int option)
{
    int value = -1;
    socklen_t bytes = sizeof value;
    return getsockopt(fd, SOL_SOCKET, option, &value, &bytes) == 0 ? value : -1;
}

static int refuse(const char *what)
{
    srv_log(SRV_LOG_ERROR, 0, "socket activation: %s", what);
    return PCCD_E_INVAL;
}

/* The path that it is bound to. */
static int take_path(int fd, struct srv_options *options)
{
    struct sockaddr_un address = {.sun_family = AF_UNSPEC};
    socklen_t bytes = sizeof address;
    if (getsockname(fd, (struct sockaddr *)&address, &bytes) != 0 ||
        address.sun_family != AF_UNIX) {
        return refuse("descriptor 3 is not a Unix socket");
    }
    size_t length = bytes - offsetof(struct sockaddr_un, sun_path);
    if (bytes <= offsetof(struct sockaddr_un, sun_path) || address.sun_path[0] == '\0') {
        return refuse("the socket has no path");
    }
    snprintf(options->socket_path, sizeof options->socket_path, "%.*s", (int)length,
             address.sun_path);
    return 0;
}

int srv_activate(struct srv_options *options)
{
    bool ours = srv_number_of("LISTEN_PID") == (long)getpid();
    long count = srv_number_of("LISTEN_FDS");
    /* Nobody we start may take them for its own. */
    unsetenv("LISTEN_PID");
    unsetenv("LISTEN_FDS");
    unsetenv("LISTEN_FDNAMES");
    if (!ours) {
        return 0;
    }
    if (count != 1) {
        return refuse("exactly one socket is wanted");
    }
    int fd = SRV_ACTIVATE_FD;
    if (int_option(fd, SO_TYPE) != SOCK_SEQPACKET || int_option(fd, SO_ACCEPTCONN) != 1) {
        return refuse("descriptor 3 is not a listening SOCK_SEQPACKET socket "
                      "(ListenSequentialPacket=)");
    }
    int flags = fcntl(fd, F_GETFL);
    if (flags < 0 || fcntl(fd, F_SETFL, flags | O_NONBLOCK) != 0 ||
        fcntl(fd, F_SETFD, FD_CLOEXEC) != 0) {
        return refuse(strerror(errno));
    }
    options->listen_fd = fd;
    return take_path(fd, options);
}

int srv_activate_give(int fd)
{
    char pid[32];
    snprintf(pid, sizeof pid, "%ld", (long)getpid());
    if (fd == SRV_ACTIVATE_FD) {
        if (fcntl(fd, F_SETFD, 0) != 0) {
            return PCCD_E_SYSTEM;
        }
    } else if (dup2(fd, SRV_ACTIVATE_FD) < 0) {
        return PCCD_E_SYSTEM;
    }
    return setenv("LISTEN_PID", pid, 1) == 0 && setenv("LISTEN_FDS", "1", 1) == 0
               ? 0
               : PCCD_E_SYSTEM;
}

#define STANDBY_NAME "PCCD_STANDBY"

int srv_standby_give(int fd)
{
    return srv_number_give(STANDBY_NAME, fd);
}

bool srv_standby(void)
{
    long fd = srv_number_of(STANDBY_NAME);
    char byte;
    ssize_t got;
    unsetenv(STANDBY_NAME);
    if (fd < SRV_GIVEN_FD_FLOOR || fd > INT_MAX) {
        return true;
    }
    do {
        got = read((int)fd, &byte, 1);
    } while (got < 0 && errno == EINTR);
    close((int)fd);
    return got == 1;
}
