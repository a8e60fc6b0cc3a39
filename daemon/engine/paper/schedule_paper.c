/* schedule_paper.c - the paper's own scheduler.
 *
 * Deal out one low-level node to each thread; a thread that runs out asks another for its
 * front unit and sleeps until it is answered; when all are done, all threads together
 * perform the high-level nodes.
 *
 * Source: paper sections 4.2 (initial assignment), 4.3 (dynamic assignment).
 *
 * A unit is only ever one thread's and disjoint from the others' units, so the main loop
 * takes no lock: after each task unit a thread looks at the length of its scheduling
 * queue, and at the number of threads that sleep because nobody had one to spare.
 * `active` counts threads that have work or to whom work is on its way; it is zero when
 * all units are done. A step that is stopped ends like one that is done: every thread
 * gives up its units and leaves.
 */
#include "paper_work.h"

#include <assert.h>

#include "paper.h"
#include "rebuild.h"
#include "wait.h"

/* ---- high-level nodes --------------------------------------------------------------
 *
 * Source: paper section 5.1.
 *
 * Above the low-level nodes there are fewer task units than threads, so all threads work
 * on the same one, unit after unit.
 *
 * Round robin ("lazy reconstruction with a locking mechanism", the default): one thread
 * refines the pair of the node's children breadth-first; when there are enough pairs they
 * are dequeued and dealt out in turn, because pairs that are close in the queue are alike
 * and take about as long. Any two pairs may lead to the same node, so a node is locked
 * while it is reconstructed, which is rare: most were looked at by low-level task units.
 *
 * Disjoint ("lazy reconstruction without a locking mechanism"): of the four pairs that
 * (n, m) is refined to, (L(n), L(m)) and (R(n), R(m)) have no node in common, nor do
 * (L(n), R(m)) and (R(n), L(m)). Two threads take the first two, wait for each other, and
 * take the other two. Each of these pairs can be divided among twice as many threads in
 * the same way: with 2^d threads d levels are refined, and the 4^d pairs found there are
 * done in 2^d phases. In phase f thread t follows at level i the child b of n and the
 * child b ^ c of m, where b is bit i of t and c bit i of f: two threads part where their
 * b differ, with different children on both sides; all (b, c) of all levels make up all
 * pairs. A node that is a leaf stands for itself; with the children of the other shared
 * by both halves of the threads, one half goes on and takes the child c. Nodes are opened
 * through their gates all the same (rebuild.h); nobody ever waits at one, but on the way
 * down to where the threads part.
 *
 * Expect twice the speed of one thread from eight (the paper's figure) rather than eight
 * times: there are eight barriers a unit, at each of which all threads wait for the
 * slowest pair of its phase, and the boxes of two siblings overlap where the siblings
 * touch: most of the work is in few of the 64 pairs, in different phases and not at the
 * same time. */

static void perform_pair(struct eng_worker *worker, uint32_t n, uint32_t m)
{
    uint64_t begin_ns = eng_worker_slice(worker);
    eng_taskunit_pairs(worker, n, m);
    eng_worker_trace(worker, PCCD_TRACE_PAIRS, begin_ns, n, m);
}

void eng_highlevel_expand(struct eng_team *team, struct eng_worker *worker, uint32_t node)
{
    assert(node != ENG_NO_NODE);
    struct eng_assignment *assignment = &eng_paper_of(team->scene)->assignment;
    const struct eng_node *opened = eng_node_open(worker, node);
    uint32_t wanted = ENG_PAIRS_PER_THREAD * team->count;
    uint32_t head = 0;
    uint64_t *pairs = assignment->pairs;
    pairs[0] = (uint64_t)opened->left << 32 | opened->right;
    assignment->pair_count = 1;
    while (assignment->pair_count - head > 0 && assignment->pair_count < wanted) {
        uint32_t n_out[4];
        uint32_t m_out[4];
        uint64_t pair = pairs[head++];
        uint32_t count = eng_taskunit_refine(worker, (uint32_t)(pair >> 32),
                                             (uint32_t)pair, n_out, m_out);
        for (uint32_t i = 0; i < count; i++) {
            pairs[assignment->pair_count++] = (uint64_t)n_out[i] << 32 | m_out[i];
        }
    }
    for (uint32_t i = head; i < assignment->pair_count; i++) {
        pairs[i - head] = pairs[i];
    }
    assignment->pair_count -= head;
}

