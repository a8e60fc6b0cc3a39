/* bench/model/sim_steal.c - schedule_steal.c, replayed.
 *
 * Room:     bench/model.
 * Does:     each thread pops its newest task, or tries the others' oldest in the order of
 *           the engine; a task's children are pushed when it ends.
 * Threads:  one.
 *
 * The count of open tasks is one cache line: each change of it waits for the one before,
 * and costs a transfer when another thread has changed it since, or looks at it because
 * it has no work.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "deque.h"
#include "report.h"
#include "schedule.h"
#include "sim.h"

enum doing { FREE, BUSY, SEARCHING, FINISHED };

struct entry {
    uint32_t task;
    double pushed; /* a thief sees it from then on */
};

struct stealer {
    enum doing doing;
    uint32_t task;  /* BUSY: it ends at the thread's `now` */
    uint32_t tried; /* SEARCHING: victims looked at in this round */
    uint32_t failed_rounds;
    uint32_t top; /* free-running, as in the deque */
    uint32_t bottom;
    struct entry entries[ENG_DEQUE_MAX];
};

struct stealing {
    struct sim *sim;
    const struct model_tasks *tasks;
    struct stealer *stealers;
    struct sim_line open_line;
    uint64_t open;
    uint32_t searching;
};

static struct entry *entry_of(struct stealer *stealer, uint32_t i)
{
    return &stealer->entries[i & (ENG_DEQUE_MAX - 1)];
}

static double change_open(struct stealing *s, uint32_t thread, double now, int by)
{
    if (s->searching > 0) {
        s->open_line.owner = UINT32_MAX;
    }
    s->open = by > 0 ? s->open + 1 : s->open - 1;
    return sim_line_use(s->sim, &s->open_line, thread, now);
}

static double push(struct stealing *s, uint32_t thread, double now, uint32_t task)
{
    struct stealer *stealer = &s->stealers[thread];
    now = change_open(s, thread, now, 1) + s->sim->input->machine->push;
    *entry_of(stealer, stealer->bottom++) = (struct entry){task, now};
    return now;
}

static void start(struct stealing *s, uint32_t thread, uint32_t task)
{
    struct sim_thread *at = &s->sim->threads[thread];
    struct stealer *stealer = &s->stealers[thread];
    stealer->doing = BUSY;
    stealer->task = task;
    at->now += sim_perform(s->sim, at, &s->tasks->items[task]);
}

static void finish(struct stealing *s, uint32_t thread)
{
    struct sim_thread *at = &s->sim->threads[thread];
    struct stealer *stealer = &s->stealers[thread];
    const struct model_task *task = &s->tasks->items[stealer->task];
    for (uint32_t i = 0; i < task->child_count; i++) {
        at->now = push(s, thread, at->now, task->first_child + i);
    }
    at->now = change_open(s, thread, at->now, -1);
    stealer->doing = FREE;
}

/* The head of the loop: anything of one's own? */
static void look(struct stealing *s, uint32_t thread)
{
    struct sim_thread *at = &s->sim->threads[thread];
    struct stealer *stealer = &s->stealers[thread];
    if (s->open == 0) {
        stealer->doing = FINISHED;
        return;
    }
    at->now += s->sim->input->machine->pop;
    if (stealer->top != stealer->bottom) {
        start(s, thread, entry_of(stealer, --stealer->bottom)->task);
        return;
    }
    stealer->doing = SEARCHING;
    stealer->tried = 0;
    s->searching++;
}

static void end_round(struct stealing *s, uint32_t thread)
{
    struct stealer *stealer = &s->stealers[thread];
    s->searching--;
    stealer->doing = FREE;
    s->sim->output->sleeps++;
    if (++stealer->failed_rounds % ENG_STEAL_ROUNDS == 0) {
        s->sim->threads[thread].now += s->sim->input->machine->yield;
    }
}

