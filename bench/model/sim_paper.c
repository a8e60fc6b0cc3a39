/* sim_paper.c - schedule_paper.c, replayed.
 *
 * Low-level nodes with requests, sleep, hand-over of the front node and wake-up; then the
 * high-level nodes, each expanded by one thread and dealt out round robin between
 * barriers.
 *
 * Source: paper sections 4.2, 4.3, 5.1.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "assignment.h"
#include "report.h"
#include "sim.h"

enum doing { FREE, BUSY, CHOOSING, ASKING, ASLEEP, LOUNGING, WOKEN, FINISHED };

struct seat {
    enum doing doing;
    uint32_t node;   /* BUSY: the unit that ends at `now`; WOKEN: what was given */
    bool given;      /* WOKEN */
    uint32_t victim; /* ASKING */
    /* The task unit queue. */
    uint32_t *nodes;
    uint32_t head;
    uint32_t tail;
    /* The scheduling queue. */
    struct sim_line lock;
    bool takes_requests;
    uint32_t requests[MODEL_THREADS_MAX];
    uint32_t request_count;
    uint32_t offers[ENG_OFFERS_MAX]; /* as published */
};

struct assigning {
    struct sim *sim;
    const struct model_record *record;
    struct seat *seats;
    struct sim_line active_line;
    uint32_t active;
    /* Who sleeps because nobody has a node to spare, first in, first out. */
    struct sim_line lounge_line;
    uint32_t lounge[MODEL_THREADS_MAX];
    uint32_t lounge_count;
};

static const struct eng_node *node_of(const struct assigning *s, uint32_t node)
{
    return &eng_trees_of(s->record->scene)->nodes[node];
}

static uint32_t queued(const struct seat *seat)
{
    return seat->tail - seat->head;
}

static void publish(const struct assigning *s, struct seat *seat)
{
    for (uint32_t k = 0; k < ENG_OFFERS_MAX; k++) {
        seat->offers[k] =
            k < queued(seat) ? node_of(s, seat->nodes[seat->head + k])->count : 0;
    }
}

/* Lock and unlock a seat's mutex; who comes while it is held pays for that too. */
static double use_lock(struct assigning *s, struct seat *seat, uint32_t thread,
                       double now)
{
    const struct model_machine *machine = s->sim->input->machine;
    struct sim_line *lock = &seat->lock;
    double held = lock->free_at > now ? machine->lock_fought : 0;
    double begin = lock->free_at > now ? lock->free_at : now;
    lock->free_at =
        begin + held + (lock->owner == thread ? machine->lock : machine->lock_transfer);
    lock->owner = thread;
    return lock->free_at;
}

/* Wake an asker. Returns when the caller may go on. */
static double answer(struct assigning *s, uint32_t asker, double now, bool given,
                     uint32_t node)
{
    const struct model_machine *machine = s->sim->input->machine;
    struct seat *seat = &s->seats[asker];
    struct sim_thread *at = &s->sim->threads[asker];
    seat->doing = WOKEN;
    seat->given = given;
    seat->node = node;
    at->now = fmax(at->now, now + machine->wake);
    return now + machine->signal;
}

static void serve(struct assigning *s, uint32_t thread, bool close)
{
    struct seat *seat = &s->seats[thread];
    struct sim_thread *at = &s->sim->threads[thread];
    uint32_t served = 0;
    at->now = use_lock(s, seat, thread, at->now);
    while (served < seat->request_count && (close || queued(seat) > 1)) {
        uint32_t asker = seat->requests[served++];
        bool given = queued(seat) > 1;
        uint32_t node = ENG_NO_NODE;
        if (given) {
            s->active++;
            at->now = sim_line_use(s->sim, &s->active_line, thread, at->now);
            node = seat->nodes[seat->head++];
            s->sim->output->hand_overs++;
        }
        at->now = answer(s, asker, at->now, given, node);
    }
    seat->lock.free_at = at->now;
    for (uint32_t i = served; i < seat->request_count; i++) {
        seat->requests[i - served] = seat->requests[i];
    }
    seat->request_count -= served;
    seat->takes_requests = !close;
}

/* Wake the first `count` of those who sleep in the lounge; the caller signals each. */
static void call_lounge(struct assigning *s, uint32_t thread, uint32_t count)
{
    const struct model_machine *machine = s->sim->input->machine;
    struct sim_thread *at = &s->sim->threads[thread];
    at->now = sim_line_use(s->sim, &s->lounge_line, thread, at->now);
    for (uint32_t i = 0; i < count; i++) {
        struct sim_thread *sleeper = &s->sim->threads[s->lounge[i]];
        sleeper->now = fmax(sleeper->now, at->now + machine->wake);
        s->seats[s->lounge[i]].doing = CHOOSING;
        at->now += machine->signal;
    }
    s->lounge_count -= count;
    memmove(s->lounge, s->lounge + count, s->lounge_count * sizeof *s->lounge);
    s->lounge_line.free_at = at->now;
}

