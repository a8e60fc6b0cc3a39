/* paper_method.c - the method paper, as a step sees it.
 *
 * Any pair may go to any thread because gates guard what reconstruction changes
 * (rebuild.h). A worker splits depth first, so its deque holds at most three siblings for
 * each level of a pair and two for each level of a node; with ENG_LEVELS_MAX levels of
 * either that is less than half of its capacity.
 */
#include <assert.h>

#include "box_frames.h"
#include "method.h"
#include "paper.h"
#include "paper_work.h"
#include "rebuild.h"
#include "trees.h"

/* Triangles below which a task is not split, of a node, of both nodes of a
 * pair. Triangles say little about the work where things touch: with 512 and 1024 the
 * largest task of recorded steps took up to 24 ms with its tests, more than a 64th of the
 * step; with these it takes 1.7 to 3.2 ms, and half of them gains nothing
 * (bench/model). A task costs about 0.1 us to push and pop. */
#define UNIT_GRAIN 128u
#define PAIR_GRAIN 128u

static uint64_t task_of(uint32_t n, uint32_t m)
{
    return (uint64_t)n << 32 | m;
}

static void push(struct eng_worker *worker, uint32_t n, uint32_t m)
{
    bool pushed = eng_deque_push(&worker->deque, task_of(n, m));
    assert(pushed);
    (void)pushed;
}

/* All task units of a small subtree. */
static void perform_subtree(struct eng_worker *worker, uint32_t node)
{
    struct eng_unit_queue *units = &eng_paper_work_of(worker)->units;
    uint64_t begin_ns = eng_worker_slice(worker);
    eng_taskunit_perform(worker, node, true);
    while (eng_units_count(units) > 0 && !eng_stop_is_set(worker->stop)) {
        eng_taskunit_perform(worker, eng_units_take_newest(units), true);
    }
    units->head = units->tail;
    eng_worker_trace(worker, PCCD_TRACE_SUBTREE, begin_ns, node,
                     eng_trees_of(worker->scene)->nodes[node].count);
}

static void perform_unit(struct eng_worker *worker, uint32_t n)
{
    if (!eng_taskunit_is_wanted(worker, n)) {
        return;
    }
    if (eng_trees_of(worker->scene)->nodes[n].count <= UNIT_GRAIN) {
        perform_subtree(worker, n);
        return;
    }
    uint64_t begin_ns = eng_worker_slice(worker);
    const struct eng_node *node = eng_node_open(worker, n);
    worker->record.task_units++;
    push(worker, node->left, node->left);
    push(worker, node->right, node->right);
    push(worker, node->left, node->right);
    eng_worker_trace(worker, PCCD_TRACE_UNIT, begin_ns, n, node->count);
}

static void perform_pair(struct eng_worker *worker, uint32_t n, uint32_t m)
{
    const struct eng_node *nodes = eng_trees_of(worker->scene)->nodes;
    uint64_t begin_ns = eng_worker_slice(worker);
    if ((uint64_t)nodes[n].count + nodes[m].count <= PAIR_GRAIN) {
        eng_taskunit_pairs(worker, n, m);
    } else {
        uint32_t n_out[4];
        uint32_t m_out[4];
        uint32_t count = eng_taskunit_refine(worker, n, m, n_out, m_out);
        for (uint32_t i = 0; i < count; i++) {
            push(worker, n_out[i], m_out[i]);
        }
    }
    eng_worker_trace(worker, PCCD_TRACE_PAIRS, begin_ns, n, m);
}

static void perform(struct eng_worker *worker, uint64_t task)
{
    uint32_t n = (uint32_t)(task >> 32);
    uint32_t m = (uint32_t)task;
    if (n == m) {
        perform_unit(worker, n);
    } else {
        perform_pair(worker, n, m);
    }
}

/* ---- the step ---------------------------------------------------------------------- */

static void deal(struct eng_team *team, struct eng_worker *worker)
{
    assert(eng_trees_of(worker->scene)->root != ENG_NO_NODE);
    (void)team;
    push(worker, eng_trees_of(worker->scene)->root, eng_trees_of(worker->scene)->root);
}

