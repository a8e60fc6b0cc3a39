/* step.c - one step of a scene.
 *
 * Source: paper sections 4 to 6.
 */
#include "step.h"

#include <assert.h>
#include <math.h>

#include "answer.h"
#include "bodies.h"
#include "box_frames.h"
#include "clock.h"
#include "detect.h"
#include "memory.h"
#include "method.h"
#include "moving.h"
#include "near.h"
#include "order.h"
#include "rigid.h"
#include "stage_turning.h"
#include "step_memory.h"
#include "thickness.h"
#include "topology.h"
#include "wide_state.h"
#include "wide_test.h"

/* ---- is the step certain to end soon? ---------------------------------------------- */

/* Say how large a step may be that is brief. */
struct bounds {
    uint64_t work_ns; /* of the last step, as it is believed (step_memory.h) */
    /* Of sixteen: boxes are made of each, and all pairs of blocks may be joined. Two
     * blocks are 256 tests of boxes, 0.1 us of a vector kernel, 2 without. */
    uint32_t vertex_blocks;
    uint32_t edge_blocks;
    uint32_t face_blocks;
    uint32_t objects; /* places for them, taken or not: some loops are over all */
};

/* At most 16 pairs of blocks of vertices and faces, and 36 of edges. */
static const struct bounds among_others = {
    .work_ns = 30000,
    .vertex_blocks = 4,
    .edge_blocks = 8,
    .face_blocks = 4,
    .objects = 64,
};

/* A thousand triangles that share no vertex. If each block met each, which it does not in
 * what has taken so little: 6 ms. */
static const struct bounds for_one = {
    .work_ns = 300000,
    .vertex_blocks = 256,
    .edge_blocks = 256,
    .face_blocks = 128,
    .objects = 1024,
};

/* Places for objects of a step that does nothing else: some 20 us. */
#define OBJECTS_AT_REST 1024u

/* Steps after one that has given up until one of more work than that of `among_others` is
 * brief again: what it did was done twice. */
#define TRY_AGAIN_AFTER 32u

/* Return whether they are settings of a step that can be brief: whose work is bounded as
 * step.h says. */
static bool can_be_brief(const struct eng_question *question)
{
    return question->mode != PCCD_MODE_PAIRS && question->distance == 0 &&
           !question->tells_start && !eng_asks_part(question) && !question->weigh &&
           !eng_asks_touching(question) && eng_method_of(question) == PCCD_METHOD_WIDE;
}

static const struct bounds *bounds_of(const struct eng_question *question)
{
    return question->alone ? &for_one : &among_others;
}

/* The trees are there, and small. */
static bool trees_are_small(const struct eng_wide *wide, const struct bounds *bounds)
{
    return !wide->is_stale &&
           wide->trees[PCCD_TREE_VERTICES].block_count[0] <= bounds->vertex_blocks &&
           wide->trees[PCCD_TREE_EDGES].block_count[0] <= bounds->edge_blocks &&
           wide->trees[PCCD_TREE_FACES].block_count[0] <= bounds->face_blocks;
}

/* No step beside its search goes on with what takes several. */
static bool has_work_beside(const struct eng_scene *scene)
{
    enum eng_wide_resort_state state = eng_wide_state_of(scene)->resort.state;
    return (state != ENG_WIDE_IDLE && state != ENG_WIDE_TRIED) ||
           !eng_rigid_is_settled(scene);
}

/* Nothing moved in the last step, so nothing does in one that writes nothing. Its boxes
 * are there, and its answer is the last one: it searches nothing, however large the scene
 * is. */
static bool is_at_rest(const struct eng_scene *scene, const struct eng_question *question)
{
    const struct eng_step_memory *memory = eng_step_memory_of(scene);
    const struct eng_answer_cache *kept = &memory->cache;
    return scene->moving.objects == 0 && !scene->has_lost_start &&
           scene->object_capacity <= OBJECTS_AT_REST &&
           (eng_methods[PCCD_METHOD_WIDE]->has_boxes(scene) || memory->bodies.is_last) &&
           !has_work_beside(scene) &&
           eng_answer_cache_fits(kept, scene, question, scene->moving.number) &&
           !kept->objects_changed && eng_answer_cache_is_brief(kept) &&
           (question->mode != PCCD_MODE_ANY || kept->verdict == PCCD_VERDICT_NO ||
            kept->verdict == PCCD_VERDICT_YES) &&
           eng_step_memory_stays(memory) && eng_wide_work_of(memory->workers[0]);
}

