/* wrap_memory.c - allocations that fail on order. */
#include <errno.h>

#include "fault.h"

void *__real_malloc(size_t bytes);
void *__real_calloc(size_t count, size_t bytes);
void *__real_realloc(void *block, size_t bytes);
void *__real_aligned_alloc(size_t alignment, size_t bytes);
void __real_free(void *block);
void *__wrap_malloc(size_t bytes);
void *__wrap_calloc(size_t count, size_t bytes);
void *__wrap_realloc(void *block, size_t bytes);
void *__wrap_aligned_alloc(size_t alignment, size_t bytes);
void __wrap_free(void *block);

/* Return whether an allocation shall fail; errno is set then. */
static bool fails(size_t count, size_t bytes)
{
    size_t most = atomic_load(&fault_page->bytes_max);
    if (most > 0 && bytes > 0 && count > most / bytes) {
        atomic_fetch_add(&fault_page->refused, 1);
        errno = ENOMEM;
        return true;
    }
    return fault_strikes(FAULT_memory);
}

static void *hold(void *block)
{
    if (block != NULL) {
        atomic_fetch_add(&fault_page->held, 1);
    }
    return block;
}

void *__wrap_malloc(size_t bytes)
{
    return fails(1, bytes) ? NULL : hold(__real_malloc(bytes));
}

void *__wrap_calloc(size_t count, size_t bytes)
{
    return fails(count, bytes) ? NULL : hold(__real_calloc(count, bytes));
}

void *__wrap_realloc(void *block, size_t bytes)
{
    if (fault_strikes(FAULT_realloc) || fails(1, bytes)) {
        return NULL;
    }
    void *grown = __real_realloc(block, bytes);
    return block == NULL ? hold(grown) : grown;
}

void *__wrap_aligned_alloc(size_t alignment, size_t bytes)
{
    return fails(1, bytes) ? NULL : hold(__real_aligned_alloc(alignment, bytes));
}

void __wrap_free(void *block)
{
    if (block != NULL) {
        atomic_fetch_sub(&fault_page->held, 1);
    }
    __real_free(block);
}
