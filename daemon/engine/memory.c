/* daemon/engine/memory.c - the engine's allocations, counted.
 *
 * Room:     engine.
 * Does:     put a 128-byte header with the size before each block, so that bytes can be
 *           counted down when a block goes.
 * Threads:  [any]; counters and limit are atomics.
 */
#include "memory.h"

#include <stdatomic.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#define ALIGNMENT    128u
#define HEADER_BYTES ALIGNMENT

static atomic_uint_fast64_t alloc_count;
static atomic_uint_fast64_t alloc_bytes;
static atomic_uint_fast64_t byte_limit = UINT64_MAX;
static atomic_uint_fast64_t refused_count;

/* Count a block before it is made: together the threads of a team keep the limit. */
static bool charge(size_t total)
{
    /* Relaxed: the counters order nothing. */
    uint64_t before =
        atomic_fetch_add_explicit(&alloc_bytes, total, memory_order_relaxed);
    if (before + total <= atomic_load_explicit(&byte_limit, memory_order_relaxed)) {
        return true;
    }
    atomic_fetch_sub_explicit(&alloc_bytes, total, memory_order_relaxed);
    atomic_fetch_add_explicit(&refused_count, 1, memory_order_relaxed);
    return false;
}

void *eng_alloc(size_t count, size_t bytes)
{
    size_t total;
    if (__builtin_mul_overflow(count, bytes, &total) ||
        __builtin_add_overflow(total, HEADER_BYTES + ALIGNMENT - 1, &total)) {
        return NULL;
    }
    total &= ~(size_t)(ALIGNMENT - 1);
    if (!charge(total)) {
        return NULL;
    }
    unsigned char *base = aligned_alloc(ALIGNMENT, total);
    if (!base) {
        atomic_fetch_sub_explicit(&alloc_bytes, total, memory_order_relaxed);
        return NULL;
    }
    memcpy(base, &total, sizeof total);
    atomic_fetch_add_explicit(&alloc_count, 1, memory_order_relaxed);
    return base + HEADER_BYTES;
}

static size_t total_of(const void *block)
{
    size_t total;
    memcpy(&total, (const unsigned char *)block - HEADER_BYTES, sizeof total);
    return total;
}

void *eng_realloc(void *block, size_t count, size_t bytes)
{
    void *grown = eng_alloc(count, bytes);
    if (!grown || !block) {
        return grown;
    }
    size_t old_bytes = total_of(block) - HEADER_BYTES;
    size_t new_bytes = count * bytes;
    memcpy(grown, block, old_bytes < new_bytes ? old_bytes : new_bytes);
    eng_free(block);
    return grown;
}

void eng_free(void *block)
{
    if (!block) {
        return;
    }
    atomic_fetch_sub_explicit(&alloc_bytes, total_of(block), memory_order_relaxed);
    free((unsigned char *)block - HEADER_BYTES);
}

uint64_t eng_alloc_count(void)
{
    return atomic_load_explicit(&alloc_count, memory_order_relaxed);
}

uint64_t eng_alloc_bytes(void)
{
    return atomic_load_explicit(&alloc_bytes, memory_order_relaxed);
}

uint64_t eng_alloc_limit(uint64_t bytes)
{
    atomic_store_explicit(&byte_limit, bytes, memory_order_relaxed);
    return atomic_load_explicit(&refused_count, memory_order_relaxed);
}
