/* record.c - every task that a step has, for each scheduler and thread count. */
#include "record.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "clock.h"
#include "highlevel.h"
#include "method.h"
#include "paper.h"
#include "paper_work.h"
#include "refit.h"
#include "report.h"
#include "schedule_paper.h"
#include "schedule_steal.h"
#include "taskunit.h"
#include "walker.h"

/* ---- task units, as by eng_taskunit_perform_all ---------------------------------- */

static void walk_units(struct model_record *record, struct model_walker *walker,
                       struct model_tasks *tasks)
{
    static struct model_recorder recorder;
    const struct eng_node *nodes = eng_trees_of(record->scene)->nodes;
    struct eng_worker *worker = model_walker_begin(walker);
    struct eng_unit_queue *units = &eng_paper_work_of(worker)->units;
    tasks->count = 0;
    eng_units_push(units, eng_trees_of(record->scene)->root);
    model_record_begin(&recorder, worker, tasks, record->clock_ns);
    while (eng_units_count(units) > 0) {
        uint32_t node = eng_units_take_newest(units);
        if (nodes[node].left == ENG_LEAF) {
            continue;
        }
        eng_taskunit_perform(worker, node, true);
        uint32_t task = model_tasks_add(tasks, 1);
        record->unit_of[node] = task;
        model_record_close(&recorder, task);
    }
    model_record_end(&recorder);
}

/* ---- tasks of work stealing, as by eng_schedule_steal ---------------------------- */

struct steal_task {
    uint32_t n, m;
    uint32_t task;
};

struct steal_stack {
    struct steal_task *items;
    uint32_t count;
    uint32_t capacity;
};

/* The children of `task`, pushed in order. */
static void push_children(struct steal_stack *stack, struct model_tasks *tasks,
                          uint32_t task, uint32_t count, const uint32_t *n,
                          const uint32_t *m)
{
    uint32_t first = model_tasks_add(tasks, count);
    tasks->items[task].first_child = first;
    tasks->items[task].child_count = count;
    if (stack->count + count > stack->capacity) {
        uint32_t capacity = 2 * stack->capacity + 256;
        struct steal_task *items = bench_alloc(capacity, sizeof *items);
        if (stack->count > 0) {
            memcpy(items, stack->items, stack->count * sizeof *items);
        }
        free(stack->items);
        stack->items = items;
        stack->capacity = capacity;
    }
    for (uint32_t i = 0; i < count; i++) {
        stack->items[stack->count++] = (struct steal_task){n[i], m[i], first + i};
    }
}

static void subtree(struct eng_worker *worker, uint32_t node)
{
    struct eng_unit_queue *units = &eng_paper_work_of(worker)->units;
    eng_taskunit_perform(worker, node, true);
    while (eng_units_count(units) > 0) {
        eng_taskunit_perform(worker, eng_units_take_newest(units), true);
    }
}

static void walk_steal(const struct model_record *record, struct model_walker *walker,
                       struct model_tasks *tasks, struct steal_stack *stack)
{
    static struct model_recorder recorder;
    const struct eng_node *nodes = eng_trees_of(record->scene)->nodes;
    struct eng_worker *worker = model_walker_begin(walker);
    tasks->count = 0;
    stack->count = 0;
    uint32_t task = model_tasks_add(tasks, 1);
    uint32_t n = eng_trees_of(record->scene)->root;
    uint32_t m = n;
    model_record_begin(&recorder, worker, tasks, record->clock_ns);
    for (;;) {
        uint32_t ns[4];
        uint32_t ms[4];
        uint32_t count = 0;
        if (n == m && nodes[n].count <= record->unit_grain) {
            subtree(worker, n);
        } else if (n == m) {
            const uint32_t left = nodes[n].left;
            const uint32_t right = nodes[n].right;
            memcpy(ns, (uint32_t[3]){left, right, left}, 3 * sizeof *ns);
            memcpy(ms, (uint32_t[3]){left, right, right}, 3 * sizeof *ms);
            count = 3;
        } else if ((uint64_t)nodes[n].count + nodes[m].count <= record->pair_grain) {
            eng_taskunit_pairs(worker, n, m);
        } else {
            count = eng_taskunit_refine(worker, n, m, ns, ms);
        }
        model_record_close(&recorder, task);
        if (count > 0) {
            push_children(stack, tasks, task, count, ns, ms);
        }
        if (stack->count == 0) {
            break;
        }
        struct steal_task *next = &stack->items[--stack->count];
        n = next->n;
        m = next->m;
        task = next->task;
    }
    model_record_end(&recorder);
}

/* ---- high-level nodes, as by eng_schedule_paper ---------------------------------- */

static void walk_round_robin(struct model_division *division,
                             const struct model_record *record, struct eng_team *team,
                             struct model_tasks *tasks)
{
    static struct model_recorder recorder;
    struct eng_assignment *assignment = &eng_paper_of(team->scene)->assignment;
    struct eng_worker *worker = model_walker_begin(division->walker);
    tasks->count = 0;
    model_record_begin(&recorder, worker, tasks, record->clock_ns);
    for (uint32_t i = 0; i < division->high_count; i++) {
        struct model_high *high = &division->high[i];
        eng_highlevel_expand(team, worker, high->node);
        high->pair_count = assignment->pair_count;
        high->expansion = model_tasks_add(tasks, 1 + high->pair_count);
        model_record_close(&recorder, high->expansion);
        for (uint32_t k = 0; k < high->pair_count; k++) {
            eng_taskunit_pairs(worker, (uint32_t)(assignment->pairs[k] >> 32),
                               (uint32_t)assignment->pairs[k]);
            model_record_close(&recorder, high->expansion + 1 + k);
        }
    }
    model_record_end(&recorder);
}

