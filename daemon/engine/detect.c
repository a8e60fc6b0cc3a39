/* detect.c - the search of a team through the trees of a method.
 *
 * Source: paper sections 4 to 6.
 */
#include "detect.h"

#include <assert.h>
#include <omp.h>

#include "affinity.h"
#include "answer.h"
#include "bodies.h"
#include "clock.h"
#include "method.h"
#include "moving.h"
#include "names.h"
#include "narrow.h"
#include "parallel.h"
#include "rigid.h"
#include "wait.h"
#include "wide_crowded.h"

/* Leaves of the scene, 2^32 - 1 if there are more. */
uint32_t eng_detect_size(const struct eng_scene *scene)
{
    return scene->leaf_count < UINT32_MAX ? (uint32_t)scene->leaf_count : UINT32_MAX;
}

static uint32_t threads_for(const struct eng_scene *scene,
                            const struct eng_question *question,
                            struct eng_effort *effort)
{
    if (question->threads == 1 || question->brief || scene->object_count == 0) {
        return 1;
    }
    if (!question->team_always &&
        !eng_effort_pays(effort, question->mode, eng_detect_size(scene))) {
        return 1;
    }
    return question->threads < ENG_THREADS_MAX ? question->threads : ENG_THREADS_MAX;
}

int eng_detect_prepare(struct eng_scene *scene, const struct eng_question *question,
                       struct eng_effort *effort, struct eng_records *out,
                       struct eng_stop *stop, struct eng_team *team)
{
    struct eng_step_memory *memory = eng_step_memory_of(scene);
    team->scene = scene;
    team->prunes = false;
    team->has_boxes = false;
    team->search = NULL;
    team->after = NULL;
    team->method = eng_methods[eng_method_of(question)];
    if (team->method->is_stale(scene)) {
        eng_effort_forget(effort);
    }
    team->count = threads_for(scene, question, effort);
    eng_rigid_prepare(scene);
    eng_refit_begin(team);
    int status = eng_step_memory_reserve(memory, team->count,
                                         eng_asks_near(question) ? &memory->near.threads
                                                                 : &memory->threads);
    team->workers = memory->workers;
    if (status == PCCD_OK) {
        status = team->method->prepare(team, question);
    }
    if (status != PCCD_OK) {
        return status;
    }
    for (uint32_t i = 0; i < team->count && !common_near_is_of_objects(question->verb);
         i++) {
        status = eng_narrow_reserve(memory->workers[i], scene, question);
        if (status != PCCD_OK) {
            return status;
        }
    }
    eng_pool_reset(memory->pool, team->count);
    eng_pool_lend(memory->pool, question->scratch_memory, question->scratch_bytes);
    for (uint32_t i = 0; i < team->count; i++) {
        eng_worker_begin(memory->workers[i], scene, question, stop, memory->pool);
        memory->workers[i]->thread = i;
        eng_narrow_begin(memory->workers[i]);
    }
    return eng_answer_begin(memory, team, out);
}

/* Do what goes on beside the traversal, by one thread. A brief step has no time for more
 * than itself. */
static void beside(struct eng_team *team, struct eng_worker *worker)
{
    if (eng_asks_near(worker->question)) {
        return;
    }
    team->method->beside(worker);
    if (worker->question->brief || eng_stop_is_set(worker->stop)) {
        return;
    }
    uint64_t begin_ns = common_now_ns();
    eng_wide_crowded_share(team->scene);
    eng_bodies_share(team->scene);
    worker->record.low_ns += common_now_ns() - begin_ns;
}

/* All tasks by one thread, or what takes their place. */
static void perform_alone(struct eng_team *team, struct eng_worker *worker)
{
    if (team->search) {
        team->search(team, worker);
        return;
    }
    team->method->ready(worker);
    team->method->enter(worker);
    if (!eng_worker_should_stop(worker)) {
        team->method->perform_all(worker);
    }
    team->method->leave(worker);
    beside(team, worker);
    if (team->after) {
        team->after(team, worker);
    }
}

/* Refit and detection by one thread; returns when they ended. */
static uint64_t run_alone(struct eng_team *team, struct pccd_step_times *times)
{
    assert(team->count == 1);
    const struct eng_method_calls *method = team->method;
    struct eng_worker *worker = team->workers[0];
    uint64_t begin_ns = common_now_ns();
    if (!team->has_boxes) {
        method->refit(worker);
    }
    uint64_t refit_ns = common_now_ns();
    eng_worker_trace(worker, PCCD_TRACE_REFIT, begin_ns, eng_moving_count(worker->scene),
                     0);
    times->refit = refit_ns - begin_ns;
    worker->record.refit_ns = times->refit;
    perform_alone(team, worker);
    uint64_t end_ns = common_now_ns();
    times->low = end_ns - refit_ns;
    worker->record.low_ns = times->low;
    return end_ns;
}

