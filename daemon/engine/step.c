/* daemon/engine/step.c - one step of a scene.
 *
 * Room:     engine.
 * Does:     put the phases in order, divide them among threads, time them.
 * Threads:  [compute]; it opens one parallel region per step.
 * Source:   paper sections 4 to 6.
 */
#include "step.h"

#include <assert.h>
#include <omp.h>

#include "affinity.h"
#include "answer.h"
#include "brief.h"
#include "clock.h"
#include "frames.h"
#include "memory.h"
#include "methods.h"
#include "moving.h"
#include "rigid.h"
#include "schedule_paper.h"
#include "schedule_steal.h"
#include "stage.h"
#include "step_memory.h"
#include "wait.h"

static bool settings_are_valid(const struct eng_step_settings *settings)
{
    return settings->mode < PCCD_MODE_COUNT && settings->method < PCCD_METHOD_COUNT &&
           settings->threads >= 1 && settings->tuning.scheduler < ENG_SCHEDULER_COUNT &&
           settings->tuning.high_level < ENG_HIGH_LEVEL_COUNT &&
           settings->tuning.refit < ENG_REFIT_COUNT &&
           settings->tuning.still < ENG_STILL_COUNT && settings->tolerance >= 1e-12 &&
           settings->tolerance <= 1;
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
        !eng_effort_pays(&eng_step_memory_of(scene)->effort[eng_method_of(settings)],
                         settings->mode, size_of(scene))) {
        return 1;
    }
    return settings->threads < ENG_THREADS_MAX ? settings->threads : ENG_THREADS_MAX;
}

/* Everything that can fail for want of memory, before anything moves. */
static int prepare(struct eng_scene *scene, const struct eng_step_settings *settings,
                   struct eng_stop *stop, struct eng_team *team)
{
    struct eng_step_memory *memory = eng_step_memory_of(scene);
    enum pccd_method method = eng_method_of(settings);
    team->scene = scene;
    team->prunes = false;
    team->method = eng_methods[method];
    if (team->method->is_stale(scene)) {
        eng_effort_forget(&memory->effort[method]);
    }
    team->count = threads_for(scene, settings);
    eng_rigid_prepare(scene);
    eng_refit_begin(team);
    int status = eng_step_memory_reserve(memory, team->count);
    team->workers = memory->workers;
    if (status == PCCD_OK && settings->tuning.scheduler == ENG_SCHEDULER_PAPER) {
        status = eng_schedule_paper_reserve(scene, team->count);
    }
    if (status == PCCD_OK) {
        status = team->method->prepare(team, settings);
    }
    if (status != PCCD_OK) {
        return status;
    }
    eng_pool_reset(&memory->pool, team->count);
    for (uint32_t i = 0; i < team->count; i++) {
        eng_worker_begin(memory->workers[i], scene, settings, stop, &memory->pool);
        memory->workers[i]->thread = i;
    }
    return eng_answer_begin(memory, team);
}

/* What is left of the work where most stands still is for one thread, as a rule. */
static void make_single(struct eng_step_memory *memory, struct eng_team *team,
                        const struct eng_step_settings *settings, struct eng_stop *stop)
{
    team->count = 1;
    eng_pool_reset(&memory->pool, 1);
    eng_worker_begin(memory->workers[0], team->scene, settings, stop, &memory->pool);
    int status = eng_answer_begin(memory, team);
    assert(status == PCCD_OK); /* it had room for more */
    (void)status;
}

/* How much of the scene moves, 0 .. 1. */
static double moving_part(const struct eng_scene *scene)
{
    const struct eng_moving *moving = &scene->moving;
    assert(moving->vertices <= moving->all);
    return moving->all > 0 ? (double)moving->vertices / (double)moving->all : 0;
}

/* The positions have moved on: keep what the last answer says of what stands still. */
static void keep_what_stands(struct eng_team *team,
                             const struct eng_step_settings *settings,
                             struct eng_stop *stop)
{
    const struct eng_scene *scene = team->scene;
    struct eng_step_memory *memory = eng_step_memory_of(scene);
    const struct eng_effort *effort = &memory->effort[eng_method_of(settings)];
    team->prunes = team->method->can_prune &&
                   eng_kept_begin(&memory->kept, scene, settings, &memory->sorted);
    if (!team->prunes) {
        return;
    }
    if (team->count > 1 && !settings->team_always &&
        !eng_effort_pays_for(effort, settings->mode, moving_part(scene))) {
        make_single(memory, team, settings, stop);
    }
    for (uint32_t i = 0; i < team->count; i++) {
        memory->workers[i]->prunes = true;
    }
    eng_answer_keep(memory, team);
}

/* What goes on beside the traversal, by one thread. A brief step has no time for more
 * than itself. */
