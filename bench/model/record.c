/* record.c - every task of a step, timed. */
#include "model.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "clock.h"
#include "memory.h"
#include "narrow.h"
#include "paper.h"
#include "paper_work.h"
#include "refit.h"
#include "report.h"
#include "wide_state.h"
#include "wide_test.h"
#include "world.h"

static double since(uint64_t begin_ns, double clock_ns)
{
    double ns = (double)(common_now_ns() - begin_ns) - clock_ns;
    return ns > 0 ? ns : 0;
}

/* Keep the least times of a pass and of those before it, as other work on the machine
 * only adds to them. Return whether it has their tasks; if not, times mean nothing. */
static bool keep_least(struct model_tasks *least, struct model_tasks *pass)
{
    bool same = least->count == 0 || least->count == pass->count;
    for (uint32_t i = 0; i < least->count && same; i++) {
        same = pass->items[i].child_count == least->items[i].child_count;
        pass->items[i].ns = fmin(pass->items[i].ns, least->items[i].ns);
    }
    model_tasks_free(least);
    *least = *pass;
    *pass = (struct model_tasks){0};
    return same;
}

/* ---- one worker ------------------------------------------------------------------ */

/* Forget what was found; worker and scene are as at the start of a step. */
static struct eng_worker *begin(struct model_record *record)
{
    struct eng_worker *worker = record->worker;
    record->scene->step++;
    eng_pool_reset(&record->pool, 1);
    eng_stop_init(&record->stop, &record->settings);
    bench_need(eng_paper_work_reserve(worker, record->scene) == PCCD_OK, "queues");
    eng_worker_begin(worker, record->scene, &record->settings, &record->stop,
                     &record->pool);
    bench_need(eng_narrow_reserve(worker, record->scene, &record->settings) == PCCD_OK,
               "a narrow phase");
    eng_narrow_begin(worker);
    eng_paper_work_begin(worker);
    if (record->method == PCCD_METHOD_WIDE) {
        bench_need(eng_wide_work_reserve(worker) == PCCD_OK, "a join");
    }
    eng_methods[record->method]->enter(worker);
    worker->thread = 0;
    return worker;
}

/* Test what is left in the chunks. */
static void end(struct model_record *record)
{
    eng_methods[record->method]->leave(record->worker);
    eng_methods[record->method]->flush(record->worker);
}

/* ---- tasks that make tasks ------------------------------------------------------- */

/* Perform a task; what it makes, in the order of pushing. */
typedef uint32_t perform_fn(struct eng_worker *worker, uint64_t name, uint64_t *made);

static uint32_t take_all(struct eng_worker *worker, uint64_t *names)
{
    uint32_t count = 0;
    while (eng_deque_steal(&worker->deque, &names[count])) {
        count++;
    }
    return count;
}

static uint32_t perform_stolen(struct eng_worker *worker, uint64_t name, uint64_t *made)
{
    eng_methods[worker->question->method]->perform(worker, name);
    return take_all(worker, made);
}

static uint32_t perform_unit(struct eng_worker *worker, uint64_t name, uint64_t *made)
{
    struct eng_unit_queue *units = &eng_paper_work_of(worker)->units;
    const struct eng_node *nodes = eng_trees_of(worker->scene)->nodes;
    uint32_t count = 0;
    eng_taskunit_perform(worker, (uint32_t)name, true);
    while (eng_units_count(units) > 0) {
        uint32_t node = eng_units_take_newest(units);
        made[count] = node;
        count += nodes[node].left != ENG_LEAF;
    }
    return count;
}

/* The tasks that wait, the newest last. */
struct waiting {
    uint64_t name;
    uint32_t task;
};

