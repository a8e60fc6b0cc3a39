/* daemon/engine/step_memory.c - what one step leaves for the next.
 *
 * Room:     engine.
 * Does:     make workers when a step first needs them, free those that are not needed any
 *           more, and all with the scene.
 * Threads:  [compute].
 */
#include "step_memory.h"

#include <string.h>

#include "memory.h"
#include "wide_test.h"

/* A worker is 0.4 MB, and beside other processes a scene that one thread suffices for is
 * now and then taken for a larger one: who keeps its workers for ever has them for every
 * scene in the end. After so many steps without them they are freed; that is longer than
 * a scene goes without a team for which a team pays (effort.c, TRY_EVERY), and making
 * them anew is little beside so many steps. */
#define KEPT_STEPS 256u

struct eng_step_memory *eng_step_memory_new(void)
{
    struct eng_step_memory *memory = eng_alloc(1, sizeof *memory);
    if (memory) {
        memset(memory, 0, sizeof *memory);
        eng_pool_init(&memory->pool);
        eng_merge_init(&memory->merge);
        eng_assignment_init(&memory->assignment);
        eng_aside_init(&memory->aside);
    }
    return memory;
}

static void keep_workers(struct eng_step_memory *memory, uint32_t count)
{
    while (memory->worker_count > count) {
        struct eng_worker *worker = memory->workers[--memory->worker_count];
        eng_worker_deinit(worker);
        eng_free(worker);
    }
}

void eng_step_memory_free(struct eng_step_memory *memory)
{
    if (!memory) {
        return;
    }
    keep_workers(memory, 0);
    eng_free(memory->records);
    eng_refit_plan_deinit(&memory->plan);
    eng_assignment_deinit(&memory->assignment);
    eng_aside_deinit(&memory->aside);
    eng_pool_deinit(&memory->pool);
    eng_merge_deinit(&memory->merge);
    eng_records_deinit(&memory->sorted);
    eng_free(memory);
}

/* Free the workers that were not needed in a whole round of steps. */
static void count_turn(struct eng_step_memory *memory, uint32_t threads)
{
    memory->most_threads =
        threads > memory->most_threads ? threads : memory->most_threads;
    if (++memory->turn_count >= KEPT_STEPS) {
        keep_workers(memory, memory->most_threads);
        memory->most_threads = 0;
        memory->turn_count = 0;
    }
}

int eng_step_memory_reserve(struct eng_step_memory *memory, uint32_t threads)
{
    count_turn(memory, threads);
    if (threads > memory->worker_count) {
        struct eng_thread_record *records =
            eng_realloc(memory->records, threads, sizeof *records);
        if (!records) {
            return ENG_E_NOMEM;
        }
        memory->records = records;
    }
    while (memory->worker_count < threads) {
        struct eng_worker *worker = eng_alloc(1, sizeof *worker);
        if (!worker) {
            return ENG_E_NOMEM;
        }
        eng_worker_init(worker);
        memory->workers[memory->worker_count++] = worker;
    }
    return ENG_OK;
}

void eng_step_memory_forget(struct eng_step_memory *memory)
{
    memory->sorted.count = 0;
}

uint64_t eng_step_memory_bytes(const struct eng_step_memory *memory)
{
    uint64_t bytes = sizeof *memory + memory->sorted.capacity_bytes +
                     eng_pool_bytes(&memory->pool) + eng_merge_bytes(&memory->merge) +
                     eng_refit_plan_bytes(&memory->plan) +
                     eng_aside_bytes(&memory->aside);
    for (uint32_t i = 0; i < memory->worker_count; i++) {
        const struct eng_worker *worker = memory->workers[i];
        bytes += sizeof *worker + sizeof *memory->records +
                 worker->split_capacity * sizeof *worker->split_items +
                 (worker->wide ? sizeof *worker->wide : 0);
    }
    return bytes;
}
