/* allocations.h - how often this process has asked for memory.
 *
 * Room:     tests/support. May include: the C library.
 * Does:     take the place of malloc, calloc and realloc in the program that it is a
 *           source of, libraries included.
 * Does not: count where a sanitizer owns them.
 * Threads:  [any].
 */
#ifndef TEST_ALLOCATIONS_H
#define TEST_ALLOCATIONS_H

#if defined(PCCD_SANITIZED)
#define TEST_COUNTS_ALLOCATIONS 0
#else
#define TEST_COUNTS_ALLOCATIONS 1
#endif

/* Since the start; 0 where they are not counted. */
unsigned test_allocations(void);

#endif
