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
 *
 * The end. `active` counts the workers that have tasks; nothing else is written by more
 * than one worker as long as each has tasks of its own. A worker leaves when its deque is
 * empty, which only it fills; a thief enters before it takes anything. So every task that
 * is not finished belongs to a worker that is counted, and none is left when the count is
 * zero. It may rise once more then, while a thief tries a deque that looked full to it.
 *
 * Who finds nothing pauses twice as long before each round, up to some 3 us: owners write
 * the lines that thieves look at, and 63 thieves without a pause would make every push of
 * the last owner wait for them.
 */
#include "schedule.h"

#include <sched.h>

#include "rebuild.h"
#include "relax.h"
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

void eng_schedule_steal_begin(struct eng_team *team, struct eng_worker *worker)
{
    push(worker, team->scene->root, team->scene->root);
    team->first = worker;
    atomic_store_explicit(&team->active, 1, memory_order_relaxed);
}

/* All task units of a small subtree. */
static void perform_subtree(struct eng_worker *worker, uint32_t node)
{
    struct eng_task_queue *units = &worker->units;
    uint64_t begin_ns = eng_worker_slice(worker);
    eng_taskunit_perform(worker, node, true);
    while (eng_units_count(units) > 0 && !eng_stop_is_set(worker->stop)) {
        eng_taskunit_perform(worker, eng_units_take_newest(units), true);
    }
    units->head = units->tail;
    eng_worker_trace(worker, ENG_TRACE_SUBTREE, begin_ns, node,
                     worker->scene->nodes[node].count);
}

static void perform_unit(struct eng_worker *worker, uint32_t n)
{
    if (worker->scene->nodes[n].count <= ENG_STEAL_UNIT_GRAIN) {
        perform_subtree(worker, n);
        return;
    }
    uint64_t begin_ns = eng_worker_slice(worker);
    const struct eng_node *node = eng_node_open(worker, n);
    worker->record.task_units++;
    push(worker, node->left, node->left);
    push(worker, node->right, node->right);
    push(worker, node->left, node->right);
    eng_worker_trace(worker, ENG_TRACE_UNIT, begin_ns, n, node->count);
}

static void perform_pair(struct eng_worker *worker, uint32_t n, uint32_t m)
{
    const struct eng_node *nodes = worker->scene->nodes;
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
    eng_worker_trace(worker, ENG_TRACE_PAIRS, begin_ns, n, m);
}

static void perform(struct eng_worker *worker, uint64_t task)
{
    uint32_t n = (uint32_t)(task >> 32);
    uint32_t m = (uint32_t)task;
    if (eng_worker_should_stop(worker)) {
        return;
    }
    if (n == m) {
        perform_unit(worker, n);
    } else {
        perform_pair(worker, n, m);
    }
}

static void enter(struct eng_team *team)
{
    atomic_fetch_add_explicit(&team->active, 1, memory_order_relaxed);
}

static void leave(struct eng_team *team)
{
    /* Release: pairs with the acquire of whoever sees zero. Acquire: an owner that lost
     * its last task to a thief has seen the thief's step, and so its entry. */
    atomic_fetch_sub_explicit(&team->active, 1, memory_order_acq_rel);
}

/* One round over the other workers, from the one that was last robbed on: it may have
 * more. True: *task is ours and we are counted. */
static bool steal(struct eng_team *team, struct eng_worker *worker, uint64_t *task)
{
    worker->record.requests++;
    for (uint32_t i = 0; i < team->count; i++) {
        struct eng_worker *victim = team->workers[worker->victim];
        if (victim != worker && eng_deque_has_task(&victim->deque)) {
            enter(team);
            if (eng_deque_steal(&victim->deque, task)) {
                worker->record.steals++;
                return true;
            }
            leave(team);
        }
        worker->victim = worker->victim + 1 < team->count ? worker->victim + 1 : 0;
    }
    return false;
}

/* A task of another worker; false: all are finished. */
static bool search(struct eng_team *team, struct eng_worker *worker, uint64_t *task)
{
    uint64_t begin_ns = eng_now_ns();
    uint32_t relaxes = 1;
    uint32_t failed_rounds = 0;
    bool found = false;
    while (!found && atomic_load_explicit(&team->active, memory_order_acquire) > 0) {
        found = steal(team, worker, task);
        for (uint32_t i = 0; i < relaxes && !found; i++) {
            eng_relax();
        }
        relaxes = relaxes < ENG_STEAL_RELAXES_MAX ? 2 * relaxes : relaxes;
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
    worker->victim = (worker->thread + 1) % team->count;
    bool has_task = eng_deque_pop(&worker->deque, &task);
    if (!has_task) {
        if (worker == team->first) {
            leave(team); /* it was late, and the root is another's by now */
        }
        has_task = search(team, worker, &task);
    }
    while (has_task) {
        perform(worker, task);
        has_task = eng_deque_pop(&worker->deque, &task);
        if (!has_task) {
            leave(team);
            /* What waits for tests would else be tested when all others have ended. */
            eng_taskunit_flush(worker);
            has_task = search(team, worker, &task);
        }
    }
    worker->record.low_ns +=
        eng_now_ns() - begin_ns - (worker->record.wait_ns - waited_ns);
}
