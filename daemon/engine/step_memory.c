/* step_memory.c - what one step leaves for the next. */
#include "step_memory.h"

#include <assert.h>
#include <string.h>

#include "memory.h"
#include "method.h"
#include "narrow.h"
#include "straight.h"

/* A worker takes 0.8 MB, and beside other processes a scene that one thread suffices for
 * is now and then taken for a larger one: if workers were kept for ever, every scene
 * would have them in the end. After so many steps without them they are freed; that is
 * longer than a scene goes without a team for which a team pays (effort.c, TRY_EVERY),
 * and making them anew is little beside so many steps. */
#define KEPT_STEPS 256u

static int create(struct eng_scene *scene)
{
    assert(!scene->slots[ENG_SLOT_STEP]);
    struct eng_step_memory *memory = eng_alloc(1, sizeof *memory);
    if (!memory) {
        return PCCD_E_NOMEM;
    }
    memset(memory, 0, sizeof *memory);
    eng_pool_init(&memory->own_pool);
    memory->pool = &memory->own_pool;
    eng_merge_init(&memory->own_merge);
    memory->merge = &memory->own_merge;
    scene->slots[ENG_SLOT_STEP] = memory;
    return PCCD_OK;
}

void eng_step_memory_keep(struct eng_step_memory *memory, uint32_t count)
{
    while (memory->worker_count > count) {
        struct eng_worker *worker = memory->workers[--memory->worker_count];
        for (int i = 0; i < PCCD_METHOD_COUNT; i++) {
            if (eng_methods[i]) {
                eng_methods[i]->work_free(worker);
            }
        }
        eng_narrow_free(worker);
        eng_turning_free(worker->turning);
        worker->turning = NULL;
        eng_straight()->free(worker->straight);
        worker->straight = NULL;
        eng_worker_deinit(worker);
        eng_free(worker);
    }
}

static void destroy(struct eng_scene *scene)
{
    struct eng_step_memory *memory = eng_step_memory_of(scene);
    if (!memory) {
        return;
    }
    eng_step_memory_keep(memory, 0);
    eng_free(memory->threads.items);
    eng_pool_deinit(&memory->own_pool);
    eng_merge_deinit(&memory->own_merge);
    eng_records_deinit(&memory->sorted);
    eng_records_deinit(&memory->found);
    eng_answer_cache_deinit(&memory->cache);
    eng_records_deinit(&memory->near.records);
    eng_records_deinit(&memory->near.none);
    eng_free(memory->near.threads.items);
    eng_free((void *)memory->near.bounds);
    eng_free(memory->near.order);
    eng_near_objects_deinit(&memory->near.objects);
    eng_turning_step_deinit(&memory->turning);
    eng_free(memory);
    scene->slots[ENG_SLOT_STEP] = NULL;
}

/* Free the workers that were not needed in a whole round of steps. */
static void count_turn(struct eng_step_memory *memory, uint32_t threads)
{
    memory->most_threads =
        threads > memory->most_threads ? threads : memory->most_threads;
    if (++memory->turn_count >= KEPT_STEPS) {
        eng_step_memory_keep(memory, memory->most_threads);
        memory->most_threads = 0;
        memory->turn_count = 0;
    }
}

bool eng_step_memory_stays(const struct eng_step_memory *memory)
{
    return memory->worker_count > 0 &&
           (memory->turn_count + 1 < KEPT_STEPS ||
            memory->worker_count <=
                (memory->most_threads > 1 ? memory->most_threads : 1));
}

