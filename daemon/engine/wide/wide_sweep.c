/* daemon/engine/wide/wide_sweep.c - the candidate pairs of plain swept boxes.
 *
 * Room:     engine.
 * Does:     refit with both ends' boxes united, go through all pairs.
 * Threads:  wide_sweep.h.
 */
#include "wide_sweep.h"

#include <omp.h>
#include <string.h>

#include "clock.h"
#include "memory.h"
#include "wide_join.h"
#include "world.h"

/* What is given to one thread at a time. */
struct task {
    enum eng_kind kind;
    uint32_t level;
    uint32_t n;
    uint32_t m;
};

struct tasks {
    struct task *list;
    uint32_t count;
    uint32_t capacity;
};

/* One thread's. */
struct sweeper {
    struct eng_wide_join join;
    const struct eng_wide *wide;
    eng_wide_visit visit;
    void *context;
    uint64_t count[ENG_KINDS];
    uint64_t a[ENG_CHUNK_MAX];
    uint64_t b[ENG_CHUNK_MAX];
};

static void hand_over(struct sweeper *sweeper, enum eng_kind kind,
                      const struct eng_wide_chunk *chunk)
{
    const struct eng_wide *wide = sweeper->wide;
    for (uint32_t i = 0; i < chunk->count; i++) {
        if (kind == ENG_VF) {
            sweeper->a[i] = wide->points[chunk->a[i]].word1;
            sweeper->b[i] = wide->trees[ENG_WIDE_FACES].keys[chunk->b[i]];
        } else {
            uint64_t a = wide->trees[ENG_WIDE_EDGES].keys[chunk->a[i]];
            uint64_t b = wide->trees[ENG_WIDE_EDGES].keys[chunk->b[i]];
            sweeper->a[i] = a < b ? a : b;
            sweeper->b[i] = a < b ? b : a;
        }
    }
    sweeper->visit(sweeper->context, kind, sweeper->a, sweeper->b, chunk->count);
}

static void on_chunk(void *owner, enum eng_kind kind, struct eng_wide_chunk *chunk)
{
    struct sweeper *sweeper = owner;
    sweeper->count[kind] += chunk->count;
    if (sweeper->visit && chunk->count > 0) {
        hand_over(sweeper, kind, chunk);
    }
    chunk->count = 0;
}

static void on_look(void *owner)
{
    (void)owner;
}

static void sweeper_init(struct sweeper *sweeper, const struct eng_wide *wide,
                         eng_wide_visit visit, void *context)
{
    memset(sweeper, 0, sizeof *sweeper);
    sweeper->wide = wide;
    sweeper->visit = visit;
    sweeper->context = context;
    sweeper->join.owner = sweeper;
    sweeper->join.flush = on_chunk;
    sweeper->join.look = on_look;
    eng_wide_join_begin(&sweeper->join, wide, ENG_JOIN_SWEPT);
}

static int add(struct tasks *tasks, struct task task)
{
    if (tasks->count == tasks->capacity) {
        uint32_t capacity = eng_world_grown(tasks->capacity, tasks->count + 1024);
        int status = eng_world_grow(&tasks->list, capacity, sizeof *tasks->list);
        if (status != ENG_OK) {
            return status;
        }
        tasks->capacity = capacity;
    }
    tasks->list[tasks->count++] = task;
    return ENG_OK;
}

/* The roots, refined down to pairs of nodes of 256 features. */
static int divide(struct tasks *tasks, struct eng_wide_join *join, uint32_t top)
{
    int status = add(tasks, (struct task){ENG_VF, top, 0, 0});
    if (status == ENG_OK) {
        status = add(tasks, (struct task){ENG_EE, top, 0, 0});
    }
    for (uint32_t i = 0; i < tasks->count && status == ENG_OK;) {
        struct task task = tasks->list[i];
        if (task.level < 2) {
            i++;
            continue;
        }
        struct eng_wide_list *below = &join->lists[task.level - 1];
        tasks->list[i] = tasks->list[--tasks->count];
        eng_wide_join_refine(join, task.kind, task.level, task.n, task.m);
        for (uint32_t k = 0; k < below->count && status == ENG_OK; k++) {
            status = add(tasks, (struct task){task.kind, task.level - 1, below->a[k],
                                              below->b[k]});
        }
        below->count = 0;
    }
    return status;
}