static void beside(struct eng_team *team, struct eng_worker *worker)
{
    team->method->beside(worker);
    if (worker->settings->brief || eng_stop_is_set(worker->stop)) {
        return;
    }
    uint64_t begin_ns = common_now_ns();
    eng_rigid_share(team->scene);
    worker->record.low_ns += common_now_ns() - begin_ns;
}

/* Refit and detection by one thread; returns when they ended. */
static uint64_t run_alone(struct eng_team *team, struct pccd_step_times *times)
{
    assert(team->count == 1);
    const struct eng_method_calls *method = team->method;
    struct eng_worker *worker = team->workers[0];
    uint64_t begin_ns = common_now_ns();
    method->refit(worker);
    uint64_t refit_ns = common_now_ns();
    eng_worker_trace(worker, PCCD_TRACE_REFIT, begin_ns, eng_moving_count(worker->scene),
                     0);
    times->refit = refit_ns - begin_ns;
    worker->record.refit_ns = times->refit;
    method->ready(worker);
    method->enter(worker);
    if (!eng_worker_should_stop(worker)) {
        method->perform_all(worker);
    }
    method->leave(worker);
    beside(team, worker);
    uint64_t end_ns = common_now_ns();
    times->low = end_ns - refit_ns;
    worker->record.low_ns = times->low;
    return end_ns;
}

/* What follows the refit, by the thread that ended it: a part of its time with low-level
 * nodes, as what is rebuilt here is. */
static void begin_tasks(struct eng_team *team, struct eng_worker *worker, bool by_paper)
{
    team->count = (uint32_t)omp_get_num_threads();
    team->refit_end_ns = common_now_ns();
    team->method->ready(worker);
    if (by_paper) {
        eng_schedule_paper_begin(team, worker);
    } else {
        eng_schedule_steal_begin(team, worker);
    }
    worker->record.low_ns += common_now_ns() - team->refit_end_ns;
    eng_refit_release(team);
}

/* Low-level nodes are done when the first thread knows: none has begun with high-level
 * ones before, and all have ended with these. `end_ns` where there are none. */
static uint64_t low_end_of(const struct eng_team *team, uint64_t end_ns)
{
    assert(end_ns >= team->refit_end_ns);
    uint64_t low_end_ns = end_ns;
    for (uint32_t i = 0; i < team->count; i++) {
        uint64_t known_ns = team->workers[i]->low_end_ns;
        low_end_ns = known_ns > 0 && known_ns < low_end_ns ? known_ns : low_end_ns;
    }
    return low_end_ns;
}

/* The same by a team, which goes on to merge what it found. Its size may turn out smaller
 * than asked for: the refit asks the runtime; everything after it, the team. */
static uint64_t run_together(struct eng_team *team, struct pccd_step_times *times)
{
    assert(team->count > 1 && team->count <= ENG_THREADS_MAX);
    const struct eng_method_calls *method = team->method;
    uint64_t begin_ns = common_now_ns();
    bool by_paper = team->workers[0]->settings->tuning.scheduler == ENG_SCHEDULER_PAPER;
    struct eng_payer *payer = eng_payer();
#pragma omp parallel num_threads((int)team->count)
    {
        eng_payer_join(payer);
        struct eng_worker *worker = team->workers[omp_get_thread_num()];
        eng_affinity_bind_thread(worker->settings->affinity, worker->thread,
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
            beside(team, worker);
        }
        if (by_paper) {
            eng_schedule_paper(team, worker);
        } else {
            eng_schedule_steal(team, worker);
        }
        method->leave(worker);
        eng_answer_by_team(eng_step_memory_of(team->scene), team, worker);
        eng_wait_for_all(worker); /* the runtime's barrier would lend nobody anything */
    }
    uint64_t merge_ns = eng_step_memory_of(team->scene)->merge.begin_ns;
    uint64_t end_ns = merge_ns > 0 ? merge_ns : common_now_ns();
    uint64_t low_end_ns = low_end_of(team, end_ns);
    times->refit = team->refit_end_ns - begin_ns;
    times->low = low_end_ns - team->refit_end_ns;
    times->high = end_ns - low_end_ns;
    return end_ns;
}

/* Wall time of detection, divided into traversal and tests as the threads' time is. */
static void divide_time(const struct eng_team *team, struct pccd_step_times *times)
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