/* Do what follows the refit, by the thread that ended it: a part of its time with
 * low-level nodes, as what is rebuilt here is. */
static void begin_tasks(struct eng_team *team, struct eng_worker *worker, bool by_paper)
{
    team->count = (uint32_t)omp_get_num_threads();
    team->refit_end_ns = common_now_ns();
    if (!team->search) {
        team->method->enter(worker);
        team->method->ready(worker);
        if (by_paper) {
            team->method->assign(team, worker);
        } else {
            eng_schedule_steal_begin(team, worker);
        }
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

/* A thread's part of the search; `has_begun`: it has begun the tasks. */
static void perform(struct eng_team *team, struct eng_worker *worker, bool has_begun,
                    bool by_paper)
{
    if (team->search) {
        team->search(team, worker);
        return;
    }
    if (!has_begun) {
        team->method->enter(worker);
    }
    if (worker->thread == team->count - 1) {
        beside(team, worker);
    }
    if (by_paper) {
        team->method->perform_assigned(team, worker);
    } else {
        eng_schedule_steal(team, worker);
    }
    team->method->leave(worker);
    if (team->after) {
        team->after(team, worker);
    }
}

/* The boxes are there, or all make them: true for one thread, which sees every box. */
static bool make_boxes(struct eng_team *team, struct eng_worker *worker)
{
    return team->has_boxes ? worker->thread == 0
                           : team->method->refit_by_team(team, worker);
}

/* The same by a team, which goes on to merge what it found. Its size may turn out smaller
 * than asked for: the refit asks the runtime; everything after it, the team. */
static uint64_t run_together(struct eng_team *team, struct pccd_step_times *times)
{
    assert(team->count > 1 && team->count <= ENG_THREADS_MAX);
    uint64_t begin_ns = common_now_ns();
    bool by_paper = team->method->assign &&
                    team->workers[0]->question->tuning.scheduler == ENG_SCHEDULER_PAPER;
    struct eng_parallel region = eng_parallel_open();
#pragma omp parallel num_threads((int)team->count)
    {
        ENG_PARALLEL_JOIN(region);
        struct eng_worker *worker = team->workers[omp_get_thread_num()];
        eng_affinity_bind_thread(worker->question->affinity, worker->thread,
                                 (uint32_t)omp_get_num_threads());
        bool is_last = make_boxes(team, worker);
        if (is_last) {
            begin_tasks(team, worker, by_paper);
        }
        eng_refit_await(team, worker);
        eng_wait_return(worker, team->count);
        perform(team, worker, is_last, by_paper);
        eng_answer_by_team(eng_step_memory_of(team->scene), team, worker);
        eng_wait_for_all(worker); /* the runtime's barrier would lend nobody anything */
    }
    eng_parallel_close();
    uint64_t merge_ns = eng_step_memory_of(team->scene)->merge->begin_ns;
    uint64_t end_ns = merge_ns > 0 ? merge_ns : common_now_ns();
    uint64_t low_end_ns = low_end_of(team, end_ns);
    times->refit = team->refit_end_ns - begin_ns;
    times->low = low_end_ns - team->refit_end_ns;
    times->high = end_ns - low_end_ns;
    return end_ns;
}

uint64_t eng_detect_run(struct eng_team *team, struct pccd_step_times *times)
{
    return team->count == 1 ? run_alone(team, times) : run_together(team, times);
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
        for (uint32_t kind = 0; kind < PCCD_KINDS_MAX; kind++) {
            sum->candidates[kind] += worker->tally.candidates[kind];
        }
        sum->survivors += worker->tally.survivors;
        sum->rebuilt_triangles += worker->tally.rebuilt_triangles;
        sum->still_features += worker->tally.still_features;
        sum->still_pairs += worker->tally.still_pairs;
        sum->exact += worker->exact.queries;
    }
}

void eng_detect_count_thick(const struct eng_team *team, struct eng_thick_counters *sum)
{
    for (uint32_t i = 0; i < team->count && team->scene->thickness.is_on; i++) {
        const struct eng_narrow *narrow = eng_narrow_of(team->workers[i]);
        sum->candidates += narrow->thick->candidates;
        sum->survivors += narrow->thick->survivors;
        sum->exact += narrow->batch.integers;
    }
}

uint64_t eng_detect_count(struct eng_team *team, struct eng_thread_record *records,
                          struct pccd_step_times *times,
                          struct pccd_step_counters *counters)
{
    uint64_t work_ns = 0;
    divide_time(team, times);
    add_counters(team, counters);
    for (uint32_t i = 0; i < team->count; i++) {
        const struct eng_thread_record *record = &team->workers[i]->record;
        work_ns += record->refit_ns + record->low_ns + record->high_ns + record->merge_ns;
        records[i] = *record;
    }
    return work_ns;
}
