/* paper_method.c - the method paper, as a step sees it.
 *
 * Any pair may go to any thread because gates guard what reconstruction changes
 * (rebuild.h). A worker splits depth first, so its deque holds at most three siblings for
 * each level of a pair and two for each level of a node; with ENG_LEVELS_MAX levels of
 * either that is less than half of its capacity.
 */
#include "paper_method.h"

#include <assert.h>

#include "build.h"
#include "frames.h"
#include "highlevel.h"
#include "moving.h"
#include "paper.h"
#include "paper_faces.h"
#include "paper_work.h"
#include "rebuild.h"
#include "refit.h"
#include "refit_box.h"
#include "refit_still.h"
#include "schedule_paper.h"
#include "taskunit.h"

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
    struct eng_task_queue *units = &worker->units;
    uint64_t begin_ns = eng_worker_slice(worker);
    eng_taskunit_perform(worker, node, true);
    while (eng_units_count(units) > 0 && !eng_stop_is_set(worker->stop)) {
        eng_taskunit_perform(worker, (uint32_t)eng_units_take_newest(units), true);
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
    if (eng_trees_of(worker->scene)->nodes[n].count <= ENG_STEAL_UNIT_GRAIN) {
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
    if ((uint64_t)nodes[n].count + nodes[m].count <= ENG_STEAL_PAIR_GRAIN) {
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

/* ---- dynamic assignment ------------------------------------------------------------ */

/* Write a node whose task unit is wanted to `place`; returns whether it is. */
static uint32_t add_wanted(struct eng_worker *worker, uint32_t node, uint32_t *place)
{
    bool is_wanted = eng_taskunit_is_wanted(worker, node);
    if (is_wanted) {
        *place = node;
    }
    return is_wanted;
}

/* Breadth-first until the queue `front` holds a node for each thread; the nodes opened on
 * the way are the high-level ones. Leaves wait in front of the queue. Returns the length
 * of the queue. */
static uint32_t choose_front(struct eng_team *team, struct eng_worker *worker,
                             uint32_t front[2 * ENG_THREADS_MAX])
{
    assert(eng_trees_of(worker->scene)->root != ENG_NO_NODE);
    struct eng_assignment *assignment = &eng_paper_of(team->scene)->assignment;
    uint32_t head = 0;
    uint32_t tail = 0;
    uint32_t leaves = 0;
    assignment->high_count = 0;
    tail += add_wanted(worker, eng_trees_of(worker->scene)->root, &front[tail]);
    while (head < tail && leaves + tail - head < team->count) {
        uint32_t idx = front[head++];
        const struct eng_node *node = eng_node_open(worker, idx);
        if (node->left == ENG_LEAF) {
            front[leaves++] = idx;
            continue;
        }
        assignment->high[assignment->high_count++] = idx;
        tail += add_wanted(worker, node->left, &front[tail]);
        tail += add_wanted(worker, node->right, &front[tail]);
    }
    while (head < tail) {
        front[leaves++] = front[head++];
    }
    return leaves;
}

/* Each opened node adds two and is one less. */
static void assign(struct eng_team *team, struct eng_worker *worker)
{
    uint32_t front[2 * ENG_THREADS_MAX];
    uint32_t count = choose_front(team, worker, front);
    for (uint32_t i = 0; i < count; i++) {
        eng_units_push(&team->workers[i]->units, front[i]);
    }
}

static void perform_assigned(struct eng_team *team, struct eng_worker *worker,
                             uint64_t unit)
{
    uint32_t node = (uint32_t)unit;
    eng_assignment_enter(&eng_paper_of(team->scene)->assignment, team->count,
                         worker->scene, worker->thread, node);
    eng_taskunit_perform(worker, node, true);
    eng_assignment_enter(&eng_paper_of(team->scene)->assignment, team->count,
                         worker->scene, worker->thread, ENG_NO_NODE);
}

static uint32_t unit_size(const struct eng_worker *worker, uint64_t unit)
{
    return eng_trees_of(worker->scene)->nodes[unit].count;
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

static int prepare(struct eng_team *team, const struct eng_step_settings *settings)
{
    struct eng_scene *scene = team->scene;
    struct eng_refit_plan *plan = &eng_paper_of(scene)->plan;
    int status = PCCD_OK;
    if (eng_trees_of(scene)->top_is_stale) {
        eng_frames_choose(scene, scene->now, scene->now);
        status = eng_plant_objects(scene);
        if (status == PCCD_OK) {
            status = eng_refit_plan_features(plan, scene);
        }
        if (status == PCCD_OK) {
            status = eng_build_top(scene);
        }
        if (status ==
            PCCD_OK) { /* below them boxes are there: at rest nobody makes more */
            eng_refit_nodes(scene, eng_trees_of(scene)->top);
        }
    }
    if (status == PCCD_OK) {
        status = eng_refit_plan_tree(plan, scene, settings->tuning.refit, team->count);
    }
    for (uint32_t i = 0; i < team->count && status == PCCD_OK; i++) {
        status = eng_paper_work_reserve(team->workers[i], scene);
    }
    return status;
}

/* Are the boxes of what stands those of the last step, so that only what moves needs new
 * ones? And is it worth it? */
static bool has_current_boxes(const struct eng_trees *trees,
                              const struct eng_scene *scene,
                              const struct eng_step_settings *settings)
{
    return settings->tuning.still == ENG_STILL_KEPT && trees->boxes_of != 0 &&
           trees->boxes_of + 1 >= scene->moving.number &&
           trees->frames == scene->framing.number &&
           trees->thickness == scene->thickness.number && eng_moves_little(scene);
}

static bool has_boxes(const struct eng_scene *scene)
{
    const struct eng_trees *trees = eng_trees_of(scene);
    return !trees->top_is_stale && trees->boxes_of != 0 &&
           trees->boxes_of == scene->moving.number &&
           trees->frames == scene->framing.number &&
           trees->thickness == scene->thickness.number;
}

static void begin_work(struct eng_team *team)
{
    for (uint32_t i = 0; i < team->count; i++) {
        eng_paper_work_begin(team->workers[i]);
    }
}

/* Nodes of objects that are others now. */
static void mark_foreign(struct eng_scene *scene)
{
    struct eng_trees *trees = eng_trees_of(scene);
    for (uint32_t i = 0; i < scene->object_capacity && trees->has_foreign; i++) {
        if (scene->objects[i].mesh) {
            eng_foreign_mark(trees, eng_planted_of(&scene->objects[i])->nodes);
        }
    }
}

static void start(struct eng_team *team, const struct eng_step_settings *settings)
{
    struct eng_paper *paper = eng_paper_of(team->scene);
    if (team->has_boxes) {
        begin_work(team);
        return;
    }
    bool keeps = has_current_boxes(&paper->trees, team->scene, settings);
    paper->trees.frames = team->scene->framing.number;
    paper->trees.thickness = team->scene->thickness.number;
    if (eng_background_swap(&paper->background, team->scene)) {
        /* The same division of a tree that has changed: no more memory is needed. */
        int status = eng_refit_plan_tree(&paper->plan, team->scene,
                                         settings->tuning.refit, team->count);
        assert(status == PCCD_OK);
        (void)status;
        keeps = false; /* what was swapped in has no boxes */
        mark_foreign(team->scene);
    }
    eng_still_begin(team->scene, keeps, team->prunes);
    begin_work(team);
}

static void ready(struct eng_worker *worker)
{
    if (worker->settings->near) {
        return;
    }
    eng_rebuild_top(worker);
    eng_background_examine(&eng_paper_of(worker->scene)->background, worker);
}

static void beside(struct eng_worker *worker)
{
    eng_background_share(&eng_paper_of(worker->scene)->background, worker);
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
    if (eng_trees_of(worker->scene)->marks) {
        worker->tally.still_features += eng_still_refit(worker->scene);
    } else {
        eng_refit(worker->scene);
    }
}

static bool refit_by_team(struct eng_team *team, struct eng_worker *worker)
{
    return eng_refit_by_team(team, worker, &eng_paper_of(team->scene)->plan);
}

const struct eng_method_calls eng_method_paper = {.can_prune = true,
                                                  .is_stale = is_stale,
                                                  .prepare = prepare,
                                                  .has_boxes = has_boxes,
                                                  .validate = eng_tree_validate,
                                                  .start = start,
                                                  .refit = refit,
                                                  .refit_by_team = refit_by_team,
                                                  .ready = ready,
                                                  .beside = beside,
                                                  .enter = no_more,
                                                  .leave = no_more,
                                                  .end = end,
                                                  .perform_all = eng_schedule_serial,
                                                  .deal = deal,
                                                  .perform = perform,
                                                  .assign = assign,
                                                  .perform_unit = perform_assigned,
                                                  .unit_size = unit_size,
                                                  .finish_units = eng_highlevel_perform,
                                                  .faces_of = eng_paper_faces_of,
                                                  .faces_open = eng_paper_faces_open,
                                                  .faces_index = eng_paper_faces_index,
                                                  .work_free = eng_paper_work_free,
                                                  .work_bytes = eng_paper_work_bytes,
                                                  .flush = eng_taskunit_flush};
