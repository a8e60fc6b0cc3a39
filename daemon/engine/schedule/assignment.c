/* daemon/engine/schedule/assignment.c - what the paper's dynamic task assignment shares.
 *
 * Room:     engine.
 * Does:     make and free locks and lists; they stay from step to step.
 * Threads:  [compute].
 */
#include "assignment.h"

#include <string.h>

#include "memory.h"

void eng_assignment_init(struct eng_assignment *assignment)
{
    memset(assignment, 0, sizeof *assignment);
    atomic_init(&assignment->active, 0);
}

void eng_assignment_deinit(struct eng_assignment *assignment)
{
    for (uint32_t i = 0; i < assignment->capacity; i++) {
        pthread_mutex_destroy(&assignment->seats[i].lock);
        pthread_cond_destroy(&assignment->seats[i].wake);
        eng_free(assignment->seats[i].requests);
    }
    eng_free(assignment->seats);
    eng_free(assignment->high);
    eng_free(assignment->pairs);
    eng_assignment_init(assignment);
}

static bool init_seat(struct eng_seat *seat, uint32_t threads)
{
    memset(seat, 0, sizeof *seat);
    for (uint32_t i = 0; i < ENG_OFFERS_MAX; i++) {
        atomic_init(&seat->offers[i], 0);
    }
    atomic_init(&seat->requests_seen, 0);
    seat->requests = eng_alloc(threads, sizeof *seat->requests);
    /* Neither can fail on Linux with default attributes. */
    pthread_mutex_init(&seat->lock, NULL);
    pthread_cond_init(&seat->wake, NULL);
    return seat->requests != NULL;
}

int eng_assignment_reserve(struct eng_assignment *assignment, uint32_t threads)
{
    if (threads <= assignment->capacity) {
        return ENG_OK;
    }
    struct eng_assignment grown;
    eng_assignment_init(&grown);
    grown.seats = eng_alloc(threads, sizeof *grown.seats);
    grown.high = eng_alloc(threads, sizeof *grown.high);
    /* A refinement turns one pair into four. */
    grown.pairs = eng_alloc(ENG_PAIRS_PER_THREAD * threads + 4, sizeof *grown.pairs);
    bool good = grown.seats && grown.high && grown.pairs;
    for (uint32_t i = 0; i < threads && good; i++) {
        good = init_seat(&grown.seats[i], threads);
        grown.capacity = i + 1;
    }
    if (!good) {
        eng_assignment_deinit(&grown);
        return ENG_E_NOMEM;
    }
    eng_assignment_deinit(assignment);
    *assignment = grown;
    return ENG_OK;
}
