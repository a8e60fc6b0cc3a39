/* least.h - a minimal server that sleeps until it is asked: the lower bound for any
 * daemon's round trip.
 *
 * Do what all such servers have in common with the daemon: wait in epoll, read one
 * message from a socket that keeps messages apart, with room for descriptors, and send
 * one of the same length, under a filter of system calls. On request it copies shared
 * memory in between, and says when it had its copy, by the clock that all processes
 * share. It decodes nothing, knows no client and computes nothing: the time it takes is
 * the machine's.
 *
 * Threads: one, and one of the server.
 */
#ifndef BENCH_LEAST_H
#define BENCH_LEAST_H

#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>

#define LEAST_CLIENTS       51u /* the last is alone in its row */
#define LEAST_MESSAGE_BYTES 8u

struct least {
    pid_t pid;
    int fds[LEAST_CLIENTS];
    unsigned char *shared; /* written here, read there */
    size_t shared_bytes;
    uint64_t *copied_ns; /* behind them, written there */
};

/* What is asked, and answered. */
extern const char least_ping[LEAST_MESSAGE_BYTES];

/* It ends with this process, whatever ends that. Exits with 2 when it cannot start. */
void least_start(struct least *least, size_t shared_bytes);
void least_stop(struct least *least);

/* One message there and back; with a copy of so many bytes, unless that is 0. Returns
 * when the newest copy was made, by CLOCK_MONOTONIC; 0: none was. */
uint64_t least_ask(const struct least *least, size_t copy_bytes);

#endif
