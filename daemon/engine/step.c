/* daemon/engine/step.c - one step of a scene.
 *
 * Room:     engine.
 * Does:     put the phases in order, divide them among threads, time them.
 * Threads:  [compute]; it opens one parallel region per step.
 * Source:   paper sections 4 to 6.
 */
#include "step.h"

#include <omp.h>

#include "answer.h"
#include "brief.h"
#include "build.h"
#include "clock.h"
#include "memory.h"
#include "method.h"
#include "place.h"
#include "refit.h"
#include "schedule.h"
#include "stage.h"
#include "step_memory.h"
#include "wait.h"

static bool settings_are_valid(const struct eng_step_settings *settings)
{
    return settings->mode >= ENG_MODE_ALL && settings->mode <= ENG_MODE_PAIRS &&
           settings->method >= ENG_METHOD_DEFAULT &&
           settings->method <= ENG_METHOD_WIDE && settings->threads >= 1 &&
           settings->scheduler >= ENG_SCHEDULER_STEAL &&
           settings->scheduler <= ENG_SCHEDULER_PAPER &&
           settings->high_level >= ENG_HIGH_ROUND_ROBIN &&
           settings->high_level <= ENG_HIGH_DISJOINT &&
           settings->refit >= ENG_REFIT_EVEN && settings->refit <= ENG_REFIT_PAPER &&
           settings->tolerance >= 1e-12 && settings->tolerance <= 1;
}

enum eng_method eng_step_method(const struct eng_step_settings *settings)
{
    if (settings->method != ENG_METHOD_DEFAULT) {
        return settings->method;
    }
    return settings->scheduler == ENG_SCHEDULER_PAPER ? ENG_METHOD_PAPER
                                                      : ENG_METHOD_WIDE;
}

/* Triangles of the scene, 2^32 - 1 if there are more. */
static uint32_t size_of(const struct eng_scene *scene)
{
    return scene->triangle_count < UINT32_MAX ? (uint32_t)scene->triangle_count
                                              : UINT32_MAX;
}

static uint32_t threads_for(const struct eng_scene *scene,
                            const struct eng_step_settings *settings)
{
    if (settings->threads == 1 || settings->brief || scene->object_count == 0) {
        return 1;
    }
    if (!settings->team_always &&
        !eng_effort_pays(&scene->memory->effort[eng_step_method(settings)],
                         settings->mode, size_of(scene))) {
        return 1;
    }
    return settings->threads < ENG_THREADS_MAX ? settings->threads : ENG_THREADS_MAX;
}

/* Everything that can fail for want of memory, before anything moves. */
static int prepare(struct eng_scene *scene, const struct eng_step_settings *settings,
                   struct eng_stop *stop, struct eng_team *team)
{
    struct eng_step_memory *memory = scene->memory;
    enum eng_method method = eng_step_method(settings);
    if (method == ENG_METHOD_WIDE ? scene->wide.is_stale : scene->top_is_stale) {
        eng_effort_forget(&memory->effort[method]);
    }
    team->scene = scene;
    team->method = method == ENG_METHOD_WIDE ? &eng_method_wide : &eng_method_paper;
    team->count = threads_for(scene, settings);
    eng_refit_begin(team);
    int status = eng_step_memory_reserve(memory, team->count);
    team->workers = memory->workers;
    team->assignment = &memory->assignment;
    if (status == ENG_OK && settings->scheduler == ENG_SCHEDULER_PAPER) {
        status = eng_assignment_reserve(&memory->assignment, team->count);
    }
    if (status == ENG_OK) {
        status = team->method->prepare(team, settings);
    }
    if (status != ENG_OK) {
        return status;
    }
    eng_pool_reset(&memory->pool, team->count);
    for (uint32_t i = 0; i < team->count; i++) {
        eng_worker_begin(memory->workers[i], scene, settings, stop, &memory->pool);
        memory->workers[i]->thread = i;
    }
    scene->wide.kernels = memory->workers[0]->kernels;
    return eng_answer_begin(memory, team);
}

/* Refit and detection by one thread; returns when they ended. */
static uint64_t run_alone(struct eng_team *team, struct eng_step_times *times)
{
    const struct eng_method_calls *method = team->method;
    struct eng_worker *worker = team->workers[0];
    uint64_t begin_ns = eng_now_ns();
    method->refit(worker);
    uint64_t refit_ns = eng_now_ns();
    eng_worker_trace(worker, ENG_TRACE_REFIT, begin_ns, 0, 0);
    times->refit = refit_ns - begin_ns;
    worker->record.refit_ns = times->refit;
    method->ready(worker);
    method->enter(worker);
    if (!eng_worker_should_stop(worker)) {
        method->perform_all(worker);
    }
    method->leave(worker);
    method->beside(worker);
    uint64_t end_ns = eng_now_ns();
    times->low = end_ns - refit_ns;
    worker->record.low_ns = times->low;
    return end_ns;
}

