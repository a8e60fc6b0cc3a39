/* model.h - a step's tasks, each timed, replayed by a list scheduler. */
#ifndef MODEL_MODEL_H
#define MODEL_MODEL_H

#include <stdint.h>
#include <stdio.h>

#include "affinity.h"
#include "resident.h"
#include "step.h"
#include "worker.h"

#define MODEL_WAYS_MAX 3

/* Nanoseconds. The parts are minima: other work on the machine only adds to them. */
struct model_measured {
    double step;   /* median */
    double ratio;  /* median over the turns: this step to the first way's of the turn */
    double serial; /* copying the positions, and what is none of the others */
    double refit;
    double detection; /* traversal and tests */
    double merge;
};

/* One way to run the step. */
struct model_way {
    uint32_t threads;
    enum eng_scheduler scheduler;
    enum pccd_method method;
    struct model_measured measured; /* by model_measure */
};

/* Run the same step `turns` times in each way, by turns, so that other work on the
 * machine hits all of them; ways[0] is by one thread. Returns whether all answers have
 * the same hash. */
bool model_measure(const struct bench_frames *frames, struct bench_world *world,
                   const struct eng_affinity *affinity, struct model_way *ways,
                   uint32_t way_count, uint32_t turns);

/* ---- Measures what it costs on this machine that threads meet.
 *
 * Medians, in nanoseconds. With one processor the costs between two are those of one. */

struct model_costs {
    double clock;     /* a reading of the clock, taken off each task's time */
    double take;      /* push a task to one's own deque, and pop it */
    double barrier;   /* of two threads that arrive together */
    double wake;      /* from the start of a region until the second thread runs */
    double wake_each; /* the starter's time for each thread that it wakes */
};

/* Measure all, on the first two processors of `affinity`. Takes about a second. */
void model_costs_measure(struct model_costs *costs, const struct eng_affinity *affinity);

/* One line a cost, in CSV: name, nanoseconds. */
void model_costs_print(const struct model_costs *costs, FILE *out);

/* ---- a list scheduler ---------------------------------------------------------------
 *
 * Replay tasks on more threads than there are processors. Times are nanoseconds since the
 * step began. Of threads that are free at once the lower one is first. */

#define MODEL_THREADS_MAX 64u

struct model_task {
    double ns;
    uint32_t first_child; /* tasks that it makes: `child_count` from here on */
    uint32_t child_count;
};

/* A list; memory grows. Zero to begin with. */
struct model_tasks {
    struct model_task *items;
    uint32_t count;
    uint32_t capacity;
};

/* Append `count` tasks of no time; returns the index of the first. */
uint32_t model_tasks_add(struct model_tasks *tasks, uint32_t count);
void model_tasks_free(struct model_tasks *tasks);

double model_tasks_sum(const struct model_tasks *tasks);
/* Return the time of the longest chain of tasks that make each other from a root on (see
 * model_schedule): no number of threads can be faster. Children stand behind parents.
 * *largest: of one task. */
double model_tasks_chain(const struct model_tasks *tasks, const uint32_t *roots,
                         uint32_t count, double *largest);
/* Multiply all times. */
void model_tasks_scale(struct model_tasks *tasks, double factor);

struct model_threads {
    const struct model_costs *costs;
    uint32_t count;
    double now[MODEL_THREADS_MAX]; /* when the thread is free */
    double busy;                   /* of all, in tasks */
};

double model_latest(const struct model_threads *threads);
/* Return the thread that is free first. */
uint32_t model_earliest(const struct model_threads *threads);

/* The thread works alone for `ns`. */
void model_work(struct model_threads *threads, uint32_t thread, double ns);

/* All threads wait for each other. */
void model_barrier(struct model_threads *threads);

/* Perform `count` tasks, roots[k] or, if that is NULL, task k, and all that they make.
 * The k-th is dealt to thread k * threads / count. A thread does what it made last
 * first; one that has nothing takes what was made first of all, which costs it
 * `hand_over` more. */
void model_schedule(struct model_threads *threads, const struct model_tasks *tasks,
                    const uint32_t *roots, uint32_t count, double hand_over);

/* ---- the tasks of a step ------------------------------------------------------------
 *
 * Walk over the scene as its last step left it, with one worker, by the engine's own
 * functions; which node belongs to whom is asked of the engine. A task that fills a chunk
 * of candidates pays for its tests, as in a step by one thread. */

/* Measurements that do not depend on the number of threads. */
struct model_record {
    struct eng_scene *scene;
    enum pccd_method method;
    uint32_t passes; /* times are the least of so many */
    double clock_ns;
    bool is_consistent; /* all passes met the same tasks */
    /* Tasks of stealing; the first `root_count` are there at the begin, named `roots`. */
    struct model_tasks steal;
    uint64_t *roots;
    uint32_t root_count;
    double deal_ns;           /* to find the roots, by one thread */
    struct model_tasks units; /* paper: its task units */
    uint32_t *unit_of;        /* [node_capacity] index in `units` */
    struct eng_worker *worker;
    struct eng_pool pool;
    struct eng_stop stop;
    struct eng_question settings;
};

/* A high-level node of the method paper. */
struct model_high {
    uint32_t node;
    uint32_t expansion;  /* in `tasks`: by one thread; its pairs stand behind it */
    uint32_t pair_count; /* dealt out */
};

#define MODEL_STAGES 3

/* Work divided among a number of threads, as measured. */
struct model_division {
    uint32_t threads;
    bool is_consistent;
    /* Vertices, then what needs them, then what one thread does after that; parts of a
     * stage in any order. */
    struct model_tasks refit[MODEL_STAGES];
    uint32_t low_count; /* paper: low-level nodes, in `units` */
    uint32_t low[MODEL_THREADS_MAX];
    uint32_t high_count;
    struct model_high high[MODEL_THREADS_MAX]; /* in the order in which they are done */
    struct model_tasks tasks;                  /* of the high-level nodes */
};

/* The first four fields are filled in already. */
void model_record_init(struct model_record *record);
void model_record_free(struct model_record *record);

void model_division_init(struct model_division *division, struct model_record *record,
                         uint32_t threads);
void model_division_free(struct model_division *division);

#endif
