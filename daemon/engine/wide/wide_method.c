/* wide_method.c - the method wide, as a step sees it.
 *
 * Keep the wide trees. A task is a pair of nodes of one level, of the trees of one kind
 * of pair; a node with itself, of one tree, stands for all pairs below it. Tasks are
 * divided down to nodes of 256 features.
 *
 * Trees do not change while they are searched, so any task may go to any thread. A worker
 * divides depth first, and what finds no room in its deque is done at once.
 */
#include "wide_state.h"

#include <assert.h>

#include "box_frames.h"
#include "moving.h"
#include "wide.h"
#include "wide_cells.h"
#include "wide_test.h"

/* A task from its highest bit: 3 bits for the kind, 3 for the level, 29 each for n and m.
 * Nodes are fewer than 2^28. */
#define NODE_BITS  29u
#define LEVEL_BITS 3u
#define KIND_BITS  3u

static_assert(KIND_BITS + LEVEL_BITS + 2 * NODE_BITS == 64 &&
                  PCCD_KINDS_MAX <= 1u << KIND_BITS &&
                  ENG_WIDE_LEVELS_MAX <= 1u << LEVEL_BITS,
              "a task");

static uint64_t task_of(enum pccd_kind kind, uint32_t level, uint32_t n, uint32_t m)
{
    assert(level < ENG_WIDE_LEVELS_MAX && n < 1u << NODE_BITS && m < 1u << NODE_BITS);
    return (((uint64_t)kind << LEVEL_BITS | level) << NODE_BITS | n) << NODE_BITS | m;
}

/* The level of nodes that are not divided any more: of two such nodes 65536 pairs of
 * features at most, some 30 us in the trees, as a rule far fewer. */
#define GRAIN_LEVEL 1u

static enum pccd_kind kind_of(uint64_t task)
{
    return (enum pccd_kind)(task >> (LEVEL_BITS + 2 * NODE_BITS));
}

static uint32_t level_of(uint64_t task)
{
    return task >> 2 * NODE_BITS & ((1u << LEVEL_BITS) - 1);
}

static_assert(PCCD_KINDS_MAX * ENG_JOIN_MAX <= ENG_DEQUE_MAX / 2, "tasks");

static void perform(struct eng_worker *worker, uint64_t task)
{
    assert(level_of(task) < ENG_WIDE_LEVELS_MAX);
    const uint32_t node_mask = (1u << NODE_BITS) - 1;
    enum pccd_kind kind = kind_of(task);
    uint32_t level = level_of(task);
    uint32_t n = task >> NODE_BITS & node_mask;
    uint32_t m = task & node_mask;
    if (eng_near_leaves_out(worker->question, kind)) {
        return;
    }
    eng_wide_work_leads(worker);
    struct eng_wide_join *join = &eng_wide_work_of(worker)->join;
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
            if (!eng_deque_push(&worker->deque, task_of(kind, level - 1, a, b))) {
                eng_wide_join_nodes(join, kind, level - 1, a, b);
            }
        }
        below->count = 0;
    }
    eng_worker_trace(worker, PCCD_TRACE_UNIT, begin_ns, n, m);
}

static uint32_t top_level(const struct eng_worker *worker)
{
    return eng_wide_of(worker->scene)->level_count - 1;
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
                      enum pccd_kind kind)
{
    const struct eng_wide *wide = eng_wide_of(worker->scene);
    const struct eng_wide_tree *tree = &wide->trees[eng_wide_tree_of(kind, 0)];
    struct eng_wide_join *join = &eng_wide_work_of(worker)->join;
    uint32_t level = top_level(worker) - 1;
    struct eng_wide_list *below = &join->lists[level];
    uint64_t begin_ns = eng_worker_slice(worker);
    eng_wide_join_refine(join, kind, level + 1, 0, 0);
    for (uint32_t i = 0; i < below->count; i++) {
        uint32_t a = below->a[i];
        uint32_t b = below->b[i];
        assert(a < tree->block_count[level]);
        uint32_t owner = eng_partition_of(tree->block_count[level], a, team->count);
        eng_deque_push(&team->workers[owner]->deque, task_of(kind, level, a, b));
    }
    below->count = 0;
    worker->record.task_units++;
    eng_worker_trace(worker, PCCD_TRACE_UNIT, begin_ns, 0, 0);
}

