/* compute.c - the threads that compute.
 *
 * Threads: [loop] and [compute]; no other lock of the server is taken under this one.
 */
#include "compute.h"

#include <signal.h>
#include <stddef.h>
#include <stdlib.h>
#include <time.h>

#include "invariant.h"
#include "now.h"
#include "pccd_types.h"

/* A thread that computes. Locked, but for what says otherwise. */
struct srv_runner {
    struct srv_compute *compute; /* constant */
    uint32_t number;             /* of the runner; constant */
    pthread_t thread;            /* [loop] */
    pthread_cond_t wake;         /* there is something to take, or stop */
    struct srv_job *job;         /* that it runs; NULL: none */
    uint64_t begin_ns;           /* since when */
    bool is_long;                /* it has run for so long that others run beside it */
    struct srv_progress {
        uint64_t begin_ns; /* of the job that ran at the last look; 0: none did */
        uint64_t cpu_ns;   /* that the thread had had */
        uint32_t idle;     /* looks since it had any */
        uint32_t late;     /* looks since the job was to end */
    } seen;                /* [loop] by the watchdog */
};

static void lock(struct srv_compute *compute)
{
    int failed = pthread_mutex_lock(&compute->mutex);
    PCCD_ASSERT(failed == 0);
}

static void unlock(struct srv_compute *compute)
{
    int failed = pthread_mutex_unlock(&compute->mutex);
    PCCD_ASSERT(failed == 0);
}

/* ---- taking ------------------------------------------------------------------------ */

static bool is_full(const struct srv_compute *compute)
{
    return compute->running >= compute->place_max;
}

/* Nothing may run beside a job that is not long, but what has no place. Locked. */
static bool has_to_wait(const struct srv_compute *compute)
{
    return compute->running > compute->long_count && !is_full(compute);
}

/* Give the runner the job whose turn it is. False: there is none that may run now.
 * Locked. */
static bool take(struct srv_compute *compute, struct srv_runner *runner)
{
    struct srv_job_list *list =
        has_to_wait(compute)
            ? NULL
            : srv_turns_choose(&compute->turns, compute->running, compute->place_max);
    if (list == NULL) {
        compute->has_no_taker = compute->turns.groups.count > 0 && !has_to_wait(compute);
        return false;
    }
    struct srv_job *job = list->first;
    PCCD_ASSERT(job->state == SRV_JOB_QUEUED && compute->queued > 0);
    list->group->running++;
    list->serving = true;
    list->first = job->next;
    if (list->first == NULL) {
        list->last = NULL;
    }
    srv_turns_update(&compute->turns, list); /* other lists of the group may be next */
    compute->queued--;
    compute->counted -= job->counts;
    compute->running++;
    srv_claims_set(job->claims, job->claim_count, true);
    job->next = NULL;
    job->state = SRV_JOB_RUNNING;
    runner->job = job;
    runner->begin_ns = common_now_ns();
    runner->is_long = false;
    return true;
}

/* The runner's job took cost_ns: who waits for more of it waits behind those who have had
 * less. Locked. */
static void settle(struct srv_compute *compute, struct srv_runner *runner,
                   uint64_t cost_ns)
{
    struct srv_job *job = runner->job;
    struct srv_job_list *list = job->list;
    struct srv_group *group = list->group;
    PCCD_ASSERT(list->serving && group->running > 0 && compute->running > 0);
    if (group->turn.queued) {
        srv_fair_remove(&compute->turns.groups, &group->turn);
    }
    srv_fair_charge(&compute->turns.groups, &group->turn, cost_ns);
    srv_fair_charge(&group->lists, &list->turn, cost_ns);
    group->running--;
    list->serving = false;
    compute->running--;
    compute->has_no_taker = false;
    compute->long_count -= runner->is_long;
    runner->is_long = false;
    runner->job = NULL;
    srv_claims_set(job->claims, job->claim_count, false);
    srv_turns_update(&compute->turns, list);
    srv_turns_empty_aside(&compute->turns);
}

/* ---- the threads ------------------------------------------------------------------- */

/* Append to the finished jobs; true when the list was empty: the loop must be told. A
 * list that was not empty has a notification under way that will find this job too.
 * Locked. */
