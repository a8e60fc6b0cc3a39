/* compute.c - the one thread that computes.
 *
 * Room:     service. See compute.h.
 * Does:     a mutex, a condition, lanes that wait for their turn, and a list of finished
 *           jobs.
 * Does not: hold the lock while a job runs or while `done` or `notify` are called;
 *           `change` takes no other.
 * Threads:  [loop] and [compute]; the mutex is the only lock of the server, so there is
 *           no lock order to keep.
 */
#include "compute.h"

#include <signal.h>
#include <stddef.h>

#include "invariant.h"
#include "now.h"
#include "pccd_types.h"

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

/* ---- turns ------------------------------------------------------------------------- */

/* The lane waits if it has a job and none of them runs; its group likewise. Locked. */
static void update(struct srv_compute *compute, struct srv_lane *lane)
{
    struct srv_group *group = lane->group;
    bool lane_waits = lane->first != NULL && !lane->serving;
    if (lane_waits && !lane->turn.queued) {
        srv_fair_push(&group->lanes, &lane->turn);
    } else if (!lane_waits && lane->turn.queued) {
        srv_fair_remove(&group->lanes, &lane->turn);
    }
    bool group_waits = group->lanes.count > 0 && !group->serving;
    if (group_waits && !group->turn.queued) {
        srv_fair_push(&compute->groups, &group->turn);
    } else if (!group_waits && group->turn.queued) {
        srv_fair_remove(&compute->groups, &group->turn);
    }
}

/* The first job of the lane whose turn it is. Locked; a lane has a job. */
static struct srv_job *take(struct srv_compute *compute)
{
    struct srv_group *group = (struct srv_group *)srv_fair_take(&compute->groups);
    struct srv_lane *lane = (struct srv_lane *)srv_fair_take(&group->lanes);
    struct srv_job *job = lane->first;
    PCCD_ASSERT(job != NULL && job->state == SRV_JOB_QUEUED && compute->queued > 0);
    group->serving = true;
    lane->serving = true;
    lane->first = job->next;
    if (lane->first == NULL) {
        lane->last = NULL;
    }
    compute->queued--;
    job->next = NULL;
    job->state = SRV_JOB_RUNNING;
    return job;
}

/* The job took cost_ns: who waits for more of it waits behind those who have had less.
 * Locked. */
static void settle(struct srv_compute *compute, const struct srv_job *job,
                   uint64_t cost_ns)
{
    struct srv_lane *lane = job->lane;
    struct srv_group *group = lane->group;
    PCCD_ASSERT(lane->serving && group->serving);
    srv_fair_charge(&compute->groups, &group->turn, cost_ns);
    srv_fair_charge(&group->lanes, &lane->turn, cost_ns);
    group->serving = false;
    lane->serving = false;
    update(compute, lane);
}

/* ---- the thread -------------------------------------------------------------------- */

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

/* Some of the job has been done: it is the first of its lane once more. Locked. */
static void put_back(struct srv_compute *compute, struct srv_job *job)
{
    struct srv_lane *lane = job->lane;
    job->state = SRV_JOB_QUEUED;
    job->next = lane->first;
    lane->first = job;
    if (job->next == NULL) {
        lane->last = job;
    }
    compute->queued++;
}

/* Run the job whose turn it is; there is one. True: the list of finished jobs is no
 * longer empty. Locked, but not while the job runs. */
static bool run_one(struct srv_compute *compute)
{
    struct srv_job *job = take(compute);
    compute->is_running = true;
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
    settle(compute, job, cost_ns);
    compute->is_running = false;
    return !goes_on && finish(compute, job);
}

static void *compute_main(void *context)
{
    struct srv_compute *compute = context;
    srv_thread_enter(SRV_THREAD_COMPUTE);
    if (compute->enter != NULL) {
        compute->enter(compute->context);
    }
    lock(compute);
    for (;;) { /* ends when stopped and idle */
        while (compute->queued == 0 && !compute->stop) {
            pthread_cond_wait(&compute->wake, &compute->mutex);
        }
        if (compute->queued == 0) {
            break;
        }
        if (run_one(compute)) {
            unlock(compute);
            compute->notify(compute->context);
            lock(compute);
        }
    }
    unlock(compute);
    return NULL;
}

int srv_compute_init(struct srv_compute *compute, uint32_t capacity)
{
    *compute = (struct srv_compute){.capacity = capacity};
    if (pthread_mutex_init(&compute->mutex, NULL) != 0) {
        return PCCD_E_NOMEM;
    }
    if (pthread_cond_init(&compute->wake, NULL) != 0) {
        pthread_mutex_destroy(&compute->mutex);
        return PCCD_E_NOMEM;
    }
    return 0;
}

