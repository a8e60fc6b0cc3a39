/* fault.h - makes chosen system or library calls fail, to test how the program copes. */
#ifndef TEST_FAULT_H
#define TEST_FAULT_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Every kind of call that can fail. */
#define FAULT_CALLS(X)                                                                   \
    X(memory)                                                                            \
    X(accept4)                                                                           \
    X(bind)                                                                              \
    X(close)                                                                             \
    X(dup3)                                                                              \
    X(epoll_create1)                                                                     \
    X(epoll_ctl)                                                                         \
    X(epoll_wait)                                                                        \
    X(eventfd)                                                                           \
    X(fchmod)                                                                            \
    X(fcntl)                                                                             \
    X(flock)                                                                             \
    X(fork)                                                                              \
    X(getrandom)                                                                         \
    X(getsockopt)                                                                        \
    X(inotify_add_watch)                                                                 \
    X(inotify_init1)                                                                     \
    X(listen)                                                                            \
    X(lstat)                                                                             \
    X(madvise)                                                                           \
    X(memfd_create)                                                                      \
    X(mkdir)                                                                             \
    X(mmap)                                                                              \
    X(open)                                                                              \
    X(pipe2)                                                                             \
    X(poll)                                                                              \
    X(posix_fallocate)                                                                   \
    X(pthread_create)                                                                    \
    X(realloc)                                                                           \
    X(read)                                                                              \
    X(recvfrom)                                                                          \
    X(recvmsg)                                                                           \
    X(sendmsg)                                                                           \
    X(sendto)                                                                            \
    X(setsockopt)                                                                        \
    X(shutdown)                                                                          \
    X(sigaction)                                                                         \
    X(socket)                                                                            \
    X(socketpair)                                                                        \
    X(unlink)                                                                            \
    X(write)

enum fault_call {
    FAULT_NONE = 0,
#define FAULT_ENUM(name) FAULT_##name,
    FAULT_CALLS(FAULT_ENUM)
#undef FAULT_ENUM
        FAULT_CALL_COUNT
};

/* Zeroed: nothing fails. */
struct fault_page {
    atomic_uint call;            /* enum fault_call; FAULT_NONE: nothing is ordered */
    atomic_int error;            /* errno of those that fail */
    atomic_uint_fast64_t first;  /* of the calls of that kind from now on, from 1 */
    atomic_uint_fast64_t length; /* that many in a row */
    atomic_uint_fast64_t seen;   /* of that kind since the order */
    atomic_uint_fast64_t hits;   /* that failed since the order */
    atomic_size_t bytes_max; /* larger allocations fail, ordered or not; 0: no bound */
    atomic_uint_fast64_t refused; /* that did */
    atomic_int_fast64_t held;     /* blocks allocated and not yet freed */
    atomic_uint_fast64_t counts[FAULT_CALL_COUNT]; /* calls made since the start */
};

/* The page that counts: this process's own, or the shared one. */
extern struct fault_page *fault_page;

const char *fault_name(enum fault_call call);

/* Have `length` calls of that kind fail, the first-th from now on and what follows. */
void fault_order(struct fault_page *page, enum fault_call call, uint64_t first,
                 uint64_t length, int error);
/* Nothing fails any more; returns how many did. */
uint64_t fault_recall(struct fault_page *page);

/* Count a call; true: it shall fail, and errno is set. Of the wrappers. */
bool fault_strikes(enum fault_call call);

#endif
