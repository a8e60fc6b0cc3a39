/* compute.h - the queue of work, and the threads that compute it, with fair turns for all
 * users.
 *
 * Room:     service. May include: the C library.
 * Does:     run jobs one after another on a thread of its own; beside a job that takes
 *           long, run the next ones on another thread. Hand finished jobs back in
 *           batches, one notification per batch.
 * Does not: know what a job computes, or own jobs: they are part of larger structs.
 * Threads:  functions say; `run` is called on [compute], `done` on [loop]. There are two
 *           queues: one for the engine and its teams; the other, [pages], makes and frees
 *           rings, which takes 2 us a page and would hold up steps for as long.
 *
 * Jobs wait in lanes, one lane per session, and lanes in groups, one group per user.
 * Within a lane the order is first in, first out, and one job runs at a time. Users get
 * equal shares of the thread's time, and the sessions of a user equal shares of that
 * user's. Time is measured, jobs are not counted (fairqueue.h): a client with many or
 * large jobs delays a client that asks for little by at most the job that runs. What is
 * measured is processor time: on a busy machine other programs take the processor away
 * for milliseconds, and a client must not be charged for these.
 *
 *     IDLE --push--> QUEUED --taken--> RUNNING --finished--> DONE --drain--> IDLE
 *                      \--remove--> IDLE  \--goes on--> QUEUED
 *
 * One job runs at a time, until it has run for SRV_LONG_NS. Then it is long, and another
 * runner, which is a thread with a team of its own, takes the next job. So at most one
 * job is not long, and others wait for it at most 10 ms. Where no job is long there is
 * one thread. The kernel divides the processors among the runners: beside k long jobs a
 * job takes k + 1 times as long as alone.
 *
 * Why threads? A long job could instead serve others between two parts of its work. But
 * the engine would then have to stop every few milliseconds in every phase of every job,
 * and a job that is itself long, taken in such a pause, would hold up the first one.
 *
 * Runners are started when first needed and sleep afterwards. A user has at most half of
 * those that other users leave, so that of 8 runners one user has 4, the next 2: a user
 * with three long jobs is still served, and whatever these two do, so are two more users.
 *
 * Two jobs that use the same thing, such as steps of one shared scene, claim it and do
 * not run at once (claim.h). A lane whose first job must wait for that is passed over
 * until any job ends; other lanes go on.
 */
#ifndef SRV_COMPUTE_H
#define SRV_COMPUTE_H

#include <pthread.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

#include "claim.h"
#include "fairqueue.h"

struct srv_job;
typedef void (*srv_job_fn)(struct srv_job *job);

enum srv_job_state {
    SRV_JOB_IDLE = 0,
    SRV_JOB_QUEUED = 1,
    SRV_JOB_RUNNING = 2,
    SRV_JOB_DONE = 3
};

#define SRV_RUNNERS_MAX 8u        /* of a queue */
#define SRV_LONG_NS     10000000u /* that a job runs before another may run beside it */

/* All zero but for lane.group: nothing waits. They belong to the queue's lock. */
struct srv_group {
    struct srv_fair turn; /* first */
    struct srv_fairqueue lanes;
    uint32_t running; /* jobs of its lanes */
};

struct srv_lane {
    struct srv_fair turn; /* first; among the lanes of its group */
    struct srv_group *group;
    struct srv_job *first;
    struct srv_job *last;
    struct srv_lane *next_aside; /* of compute->aside */
    bool serving;                /* a job of it runs */
    bool is_background;          /* its first job waits for what another has claimed */
};

/* A long job may run in parts, and those of others come between them: after each part it
 * is QUEUED again, the first of its lane, and can be removed.
 * All above `run` belongs to the queue's lock; the rest to whom the state says. */
