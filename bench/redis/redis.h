/* redis.h - a Redis server of the benchmark's own, and the two commands that it is asked.
 *
 * Threads: one.
 */
#ifndef BENCH_REDIS_H
#define BENCH_REDIS_H

#include <stdbool.h>
#include <stddef.h>
#include <sys/types.h>

#define REDIS_PING       "*1\r\n$4\r\nPING\r\n"
#define REDIS_PING_BYTES (sizeof REDIS_PING - 1)
#define REDIS_PONG       "+PONG\r\n"
#define REDIS_PONG_BYTES (sizeof REDIS_PONG - 1)

struct redis {
    pid_t pid; /* 0: none */
    char folder[64];
    char socket[96];
};

/* False: redis-server is not installed, or does not serve; said on stderr. It ends with
 * this process, whatever ends that. */
bool redis_start(struct redis *redis);
void redis_stop(struct redis *redis);

/* A connected socket; exits with 2 without one. */
int redis_connect(const struct redis *redis);

/* Each waits for the reply. False: it is not the one that must come. */
bool redis_ping(int fd);
bool redis_set(int fd, const void *value, size_t bytes);

#endif