/* Return whether what is left of a brief step, after a look at the boxes and records at
 * hand, is bounded so. */
static bool is_bounded(const struct eng_scene *scene, const struct eng_team *team,
                       const struct eng_question *question)
{
    return trees_are_small(eng_wide_of(scene), bounds_of(question)) ||
           (scene->moving.objects == 0 && team->prunes && team->has_boxes);
}

bool eng_step_can_be_brief(const struct eng_scene *scene,
                           const struct eng_question *question, bool is_staged)
{
    assert(scene && question);
    const struct eng_step_memory *memory = eng_step_memory_of(scene);
    if (!can_be_brief(question) || scene->thickness.may_have_radii ||
        eng_masks_have_clearances(&scene->masks)) {
        return false;
    }
    if (!is_staged && is_at_rest(scene, question)) {
        return true;
    }
    const struct bounds *bounds = bounds_of(question);
    if (scene->object_capacity > bounds->objects ||
        !trees_are_small(eng_wide_of(scene), bounds)) {
        return false;
    }
    uint64_t work_ns = memory->effort[PCCD_METHOD_WIDE].work_ns[question->mode];
    /* Workers beyond the first are freed by some later step: a millisecond of it. */
    bool has_worker =
        question->alone ? memory->worker_count > 0 : memory->worker_count == 1;
    bool would_lose_little =
        work_ns <= among_others.work_ns || memory->steps_until_brief == 0;
    return work_ns > 0 && work_ns <= bounds->work_ns && would_lose_little && has_worker &&
           eng_wide_work_of(memory->workers[0]);
}

/* ---- the step ---------------------------------------------------------------------- */

/* The longest separation. */
#define SEPARATION_MAX 1e18

static bool lengths_are_valid(const struct eng_question *question)
{
    return question->distance >= 0 && question->distance < INFINITY &&
           question->resolution >= 0 && question->resolution <= SEPARATION_MAX &&
           question->approach >= 0 && question->approach < 1;
}

bool eng_step_refuses_start(const struct eng_scene *scene,
                            const struct eng_question *question)
{
    return question->tells_start && question->approach > 0 &&
           eng_masks_have_clearances(&scene->masks);
}

/* A part of a step neither says how the step begins nor can be brief. */
static bool span_is_valid(const struct eng_question *question)
{
    const double *span = question->span;
    return span[0] >= 0 && span[0] < span[1] && span[1] <= 1 &&
           !(eng_asks_part(question) && (question->brief || question->tells_start));
}

static bool settings_are_valid(const struct eng_question *question)
{
    return lengths_are_valid(question) && question->verb == ENG_CONTACTS &&
           span_is_valid(question) && question->mode < PCCD_MODE_COUNT &&
           question->touching < PCCD_TOUCHING_COUNT &&
           question->method < PCCD_METHOD_COUNT && question->threads >= 1 &&
           question->tuning.scheduler < ENG_SCHEDULER_COUNT &&
           question->tuning.high_level < ENG_HIGH_LEVEL_COUNT &&
           question->tuning.refit < ENG_REFIT_COUNT &&
           question->tuning.still < ENG_STILL_COUNT && question->tolerance >= 1e-12 &&
           question->tolerance <= 1;
}

/* Return whether the step is one in which objects turn: the last one, if that is computed
 * once more. */
static bool objects_turn(const struct eng_scene *scene,
                         const struct eng_question *question)
{
    return eng_scene_turns(scene) &&
           (scene->staging || scene->has_moved_without_answer || eng_asks_part(question));
}

static int check(const struct eng_scene *scene, const struct eng_question *question)
{
    if (!settings_are_valid(question) || (question->brief && !can_be_brief(question)) ||
        (objects_turn(scene, question) && eng_turning_refuses(question)) ||
        eng_step_refuses_start(scene, question)) {
        return PCCD_E_INVAL;
    }
    return question->distance <= SEPARATION_MAX ? PCCD_OK : PCCD_E_LIMIT;
}

/* Return what is known of the work of a step, by whether objects turn in it. */
static struct eng_effort *effort_of(struct eng_step_memory *memory,
                                    const struct eng_question *question, bool turns)
{
    return turns ? &memory->turning_effort : &memory->effort[eng_method_of(question)];
}

/* Leave the step to one thread, as a rule, where most stands still. */
static void make_single(struct eng_step_memory *memory, struct eng_team *team,
                        const struct eng_question *question, struct eng_stop *stop)
{
    team->count = 1;
    eng_pool_reset(memory->pool, 1);
    eng_worker_begin(memory->workers[0], team->scene, question, stop, memory->pool);
    int status = eng_answer_begin(memory, team, &memory->sorted);
    assert(status == PCCD_OK); /* it had room for more */
    (void)status;
}