static void walk_disjoint(struct model_division *division,
                          const struct model_record *record, struct model_tasks *tasks)
{
    static struct model_recorder recorder;
    struct eng_worker *worker = model_walker_begin(division->walker);
    uint32_t width = 1u << division->levels;
    tasks->count = 0;
    model_record_begin(&recorder, worker, tasks, record->clock_ns);
    for (uint32_t i = 0; i < division->high_count; i++) {
        struct model_high *high = &division->high[i];
        high->phases = model_tasks_add(tasks, width * width);
        for (uint32_t k = 0; k < width * width; k++) {
            worker->thread = k % width;
            eng_highlevel_phase(worker, high->node, k / width, division->levels);
            model_record_close(&recorder, high->phases + k);
        }
    }
    worker->thread = 0;
    model_record_end(&recorder);
}

static void record_high(struct model_division *division,
                        const struct model_record *record)
{
    struct eng_assignment *assignment = &eng_paper_of(record->scene)->assignment;
    struct model_tasks *round_robin = model_tasks_passes(record->passes);
    struct model_tasks *disjoint = model_tasks_passes(record->passes);
    struct eng_worker *workers[MODEL_THREADS_MAX];
    struct eng_team team = {.scene = record->scene,
                            .workers = workers,
                            .count = division->threads,
                            .method = &eng_method_paper};
    model_must(eng_assignment_reserve(assignment, division->threads) == PCCD_OK, "seats");
    struct eng_worker *worker = model_walker_begin(division->walker);
    for (uint32_t i = 0; i < division->threads; i++) {
        workers[i] = worker; /* what is dealt out comes to one queue, in order */
    }
    uint64_t begin_ns = common_now_ns();
    eng_schedule_paper_begin(&team, worker);
    division->begin_ns = (double)(common_now_ns() - begin_ns);
    for (uint32_t i = 0; i < division->threads; i++) {
        struct eng_unit_queue *units = &eng_paper_work_of(worker)->units;
        division->first_node[i] =
            eng_units_count(units) > 0 ? eng_units_take_front(units) : ENG_NO_NODE;
    }
    division->high_count = assignment->high_count;
    division->levels = eng_highlevel_levels(division->threads);
    for (uint32_t i = 0; i < division->high_count; i++) { /* the deepest first */
        division->high[i].node = assignment->high[division->high_count - 1 - i];
    }
    for (uint32_t pass = 0; pass < record->passes; pass++) {
        walk_round_robin(division, record, &team, &round_robin[pass]);
        walk_disjoint(division, record, &disjoint[pass]);
    }
    bool same = model_tasks_take_medians(&division->tasks, round_robin, record->passes);
    division->consistent =
        model_tasks_take_medians(&division->disjoint, disjoint, record->passes) && same;
}

void model_division_init(struct model_division *division,
                         const struct model_record *record, uint32_t threads)
{
    struct model_walker walker;
    memset(division, 0, sizeof *division);
    division->threads = threads;
    if (record->method == PCCD_METHOD_WIDE) {
        division->owner = model_wide_owners(record, threads);
        division->consistent = true;
        model_merge_init(&division->merge, record, threads);
        return;
    }
    model_walker_init(&walker, record->scene, record->near);
    division->walker = &walker;
    record_high(division, record);
    division->walker = NULL;
    model_walker_deinit(&walker);
    model_refit_init(&division->refit[ENG_REFIT_EVEN], record, ENG_REFIT_EVEN, threads);
    model_merge_init(&division->merge, record, threads);
    model_refit_init(&division->refit[ENG_REFIT_PAPER], record, ENG_REFIT_PAPER, threads);
}

void model_division_deinit(struct model_division *division)
{
    model_tasks_deinit(&division->tasks);
    model_tasks_deinit(&division->disjoint);
    free(division->owner);
    model_refit_deinit(&division->refit[ENG_REFIT_EVEN]);
    model_refit_deinit(&division->refit[ENG_REFIT_PAPER]);
    memset(division, 0, sizeof *division);
}

void model_record_init(struct model_record *record)
{
    struct eng_scene *scene = record->scene;
    const uint32_t passes = record->passes;
    struct model_walker *walker = &record->walker;
    struct steal_stack stack = {NULL, 0, 0};
    if (record->method == PCCD_METHOD_WIDE) {
        model_wide_init(record);
        return;
    }
    struct model_tasks *units = model_tasks_passes(passes);
    struct model_tasks *steal = model_tasks_passes(passes);
    record->unit_of =
        bench_alloc(eng_trees_of(scene)->node_capacity, sizeof *record->unit_of);
    memset(record->unit_of, 0xff,
           eng_trees_of(scene)->node_capacity * sizeof *record->unit_of);
    model_walker_init(walker, scene, record->near);
    walk_units(record, walker, &units[0]); /* caches and pool */
    for (uint32_t pass = 0; pass < passes; pass++) {
        walk_units(record, walker, &units[pass]);
        walk_steal(record, walker, &steal[pass], &stack);
    }
    bool same = model_tasks_take_medians(&record->units, units, passes);
    record->consistent = model_tasks_take_medians(&record->steal, steal, passes) && same;
    free(stack.items);
    struct model_tasks again = {NULL, 0, 0};
    walk_units(record, walker, &again);
    model_tasks_deinit(&again);
    model_merge_keep(record, &walker->worker->found);
    model_refit_features(record);
}

void model_record_deinit(struct model_record *record)
{
    model_tasks_deinit(&record->units);
    model_tasks_deinit(&record->steal);
    model_wide_deinit(&record->wide);
    free(record->unit_of);
    free(record->blocks);
    model_walker_deinit(&record->walker);
    memset(record, 0, sizeof *record);
}
