/* schedule_steal.c - work stealing.
 *
 * The method deals out the first tasks, to one worker or to several; large ones are split
 * and the parts pushed to the worker's own deque; small ones are worked through at once.
 * A worker without tasks takes the oldest of another.
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
#include <assert.h>

#include "method.h"

void eng_schedule_steal_begin(struct eng_team *team, struct eng_worker *worker)
{
    assert(team->count >= 1 && team->method);
    uint32_t active = 0;
    team->method->deal(team, worker);
    for (uint32_t i = 0; i < team->count; i++) {
        struct eng_worker *dealt = team->workers[i];
        dealt->is_dealt = eng_deque_has_task(&dealt->deque);
        active += dealt->is_dealt;
    }
    atomic_store_explicit(&team->active, active, memory_order_relaxed);
}

static void perform(struct eng_team *team, struct eng_worker *worker, uint64_t task)
{
    if (!eng_worker_should_stop(worker)) {
        team->method->perform(worker, task);
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
    struct eng_wait wait;
    uint32_t relaxes = 1;
    bool found = false;
    eng_wait_begin(&wait, worker);
    while (!found && atomic_load_explicit(&team->active, memory_order_acquire) > 0) {
        found = steal(team, worker, task);
        bool has_slept = false;
        for (uint32_t i = 0; i < relaxes && !found && !has_slept; i++) {
            has_slept = eng_wait_moment(&wait);
        }
        relaxes = relaxes < ENG_STEAL_RELAXES_MAX ? 2 * relaxes : relaxes;
    }
    eng_wait_end(&wait);
    return found;
}

void eng_schedule_steal(struct eng_team *team, struct eng_worker *worker)
{
    assert(worker->thread < team->count);
    uint64_t begin_ns = common_now_ns();
    uint64_t waited_ns = worker->record.wait_ns;
    uint64_t task;
    worker->victim = (worker->thread + 1) % team->count;
    bool has_task = eng_deque_pop(&worker->deque, &task);
    if (!has_task) {
        if (worker->is_dealt) {
            leave(team); /* it was late, and its tasks are others' by now */
        }
        has_task = search(team, worker, &task);
    }
    while (has_task) {
        perform(team, worker, task);
        /* Whoever waited finds what we have pushed, and needs its processor. */
        eng_wait_return(worker, team->count);
        has_task = eng_deque_pop(&worker->deque, &task);
        if (!has_task) {
            leave(team);
            /* What waits for tests would else be tested when all others have ended. */
            team->method->flush(worker);
            has_task = search(team, worker, &task);
        }
    }
    worker->record.low_ns +=
        common_now_ns() - begin_ns - (worker->record.wait_ns - waited_ns);
}