/* Perform all tasks, the newest first, each timed; `unit_of` may be NULL. */
static void walk(struct model_record *record, perform_fn *perform,
                 struct model_tasks *tasks, uint32_t *unit_of)
{
    static uint64_t made[ENG_DEQUE_MAX];
    struct eng_worker *worker = record->worker;
    uint32_t capacity = 1u << 20;
    struct waiting *stack = bench_alloc(capacity, sizeof *stack);
    uint32_t waiting = 0;
    uint32_t count = record->root_count;
    uint32_t task = 0;
    uint32_t first = 0;
    memcpy(made, record->roots, count * sizeof *made);
    tasks->count = 0;
    for (;;) {
        first = model_tasks_add(tasks, count);
        bench_need(waiting + count <= capacity, "tasks that wait");
        for (uint32_t i = 0; i < count; i++) {
            stack[waiting++] = (struct waiting){made[i], first + i};
            if (unit_of) {
                unit_of[(uint32_t)made[i]] = first + i;
            }
        }
        if (waiting == 0) {
            break;
        }
        struct waiting now = stack[--waiting];
        task = now.task;
        uint64_t begin_ns = common_now_ns();
        count = perform(worker, now.name, made);
        tasks->items[task].ns = since(begin_ns, record->clock_ns);
        tasks->items[task].first_child = tasks->count;
        tasks->items[task].child_count = count;
    }
    uint64_t begin_ns = common_now_ns();
    end(record);
    tasks->items[task].ns += since(begin_ns, record->clock_ns);
    free(stack);
}

/* Name the first tasks. */
static void deal(struct model_record *record, struct eng_worker *worker)
{
    struct eng_team team = {.scene = record->scene,
                            .workers = &worker,
                            .count = 1,
                            .method = eng_methods[record->method]};
    uint64_t begin_ns = common_now_ns();
    team.method->deal(&team, worker);
    record->deal_ns = since(begin_ns, record->clock_ns);
    record->root_count = take_all(worker, record->roots);
}

static void record_tasks(struct model_record *record, perform_fn *perform,
                         struct model_tasks *tasks, uint32_t *unit_of)
{
    for (uint32_t i = 0; i < record->passes; i++) {
        struct model_tasks pass = {0};
        deal(record, begin(record));
        walk(record, perform, &pass, unit_of);
        record->is_consistent = keep_least(tasks, &pass) && record->is_consistent;
    }
}

void model_record_init(struct model_record *record)
{
    record->settings = (struct eng_question)ENG_QUESTION_DEFAULT;
    record->settings.contact_max = UINT32_MAX;
    record->settings.method = record->method;
    record->worker = eng_alloc(1, sizeof *record->worker);
    bench_need(record->worker != NULL, "a worker");
    eng_worker_init(record->worker);
    eng_pool_init(&record->pool);
    record->roots = bench_alloc(ENG_DEQUE_MAX, sizeof *record->roots);
    record->is_consistent = true;
    record_tasks(record, perform_stolen, &record->steal, NULL);
    if (record->method == PCCD_METHOD_PAPER) {
        uint32_t capacity = eng_trees_of(record->scene)->node_capacity;
        record->unit_of = bench_alloc(capacity, sizeof *record->unit_of);
        record_tasks(record, perform_unit, &record->units, record->unit_of);
    }
}

void model_record_free(struct model_record *record)
{
    model_tasks_free(&record->steal);
    model_tasks_free(&record->units);
    free(record->roots);
    free(record->unit_of);
    eng_narrow_free(record->worker);
    eng_paper_work_free(record->worker);
    eng_wide_work_free(record->worker);
    eng_worker_deinit(record->worker);
    eng_free(record->worker);
    eng_pool_deinit(&record->pool);
    memset(record, 0, sizeof *record);
}

/* ---- the refit ------------------------------------------------------------------- */

static void add(struct model_tasks *tasks, uint64_t begin_ns, double clock_ns)
{
    uint32_t task = model_tasks_add(tasks, 1);
    tasks->items[task].ns = since(begin_ns, clock_ns);
}

static void refit_wide(struct model_division *division, struct model_record *record)
{
    struct eng_wide *wide = eng_wide_of(record->scene);
    for (enum pccd_tree kind = 0; kind < ENG_WIDE_TREES; kind++) {
        uint32_t stage = kind != PCCD_TREE_VERTICES;
        for (uint32_t i = 0; i < eng_wide_refit_chunks(wide, kind); i++) {
            uint64_t begin_ns = common_now_ns();
            eng_wide_refit_chunk(wide, record->scene, kind, i);
            add(&division->refit[stage], begin_ns, record->clock_ns);
        }
    }
    uint64_t begin_ns = common_now_ns();
    eng_wide_refit_above(wide);
    add(&division->refit[2], begin_ns, record->clock_ns);
    division->refit[2].items[0].ns += record->deal_ns;
}

