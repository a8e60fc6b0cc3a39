/* redis.c - a Redis of one's own, and the two things asked of it. */
#include "rows.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/uio.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#define START_MS 10000

static void become_redis(const struct redis *redis, pid_t parent)
{
    const char *arguments[] = {"redis-server",
                               "--port",
                               "0",
                               "--unixsocket",
                               redis->socket,
                               "--save",
                               "",
                               "--appendonly",
                               "no",
                               "--daemonize",
                               "no",
                               "--loglevel",
                               "warning",
                               "--dir",
                               redis->folder,
                               NULL};
    int null = open("/dev/null", O_WRONLY);
    if (null >= 0 && dup2(null, 1) == 1 && prctl(PR_SET_PDEATHSIG, SIGKILL) == 0 &&
        getppid() == parent) {
        execvp(arguments[0], (char *const *)(uintptr_t)arguments);
    }
    _exit(127);
}

static int try_connect(const struct redis *redis)
{
    struct sockaddr_un address = {.sun_family = AF_UNIX};
    int fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
    strcpy(address.sun_path, redis->socket);
    if (fd >= 0 && connect(fd, (struct sockaddr *)&address, sizeof address) != 0) {
        close(fd);
        return -1;
    }
    return fd;
}

static bool has_begun(struct redis *redis)
{
    for (int ms = 0; ms < START_MS; ms += 10) {
        int fd = try_connect(redis);
        bool serves = fd >= 0 && redis_ping(fd);
        close(fd);
        if (serves) {
            return true;
        }
        if (waitpid(redis->pid, NULL, WNOHANG) == redis->pid) {
            redis->pid = 0;
            return false;
        }
        nanosleep(&(struct timespec){0, 10000000}, NULL);
    }
    return false;
}

bool redis_start(struct redis *redis)
{
    const char *base = getenv("TMPDIR");
    *redis = (struct redis){0};
    snprintf(redis->folder, sizeof redis->folder, "%.40s/bench-redis-XXXXXX",
             base && strlen(base) <= 40 ? base : "/tmp");
    if (!mkdtemp(redis->folder)) {
        perror(redis->folder);
        return false;
    }
    snprintf(redis->socket, sizeof redis->socket, "%s/redis.sock", redis->folder);
    pid_t parent = getpid();
    redis->pid = fork();
    if (redis->pid == 0) {
        become_redis(redis, parent);
    }
    if (redis->pid < 0 || !has_begun(redis)) {
        fprintf(stderr, "redis-server does not start; is it installed?\n");
        redis_stop(redis);
        return false;
    }
    return true;
}

void redis_stop(struct redis *redis)
{
    if (redis->pid > 0) {
        kill(redis->pid, SIGKILL);
        waitpid(redis->pid, NULL, 0);
        redis->pid = 0;
    }
    unlink(redis->socket);
    rmdir(redis->folder);
}

int redis_connect(const struct redis *redis)
{
    int fd = try_connect(redis);
    bench_need(fd >= 0, redis->socket);
    return fd;
}

/* ---- requests ---------------------------------------------------------------------- */

static bool expect(int fd, const char *reply, size_t bytes)
{
    char got[64];
    size_t count = 0;
    while (count < bytes) {
        ssize_t n = recv(fd, got + count, sizeof got - count, 0);
        if (n <= 0 && !(n < 0 && errno == EINTR)) {
            return false;
        }
        count += n > 0 ? (size_t)n : 0;
    }
    return count == bytes && memcmp(got, reply, bytes) == 0;
}

bool redis_ping(int fd)
{
    return send(fd, REDIS_PING, REDIS_PING_BYTES, MSG_NOSIGNAL) ==
               (ssize_t)REDIS_PING_BYTES &&
           expect(fd, REDIS_PONG, REDIS_PONG_BYTES);
}

/* All of it; Redis reads while we write. */
static bool write_all(int fd, struct iovec *parts, int count)
{
    while (count > 0) {
        ssize_t n = writev(fd, parts, count);
        if (n < 0 && errno != EINTR) {
            return false;
        }
        for (size_t left = n > 0 ? (size_t)n : 0; count > 0;) {
            if (left < parts->iov_len) {
                parts->iov_base = (char *)parts->iov_base + left;
                parts->iov_len -= left;
                break;
            }
            left -= parts->iov_len;
            parts++;
            count--;
        }
    }
    return true;
}

bool redis_set(int fd, const void *value, size_t bytes)
{
    char head[64];
    int length =
        snprintf(head, sizeof head, "*3\r\n$3\r\nSET\r\n$1\r\nx\r\n$%zu\r\n", bytes);
    struct iovec parts[] = {{head, (size_t)length},
                            {(void *)(uintptr_t)value, bytes},
                            {(void *)(uintptr_t) "\r\n", 2}};
    return write_all(fd, parts, 3) && expect(fd, "+OK\r\n", 5);
}
