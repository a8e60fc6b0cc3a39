/* notify.c - tell the service manager that started us how we are. */
#include "notify.h"

#include <errno.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <sys/un.h>
#include <unistd.h>

#include "log.h"
#include "pccd_types.h"

#define ANNOUNCE_S 1

static int notify_fd = -1; /* -1: nobody wants to know; held until the process ends */
static struct sockaddr_un manager;
static socklen_t manager_bytes;
static uint64_t watchdog_us; /* 0: nobody waits for us to be silent */

static uint64_t wanted_watchdog_us(void)
{
    long us = srv_number_of("WATCHDOG_USEC");
    bool ours =
        getenv("WATCHDOG_PID") == NULL || srv_number_of("WATCHDOG_PID") == (long)getpid();
    return ours && us > 0 ? (uint64_t)us : 0;
}

void srv_notify_open(void)
{
    const char *name = getenv("NOTIFY_SOCKET");
    const struct timeval patience = {.tv_sec = ANNOUNCE_S};
    if (name == NULL || name[0] == '\0') {
        return;
    }
    size_t length = strlen(name);
    if ((name[0] != '/' && name[0] != '@') || length < 2 ||
        length >= sizeof manager.sun_path) {
        srv_log(SRV_LOG_WARN, 0, "NOTIFY_SOCKET=%s: neither a path nor an abstract name",
                name);
        return;
    }
    manager = (struct sockaddr_un){.sun_family = AF_UNIX};
    memcpy(manager.sun_path, name, length);
    manager_bytes = (socklen_t)(offsetof(struct sockaddr_un, sun_path) + length);
    if (name[0] == '@') {
        manager.sun_path[0] = '\0'; /* its length ends an abstract name */
    } else {
        manager_bytes++;
    }
    notify_fd = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    if (notify_fd < 0) {
        srv_log(SRV_LOG_WARN, 0, "the service manager cannot be told: %s",
                strerror(errno));
        return;
    }
    (void)setsockopt(notify_fd, SOL_SOCKET, SO_SNDTIMEO, &patience, sizeof patience);
    watchdog_us = wanted_watchdog_us();
}

bool srv_notify_is_open(void)
{
    return notify_fd >= 0;
}

static bool send_lines(const char *lines, int flags)
{
    ssize_t sent;
    if (notify_fd < 0) {
        return true;
    }
    do {
        sent = sendto(notify_fd, lines, strlen(lines), flags | MSG_NOSIGNAL,
                      (const struct sockaddr *)&manager, manager_bytes);
    } while (sent < 0 && errno == EINTR);
    return sent >= 0;
}

void srv_notify_say(const char *lines)
{
    (void)send_lines(lines, MSG_DONTWAIT);
}

void srv_notify_announce(const char *lines)
{
    if (!send_lines(lines, 0)) {
        srv_log(SRV_LOG_WARN, 0, "the service manager does not listen: %s",
                strerror(errno));
    }
}

void srv_notify_ready(void)
{
    char lines[64];
    snprintf(lines, sizeof lines, "READY=1\nMAINPID=%ld", (long)getpid());
    srv_notify_announce(lines);
}

uint64_t srv_notify_watchdog_us(void)
{
    return watchdog_us;
}

int srv_notify_give(void)
{
    char pid[32];
    if (watchdog_us == 0) {
        return 0;
    }
    snprintf(pid, sizeof pid, "%ld", (long)getpid());
    return setenv("WATCHDOG_PID", pid, 1) == 0 ? 0 : PCCD_E_SYSTEM;
}
