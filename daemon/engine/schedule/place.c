/* daemon/engine/schedule/place.c - where the threads of a team run.
 *
 * Room:     engine.
 * Does:     sched_setaffinity of each thread for itself; a thread knows where it was put.
 * Threads:  place.h.
 */
#include "place.h"

#include <omp.h>
#include <sched.h>
#include <stddef.h>

enum { UNKNOWN = -2, ANYWHERE = -1 };

/* Where this thread was bound. A new one inherits the mask of the thread that opened the
 * region, not this. */
static _Thread_local int placed_on = UNKNOWN;

void eng_places_init(struct eng_places *places)
{
    cpu_set_t set;
    places->count = 0;
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

void eng_place_thread(const struct eng_places *places, uint32_t thread,
                      uint32_t team_count)
{
    if (!places || places->count == 0) {
        return;
    }
    int place = team_count <= places->count ? places->cpu[thread] : ANYWHERE;
    if (placed_on == place) {
        return;
    }
    cpu_set_t set;
    CPU_ZERO(&set);
    for (uint32_t i = 0; i < places->count; i++) {
        if (place == ANYWHERE || places->cpu[i] == place) {
            CPU_SET(places->cpu[i], &set);
        }
    }
    if (sched_setaffinity(0, sizeof set, &set) == 0) {
        placed_on = place;
    }
}

void eng_places_warm_up(const struct eng_places *places, uint32_t threads)
{
#pragma omp parallel num_threads((int)threads)
    {
        eng_place_thread(places, (uint32_t)omp_get_thread_num(),
                         (uint32_t)omp_get_num_threads());
    }
}
