/* timers.c - what is due at a time, without a thread that waits for it. */
#include "timers.h"

#include <stdatomic.h>
#include <stdlib.h>

#include "host.h"
#include "now.h"

#define NS_PER_MS 1000000u

struct srv_timer {
    struct srv_timer *next;
    void (*fire)(void *context);
    void *context;
    uint64_t at_ns;    /* CLOCK_MONOTONIC; 0: it is stopped */
    uint64_t every_ns; /* 0: once */
};

static struct srv_timer *timers;
static _Atomic uint64_t due_ns; /* of the first timer; 0: none. Whoever reads it without
                                 * a turn takes one to be sure */

static void find_due(void)
{
    uint64_t first_ns = 0;
    for (const struct srv_timer *timer = timers; timer != NULL; timer = timer->next) {
        if (timer->at_ns != 0 && (first_ns == 0 || timer->at_ns < first_ns)) {
            first_ns = timer->at_ns;
        }
    }
    atomic_store_explicit(&due_ns, first_ns, memory_order_relaxed);
}

struct srv_timer *srv_timer_new(struct srv_service *service, void (*fire)(void *context),
                                void *context)
{
    (void)service;
    struct srv_timer *timer = calloc(1, sizeof *timer);
    if (timer != NULL) {
        *timer = (struct srv_timer){.next = timers, .fire = fire, .context = context};
        timers = timer;
    }
    return timer;
}

void srv_timer_start(struct srv_timer *timer, uint64_t after_ms, uint64_t every_ms)
{
    timer->at_ns = common_now_ns() + after_ms * NS_PER_MS;
    timer->every_ns = every_ms * NS_PER_MS;
    find_due();
}

void srv_timer_stop(struct srv_timer *timer)
{
    timer->at_ns = 0;
    find_due();
}

void srv_timer_free(struct srv_timer *timer)
{
    struct srv_timer **at = &timers;
    while (*at != NULL && *at != timer) {
        at = &(*at)->next;
    }
    if (timer != NULL) {
        *at = timer->next;
        free(timer);
        find_due();
    }
}

uint64_t direct_timers_due_ns(void)
{
    return atomic_load_explicit(&due_ns, memory_order_relaxed);
}

bool direct_timers_are_due(void)
{
    uint64_t at_ns = direct_timers_due_ns();
    return at_ns != 0 && at_ns <= common_now_ns();
}

/* A timer that fires may stop and start others. */
void direct_timers_fire(void)
{
    uint64_t now_ns = common_now_ns();
    for (struct srv_timer *timer = timers; timer != NULL; timer = timer->next) {
        if (timer->at_ns != 0 && timer->at_ns <= now_ns) {
            timer->at_ns = timer->every_ns != 0 ? now_ns + timer->every_ns : 0;
            timer->fire(timer->context);
        }
    }
    find_due();
}
