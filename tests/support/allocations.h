/* allocations.h - counts how often this process asks for memory. */
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