static bool finish(struct srv_compute *compute, struct srv_job *job)
{
    bool first = compute->done_first == NULL;
    PCCD_ASSERT(job->state == SRV_JOB_RUNNING);
    job->state = SRV_JOB_DONE;
    if (first) {
        compute->done_first = job;
    } else {
        compute->done_last->next = job;
    }
    compute->done_last = job;
    return first;
}

/* Some of the job has been done: it is the first of its list once more. Locked. */
static void put_back(struct srv_compute *compute, struct srv_job *job)
{
    struct srv_job_list *list = job->list;
    job->state = SRV_JOB_QUEUED;
    job->next = list->first;
    list->first = job;
    if (job->next == NULL) {
        list->last = job;
    }
    compute->queued++;
    compute->counted += job->counts;
}

/* Run the job that the runner has taken. True: the list of finished jobs is no longer
 * empty. Locked, but not while the job runs. */
static bool run_one(struct srv_compute *compute, struct srv_runner *runner)
{
    struct srv_job *job = runner->job;
    unlock(compute);
    job->goes_on = false;
    uint64_t begin_ns = srv_now_thread_ns();
    job->run(job);
    uint64_t cost_ns = srv_now_thread_ns() - begin_ns;
    lock(compute);
    bool goes_on = job->goes_on;
    if (goes_on) {
        put_back(compute, job);
    }
    settle(compute, runner, cost_ns);
    return !goes_on && finish(compute, job);
}

static void *runner_main(void *context)
{
    struct srv_runner *runner = context;
    struct srv_compute *compute = runner->compute;
    srv_thread_enter(SRV_THREAD_COMPUTE);
    if (compute->enter != NULL) {
        compute->enter(compute->context, runner->number);
    }
    lock(compute);
    for (;;) { /* ends when stopped and idle */
        if (!take(compute, runner)) {
            if (compute->stop) {
                break;
            }
            pthread_cond_wait(&runner->wake, &compute->mutex);
        } else if (run_one(compute, runner)) {
            unlock(compute);
            compute->notify(compute->context);
            lock(compute);
        }
    }
    unlock(compute);
    return NULL;
}

static int init(struct srv_compute *compute, uint32_t capacity, uint32_t place_max,
                uint32_t runner_max)
{
    *compute =
        (struct srv_compute){.capacity = capacity,
                             .place_max = place_max,
                             .runner_max = runner_max,
                             .runners = calloc(runner_max, sizeof(struct srv_runner))};
    if (compute->runners == NULL) {
        return PCCD_E_NOMEM;
    }
    if (pthread_mutex_init(&compute->mutex, NULL) != 0) {
        free(compute->runners);
        return PCCD_E_NOMEM;
    }
    return 0;
}

int srv_compute_init(struct srv_compute *compute, uint32_t capacity)
{
    return init(compute, capacity, 1, 1);
}

void srv_compute_deinit(struct srv_compute *compute)
{
    PCCD_ASSERT(compute->queued == 0 && compute->done_first == NULL);
    pthread_mutex_destroy(&compute->mutex);
    free(compute->runners);
}

bool srv_compute_run_next(struct srv_compute *compute)
{
    lock(compute);
    bool has_job = take(compute, &compute->runners[0]);
    if (has_job) {
        (void)run_one(compute, &compute->runners[0]);
    }
    unlock(compute);
    return has_job;
}

int srv_compute_add_runner(struct srv_compute *compute)
{
    struct srv_runner *runner = &compute->runners[compute->runner_count];
    PCCD_ASSERT(compute->runner_count < compute->runner_max);
    if (pthread_cond_init(&runner->wake, NULL) != 0) {
        return PCCD_E_SYSTEM;
    }
    runner->compute = compute;
    runner->number = compute->runner_count;
    sigset_t all;
    sigset_t before;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    int failed = pthread_create(&runner->thread, NULL, runner_main, runner);
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    if (failed != 0) {
        pthread_cond_destroy(&runner->wake);
        return PCCD_E_SYSTEM;
    }
    lock(compute);
    compute->runner_count++;
    unlock(compute);
    return 0;
}

int srv_compute_start(struct srv_compute *compute,
                      const struct srv_compute_settings *settings)
{
    PCCD_ASSERT(settings->place_max >= 1 && settings->place_max <= settings->runner_max &&
                settings->runner_max <= SRV_RUNNERS_MAX);
    int status =
        init(compute, settings->capacity, settings->place_max, settings->runner_max);
    if (status != 0) {
        return status;
    }
    compute->enter = settings->enter;
    compute->notify = settings->notify;
    compute->context = settings->context;
    status = srv_compute_add_runner(compute);
    if (status != 0) {
        srv_compute_deinit(compute);
    }
    return status;
}