struct srv_job {
    struct srv_job *next;
    struct srv_lane *lane;
    enum srv_job_state state;
    bool counts;        /* towards the capacity of the queue, while it waits */
    srv_job_fn run;     /* [compute] */
    srv_job_fn done;    /* [loop]; may free the job */
    atomic_bool cancel; /* set by [loop], polled by [compute]; relaxed: a hint, no data */
    bool heeds_end;     /* its `run` ends soon after it is cancelled, or after */
    atomic_uint_least64_t end_ns; /* [compute] this time; 0: none. Relaxed */
    bool goes_on; /* [compute] set by `run`: a part is done; call it again */
    /* What it uses that jobs of other lanes may use, too; constant while it is queued. */
    struct srv_claim *const *claims;
    uint32_t claim_count;
};

/* A thread that computes. Locked, but for what says otherwise. */
struct srv_runner {
    struct srv_compute *compute; /* constant */
    uint32_t number;             /* likewise */
    pthread_t thread;            /* [loop] */
    pthread_cond_t wake;         /* there is something to take, or stop */
    struct srv_job *job;         /* that it runs; NULL: none */
    uint64_t begin_ns;           /* since when */
    bool is_long;                /* it has run for SRV_LONG_NS */
};

struct srv_compute {
    pthread_mutex_t mutex; /* everything below that is not constant or [loop]'s */
    struct srv_runner runners[SRV_RUNNERS_MAX];
    uint32_t runner_count; /* started */
    uint32_t runner_max;   /* constant */
    bool stop;
    struct srv_fairqueue groups;
    struct srv_lane *aside; /* lanes that wait for a claim */
    uint32_t queued;        /* jobs in lanes */
    uint32_t counted;       /* of these, those that count towards the capacity */
    uint32_t running;       /* taken from them */
    uint32_t long_count;    /* of these */
    bool has_no_taker;      /* all that wait have their share, until something changes */
    uint32_t capacity;      /* of `counted` */
    struct srv_job *done_first;
    struct srv_job *done_last;
    /* [compute]: the list of done jobs is no longer empty */
    void (*notify)(void *context);
    void (*enter)(void *context, uint32_t number);
    /* [loop]: a job waits for another: srv_compute_look is to be called. NULL: nobody
     * looks */
    void (*crowded)(void *context);
    void *crowded_context;
    void *context; /* of the other two */
};

/* Start the first runner, all signals blocked in it; there may be `runner_max`. `enter`
 * (NULL: nothing) is the first that runs on each, before any job. Returns 0, PCCD_E_NOMEM
 * or PCCD_E_SYSTEM. [loop] */
int srv_compute_start(struct srv_compute *compute, uint32_t capacity, uint32_t runner_max,
                      void (*enter)(void *context, uint32_t number),
                      void (*notify)(void *context), void *context);

/* Start one more; fewer than runner_max have been. Returns 0 or PCCD_E_SYSTEM. [loop] */
int srv_compute_add_runner(struct srv_compute *compute);

/* See which jobs have become long, and wake a runner for one that waits. Returns after
 * how many ns to look again, 0: when there is another reason to; *wants_runner says that
 * all that have been started are busy with long jobs, and one more may be. [loop] */
uint64_t srv_compute_look(struct srv_compute *compute, bool *wants_runner);

/* Let the running jobs end, join the threads. No job may be queued or undrained.
 * [loop] */
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

/* Returns 0 or PCCD_E_BUSY (`capacity` jobs wait that count). [loop] */
int srv_compute_push(struct srv_compute *compute, struct srv_lane *lane,
                     struct srv_job *job);

/* The same for jobs that free something, at most one for each thing that was admitted.
 * They do not count: who waits for an answer is not refused for them. [loop] */
void srv_compute_push_reap(struct srv_compute *compute, struct srv_lane *lane,
                           struct srv_job *job);

/* Take a queued job out of its lane; its `run` and `done` are not called. false: it was
 * not queued any more. [loop] */
bool srv_compute_remove(struct srv_compute *compute, struct srv_job *job);

/* Call `change`, unless it is NULL, of a job that is queued and cannot begin meanwhile:
 * it may change job->counts. false: the job was not queued any more. [loop] */
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