static bool is_wanted(const struct eng_worker *worker, enum pccd_kind kind)
{
    return eng_wide_work_of(worker)->join.kinds >> kind & 1;
}

static void deal(struct eng_team *team, struct eng_worker *worker)
{
    uint32_t top = top_level(worker);
    if (has_no_boxes(worker)) {
        return;
    }
    for (enum pccd_kind kind = 0; kind < COMMON_KIND_COUNT; kind++) {
        if (!is_wanted(worker, kind)) {
            continue;
        }
        if (top <= GRAIN_LEVEL) {
            eng_deque_push(&worker->deque, task_of(kind, top, 0, 0));
        } else {
            deal_kind(team, worker, kind);
        }
    }
}

/* ---- the step ---------------------------------------------------------------------- */

/* The last one, of edges that pass through faces, first: whether any does decides what
 * else is looked for. By a team it is that, too: it is dealt out last. */
static enum pccd_kind kind_in_turn(uint32_t turn)
{
    return (enum pccd_kind)((turn + COMMON_KIND_COUNT - 1) % COMMON_KIND_COUNT);
}

static void perform_all(struct eng_worker *worker)
{
    struct eng_wide_join *join = &eng_wide_work_of(worker)->join;
    eng_wide_work_leads(worker);
    for (uint32_t turn = 0; turn < COMMON_KIND_COUNT; turn++) {
        enum pccd_kind kind = kind_in_turn(turn);
        if (!is_wanted(worker, kind) || eng_near_leaves_out(worker->question, kind)) {
            continue;
        }
        uint64_t begin_ns = eng_worker_slice(worker);
        eng_wide_join_nodes(join, kind, top_level(worker), 0, 0);
        worker->record.task_units++;
        eng_worker_trace(worker, PCCD_TRACE_UNIT, begin_ns, 0, 0);
        if (turn == 0) {
            eng_wide_join_flush(join);
        }
    }
    eng_wide_join_flush(join);
}

static void flush(struct eng_worker *worker)
{
    eng_wide_join_flush(&eng_wide_work_of(worker)->join);
}

static bool is_stale(const struct eng_scene *scene)
{
    return eng_wide_of(scene)->is_stale;
}

static int prepare(struct eng_team *team, const struct eng_question *question)
{
    struct eng_scene *scene = team->scene;
    int status = PCCD_OK;
    bool has_changed = false;
    eng_wide_resort_prepare(&eng_wide_state_of(scene)->resort, scene);
    if (eng_wide_of(scene)->is_stale) {
        eng_box_frames_choose(scene, scene->now, scene->now);
        status = eng_wide_assemble(eng_wide_of(scene), scene);
    }
    if (status == PCCD_OK && question->mode == PCCD_MODE_PAIRS) {
        status = eng_wide_reserve_floats(eng_wide_of(scene));
    }
    if (status == PCCD_OK) {
        status = eng_wide_owners_prepare(&eng_wide_state_of(scene)->owners,
                                         eng_wide_of(scene), scene, &has_changed);
    }
    if (has_changed) {
        eng_wide_resort_unlearn(&eng_wide_state_of(scene)->resort);
    }
    if (status == PCCD_OK && eng_near_prunes(question)) {
        status =
            eng_wide_leads_reserve(&eng_wide_state_of(scene)->leads, eng_wide_of(scene));
    }
    for (uint32_t i = 0; i < team->count && status == PCCD_OK; i++) {
        status = eng_wide_work_reserve(team->workers[i]);
    }
    return status;
}

/* Return whether the boxes of what stands are those of the last step, so that only what
 * moves needs new ones, and it is worth it. */