/* A part of the unit that began at `begin_ns`. */
static void end_part(struct eng_worker *worker, uint32_t node, uint64_t begin_ns,
                     uint32_t pairs)
{
    uint64_t end_ns = common_now_ns();
    worker->record.high_ns += end_ns - begin_ns;
    eng_worker_trace_until(worker, PCCD_TRACE_HIGH, begin_ns, end_ns, node, pairs);
}

/* This thread's share of the pairs. */
static uint32_t perform_share(const struct eng_team *team, struct eng_worker *worker)
{
    const struct eng_assignment *assignment = &eng_paper_of(team->scene)->assignment;
    uint32_t performed = 0;
    for (uint32_t k = worker->thread;
         k < assignment->pair_count && !eng_worker_should_stop(worker);
         k += team->count) {
        uint64_t pair = assignment->pairs[k];
        perform_pair(worker, (uint32_t)(pair >> 32), (uint32_t)pair);
        performed++;
    }
    return performed;
}

static void perform_round_robin(struct eng_team *team, struct eng_worker *worker,
                                uint32_t node)
{
    if (worker->thread == 0) {
        uint64_t begin_ns = common_now_ns();
        eng_highlevel_expand(team, worker, node);
        worker->record.high_ns += common_now_ns() - begin_ns;
    }
    eng_wait_for_all(worker);
    uint64_t begin_ns = common_now_ns();
    uint32_t performed = perform_share(team, worker);
    end_part(worker, node, begin_ns, performed);
    eng_wait_for_all(worker); /* the pairs make room for the next node's */
}

/* Follow the pair (n, m) of `level` one level down; false: there is nothing there for
 * this thread in this phase. A pair that several meet, in this phase or another, is
 * counted, or dealt with if it is two leaves, by the first thread in the first phase of
 * them. */
static bool descend(struct eng_worker *worker, uint32_t phase, uint32_t level,
                    uint32_t *n, uint32_t *m)
{
    uint32_t n_out[4];
    uint32_t m_out[4];
    uint32_t b = worker->thread >> level & 1u;
    uint32_t c = phase >> level & 1u;
    bool is_first = (worker->thread | phase) >> level == 0;
    uint32_t count = is_first ? eng_taskunit_refine(worker, *n, *m, n_out, m_out)
                              : eng_taskunit_peek(worker, *n, *m, n_out, m_out);
    if (count == 0 || (count == 2 && b == 1)) {
        return false;
    }
    uint32_t pick = count == 2 ? c : 2 * b + (b ^ c);
    *n = n_out[pick];
    *m = m_out[pick];
    return true;
}

/* The pair of worker->thread in this phase. Returns their number, 0 or 1. */
static uint32_t perform_phase(struct eng_worker *worker, uint32_t node, uint32_t phase,
                              uint32_t levels)
{
    assert(phase < 1u << levels);
    const struct eng_node *opened = eng_node_open(worker, node);
    uint32_t n = opened->left;
    uint32_t m = opened->right;
    for (uint32_t level = 0; level < levels; level++) {
        if (!descend(worker, phase, level, &n, &m)) {
            return 0;
        }
    }
    perform_pair(worker, n, m);
    return 1;
}

/* Disjoint pairs: levels that are refined for so many threads. 2^levels threads take
 * part, in as many phases. */
static uint32_t levels_for(uint32_t threads)
{
    assert(threads >= 1);
    uint32_t levels = 0;
    while (2u << levels <= threads) {
        levels++;
    }
    return levels;
}

