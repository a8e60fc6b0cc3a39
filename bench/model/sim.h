/* sim.h - predicts how long a step takes with p threads, from recorded costs of its
 * tasks.
 *
 * Threads: one.
 *
 * Times are nanoseconds since the step began, in doubles. Ties go to the lower thread.
 */
#ifndef MODEL_SIM_H
#define MODEL_SIM_H

#include "machine.h"
#include "record.h"

struct model_input {
    const struct model_record *record;
    const struct model_division *division; /* for the same number of threads */
    const struct model_machine *machine;
    double serial;      /* before and after the region: ingest, commit, preparation */
    double merge_alone; /* by a step of one thread */
    enum pccd_method method;
    enum eng_scheduler scheduler; /* wide: stealing */
    enum eng_high_level high_level;
    enum eng_refit_scheme refit;
};

/* Wall time by phase; the five add up to `total`. */
struct model_output {
    double total;
    double refit;
    double low; /* by stealing: all nodes */
    double high;
    double merge;
    double serial;
    double wait;      /* mean over the threads: time in the region without work */
    double detection; /* from its first thread's begin to its last's end */
    /* Work, as the sum over the threads of what tasks cost. */
    double refit_work;
    double low_work;
    double high_work;
    double merge_work;
    double performed; /* what the threads did of low_work and high_work: all of it */
    /* Detection cannot take less: the longest chain of tasks that wait for each other. */
    double critical;
    double largest;      /* task of the scheduler, with its tests */
    uint64_t hand_overs; /* nodes given, tasks stolen */
    uint64_t sleeps;     /* sleeps without a request; failed rounds over the victims */
};

/* The step by one thread: the sum of all costs, and nothing else. */
void model_alone(const struct model_input *input, struct model_output *output);

/* The step by division->threads threads. */
void model_simulate(const struct model_input *input, struct model_output *output);

/* ---- shared by the schedulers' files --------------------------------------------- */

/* A cache line that threads change, or a lock: one at a time, in the order of time. */
struct sim_line {
    double free_at;
    uint32_t owner; /* who changed it last; UINT32_MAX: nobody, or others read it */
};

struct sim_thread {
    double now;
    double busy; /* of it, in tasks */
    /* Chunks of candidates on their way to the tests, and what those will cost. */
    uint64_t waiting[MODEL_KINDS];
    double waiting_ns[MODEL_KINDS];
};

struct sim {
    const struct model_input *input;
    uint32_t count;
    uint32_t refit_thread; /* who ended the refit, and begins the schedule */
    struct sim_thread threads[MODEL_THREADS_MAX];
    struct model_output *output;
};

/* Change the line at `now`: returns when that is done. */
double sim_line_use(struct sim *sim, struct sim_line *line, uint32_t thread, double now);

/* The thread performs a task, with the tests of chunks that fill up; returns the time
 * that takes. The clock is the caller's to move. */
double sim_perform(struct sim *sim, struct sim_thread *thread,
                   const struct model_task *task);
/* Test what is left in the chunks; the same. */
double sim_flush(struct sim *sim, struct sim_thread *thread);

/* When the last thread stands. */
double sim_latest(const struct sim *sim);
double sim_largest(const struct model_tasks *tasks);

/* All threads wait for each other. */
void sim_barrier(struct sim *sim);

/* Who is free first. */
uint32_t sim_earliest(const struct sim *sim);

/* The thread does something that is not a task. */
void sim_work(struct sim_thread *thread, double ns);

/* The refit; all may look at the boxes after it. */
void sim_refit(struct sim *sim);
void sim_refit_wide(struct sim *sim);

/* The schedulers, from the refit's end to their own; no barrier after. */
void sim_steal(struct sim *sim);
void sim_paper(struct sim *sim);

#endif
