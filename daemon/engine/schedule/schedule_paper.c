/* daemon/engine/schedule/schedule_paper.c - the paper's own scheduler.
 *
 * Room:     engine.
 * Does:     deal out one low-level node to each thread; a thread that runs out asks
 *           another for its front node and sleeps until it is answered; when all
 *           low-level nodes are done, work through the high-level nodes above them, each
 *           by all threads.
 * Threads:  [team].
 * Source:   paper sections 4.2 (initial assignment), 4.3 (dynamic assignment), 5.1 (a
 *           task unit by several threads, pairs dealt out round robin).
 *
 * A node is only ever below one thread's nodes (disjoint task units), so the main loop
 * takes no lock. `active` counts threads that have work or to whom work is on its way; it
 * is zero when the low-level nodes are done.
 */
#include "schedule.h"

#include <time.h>

#include "rebuild.h"
#include "taskunit.h"

void eng_schedule_paper_begin(struct eng_team *team, struct eng_worker *worker)
{
    struct eng_assignment *assignment = team->assignment;
    const struct eng_scene *scene = team->scene;
    uint32_t *queue = assignment->high; /* breadth-first; opened nodes stay in front */
    uint32_t opened = 0;
    uint32_t count = 0;
    uint32_t front[ENG_THREADS_MAX];
    uint32_t front_count = 0;
    if (scene->root != ENG_NO_NODE) {
        front[front_count++] = scene->root;
    }
    /* Opening a node replaces it by two: the queue keeps its order when the children go
     * to the end and the rest moves up. */
    while (front_count > 0 && front_count < team->count && opened < team->count) {
        const struct eng_node *node = eng_node_open(worker, front[0]);
        if (node->left == ENG_LEAF) {
            break; /* breadth-first: what follows is as small */
        }
        queue[count++] = front[0];
        for (uint32_t i = 1; i < front_count; i++) {
            front[i - 1] = front[i];
        }
        front[front_count - 1] = node->left;
        front[front_count++] = node->right;
        opened++;
    }
    assignment->high_count = count;
    for (uint32_t i = 0; i < team->count; i++) {
        struct eng_seat *seat = &assignment->seats[i];
        seat->first_node = i < front_count ? front[i] : ENG_NO_NODE;
        seat->takes_requests = i < front_count;
        seat->request_count = 0;
        atomic_store_explicit(&seat->requests_seen, 0, memory_order_relaxed);
        for (uint32_t k = 0; k < ENG_OFFERS_MAX; k++) {
            atomic_store_explicit(&seat->offers[k], 0, memory_order_relaxed);
        }
    }
    atomic_store_explicit(&assignment->active, front_count, memory_order_relaxed);
}

static uint32_t queued(const struct eng_task_queue *units)
{
    return units->tail - units->head;
}

static uint32_t dequeue(struct eng_task_queue *units)
{
    return units->nodes[units->head++ & (units->capacity - 1)];
}