/* What follows the refit, by the thread that ended it: a part of its time with low-level
 * nodes, as what is rebuilt here is. */
static void begin_tasks(struct eng_team *team, struct eng_worker *worker, bool by_paper)
{
    team->count = (uint32_t)omp_get_num_threads();
    team->refit_end_ns = eng_now_ns();
    team->method->ready(worker);
    if (by_paper) {
        eng_schedule_paper_begin(team, worker);
    } else {
        eng_schedule_steal_begin(team, worker);
    }
    worker->record.low_ns += eng_now_ns() - team->refit_end_ns;
    eng_refit_release(team);
}

/* Low-level nodes are done when the first thread knows: none has begun with high-level
 * ones before, and all have ended with these. `end_ns` where there are none. */
static uint64_t low_end_of(const struct eng_team *team, uint64_t end_ns)
{
    uint64_t low_end_ns = end_ns;
    for (uint32_t i = 0; i < team->count; i++) {
        uint64_t known_ns = team->workers[i]->low_end_ns;
        low_end_ns = known_ns > 0 && known_ns < low_end_ns ? known_ns : low_end_ns;
    }
    return low_end_ns;
}

/* The same by a team, which goes on to merge what it found. Its size may turn out smaller
 * than asked for: the refit asks the runtime; everything after it, the team. */
static uint64_t run_together(struct eng_team *team, struct eng_step_times *times)
{
    const struct eng_method_calls *method = team->method;
    uint64_t begin_ns = eng_now_ns();
    bool by_paper = team->workers[0]->settings->scheduler == ENG_SCHEDULER_PAPER;
    struct eng_payer *payer = eng_payer();
#pragma omp parallel num_threads((int)team->count)
    {
        eng_payer_join(payer);
        struct eng_worker *worker = team->workers[omp_get_thread_num()];
        eng_place_thread(worker->settings->places, worker->thread,
                         (uint32_t)omp_get_num_threads());
        bool is_last = method->refit_by_team(team, worker);
        if (is_last) {
            method->enter(worker);
            begin_tasks(team, worker, by_paper);
        }
        eng_refit_await(team, worker);
        eng_wait_return(worker, team->count);
        if (!is_last) {
            method->enter(worker);
        }
        if (worker->thread == team->count - 1) {
            method->beside(worker);
        }
        if (by_paper) {
            eng_schedule_paper(team, worker);
        } else {
            eng_schedule_steal(team, worker);
        }
        method->leave(worker);
        eng_answer_by_team(team->scene->memory, team, worker);
        eng_wait_for_all(worker); /* the runtime's barrier would lend nobody anything */
    }
    uint64_t merge_ns = team->scene->memory->merge.begin_ns;
    uint64_t end_ns = merge_ns > 0 ? merge_ns : eng_now_ns();
    uint64_t low_end_ns = low_end_of(team, end_ns);
    times->refit = team->refit_end_ns - begin_ns;
    times->low = low_end_ns - team->refit_end_ns;
    times->high = end_ns - low_end_ns;
    return end_ns;
}

/* Wall time of detection, divided into traversal and tests as the threads' time is. */
static void divide_time(const struct eng_team *team, struct eng_step_times *times)
{
    uint64_t wall_ns = times->low + times->high;
    double busy_ns = 1;
    double tests_ns = 0;
    for (uint32_t i = 0; i < team->count; i++) {
        const struct eng_thread_record *record = &team->workers[i]->record;
        busy_ns += (double)(record->low_ns + record->high_ns);
        tests_ns += (double)record->tests_ns;
        times->rebuild += record->rebuild_ns;
    }
    times->tests = (uint64_t)((double)wall_ns * (tests_ns / busy_ns));
    times->tests = times->tests < wall_ns ? times->tests : wall_ns;
    times->traversal = wall_ns - times->tests;
}

static void add_counters(const struct eng_team *team, struct eng_step_counters *sum)
{
    for (uint32_t i = 0; i < team->count; i++) {
        const struct eng_worker *worker = team->workers[i];
        sum->task_units += worker->record.task_units;
        sum->box_tests += worker->record.box_tests;
        sum->rebuilds += worker->record.rebuilds;
        sum->leaf_pairs += worker->tally.leaf_pairs;
        sum->candidates_vf += worker->tally.candidates_vf;
        sum->candidates_ee += worker->tally.candidates_ee;
        sum->survivors += worker->tally.survivors;
        sum->rebuilt_triangles += worker->tally.rebuilt_triangles;
        sum->exact += worker->exact.queries;
    }
}

