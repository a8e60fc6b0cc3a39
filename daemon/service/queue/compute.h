/* compute.h - the queue of work, and the threads that compute it, with fair turns for all
 * users.
 *
 * Run jobs one after another on a thread of its own; beside a job that takes long, run
 * the next ones on another thread. Hand finished jobs back in batches, one notification
 * per batch.
 *
 * Threads: functions say; `run` is called on [compute], `done` on [loop]. There are two
 * queues: one for the engine and its teams; the other, [pages], makes and frees rings,
 * which takes 2 us a page and would hold up steps for as long.
 *
 * Jobs wait in lists, one per session, and lists in groups, one group per user. In a
 * list the order is first in, first out, and one job runs at a time. Users get
 * equal shares of the thread's time, and the sessions of a user equal shares of that
 * user's. Time is measured, jobs are not counted (turns.h): a client with many or
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
 * Runners are started when first needed and sleep afterwards. There are place_max places,
 * each with a team. A user has at most half of those that others leave: of 8 the first
 * has 4, the next 2. When all are taken, a user of whom no job runs gets one more runner
 * at once, without a team; there are runner_max. So a turn comes within 50 ms, whatever
 * others have: 5 ms for each place, where many wait, and the loop's timer.
 *
 * Two jobs that use the same thing, such as steps of one shared scene, claim it and do
 * not run at once (turns.h). A list whose first job must wait for that is passed over
 * until any job ends; other lists go on.
 */
#ifndef SRV_COMPUTE_H
#define SRV_COMPUTE_H

#include <pthread.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

#include "turns.h"

#define SRV_PLACES      8u        /* runners of a queue that have a team */
#define SRV_RUNNERS_MAX 1024u     /* of a queue; as many as connections by default */
#define SRV_LONG_NS     10000000u /* that a job runs before another may run beside it, */
#define SRV_MANY        4u        /* or half of it, while more users than that wait */
#define SRV_SOON_NS     1000000u  /* after which one that was woken has taken a job */

struct srv_compute {
    pthread_mutex_t mutex;      /* everything below that is not constant or [loop]'s */
    struct srv_runner *runners; /* [runner_max] */
    uint32_t runner_count;      /* started */
    uint32_t runner_max;        /* constant */
    uint32_t place_max;         /* constant; the first runners have them */
    bool stop;
    struct srv_turns turns; /* of lists with jobs */
    uint32_t queued;        /* jobs in lists */
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
    void (*on_backlog)(void *context);
    void *backlog_context;
    void *context; /* of the other two */
};

struct srv_compute_settings {
    uint32_t capacity;   /* jobs that may wait */
    uint32_t place_max;  /* jobs that run at a time, but for those of users that would */
    uint32_t runner_max; /* wait then without any; place_max .. SRV_RUNNERS_MAX */
    void (*enter)(void *context, uint32_t number); /* the first on each runner, or NULL */
    void (*notify)(void *context);
    void *context; /* of both */
};

/* Start the first runner, all signals blocked in it. Returns 0, PCCD_E_NOMEM or
 * PCCD_E_SYSTEM. [loop] */
int srv_compute_start(struct srv_compute *compute,
                      const struct srv_compute_settings *settings);

/* Start one more; fewer than runner_max have been. Returns 0 or PCCD_E_SYSTEM. [loop] */
int srv_compute_add_runner(struct srv_compute *compute);

/* Look which jobs have become long, and wake a runner for one that waits. Returns after
 * how many ns to look again, 0: when there is another reason to; *wants_runner says that
 * all that have been started are busy, and one more may be. [loop] */
uint64_t srv_compute_look(struct srv_compute *compute, bool *wants_runner);

/* Let the running jobs end, join the threads. No job may be queued or undrained.
 * [loop] */
void srv_compute_stop(struct srv_compute *compute);

/* Make a queue without a thread: whoever pushes runs the jobs, too. Returns 0 or
 * PCCD_E_NOMEM. [loop] */
int srv_compute_init(struct srv_compute *compute, uint32_t capacity);
/* Free such a queue. No job may be queued or undrained. [loop] */
void srv_compute_deinit(struct srv_compute *compute);
/* Run the job whose turn it is, or a part of it, on this thread. False: there is none.
 * [compute] */
bool srv_compute_run_next(struct srv_compute *compute);

void srv_job_init(struct srv_job *job, srv_job_fn run, srv_job_fn done);

/* Queue a job. Returns 0 or PCCD_E_BUSY (`capacity` jobs wait that count). [loop] */
int srv_compute_push(struct srv_compute *compute, struct srv_job_list *list,
                     struct srv_job *job);

/* Queue a job that frees something; there is at most one for each thing that was
 * admitted. It does not count: who waits for an answer is not refused for it. [loop] */
void srv_compute_push_reap(struct srv_compute *compute, struct srv_job_list *list,
                           struct srv_job *job);

/* Take a queued job out of its list; its `run` and `done` are not called. false: it was
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

/* Return whether nothing waits or runs, and all that has run was drained: until the next
 * push nobody but the caller touches what jobs do. [loop] */
bool srv_compute_is_idle(struct srv_compute *compute);

/* Return how many jobs wait now. [any] */
uint32_t srv_compute_queued(struct srv_compute *compute);

/* Return whether a thread is stuck. To be called at equal intervals, long enough that a
 * thread which can run has run. It is stuck if its job goes on, but it has had no
 * processor time since the look before last: it waits for something that does not come.
 * Also if its step should have ended two looks ago, by its deadline or because it was
 * cancelled. */
bool srv_compute_is_stuck(struct srv_compute *compute);

#endif
