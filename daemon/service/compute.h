/* compute.h - a thread that computes, and its queue.
 *
 * Room:     service. May include: the C library.
 * Does:     run jobs one after another on a thread of its own; hand them back in batches,
 *           one notification per batch.
 * Does not: know what a job computes, or own jobs: they are part of larger structs.
 * Threads:  functions say; `run` is called on [compute], `done` on [loop]. There are two:
 *           one owns the engine and its team; the other, [pages], makes and frees rings,
 *           which takes 2 us a page and would hold up steps for as long.
 *
 * Jobs wait in lanes, one lane per session, and lanes in groups, one group per user.
 * Within a lane the order is first in, first out. Users get equal shares of the thread's
 * time, and the sessions of a user equal shares of that user's, measured and not counted
 * in jobs (fairqueue.h): many jobs, or large ones, delay who asks for little by at most
 * the one that runs. What is measured is the time that the thread had of a processor: on
 * a busy machine others take it away for milliseconds, for which no client is to wait
 * behind as many jobs of all others.
 *
 *     IDLE --push--> QUEUED --taken--> RUNNING --finished--> DONE --drain--> IDLE
 *                      \--remove--> IDLE  \--goes on--> QUEUED
 */
#ifndef SRV_COMPUTE_H
#define SRV_COMPUTE_H

#include <pthread.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

#include "fairqueue.h"

struct srv_job;
typedef void (*srv_job_fn)(struct srv_job *job);

enum srv_job_state {
    SRV_JOB_IDLE = 0,
    SRV_JOB_QUEUED = 1,
    SRV_JOB_RUNNING = 2,
    SRV_JOB_DONE = 3
};

/* All zero but for lane.group: nothing waits. They belong to the queue's lock. */
struct srv_group {
    struct srv_fair turn; /* first */
    struct srv_fairqueue lanes;
    bool serving; /* a job of one of its lanes runs */
};

struct srv_lane {
    struct srv_fair turn; /* first; among the lanes of its group */
    struct srv_group *group;
    struct srv_job *first;
    struct srv_job *last;
    bool serving;
};

/* A long job may run in parts, and those of others come between them: after each part it
 * is QUEUED again, the first of its lane, and can be removed.
 * Links, lane and state belong to the queue's lock; the rest to whom the state says. */
struct srv_job {
    struct srv_job *next;
    struct srv_lane *lane;
    enum srv_job_state state;
    srv_job_fn run;     /* [compute] */
    srv_job_fn done;    /* [loop]; may free the job */
    atomic_bool cancel; /* set by [loop], polled by [compute]; relaxed: a hint, no data */
    bool goes_on;       /* [compute] set by `run`: a part is done; call it again */
};

struct srv_compute {
    pthread_t thread;
    bool started;
    pthread_mutex_t mutex; /* everything below */
    pthread_cond_t wake;   /* a lane has a job, or stop */
    bool stop;
    struct srv_fairqueue groups;
    uint32_t queued;   /* jobs in lanes */
    bool is_running;   /* one of those taken from them */
    uint32_t capacity; /* of those pushed by srv_compute_push */
    struct srv_job *done_first;
    struct srv_job *done_last;
    /* [compute]: the list of done jobs is no longer empty */
    void (*notify)(void *context);
    void (*enter)(void *context);
    void *context; /* of both */
};

/* Start the thread, all signals blocked in it. `enter` (NULL: nothing) is the first that
 * runs there, before any job. Returns 0, PCCD_E_NOMEM or PCCD_E_SYSTEM. [loop] */
int srv_compute_start(struct srv_compute *compute, uint32_t capacity,
                      void (*enter)(void *context), void (*notify)(void *context),
                      void *context);

/* Let the running job end, join the thread. No job may be queued or undrained. [loop] */
void srv_compute_stop(struct srv_compute *compute);

/* A queue without a thread: whoever pushes runs the jobs, too. Returns 0 or PCCD_E_NOMEM.
 * [loop] */
int srv_compute_init(struct srv_compute *compute, uint32_t capacity);
/* No job may be queued or undrained. [loop] */
void srv_compute_deinit(struct srv_compute *compute);
/* Run the job whose turn it is, or a part of it, on this thread. False: there is none.
 * [compute] */
bool srv_compute_run_next(struct srv_compute *compute);

void srv_job_init(struct srv_job *job, srv_job_fn run, srv_job_fn done);

/* Returns 0 or PCCD_E_BUSY (`capacity` jobs wait already). [loop] */
int srv_compute_push(struct srv_compute *compute, struct srv_lane *lane,
                     struct srv_job *job);

/* The same without a bound, for jobs that free something: there is at most one of them
 * per thing that was admitted. [loop] */
void srv_compute_push_reap(struct srv_compute *compute, struct srv_lane *lane,
                           struct srv_job *job);

/* Take a queued job out of its lane; its `run` and `done` are not called. false: it was
 * not queued any more. [loop] */
bool srv_compute_remove(struct srv_compute *compute, struct srv_job *job);

/* Call `change` of a job that is queued, which cannot begin meanwhile; it stays where it
 * is. false: it was not queued any more, and nothing was called. [loop] */
bool srv_compute_amend(struct srv_compute *compute, struct srv_job *job,
                       void (*change)(struct srv_job *job, void *context), void *context);

/* Call `done` of every finished job, in the order in which they finished. [loop] */
uint32_t srv_compute_drain(struct srv_compute *compute);

/* Let so many jobs wait from now on; those that do stay. [loop] */
void srv_compute_resize(struct srv_compute *compute, uint32_t capacity);

/* Nothing waits or runs, and all that has run was drained: until the next push nobody but
 * the caller touches what jobs do. [loop] */
bool srv_compute_is_idle(struct srv_compute *compute);

/* Jobs that wait now. [any] */
uint32_t srv_compute_queued(struct srv_compute *compute);

#endif
