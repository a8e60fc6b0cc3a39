/* near.c - what is near in a scene at one moment. */
#include "near.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "answer.h"
#include "bodies.h"
#include "box_frames.h"
#include "clock.h"
#include "detect.h"
#include "memory.h"
#include "names.h"
#include "narrow.h"
#include "near_objects.h"
#include "question.h"
#include "rigid.h"
#include "world.h"

#define NOTHING_NEAR 2e18

/* ---- the question ------------------------------------------------------------------ */

static bool is_length(double length)
{
    return length >= 0 && length <= 1e18;
}

/* Check the lengths that the question looks at. */
static bool lengths_are_valid(const struct eng_question *question)
{
    switch (question->verb) {
    case PCCD_NEAR_CROSSINGS:
    case PCCD_NEAR_DEPTH:
        return true;
    case PCCD_NEAR_NEAREST:
        return (is_length(question->distance) || question->distance == INFINITY) &&
               is_length(question->gap);
    default:
        return is_length(question->distance);
    }
}

static bool settings_are_valid(const struct eng_question *question)
{
    return question->verb < PCCD_NEAR_COUNT && question->end <= 1 &&
           lengths_are_valid(question) && question->method < PCCD_METHOD_COUNT &&
           question->threads >= 1 && question->tuning.scheduler < ENG_SCHEDULER_COUNT &&
           question->tuning.high_level < ENG_HIGH_LEVEL_COUNT &&
           question->tuning.refit < ENG_REFIT_COUNT;
}

/* Only `wide` has faces to walk through. */
static enum pccd_method method_of(const struct eng_question *question)
{
    return common_near_is_of_objects(question->verb) ? PCCD_METHOD_WIDE
                                                     : eng_method_of(question);
}

static uint32_t kinds_for(const struct eng_question *question)
{
    uint32_t pairs = 1u << PCCD_VF | 1u << PCCD_EE | 1u << PCCD_VE | 1u << PCCD_VV;
    uint32_t crossings = 1u << PCCD_EF;
    if (question->verb == PCCD_NEAR_CROSSINGS) {
        return question->counts_only ? crossings : pairs | crossings;
    }
    return question->tells_crossings ? pairs | crossings : pairs;
}

/* Return whether radii of objects enter, or pairs that are left thin for their rest. */
static bool is_thick(enum pccd_near_what what, const struct eng_thickness *thickness)
{
    switch (what) {
    case PCCD_NEAR_PAIRS:
    case PCCD_NEAR_FEATURES:
        return thickness->may_have_radii || thickness->may_rest;
    case PCCD_NEAR_VERTICES: /* which have what is left thin */
    case PCCD_NEAR_NEAREST:  /* of two objects */
        return thickness->may_have_radii;
    default:
        return false;
    }
}

/* Say what threads look for, with the radii of the scene. PCCD_E_LIMIT: too far. */
static int seek(const struct eng_scene *scene, struct eng_question *question)
{
    const struct eng_thickness *thickness = &scene->thickness;
    struct eng_sought *sought = &question->sought;
    if (question->verb == PCCD_NEAR_CROSSINGS || question->verb == PCCD_NEAR_DEPTH) {
        question->distance = 0;
    }
    *sought = (struct eng_sought){.kinds = kinds_for(question),
                                  .is_thick = is_thick(question->verb, thickness),
                                  .reach = question->distance};
    if (sought->is_thick && thickness->most > 0) {
        sought->reach = nextafter(2 * thickness->most + question->distance, INFINITY);
    }
    return is_length(sought->reach) || sought->reach == INFINITY ? PCCD_OK : PCCD_E_LIMIT;
}

/* ---- bounds by vertex -------------------------------------------------------------- */

static int compare_ids(const void *a, const void *b)
{
    uint64_t x = *(const uint64_t *)a;
    uint64_t y = *(const uint64_t *)b;
    return x < y ? -1 : x > y;
}

