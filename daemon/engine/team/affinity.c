/* affinity.c - where the threads of a team run. */
#include "affinity.h"

#include <assert.h>
#include <omp.h>
#include <pthread.h>
#include <stddef.h>

#include "parallel.h"
#include "seat.h"

/* Not known: none of what processors.h names. */
enum { UNKNOWN = -2 };

/* Where this thread was bound. A new one inherits the mask of the thread that opened the
 * region, not this. */
static _Thread_local int placed_on = UNKNOWN;

void eng_affinity_bind_thread(const struct eng_affinity *affinity, uint32_t thread,
                              uint32_t team_count)
{
    assert(thread < team_count);
    if (!affinity || affinity->count == 0) {
        return;
    }
    if (affinity->is_guest && thread == 0) {
        return;
    }
    eng_seat_take(affinity, thread, team_count);
    if (eng_seat_end_loan(affinity, thread, team_count)) {
        placed_on = UNKNOWN;
    }
    int place = team_count > affinity->count ? ENG_ANYWHERE
                : affinity->is_guest         ? ENG_KEPT_OFF - affinity->first_on
                                             : affinity->cpu[thread];
    if (placed_on != place && eng_affinity_bind(affinity, place, pthread_self())) {
        placed_on = place;
    }
}

void eng_affinity_return(const struct eng_affinity *affinity, uint32_t thread,
                         uint32_t team_count)
{
    if (eng_seat_end_loan(affinity, thread, team_count)) {
        placed_on = UNKNOWN;
        eng_affinity_bind_thread(affinity, thread, team_count);
    }
}

void eng_affinity_warm_up(const struct eng_affinity *affinity, uint32_t threads)
{
    struct eng_parallel region = eng_parallel_open();
#pragma omp parallel num_threads((int)threads)
    {
        ENG_PARALLEL_JOIN(region);
        eng_affinity_bind_thread(affinity, (uint32_t)omp_get_thread_num(),
                                 (uint32_t)omp_get_num_threads());
    }
    eng_parallel_close();
}