/* Something waits that a runner could take now. Locked. */
static bool can_begin(const struct srv_compute *compute)
{
    return compute->turns.groups.count > 0 && !compute->has_no_taker &&
           !has_to_wait(compute);
}

/* The runner to wake for what waits; NULL: nothing may begin now, or all are busy. The
 * first that sleeps, so that without long jobs it is always the same. Locked. */
static struct srv_runner *sleeper(struct srv_compute *compute)
{
    for (uint32_t i = 0; i < compute->runner_count && can_begin(compute); i++) {
        if (compute->runners[i].job == NULL) {
            return &compute->runners[i];
        }
    }
    return NULL;
}

/* Not with the lock: where both share a processor the thread runs at once, finds the lock
 * taken and sleeps again, and the processor may go to another for a tick: 3 ms behind the
 * making of a ring. */
static void wake(struct srv_runner *runner)
{
    if (runner != NULL) {
        pthread_cond_signal(&runner->wake);
    }
}

void srv_compute_stop(struct srv_compute *compute)
{
    if (compute->runner_count == 0) {
        return;
    }
    lock(compute);
    PCCD_ASSERT(compute->queued == 0);
    compute->stop = true;
    unlock(compute);
    for (uint32_t i = 0; i < compute->runner_count; i++) {
        wake(&compute->runners[i]);
        int failed = pthread_join(compute->runners[i].thread, NULL);
        PCCD_ASSERT(failed == 0);
        pthread_cond_destroy(&compute->runners[i].wake);
    }
    compute->runner_count = 0;
    srv_compute_deinit(compute);
}

/* ---- long jobs --------------------------------------------------------------------- */

/* Return whether a job waits that may have to be helped. Locked. */
static bool has_backlog(const struct srv_compute *compute)
{
    return compute->on_backlog != NULL && compute->turns.groups.count > 0 &&
           compute->queued + compute->running > 1;
}

/* Returns in how many ns another job will be long; 0: there is none. Locked. */
static uint64_t find_long(struct srv_compute *compute)
{
    uint64_t now_ns = common_now_ns();
    uint64_t long_ns =
        compute->turns.groups.count > SRV_MANY ? SRV_LONG_NS / 2 : SRV_LONG_NS;
    uint64_t after_ns = 0;
    for (uint32_t i = 0; i < compute->runner_count; i++) {
        struct srv_runner *runner = &compute->runners[i];
        uint64_t ran_ns = now_ns - runner->begin_ns;
        if (runner->job == NULL || runner->is_long) {
            continue;
        }
        if (ran_ns >= long_ns) {
            runner->is_long = true;
            compute->long_count++;
        } else if (after_ns == 0 || long_ns - ran_ns < after_ns) {
            after_ns = long_ns - ran_ns;
        }
    }
    return after_ns;
}

uint64_t srv_compute_look(struct srv_compute *compute, bool *wants_runner)
{
    lock(compute);
    uint64_t after_ns = find_long(compute);
    struct srv_runner *runner = sleeper(compute);
    bool waits = compute->turns.groups.count > 0 && !compute->has_no_taker;
    *wants_runner = runner == NULL && can_begin(compute) &&
                    compute->runner_count < compute->runner_max;
    if (runner != NULL) {
        after_ns = SRV_SOON_NS; /* when it has taken something: others may wait on */
    }
    unlock(compute);
    wake(runner);
    return waits ? after_ns : 0;
}

/* ---- jobs -------------------------------------------------------------------------- */

void srv_job_init(struct srv_job *job, srv_job_fn run, srv_job_fn done)
{
    *job = (struct srv_job){.run = run, .done = done};
    atomic_init(&job->cancel, false);
}

/* Append to the list; begin_next then. Locked. */
static void append(struct srv_compute *compute, struct srv_job_list *list,
                   struct srv_job *job, bool counts)
{
    PCCD_ASSERT(job->state == SRV_JOB_IDLE && !compute->stop);
    job->next = NULL;
    job->list = list;
    job->state = SRV_JOB_QUEUED;
    job->counts = counts;
    compute->queued++;
    compute->counted += counts;
    compute->has_no_taker = false;
    if (list->first == NULL) {
        list->first = job;
    } else {
        list->last->next = job;
    }
    list->last = job;
    srv_turns_update(&compute->turns, list);
}