/* Objects by increasing id, of one id alone if that is not 0. */
static uint32_t order_objects(struct eng_near_memory *memory,
                              const struct eng_scene *scene, uint32_t only)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < scene->object_capacity; i++) {
        if (scene->objects[i].mesh && (only == 0 || scene->objects[i].id == only)) {
            memory->order[count++] = (uint64_t)scene->objects[i].id << 32 | i;
        }
    }
    if (count > 1) { /* of no object there may be no memory */
        qsort(memory->order, count, sizeof *memory->order, compare_ids);
    }
    return count;
}

static int reserve_order(struct eng_near_memory *memory, const struct eng_scene *scene)
{
    if (scene->object_count > memory->order_capacity) {
        uint64_t *order = eng_alloc(scene->object_count, sizeof *order);
        if (!order) {
            return PCCD_E_NOMEM;
        }
        eng_free(memory->order);
        memory->order = order;
        memory->order_capacity = scene->object_count;
    }
    return PCCD_OK;
}

static int reserve_bounds(struct eng_near_memory *memory, const struct eng_scene *scene,
                          uint32_t only)
{
    uint32_t vertices = scene->vertex_ranges.end;
    if (vertices > memory->bound_capacity) {
        _Atomic uint64_t *bounds = eng_alloc(vertices, sizeof *bounds);
        if (!bounds) {
            return PCCD_E_NOMEM;
        }
        eng_free((void *)memory->bounds);
        memory->bounds = bounds;
        memory->bound_capacity = vertices;
    }
    int status = reserve_order(memory, scene);
    if (status != PCCD_OK) {
        return status;
    }
    if (only != 0 && order_objects(memory, scene, only) == 0) {
        return PCCD_E_HANDLE;
    }
    memory->records.record_bytes = sizeof(double);
    return eng_records_reserve(&memory->records, vertices);
}

static void begin_bounds(struct eng_near_memory *memory, const struct eng_scene *scene)
{
    const double none = INFINITY;
    uint64_t bits;
    memcpy(&bits, &none, sizeof bits);
    for (uint32_t i = 0; i < scene->vertex_ranges.end; i++) {
        atomic_init(&memory->bounds[i], bits);
    }
}

/* Return the bound of a vertex in the scene's arrays; INFINITY: no pair is near that it
 * is part of. */
static double bound_of(const struct eng_near_memory *memory, uint32_t vertex)
{
    uint64_t bits = atomic_load_explicit(&memory->bounds[vertex], memory_order_relaxed);
    double bound;
    memcpy(&bound, &bits, sizeof bound);
    return bound;
}

/* That pairs have, of which only those that matter were looked for. */
static double greatest_bound(const struct eng_near_memory *memory,
                             const struct eng_scene *scene)
{
    double greatest = 0;
    for (uint32_t i = 0; i < scene->vertex_ranges.end; i++) {
        double bound = bound_of(memory, i);
        greatest = bound < INFINITY ? fmax(greatest, bound) : greatest;
    }
    return greatest;
}

static void write_bounds(struct eng_near_memory *memory, const struct eng_scene *scene,
                         const struct eng_question *question,
                         struct eng_step_result *result)
{
    double *to = (double *)(void *)memory->records.data;
    eng_hash_sum sum = 0;
    uint32_t objects = order_objects(memory, scene, question->objects[0]);
    for (uint32_t i = 0; i < objects; i++) {
        const struct eng_object *object = &scene->objects[(uint32_t)memory->order[i]];
        for (uint32_t v = 0; v < object->vertices.count; v++) {
            double least = bound_of(memory, object->vertices.first + v);
            double most = eng_mesh_has_foreign(object->mesh) ? INFINITY /* not known */
                                                             : question->distance;
            struct eng_vertex_bound bound = {
                .object = object->id, .vertex = v, .bound = fmin(least, most)};
            *to++ = bound.bound;
            sum += eng_hash_records(&bound, 1, sizeof bound);
            result->count++;
        }
    }
    memory->records.count = result->count;
    eng_hash_end(sum, result->count, result->hash);
}

/* ---- the answer -------------------------------------------------------------------- */

