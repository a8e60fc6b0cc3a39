/* daemon/engine/schedule/schedule_steal.c - work stealing over task units and pairs.
 *
 * Room:     engine.
 * Does:     a task is a node (its self-CD task unit and those below it) or a pair of
 *           nodes. Large tasks are split and the parts pushed to the worker's own deque;
 *           small ones are worked through at once. A worker without tasks takes the
 *           oldest of another.
 * Threads:  [team].
 *
 * Any pair may go to any thread because gates guard what reconstruction changes
 * (rebuild.h). A worker splits depth first, so its deque holds at most three siblings for
 * each level of a pair and two for each level of a node; with ENG_LEVELS_MAX levels of
 * either that is less than half of its capacity.
 */
#include "schedule.h"

#include <sched.h>

#include "rebuild.h"
#include "taskunit.h"

static uint64_t task_of(uint32_t n, uint32_t m)
{
    return (uint64_t)n << 32 | m;
}

static void push(struct eng_team *team, struct eng_worker *worker, uint32_t n, uint32_t m)
{
    /* Relaxed: the pushing task is itself still open, so the count cannot reach zero
     * meanwhile. */
    atomic_fetch_add_explicit(&team->open_tasks, 1, memory_order_relaxed);
    bool pushed = eng_deque_push(&worker->deque, task_of(n, m));
    assert(pushed);
    (void)pushed;
}

void eng_schedule_steal_begin(struct eng_team *team)
{
    atomic_init(&team->open_tasks, 0);
    if (team->scene->root != ENG_NO_NODE) {
        push(team, team->workers[0], team->scene->root, team->scene->root);
    }
}

/* All task units of a small subtree. */
static void perform_subtree(struct eng_worker *worker, uint32_t node)
{
    struct eng_task_queue *units = &worker->units;
    uint64_t begin_ns = eng_worker_slice(worker);
    eng_taskunit_perform(worker, node, true);
    while (units->head != units->tail && !eng_stop_is_set(worker->stop)) {
        uint32_t next = units->nodes[units->head++ & (units->capacity - 1)];
        eng_taskunit_perform(worker, next, true);
    }
    units->head = units->tail;
    eng_worker_trace(worker, ENG_TRACE_SUBTREE, begin_ns, node,
                     worker->scene->nodes[node].count);
}

static void perform_unit(struct eng_team *team, struct eng_worker *worker, uint32_t n)
{
    if (team->scene->nodes[n].count <= ENG_STEAL_UNIT_GRAIN) {
        perform_subtree(worker, n);
        return;
    }
    uint64_t begin_ns = eng_worker_slice(worker);
    const struct eng_node *node = eng_node_open(worker, n);
    worker->record.task_units++;
    push(team, worker, node->left, node->left);
    push(team, worker, node->right, node->right);
    push(team, worker, node->left, node->right);
    eng_worker_trace(worker, ENG_TRACE_UNIT, begin_ns, n, node->count);
}

static void perform_pair(struct eng_team *team, struct eng_worker *worker, uint32_t n,
                         uint32_t m)
{
    const struct eng_node *nodes = team->scene->nodes;
    uint64_t begin_ns = eng_worker_slice(worker);
    if ((uint64_t)nodes[n].count + nodes[m].count <= ENG_STEAL_PAIR_GRAIN) {
        eng_taskunit_pairs(worker, n, m);
    } else {
        uint32_t n_out[4];
        uint32_t m_out[4];
        uint32_t count = eng_taskunit_refine(worker, n, m, n_out, m_out);
        for (uint32_t i = 0; i < count; i++) {
            push(team, worker, n_out[i], m_out[i]);
        }
    }
    eng_worker_trace(worker, ENG_TRACE_PAIRS, begin_ns, n, m);
}

static void perform(struct eng_team *team, struct eng_worker *worker, uint64_t task)
{
    uint32_t n = (uint32_t)(task >> 32);
    uint32_t m = (uint32_t)task;
    if (!eng_worker_should_stop(worker)) {
        if (n == m) {
            perform_unit(team, worker, n);
        } else {
            perform_pair(team, worker, n, m);
        }
    }
    /* Release, and acquire for whoever sees zero: what the task wrote is then visible. */
    atomic_fetch_sub_explicit(&team->open_tasks, 1, memory_order_acq_rel);
}

/* One round over the other workers, starting behind the own place. */
static bool steal(struct eng_team *team, struct eng_worker *worker, uint64_t *task)
{
    worker->record.requests++;
    for (uint32_t i = 1; i < team->count; i++) {
        struct eng_worker *victim = team->workers[(worker->thread + i) % team->count];
        if (eng_deque_steal(&victim->deque, task)) {
            worker->record.steals++;
            return true;
        }
    }
    return false;
}

/* A task of another worker; false: all are finished. */
static bool search(struct eng_team *team, struct eng_worker *worker, uint64_t *task)
{
    uint64_t begin_ns = eng_now_ns();
    uint32_t failed_rounds = 0;
    bool found = false;
    while (!found && atomic_load_explicit(&team->open_tasks, memory_order_acquire) > 0) {
        found = steal(team, worker, task);
        if (!found && ++failed_rounds % ENG_STEAL_ROUNDS == 0) {
            worker->record.sleeps++;
            sched_yield();
        }
    }
    eng_worker_waited(worker, begin_ns);
    return found;
}

void eng_schedule_steal(struct eng_team *team, struct eng_worker *worker)
{
    uint64_t begin_ns = eng_now_ns();
    uint64_t waited_ns = worker->record.wait_ns;
    uint64_t task;
    while (eng_deque_pop(&worker->deque, &task) || search(team, worker, &task)) {
        perform(team, worker, task);
    }
    eng_taskunit_flush(worker);
    worker->record.low_ns +=
        eng_now_ns() - begin_ns - (worker->record.wait_ns - waited_ns);
}
