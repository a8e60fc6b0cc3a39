/* step_memory.h - the memory that a step leaves for the next one, so that a warm step
 * allocates nothing.
 */
#ifndef ENG_STEP_MEMORY_H
#define ENG_STEP_MEMORY_H

#include "answer_cache.h"
#include "merge.h"
#include "near_objects.h"
#include "question.h"
#include "turning_step.h"
#include "worker.h"
#include "world.h"

/* ---- does a team pay? -------------------------------------------------------------- */

struct eng_effort {
    uint64_t work_ns[PCCD_MODE_COUNT]; /* of all threads, by mode; 0: not known */
    bool paid; /* the last answer; the next one clings to it */
    struct eng_effort_took {
        uint64_t alone_ns, team_ns; /* from beginning to end, smoothed; 0: not known */
        uint32_t turns;             /* steps that this has decided */
    } took[PCCD_MODE_COUNT];
};

/* Return whether the next step in this mode should be taken by more than one thread. */
bool eng_effort_pays(struct eng_effort *effort, enum pccd_mode mode, uint32_t triangles);

/* Return the work of the next step in this mode, ns; before the first, a guess. */
uint64_t eng_effort_expects(const struct eng_effort *effort, enum pccd_mode mode,
                            uint32_t triangles);
/* Return whether so much work, in pieces that do not depend on each other, is worth a
 * team. */
bool eng_effort_is_enough(uint64_t work_ns);

/* Return whether a team pays for the next step where this part, 0 .. 1, of what is
 * searched as a rule moves. */
bool eng_effort_pays_for(const struct eng_effort *effort, enum pccd_mode mode,
                         double part);

/* Learn from a step that was done from beginning to end; `work_ns` is the time that its
 * threads took, without waiting. */
void eng_effort_learn(struct eng_effort *effort, enum pccd_mode mode, uint64_t work_ns);

/* Learn from a step that left out what stood still, and searched this part, 0 .. 1, of
 * what is searched as a rule. It can only show that the work is less than was believed:
 * one slow step at the beginning would else stand for as long as something stands. */
void eng_effort_learn_part(struct eng_effort *effort, enum pccd_mode mode, double part,
                           uint64_t work_ns);

/* Note how long it took, by a team or not. */
void eng_effort_time(struct eng_effort *effort, enum pccd_mode mode, bool by_team,
                     uint64_t took_ns);

/* Forget what was learned: the scene is another one. */
void eng_effort_forget(struct eng_effort *effort);

/* The work of the threads of an answer, which lives as long as the answer. */
struct eng_thread_records {
    struct eng_thread_record *items;
    uint32_t capacity;
};

/* The memory that an answer about what is near leaves for the next one. */
struct eng_near_memory {
    struct eng_effort effort[PCCD_METHOD_COUNT][PCCD_NEAR_COUNT];
    struct eng_records records; /* its records, or bounds by vertex */
    struct eng_records none;    /* those of one that only counts */
    struct eng_thread_records threads;
    _Atomic uint64_t *bounds; /* [bound_capacity] by the scene's vertices */
    uint32_t bound_capacity;
    atomic_bool meets; /* CROSSINGS: question.h */
    uint64_t *order;   /* [order_capacity] objects: id << 32 | index */
    uint32_t order_capacity;
    struct eng_near_objects objects; /* NEAREST, DEPTH */
};

/* The state of steps in body space (bodies.h). */
struct eng_bodies {
    bool is_last;         /* the last step was one: the boxes of the method are older */
    bool wants_trees;     /* some meshes have none yet */
    uint32_t steps_until; /* so many steps go by first that could be */
    uint32_t wait;        /* that it was set to last */
    uint64_t leaves;      /* that moved in the last one */
};

struct eng_step_memory {
    struct eng_worker *workers[ENG_THREADS_MAX]; /* made when first needed */
    uint32_t worker_count;
    /* While it borrows: its own first worker, and how many it has of its own. */
    struct eng_worker *own_first;
    uint32_t own_count;
    bool borrows;
    uint32_t most_threads; /* of the last turn_count steps */
    uint32_t turn_count;
    struct eng_thread_records threads;           /* of the last step */
    struct eng_effort effort[PCCD_METHOD_COUNT]; /* by method */
    struct eng_effort turning_effort;            /* of steps in which objects turn */
    struct eng_turning_step turning;
    struct eng_bodies bodies;
    struct eng_pool *pool;                       /* of the workers' records */
    struct eng_pool own_pool;
    struct eng_merge *merge;
    struct eng_merge own_merge;
    struct eng_records sorted;  /* the last answer */
    bool was_emptied;           /* the scene, since that answer */
    uint32_t steps_until_brief; /* of large ones; one has given up (step.c) */
    struct eng_records found;   /* what a step adds to those of it that it keeps */
    struct eng_answer_cache cache;
    struct eng_counts kept_counts; /* of what a step keeps */
    struct eng_near_memory near;   /* of eng_near */
};

/* Return the memory of a scene. */
static inline struct eng_step_memory *eng_step_memory_of(const struct eng_scene *scene)
{
    return scene->slots[ENG_SLOT_STEP];
}

uint64_t eng_step_memory_bytes(const struct eng_scene *scene);

extern const struct eng_slot_calls eng_step_slot;

/* Use, for an answer by one thread, the first worker of `lender`, its pool and its merge.
 * A worker that is made meanwhile is the lender's if it had none. */
void eng_step_memory_borrow(struct eng_step_memory *memory,
                            struct eng_step_memory *lender);
/* Give back what was borrowed, and count that no worker of its own was wanted. */
void eng_step_memory_give_back(struct eng_step_memory *memory,
                               struct eng_step_memory *lender);

/* Free all workers but the first `count`. */
void eng_step_memory_keep(struct eng_step_memory *memory, uint32_t count);

/* Return whether the next answer, by one thread, makes no worker, and frees none. */
bool eng_step_memory_stays(const struct eng_step_memory *memory);

/* Make workers for that many threads of the next answer, 1 .. ENG_THREADS_MAX, and room
 * in `records` for what they will have done. Workers that have not been wanted for long
 * are freed. PCCD_E_NOMEM: those at hand stay. */
int eng_step_memory_reserve(struct eng_step_memory *memory, uint32_t threads,
                            struct eng_thread_records *records);

#endif
