/* allocations.c - how often this process has asked for memory. */
#include "allocations.h"

#include <stdatomic.h>
#include <stddef.h>

static atomic_uint allocations;

unsigned test_allocations(void)
{
    return atomic_load(&allocations);
}

#if TEST_COUNTS_ALLOCATIONS

#define EXPORTED __attribute__((visibility("default"))) /* in the place of libc's */

void *__libc_malloc(size_t bytes);
void *__libc_calloc(size_t count, size_t bytes);
void *__libc_realloc(void *old, size_t bytes);

EXPORTED void *malloc(size_t bytes)
{
    (void)atomic_fetch_add(&allocations, 1);
    return __libc_malloc(bytes);
}

EXPORTED void *calloc(size_t count, size_t bytes)
{
    (void)atomic_fetch_add(&allocations, 1);
    return __libc_calloc(count, bytes);
}

EXPORTED void *realloc(void *old, size_t bytes)
{
    (void)atomic_fetch_add(&allocations, 1);
    return __libc_realloc(old, bytes);
}

#endif