static void perform(struct sweeper *sweeper, const struct tasks *tasks)
{
#pragma omp for schedule(dynamic, 4)
    for (uint32_t i = 0; i < tasks->count; i++) {
        const struct task *task = &tasks->list[i];
        eng_wide_join_nodes(&sweeper->join, task->kind, task->level, task->n, task->m);
    }
    eng_wide_join_flush(&sweeper->join);
}

static void refit(struct eng_wide *wide, const struct eng_scene *scene, uint32_t threads)
{
    if (threads == 1) {
        eng_wide_refit(wide, scene, true);
        return;
    }
#pragma omp parallel num_threads((int)threads)
    for (enum eng_wide_kind kind = 0; kind < ENG_WIDE_KINDS; kind++) {
        uint32_t count = eng_wide_refit_chunks(wide, kind);
#pragma omp for schedule(dynamic, 4)
        for (uint32_t i = 0; i < count; i++) {
            eng_wide_refit_chunk(wide, scene, kind, i, true);
        }
    }
    eng_wide_refit_above(wide, true);
}

static int pairs(struct sweeper *sweepers, uint32_t threads, uint32_t top,
                 struct tasks *tasks)
{
    if (threads == 1) {
        eng_wide_join_nodes(&sweepers[0].join, ENG_VF, top, 0, 0);
        eng_wide_join_nodes(&sweepers[0].join, ENG_EE, top, 0, 0);
        eng_wide_join_flush(&sweepers[0].join);
        return ENG_OK;
    }
    int status = divide(tasks, &sweepers[0].join, top);
    if (status == ENG_OK) {
        struct eng_payer *payer = eng_payer();
#pragma omp parallel num_threads((int)threads)
        {
            eng_payer_join(payer);
            perform(&sweepers[omp_get_thread_num()], tasks);
        }
    }
    return status;
}

int eng_wide_sweep(struct eng_scene *scene, uint32_t threads, eng_wide_visit visit,
                   void *context, struct eng_wide_sweep *sweep)
{
    struct eng_wide *wide = &scene->wide;
    struct tasks tasks = {0};
    struct sweeper *sweepers = eng_alloc(threads, sizeof *sweepers);
    int status = sweepers ? ENG_OK : ENG_E_NOMEM;
    eng_frames_choose(scene, 1 - scene->now, scene->now);
    if (status == ENG_OK && wide->is_stale) {
        status = eng_wide_assemble(wide, scene);
    }
    uint64_t begin_ns = eng_now_ns();
    if (status == ENG_OK) {
        refit(wide, scene, threads);
        uint64_t refit_ns = eng_now_ns();
        for (uint32_t i = 0; i < threads; i++) {
            sweeper_init(&sweepers[i], wide, visit, context);
        }
        uint64_t pairs_ns = eng_now_ns();
        status = pairs(sweepers, threads, wide->level_count - 1, &tasks);
        *sweep = (struct eng_wide_sweep){.refit_ns = refit_ns - begin_ns,
                                         .pairs_ns = eng_now_ns() - pairs_ns};
    }
    for (uint32_t i = 0; i < threads && status == ENG_OK; i++) {
        sweep->vf += sweepers[i].count[ENG_VF];
        sweep->ee += sweepers[i].count[ENG_EE];
        sweep->box_tests += eng_wide_join_tests(&sweepers[i].join);
    }
    eng_free(tasks.list);
    eng_free(sweepers);
    return status;
}
