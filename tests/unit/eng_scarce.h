/* eng_scarce.h - replaces the engine's memory functions by ones that fail on order.
 *
 * Threads: eng_alloc and its kin: any; the rest: one, while no step runs.
 */
#ifndef TEST_ENG_SCARCE_H
#define TEST_ENG_SCARCE_H

#include "eng_kit.h"

#include "memory.h"

struct scarce {
    uint64_t allocations; /* since the start */
    uint64_t held_blocks;
    uint64_t held_bytes;
    uint64_t countdown; /* the allocation that brings it to 0 fails; 0: none does */
    bool goes_on_failing;
    bool is_failing;
    uint64_t failures;
};

extern struct scarce scarce;

/* Memory comes back once a call has said that it failed. */
bool scarce_recovered(int status);

/* Do it; if memory ran out, do it again. */
#define RETRY(call)                                                                      \
    do {                                                                                 \
        if (!scarce_recovered(call)) {                                                   \
            assert_ok(call);                                                             \
        }                                                                                \
    } while (0)

#endif