static void count_records(const struct eng_records *records,
                          struct eng_step_result *result)
{
    const struct pccd_near *near = (const struct pccd_near *)(const void *)records->data;
    memset(result->counts, 0, sizeof result->counts);
    for (uint64_t i = 0; i < records->count; i++) {
        result->counts[near[i].kind]++;
        result->distance_min = fmin(result->distance_min, near[i].d_lo);
        result->distance_max = fmax(result->distance_max, near[i].d_hi);
    }
}

/* Sum up what the workers have seen, if the answer is complete. */
static void sum_up(const struct eng_team *team, const struct eng_counts *counts,
                   struct eng_step_result *result)
{
    memcpy(result->counts, counts->kind, sizeof result->counts);
    for (uint32_t i = 0; i < team->count; i++) {
        const struct eng_narrow_near *work = eng_narrow_of(team->workers[i])->near;
        result->distance_min = fmin(result->distance_min, work->least);
        result->distance_max = fmax(result->distance_max, work->greatest);
    }
}

static enum pccd_verdict verdict_of(const struct eng_team *team,
                                    const struct eng_step_result *result)
{
    bool meets = atomic_load_explicit(team->workers[0]->question->sought.meets,
                                      memory_order_relaxed);
    if (result->incomplete != PCCD_COMPLETE) {
        return PCCD_VERDICT_NONE;
    }
    return meets ? PCCD_VERDICT_YES : PCCD_VERDICT_NO;
}

static uint64_t sum_crossings(const struct eng_team *team)
{
    uint64_t crossings = 0;
    for (uint32_t i = 0; i < team->count; i++) {
        crossings += eng_narrow_of(team->workers[i])->near->crossings;
    }
    return crossings;
}

static uint64_t sum_pairs(const struct eng_team *team)
{
    uint64_t pairs = 0;
    for (uint32_t i = 0; i < team->count; i++) {
        pairs += eng_narrow_of(team->workers[i])->near->pairs;
    }
    return pairs;
}

static void answer_records(struct eng_near_memory *memory,
                           const struct eng_counts *counts, const struct eng_team *team,
                           struct eng_step_result *result)
{
    struct eng_records *records = &memory->records;
    result->count = records->count;
    if (common_near_is_of_objects(result->what) || result->incomplete != PCCD_COMPLETE) {
        count_records(records, result);
    } else {
        sum_up(team, counts, result);
    }
    eng_hash_end(counts->hash, result->count, result->hash);
    if (result->what == PCCD_NEAR_DEPTH) {
        result->crossings = eng_near_objects_crossings(&memory->objects);
    }
    if (result->what == PCCD_NEAR_NEAREST) {
        if (memory->objects.ask.gap > 0) {
            result->hash[0] = result->hash[1] = 0;
        }
        if (result->incomplete == PCCD_COMPLETE) {
            eng_near_objects_learn(&memory->objects, records->data, records->count);
        }
    }
    if (result->what == PCCD_NEAR_CROSSINGS) {
        result->crossings = result->counts[PCCD_EF];
        result->verdict = verdict_of(team, result);
    }
}

static void answer_bounds(struct eng_near_memory *memory, const struct eng_counts *counts,
                          const struct eng_team *team,
                          const struct eng_question *question,
                          struct eng_step_result *result)
{
    if (result->incomplete != PCCD_COMPLETE) {
        memory->records.count = 0;
        eng_hash_end(0, 0, result->hash);
        return;
    }
    sum_up(team, counts, result);
    result->distance_max = greatest_bound(memory, team->scene);
    write_bounds(memory, team->scene, question, result);
}

