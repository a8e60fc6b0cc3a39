/* daemon/engine/schedule/place.c - where the threads of a team run.
 *
 * Room:     engine.
 * Does:     sched_setaffinity of each thread; a thread knows where it was put.
 * Threads:  place.h.
 */
#include "place.h"

#include <omp.h>
#include <sched.h>
#include <stdatomic.h>
#include <stddef.h>

#include "memory.h"
#include "seat.h"

/* KEPT_OFF - n: bound to all but the n-th. */
enum { KEPT_OFF = -3, UNKNOWN = -2, ANYWHERE = -1 };

/* Where this thread was bound. A new one inherits the mask of the thread that opened the
 * region, not this. */
static _Thread_local int placed_on = UNKNOWN;

void eng_places_init(struct eng_places *places)
{
    cpu_set_t set;
    places->count = 0;
    places->team = 0;
    places->is_guest = false;
    places->first_on = 0;
    (void)omp_get_max_threads();
    if (sched_getaffinity(0, sizeof set, &set) != 0) {
        return;
    }
    for (uint32_t cpu = 0; cpu < CPU_SETSIZE && places->count < ENG_PLACES_MAX; cpu++) {
        if (CPU_ISSET(cpu, &set)) {
            places->cpu[places->count++] = (uint16_t)cpu;
        }
    }
}

void eng_places_for_team(const struct eng_places *first, uint32_t team,
                         struct eng_places *places)
{
    *places = *first;
    places->team = team;
    for (uint32_t i = 0; i < first->count; i++) {
        places->cpu[i] = first->cpu[(i + team) % first->count];
    }
}

bool eng_places_bind(const struct eng_places *places, int cpu, pthread_t thread)
{
    cpu_set_t set;
    CPU_ZERO(&set);
    for (uint32_t i = 0; i < places->count; i++) {
        bool is_meant = cpu == ANYWHERE || places->cpu[i] == cpu ||
                        (cpu <= KEPT_OFF && places->cpu[i] != KEPT_OFF - cpu);
        if (is_meant) {
            CPU_SET(places->cpu[i], &set);
        }
    }
    return pthread_setaffinity_np(thread, sizeof set, &set) == 0;
}

void eng_place_thread(const struct eng_places *places, uint32_t thread,
                      uint32_t team_count)
{
    if (!places || places->count == 0) {
        return;
    }
    if (places->is_guest && thread == 0) {
        return;
    }
    eng_seat_take(places, thread, team_count);
    if (eng_seat_end_loan(places, thread, team_count)) {
        placed_on = UNKNOWN;
    }
    int place = team_count > places->count ? ANYWHERE
                : places->is_guest         ? KEPT_OFF - places->first_on
                                           : places->cpu[thread];
    if (placed_on != place && eng_places_bind(places, place, pthread_self())) {
        placed_on = place;
    }
}

void eng_place_return(const struct eng_places *places, uint32_t thread,
                      uint32_t team_count)
{
    if (eng_seat_end_loan(places, thread, team_count)) {
        placed_on = UNKNOWN;
        eng_place_thread(places, thread, team_count);
    }
}

uint32_t eng_places_processors(const struct eng_places *places)
{
    static atomic_uint known;
    if (places) {
        return places->count;
    }
    uint32_t count = atomic_load_explicit(&known, memory_order_relaxed);
    if (count == 0) {
        cpu_set_t set;
        count =
            sched_getaffinity(0, sizeof set, &set) == 0 ? (uint32_t)CPU_COUNT(&set) : 1;
        atomic_store_explicit(&known, count, memory_order_relaxed);
    }
    return count;
}

void eng_places_warm_up(const struct eng_places *places, uint32_t threads)
{
    struct eng_payer *payer = eng_payer();
#pragma omp parallel num_threads((int)threads)
    {
        eng_payer_join(payer);
        eng_place_thread(places, (uint32_t)omp_get_thread_num(),
                         (uint32_t)omp_get_num_threads());
    }
}
