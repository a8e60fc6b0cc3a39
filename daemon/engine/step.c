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
#include "build.h"
#include "clock.h"
#include "memory.h"
#include "refit.h"
#include "schedule.h"
#include "stage.h"
#include "step_memory.h"

/* Triangles below which a step runs on the compute thread alone: waking a team costs 40
 * to 70 us, what this many triangles take is about as long. */
#define SERIAL_TRIANGLES_MAX 1000u

/* Subtrees to refit for each thread: the paper takes two and measures a factor of four on
 * eight threads; more and smaller ones end closer together. */
#define SUBTREES_PER_THREAD 8u

static bool settings_are_valid(const struct eng_step_settings *settings)
{
    return settings->mode >= ENG_MODE_ALL && settings->mode <= ENG_MODE_PAIRS &&
           settings->method >= ENG_METHOD_DEFAULT &&
           settings->method <= ENG_METHOD_PAPER && settings->threads >= 1 &&
           settings->scheduler >= ENG_SCHEDULER_STEAL &&
           settings->scheduler <= ENG_SCHEDULER_PAPER && settings->tolerance >= 1e-12 &&
           settings->tolerance <= 1;
}

static uint32_t threads_for(const struct eng_scene *scene,
                            const struct eng_step_settings *settings)
{
    if (scene->root == ENG_NO_NODE ||
        scene->nodes[scene->root].count < SERIAL_TRIANGLES_MAX) {
        return 1;
    }
    return settings->threads < ENG_THREADS_MAX ? settings->threads : ENG_THREADS_MAX;
}

/* Everything that can fail for want of memory, before anything moves. */
static int prepare(struct eng_scene *scene, const struct eng_step_settings *settings,
                   struct eng_stop *stop, struct eng_team *team)
{
    struct eng_step_memory *memory = scene->memory;
    int status = scene->top_is_stale ? eng_build_top(scene) : ENG_OK;
    team->scene = scene;
    team->workers = memory->workers;
    team->count = threads_for(scene, settings);
    team->plan = &memory->plan;
    team->assignment = &memory->assignment;
    atomic_init(&team->next_subtree, 0);
    if (status == ENG_OK) {
        status = eng_step_memory_reserve(memory, team->count);
    }
    if (status == ENG_OK) {
        status = eng_refit_plan(&memory->plan, scene, SUBTREES_PER_THREAD * team->count);
    }
    if (status == ENG_OK && settings->scheduler == ENG_SCHEDULER_PAPER) {
        status = eng_assignment_reserve(&memory->assignment, team->count);
    }
    eng_pool_reset(&memory->pool, team->count);
    for (uint32_t i = 0; i < team->count && status == ENG_OK; i++) {
        status =
            eng_worker_begin(memory->workers[i], scene, settings, stop, &memory->pool);
        memory->workers[i]->thread = i;
    }
    return status;
}

/* Refit and detection by one thread. */
static void run_alone(struct eng_team *team, struct eng_step_result *result)
{
    uint64_t begin_ns = eng_now_ns();
    eng_refit(team->scene);
    uint64_t refit_ns = eng_now_ns();
    result->times.refit = refit_ns - begin_ns;
    eng_schedule_serial(team, team->workers[0]);
    team->workers[0]->busy_ns = eng_now_ns() - refit_ns;
}

/* The same by a team. Its size may turn out smaller than asked for: a share of work
 * belongs to each thread that is there, so the team's count is set before anything is
 * divided. */
static void run_together(struct eng_team *team, struct eng_step_result *result)
{
    uint64_t begin_ns = eng_now_ns();
    uint64_t refit_ns = 0;
    bool by_paper = team->workers[0]->settings->scheduler == ENG_SCHEDULER_PAPER;
#pragma omp parallel num_threads((int)team->count)
    {
#pragma omp single
        {
            team->count = (uint32_t)omp_get_num_threads();
            if (by_paper) {
                eng_schedule_paper_begin(team);
            } else {
                eng_schedule_steal_begin(team);
            }
        }
        eng_refit_by_team(team);
        uint32_t thread = (uint32_t)omp_get_thread_num();
        if (thread == 0) {
            refit_ns = eng_now_ns();
        }
        if (by_paper) {
            eng_schedule_paper(team, team->workers[thread]);
        } else {
            eng_schedule_steal(team, team->workers[thread]);
        }
    }
    result->times.refit = refit_ns - begin_ns;
}

/* Wall time of detection, divided into traversal and tests as the threads' time is. */
static void divide_time(const struct eng_team *team, uint64_t wall_ns,
                        struct eng_step_times *times)
{
    double busy_ns = 1;
    double tests_ns = 0;
    for (uint32_t i = 0; i < team->count; i++) {
        busy_ns += (double)team->workers[i]->busy_ns;
        tests_ns += (double)team->workers[i]->tests_ns;
    }
    times->tests = (uint64_t)((double)wall_ns * (tests_ns / busy_ns));
    times->tests = times->tests < wall_ns ? times->tests : wall_ns;
    times->traversal = wall_ns - times->tests;
}

static void add_counters(const struct eng_team *team, struct eng_step_counters *sum)
{
    for (uint32_t i = 0; i < team->count; i++) {
        const struct eng_worker *worker = team->workers[i];
        sum->task_units += worker->counters.task_units;
        sum->box_tests += worker->counters.box_tests;
        sum->leaf_pairs += worker->counters.leaf_pairs;
        sum->candidates_vf += worker->counters.candidates_vf;
        sum->candidates_ee += worker->counters.candidates_ee;
        sum->survivors += worker->counters.survivors;
        sum->exact += worker->exact.queries;
    }
}

int eng_step(struct eng_scene *scene, const struct eng_step_settings *settings,
             struct eng_step_result *result)
{
    uint64_t begin_ns = eng_now_ns();
    uint64_t allocs = eng_alloc_count();
    uint64_t builds = scene->builds;
    struct eng_stop stop;
    struct eng_team team;
    int status = ENG_E_INVAL;
    if (settings_are_valid(settings)) {
        eng_stop_init(&stop, settings);
        status = prepare(scene, settings, &stop, &team);
    }
    if (status != ENG_OK) {
        eng_stage_abort(scene);
        return status;
    }
    status = eng_stage_commit(scene);
    if (status != ENG_OK) {
        return status;
    }
    struct eng_step_result r = {.mode = settings->mode,
                                .method = ENG_METHOD_PAPER,
                                .verdict = ENG_VERDICT_NONE,
                                .record_bytes = team.workers[0]->found.record_bytes,
                                .toi_first = 2};
    r.times.ingest = scene->stage_ns;
    uint64_t detect_ns = eng_now_ns();
    if (team.count == 1) {
        run_alone(&team, &r);
    } else {
        run_together(&team, &r);
    }
#ifdef PCCD_VALIDATE
    assert(eng_tree_validate(scene));
#endif
    uint64_t merge_ns = eng_now_ns();
    divide_time(&team, merge_ns - detect_ns - r.times.refit, &r.times);
    add_counters(&team, &r.counters);
    r.threads = team.count;
    r.incomplete =
        (enum eng_incomplete)atomic_load_explicit(&stop.reason, memory_order_relaxed);
    eng_answer(scene->memory, &team, &r);
    eng_pool_reset(&scene->memory->pool, team.count); /* ready for the next step */
    r.times.merge = eng_now_ns() - merge_ns;
    r.times.step = eng_now_ns() - begin_ns + scene->stage_ns;
    r.counters.builds = scene->builds - builds;
    r.counters.allocs = eng_alloc_count() - allocs;
    *result = r;
    return ENG_OK;
}
