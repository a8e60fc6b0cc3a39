/* processors.c - the processors that threads of a team can be bound to. */
#include "processors.h"

#include <assert.h>
#include <omp.h>
#include <sched.h>
#include <stdatomic.h>
#include <stddef.h>

void eng_affinity_init(struct eng_affinity *affinity)
{
    cpu_set_t set;
    affinity->count = 0;
    affinity->team = 0;
    affinity->is_guest = false;
    affinity->first_on = 0;
    (void)omp_get_max_threads();
    if (sched_getaffinity(0, sizeof set, &set) != 0) {
        return;
    }
    for (uint32_t cpu = 0; cpu < CPU_SETSIZE && affinity->count < ENG_PROCESSORS_MAX;
         cpu++) {
        if (CPU_ISSET(cpu, &set)) {
            affinity->cpu[affinity->count++] = (uint16_t)cpu;
        }
    }
}

void eng_affinity_for_team(const struct eng_affinity *first, uint32_t team,
                           struct eng_affinity *affinity)
{
    assert(team < ENG_TEAMS_MAX);
    *affinity = *first;
    affinity->team = team;
    for (uint32_t i = 0; i < first->count; i++) {
        affinity->cpu[i] = first->cpu[(i + team) % first->count];
    }
}

bool eng_affinity_bind(const struct eng_affinity *affinity, int cpu, pthread_t thread)
{
    assert(affinity->count <= ENG_PROCESSORS_MAX);
    cpu_set_t set;
    CPU_ZERO(&set);
    for (uint32_t i = 0; i < affinity->count; i++) {
        bool is_meant = cpu == ENG_ANYWHERE || affinity->cpu[i] == cpu ||
                        (cpu <= ENG_KEPT_OFF && affinity->cpu[i] != ENG_KEPT_OFF - cpu);
        if (is_meant) {
            CPU_SET(affinity->cpu[i], &set);
        }
    }
    return pthread_setaffinity_np(thread, sizeof set, &set) == 0;
}

uint32_t eng_affinity_processors(const struct eng_affinity *affinity)
{
    static atomic_uint known;
    if (affinity) {
        return affinity->count;
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