int eng_step_memory_reserve(struct eng_step_memory *memory, uint32_t threads,
                            struct eng_thread_records *records)
{
    assert(threads >= 1 && threads <= ENG_THREADS_MAX);
    if (!memory->borrows) {
        count_turn(memory, threads);
    }
    if (threads > records->capacity) {
        struct eng_thread_record *items =
            eng_realloc(records->items, threads, sizeof *items);
        if (!items) {
            return PCCD_E_NOMEM;
        }
        records->items = items;
        records->capacity = threads;
    }
    while (memory->worker_count < threads) {
        struct eng_worker *worker = eng_alloc(1, sizeof *worker);
        if (!worker) {
            return PCCD_E_NOMEM;
        }
        if (eng_worker_init(worker) != PCCD_OK) {
            eng_free(worker);
            return PCCD_E_NOMEM;
        }
        memory->workers[memory->worker_count++] = worker;
    }
    return PCCD_OK;
}

void eng_step_memory_borrow(struct eng_step_memory *memory,
                            struct eng_step_memory *lender)
{
    assert(memory != lender && !memory->borrows && !lender->borrows);
    memory->own_first = memory->workers[0];
    memory->own_count = memory->worker_count;
    memory->workers[0] = lender->workers[0];
    memory->worker_count = lender->worker_count > 0 ? 1 : 0;
    memory->pool = &lender->own_pool;
    memory->merge = &lender->own_merge;
    memory->borrows = true;
}

void eng_step_memory_give_back(struct eng_step_memory *memory,
                               struct eng_step_memory *lender)
{
    assert(memory->borrows && memory->worker_count <= 1);
    if (memory->worker_count > lender->worker_count) { /* it was made meanwhile */
        lender->workers[0] = memory->workers[0];
        lender->worker_count = 1;
    }
    memory->workers[0] = memory->own_first;
    memory->worker_count = memory->own_count;
    memory->pool = &memory->own_pool;
    memory->merge = &memory->own_merge;
    memory->borrows = false;
    count_turn(memory, 0);
}

static void changed(struct eng_scene *scene)
{
    eng_step_memory_of(scene)->cache.objects_changed = true;
    eng_near_objects_forget(&eng_step_memory_of(scene)->near.objects);
}

/* The last answer's records are read until the next step. */
static void emptied(struct eng_scene *scene)
{
    struct eng_step_memory *memory = eng_step_memory_of(scene);
    assert(!memory->borrows);
    eng_pool_deinit(&memory->own_pool);
    eng_merge_deinit(&memory->own_merge);
    memory->was_emptied = true;
}

static uint64_t bytes_of(const struct eng_worker *worker)
{
    uint64_t bytes =
        sizeof *worker + eng_exact_bytes() + eng_per_pair_bytes(&worker->firsts);
    for (int i = 0; i < PCCD_METHOD_COUNT; i++) {
        bytes += eng_methods[i] ? eng_methods[i]->work_bytes(worker) : 0;
    }
    return bytes + eng_narrow_bytes(worker) + eng_turning_bytes(worker->turning) +
           eng_straight()->bytes(worker->straight);
}

uint64_t eng_step_memory_bytes(const struct eng_scene *scene)
{
    const struct eng_step_memory *memory = eng_step_memory_of(scene);
    uint64_t sum =
        sizeof *memory + memory->sorted.capacity_bytes + memory->found.capacity_bytes +
        eng_answer_cache_bytes(&memory->cache) + eng_pool_bytes(&memory->own_pool) +
        eng_merge_bytes(&memory->own_merge) + memory->near.records.capacity_bytes +
        ((uint64_t)memory->threads.capacity + memory->near.threads.capacity) *
            sizeof(struct eng_thread_record) +
        memory->near.bound_capacity * sizeof *memory->near.bounds +
        memory->near.order_capacity * sizeof *memory->near.order +
        eng_near_objects_bytes(&memory->near.objects) +
        eng_turning_step_bytes(&memory->turning);
    for (uint32_t i = 0; i < memory->worker_count; i++) {
        sum += bytes_of(memory->workers[i]);
    }
    return sum;
}

const struct eng_slot_calls eng_step_slot = {.create = create,
                                             .destroy = destroy,
                                             .bytes = eng_step_memory_bytes,
                                             .changed = changed,
                                             .emptied = emptied};