static void add_counters(const struct eng_team *team, struct pccd_step_counters *sum)
{
    for (uint32_t i = 0; i < team->count; i++) {
        const struct eng_worker *worker = team->workers[i];
        sum->task_units += worker->record.task_units;
        sum->box_tests += worker->record.box_tests;
        sum->rebuilds += worker->record.rebuilds;
        sum->leaf_pairs += worker->tally.leaf_pairs;
        for (uint32_t kind = 0; kind < PCCD_KIND_COUNT; kind++) {
            sum->candidates[kind] += worker->tally.candidates[kind];
        }
        sum->survivors += worker->tally.survivors;
        sum->rebuilt_triangles += worker->tally.rebuilt_triangles;
        sum->still_features += worker->tally.still_features;
        sum->still_pairs += worker->tally.still_pairs;
        sum->exact += worker->exact.queries;
    }
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
    eng_pool_reset(&memory->pool, team->count); /* ready for the next step */
    uint64_t end_ns = common_now_ns();
    result->times.merge = end_ns - detect_ns;
    worker->record.merge_ns += end_ns - begin_ns;
    eng_worker_trace(worker, PCCD_TRACE_MERGE, begin_ns,
                     (uint32_t)result->counters.kept_records, 0);
    divide_time(team, &result->times);
    add_counters(team, &result->counters);
    result->counters.rigid_objects = team->scene->rigid.objects;
    uint64_t work_ns = 0;
    for (uint32_t i = 0; i < team->count; i++) {
        const struct eng_thread_record *record = &team->workers[i]->record;
        work_ns += record->refit_ns + record->low_ns + record->high_ns + record->merge_ns;
        memory->records[i] = *record;
    }
    struct eng_effort *effort = &memory->effort[result->method];
    if (result->incomplete == PCCD_COMPLETE && team->prunes) {
        eng_effort_learn_part(effort, result->mode, moving_part(team->scene), work_ns);
    } else if (result->incomplete == PCCD_COMPLETE) {
        eng_effort_learn(effort, result->mode, work_ns);
        eng_effort_time(effort, result->mode, team->count > 1, end_ns - step_ns);
    }
    result->thread_records = memory->records;
    result->threads = team->count;
}

int eng_step(struct eng_scene *scene, const struct eng_step_settings *settings,
             struct eng_step_result *result)
{
    assert(scene && settings && result);
    uint64_t begin_ns = common_now_ns();
    uint64_t allocs = atomic_load(&eng_payer()->allocs);
    uint64_t builds = scene->builds;
    struct eng_stop stop;
    struct eng_team team;
    int status = PCCD_E_INVAL;
    if (settings_are_valid(settings) && (!settings->brief || eng_brief_fits(settings))) {
        eng_stop_init(&stop, settings);
        status = prepare(scene, settings, &stop, &team);
    }
    if (status != PCCD_OK) {
        eng_stage_abort(scene);
        return status;
    }
    bool is_owed = scene->is_owed && !scene->staging;
    /* Without the commit. */
    uint64_t staged_ns = scene->staging || is_owed ? scene->stage_ns : 0;
    status = is_owed ? PCCD_OK : eng_stage_commit(scene);
    if (status != PCCD_OK) {
        return status;
    }
    struct eng_step_result r = {.mode = settings->mode,
                                .method = eng_method_of(settings),
                                .verdict = PCCD_VERDICT_NONE,
                                .record_bytes = team.workers[0]->found.record_bytes,
                                .toi_first = 2};
    r.times.ingest = scene->stage_ns;
    scene->step++;
    keep_what_stands(&team, settings, &stop);
    eng_frames_follow(scene);
    eng_rigid_choose(scene, settings->mode != PCCD_MODE_PAIRS);
    team.method->start(&team, settings);
    uint64_t detect_ns =
        team.count == 1 ? run_alone(&team, &r.times) : run_together(&team, &r.times);
    scene->is_owed = stop.gave_up;
    if (stop.gave_up) {
        return PCCD_E_AGAIN;
    }
    assert(!PCCD_VALIDATE || !team.method->validate || team.method->validate(scene));
    r.incomplete =
        (enum pccd_incomplete)atomic_load_explicit(&stop.reason, memory_order_relaxed);
    merge(&team, eng_step_memory_of(scene), begin_ns, detect_ns, &r);
    eng_worker_trace(team.workers[0], PCCD_TRACE_STEP, begin_ns, size_of(scene),
                     team.count);
    r.times.step = common_now_ns() - begin_ns + staged_ns;
    team.method->end(&team, &r, r.times.step - staged_ns);
    r.counters.builds = scene->builds - builds;
    r.counters.allocs = atomic_load(&eng_payer()->allocs) - allocs;
    *result = r;
    return PCCD_OK;
}

void eng_step_nothing(const struct eng_step_settings *settings,
                      struct eng_step_result *result)
{
    assert(settings && result);
    *result = (struct eng_step_result){.mode = settings->mode,
                                       .method = eng_method_of(settings),
                                       .incomplete = PCCD_INCOMPLETE_DEADLINE,
                                       .verdict = PCCD_VERDICT_NONE,
                                       .toi_first = 2};
    eng_answer_nothing(result);
}
