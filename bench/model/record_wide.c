/* record_wide.c - what the method wide costs, part by part. */
#include <stdlib.h>
#include <string.h>

#include "clock.h"
#include "memory.h"
#include "method.h"
#include "record.h"
#include "report.h"
#include "wide_method.h"

struct waiting_task {
    uint64_t name;
    uint32_t task;
};

struct stack {
    struct waiting_task *items;
    uint32_t count;
    uint32_t capacity;
};

/* What the worker's deque holds, the oldest first; it is empty then. */
static uint32_t take_all(struct eng_worker *worker, uint64_t names[ENG_DEQUE_MAX])
{
    uint64_t task;
    uint32_t count = 0;
    while (eng_deque_steal(&worker->deque, &task)) {
        names[count++] = task;
    }
    return count;
}

static void push(struct stack *stack, const uint64_t *names, uint32_t count,
                 uint32_t first)
{
    if (stack->count + count > stack->capacity) {
        uint32_t capacity = 2 * stack->capacity + ENG_DEQUE_MAX;
        struct waiting_task *items = bench_alloc(capacity, sizeof *items);
        if (stack->count > 0) {
            memcpy(items, stack->items, stack->count * sizeof *items);
        }
        free(stack->items);
        stack->items = items;
        stack->capacity = capacity;
    }
    for (uint32_t i = 0; i < count; i++) {
        stack->items[stack->count++] = (struct waiting_task){names[i], first + i};
    }
}

/* A worker at the begin of the traversal. */
static struct eng_worker *enter(struct model_walker *walker)
{
    struct eng_worker *worker = model_walker_begin(walker);
    model_must(eng_wide_work_reserve(worker) == PCCD_OK, "a join");
    eng_method_wide.enter(worker);
    return worker;
}

static void deal(struct model_record *record, struct eng_worker *worker)
{
    static uint64_t names[ENG_DEQUE_MAX];
    struct eng_team team = {.scene = record->scene,
                            .workers = &worker,
                            .count = 1,
                            .method = &eng_method_wide};
    uint64_t begin_ns = common_now_ns();
    eng_method_wide.deal(&team, worker);
    record->wide.deal_ns = (double)(common_now_ns() - begin_ns);
    record->wide.dealt_count = take_all(worker, names);
    memcpy(record->wide.dealt, names, record->wide.dealt_count * sizeof *names);
}

static void walk(struct model_record *record, struct model_tasks *tasks,
                 struct stack *stack)
{
    static struct model_recorder recorder;
    static uint64_t names[ENG_DEQUE_MAX];
    struct eng_worker *worker = enter(&record->walker);
    deal(record, worker);
    tasks->count = 0;
    model_tasks_add(tasks, record->wide.dealt_count);
    push(stack, record->wide.dealt, record->wide.dealt_count, 0);
    model_record_begin_wide(&recorder, worker, tasks, record->clock_ns);
    while (stack->count > 0) {
        struct waiting_task now = stack->items[--stack->count];
        eng_method_wide.perform(worker, now.name);
        model_record_close(&recorder, now.task);
        uint32_t count = take_all(worker, names);
        if (count > 0) {
            uint32_t first = model_tasks_add(tasks, count);
            tasks->items[now.task].first_child = first;
            tasks->items[now.task].child_count = count;
            push(stack, names, count, first);
            recorder.begin_ns = common_now_ns();
        }
    }
    model_record_end(&recorder);
    eng_method_wide.leave(worker);
}

/* The median of each chunk over the passes. */
static void time_chunks(struct model_record *record, enum pccd_tree kind,
                        struct bench_samples *samples)
{
    struct eng_wide *wide = eng_wide_of(record->scene);
    for (uint32_t i = 0; i < record->wide.chunk_count[kind]; i++) {
        uint64_t begin_ns = common_now_ns();
        eng_wide_refit_chunk(wide, record->scene, kind, i, false);
        double ns = (double)(common_now_ns() - begin_ns) - record->clock_ns;
        bench_add(&samples[i], ns > 0 ? ns : 0);
    }
}

