/* each.c - many items, dealt out to several threads. */
#include "each.h"

#include <assert.h>
#include <omp.h>
#include <stdatomic.h>

#include "parallel.h"
#include "wait.h"

void eng_each(const struct eng_each *each)
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