static bool has_current_boxes(const struct eng_wide *wide, const struct eng_scene *scene,
                              const struct eng_question *question)
{
    return question->tuning.still == ENG_STILL_KEPT && !wide->boxes_are_old &&
           wide->boxes_of != 0 && wide->boxes_of + 1 >= scene->moving.number &&
           wide->frames == scene->framing.number &&
           wide->thickness == scene->thickness.number && eng_moves_little(scene);
}

/* A part of the scene's leaves: with so many more, or fewer, that need no tests
 * against themselves, the number of box tests says nothing of the order. */
#define LEFT_OUT_PART 16u

static void follow_rigid(const struct eng_scene *scene, enum pccd_mode mode)
{
    struct eng_wide_state *state = eng_wide_state_of(scene);
    uint64_t now = scene->rigid.leaves;
    uint64_t change =
        now > state->left_out ? now - state->left_out : state->left_out - now;
    /* What is learned of mode pairs is apart, and that leaves nothing out. */
    if (mode != PCCD_MODE_PAIRS && change > scene->leaf_count / LEFT_OUT_PART) {
        eng_wide_resort_unlearn(&state->resort);
        state->left_out = now;
    }
}

static void survey(struct eng_scene *scene)
{
    struct eng_moving *moving = &scene->moving;
    bool may_be = eng_moves_much(ENG_WIDE * moving->vertices, moving->all);
    if (eng_moves_little(scene) && may_be) {
        moving->is_spread = eng_wide_still_is_spread(eng_wide_of(scene), scene);
    }
}

static bool has_boxes(const struct eng_scene *scene)
{
    const struct eng_wide *wide = eng_wide_of(scene);
    return !wide->is_stale && !wide->boxes_are_old && !wide->lacks_apart &&
           wide->boxes_of != 0 && wide->boxes_of == scene->moving.number &&
           wide->frames == scene->framing.number &&
           wide->thickness == scene->thickness.number;
}

static void start(struct eng_team *team, const struct eng_question *question)
{
    struct eng_wide *wide = eng_wide_of(team->scene);
    wide->kernels = team->workers[0]->kernels;
    if (eng_near_prunes(question)) {
        eng_wide_forget_near(wide, question->end);
        eng_wide_leads_begin(&eng_wide_state_of(team->scene)->leads, wide,
                             team->scene->masks.version);
    }
    if (team->has_boxes) {
        return;
    }
    if (!eng_asks_near(question)) {
        follow_rigid(team->scene, question->mode);
    }
    /* What is counted as a candidate in mode pairs is a pair of the boxes themselves. */
    bool keeps = has_current_boxes(wide, team->scene, question);
    keeps &= eng_wide_quantised_choose(wide, team->scene,
                                       question->mode != PCCD_MODE_PAIRS, keeps);
    keeps &= eng_wide_grid_choose(wide, team->scene);
    if (!keeps || wide->lacks_apart) {
        wide->boxes_of = 0; /* until they are made, if nothing stops that */
    }
    eng_wide_still_begin(wide, team->scene, keeps, team->prunes);
    if (wide->thickness != team->scene->thickness.number) {
        /* Other boxes, other numbers of tests: they say nothing of the order. */
        eng_wide_resort_unlearn(&eng_wide_state_of(team->scene)->resort);
        wide->thickness = team->scene->thickness.number;
    }
    wide->frames = team->scene->framing.number;
    wide->frame_scale = team->scene->framing.scale;
    if (keeps && team->scene->moving.objects == 0) {
        wide->boxes_of = wide->refit_of;
        team->has_boxes = true;
        return;
    }
    for (enum pccd_tree kind = 0; kind < ENG_WIDE_TREES; kind++) {
        uint32_t chunks = eng_wide_refit_chunks(eng_wide_of(team->scene), kind);
        for (uint32_t i = 0; i < team->count; i++) {
            eng_partition_init(&eng_wide_work_of(team->workers[i])->shares[kind], chunks,
                               i, team->count);
        }
    }
    team->shares = team->count;
}

