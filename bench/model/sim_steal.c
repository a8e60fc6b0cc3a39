/* sim_steal.c - schedule_steal.c, replayed.
 *
 * Each thread pops its newest task; one without tasks tests what its chunks hold, then
 * looks at the others' deques from the victim that gave last on, with longer and longer
 * pauses between rounds.
 *
 * The count of threads that have tasks is one cache line: each change of it waits for the
 * one before, and costs a transfer when another thread has changed it since, or looks at
 * it because it has no work.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "deque.h"
#include "report.h"
#include "schedule_steal.h"
#include "sim.h"

enum doing { FREE, BUSY, SEARCHING, STEALING, FINISHED };

struct entry {
    uint32_t task;
    double pushed; /* a thief sees it from then on */
};

struct stealer {
    enum doing doing;
    uint32_t task;   /* BUSY: it ends at the thread's `now` */
    uint32_t victim; /* next to be looked at; STEALING: from whom */
    uint32_t tried;  /* SEARCHING: seats looked at in this round */
    uint32_t relaxes;
    uint32_t top; /* free-running, as in the deque */
    uint32_t bottom;
    struct entry entries[ENG_DEQUE_MAX];
};

struct stealing {
    struct sim *sim;
    const struct model_tasks *tasks;
    struct stealer *stealers;
    struct sim_line active_line;
    uint32_t active;    /* threads with tasks */
    uint32_t searching; /* threads without */
    uint32_t waiting;   /* tasks in deques */
};

static struct entry *entry_of(struct stealer *stealer, uint32_t i)
{
    return &stealer->entries[i & (ENG_DEQUE_MAX - 1)];
}

static void change_active(struct stealing *s, uint32_t thread, int by)
{
    struct sim_thread *at = &s->sim->threads[thread];
    if (s->searching > 0) {
        s->active_line.owner = UINT32_MAX;
    }
    s->active = by > 0 ? s->active + 1 : s->active - 1;
    at->now = sim_line_use(s->sim, &s->active_line, thread, at->now);
}

static void start(struct stealing *s, uint32_t thread, uint32_t task)
{
    struct sim_thread *at = &s->sim->threads[thread];
    s->stealers[thread].doing = BUSY;
    s->stealers[thread].task = task;
    at->now += sim_perform(s->sim, at, &s->tasks->items[task]);
}

static void finish(struct stealing *s, uint32_t thread)
{
    struct sim_thread *at = &s->sim->threads[thread];
    struct stealer *stealer = &s->stealers[thread];
    const struct model_task *task = &s->tasks->items[stealer->task];
    for (uint32_t i = 0; i < task->child_count; i++) {
        at->now += s->sim->input->machine->push;
        *entry_of(stealer, stealer->bottom++) =
            (struct entry){task->first_child + i, at->now};
    }
    s->waiting += task->child_count;
    stealer->doing = FREE;
}

static void begin_search(struct stealing *s, uint32_t thread)
{
    struct stealer *stealer = &s->stealers[thread];
    stealer->doing = SEARCHING;
    stealer->tried = 0;
    stealer->relaxes = 1;
    s->searching++;
}

/* Anything of one's own? */
static void look(struct stealing *s, uint32_t thread)
{
    struct sim_thread *at = &s->sim->threads[thread];
    struct stealer *stealer = &s->stealers[thread];
    at->now += s->sim->input->machine->pop;
    if (stealer->top != stealer->bottom) {
        s->waiting--;
        start(s, thread, entry_of(stealer, --stealer->bottom)->task);
        return;
    }
    change_active(s, thread, -1);
    at->now += sim_flush(s->sim, at);
    begin_search(s, thread);
}

static void end_round(struct stealing *s, uint32_t thread)
{
    const struct model_machine *machine = s->sim->input->machine;
    struct sim_thread *at = &s->sim->threads[thread];
    struct stealer *stealer = &s->stealers[thread];
    stealer->tried = 0;
    s->sim->output->sleeps++;
    at->now += machine->relax * stealer->relaxes;
    if (stealer->relaxes < ENG_STEAL_RELAXES_MAX) {
        stealer->relaxes *= 2;
    }
}

