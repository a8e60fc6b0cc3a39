/* rows.h - the rows of the comparison with Redis: whom they ask, how two compare. */
#ifndef BENCH_REDIS_ROWS_H
#define BENCH_REDIS_ROWS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>

#include "pccd.h"
#include "report.h"

/* ---- Compares two things that are measured in turn, and prints the table. */

struct pairs {
    struct bench_samples ours, anchor, ratio; /* one of each a turn */
};

enum pairs_want {
    PAIRS_AT_MOST,  /* the ratio must not be more than the target */
    PAIRS_AT_LEAST, /* not less */
    PAIRS_TOLD      /* there is no target */
};

struct pairs_row {
    const char *number; /* of the list of targets; "" goes on with the last one */
    const char *what;
    const char *anchor;
    const char *unit;
    enum pairs_want want;
    double target;
};

void pairs_add(struct pairs *pairs, double ours, double anchor);

/* Prints, and frees the pairs; nothing of pairs that were not measured. */
void pairs_print(const struct pairs_row *row, struct pairs *pairs);

/* ---- A Redis server of the benchmark's own, and the two commands that it is asked. */

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

/* ---- A minimal server that sleeps until it is asked: the lower bound for any
 * daemon's round trip.
 *
 * Do what all such servers have in common with the daemon: wait in epoll, read one
 * message from a socket that keeps messages apart, with room for descriptors, and send
 * one of the same length, under a filter of system calls. On request it copies shared
 * memory in between, and says when it had its copy, by the clock that all processes
 * share. It decodes nothing, knows no client and computes nothing: the time it takes is
 * the machine's. */

#define LEAST_CLIENTS       51u /* the last is alone in its row */
#define LEAST_MESSAGE_BYTES 8u

struct least {
    pid_t pid;
    int fds[LEAST_CLIENTS];
    unsigned char *shared; /* written here, read there */
    size_t shared_bytes;
    uint64_t *copied_ns; /* behind them, written there */
};

/* Message that is sent, and that comes back. */
extern const char least_ping[LEAST_MESSAGE_BYTES];

/* It ends with this process, whatever ends that. Exits with 2 when it cannot start. */
void least_start(struct least *least, size_t shared_bytes);
void least_stop(struct least *least);

/* One message there and back; with a copy of so many bytes, unless that is 0. Returns
 * when the newest copy was made, by CLOCK_MONOTONIC; 0: none was. */
uint64_t least_ask(const struct least *least, size_t copy_bytes);

struct rows {
    const struct redis *redis;    /* NULL: it is not installed */
    const struct least *least;    /* told beside rows that depend on the machine most */
    struct pccd_client *blocking; /* waits in the kernel */
    struct pccd_client *spinning; /* for 50 us before it does */
    bool smoke;                   /* the least that shows that it works */
};

#define ROWS_VERTICES_MAX 1000000u /* of an update */

/* Rows 1 and 3: one client, one message at a time. */
void rows_trips(const struct rows *rows);

/* Row 2: fifty connections with a ping each in flight. */
void rows_crowd(const struct rows *rows);

/* Rows 4 and 5: positions of many vertices. */
void rows_updates(const struct rows *rows);

/* Row 11: ping while a step computes for a second. */
void rows_busy(const struct rows *rows);

#endif
