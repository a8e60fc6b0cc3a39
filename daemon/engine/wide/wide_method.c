/* daemon/engine/wide/wide_method.c - the method wide, as a step sees it.
 *
 * Room:     engine.
 * Does:     keep the wide trees. A task, for stealing and as a unit of the dynamic
 *           assignment, is a pair of nodes of one level, of vertices and faces or of
 *           edges; a node with itself stands for all pairs of edges below it. Tasks are
 *           divided down to nodes of 256 features.
 * Threads:  method.h.
 *
 * Trees do not change while they are searched, so any task may go to any thread. A worker
 * divides depth first, and what finds no room in its deque is done at once.
 */
#include <assert.h>

#include "method.h"
#include "step_memory.h"
#include "wide_grid.h"
#include "wide_narrow.h"
#include "wide_team.h"
#include "wide_test.h"

/* kind: bit 63, level: from bit 58, n: from bit 29, m. Nodes are fewer than 2^28. */
static uint64_t task_of(enum eng_kind kind, uint32_t level, uint32_t n, uint32_t m)
{
    return (uint64_t)kind << 63 | (uint64_t)level << 58 | (uint64_t)n << 29 | m;
}

/* The level of nodes that are not divided any more: of two such nodes 65536 pairs of
 * features at most, some 30 us in the trees, as a rule far fewer. */
#define GRAIN_LEVEL 1u

static enum eng_kind kind_of(uint64_t task)
{
    return (enum eng_kind)(task >> 63);
}

static uint32_t level_of(uint64_t task)
{
    return task >> 58 & 31;
}

/* Do a task, or hand the pairs that it divides into to `push`, which says whether it had
 * room. */
static void perform_or_divide(struct eng_worker *worker, uint64_t task,
                              bool (*push)(struct eng_worker *worker, uint64_t task))
{
    const uint32_t node_mask = (1u << 29) - 1;
    enum eng_kind kind = kind_of(task);
    uint32_t level = level_of(task);
    uint32_t n = task >> 29 & node_mask;
    uint32_t m = task & node_mask;
    struct eng_wide_join *join = &worker->wide->join;
    uint64_t begin_ns = eng_worker_slice(worker);
    worker->record.task_units++;
    if (level <= GRAIN_LEVEL) {
        eng_wide_join_nodes(join, kind, level, n, m);
    } else {
        struct eng_wide_list *below = &join->lists[level - 1];
        eng_wide_join_refine(join, kind, level, n, m);
        for (uint32_t i = 0; i < below->count; i++) {
            uint32_t a = below->a[i];
            uint32_t b = below->b[i];
            if (!push(worker, task_of(kind, level - 1, a, b))) {
                eng_wide_join_nodes(join, kind, level - 1, a, b);
            }
        }
        below->count = 0;
    }
    eng_worker_trace(worker, ENG_TRACE_UNIT, begin_ns, n, m);
}

static_assert(ENG_KINDS * ENG_JOIN_MAX <= ENG_DEQUE_MAX / 2, "tasks");

static bool push_task(struct eng_worker *worker, uint64_t task)
{
    return eng_deque_push(&worker->deque, task);
}

static void perform(struct eng_worker *worker, uint64_t task)
{
    perform_or_divide(worker, task, push_task);
}

static uint32_t top_level(const struct eng_worker *worker)
{
    return worker->scene->wide.level_count - 1;
}

/* A step that was stopped during the refit left the rest of the boxes out: where they
 * belong lie those of other trees, or nothing that was ever written. */
static bool has_no_boxes(const struct eng_worker *worker)
{
    return eng_stop_is_set(worker->stop);
}

/* Pairs of the nodes below the root, each to the worker that made the boxes of the first
 * of the two, as a rule. At most ENG_JOIN_MAX of a kind: there is room in any deque. */
static void deal_kind(struct eng_team *team, struct eng_worker *worker,
                      enum eng_kind kind)
{
    const struct eng_wide *wide = &worker->scene->wide;
    const struct eng_wide_tree *tree =
        &wide->trees[kind == ENG_VF ? ENG_WIDE_VERTICES : ENG_WIDE_EDGES];
    struct eng_wide_join *join = &worker->wide->join;
    uint32_t level = top_level(worker) - 1;
    struct eng_wide_list *below = &join->lists[level];
    uint64_t begin_ns = eng_worker_slice(worker);
    eng_wide_join_refine(join, kind, level + 1, 0, 0);
    for (uint32_t i = 0; i < below->count; i++) {
        uint32_t a = below->a[i];
        uint32_t b = below->b[i];
        assert(a < tree->block_count[level]);
        uint32_t owner = eng_share_of(tree->block_count[level], a, team->count);
        eng_deque_push(&team->workers[owner]->deque, task_of(kind, level, a, b));
    }
    below->count = 0;
    worker->record.task_units++;
    eng_worker_trace(worker, ENG_TRACE_UNIT, begin_ns, 0, 0);
}