/* Something waits that may begin. Locked before, and not afterwards. */
static void begin_next(struct srv_compute *compute)
{
    struct srv_runner *runner = sleeper(compute);
    bool backlog = has_backlog(compute);
    unlock(compute);
    wake(runner);
    if (backlog) {
        compute->on_backlog(compute->backlog_context);
    }
}

int srv_compute_push(struct srv_compute *compute, struct srv_job_list *list,
                     struct srv_job *job)
{
    lock(compute);
    if (compute->counted >= compute->capacity) {
        unlock(compute);
        return PCCD_E_BUSY;
    }
    append(compute, list, job, true);
    begin_next(compute);
    return 0;
}

void srv_compute_push_reap(struct srv_compute *compute, struct srv_job_list *list,
                           struct srv_job *job)
{
    lock(compute);
    append(compute, list, job, false);
    begin_next(compute);
}

/* Unlink a queued job from its list, which holds a bounded number. Locked. */
static void unlink_job(struct srv_compute *compute, struct srv_job *job)
{
    struct srv_job_list *list = job->list;
    struct srv_job *before = NULL;
    for (struct srv_job *at = list->first; at != job; at = at->next) {
        PCCD_ASSERT(at != NULL);
        before = at;
    }
    if (list->last == job) {
        list->last = before;
    }
    compute->queued--;
    compute->counted -= job->counts;
    if (before == NULL) {
        list->first = job->next;
    } else {
        before->next = job->next;
    }
    if (before == NULL && list->is_background) {
        srv_turns_take_from_aside(&compute->turns, list);
    }
    srv_turns_update(&compute->turns, list);
    job->next = NULL;
    job->state = SRV_JOB_IDLE;
}

bool srv_compute_remove(struct srv_compute *compute, struct srv_job *job)
{
    lock(compute);
    bool queued = job->state == SRV_JOB_QUEUED;
    if (queued) {
        unlink_job(compute, job);
    }
    begin_next(compute); /* the job behind it may not have to wait as it had to */
    return queued;
}

bool srv_compute_amend(struct srv_compute *compute, struct srv_job *job,
                       void (*change)(struct srv_job *job, void *context), void *context)
{
    lock(compute);
    bool queued = job->state == SRV_JOB_QUEUED;
    if (queued && change != NULL) {
        compute->counted -= job->counts;
        change(job, context);
        compute->counted += job->counts;
    }
    unlock(compute);
    return queued;
}

uint32_t srv_compute_drain(struct srv_compute *compute)
{
    lock(compute);
    struct srv_job *job = compute->done_first;
    compute->done_first = NULL;
    compute->done_last = NULL;
    bool backlog = has_backlog(compute);
    unlock(compute);
    uint32_t count = 0;
    while (job != NULL) {
        struct srv_job *next = job->next; /* `done` may free the job or push it again */
        PCCD_ASSERT(job->state == SRV_JOB_DONE);
        job->next = NULL;
        job->state = SRV_JOB_IDLE;
        job->done(job);
        job = next;
        count++;
    }
    if (backlog) {
        compute->on_backlog(compute->backlog_context);
    }
    return count;
}

bool srv_compute_is_idle(struct srv_compute *compute)
{
    lock(compute);
    bool is_idle =
        compute->queued == 0 && compute->running == 0 && compute->done_first == NULL;
    unlock(compute);
    return is_idle;
}

uint32_t srv_compute_queued(struct srv_compute *compute)
{
    lock(compute);
    uint32_t queued = compute->queued;
    unlock(compute);
    return queued;
}

void srv_compute_resize(struct srv_compute *compute, uint32_t capacity)
{
    lock(compute);
    compute->capacity = capacity;
    unlock(compute);
}

#define NS_PER_S  1000000000u
#define LOOKS_MAX 2u

/* Return the processor time that the thread has had; 0: unknown. */
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

bool srv_compute_is_stuck(struct srv_compute *compute)
{
    uint64_t now_ns = common_now_ns();
    bool is_stuck = false;
    pthread_mutex_lock(&compute->mutex);
    for (uint32_t i = 0; i < compute->runner_count; i++) {
        struct srv_runner *runner = &compute->runners[i];
        struct srv_progress *seen = &runner->seen;
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
