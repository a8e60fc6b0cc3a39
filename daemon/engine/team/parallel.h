/* parallel.h - what every parallel region begins and ends with.
 *
 * Let the threads of a region pay as the one that opens it, and round as the engine needs
 * it (rounding.h). In a process that is not ours give each of them back what it had, and
 * let those that the runtime makes for the region begin with what the caller has, as if
 * it had opened the region itself.
 */
#ifndef ENG_PARALLEL_H
#define ENG_PARALLEL_H

#include "memory.h"
#include "rounding.h"

struct eng_parallel {
    struct eng_payer *payer;
};

/* [compute] */
struct eng_parallel eng_parallel_open(void);
void eng_parallel_close(void);

/* Until the end of its block. [team] */
#define ENG_PARALLEL_JOIN(region)                                                        \
    COMMON_ROUNDING_HERE;                                                                \
    eng_payer_join((region).payer)

/* A thread of somebody else comes, and goes: in between it calls the engine and rounds as
 * that needs it. [any] */
void eng_guest_enter(void);
void eng_guest_leave(void);

#endif