/* Let others see how large the front nodes are. Relaxed: a hint; the lock decides. */
static void publish(struct eng_seat *seat, const struct eng_worker *worker)
{
    const struct eng_task_queue *units = &worker->units;
    for (uint32_t k = 0; k < ENG_OFFERS_MAX; k++) {
        uint32_t size = 0;
        if (k < queued(units)) {
            uint32_t node = units->nodes[(units->head + k) & (units->capacity - 1)];
            size = worker->scene->nodes[node].count;
        }
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

/* Give front nodes to those who asked, oldest first, and keep one; with `close`, send the
 * rest away and take no more requests. */
static void serve(struct eng_assignment *assignment, struct eng_seat *seat,
                  struct eng_worker *worker, bool close)
{
    struct eng_task_queue *units = &worker->units;
    pthread_mutex_lock(&seat->lock);
    uint32_t served = 0;
    while (served < seat->request_count && (close || queued(units) > 1)) {
        struct eng_seat *asker = &assignment->seats[seat->requests[served++]];
        if (queued(units) > 1) {
            /* Counted before the asker wakes, so that `active` is not zero meanwhile. */
            atomic_fetch_add_explicit(&assignment->active, 1, memory_order_relaxed);
            worker->record.given++;
            answer(asker, ENG_REPLY_GIVEN, dequeue(units));
        } else {
            answer(asker, ENG_REPLY_DENIED, ENG_NO_NODE);
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

/* The main loop of section 4.3: no lock unless somebody asks. */
static void perform_units(struct eng_assignment *assignment, struct eng_seat *seat,
                          struct eng_worker *worker)
{
    struct eng_task_queue *units = &worker->units;
    while (queued(units) > 0 && !eng_worker_should_stop(worker)) {
        eng_taskunit_perform(worker, dequeue(units), true);
        publish(seat, worker);
        if (atomic_load_explicit(&seat->requests_seen, memory_order_relaxed) > 0) {
            serve(assignment, seat, worker, false);
            publish(seat, worker);
        }
    }
    units->head = units->tail; /* when stopped */
    publish(seat, worker);
    serve(assignment, seat, worker, true);
    /* Release: whoever sees zero sees what every thread found. */
    atomic_fetch_sub_explicit(&assignment->active, 1, memory_order_acq_rel);
}

/* The thread whose (k + 1)th node is largest, k requests being ahead of ours; or none. */
static struct eng_seat *choose_victim(const struct eng_team *team, uint32_t thread)
{
    struct eng_seat *victim = NULL;
    uint32_t largest = 0;
    for (uint32_t i = 0; i < team->count; i++) {
        struct eng_seat *seat = &team->assignment->seats[i];
        uint32_t k = atomic_load_explicit(&seat->requests_seen, memory_order_relaxed);
        if (i == thread || k + 1 >= ENG_OFFERS_MAX) {
            continue;
        }
        uint32_t size = atomic_load_explicit(&seat->offers[k], memory_order_relaxed);
        /* The last node stays with its thread. */
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
    uint64_t begin_ns = eng_now_ns();
    bool found = false;
    while (!found &&
           atomic_load_explicit(&team->assignment->active, memory_order_acquire) > 0) {
        struct eng_seat *victim = choose_victim(team, worker->thread);
        if (victim) {
            found = request(victim, seat, worker, node);
        } else {
            worker->record.sleeps++;
            nanosleep(&(struct timespec){0, ENG_PAPER_RETRY_NS}, NULL);
        }
    }
    eng_worker_waited(worker, begin_ns);
    return found;
}

static void enqueue(struct eng_worker *worker, uint32_t node)
{
    struct eng_task_queue *units = &worker->units;
    units->nodes[units->tail++ & (units->capacity - 1)] = node;
}

static void open_seat(struct eng_seat *seat)
{
    pthread_mutex_lock(&seat->lock);
    seat->takes_requests = true;
    pthread_mutex_unlock(&seat->lock);
}

/* Low-level nodes. */
static void perform_low(struct eng_team *team, struct eng_worker *worker)
{
    struct eng_assignment *assignment = team->assignment;
    struct eng_seat *seat = &assignment->seats[worker->thread];
    uint32_t node = seat->first_node;
    bool has_work = node != ENG_NO_NODE || find_work(team, seat, worker, &node);
    while (has_work) {
        uint64_t begin_ns = eng_now_ns();
        enqueue(worker, node);
        open_seat(seat);
        perform_units(assignment, seat, worker);
        eng_taskunit_flush(worker);
        worker->record.low_ns += eng_now_ns() - begin_ns;
        has_work = find_work(team, seat, worker, &node);
    }
}

/* Refine the pair of a high-level node's children breadth-first until there are enough
 * pairs to deal out. */
static void expand_high(struct eng_team *team, struct eng_worker *worker, uint32_t node)
{
    struct eng_assignment *assignment = team->assignment;
    const struct eng_node *opened = eng_node_open(worker, node);
    uint32_t wanted = ENG_PAIRS_PER_THREAD * team->count;
    uint32_t head = 0;
    uint64_t *pairs = assignment->pairs;
    worker->record.task_units++;
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

/* Every thread's share of a high-level node's pairs. */
static void perform_share(struct eng_team *team, struct eng_worker *worker, uint32_t node)
{
    struct eng_assignment *assignment = team->assignment;
    uint64_t high_ns = eng_worker_slice(worker);
    uint32_t performed = 0;
    for (uint32_t k = worker->thread;
         k < assignment->pair_count && !eng_worker_should_stop(worker);
         k += team->count) {
        uint64_t begin_ns = eng_worker_slice(worker);
        uint32_t n = (uint32_t)(assignment->pairs[k] >> 32);
        uint32_t m = (uint32_t)assignment->pairs[k];
        eng_taskunit_pairs(worker, n, m);
        eng_worker_trace(worker, ENG_TRACE_PAIRS, begin_ns, n, m);
        performed++;
    }
    eng_worker_trace(worker, ENG_TRACE_HIGH, high_ns, node, performed);
}

/* High-level nodes, the deepest first; every thread works on the same one. */
static void perform_high(struct eng_team *team, struct eng_worker *worker)
{
    struct eng_assignment *assignment = team->assignment;
    for (uint32_t i = assignment->high_count; i-- > 0;) {
        uint32_t node = assignment->high[i];
        if (worker->thread == 0) {
            uint64_t begin_ns = eng_now_ns();
            expand_high(team, worker, node);
            worker->record.high_ns += eng_now_ns() - begin_ns;
        }
        eng_worker_barrier(worker);
        uint64_t dealt_ns = eng_now_ns();
        perform_share(team, worker, node);
        worker->record.high_ns += eng_now_ns() - dealt_ns;
        eng_worker_barrier(worker); /* the pairs make room for the next node's */
    }
}

void eng_schedule_paper(struct eng_team *team, struct eng_worker *worker)
{
    perform_low(team, worker);
    eng_worker_barrier(worker);
    if (worker->thread == 0) {
        team->low_end_ns = eng_now_ns();
    }
    perform_high(team, worker);
    uint64_t begin_ns = eng_now_ns();
    eng_taskunit_flush(worker);
    worker->record.high_ns += eng_now_ns() - begin_ns;
}
