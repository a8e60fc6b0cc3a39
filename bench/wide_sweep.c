/* wide_sweep.c - the candidate pairs of plain swept boxes. */
#include "wide_sweep.h"

#include <assert.h>
#include <omp.h>
#include <string.h>

#include "box_frames.h"
#include "clock.h"
#include "memory.h"
#include "parallel.h"
#include "wide_join.h"
#include "world.h"

/* Piece of work for one thread. */
struct task {
    enum pccd_kind kind;
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
    uint64_t count[PCCD_KIND_COUNT];
    uint64_t a[ENG_CHUNK_MAX];
    uint64_t b[ENG_CHUNK_MAX];
};

static void hand_over(struct sweeper *sweeper, enum pccd_kind kind,
                      const struct eng_wide_chunk *chunk)
{
    const struct eng_wide *wide = sweeper->wide;
    const enum pccd_tree tree_a = eng_wide_tree_of(kind, 0);
    const enum pccd_tree tree_b = eng_wide_tree_of(kind, 1);
    for (uint32_t i = 0; i < chunk->count; i++) {
        eng_wide_key a = eng_wide_key_of(wide, tree_a, chunk->a[i]);
        eng_wide_key b = eng_wide_key_of(wide, tree_b, chunk->b[i]);
        bool is_turned = tree_a == tree_b && a > b;
        sweeper->a[i] = is_turned ? b : a;
        sweeper->b[i] = is_turned ? a : b;
    }
    sweeper->visit(sweeper->context, kind, sweeper->a, sweeper->b, chunk->count);
}

static void on_chunk(void *owner, enum pccd_kind kind, struct eng_wide_chunk *chunk)
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
        uint32_t capacity = eng_array_grown(tasks->capacity, tasks->count + 1024);
        int status = eng_array_grow(&tasks->list, capacity, sizeof *tasks->list);
        if (status != PCCD_OK) {
            return status;
        }
        tasks->capacity = capacity;
    }
    tasks->list[tasks->count++] = task;
    return PCCD_OK;
}

/* The roots, refined down to pairs of nodes of 256 features. */
static int divide(struct tasks *tasks, struct eng_wide_join *join, uint32_t top)
{
    int status = PCCD_OK;
    for (enum pccd_kind kind = 0; kind < PCCD_KIND_COUNT && status == PCCD_OK; kind++) {
        if (!(join->kinds >> kind & 1)) {
            continue;
        }
        status = add(tasks, (struct task){kind, top, 0, 0});
    }
    for (uint32_t i = 0; i < tasks->count && status == PCCD_OK;) {
        struct task task = tasks->list[i];
        if (task.level < 2) {
            i++;
            continue;
        }
        struct eng_wide_list *below = &join->lists[task.level - 1];
        tasks->list[i] = tasks->list[--tasks->count];
        eng_wide_join_refine(join, task.kind, task.level, task.n, task.m);
        for (uint32_t k = 0; k < below->count && status == PCCD_OK; k++) {
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
    eng_wide_still_begin(wide, scene, false, false);
    wide->is_swept = true;
    struct eng_parallel region = eng_parallel_open();
#pragma omp parallel num_threads((int)threads) if (threads > 1)
    {
        ENG_PARALLEL_JOIN(region);
        for (enum pccd_tree kind = 0; kind < ENG_WIDE_TREES; kind++) {
            uint32_t count = eng_wide_refit_chunks(wide, kind);
#pragma omp for schedule(dynamic, 4)
            for (uint32_t i = 0; i < count; i++) {
                eng_wide_refit_chunk(wide, scene, kind, i);
            }
        }
    }
    eng_parallel_close();
    eng_wide_refit_above(wide);
    wide->is_swept = false;
}

static int pairs(struct sweeper *sweepers, uint32_t threads, uint32_t top,
                 struct tasks *tasks)
{
    if (threads == 1) {
        for (enum pccd_kind kind = 0; kind < PCCD_KIND_COUNT; kind++) {
            if (!(sweepers[0].join.kinds >> kind & 1)) {
                continue;
            }
            eng_wide_join_nodes(&sweepers[0].join, kind, top, 0, 0);
        }
        eng_wide_join_flush(&sweepers[0].join);
        return PCCD_OK;
    }
    int status = divide(tasks, &sweepers[0].join, top);
    if (status == PCCD_OK) {
        struct eng_parallel region = eng_parallel_open();
#pragma omp parallel num_threads((int)threads)
        {
            ENG_PARALLEL_JOIN(region);
            perform(&sweepers[omp_get_thread_num()], tasks);
        }
        eng_parallel_close();
    }
    return status;
}

int eng_wide_sweep(struct eng_scene *scene, uint32_t threads, eng_wide_visit visit,
                   void *context, struct eng_wide_sweep *sweep)
{
    assert(threads >= 1 && sweep);
    struct eng_wide *wide = eng_wide_of(scene);
    struct tasks tasks = {0};
    struct sweeper *sweepers = eng_alloc(threads, sizeof *sweepers);
    int status = sweepers ? PCCD_OK : PCCD_E_NOMEM;
    eng_box_frames_choose(scene, 1 - scene->now, scene->now);
    if (status == PCCD_OK && wide->is_stale) {
        status = eng_wide_assemble(wide, scene);
    }
    status = status == PCCD_OK ? eng_wide_reserve_floats(wide) : status;
    uint64_t begin_ns = common_now_ns();
    if (status == PCCD_OK) {
        refit(wide, scene, threads);
        uint64_t refit_ns = common_now_ns();
        for (uint32_t i = 0; i < threads; i++) {
            sweeper_init(&sweepers[i], wide, visit, context);
        }
        uint64_t pairs_ns = common_now_ns();
        status = pairs(sweepers, threads, wide->level_count - 1, &tasks);
        *sweep = (struct eng_wide_sweep){.refit_ns = refit_ns - begin_ns,
                                         .pairs_ns = common_now_ns() - pairs_ns};
    }
    for (uint32_t i = 0; i < threads && status == PCCD_OK; i++) {
        for (enum pccd_kind kind = 0; kind < PCCD_KIND_COUNT; kind++) {
            sweep->counts[kind] += sweepers[i].count[kind];
        }
        sweep->box_tests += eng_wide_join_test_count(&sweepers[i].join);
    }
    eng_free(tasks.list);
    eng_free(sweepers);
    return status;
}
