/* pool.c - blocks of memory shared by the workers of a step. */
#include "pool.h"

#include <assert.h>
#include <stdbool.h>
#include <stddef.h>

#include "memory.h"

void eng_pool_init(struct eng_pool *pool)
{
    pool->blocks = pool->lent = NULL;
    pool->capacity = pool->lent_count = 0;
    atomic_init(&pool->taken, 0);
    atomic_init(&pool->spilled, NULL);
}

static void free_spilled(struct eng_pool *pool)
{
    struct eng_block *block = atomic_load_explicit(&pool->spilled, memory_order_relaxed);
    while (block) {
        struct eng_block *next = block->spill_next;
        eng_free(block);
        block = next;
    }
    atomic_store_explicit(&pool->spilled, NULL, memory_order_relaxed);
}

void eng_pool_deinit(struct eng_pool *pool)
{
    free_spilled(pool);
    eng_free(pool->blocks);
    eng_pool_init(pool);
}

void eng_pool_reset(struct eng_pool *pool, uint32_t workers)
{
    assert(workers >= 1);
    uint32_t taken = atomic_load_explicit(&pool->taken, memory_order_relaxed);
    taken = taken > pool->lent_count ? taken - pool->lent_count : 0;
    free_spilled(pool);
    if (taken > pool->capacity || pool->capacity < workers) {
        uint32_t capacity = taken + taken / 4 + 2 * workers;
        struct eng_block *blocks = eng_alloc(capacity, sizeof *blocks);
        if (blocks) {
            eng_free(pool->blocks);
            pool->blocks = blocks;
            pool->capacity = capacity;
        }
    }
    atomic_store_explicit(&pool->taken, 0, memory_order_relaxed);
}

void eng_pool_lend(struct eng_pool *pool, void *memory, uint64_t bytes)
{
    assert(atomic_load_explicit(&pool->taken, memory_order_relaxed) == 0);
    assert((uintptr_t)memory % ENG_BLOCK_HEADER_BYTES == 0);
    uint64_t count = memory ? bytes / sizeof *pool->lent : 0;
    pool->lent = memory;
    pool->lent_count = count < UINT32_MAX / 2 ? (uint32_t)count : UINT32_MAX / 2;
}

/* A block that the pool did not foresee. */
static struct eng_block *spill(struct eng_pool *pool)
{
    struct eng_block *block = eng_alloc(1, sizeof *block);
    if (!block) {
        return NULL;
    }
    block->spill_next = atomic_load_explicit(&pool->spilled, memory_order_relaxed);
    /* Release: whoever walks the list after the region sees the link. */
    while (!atomic_compare_exchange_weak_explicit(&pool->spilled, &block->spill_next,
                                                  block, memory_order_release,
                                                  memory_order_relaxed)) {
    }
    return block;
}

struct eng_block *eng_pool_take(struct eng_pool *pool)
{
    /* Relaxed: each number is handed out once; the block is nobody else's. */
    uint32_t i = atomic_fetch_add_explicit(&pool->taken, 1, memory_order_relaxed);
    bool is_lent = i < pool->lent_count;
    uint32_t own = i - pool->lent_count; /* if it is not */
    struct eng_block *block = is_lent                ? &pool->lent[i]
                              : own < pool->capacity ? &pool->blocks[own]
                                                     : spill(pool);
    if (block) {
        block->next = NULL;
        block->count = 0;
    }
    return block;
}

uint64_t eng_pool_bytes(const struct eng_pool *pool)
{
    return (uint64_t)pool->capacity * sizeof *pool->blocks;
}