/* The next victim of a round. */
static void try_next(struct stealing *s, uint32_t thread)
{
    struct sim_thread *at = &s->sim->threads[thread];
    struct stealer *stealer = &s->stealers[thread];
    if (++stealer->tried == s->sim->count) {
        end_round(s, thread);
        return;
    }
    struct stealer *victim = &s->stealers[(thread + stealer->tried) % s->sim->count];
    const struct entry *oldest = entry_of(victim, victim->top);
    if (victim->top == victim->bottom || oldest->pushed > at->now) {
        at->now += s->sim->input->machine->probe;
        return;
    }
    victim->top++;
    s->searching--;
    s->sim->output->hand_overs++;
    stealer->failed_rounds = 0;
    at->now += s->sim->input->machine->steal;
    start(s, thread, oldest->task);
}

/* When something can change for a thread that searches: a task ends, or one that was
 * pushed comes into sight. Until then its rounds fail, and all but the last are skipped
 * in one go. */
static void skip_rounds(struct stealing *s, uint32_t thread)
{
    const struct model_machine *machine = s->sim->input->machine;
    struct sim_thread *at = &s->sim->threads[thread];
    double until = INFINITY;
    for (uint32_t i = 0; i < s->sim->count; i++) {
        struct stealer *other = &s->stealers[i];
        if (other->doing == BUSY || other->doing == FREE) {
            until = fmin(until, s->sim->threads[i].now);
        }
        if (other->top != other->bottom) {
            until = fmin(until, entry_of(other, other->top)->pushed);
        }
    }
    double round_ns = machine->pop + machine->probe * (s->sim->count - 1) +
                      machine->yield / ENG_STEAL_ROUNDS;
    if (isfinite(until) && round_ns > 0 && until - at->now > 2 * round_ns) {
        double rounds = floor((until - at->now) / round_ns) - 1;
        at->now += rounds * round_ns;
        s->sim->output->sleeps += (uint64_t)rounds;
    }
}

static bool next_event(struct stealing *s)
{
    uint32_t first = UINT32_MAX;
    for (uint32_t i = 0; i < s->sim->count; i++) {
        if (s->stealers[i].doing != FINISHED &&
            (first == UINT32_MAX ||
             s->sim->threads[i].now < s->sim->threads[first].now)) {
            first = i;
        }
    }
    if (first == UINT32_MAX) {
        return false;
    }
    switch (s->stealers[first].doing) {
    case BUSY:
        finish(s, first);
        break;
    case FREE:
        look(s, first);
        break;
    default:
        if (s->stealers[first].tried == 0) {
            skip_rounds(s, first);
        }
        try_next(s, first);
        break;
    }
    return true;
}

/* The longest chain of a task and those that it makes. Children stand behind parents. */
static double longest_chain(const struct model_tasks *tasks)
{
    double *chain = bench_alloc(tasks->count, sizeof *chain);
    for (uint32_t i = tasks->count; i-- > 0;) {
        const struct model_task *task = &tasks->items[i];
        chain[i] = 0;
        for (uint32_t k = 0; k < task->child_count; k++) {
            chain[i] = fmax(chain[i], chain[task->first_child + k]);
        }
        chain[i] += task->walk_ns;
    }
    double longest = chain[0];
    free(chain);
    return longest;
}

void sim_steal(struct sim *sim)
{
    struct stealing s = {
        .sim = sim, .tasks = &sim->input->record->steal, .open_line = {0, UINT32_MAX}};
    s.stealers = bench_alloc(sim->count, sizeof *s.stealers);
    memset(s.stealers, 0, sim->count * sizeof *s.stealers);
    s.open = 1;
    *entry_of(&s.stealers[0], s.stealers[0].bottom++) = (struct entry){0, 0};
    while (next_event(&s)) {
    }
    free(s.stealers);
    double done = sim_latest(sim);
    for (uint32_t i = 0; i < sim->count; i++) {
        sim->threads[i].now += sim_flush(sim, &sim->threads[i]);
    }
    sim->output->flush = sim_latest(sim) - done;
    sim->output->largest = sim_largest(s.tasks);
    sim->output->low_work = model_tasks_ns(&sim->input->record->steal);
    sim->output->critical = longest_chain(&sim->input->record->steal);
}
