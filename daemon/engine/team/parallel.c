/* parallel.c - the begin and the end of parallel regions, and loops over many items. */
#include "parallel.h"

#include <assert.h>
#include <omp.h>
#include <stdatomic.h>
#include <stdbool.h>

#include "wait.h"

static _Thread_local bool is_guest;
static _Thread_local struct common_rounding guests;

void eng_guest_enter(void)
{
    assert(!is_guest);
    guests = common_rounding_enter();
    is_guest = true;
}

void eng_guest_leave(void)
{
    assert(is_guest);
    is_guest = false;
    common_rounding_set(&guests);
}

struct eng_parallel eng_parallel_open(void)
{
    if (is_guest) {
        common_rounding_set(&guests);
    }
    return (struct eng_parallel){.payer = eng_payer()};
}

void eng_parallel_close(void)
{
    if (is_guest) {
        (void)common_rounding_enter();
    }
}

void eng_parallel_for(const struct eng_parallel_for *each)
{
    assert(each && each->item && each->threads >= 1);
    uint32_t threads = each->threads < each->count ? each->threads : each->count;
    if (threads < 2) {
        for (uint32_t i = 0; i < each->count; i++) {
            each->item(each->context, i, 0);
        }
        return;
    }
    atomic_uint next;
    atomic_uint ended;
    atomic_init(&next, 0);
    atomic_init(&ended, 0);
    struct eng_parallel region = eng_parallel_open();
#pragma omp parallel num_threads((int)threads)
    {
        ENG_PARALLEL_JOIN(region);
        uint32_t thread = (uint32_t)omp_get_thread_num();
        uint32_t team_count = (uint32_t)omp_get_num_threads();
        eng_affinity_bind_thread(each->affinity, thread, team_count);
        for (uint32_t i = thread; i < each->count;
             i = team_count + atomic_fetch_add_explicit(&next, 1, memory_order_relaxed)) {
            each->item(each->context, i, thread);
        }
        /* As in ingest.c: the runtime's barrier would lend nobody a processor. */
        atomic_fetch_add_explicit(&ended, 1, memory_order_acq_rel);
        eng_wait_plainly(each->affinity, thread, &ended, team_count);
    } /* the end of the region orders all items before what follows */
    eng_parallel_close();
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
