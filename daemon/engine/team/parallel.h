/* parallel.h - parallel regions: what each begins and ends with, and loops over items.
 *
 * Let the threads of a region pay as the one that opens it, and round as the engine needs
 * it (rounding.h). In a process that is not ours give each of them back what it had, and
 * let those that the runtime makes for the region begin with what the caller has, as if
 * it had opened the region itself.
 */
#ifndef ENG_PARALLEL_H
#define ENG_PARALLEL_H

#include <stdint.h>

#include "affinity.h"
#include "memory.h"
#include "rounding.h"

struct eng_parallel {
    struct eng_payer *payer;
};

/* Return what the threads of the next parallel region join by. A thread of somebody else
 * (eng_guest_enter) has its own rounding until close, since new threads take that over.
 * [compute] */
struct eng_parallel eng_parallel_open(void);
/* Give such a thread the engine's rounding again; nothing else is closed. [compute] */
void eng_parallel_close(void);

/* Until the end of its block. [team] */
#define ENG_PARALLEL_JOIN(region)                                                        \
    COMMON_ROUNDING_HERE;                                                                \
    eng_payer_join((region).payer)

/* Begin calls of the engine by a thread of somebody else: until leave it rounds as the
 * engine needs it. [any] */
void eng_guest_enter(void);
/* End them: the thread rounds again as it did before. [any] */
void eng_guest_leave(void);

/* ---- many items: of a batch, a step with each scene -------------------------------- */

struct eng_parallel_for {
    uint32_t count;                      /* items 0 .. count - 1 */
    uint32_t threads;                    /* at most so many, >= 1; 1: the calling one */
    const struct eng_affinity *affinity; /* where they belong; NULL: anywhere */
    /* [team] `thread`: 0 is the calling one. The first item of each thread is the one
     * with its number. */
    void (*item)(void *context, uint32_t item, uint32_t thread);
    void *context;
};

/* Do all items, and return when they are done; what was done with them is visible then.
 * The threads pay for memory as the calling one does (memory.h). */
void eng_parallel_for(const struct eng_parallel_for *each);

/* Open one region, so that the team exists and is placed before the first step.
 * [compute] */
void eng_affinity_warm_up(const struct eng_affinity *affinity, uint32_t threads);

#endif