static void refit(struct eng_worker *worker)
{
    struct eng_wide *wide = eng_wide_of(worker->scene);
    for (enum pccd_tree kind = 0; kind < ENG_WIDE_TREES; kind++) {
        uint32_t count = eng_wide_refit_chunks(wide, kind);
        for (uint32_t i = 0; i < count && !eng_worker_should_stop(worker); i++) {
            eng_wide_refit_chunk(wide, worker->scene, kind, i);
        }
    }
    if (!eng_stop_is_set(worker->stop)) {
        eng_wide_refit_above(wide);
    }
}

static void ready(struct eng_worker *worker)
{
    (void)worker;
}

static void beside(struct eng_worker *worker)
{
    struct eng_wide_resort *resort = &eng_wide_state_of(worker->scene)->resort;
    if (resort->state != ENG_WIDE_SORTING) {
        return;
    }
    uint64_t begin_ns = common_now_ns();
    uint32_t object = resort->object;
    eng_wide_resort_share(resort, worker->scene, worker->stop);
    uint64_t share_ns = common_now_ns() - begin_ns;
    worker->record.low_ns += share_ns;
    worker->record.rebuild_ns += share_ns;
    eng_worker_trace(worker, PCCD_TRACE_BACKGROUND, begin_ns, object,
                     (uint32_t)resort->item_count);
}

/* One of sixteen pairs of nodes that are looked at in time has to go, or the next steps
 * do without: a look takes a tenth of what becomes of a pair as a rule. By whole steps,
 * so that what is counted does not depend on threads. */
#define NODES_PAY_FROM      16u
#define STEPS_WITHOUT_TIMES 31u

static void learn_times(const struct eng_team *team)
{
    for (enum pccd_kind kind = 0; kind < PCCD_KIND_COUNT; kind++) {
        uint32_t *without = &eng_wide_of(team->scene)->steps_without_times[kind];
        uint64_t apart = 0;
        uint64_t below = 0;
        for (uint32_t i = 0; i < team->count; i++) {
            const struct eng_wide_join *join = &eng_wide_work_of(team->workers[i])->join;
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

/* Box tests of the step, or what they would have been had it left nothing out. 0: nothing
 * is to be learned from it. */
static uint64_t whole_tests(const struct eng_team *team,
                            const struct eng_step_result *result)
{
    struct eng_wide_resort *resort = &eng_wide_state_of(team->scene)->resort;
    const struct eng_moving *moving = &team->scene->moving;
    if (team->prunes) {
        return moving->vertices == 0
                   ? 0
                   : eng_wide_resort_whole(resort, result->mode,
                                           result->counters.box_tests, moving->vertices,
                                           moving->all);
    }
    resort->whole_tests[result->mode] = result->counters.box_tests;
    resort->tests_each[result->mode] = 0;
    return result->counters.box_tests;
}

static void end(struct eng_team *team, struct eng_step_result *result, uint64_t step_ns)
{
    struct eng_wide_resort *resort = &eng_wide_state_of(team->scene)->resort;
    result->counters.swaps = resort->sorts;
    result->counters.swapped_triangles = resort->sorted_triangles;
    result->counters.still_features =
        eng_wide_still_count(eng_wide_of(team->scene), team->scene);
    uint64_t tests = whole_tests(team, result);
    if (tests > 0 && result->incomplete == PCCD_COMPLETE &&
        result->mode != PCCD_MODE_ANY) {
        eng_wide_resort_learn(resort, result->mode, tests, step_ns);
    }
    if (!team->prunes && result->incomplete == PCCD_COMPLETE &&
        result->mode == PCCD_MODE_ALL) {
        learn_times(team);
    }
}

const struct eng_method_calls eng_method_wide = {.can_prune = true,
                                                 .is_stale = is_stale,
                                                 .prepare = prepare,
                                                 .survey = survey,
                                                 .has_boxes = has_boxes,
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
                                                 .leaves_of = eng_wide_leaves_of,
                                                 .leaves_open = eng_wide_leaves_open,
                                                 .leaves_index = eng_wide_leaves_index,
                                                 .work_free = eng_wide_work_free,
                                                 .work_bytes = eng_wide_work_bytes,
                                                 .flush = flush};