static void deal(struct eng_team *team, struct eng_worker *worker)
{
    uint32_t top = top_level(worker);
    if (has_no_boxes(worker)) {
        return;
    }
    if (top <= GRAIN_LEVEL) {
        eng_deque_push(&worker->deque, task_of(ENG_VF, top, 0, 0));
        eng_deque_push(&worker->deque, task_of(ENG_EE, top, 0, 0));
        return;
    }
    deal_kind(team, worker, ENG_VF);
    deal_kind(team, worker, ENG_EE);
}

/* ---- dynamic assignment ------------------------------------------------------------ */

static_assert(ENG_WIDE_LEVELS_MAX * ENG_JOIN_MAX <= ENG_UNITS_MAX / 2, "task units");

static bool push_unit(struct eng_worker *worker, uint64_t unit)
{
    eng_units_push(&worker->units, unit);
    return true;
}

/* Divide from the top, the oldest first, until there is a unit for each thread, and deal
 * them out. */
static void assign(struct eng_team *team, struct eng_worker *worker)
{
    struct eng_task_queue *units = &worker->units;
    uint32_t top = top_level(worker);
    if (has_no_boxes(worker)) {
        return;
    }
    push_unit(worker, task_of(ENG_EE, top, 0, 0));
    push_unit(worker, task_of(ENG_VF, top, 0, 0));
    while (eng_units_count(units) > 0 && eng_units_count(units) < team->count &&
           level_of(eng_units_look(units, 0)) > GRAIN_LEVEL) {
        perform_or_divide(worker, eng_units_take_front(units), push_unit);
    }
    uint32_t count = eng_units_count(units);
    for (uint32_t i = 0; i < count; i++) {
        uint64_t unit = eng_units_take_front(units);
        eng_units_push(&team->workers[i % team->count]->units, unit);
    }
}

static void perform_unit(struct eng_team *team, struct eng_worker *worker, uint64_t unit)
{
    (void)team;
    perform_or_divide(worker, unit, push_unit);
}

/* Features of a node: two nodes have twice as many, but a node with itself has more
 * pairs. */
static uint32_t unit_size(const struct eng_worker *worker, uint64_t unit)
{
    uint32_t bits = (level_of(unit) + 1) * ENG_WIDE_BITS;
    (void)worker;
    return bits < 31 ? 1u << bits : 1u << 31;
}

/* Nothing is left for all threads: any pair may go to any thread. */
static void no_high_level(struct eng_team *team, struct eng_worker *worker)
{
    (void)team;
    (void)worker;
}

/* ---- the step ---------------------------------------------------------------------- */

static void perform_all(struct eng_worker *worker)
{
    for (enum eng_kind kind = 0; kind < ENG_KINDS; kind++) {
        uint64_t begin_ns = eng_worker_slice(worker);
        eng_wide_join_nodes(&worker->wide->join, kind, top_level(worker), 0, 0);
        worker->record.task_units++;
        eng_worker_trace(worker, ENG_TRACE_UNIT, begin_ns, 0, 0);
    }
    eng_wide_join_flush(&worker->wide->join);
}

static void flush(struct eng_worker *worker)
{
    eng_wide_join_flush(&worker->wide->join);
}

static int prepare(struct eng_team *team, const struct eng_step_settings *settings)
{
    (void)settings;
    struct eng_scene *scene = team->scene;
    int status = ENG_OK;
    bool has_changed = false;
    eng_wide_resort_prepare(&scene->wide.resort, scene);
    if (scene->wide.is_stale) {
        eng_frames_choose(scene, scene->now, scene->now);
        status = eng_wide_assemble(&scene->wide, scene);
    }
    if (status == ENG_OK) {
        status = eng_wide_owners_prepare(&scene->wide, scene, &has_changed);
    }
    if (has_changed) {
        eng_wide_resort_unlearn(&scene->wide.resort);
    }
    for (uint32_t i = 0; i < team->count && status == ENG_OK; i++) {
        status = eng_wide_work_reserve(scene->memory->workers[i]);
    }
    return status;
}

