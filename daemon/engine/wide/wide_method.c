/* daemon/engine/wide/wide_method.c - the method wide, as a step sees it.
 *
 * Room:     engine.
 * Does:     keep the wide trees. For stealing, a task is a pair of nodes of one level, of
 *           vertices and faces or of edges; a node with itself stands for all pairs of
 *           edges below it. Tasks are divided down to nodes of 256 features.
 * Threads:  method.h.
 *
 * Trees do not change while they are searched, so any task may go to any thread. A worker
 * divides depth first, and what finds no room in its deque is done at once.
 */
#include "method.h"
#include "step_memory.h"
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

static void perform(struct eng_worker *worker, uint64_t task)
{
    const uint32_t node_mask = (1u << 29) - 1;
    enum eng_kind kind = (enum eng_kind)(task >> 63);
    uint32_t level = task >> 58 & 31;
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
            if (!eng_deque_push(&worker->deque,
                                task_of(kind, level - 1, below->a[i], below->b[i]))) {
                eng_wide_join_nodes(join, kind, level - 1, below->a[i], below->b[i]);
            }
        }
        below->count = 0;
    }
    eng_worker_trace(worker, ENG_TRACE_UNIT, begin_ns, n, m);
}

static uint32_t top_level(const struct eng_worker *worker)
{
    return worker->scene->wide.level_count - 1;
}

static void push_first(struct eng_worker *worker)
{
    uint32_t top = top_level(worker);
    eng_deque_push(&worker->deque, task_of(ENG_VF, top, 0, 0));
    eng_deque_push(&worker->deque, task_of(ENG_EE, top, 0, 0));
}

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
    struct eng_scene *scene = team->scene;
    int status = ENG_OK;
    (void)settings;
    if (scene->wide.is_stale) {
        status = eng_wide_assemble(&scene->wide, scene);
    }
    for (uint32_t i = 0; i < team->count && status == ENG_OK; i++) {
        status = eng_wide_work_reserve(scene->memory->workers[i]);
    }
    return status;
}

static void start(struct eng_team *team, const struct eng_step_settings *settings)
{
    (void)team;
    (void)settings;
}

static void refit(struct eng_scene *scene)
{
    eng_wide_refit(&scene->wide, scene, false);
}

static void no_more(struct eng_worker *worker)
{
    (void)worker;
}

const struct eng_method_calls eng_method_wide = {.prepare = prepare,
                                                 .start = start,
                                                 .refit = refit,
                                                 .refit_by_team = eng_wide_refit_by_team,
                                                 .ready = no_more,
                                                 .beside = no_more,
                                                 .enter = eng_wide_work_begin,
                                                 .leave = eng_wide_work_end,
                                                 .perform_all = perform_all,
                                                 .push_first = push_first,
                                                 .perform = perform,
                                                 .flush = flush};
