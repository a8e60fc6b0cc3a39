/* taken.h - measures how much memory the kernel has allocated for what a test shares
 * with its daemon. */
#ifndef TEST_TAKEN_H
#define TEST_TAKEN_H

#include <stdint.h>

/* Bytes of the upload rings and result regions that this process has descriptors of. */
uint64_t test_taken_bytes(void);

/* Wait until they are at most `bytes`, 10 s at most. Returns what they are then. */
uint64_t test_taken_await(uint64_t bytes);

#endif