/* Bring together what the workers found. */
static void answer(struct eng_team *team, const struct eng_question *question,
                   struct eng_step_result *result)
{
    struct eng_step_memory *memory = eng_step_memory_of(team->scene);
    struct eng_counts counts = ENG_COUNTS_NONE;
    if (eng_answer_collect(memory, team, &result->incomplete, &counts) != PCCD_OK) {
        result->incomplete = PCCD_INCOMPLETE_CONTACT_LIMIT; /* and nothing is in it */
        counts = ENG_COUNTS_NONE;
    }
    if (!common_near_is_of_objects(result->what)) {
        result->crossings = sum_crossings(team);
    }
    if (question->counts_only) {
        result->count = sum_pairs(team);
    } else if (result->what == PCCD_NEAR_VERTICES) {
        answer_bounds(&memory->near, &counts, team, question, result);
    } else {
        answer_records(&memory->near, &counts, team, result);
    }
    result->records = question->counts_only ? NULL : memory->near.records.data;
    eng_pool_reset(memory->pool, team->count);
}

/* ---- the search -------------------------------------------------------------------- */

/* Make staged positions the scene's, and find out whether there are boxes of them. */
static int arrive(struct eng_team *team, struct eng_question *question)
{
    struct eng_scene *scene = team->scene;
    if (scene->staging) {
        int status = eng_stage_commit(scene);
        if (status != PCCD_OK) {
            return status;
        }
        scene->step++;
    }
    team->has_boxes = !scene->has_lost_start && team->method->has_boxes(scene) &&
                      eng_box_frames_keep_distances(scene);
    if (!team->has_boxes) {
        eng_box_frames_follow(scene);
    }
    if (!eng_box_frames_keep_distances(scene)) {
        eng_box_frames_choose_keeping(scene, 1 - scene->now, scene->now);
    }
    eng_rigid_choose(scene, false);
    struct eng_sought *sought = &question->sought;
    sought->growth = eng_near_growth(question->distance, scene->framing.scale);
    sought->reach_growth = eng_near_growth(sought->reach, scene->framing.scale);
    return PCCD_OK;
}

static int reserve_objects(struct eng_team *team, const struct eng_question *question,
                           struct eng_step_result *result)
{
    struct eng_near_memory *memory = &eng_step_memory_of(team->scene)->near;
    struct eng_open_mesh_error open;
    int status = eng_near_objects_prepare(&memory->objects, team->scene, question,
                                          team->count, &open);
    if (status == PCCD_E_INVAL && open.object != 0) {
        result->open_object = open.object;
        memcpy(result->open_edge, open.edge.vertex, sizeof result->open_edge);
        memcpy(result->open_runs, open.edge.runs, sizeof result->open_runs);
    }
    return status;
}

static int reserve(struct eng_team *team, const struct eng_question *question,
                   struct eng_step_result *result)
{
    struct eng_near_memory *memory = &eng_step_memory_of(team->scene)->near;
    int status = PCCD_OK;
    if (common_near_is_of_objects(question->verb)) {
        return reserve_objects(team, question, result);
    }
    if (status == PCCD_OK && question->verb == PCCD_NEAR_CROSSINGS) {
        status = reserve_order(memory, team->scene);
    }
    if (status == PCCD_OK && question->verb == PCCD_NEAR_VERTICES) {
        status = reserve_bounds(memory, team->scene, question->objects[0]);
    }
    return status;
}

static void search_objects(struct eng_team *team, struct eng_worker *worker)
{
    eng_near_objects_perform(&eng_step_memory_of(team->scene)->near.objects, team->method,
                             worker);
}

static void begin_search(struct eng_team *team, const struct eng_question *question)
{
    if (common_near_is_of_objects(question->verb)) {
        eng_near_objects_begin(&eng_step_memory_of(team->scene)->near.objects);
        team->search = search_objects;
        return;
    }
    struct eng_name_range range = eng_near_range(team->scene);
    for (uint32_t i = 0; i < team->count; i++) {
        eng_near_begin(team->workers[i], &range);
    }
}