static void record_refit(struct model_record *record)
{
    struct eng_wide *scene_wide = eng_wide_of(record->scene);
    struct model_wide *wide = &record->wide;
    struct bench_samples *samples[ENG_WIDE_TREES];
    struct bench_samples above = {0};
    for (enum pccd_tree kind = 0; kind < ENG_WIDE_TREES; kind++) {
        uint32_t count = eng_wide_refit_chunks(scene_wide, kind);
        wide->chunk_count[kind] = count;
        wide->chunk_ns[kind] = bench_alloc(count, sizeof(double));
        samples[kind] = bench_alloc(count, sizeof **samples);
        memset(samples[kind], 0, count * sizeof **samples);
    }
    for (uint32_t pass = 0; pass < record->passes; pass++) {
        for (enum pccd_tree kind = 0; kind < ENG_WIDE_TREES; kind++) {
            time_chunks(record, kind, samples[kind]);
        }
        uint64_t begin_ns = common_now_ns();
        eng_wide_refit_above(scene_wide, false);
        bench_add(&above, (double)(common_now_ns() - begin_ns));
    }
    wide->above_ns = bench_summarise(&above).p50;
    bench_free(&above);
    for (enum pccd_tree kind = 0; kind < ENG_WIDE_TREES; kind++) {
        for (uint32_t i = 0; i < wide->chunk_count[kind]; i++) {
            wide->chunk_ns[kind][i] = bench_summarise(&samples[kind][i]).p50;
            bench_free(&samples[kind][i]);
        }
        free(samples[kind]);
    }
}

void model_wide_init(struct model_record *record)
{
    struct model_tasks *passes = model_tasks_passes(record->passes);
    struct stack stack = {NULL, 0, 0};
    struct model_tasks again = {NULL, 0, 0};
    record->wide.dealt = bench_alloc(ENG_DEQUE_MAX, sizeof *record->wide.dealt);
    model_walker_init(&record->walker, record->scene, record->near);
    walk(record, &again, &stack); /* caches and pool */
    for (uint32_t pass = 0; pass < record->passes; pass++) {
        walk(record, &passes[pass], &stack);
    }
    record->consistent =
        model_tasks_take_medians(&record->wide.tasks, passes, record->passes);
    uint64_t begin_ns = common_now_ns();
    eng_method_wide.enter(record->walker.worker);
    record->wide.enter_ns = (double)(common_now_ns() - begin_ns);
    record_refit(record);
    walk(record, &again, &stack);
    model_tasks_deinit(&again);
    free(stack.items);
    model_merge_keep(record, &record->walker.worker->found);
}

uint32_t *model_wide_owners(const struct model_record *record, uint32_t threads)
{
    static uint64_t names[ENG_DEQUE_MAX];
    struct eng_worker *workers[MODEL_THREADS_MAX];
    struct model_walker walker;
    uint32_t *owner = bench_alloc(record->wide.dealt_count, sizeof *owner);
    struct eng_team team = {.scene = record->scene,
                            .workers = workers,
                            .count = threads,
                            .method = &eng_method_wide};
    model_walker_init(&walker, record->scene, record->near);
    workers[0] = enter(&walker);
    for (uint32_t t = 1; t < threads; t++) {
        workers[t] = eng_alloc(1, sizeof *workers[t]);
        model_must(workers[t] != NULL, "a worker");
        eng_worker_init(workers[t]);
    }
    eng_method_wide.deal(&team, workers[0]);
    for (uint32_t t = 0; t < threads; t++) {
        uint32_t count = take_all(workers[t], names);
        uint32_t at = 0; /* both lists are in the order of dealing */
        for (uint32_t i = 0; i < count; i++) {
            while (record->wide.dealt[at] != names[i]) {
                at++;
            }
            owner[at++] = t;
        }
        if (t > 0) {
            eng_worker_deinit(workers[t]);
            eng_free(workers[t]);
        }
    }
    model_walker_deinit(&walker);
    return owner;
}

double model_wide_refit_ns(const struct model_wide *wide)
{
    double ns = wide->above_ns;
    for (int kind = 0; kind < ENG_WIDE_TREES; kind++) {
        for (uint32_t i = 0; i < wide->chunk_count[kind]; i++) {
            ns += wide->chunk_ns[kind][i];
        }
    }
    return ns;
}

void model_wide_calibrate(struct model_wide *wide, double refit_ns, double detection_ns)
{
    double scale = refit_ns / model_wide_refit_ns(wide);
    for (int kind = 0; kind < ENG_WIDE_TREES; kind++) {
        for (uint32_t i = 0; i < wide->chunk_count[kind]; i++) {
            wide->chunk_ns[kind][i] *= scale;
        }
    }
    wide->above_ns *= scale;
    scale = detection_ns / (model_tasks_ns(&wide->tasks) + wide->deal_ns);
    for (uint32_t i = 0; i < wide->tasks.count; i++) {
        wide->tasks.items[i].walk_ns *= scale;
        wide->tasks.items[i].tests_ns *= scale;
    }
    wide->deal_ns *= scale;
}

void model_wide_deinit(struct model_wide *wide)
{
    for (int kind = 0; kind < ENG_WIDE_TREES; kind++) {
        free(wide->chunk_ns[kind]);
    }
    free(wide->dealt);
    model_tasks_deinit(&wide->tasks);
    memset(wide, 0, sizeof *wide);
}