static bool is_stale(const struct eng_scene *scene)
{
    return eng_trees_of(scene)->top_is_stale;
}

static int prepare(struct eng_team *team, const struct eng_question *question)
{
    struct eng_scene *scene = team->scene;
    struct eng_refit_plan *plan = &eng_paper_of(scene)->plan;
    int status = PCCD_OK;
    if (eng_trees_of(scene)->top_is_stale) {
        eng_box_frames_choose(scene, scene->now, scene->now);
        status = eng_paper_add_objects(scene);
        if (status == PCCD_OK) {
            status = eng_refit_plan_features(plan, scene);
        }
        if (status == PCCD_OK) {
            status = eng_build_top(scene);
        }
        if (status == PCCD_OK) { /* below them boxes are there */
            eng_refit_nodes(scene, eng_trees_of(scene)->top);
        }
    }
    if (status == PCCD_OK) {
        status = eng_refit_plan_tree(plan, scene, question->tuning.refit, team->count);
    }
    if (status == PCCD_OK && question->tuning.scheduler == ENG_SCHEDULER_PAPER) {
        status = eng_assignment_reserve(&eng_paper_of(scene)->assignment, team->count);
    }
    for (uint32_t i = 0; i < team->count && status == PCCD_OK; i++) {
        status = eng_paper_work_reserve(team->workers[i], scene);
    }
    return status;
}

static void start(struct eng_team *team, const struct eng_question *question)
{
    struct eng_paper *paper = eng_paper_of(team->scene);
    (void)question;
    if (!team->has_boxes) {
        eng_background_swap(&paper->background, team->scene);
        paper->trees.frames = team->scene->framing.number;
        paper->trees.thickness = team->scene->thickness.number;
        paper->trees.boxes_of = team->scene->moving.number;
    }
    for (uint32_t i = 0; i < team->count; i++) {
        eng_paper_work_begin(team->workers[i]);
    }
}

static void ready(struct eng_worker *worker)
{
    struct eng_trees *trees = eng_trees_of(worker->scene);
    trees->boxes_are_old = eng_worker_is_late(worker, 0);
    if (trees->boxes_are_old || eng_asks_near(worker->question)) {
        return;
    }
    eng_rebuild_top(worker);
    eng_background_examine(&eng_paper_of(worker->scene)->background, worker);
}

static void beside(struct eng_worker *worker)
{
    if (!eng_trees_of(worker->scene)->boxes_are_old) {
        eng_background_share(&eng_paper_of(worker->scene)->background, worker);
    }
}

static void end(struct eng_team *team, struct eng_step_result *result, uint64_t step_ns)
{
    struct eng_background *background = &eng_paper_of(team->scene)->background;
    eng_background_end_step(background, step_ns, team->count);
    result->counters.swaps = background->swaps;
    result->counters.swapped_triangles = background->swapped_triangles;
}

static void no_more(struct eng_worker *worker)
{
    (void)worker;
}

static void refit(struct eng_worker *worker)
{
    eng_refit(worker->scene, worker);
}

static bool refit_by_team(struct eng_team *team, struct eng_worker *worker)
{
    return eng_refit_by_team(team, worker, &eng_paper_of(team->scene)->plan);
}

const struct eng_method_calls eng_method_paper = {.is_stale = is_stale,
                                                  .prepare = prepare,
                                                  .has_boxes = eng_tree_has_boxes,
                                                  .validate = eng_tree_validate,
                                                  .start = start,
                                                  .refit = refit,
                                                  .refit_by_team = refit_by_team,
                                                  .ready = ready,
                                                  .beside = beside,
                                                  .enter = no_more,
                                                  .leave = no_more,
                                                  .end = end,
                                                  .perform_all = eng_taskunit_perform_all,
                                                  .deal = deal,
                                                  .perform = perform,
                                                  .assign = eng_schedule_paper_begin,
                                                  .perform_assigned = eng_schedule_paper,
                                                  .work_free = eng_paper_work_free,
                                                  .work_bytes = eng_paper_work_bytes,
                                                  .flush = eng_taskunit_flush};
