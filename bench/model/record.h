/* record.h - lists every task of a step, for each scheduler and number of threads, as
 * input of the model.
 *
 * Walk over the scene as its last step left it, with one worker, in the order of one
 * thread: all task units (the paper's scheduler), all tasks of work stealing, the high-
 * level nodes for one number of threads, the refit. Of the method wide: the tasks and the
 * chunks of the refit.
 *
 * Threads: one.
 *
 * The walk calls the engine's own functions for what takes time; which node belongs to
 * whom is asked of the engine (eng_schedule_paper_begin, eng_refit_plan).
 */
#ifndef MODEL_RECORD_H
#define MODEL_RECORD_H

#include "refit.h"
#include "step.h"
#include "task.h"
#include "walker.h"

#define MODEL_THREADS_MAX 64u
#define MODEL_NO_TASK     UINT32_MAX

/* The method wide: boxes in chunks, and tasks that all come from those dealt out. */
struct model_wide {
    double *chunk_ns[ENG_WIDE_TREES];
    uint32_t chunk_count[ENG_WIDE_TREES];
    double above_ns; /* boxes above the chunks, by one thread */
    double deal_ns;  /* from the roots to the first tasks, by one thread */
    double enter_ns; /* each thread gets ready to search */
    uint64_t *dealt; /* the first tasks, as the engine names them: tasks.items[0 ..] */
    uint32_t dealt_count;
    struct model_tasks tasks;
};

/* What does not depend on the number of threads. */
struct model_record {
    struct eng_scene *scene;
    enum pccd_method method; /* paper: all but `wide`; wide: that, and what to merge */
    const struct eng_near_query *near; /* NULL: contacts are looked for */
    struct model_wide wide;
    uint32_t passes; /* medians are over so many */
    double clock_ns;
    uint32_t unit_grain; /* of work stealing */
    uint32_t pair_grain;
    struct model_tasks units; /* self-CD task units, depth-first from the root */
    uint32_t *unit_of; /* [node_capacity] index in `units`; leaves: MODEL_NO_TASK */
    struct model_tasks steal; /* [0] is the root's; children in the order of pushing */
    double vertices_ns;       /* refit of all of them */
    double edges_ns;
    double refit_scale; /* a refit in a step to one in a row: caches */
    bool consistent;    /* all passes met the same tasks */
    /* What the whole step found, to merge it again. */
    struct model_walker walker; /* who found it */
    struct eng_found found;
    struct eng_block **blocks;
    uint32_t block_count;
};

struct model_high {
    uint32_t node;
    /* Round robin: in `tasks` what thread 0 does alone, then the pairs dealt out. */
    uint32_t expansion;
    uint32_t pair_count;
    /* Disjoint pairs: in `disjoint`, 2^levels phases of 2^levels threads. */
    uint32_t phases;
};

/* How the tree is refitted. */
struct model_refit {
    struct eng_refit_plan plan; /* for so many threads */
    double *root_ns;            /* of each subtree */
    double node_ns;             /* of each node above them */
};

/* How the answer is merged. */
struct model_merge {
    bool shared;       /* else all is `end_ns`, by one thread */
    double survey_ns;  /* of each thread's list */
    double plan_ns;    /* by the last one to come */
    double divide_ns;  /* of each thread's list */
    double buckets_ns; /* all, taken on demand */
    uint32_t bucket_count;
    double end_ns; /* by one thread */
};

/* What depends on it. */
struct model_division {
    uint32_t threads;
    uint32_t first_node[MODEL_THREADS_MAX]; /* low-level nodes, or ENG_NO_NODE */
    uint32_t high_count;
    struct model_high high[MODEL_THREADS_MAX]; /* in the order in which they are done */
    uint32_t levels;                           /* of disjoint pairs */
    struct model_tasks tasks;    /* of the high-level nodes, by round robin */
    struct model_tasks disjoint; /* the same work by disjoint pairs */
    double begin_ns;             /* eng_schedule_paper_begin */
    struct model_refit refit[ENG_REFIT_COUNT]; /* of enum eng_refit_scheme */
    struct model_merge merge;
    uint32_t *owner;             /* wide: who is dealt each of the first tasks */
    struct model_walker *walker; /* while it is recorded */
    bool consistent;
};

/* Tasks and chunks of the method wide; who gets the first tasks. */
void model_wide_init(struct model_record *record);
void model_wide_deinit(struct model_wide *wide);
uint32_t *model_wide_owners(const struct model_record *record, uint32_t threads);
/* The boxes of all chunks and above them, as one thread makes them. */
double model_wide_refit_ns(const struct model_wide *wide);
/* As model_refit_calibrate, and the same for the tasks: all parts are then as the fastest
 * steps by one thread had them, whatever the clock did while each task was timed. */
void model_wide_calibrate(struct model_wide *wide, double refit_ns, double detection_ns);

/* The fields `scene`, `method`, `passes`, `clock_ns` and the grains are filled in
 * already. */
void model_record_init(struct model_record *record);
void model_record_deinit(struct model_record *record);

/* Time the refit of vertices and edges, and that of the subtrees of a plan. */
void model_refit_features(struct model_record *record);
/* In a step the refit comes after other work, and finds nothing in the caches: make its
 * parts add up to what it took there, by one thread. */
void model_refit_calibrate(struct model_record *record, double refit_ns);
void model_refit_init(struct model_refit *refit, const struct model_record *record,
                      enum eng_refit_scheme scheme, uint32_t threads);
/* All of it, as one thread does it. */
double model_refit_ns(const struct model_refit *refit, const struct model_record *record);
void model_refit_deinit(struct model_refit *refit);

/* Remember what was found, and time the merge of it. */
void model_merge_keep(struct model_record *record, const struct eng_found *found);
void model_merge_init(struct model_merge *merge, const struct model_record *record,
                      uint32_t threads);

void model_division_init(struct model_division *division,
                         const struct model_record *record, uint32_t threads);
void model_division_deinit(struct model_division *division);

#endif