/* The next seat of a round. */
static void try_next(struct stealing *s, uint32_t thread)
{
    const struct model_machine *machine = s->sim->input->machine;
    struct sim_thread *at = &s->sim->threads[thread];
    struct stealer *stealer = &s->stealers[thread];
    if (stealer->tried == 0 && s->active == 0) {
        s->searching--;
        stealer->doing = FINISHED;
        return;
    }
    if (stealer->tried == 0 && s->waiting == 0) { /* all of it fails */
        at->now += machine->probe * (s->sim->count - 1);
        end_round(s, thread);
        return;
    }
    if (stealer->tried == s->sim->count) {
        end_round(s, thread);
        return;
    }
    stealer->tried++;
    struct stealer *victim = &s->stealers[stealer->victim];
    if (stealer->victim != thread) {
        at->now += machine->probe;
        if (victim->top != victim->bottom &&
            entry_of(victim, victim->top)->pushed <= at->now) {
            change_active(s, thread, 1);
            stealer->doing = STEALING;
            return;
        }
    }
    stealer->victim = (stealer->victim + 1) % s->sim->count;
}

/* The thief is counted, and tries to take what it has seen. */
static void steal(struct stealing *s, uint32_t thread)
{
    struct sim_thread *at = &s->sim->threads[thread];
    struct stealer *stealer = &s->stealers[thread];
    struct stealer *victim = &s->stealers[stealer->victim];
    at->now += s->sim->input->machine->steal;
    if (victim->top == victim->bottom) { /* another was faster */
        change_active(s, thread, -1);
        stealer->doing = SEARCHING;
        stealer->victim = (stealer->victim + 1) % s->sim->count;
        return;
    }
    s->waiting--;
    s->searching--;
    s->sim->output->hand_overs++;
    start(s, thread, entry_of(victim, victim->top++)->task);
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
    case SEARCHING:
        try_next(s, first);
        break;
    default:
        steal(s, first);
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
    double longest = 0;
    for (uint32_t i = 0; i < tasks->count; i++) {
        longest = fmax(longest, chain[i]);
    }
    free(chain);
    return longest;
}

/* The first tasks: that of the root to who ended the refit; by the method wide, those
 * that were dealt out. */
static void deal(struct stealing *s, const struct model_input *input)
{
    bool is_wide = input->method == PCCD_METHOD_WIDE;
    s->waiting = is_wide ? input->record->wide.dealt_count : 1;
    for (uint32_t i = 0; i < s->waiting; i++) {
        uint32_t owner = is_wide ? input->division->owner[i] : s->sim->refit_thread;
        struct stealer *stealer = &s->stealers[owner];
        *entry_of(stealer, stealer->bottom++) = (struct entry){i, 0};
    }
}

void sim_steal(struct sim *sim)
{
    const struct model_record *record = sim->input->record;
    struct stealing s = {.sim = sim,
                         .tasks = sim->input->method == PCCD_METHOD_WIDE
                                      ? &record->wide.tasks
                                      : &record->steal,
                         .active_line = {0, UINT32_MAX}};
    s.stealers = bench_alloc(sim->count, sizeof *s.stealers);
    memset(s.stealers, 0, sim->count * sizeof *s.stealers);
    deal(&s, sim->input);
    for (uint32_t i = 0; i < sim->count; i++) {
        s.stealers[i].victim = (i + 1) % sim->count;
        if (s.stealers[i].top == s.stealers[i].bottom) {
            begin_search(&s, i);
        } else {
            s.active++;
        }
    }
    while (next_event(&s)) {
    }
    free(s.stealers);
    sim->output->largest = sim_largest(s.tasks);
    sim->output->low_work = model_tasks_ns(s.tasks);
    sim->output->critical = longest_chain(s.tasks);
}
