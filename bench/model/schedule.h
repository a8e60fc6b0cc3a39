/* schedule.h - a list scheduler: replays tasks on more threads than there are processors.
 *
 * Threads: one.
 *
 * Times are nanoseconds since the step began. Of threads that are free at once the lower
 * one is first.
 */
#ifndef MODEL_SCHEDULE_H
#define MODEL_SCHEDULE_H

#include <stdint.h>

#include "measure.h"

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

/* Return the sum of all times, the greatest one, and the longest chain of tasks that make
 * each other from a root on (see model_schedule): no number of threads can be faster.
 * Children stand behind parents. */
double model_tasks_sum(const struct model_tasks *tasks);
double model_tasks_largest(const struct model_tasks *tasks);
double model_tasks_chain(const struct model_tasks *tasks, const uint32_t *roots,
                         uint32_t count);
/* Multiply all times. */
void model_tasks_scale(struct model_tasks *tasks, double factor);

struct model_threads {
    const struct model_costs *costs;
    uint32_t count;
    double now[MODEL_THREADS_MAX];  /* when the thread is free */
    double busy[MODEL_THREADS_MAX]; /* of it, in tasks */
    uint64_t hand_overs;            /* tasks done by another thread than their maker */
};

double model_latest(const struct model_threads *threads);

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

#endif
