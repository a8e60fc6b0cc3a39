/* wait.c - a thread without work, until others are done. */
#include "wait.h"

#include <assert.h>
#include <omp.h>
#include <time.h>

#include "clock.h"

/* Relaxes between two looks at the clock, which costs 25 ns; each takes 20 to 50. */
#define RELAXES_PER_CLOCK 8u

/* Between two looks at whether another runs: it has by then if it does. */
#define LOOK_NS 40000u

/* Spinning: those who are waited for run on other processors, and to wake takes 50 us; or
 * they cannot while we spin. */
#define SPIN_NS                200000u
#define SPIN_OVERSUBSCRIBED_NS 10000u

/* Asleep: doubled each time. The longer it took, the less another such time matters. */
#define SLEEP_MIN_NS 20000u
#define SLEEP_MAX_NS 160000u

static void begin(struct eng_wait *wait, const struct eng_affinity *affinity,
                  uint32_t thread)
{
    uint32_t team_count = (uint32_t)omp_get_num_threads();
    bool is_oversubscribed = team_count > eng_affinity_processors(affinity);
    uint64_t now_ns = common_now_ns();
    *wait = (struct eng_wait){
        .affinity = affinity,
        .thread = thread,
        .team_count = team_count,
        .begin_ns = now_ns,
        .next_ns = now_ns + LOOK_NS,
        .spin_end_ns = now_ns + (is_oversubscribed ? SPIN_OVERSUBSCRIBED_NS : SPIN_NS),
    };
    eng_processor_set_waiting(affinity, thread, true);
}

void eng_wait_begin(struct eng_wait *wait, struct eng_worker *worker)
{
    assert(worker && worker->question);
    begin(wait, worker->question->affinity, worker->thread);
    wait->worker = worker;
}

static void sleep_for(struct eng_wait *wait)
{
    uint64_t ns = wait->sleep_ns == 0 ? SLEEP_MIN_NS : wait->sleep_ns;
    if (wait->worker) {
        wait->worker->record.sleeps++;
    }
    clock_nanosleep(CLOCK_MONOTONIC, 0, &(struct timespec){0, (long)ns}, NULL);
    wait->sleep_ns = 2 * ns < SLEEP_MAX_NS ? 2 * ns : SLEEP_MAX_NS;
}

bool eng_wait_moment(struct eng_wait *wait)
{
    eng_relax();
    if (++wait->moments % RELAXES_PER_CLOCK != 0 && wait->sleep_ns == 0) {
        return false;
    }
    uint64_t now_ns = common_now_ns();
    if (now_ns >= wait->next_ns) {
        wait->next_ns = now_ns + LOOK_NS;
        if (wait->worker) {
            eng_worker_ask(wait->worker);
        }
        if (eng_processor_lend(wait->affinity, wait->thread, wait->team_count, now_ns,
                               &wait->look)) {
            wait->spin_end_ns = now_ns; /* it has our processor when we sleep */
        }
    }
    if (now_ns < wait->spin_end_ns) {
        return false;
    }
    sleep_for(wait);
    return true;
}

void eng_wait_end(struct eng_wait *wait)
{
    eng_processor_set_waiting(wait->affinity, wait->thread, false);
    if (wait->worker) {
        eng_worker_waited(wait->worker, wait->begin_ns);
    }
}

static bool has_come(const atomic_uint *counter, uint32_t value)
{
    return atomic_load_explicit(counter, memory_order_acquire) == value;
}

void eng_wait_plainly(const struct eng_affinity *affinity, uint32_t thread,
                      const atomic_uint *counter, uint32_t value)
{
    struct eng_wait wait;
    if (!has_come(counter, value)) {
        begin(&wait, affinity, thread);
        while (!has_come(counter, value)) {
            eng_wait_moment(&wait);
        }
        eng_wait_end(&wait);
    }
}

void eng_wait_for(struct eng_worker *worker, const atomic_uint *counter, uint32_t value)
{
    if (has_come(counter, value)) {
        return;
    }
    struct eng_wait wait;
    eng_wait_begin(&wait, worker);
    while (!has_come(counter, value)) {
        eng_wait_moment(&wait);
    }
    eng_wait_end(&wait);
}

void eng_wait_for_all(struct eng_worker *worker)
{
    assert(worker->stop);
    struct eng_barrier *barrier = &worker->stop->barrier;
    /* Relaxed: it cannot change before we are there. */
    uint32_t round = atomic_load_explicit(&barrier->round, memory_order_relaxed);
    /* The last one acquires what all others have released, and releases it to them. */
    if (atomic_fetch_add_explicit(&barrier->arrived, 1, memory_order_acq_rel) + 1 ==
        (uint32_t)omp_get_num_threads()) {
        atomic_store_explicit(&barrier->arrived, 0, memory_order_relaxed);
        atomic_store_explicit(&barrier->round, round + 1, memory_order_release);
        return;
    }
    eng_wait_for(worker, &barrier->round, round + 1);
}