/* Its queue is empty: the rest of perform_units. */
static void close_seat(struct assigning *s, uint32_t thread)
{
    struct seat *seat = &s->seats[thread];
    struct sim_thread *at = &s->sim->threads[thread];
    publish(s, seat);
    serve(s, thread, true);
    s->active--;
    at->now = sim_line_use(s->sim, &s->active_line, thread, at->now);
    if (s->active == 0) {
        call_lounge(s, thread, s->lounge_count);
    }
    at->now += sim_flush(s->sim, at);
    seat->doing = CHOOSING;
}

static void begin_unit(struct assigning *s, uint32_t thread)
{
    struct seat *seat = &s->seats[thread];
    struct sim_thread *at = &s->sim->threads[thread];
    if (queued(seat) == 0) {
        close_seat(s, thread);
        return;
    }
    seat->node = seat->nodes[--seat->tail];
    seat->doing = BUSY;
    uint32_t unit = s->record->unit_of[seat->node];
    if (unit != MODEL_NO_TASK) {
        at->now += sim_perform(s->sim, at, &s->record->units.items[unit]);
    }
    at->now += s->sim->input->machine->unit;
}

static void end_unit(struct assigning *s, uint32_t thread)
{
    struct seat *seat = &s->seats[thread];
    const struct eng_node *node = node_of(s, seat->node);
    if (node->left != ENG_LEAF) {
        seat->nodes[seat->tail++] = node->left;
        seat->nodes[seat->tail++] = node->right;
    }
    publish(s, seat);
    if (seat->request_count > 0) {
        serve(s, thread, false);
        publish(s, seat);
    }
    if (queued(seat) > 1 && s->lounge_count > 0) {
        uint32_t spare = queued(seat) - 1;
        call_lounge(s, thread, spare < s->lounge_count ? spare : s->lounge_count);
    }
    seat->doing = FREE;
}

/* One look over all seats; each is a line that its owner has written since. */
static void choose(struct assigning *s, uint32_t thread)
{
    const struct model_machine *machine = s->sim->input->machine;
    struct sim_thread *at = &s->sim->threads[thread];
    struct seat *seat = &s->seats[thread];
    uint32_t victim = UINT32_MAX;
    uint32_t largest = 0;
    if (s->active == 0) {
        seat->doing = FINISHED;
        return;
    }
    for (uint32_t i = 0; i < s->sim->count; i++) {
        const struct seat *other = &s->seats[i];
        uint32_t k = other->request_count;
        if (i == thread || k + 1 >= ENG_OFFERS_MAX) {
            continue;
        }
        if (other->offers[k + 1] > 0 && other->offers[k] > largest) {
            largest = other->offers[k];
            victim = i;
        }
    }
    at->now += machine->transfer * (s->sim->count - 1);
    if (victim == UINT32_MAX) {
        at->now = sim_line_use(s->sim, &s->lounge_line, thread, at->now);
        s->lounge[s->lounge_count++] = thread;
        seat->doing = LOUNGING;
        s->sim->output->sleeps++;
    } else {
        seat->victim = victim;
        seat->doing = ASKING;
    }
}

static void ask(struct assigning *s, uint32_t thread)
{
    struct sim_thread *at = &s->sim->threads[thread];
    struct seat *seat = &s->seats[thread];
    struct seat *victim = &s->seats[seat->victim];
    at->now = use_lock(s, victim, thread, at->now);
    if (victim->takes_requests) {
        victim->requests[victim->request_count++] = thread;
        seat->doing = ASLEEP;
    } else {
        seat->doing = CHOOSING;
    }
}

static void wake(struct assigning *s, uint32_t thread)
{
    struct seat *seat = &s->seats[thread];
    struct sim_thread *at = &s->sim->threads[thread];
    if (!seat->given) {
        seat->doing = CHOOSING;
        return;
    }
    seat->nodes[seat->tail++] = seat->node;
    at->now = use_lock(s, seat, thread, at->now);
    seat->takes_requests = true;
    seat->doing = FREE;
}