/* Return how much of the scene moves, 0 .. 1. */
static double moving_part(const struct eng_scene *scene)
{
    const struct eng_moving *moving = &scene->moving;
    assert(moving->vertices <= moving->all);
    return moving->all > 0 ? (double)moving->vertices / (double)moving->all : 0;
}

/* The positions have moved on: keep what the last answer says of what stands still. */
static void keep_what_stands(struct eng_team *team, const struct eng_question *question,
                             bool by_bodies, struct eng_stop *stop)
{
    const struct eng_scene *scene = team->scene;
    struct eng_step_memory *memory = eng_step_memory_of(scene);
    const struct eng_effort *effort = &memory->effort[eng_method_of(question)];
    bool is_apart = by_bodies || eng_moving_turns_alone(scene);
    if (team->method->survey && question->tuning.still == ENG_STILL_KEPT && !is_apart) {
        team->method->survey(team->scene);
    }
    team->prunes =
        team->method->can_prune &&
        eng_answer_cache_begin(&memory->cache, scene, question, is_apart,
                               &memory->sorted);
    if (!team->prunes) {
        return;
    }
    if (team->count > 1 && !question->team_always && scene->turning_count == 0 &&
        !eng_effort_pays_for(effort, question->mode, moving_part(scene))) {
        make_single(memory, team, question, stop);
    }
    for (uint32_t i = 0; i < team->count; i++) {
        memory->workers[i]->prunes = true;
    }
    eng_answer_keep(memory, team);
}

/* Bring the answer together, and what the workers did; the step began at `step_ns`, and
 * detection ended at `detect_ns`. */
static void merge(struct eng_team *team, struct eng_step_memory *memory, uint64_t step_ns,
                  uint64_t detect_ns, struct eng_step_result *result)
{
    assert(team->count <= memory->worker_count && detect_ns >= step_ns);
    struct eng_worker *worker = team->workers[0];
    uint64_t begin_ns = common_now_ns();
    eng_answer_end(memory, team, result);
    eng_pool_reset(memory->pool, team->count); /* ready for the next step */
    eng_pool_lend(memory->pool, NULL, 0);
    uint64_t end_ns = common_now_ns();
    result->times.merge = end_ns - detect_ns;
    worker->record.merge_ns += end_ns - begin_ns;
    eng_worker_trace(worker, PCCD_TRACE_MERGE, begin_ns,
                     (uint32_t)result->counters.kept_records, 0);
    uint64_t work_ns =
        eng_detect_count(team, memory->threads.items, &result->times, &result->counters);
    eng_detect_count_thick(team, &result->thick);
    result->counters.exact += result->thick.exact;
    result->counters.thick_candidates = result->thick.candidates;
    result->counters.thick_survivors = result->thick.survivors;
    result->counters.thick_exact = result->thick.exact;
    result->counters.rigid_objects = team->scene->rigid.objects;
    bool turns = team->scene->turning_count > 0;
    struct eng_effort *effort = effort_of(memory, team->workers[0]->question, turns);
    if (result->incomplete == PCCD_COMPLETE && team->prunes && !turns) {
        eng_effort_learn_part(effort, result->mode, moving_part(team->scene), work_ns);
    } else if (result->incomplete == PCCD_COMPLETE) {
        eng_effort_learn(effort, result->mode, work_ns);
        eng_effort_time(effort, result->mode, team->count > 1, end_ns - step_ns);
    }
    for (uint32_t i = 0; i < team->count && result->mode != PCCD_MODE_ANY; i++) {
        const uint64_t *touching = team->workers[i]->tally.touching;
        result->entering += touching[0];
        result->sliding += touching[1];
        result->leaving += touching[2];
    }
    result->thread_records = memory->threads.items;
    result->threads = team->count;
}

static void perform_turning(struct eng_team *team, struct eng_worker *worker)
{
    eng_turning_step_perform(&eng_step_memory_of(team->scene)->turning, worker);
}

/* Have objects that turn tested after all others; or alone, if nothing else moves, or
 * what does is tested in body space, too, and the last answer tells of what stands, or
 * nothing stands. The method makes no boxes then. */
