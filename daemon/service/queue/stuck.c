/* stuck.c - whether a thread that computes is stuck. */
#include "stuck.h"

#include <time.h>

#include "now.h"

#define NS_PER_S  1000000000u
#define LOOKS_MAX 2u

/* Of a processor, that the thread has had; 0: unknown. */
static uint64_t time_of(pthread_t thread)
{
    clockid_t clock;
    struct timespec time;
    if (pthread_getcpuclockid(thread, &clock) != 0 || clock_gettime(clock, &time) != 0) {
        return 0;
    }
    return (uint64_t)time.tv_sec * NS_PER_S + (uint64_t)time.tv_nsec;
}

/* Locked: it stays the runner's. */
static bool is_late(const struct srv_job *job, uint64_t now_ns)
{
    uint64_t end_ns = atomic_load_explicit(&job->end_ns, memory_order_relaxed);
    return job->heeds_end && ((end_ns != 0 && now_ns > end_ns) ||
                              atomic_load_explicit(&job->cancel, memory_order_relaxed));
}

bool srv_stuck_look(struct srv_compute *compute)
{
    uint64_t now_ns = common_now_ns();
    bool is_stuck = false;
    pthread_mutex_lock(&compute->mutex);
    for (uint32_t i = 0; i < compute->runner_count; i++) {
        struct srv_runner *runner = &compute->runners[i];
        struct srv_stuck_look *seen = &runner->seen;
        uint64_t begin_ns = runner->job != NULL ? runner->begin_ns : 0;
        uint64_t cpu_ns = time_of(runner->thread);
        bool is_same = begin_ns != 0 && begin_ns == seen->begin_ns;
        bool is_idle = is_same && cpu_ns == seen->cpu_ns;
        bool has_to_end = is_same && is_late(runner->job, now_ns);
        seen->begin_ns = begin_ns;
        seen->cpu_ns = cpu_ns;
        seen->idle = is_idle ? seen->idle + 1 : 0;
        seen->late = has_to_end ? seen->late + 1 : 0;
        is_stuck = is_stuck || seen->idle >= LOOKS_MAX || seen->late >= LOOKS_MAX;
    }
    pthread_mutex_unlock(&compute->mutex);
    return is_stuck;
}
