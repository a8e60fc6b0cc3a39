/* laststep.c - what the threads of the last step did. */
#include "laststep.h"

#include <stdlib.h>
#include <string.h>

#include "invariant.h"

struct srv_laststep *srv_laststep_new(struct srv_laststep_spare *spare, uint32_t threads)
{
    size_t bytes = threads * sizeof(struct srv_laststep_thread);
    /* Acquire: pairs with the release where it was put; what was in it is not read any
     * more. */
    struct srv_laststep *last =
        atomic_exchange_explicit(&spare->last, NULL, memory_order_acquire);
    if (last != NULL && last->capacity < threads) {
        free(last);
        last = NULL;
    }
    uint32_t capacity = last != NULL ? last->capacity : threads;
    if (last == NULL) {
        last = malloc(sizeof *last + bytes);
    }
    if (last != NULL) {
        *last = (struct srv_laststep){.thread_count = threads, .capacity = capacity};
        memset(last->threads, 0, bytes);
    }
    return last;
}

struct srv_laststep *srv_laststep_of(struct srv_laststep_spare *spare,
                                     const struct eng_step_result *step)
{
    struct srv_laststep *last = srv_laststep_new(spare, step->threads);
    for (uint32_t i = 0; last != NULL && i < step->threads; i++) {
        last->threads[i].record = step->thread_records[i];
    }
    return last;
}

void srv_laststep_set(struct srv_laststep_spare *spare, struct srv_laststep **slot,
                      struct srv_laststep *last)
{
    srv_assert_loop();
    if (last != NULL) {
        last->refs++;
    }
    if (*slot != NULL && --(*slot)->refs == 0) {
        free(atomic_exchange_explicit(&spare->last, *slot, memory_order_acq_rel));
    }
    *slot = last;
}

void srv_laststep_deinit(struct srv_laststep_spare *spare)
{
    free(atomic_exchange(&spare->last, NULL));
}
