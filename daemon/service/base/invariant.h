/* invariant.h - asserts about the daemon's own state, which stay on in every build. */
#ifndef SRV_INVARIANT_H
#define SRV_INVARIANT_H

#include <stdbool.h>

#define PCCD_ASSERT(condition)                                                           \
    ((condition) ? (void)0 : srv_assert_failed(#condition, __FILE__, __LINE__))

void srv_assert_failed(const char *condition, const char *file, int line)
    __attribute__((noreturn));

enum srv_thread {
    SRV_THREAD_OTHER = 0,
    SRV_THREAD_LOOP = 1,   /* sockets, admission, parsing, timers, signals */
    SRV_THREAD_COMPUTE = 2 /* everything that touches geometry or shared payload */
};

/* Declare what the calling thread is. */
void srv_thread_enter(enum srv_thread thread);

/* Return "loop", "compute", or "team" for those that help. */
const char *srv_thread_name(void);
bool srv_thread_is_loop(void);

/* Abort when called on another thread. */
void srv_assert_loop(void);
void srv_assert_compute(void);

#endif