void srv_compute_deinit(struct srv_compute *compute)
{
    PCCD_ASSERT(compute->queued == 0 && compute->done_first == NULL);
    pthread_cond_destroy(&compute->wake);
    pthread_mutex_destroy(&compute->mutex);
}

bool srv_compute_run_next(struct srv_compute *compute)
{
    lock(compute);
    bool has_job = compute->queued > 0;
    if (has_job) {
        (void)run_one(compute);
    }
    unlock(compute);
    return has_job;
}

int srv_compute_start(struct srv_compute *compute, uint32_t capacity,
                      void (*enter)(void *context), void (*notify)(void *context),
                      void *context)
{
    int status = srv_compute_init(compute, capacity);
    if (status != 0) {
        return status;
    }
    compute->enter = enter;
    compute->notify = notify;
    compute->context = context;
    sigset_t all;
    sigset_t before;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    int failed = pthread_create(&compute->thread, NULL, compute_main, compute);
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    if (failed != 0) {
        srv_compute_deinit(compute);
        return PCCD_E_SYSTEM;
    }
    compute->started = true;
    return 0;
}

/* Not with the lock: where both share a processor the thread runs at once, finds the lock
 * taken and sleeps again, and the processor may go to another for a tick: 3 ms behind the
 * making of a ring. */
static void wake(struct srv_compute *compute)
{
    pthread_cond_signal(&compute->wake);
}

void srv_compute_stop(struct srv_compute *compute)
{
    if (!compute->started) {
        return;
    }
    lock(compute);
    PCCD_ASSERT(compute->queued == 0);
    compute->stop = true;
    unlock(compute);
    wake(compute);
    int failed = pthread_join(compute->thread, NULL);
    PCCD_ASSERT(failed == 0);
    srv_compute_deinit(compute);
    compute->started = false;
}

void srv_job_init(struct srv_job *job, srv_job_fn run, srv_job_fn done)
{
    *job = (struct srv_job){.run = run, .done = done};
    atomic_init(&job->cancel, false);
}

/* Append to the lane; wake the thread then. Locked. */
static void append(struct srv_compute *compute, struct srv_lane *lane,
                   struct srv_job *job)
{
    PCCD_ASSERT(job->state == SRV_JOB_IDLE && !compute->stop);
    job->next = NULL;
    job->lane = lane;
    job->state = SRV_JOB_QUEUED;
    compute->queued++;
    if (lane->first == NULL) {
        lane->first = job;
    } else {
        lane->last->next = job;
    }
    lane->last = job;
    update(compute, lane);
}

int srv_compute_push(struct srv_compute *compute, struct srv_lane *lane,
                     struct srv_job *job)
{
    lock(compute);
    bool room = compute->queued < compute->capacity;
    if (room) {
        append(compute, lane, job);
    }
    unlock(compute);
    if (!room) {
        return PCCD_E_BUSY;
    }
    wake(compute);
    return 0;
}

void srv_compute_push_reap(struct srv_compute *compute, struct srv_lane *lane,
                           struct srv_job *job)
{
    lock(compute);
    append(compute, lane, job);
    unlock(compute);
    wake(compute);
}

/* Unlink a queued job from its lane. Locked; a lane holds a bounded number of jobs. */
static void unlink_job(struct srv_compute *compute, struct srv_job *job)
{
    struct srv_lane *lane = job->lane;
    struct srv_job *before = NULL;
    for (struct srv_job *at = lane->first; at != job; at = at->next) {
        PCCD_ASSERT(at != NULL);
        before = at;
    }
    if (lane->last == job) {
        lane->last = before;
    }
    compute->queued--;
    if (before == NULL) {
        lane->first = job->next;
    } else {
        before->next = job->next;
    }
    update(compute, lane);
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
    unlock(compute);
    return queued;
}

bool srv_compute_amend(struct srv_compute *compute, struct srv_job *job,
                       void (*change)(struct srv_job *job, void *context), void *context)
{
    lock(compute);
    bool queued = job->state == SRV_JOB_QUEUED;
    if (queued) {
        change(job, context);
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
    return count;
}

bool srv_compute_is_idle(struct srv_compute *compute)
{
    lock(compute);
    bool is_idle =
        compute->queued == 0 && !compute->is_running && compute->done_first == NULL;
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