static void refit_paper(struct model_division *division, struct model_record *record)
{
    struct eng_scene *scene = record->scene;
    struct eng_refit_plan plan = {0};
    uint64_t begin_ns;
    bench_need(eng_refit_plan_features(&plan, scene) == PCCD_OK &&
                   eng_refit_plan_tree(&plan, scene, ENG_REFIT_EVEN, division->threads) ==
                       PCCD_OK,
               "a plan of the refit");
    for (uint32_t i = 0; i < plan.vertices.count; i++) {
        begin_ns = common_now_ns();
        eng_refit_vertices(scene, plan.vertices.ranges[i]);
        add(&division->refit[0], begin_ns, record->clock_ns);
    }
    for (uint32_t i = 0; i < plan.root_count; i++) {
        begin_ns = common_now_ns();
        eng_refit_subtree(scene, plan.roots[i]);
        add(&division->refit[1], begin_ns, record->clock_ns);
    }
    for (uint32_t i = 0; i < plan.edges.count; i++) {
        begin_ns = common_now_ns();
        eng_refit_edges(scene, plan.edges.ranges[i]);
        add(&division->refit[1], begin_ns, record->clock_ns);
    }
    begin_ns = common_now_ns();
    for (uint32_t i = plan.opened_count; i-- > 0;) {
        eng_refit_nodes(scene, (struct eng_range){plan.opened[i], 1});
    }
    add(&division->refit[2], begin_ns, record->clock_ns);
    eng_refit_plan_deinit(&plan);
}

/* ---- high-level nodes, as by eng_schedule_paper ---------------------------------- */

static void walk_high(struct model_division *division, struct model_record *record,
                      struct eng_team *team, struct model_tasks *tasks)
{
    struct eng_assignment *assignment = &eng_paper_of(team->scene)->assignment;
    struct eng_worker *worker = begin(record);
    for (uint32_t i = 0; i < division->high_count; i++) {
        struct model_high *high = &division->high[i];
        uint64_t begin_ns = common_now_ns();
        eng_highlevel_expand(team, worker, high->node);
        high->expansion = tasks->count;
        high->pair_count = assignment->pair_count;
        add(tasks, begin_ns, record->clock_ns);
        for (uint32_t k = 0; k < high->pair_count; k++) {
            begin_ns = common_now_ns();
            eng_taskunit_pairs(worker, (uint32_t)(assignment->pairs[k] >> 32),
                               (uint32_t)assignment->pairs[k]);
            add(tasks, begin_ns, record->clock_ns);
        }
    }
    end(record);
}

static void record_high(struct model_division *division, struct model_record *record)
{
    struct eng_assignment *assignment = &eng_paper_of(record->scene)->assignment;
    struct eng_worker *worker = begin(record);
    struct eng_worker *workers[MODEL_THREADS_MAX];
    struct eng_team team = {.scene = record->scene,
                            .workers = workers,
                            .count = division->threads,
                            .method = &eng_method_paper};
    bench_need(eng_assignment_reserve(assignment, division->threads) == PCCD_OK, "seats");
    for (uint32_t i = 0; i < division->threads; i++) {
        workers[i] = worker; /* what is dealt out comes to one queue, in order */
    }
    eng_schedule_paper_begin(&team, worker);
    struct eng_unit_queue *units = &eng_paper_work_of(worker)->units;
    while (eng_units_count(units) > 0) {
        uint32_t node = eng_units_take_front(units);
        if (eng_trees_of(record->scene)->nodes[node].left != ENG_LEAF) {
            division->low[division->low_count++] = record->unit_of[node];
        }
    }
    division->high_count = assignment->high_count;
    for (uint32_t i = 0; i < division->high_count; i++) { /* the deepest first */
        division->high[i].node = assignment->high[division->high_count - 1 - i];
    }
    for (uint32_t i = 0; i < record->passes; i++) {
        struct model_tasks pass = {0};
        walk_high(division, record, &team, &pass);
        division->is_consistent =
            keep_least(&division->tasks, &pass) && division->is_consistent;
    }
}

void model_division_init(struct model_division *division, struct model_record *record,
                         uint32_t threads)
{
    *division = (struct model_division){.threads = threads, .is_consistent = true};
    if (record->method == PCCD_METHOD_WIDE) {
        refit_wide(division, record);
    } else {
        record_high(division, record);
        refit_paper(division, record);
    }
}

void model_division_free(struct model_division *division)
{
    for (int stage = 0; stage < MODEL_STAGES; stage++) {
        model_tasks_free(&division->refit[stage]);
    }
    model_tasks_free(&division->tasks);
}