static void perform_disjoint(struct eng_team *team, struct eng_worker *worker,
                             uint32_t node)
{
    uint32_t levels = levels_for(team->count);
    for (uint32_t phase = 0; phase < 1u << levels; phase++) {
        uint64_t begin_ns = common_now_ns();
        uint32_t performed = 0;
        if (worker->thread < 1u << levels && !eng_worker_should_stop(worker)) {
            performed = perform_phase(worker, node, phase, levels);
        }
        end_part(worker, node, begin_ns, performed);
        eng_wait_for_all(worker); /* what comes next has nodes of all of these */
    }
}

/* The high-level nodes of team->assignment, the deepest first, as
 * question->tuning.high_level says. Fills in record.high_ns. */
static void perform_high_levels(struct eng_team *team, struct eng_worker *worker)
{
    const struct eng_assignment *assignment = &eng_paper_of(team->scene)->assignment;
    bool is_disjoint = worker->question->tuning.high_level == ENG_HIGH_LEVEL_DISJOINT;
    for (uint32_t i = assignment->high_count; i-- > 0;) {
        worker->record.task_units += worker->thread == 0;
        if (is_disjoint) {
            perform_disjoint(team, worker, assignment->high[i]);
        } else {
            perform_round_robin(team, worker, assignment->high[i]);
        }
    }
    uint64_t begin_ns = common_now_ns();
    eng_taskunit_flush(worker);
    worker->record.high_ns += common_now_ns() - begin_ns;
}

/* ---- low-level nodes --------------------------------------------------------------- */

/* Write a node whose task unit is wanted to `place`; returns whether it is. */
static uint32_t add_wanted(struct eng_worker *worker, uint32_t node, uint32_t *place)
{
    bool is_wanted = eng_taskunit_is_wanted(worker, node);
    if (is_wanted) {
        *place = node;
    }
    return is_wanted;
}

/* Breadth-first until the queue `front` holds a node for each thread; the nodes opened on
 * the way are the high-level ones. Leaves wait in front of the queue. Returns the length
 * of the queue. */
static uint32_t choose_front(struct eng_team *team, struct eng_worker *worker,
                             uint32_t front[2 * ENG_THREADS_MAX])
{
    assert(eng_trees_of(worker->scene)->root != ENG_NO_NODE);
    struct eng_assignment *assignment = &eng_paper_of(team->scene)->assignment;
    uint32_t head = 0;
    uint32_t tail = 0;
    uint32_t leaves = 0;
    assignment->high_count = 0;
    tail += add_wanted(worker, eng_trees_of(worker->scene)->root, &front[tail]);
    while (head < tail && leaves + tail - head < team->count) {
        uint32_t idx = front[head++];
        const struct eng_node *node = eng_node_open(worker, idx);
        if (node->left == ENG_LEAF) {
            front[leaves++] = idx;
            continue;
        }
        assignment->high[assignment->high_count++] = idx;
        tail += add_wanted(worker, node->left, &front[tail]);
        tail += add_wanted(worker, node->right, &front[tail]);
    }
    while (head < tail) {
        front[leaves++] = front[head++];
    }
    return leaves;
}

/* Each opened node adds two and is one less. */
static void assign(struct eng_team *team, struct eng_worker *worker)
{
    uint32_t front[2 * ENG_THREADS_MAX];
    uint32_t count = choose_front(team, worker, front);
    for (uint32_t i = 0; i < count; i++) {
        eng_units_push(&eng_paper_work_of(team->workers[i])->units, front[i]);
    }
}

void eng_schedule_paper_begin(struct eng_team *team, struct eng_worker *worker)
{
    assert(eng_paper_of(team->scene)->assignment.capacity >= team->count);
    struct eng_assignment *assignment = &eng_paper_of(team->scene)->assignment;
    uint32_t active = 0;
    assign(team, worker);
    for (uint32_t i = 0; i < team->count; i++) {
        struct eng_seat *seat = &assignment->seats[i];
        seat->takes_requests =
            eng_units_count(&eng_paper_work_of(team->workers[i])->units) > 0;
        active += seat->takes_requests;
        seat->request_count = 0;
        atomic_store_explicit(&seat->requests_seen, 0, memory_order_relaxed);
        atomic_store_explicit(&seat->current, ENG_NO_NODE, memory_order_relaxed);
        for (uint32_t k = 0; k < ENG_OFFERS_MAX; k++) {
            atomic_store_explicit(&seat->offers[k], 0, memory_order_relaxed);
        }
    }
    atomic_store_explicit(&assignment->active, active, memory_order_relaxed);
}

