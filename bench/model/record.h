/* record.h - times every task of a step, as input of the list scheduler.
 *
 * Threads: one.
 *
 * Walk over the scene as its last step left it, with one worker, by the engine's own
 * functions; which node belongs to whom is asked of the engine. A task that fills a chunk
 * of candidates pays for its tests, as in a step by one thread.
 */
#ifndef MODEL_RECORD_H
#define MODEL_RECORD_H

#include "schedule.h"
#include "step.h"
#include "worker.h"

/* What does not depend on the number of threads. */
struct model_record {
    struct eng_scene *scene;
    enum pccd_method method;
    uint32_t passes; /* times are medians over so many */
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

/* What depends on it. */
struct model_division {
    uint32_t threads;
    bool is_consistent;
    /* Vertices, then what needs them; parts of a stage in any order. */
    struct model_tasks refit[2];
    double refit_end_ns; /* after all of them, by one thread */
    uint32_t low_count;  /* paper: low-level nodes, in `units` */
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
