/* compute.c - the one thread that computes.
 *
 * Room:     server. See compute.h.
 * Does:     a mutex, a condition, a round of lanes and a list of finished jobs.
 * Does not: hold the lock while a job runs or while `done` or `notify` are called.
 * Threads:  [loop] and [compute]; the mutex is the only lock of the server, so there is
 *           no lock order to keep.
 */
#include "compute.h"

#include <signal.h>
#include <stddef.h>

#include "crash.h"
#include "invariant.h"
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

/* Put a lane at the end of the round. Locked. */
static void round_append(struct srv_compute *compute, struct srv_lane *lane)
{
    lane->next = NULL;
    if (compute->round_last == NULL) {
        compute->round_first = lane;
    } else {
        compute->round_last->next = lane;
    }
    compute->round_last = lane;
}

/* Take a lane out of the round; `before` precedes it, NULL: it is the first. Locked. */
static void round_unlink(struct srv_compute *compute, struct srv_lane *lane,
                         struct srv_lane *before)
{
    if (before == NULL) {
        compute->round_first = lane->next;
    } else {
        before->next = lane->next;
    }
    if (compute->round_last == lane) {
        compute->round_last = before;
    }
    lane->next = NULL;
}

/* The first job of the lane whose turn it is; the lane goes to the end of the round when
 * it has more. Locked; a lane has a job. */
static struct srv_job *take(struct srv_compute *compute)
{
    struct srv_lane *lane = compute->round_first;
    struct srv_job *job = lane->first;
    PCCD_ASSERT(job != NULL && job->state == SRV_JOB_QUEUED && compute->queued > 0);
    lane->first = job->next;
    if (lane->first == NULL) {
        lane->last = NULL;
    }
    round_unlink(compute, lane, NULL);
    if (lane->first != NULL) {
        round_append(compute, lane);
    }
    compute->queued--;
    job->next = NULL;
    job->state = SRV_JOB_RUNNING;
    return job;
}

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

static void *compute_main(void *context)
{
    struct srv_compute *compute = context;
    srv_thread_enter(SRV_THREAD_COMPUTE);
    srv_crash_thread();
    if (compute->enter != NULL) {
        compute->enter(compute->context);
    }
    lock(compute);
    for (;;) { /* ends when stopped and idle */
        while (compute->round_first == NULL && !compute->stop) {
            pthread_cond_wait(&compute->wake, &compute->mutex);
        }
        if (compute->round_first == NULL) {
            break;
        }
        struct srv_job *job = take(compute);
        unlock(compute);
        job->run(job);
        lock(compute);
        if (finish(compute, job)) {
            unlock(compute);
            compute->notify(compute->context);
            lock(compute);
        }
    }
    unlock(compute);
    return NULL;
}

int srv_compute_start(struct srv_compute *compute, uint32_t capacity,
                      void (*enter)(void *context), void (*notify)(void *context),
                      void *context)
{
    *compute = (struct srv_compute){
        .capacity = capacity, .enter = enter, .notify = notify, .context = context};
    if (pthread_mutex_init(&compute->mutex, NULL) != 0) {
        return PCCD_E_NOMEM;
    }
    if (pthread_cond_init(&compute->wake, NULL) != 0) {
        pthread_mutex_destroy(&compute->mutex);
        return PCCD_E_NOMEM;
    }
    sigset_t all;
    sigset_t before;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    int failed = pthread_create(&compute->thread, NULL, compute_main, compute);
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    if (failed != 0) {
        pthread_cond_destroy(&compute->wake);
        pthread_mutex_destroy(&compute->mutex);
        return PCCD_E_SYSTEM;
    }
    compute->started = true;
    return 0;
}

void srv_compute_stop(struct srv_compute *compute)
{
    if (!compute->started) {
        return;
    }
    lock(compute);
    PCCD_ASSERT(compute->round_first == NULL);
    compute->stop = true;
    pthread_cond_signal(&compute->wake);
    unlock(compute);
    int failed = pthread_join(compute->thread, NULL);
    PCCD_ASSERT(failed == 0 && compute->done_first == NULL);
    pthread_cond_destroy(&compute->wake);
    pthread_mutex_destroy(&compute->mutex);
    compute->started = false;
}

void srv_job_init(struct srv_job *job, srv_job_fn run, srv_job_fn done)
{
    *job = (struct srv_job){.run = run, .done = done};
    atomic_init(&job->cancel, false);
}

/* Append to the lane, wake the thread. Locked. */
static void append(struct srv_compute *compute, struct srv_lane *lane,
                   struct srv_job *job)
{
    PCCD_ASSERT(job->state == SRV_JOB_IDLE && !compute->stop);
    job->next = NULL;
    job->lane = lane;
    job->state = SRV_JOB_QUEUED;
    if (lane->first == NULL) {
        lane->first = job;
        round_append(compute, lane);
    } else {
        lane->last->next = job;
    }
    lane->last = job;
    compute->queued++;
    pthread_cond_signal(&compute->wake);
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
    return room ? 0 : PCCD_E_BUSY;
}

void srv_compute_push_reap(struct srv_compute *compute, struct srv_lane *lane,
                           struct srv_job *job)
{
    lock(compute);
    append(compute, lane, job);
    unlock(compute);
}

/* The element before `lane` in the round, NULL: it is the first. Locked; at most one
 * element per session. */
static struct srv_lane *round_before(struct srv_compute *compute,
                                     const struct srv_lane *lane)
{
    struct srv_lane *before = NULL;
    for (struct srv_lane *at = compute->round_first; at != lane; at = at->next) {
        PCCD_ASSERT(at != NULL);
        before = at;
    }
    return before;
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
    if (before == NULL) {
        lane->first = job->next;
    } else {
        before->next = job->next;
    }
    if (lane->last == job) {
        lane->last = before;
    }
    if (lane->first == NULL) {
        round_unlink(compute, lane, round_before(compute, lane));
    }
    compute->queued--;
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

uint32_t srv_compute_queued(struct srv_compute *compute)
{
    lock(compute);
    uint32_t queued = compute->queued;
    unlock(compute);
    return queued;
}