static void begin_turning(struct eng_team *team, bool by_bodies)
{
    const struct eng_scene *scene = team->scene;
    eng_turning_step_begin(&eng_step_memory_of(scene)->turning, by_bodies,
                           team->workers[0], team->count);
    team->after = perform_turning;
    if (by_bodies || scene->turning_count == scene->object_count ||
        (team->prunes && eng_moving_turns_alone(scene))) {
        team->search = perform_turning;
        team->has_boxes = true;
    }
}

/* Remember of mode any what the rest of the step has shown, whatever turning objects
 * met. */
static void remember_rest(struct eng_step_memory *memory,
                          const struct eng_step_result *result)
{
    int rest = atomic_load_explicit(&memory->turning.rest, memory_order_relaxed);
    if (result->mode == PCCD_MODE_ANY && rest != ENG_REST_MEETS) {
        memory->cache.is_valid = rest == ENG_REST_IS_FREE;
        memory->cache.verdict = PCCD_VERDICT_NO;
    }
}

/* The scene was emptied: the answer may be of another size. */
static void forget_records(struct eng_step_memory *memory)
{
    eng_records_deinit(&memory->sorted);
    eng_records_deinit(&memory->found);
    memory->cache.is_valid = false;
    memory->was_emptied = false;
}

/* The scene moves on; unless the last step, which had given up, or of which a part is
 * asked, has moved it. *staged_ns: what staging took, without this. */
static int arrive(struct eng_scene *scene, const struct eng_question *question,
                  uint64_t *staged_ns)
{
    bool has_moved =
        !scene->staging && (scene->has_moved_without_answer || eng_asks_part(question));
    if (!scene->staging && !scene->has_moved_without_answer) {
        scene->stage_ns = 0;
    }
    *staged_ns = scene->stage_ns;
    int status = has_moved ? PCCD_OK : eng_stage_commit(scene);
    if (status == PCCD_OK && eng_asks_part(question)) {
        eng_part_enter(scene, question->span);
    }
    return status;
}

/* Have what only some questions need. */
static int reserve(struct eng_scene *scene, const struct eng_question *question)
{
    int status = PCCD_OK;
    uint32_t objects = eng_asks_touching(question) ? scene->object_capacity : 0;
    for (uint32_t i = 0; i < objects && status == PCCD_OK; i++) {
        if (scene->objects[i].mesh) {
            status = eng_stars_prepare(scene->objects[i].mesh);
        }
    }
    return status == PCCD_OK && eng_asks_part(question) ? eng_part_reserve(scene)
                                                        : status;
}

/* Do all that can fail before anything moves. */
static int prepare(struct eng_scene *scene, const struct eng_question *question,
                   bool turns, bool *may_be_bodies, struct eng_stop *stop,
                   struct eng_team *team)
{
    struct eng_step_memory *memory = eng_step_memory_of(scene);
    int status = check(scene, question);
    if (status != PCCD_OK) {
        return status;
    }
    eng_thickness_begin(scene, question->distance);
    eng_stop_init(stop, question);
    if (memory->was_emptied) {
        forget_records(memory);
    }
    status = eng_detect_prepare(scene, question, effort_of(memory, question, turns),
                                &memory->sorted, stop, team);
    if (status == PCCD_OK) {
        *may_be_bodies = eng_bodies_may(scene, question);
    }
    if (status == PCCD_OK && (turns || *may_be_bodies)) {
        status = eng_turning_step_prepare(&memory->turning, scene, turns, *may_be_bodies,
                                          team->workers, team->count);
    }
    return status == PCCD_OK ? reserve(scene, question) : status;
}

/* Leave out all of a step that has to end before it begins: the method makes no boxes,
 * and does not get ready to make any. A batch has many such. */
static void search_nothing(struct eng_team *team, struct eng_worker *worker)
{
    (void)team, (void)worker;
}

/* Choose what is searched, when the positions have moved on. */
static void start(struct eng_team *team, const struct eng_question *question, bool turns,
                  bool by_bodies)
{
    struct eng_scene *scene = team->scene;
    eng_box_frames_follow(scene);
    if (by_bodies || (turns && !question->brief)) {
        begin_turning(team, by_bodies);
    }
    if (!by_bodies) {
        eng_bodies_leave(scene, question);
    }
    /* Only the boxes of wide know of which step they are. */
    bool is_over = !question->brief && eng_method_of(question) == PCCD_METHOD_WIDE &&
                   eng_worker_should_stop(team->workers[0]);
    if (!team->search && is_over) {
        team->search = search_nothing;
        team->has_boxes = true;
    } else if (!team->search) {
        team->method->start(team, question);
    }
    if (question->brief && (turns || !is_bounded(scene, team, question))) {
        eng_worker_give_up(team->workers[0]);
    }
}