/* Find what is asked for. */
static int search(struct eng_scene *scene, const struct eng_question *asked,
                  uint64_t begin_ns, struct eng_step_result *result)
{
    struct eng_question question = *asked;
    enum pccd_method method = method_of(asked);
    struct eng_step_memory *memory = eng_step_memory_of(scene);
    struct eng_effort *effort = &memory->near.effort[method][asked->verb];
    struct eng_stop stop;
    struct eng_team team;
    question.method = method;
    question.mode = PCCD_MODE_ALL;
    question.tolerance = 1;
    question.brief = false;
    eng_thickness_begin(scene, scene->thickness.separation);
    int status = seek(scene, &question);
    if (status != PCCD_OK) {
        eng_stage_abort(scene);
        return status;
    }
    eng_stop_init(&stop, &question);
    uint64_t staged_ns = scene->staging ? scene->stage_ns : 0;
    struct eng_records *records =
        question.counts_only ? &memory->near.none : &memory->near.records;
    records->record_bytes = sizeof(struct pccd_near);
    status = eng_detect_prepare(scene, &question, effort, records, &stop, &team);
    status = status == PCCD_OK ? reserve(&team, &question, result) : status;
    if (status != PCCD_OK) {
        eng_stage_abort(scene);
        return status;
    }
    status = arrive(&team, &question);
    if (status != PCCD_OK) {
        return status;
    }
    if (question.verb == PCCD_NEAR_VERTICES) {
        begin_bounds(&memory->near, scene);
        question.sought.bounds = memory->near.bounds;
    }
    atomic_store_explicit(&memory->near.meets, false, memory_order_relaxed);
    question.sought.meets = &memory->near.meets;
    begin_search(&team, &question);
    eng_bodies_leave(scene, &question);
    result->times.ingest = staged_ns;
    team.method->start(&team, &question);
    uint64_t detect_ns = eng_detect_run(&team, &result->times);
    result->incomplete =
        (enum pccd_incomplete)atomic_load_explicit(&stop.reason, memory_order_relaxed);
    answer(&team, &question, result);
    uint64_t end_ns = common_now_ns();
    result->times.merge = end_ns - detect_ns;
    uint64_t work_ns = eng_detect_count(&team, memory->near.threads.items, &result->times,
                                        &result->counters);
    for (uint32_t i = 0; i < team.count && !common_near_is_of_objects(question.verb);
         i++) {
        result->counters.exact += eng_narrow_of(team.workers[i])->batch.integers;
    }
    if (result->incomplete == PCCD_COMPLETE) {
        eng_effort_learn(effort, question.mode, work_ns);
        eng_effort_time(effort, question.mode, team.count > 1, end_ns - begin_ns);
    }
    result->threads = team.count;
    result->thread_records = memory->near.threads.items;
    result->times.step = end_ns - begin_ns + staged_ns;
    return PCCD_OK;
}

int eng_near(struct eng_scene *scene, const struct eng_question *question,
             struct eng_step_result *result)
{
    assert(scene && question && result);
    uint64_t begin_ns = common_now_ns();
    uint64_t allocs = atomic_load(&eng_payer()->allocs);
    uint64_t builds = scene->builds;
    if (!settings_are_valid(question)) {
        eng_stage_abort(scene);
        return PCCD_E_INVAL;
    }
    struct eng_step_result r = {.what = question->verb,
                                .method = method_of(question),
                                .verdict = PCCD_VERDICT_NONE,
                                .record_bytes = question->verb == PCCD_NEAR_VERTICES
                                                    ? (uint32_t)sizeof(double)
                                                    : (uint32_t)sizeof(struct pccd_near),
                                .distance_min = NOTHING_NEAR};
    int status = search(scene, question, begin_ns, &r);
    r.counters.builds = scene->builds - builds;
    r.counters.allocs = atomic_load(&eng_payer()->allocs) - allocs;
    *result = r;
    return status;
}

int eng_near_start(struct eng_scene *scene, const struct eng_question *step,
                   struct eng_step_result *result)
{
    struct eng_question near = *step;
    near.verb = PCCD_NEAR_CROSSINGS;
    near.end = 0;
    near.tells_crossings = true;
    near.counts_only = true;
    near.scratch_from = NULL;
    near.scratch_memory = NULL;
    near.scratch_bytes = 0;
    if (step->approach > 0) { /* else those pairs are contacts */
        near.verb = PCCD_NEAR_PAIRS;
    }
    return eng_near(scene, &near, result);
}
