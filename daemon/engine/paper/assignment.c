/* assignment.c - what the paper's dynamic task assignment shares. */
#include "assignment.h"

#include <assert.h>
#include <string.h>

#include "memory.h"

void eng_assignment_init(struct eng_assignment *assignment)
{
    memset(assignment, 0, sizeof *assignment);
    atomic_init(&assignment->active, 0);
    atomic_init(&assignment->idle.sleepers, 0);
    /* Neither can fail on Linux with default attributes. */
    pthread_mutex_init(&assignment->idle.lock, NULL);
    pthread_cond_init(&assignment->idle.wake, NULL);
}

static void free_seats(struct eng_seat *seats, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++) {
        pthread_mutex_destroy(&seats[i].lock);
        pthread_cond_destroy(&seats[i].wake);
        eng_free(seats[i].requests);
    }
    eng_free(seats);
}

void eng_assignment_deinit(struct eng_assignment *assignment)
{
    free_seats(assignment->seats, assignment->capacity);
    eng_free(assignment->high);
    eng_free(assignment->pairs);
    pthread_mutex_destroy(&assignment->idle.lock);
    pthread_cond_destroy(&assignment->idle.wake);
    memset(assignment, 0, sizeof *assignment);
}

static bool init_seat(struct eng_seat *seat, uint32_t threads)
{
    memset(seat, 0, sizeof *seat);
    for (uint32_t i = 0; i < ENG_OFFERS_MAX; i++) {
        atomic_init(&seat->offers[i], 0);
    }
    atomic_init(&seat->requests_seen, 0);
    atomic_init(&seat->current, ENG_NO_NODE);
    seat->requests = eng_alloc(threads, sizeof *seat->requests);
    pthread_mutex_init(&seat->lock, NULL);
    pthread_cond_init(&seat->wake, NULL);
    return seat->requests != NULL;
}

int eng_assignment_reserve(struct eng_assignment *assignment, uint32_t threads)
{
    assert(threads >= 1);
    if (threads <= assignment->capacity) {
        return PCCD_OK;
    }
    struct eng_seat *seats = eng_alloc(threads, sizeof *seats);
    uint32_t *high = eng_alloc(threads, sizeof *high);
    /* A refinement turns one pair into four. */
    uint64_t *pairs = eng_alloc(ENG_PAIRS_PER_THREAD * threads + 4, sizeof *pairs);
    bool good = seats && high && pairs;
    uint32_t made = 0;
    while (made < threads && good) {
        good = init_seat(&seats[made++], threads);
    }
    if (!good) {
        free_seats(seats, made);
        eng_free(high);
        eng_free(pairs);
        return PCCD_E_NOMEM;
    }
    free_seats(assignment->seats, assignment->capacity);
    eng_free(assignment->high);
    eng_free(assignment->pairs);
    assignment->seats = seats;
    assignment->high = high;
    assignment->pairs = pairs;
    assignment->capacity = threads;
    return PCCD_OK;
}

/* Acquire: whoever sees zero sees what every thread found. */
static bool somebody_has_work(struct eng_assignment *assignment)
{
    return atomic_load_explicit(&assignment->active, memory_order_acquire) > 0;
}

void eng_idle_sleep(struct eng_assignment *assignment)
{
    struct eng_idle_list *idle = &assignment->idle;
    pthread_mutex_lock(&idle->lock);
    uint32_t sleepers = atomic_load_explicit(&idle->sleepers, memory_order_relaxed);
    atomic_store_explicit(&idle->sleepers, sleepers + 1, memory_order_relaxed);
    /* The last one to leave takes the lock after its decrement: it is seen here, or wakes
     * us. */
    while (idle->calls == 0 && somebody_has_work(assignment)) {
        pthread_cond_wait(&idle->wake, &idle->lock);
    }
    if (idle->calls > 0) {
        idle->calls--;
    } else {
        sleepers = atomic_load_explicit(&idle->sleepers, memory_order_relaxed);
        atomic_store_explicit(&idle->sleepers, sleepers - 1, memory_order_relaxed);
    }
    pthread_mutex_unlock(&idle->lock);
}

void eng_idle_wake(struct eng_assignment *assignment, uint32_t nodes)
{
    struct eng_idle_list *idle = &assignment->idle;
    /* Relaxed: a hint; the lock decides. */
    if (atomic_load_explicit(&idle->sleepers, memory_order_relaxed) == 0) {
        return;
    }
    pthread_mutex_lock(&idle->lock);
    uint32_t sleepers = atomic_load_explicit(&idle->sleepers, memory_order_relaxed);
    uint32_t called = nodes < sleepers ? nodes : sleepers;
    idle->calls += called;
    atomic_store_explicit(&idle->sleepers, sleepers - called, memory_order_relaxed);
    for (uint32_t i = 0; i < called; i++) {
        pthread_cond_signal(&idle->wake);
    }
    pthread_mutex_unlock(&idle->lock);
}

void eng_assignment_enter(struct eng_assignment *assignment, uint32_t seat_count,
                          const struct eng_scene *scene, uint32_t seat, uint32_t node)
{
    assert(seat < seat_count && seat_count <= assignment->capacity);
    if (!PCCD_VALIDATE) {
        return;
    }
    /* seq_cst: of two threads that name their nodes and then look at each other's, one
     * sees the other. */
    atomic_store_explicit(&assignment->seats[seat].current, node, memory_order_seq_cst);
    for (uint32_t i = 0; i < seat_count && node != ENG_NO_NODE; i++) {
        uint32_t other =
            atomic_load_explicit(&assignment->seats[i].current, memory_order_seq_cst);
        if (i != seat && other != ENG_NO_NODE) {
            assert(!eng_node_is_below(scene, node, other) &&
                   !eng_node_is_below(scene, other, node));
        }
    }
}

void eng_assignment_leave(struct eng_assignment *assignment)
{
    /* Release: pairs with the acquire of whoever sees zero. */
    if (atomic_fetch_sub_explicit(&assignment->active, 1, memory_order_acq_rel) == 1) {
        pthread_mutex_lock(&assignment->idle.lock);
        pthread_cond_broadcast(&assignment->idle.wake);
        pthread_mutex_unlock(&assignment->idle.lock);
    }
}