static bool next_event(struct assigning *s)
{
    uint32_t first = UINT32_MAX;
    for (uint32_t i = 0; i < s->sim->count; i++) {
        if (s->seats[i].doing != FINISHED && s->seats[i].doing != ASLEEP &&
            s->seats[i].doing != LOUNGING &&
            (first == UINT32_MAX ||
             s->sim->threads[i].now < s->sim->threads[first].now)) {
            first = i;
        }
    }
    if (first == UINT32_MAX) {
        return false;
    }
    switch (s->seats[first].doing) {
    case FREE:
        begin_unit(s, first);
        break;
    case BUSY:
        end_unit(s, first);
        break;
    case CHOOSING:
        choose(s, first);
        break;
    case ASKING:
        ask(s, first);
        break;
    default:
        wake(s, first);
        break;
    }
    return true;
}

static void begin(struct assigning *s)
{
    const struct model_division *division = s->sim->input->division;
    const struct eng_scene *scene = s->record->scene;
    for (uint32_t i = 0; i < s->sim->count; i++) {
        struct seat *seat = &s->seats[i];
        /* Nodes come and go; none comes twice. */
        seat->nodes = bench_alloc(
            2 * (size_t)eng_trees_of(scene)->nodes[eng_trees_of(scene)->root].count,
            sizeof *seat->nodes);
        seat->lock.owner = i;
        seat->doing = CHOOSING;
        if (division->first_node[i] != ENG_NO_NODE) {
            seat->nodes[seat->tail++] = division->first_node[i];
            seat->takes_requests = true;
            seat->doing = FREE;
            s->active++;
        }
    }
}

static void perform_low(struct sim *sim)
{
    struct assigning s = {
        .sim = sim, .record = sim->input->record, .active_line = {0, UINT32_MAX}};
    s.seats = bench_alloc(sim->count, sizeof *s.seats);
    memset(s.seats, 0, sim->count * sizeof *s.seats);
    begin(&s);
    while (next_event(&s)) {
    }
    for (uint32_t i = 0; i < sim->count; i++) {
        free(s.seats[i].nodes);
    }
    free(s.seats);
}

static void perform(struct sim *sim, uint32_t thread, const struct model_task *task)
{
    struct sim_thread *at = &sim->threads[thread];
    at->now += sim_perform(sim, at, task);
}

static void perform_round_robin(struct sim *sim, const struct model_high *high)
{
    const struct model_task *tasks = sim->input->division->tasks.items;
    perform(sim, 0, &tasks[high->expansion]);
    sim_barrier(sim);
    for (uint32_t k = 0; k < high->pair_count; k++) {
        perform(sim, k % sim->count, &tasks[high->expansion + 1 + k]);
    }
    sim_barrier(sim);
}

static void perform_disjoint(struct sim *sim, const struct model_high *high)
{
    const struct model_task *tasks = sim->input->division->disjoint.items;
    uint32_t width = 1u << sim->input->division->levels;
    for (uint32_t phase = 0; phase < width; phase++) {
        for (uint32_t i = 0; i < width; i++) {
            perform(sim, i, &tasks[high->phases + phase * width + i]);
        }
        sim_barrier(sim);
    }
}

static void perform_high(struct sim *sim)
{
    const struct model_division *division = sim->input->division;
    bool is_disjoint = sim->input->high_level == ENG_HIGH_LEVEL_DISJOINT;
    sim_barrier(sim);
    sim->output->low = sim->threads[0].now;
    for (uint32_t i = 0; i < division->high_count; i++) {
        if (is_disjoint) {
            perform_disjoint(sim, &division->high[i]);
        } else {
            perform_round_robin(sim, &division->high[i]);
        }
    }
}

/* Work of the low-level nodes: all units but those of high-level nodes. */
static double low_work(const struct sim *sim)
{
    const struct model_record *record = sim->input->record;
    const struct model_division *division = sim->input->division;
    double ns = model_tasks_ns(&record->units);
    for (uint32_t i = 0; i < division->high_count; i++) {
        const struct model_task *unit =
            &record->units.items[record->unit_of[division->high[i].node]];
        ns -= unit->walk_ns + unit->tests_ns;
    }
    return ns;
}

void sim_paper(struct sim *sim)
{
    perform_low(sim);
    perform_high(sim);
    for (uint32_t i = 0; i < sim->count; i++) {
        sim->threads[i].now += sim_flush(sim, &sim->threads[i]);
    }
    sim->output->largest = sim_largest(&sim->input->record->units);
    sim->output->low_work = low_work(sim);
    sim->output->high_work =
        model_tasks_ns(sim->input->high_level == ENG_HIGH_LEVEL_DISJOINT
                           ? &sim->input->division->disjoint
                           : &sim->input->division->tasks);
}
