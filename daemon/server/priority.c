/* priority.c - how soon a thread gets a processor. */
#include "priority.h"

#include <stdint.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

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
