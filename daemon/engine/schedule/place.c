/* place.c - where the threads of a team run.
 *
 * Room:     engine.
 * Does:     sched_setaffinity of each thread for itself; a thread knows where it was put.
 * Threads:  place.h.
 */
#include "place.h"

#include <omp.h>
#include <sched.h>
#include <stddef.h>

/* Where this thread was bound; a new one inherits its creator's processor, not this. */
static _Thread_local int placed_on = -1;

void eng_places_init(struct eng_places *places)
{
    cpu_set_t set;
    places->count = 0;
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
    if (!places || team_count > places->count || placed_on == places->cpu[thread]) {
        return;
    }
    cpu_set_t set;
    CPU_ZERO(&set);
    CPU_SET(places->cpu[thread], &set);
    if (sched_setaffinity(0, sizeof set, &set) == 0) {
        placed_on = places->cpu[thread];
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