/* The step, by the workers that the scene has, or was lent. */
static int step(struct eng_scene *scene, const struct eng_question *question,
                struct eng_step_result *result)
{
    uint64_t begin_ns = common_now_ns();
    uint64_t allocs = atomic_load(&eng_payer()->allocs);
    uint64_t builds = scene->builds;
    struct eng_stop stop;
    struct eng_team team;
    bool is_part = eng_asks_part(question);
    bool turns = objects_turn(scene, question);
    bool may_be_bodies = false;
    int status = prepare(scene, question, turns, &may_be_bodies, &stop, &team);
    if (status != PCCD_OK) {
        eng_stage_abort(scene);
        return status;
    }
    uint64_t staged_ns;
    status = arrive(scene, question, &staged_ns);
    if (status != PCCD_OK) {
        return status;
    }
    struct eng_step_result r = {.mode = question->mode,
                                .method = eng_method_of(question),
                                .verdict = PCCD_VERDICT_NONE,
                                .record_bytes = team.workers[0]->found.record_bytes,
                                .toi_first = 2};
    r.times.ingest = scene->stage_ns;
    scene->step++;
    eng_rigid_choose(scene, question->mode != PCCD_MODE_PAIRS && !is_part);
    bool by_bodies = may_be_bodies && eng_bodies_choose(scene, question);
    keep_what_stands(&team, question, by_bodies, &stop);
    by_bodies = by_bodies && (team.prunes || eng_bodies_are_all(scene));
    start(&team, question, turns, by_bodies);
    uint64_t detect_ns = eng_detect_run(&team, &r.times);
    scene->has_moved_without_answer = stop.gave_up;
    struct eng_step_memory *memory = eng_step_memory_of(scene);
    if (stop.gave_up) {
        memory->steps_until_brief = TRY_AGAIN_AFTER;
        return PCCD_E_AGAIN;
    }
    assert(!PCCD_VALIDATE || !team.method->validate || team.method->validate(scene));
    memory->steps_until_brief -= memory->steps_until_brief > 0;
    r.incomplete =
        (enum pccd_incomplete)atomic_load_explicit(&stop.reason, memory_order_relaxed);
    merge(&team, memory, begin_ns, detect_ns, &r);
    if (turns && team.search != search_nothing) {
        remember_rest(memory, &r);
    }
    if (by_bodies) {
        eng_bodies_end(scene, question, &r);
    }
    if (is_part) {
        eng_part_leave(scene);
    }
    r.times.step = common_now_ns() - begin_ns + staged_ns;
    if (!team.search) {
        team.method->end(&team, &r, r.times.step - staged_ns);
    }
    r.counters.builds = scene->builds - builds;
    r.counters.allocs = atomic_load(&eng_payer()->allocs) - allocs;
    *result = r;
    return PCCD_OK;
}

/* Add to the step what finding out how it begins took. */
static void add_work(const struct eng_step_result *near, struct eng_step_result *result)
{
    struct pccd_step_counters *counters = &result->counters;
    for (uint32_t kind = 0; kind < PCCD_KINDS_MAX; kind++) {
        counters->candidates[kind] += near->counters.candidates[kind];
    }
    counters->box_tests += near->counters.box_tests;
    counters->leaf_pairs += near->counters.leaf_pairs;
    counters->survivors += near->counters.survivors;
    counters->exact += near->counters.exact;
    counters->allocs += near->counters.allocs;
    result->times.refit += near->times.refit;
    result->times.traversal += near->times.traversal;
    result->times.tests += near->times.tests;
    result->times.merge += near->times.merge;
    result->times.step += near->times.step;
}

/* Tell how it began, and what that leaves of its answer. Who does not know all of it does
 * not say that it is free. Where objects turn it began at places that are rounded: that
 * edges pass through faces there proves nothing; but where none does, and no pair is so
 * near that its record says so, none does at the true places. */