static void start(struct eng_team *team, const struct eng_step_settings *settings)
{
    struct eng_wide *wide = &team->scene->wide;
    /* What is counted as a candidate in mode pairs is a pair of the boxes themselves. */
    eng_wide_narrow_choose(wide, team->scene, settings->mode != ENG_MODE_PAIRS);
    eng_wide_grid_choose(wide, team->scene);
    wide->frames = team->scene->framing.number;
    wide->frame_scale = team->scene->framing.scale;
    for (enum eng_wide_kind kind = 0; kind < ENG_WIDE_KINDS; kind++) {
        uint32_t chunks = eng_wide_refit_chunks(&team->scene->wide, kind);
        for (uint32_t i = 0; i < team->count; i++) {
            eng_share_init(&team->workers[i]->shares[kind], chunks, i, team->count);
        }
    }
    team->shares = team->count;
}

static void refit(struct eng_worker *worker)
{
    struct eng_wide *wide = &worker->scene->wide;
    for (enum eng_wide_kind kind = 0; kind < ENG_WIDE_KINDS; kind++) {
        uint32_t count = eng_wide_refit_chunks(wide, kind);
        for (uint32_t i = 0; i < count && !eng_worker_should_stop(worker); i++) {
            eng_wide_refit_chunk(wide, worker->scene, kind, i, false);
        }
    }
    if (!eng_stop_is_set(worker->stop)) {
        eng_wide_refit_above(wide, false);
    }
}

static void ready(struct eng_worker *worker)
{
    (void)worker;
}

static void beside(struct eng_worker *worker)
{
    struct eng_wide_resort *resort = &worker->scene->wide.resort;
    if (resort->state != ENG_WIDE_SORTING) {
        return;
    }
    uint64_t begin_ns = eng_now_ns();
    uint32_t object = resort->object;
    eng_wide_resort_share(resort, worker->scene, worker->stop);
    uint64_t share_ns = eng_now_ns() - begin_ns;
    worker->record.low_ns += share_ns;
    worker->record.rebuild_ns += share_ns;
    eng_worker_trace(worker, ENG_TRACE_ASIDE, begin_ns, object,
                     (uint32_t)resort->item_count);
}

/* Of sixteen pairs of nodes that are looked at in time one has to go, or the next steps
 * do without: a look takes a tenth of what becomes of a pair as a rule. By whole steps,
 * so that what is counted does not depend on threads. */
#define NODES_PAY_FROM      16u
#define STEPS_WITHOUT_TIMES 31u

static void learn_times(const struct eng_team *team)
{
    for (enum eng_kind kind = 0; kind < ENG_KINDS; kind++) {
        uint32_t *without = &team->scene->wide.steps_without_times[kind];
        uint64_t apart = 0;
        uint64_t below = 0;
        for (uint32_t i = 0; i < team->count; i++) {
            const struct eng_wide_join *join = &team->workers[i]->wide->join;
            apart += eng_wide_join_nodes_apart(join, kind);
            below += join->below[kind];
        }
        if (*without > 0) {
            --*without;
        } else if (apart < (apart + below) / NODES_PAY_FROM) {
            *without = STEPS_WITHOUT_TIMES;
        }
    }
}

static void end(struct eng_team *team, struct eng_step_result *result, uint64_t step_ns)
{
    struct eng_wide_resort *resort = &team->scene->wide.resort;
    result->counters.swaps = resort->sorts;
    result->counters.swapped_triangles = resort->sorted_triangles;
    if (result->incomplete == ENG_COMPLETE && result->mode != ENG_MODE_ANY) {
        eng_wide_resort_learn(resort, result->mode, result->counters.box_tests, step_ns);
    }
    if (result->incomplete == ENG_COMPLETE && result->mode == ENG_MODE_ALL) {
        learn_times(team);
    }
}

const struct eng_method_calls eng_method_wide = {.prepare = prepare,
                                                 .start = start,
                                                 .refit = refit,
                                                 .refit_by_team = eng_wide_refit_by_team,
                                                 .ready = ready,
                                                 .beside = beside,
                                                 .enter = eng_wide_work_begin,
                                                 .leave = eng_wide_work_end,
                                                 .end = end,
                                                 .perform_all = perform_all,
                                                 .deal = deal,
                                                 .perform = perform,
                                                 .assign = assign,
                                                 .perform_unit = perform_unit,
                                                 .unit_size = unit_size,
                                                 .finish_units = no_high_level,
                                                 .flush = flush};