/* Let others see how large the front units are. Relaxed: a hint; the lock decides. */
static void publish(struct eng_seat *seat, const struct eng_worker *worker)
{
    const struct eng_node *nodes = eng_trees_of(worker->scene)->nodes;
    const struct eng_unit_queue *units = &eng_paper_work_of(worker)->units;
    for (uint32_t k = 0; k < ENG_OFFERS_MAX; k++) {
        uint32_t size =
            k < eng_units_count(units) ? nodes[eng_units_peek(units, k)].count : 0;
        atomic_store_explicit(&seat->offers[k], size, memory_order_relaxed);
    }
}

static void answer(struct eng_seat *asker, enum eng_reply reply, uint32_t node)
{
    pthread_mutex_lock(&asker->lock);
    asker->reply = reply;
    asker->given = node;
    pthread_cond_signal(&asker->wake);
    pthread_mutex_unlock(&asker->lock);
}

/* Give front units to those who asked, oldest first, and keep one; with `close`, send the
 * rest away and take no more requests. */
static void serve(struct eng_assignment *assignment, struct eng_seat *seat,
                  struct eng_worker *worker, bool close)
{
    struct eng_unit_queue *units = &eng_paper_work_of(worker)->units;
    pthread_mutex_lock(&seat->lock);
    uint32_t served = 0;
    while (served < seat->request_count && (close || eng_units_count(units) > 1)) {
        struct eng_seat *asker = &assignment->seats[seat->requests[served++]];
        if (eng_units_count(units) > 1) {
            /* Counted before the asker wakes, so that `active` is not zero meanwhile. */
            atomic_fetch_add_explicit(&assignment->active, 1, memory_order_relaxed);
            worker->record.given++;
            answer(asker, ENG_REPLY_GIVEN, eng_units_take_front(units));
        } else {
            answer(asker, ENG_REPLY_DENIED, 0);
        }
    }
    for (uint32_t i = served; i < seat->request_count; i++) {
        seat->requests[i - served] = seat->requests[i];
    }
    seat->request_count -= served;
    seat->takes_requests = !close;
    atomic_store_explicit(&seat->requests_seen, seat->request_count,
                          memory_order_relaxed);
    pthread_mutex_unlock(&seat->lock);
}

static void perform_unit(const struct eng_team *team, struct eng_worker *worker,
                         uint32_t node)
{
    struct eng_assignment *assignment = &eng_paper_of(team->scene)->assignment;
    eng_assignment_enter(assignment, team->count, team->scene, worker->thread, node);
    eng_taskunit_perform(worker, node, true);
    eng_assignment_enter(assignment, team->count, team->scene, worker->thread,
                         ENG_NO_NODE);
}

/* The main loop of section 4.3: no lock unless somebody asks or sleeps. */
static void perform_units(struct eng_team *team, struct eng_seat *seat,
                          struct eng_worker *worker)
{
    struct eng_assignment *assignment = &eng_paper_of(team->scene)->assignment;
    struct eng_unit_queue *units = &eng_paper_work_of(worker)->units;
    while (eng_units_count(units) > 0 && !eng_worker_should_stop(worker)) {
        perform_unit(team, worker, eng_units_take_newest(units));
        publish(seat, worker);
        if (atomic_load_explicit(&seat->requests_seen, memory_order_relaxed) > 0) {
            serve(assignment, seat, worker, false);
            publish(seat, worker);
        }
        if (eng_units_count(units) > 1) {
            eng_idle_wake(assignment, eng_units_count(units) - 1);
        }
    }
    units->head = units->tail; /* when stopped */
    publish(seat, worker);
    serve(assignment, seat, worker, true);
    eng_assignment_leave(assignment);
}

