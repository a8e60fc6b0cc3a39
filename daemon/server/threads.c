/* threads.c - how many threads the system grants, and how soon one gets a processor. */
#include "threads.h"

#include <errno.h>
#include <pthread.h>
#include <sched.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "engine.h"
#include "invariant.h"
#include "log.h"
#include "printable.h"

/* Live until the gate opens. */
static void *await(void *gate)
{
    pthread_mutex_lock(gate);
    pthread_mutex_unlock(gate);
    return NULL;
}

uint32_t srv_threads_granted(uint32_t wanted, uint32_t own)
{
    static pthread_t threads[ENG_THREADS_MAX + SRV_OWN_THREADS];
    pthread_mutex_t gate = PTHREAD_MUTEX_INITIALIZER;
    PCCD_ASSERT(wanted >= 1 && own >= 1 && own <= SRV_OWN_THREADS);
    if (wanted > ENG_THREADS_MAX) {
        wanted = ENG_THREADS_MAX; /* more the engine does not use */
    }
    uint32_t all = wanted - 1 + own; /* the compute thread is one of the team */
    uint32_t count = 0;
    int failed = 0;
    pthread_mutex_lock(&gate);
    while (count < all && failed == 0) {
        failed = pthread_create(&threads[count], NULL, await, &gate);
        count += failed == 0;
    }
    pthread_mutex_unlock(&gate);
    for (uint32_t i = 0; i < count; i++) {
        pthread_join(threads[i], NULL);
    }
    if (count == all) {
        return wanted;
    }
    uint32_t granted = count > own ? count - own + 1 : 1;
    srv_log(SRV_LOG_WARN, 0, "%u %s instead of %u: %s", granted,
            proto_plural(granted, "thread", "threads"), wanted, strerror(failed));
    return granted;
}

uint32_t srv_processors_allowed(void)
{
    cpu_set_t mine, all;
    if (sched_getaffinity(0, sizeof mine, &mine) != 0) {
        return 0;
    }
    memset(&all, 0xff, sizeof all); /* the system takes out what the cpuset has not */
    bool is_known = sched_setaffinity(0, sizeof all, &all) == 0 &&
                    sched_getaffinity(0, sizeof all, &all) == 0;
    (void)sched_setaffinity(0, sizeof mine, &mine);
    return is_known ? (uint32_t)CPU_COUNT(&all) : 0;
}

/* ---- How soon a thread gets a processor. */

/* Shorter than anybody's (0.7 ms on one processor, more on more), and long enough that a
 * tick, which ends the slice of one that has had its length, seldom ends this one. */
#define SLICE_NS       500000u
#define NICE_BEHIND    10 /* of the thread alone, on Linux */
#define TIMER_SLACK_NS 1000u

/* struct sched_attr of <linux/sched/types.h>, which does not go with <sched.h>. */
struct attributes {
    uint32_t size;
    uint32_t policy;
    uint64_t flags;
    int32_t nice;
    uint32_t priority;
    uint64_t runtime_ns;
    uint64_t deadline_ns;
    uint64_t period_ns;
};

void srv_priority_prompt(void)
{
    struct attributes attributes;
    if (syscall(SYS_sched_getattr, 0, &attributes, sizeof attributes, 0) == 0) {
        attributes.size = sizeof attributes;
        attributes.flags = 0;
        attributes.runtime_ns = SLICE_NS;
        (void)syscall(SYS_sched_setattr, 0, &attributes, 0);
    }
}

void srv_priority_punctual(void)
{
    (void)prctl(PR_SET_TIMERSLACK, TIMER_SLACK_NS, 0, 0, 0);
}

void srv_priority_behind(void)
{
    (void)setpriority(PRIO_PROCESS, 0, NICE_BEHIND);
}