/* Bring the answer together, and what the workers did; the step began at `step_ns`, and
 * detection ended at `detect_ns`. */
static void merge(struct eng_team *team, struct eng_step_memory *memory, uint64_t step_ns,
                  uint64_t detect_ns, struct eng_step_result *result)
{
    struct eng_worker *worker = team->workers[0];
    uint64_t begin_ns = eng_now_ns();
    eng_answer_end(memory, team, result);
    eng_pool_reset(&memory->pool, team->count); /* ready for the next step */
    uint64_t end_ns = eng_now_ns();
    result->times.merge = end_ns - detect_ns;
    worker->record.merge_ns += end_ns - begin_ns;
    eng_worker_trace(worker, ENG_TRACE_MERGE, begin_ns, 0, 0);
    divide_time(team, &result->times);
    add_counters(team, &result->counters);
    uint64_t work_ns = 0;
    for (uint32_t i = 0; i < team->count; i++) {
        const struct eng_thread_record *record = &team->workers[i]->record;
        work_ns += record->refit_ns + record->low_ns + record->high_ns + record->merge_ns;
        memory->records[i] = *record;
    }
    if (result->incomplete == ENG_COMPLETE) {
        struct eng_effort *effort = &memory->effort[result->method];
        eng_effort_learn(effort, result->mode, work_ns);
        eng_effort_time(effort, result->mode, team->count > 1, end_ns - step_ns);
    }
    result->thread_records = memory->records;
    result->threads = team->count;
}

int eng_step(struct eng_scene *scene, const struct eng_step_settings *settings,
             struct eng_step_result *result)
{
    uint64_t begin_ns = eng_now_ns();
    uint64_t allocs = atomic_load(&eng_payer()->allocs);
    uint64_t builds = scene->builds;
    struct eng_stop stop;
    struct eng_team team;
    int status = ENG_E_INVAL;
    if (settings_are_valid(settings) && (!settings->brief || eng_brief_fits(settings))) {
        eng_stop_init(&stop, settings);
        status = prepare(scene, settings, &stop, &team);
    }
    if (status != ENG_OK) {
        eng_stage_abort(scene);
        return status;
    }
    bool is_owed = scene->is_owed && !scene->staging;
    /* Without the commit. */
    uint64_t staged_ns = scene->staging || is_owed ? scene->stage_ns : 0;
    status = is_owed ? ENG_OK : eng_stage_commit(scene);
    if (status != ENG_OK) {
        return status;
    }
    struct eng_step_result r = {.mode = settings->mode,
                                .method = eng_step_method(settings),
                                .verdict = ENG_VERDICT_NONE,
                                .record_bytes = team.workers[0]->found.record_bytes,
                                .toi_first = 2};
    r.times.ingest = scene->stage_ns;
    scene->step++;
    eng_frames_choose(scene, 1 - scene->now, scene->now);
    team.method->start(&team, settings);
    uint64_t detect_ns =
        team.count == 1 ? run_alone(&team, &r.times) : run_together(&team, &r.times);
    scene->is_owed = stop.gave_up;
    if (stop.gave_up) {
        return ENG_E_LONG;
    }
    assert(!PCCD_VALIDATE || r.method != ENG_METHOD_PAPER || eng_tree_validate(scene));
    r.incomplete =
        (enum eng_incomplete)atomic_load_explicit(&stop.reason, memory_order_relaxed);
    merge(&team, scene->memory, begin_ns, detect_ns, &r);
    eng_worker_trace(team.workers[0], ENG_TRACE_STEP, begin_ns, size_of(scene),
                     team.count);
    r.times.step = eng_now_ns() - begin_ns + staged_ns;
    team.method->end(&team, &r, r.times.step - staged_ns);
    r.counters.builds = scene->builds - builds;
    r.counters.allocs = atomic_load(&eng_payer()->allocs) - allocs;
    *result = r;
    return ENG_OK;
}

void eng_step_nothing(const struct eng_step_settings *settings,
                      struct eng_step_result *result)
{
    *result = (struct eng_step_result){.mode = settings->mode,
                                       .method = eng_step_method(settings),
                                       .incomplete = ENG_INCOMPLETE_DEADLINE,
                                       .verdict = ENG_VERDICT_NONE,
                                       .toi_first = 2};
    eng_answer_nothing(result);
}