static void tell_start(struct eng_scene *scene, const struct eng_question *question,
                       struct eng_step_result *result)
{
    struct eng_step_result near = {.incomplete = PCCD_INCOMPLETE_CONTACT_LIMIT};
    if (eng_near_start(scene, question, &near) != PCCD_OK) {
        near = (struct eng_step_result){.incomplete = PCCD_INCOMPLETE_CONTACT_LIMIT};
    }
    bool is_free = near.crossings + near.count == 0;
    bool is_known = near.incomplete == PCCD_COMPLETE || !is_free;
    result->crossings = near.crossings;
    result->start_inside = near.count;
    if (result->verdict == PCCD_VERDICT_NO && !(is_known && is_free)) {
        result->verdict = !is_known                  ? PCCD_VERDICT_NONE
                          : scene->turning_count > 0 ? PCCD_VERDICT_POSSIBLE
                                                     : PCCD_VERDICT_YES;
        eng_hash_verdict((uint32_t)result->verdict, result->hash);
        result->safe_step = 0;
    }
    if (result->incomplete == PCCD_COMPLETE) {
        result->incomplete = near.incomplete; /* of the counts, whatever was decided */
    }
    if (near.crossings > 0 || result->incomplete != PCCD_COMPLETE) {
        result->safe_step = 0;
    }
    add_work(&near, result);
}

/* All of it. */
static int whole_step(struct eng_scene *scene, const struct eng_question *question,
                      struct eng_step_result *result)
{
    uint64_t begin_ns = question->trace ? common_now_ns() : 0;
    int status = step(scene, question, result);
    if (status == PCCD_OK && question->tells_start) {
        tell_start(scene, question, result);
    }
    if (status == PCCD_OK && question->trace) {
        const struct pccd_trace_event event = {begin_ns,        common_now_ns(),
                                               PCCD_TRACE_STEP, question->track,
                                               eng_detect_size(scene), result->threads};
        eng_trace_add(question->trace, event);
    }
    return status;
}

int eng_step(struct eng_scene *scene, const struct eng_question *question,
             struct eng_step_result *result)
{
    assert(scene && question && result);
    struct eng_step_memory *memory = eng_step_memory_of(scene);
    struct eng_step_memory *lender =
        question->scratch_from ? eng_step_memory_of(question->scratch_from) : memory;
    if (lender == memory) {
        return whole_step(scene, question, result);
    }
    assert(question->threads == 1);
    eng_step_memory_borrow(memory, lender);
    int status = whole_step(scene, question, result);
    eng_step_memory_give_back(memory, lender);
    return status;
}

/* The method paper makes all boxes in each step, and others read them as they are. */
int eng_move(struct eng_scene *scene, const struct eng_question *question,
             struct eng_step_result *result)
{
    assert(scene && question && result && !question->brief && !eng_asks_part(question));
    uint64_t begin_ns = common_now_ns();
    uint64_t staged_ns = 0;
    if (eng_method_of(question) != PCCD_METHOD_WIDE) {
        return eng_step(scene, question, result);
    }
    int status = check(scene, question);
    if (status != PCCD_OK) {
        eng_stage_abort(scene);
        return status;
    }
    eng_thickness_begin(scene, question->distance);
    status = arrive(scene, question, &staged_ns);
    if (status != PCCD_OK) {
        return status;
    }
    scene->step++;
    scene->has_moved_without_answer = false;
    eng_box_frames_follow(scene);
    eng_bodies_leave(scene, question);
    eng_step_memory_of(scene)->cache.is_valid = false;
    eng_step_empty_result(question, result);
    if (question->cancel &&
        atomic_load_explicit(question->cancel, memory_order_relaxed)) {
        result->incomplete = PCCD_INCOMPLETE_CANCELLED;
    }
    result->times.ingest = scene->stage_ns;
    result->times.step = common_now_ns() - begin_ns + staged_ns;
    return PCCD_OK;
}

uint64_t eng_step_expects(const struct eng_scene *scene,
                          const struct eng_question *question)
{
    assert(scene && question && question->mode < PCCD_MODE_COUNT);
    struct eng_step_memory *memory = eng_step_memory_of(scene);
    return eng_effort_expects(effort_of(memory, question, scene->turning_count > 0),
                              question->mode, eng_detect_size(scene));
}

bool eng_team_pays(uint64_t work_ns)
{
    return eng_effort_is_enough(work_ns);
}

void eng_step_free_scratch(struct eng_scene *scene)
{
    assert(scene && !scene->staging);
    eng_step_memory_keep(eng_step_memory_of(scene), 0);
}

void eng_step_empty_result(const struct eng_question *question,
                           struct eng_step_result *result)
{
    assert(question && result);
    *result = (struct eng_step_result){.mode = question->mode,
                                       .method = eng_method_of(question),
                                       .incomplete = PCCD_INCOMPLETE_DEADLINE,
                                       .verdict = PCCD_VERDICT_NONE,
                                       .toi_first = 2};
    eng_answer_nothing(result);
}
