/* invariant.c - asserts on our own invariants, and which thread we are on. */
#include "invariant.h"

#include <stdio.h>
#include <stdlib.h>

#include "log.h"

static _Thread_local enum srv_thread current_thread = SRV_THREAD_OTHER;

void srv_assert_failed(const char *condition, const char *file, int line)
{
    char said[256];
    snprintf(said, sizeof said, "pccdd: invariant broken at %s:%d: %s", file, line,
             condition);
    if (!srv_log_last_words(said)) {
        fprintf(stderr, "%s\n", said);
    }
    abort();
}

void srv_thread_enter(enum srv_thread thread)
{
    current_thread = thread;
}

const char *srv_thread_name(void)
{
    static const char *const names[] = {[SRV_THREAD_OTHER] = "team",
                                        [SRV_THREAD_LOOP] = "loop",
                                        [SRV_THREAD_COMPUTE] = "compute"};
    return names[current_thread];
}

bool srv_thread_is_loop(void)
{
    return current_thread == SRV_THREAD_LOOP;
}

void srv_assert_loop(void)
{
    PCCD_ASSERT(current_thread == SRV_THREAD_LOOP);
}

void srv_assert_compute(void)
{
    PCCD_ASSERT(current_thread == SRV_THREAD_COMPUTE);
}