/* The thread whose (k + 1)th unit is largest, k requests being ahead of ours; or none. */
static struct eng_seat *choose_victim(const struct eng_team *team, uint32_t thread)
{
    struct eng_seat *victim = NULL;
    uint32_t largest = 0;
    for (uint32_t i = 0; i < team->count; i++) {
        struct eng_seat *seat = &eng_paper_of(team->scene)->assignment.seats[i];
        uint32_t k = atomic_load_explicit(&seat->requests_seen, memory_order_relaxed);
        if (i == thread || k + 1 >= ENG_OFFERS_MAX) {
            continue;
        }
        uint32_t size = atomic_load_explicit(&seat->offers[k], memory_order_relaxed);
        /* The last one stays with its thread. */
        bool has_more =
            atomic_load_explicit(&seat->offers[k + 1], memory_order_relaxed) > 0;
        if (has_more && size > largest) {
            largest = size;
            victim = seat;
        }
    }
    return victim;
}

/* Place a request and sleep until it is answered. False: not taken, or denied. */
static bool request(struct eng_seat *victim, struct eng_seat *seat,
                    struct eng_worker *worker, uint32_t *node)
{
    seat->reply = ENG_REPLY_NONE; /* nobody else knows of us yet */
    pthread_mutex_lock(&victim->lock);
    bool taken = victim->takes_requests;
    if (taken) {
        victim->requests[victim->request_count++] = worker->thread;
        atomic_store_explicit(&victim->requests_seen, victim->request_count,
                              memory_order_relaxed);
    }
    pthread_mutex_unlock(&victim->lock);
    if (!taken) {
        return false;
    }
    worker->record.requests++;
    worker->record.sleeps++;
    pthread_mutex_lock(&seat->lock);
    while (seat->reply == ENG_REPLY_NONE) {
        pthread_cond_wait(&seat->wake, &seat->lock);
    }
    *node = seat->given;
    bool given = seat->reply == ENG_REPLY_GIVEN;
    pthread_mutex_unlock(&seat->lock);
    worker->record.steals += given;
    return given;
}

/* Work from another thread; false: there is none anywhere. */
static bool find_work(struct eng_team *team, struct eng_seat *seat,
                      struct eng_worker *worker, uint32_t *node)
{
    uint64_t begin_ns = common_now_ns();
    bool found = false;
    while (!found && atomic_load_explicit(&eng_paper_of(team->scene)->assignment.active,
                                          memory_order_acquire) > 0) {
        struct eng_seat *victim = choose_victim(team, worker->thread);
        if (victim) {
            found = request(victim, seat, worker, node);
        } else {
            worker->record.sleeps++;
            eng_idle_sleep(&eng_paper_of(team->scene)->assignment);
        }
    }
    eng_worker_waited(worker, begin_ns);
    return found;
}

static void open_seat(struct eng_seat *seat)
{
    pthread_mutex_lock(&seat->lock);
    seat->takes_requests = true;
    pthread_mutex_unlock(&seat->lock);
}

static void perform_all_units(struct eng_team *team, struct eng_worker *worker)
{
    struct eng_seat *seat = &eng_paper_of(team->scene)->assignment.seats[worker->thread];
    struct eng_unit_queue *units = &eng_paper_work_of(worker)->units;
    uint32_t node;
    bool has_work = eng_units_count(units) > 0;
    if (!has_work && find_work(team, seat, worker, &node)) {
        eng_units_push(units, node);
        has_work = true;
    }
    while (has_work) {
        uint64_t begin_ns = common_now_ns();
        open_seat(seat);
        perform_units(team, seat, worker);
        eng_taskunit_flush(worker);
        worker->record.low_ns += common_now_ns() - begin_ns;
        has_work = find_work(team, seat, worker, &node);
        if (has_work) {
            eng_units_push(units, node);
        }
    }
}

void eng_schedule_paper(struct eng_team *team, struct eng_worker *worker)
{
    assert(worker->thread < team->count);
    perform_all_units(team, worker);
    eng_wait_for_all(worker);
    worker->low_end_ns = common_now_ns();
    perform_high_levels(team, worker);
}
