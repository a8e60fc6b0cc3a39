/* task.h - measures what each task of a step costs.
 *
 * Time tasks as one worker performs them, without the clock's own cost; add to each task
 * its share of the elementary tests of its candidates; take the median of several passes
 * over the same tasks.
 *
 * Threads: one.
 *
 * Candidates are tested in chunks of 1024, so the task that fills a chunk pays for the
 * tests of candidates that others have found. The time of a chunk is divided among the
 * tasks that filled it, by the number of their candidates.
 *
 * Time in which other programs had the processor is subtracted from tasks that are long
 * enough for it to matter.
 */
#ifndef MODEL_TASK_H
#define MODEL_TASK_H

#include "wide_test.h"
#include "worker.h"

#define MODEL_KINDS 2 /* enum pccd_kind */

struct model_task {
    double walk_ns;  /* traversal: boxes, leaves, candidates written */
    double tests_ns; /* elementary tests of the candidates it emits, whoever pays */
    uint32_t candidates[MODEL_KINDS];
    uint32_t first_child; /* tasks that it makes, in the order in which it pushes them */
    uint32_t child_count;
};

/* A list; memory grows. Zero to begin with. */
struct model_tasks {
    struct model_task *items;
    uint32_t count;
    uint32_t capacity;
};

/* Append `count` tasks of no cost; returns the index of the first. */
uint32_t model_tasks_add(struct model_tasks *tasks, uint32_t count);
void model_tasks_deinit(struct model_tasks *tasks);

/* `count` empty lists. */
struct model_tasks *model_tasks_passes(uint32_t count);
/* The medians over all passes of each task's times become `tasks`; `passes` are freed.
 * False: they do not have the same tasks with the same candidates, so their times mean
 * nothing. */
bool model_tasks_take_medians(struct model_tasks *tasks, struct model_tasks *passes,
                              uint32_t count);

/* The sum of both times over all tasks. */
double model_tasks_ns(const struct model_tasks *tasks);

/* A task's candidates that still wait in the worker's chunk. */
struct model_waiting {
    uint32_t task;
    uint32_t count;
};

struct model_recorder {
    struct eng_worker *worker;
    struct model_tasks *tasks;
    double clock_ns; /* of one reading, taken off each task */
    uint64_t begin_ns;
    uint64_t looked_ns; /* when the processor's own time was last asked for, */
    uint64_t used_ns;   /* and what it was */
    uint64_t tests_ns;
    bool is_wide;                  /* chunks are those of the method wide, */
    uint64_t flushed[MODEL_KINDS]; /* of which so many candidates left */
    uint64_t emitted[MODEL_KINDS];
    uint64_t tested[MODEL_KINDS];
    /* First in, first out; never more tasks than candidates in a chunk and one. */
    struct model_waiting waiting[MODEL_KINDS][ENG_CHUNK_MAX + 1];
    uint32_t waiting_count[MODEL_KINDS];
};

/* What a reading of the clock adds to a time between two readings. */
double model_clock_ns(void);

/* `worker` has begun a step and done nothing. */
void model_record_begin(struct model_recorder *recorder, struct eng_worker *worker,
                        struct model_tasks *tasks, double clock_ns);
/* The same by the method wide, whose eng_method_calls.enter the worker has called. */
void model_record_begin_wide(struct model_recorder *recorder, struct eng_worker *worker,
                             struct model_tasks *tasks, double clock_ns);
/* All that was done since the last close, or begin, was this task. */
void model_record_close(struct model_recorder *recorder, uint32_t task);
/* Test what is left in the chunks. */
void model_record_end(struct model_recorder *recorder);

#endif
