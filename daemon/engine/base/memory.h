/* memory.h - malloc and free for the engine, which count what is allocated.
 *
 * Allocate blocks aligned to 128 bytes, with counts for the whole process: "a warm step
 * allocates nothing" is a number in `stats`. Charge each block to the user it serves,
 * because several teams compute at once.
 */
#ifndef ENG_MEMORY_H
#define ENG_MEMORY_H

#include <stdatomic.h>
#include <stddef.h>
#include <stdint.h>

#include "pccd_types.h"

/* Somebody's share of the engine's memory. Several threads may charge it at once. */
struct eng_account {
    atomic_int_fast64_t bytes;    /* held now; what others freed of theirs is below 0 */
    atomic_int_fast64_t limit;    /* allocations that would bring `bytes` above it fail */
    atomic_uint_fast64_t refused; /* that have failed so */
};

/* Who pays for what a thread allocates and frees. A thread that computes has one of its
 * own; the threads of its team use the same. */
struct eng_payer {
    struct eng_account *account; /* NULL: nobody's, without a limit */
    uint32_t number;      /* of the thread that computes; what for, its owner knows */
    uint32_t threads_max; /* that its team may have; 0: as many as are asked for */
    atomic_uint_fast64_t allocs; /* made by all who use it; a realloc is one */
    /* Allocations that the ceiling has refused, and what the last one wanted. */
    atomic_uint_fast64_t ceiling_hits;
    atomic_uint_fast64_t ceiling_asked;
};

/* Return the payer of the calling thread: its own unless it has joined another. */
struct eng_payer *eng_payer(void);
/* Use the payer of the thread that opened the parallel region (team/parallel.h).
 * [team] */
void eng_payer_join(struct eng_payer *payer);

/* Return how many threads a team may have: `wanted`, or fewer if its payer may have no
 * more. [compute] */
static inline uint32_t eng_payer_threads(uint32_t wanted)
{
    uint32_t most = eng_payer()->threads_max;
    return most != 0 && most < wanted ? most : wanted;
}

/* Charge what this thread alone allocates and frees to `account` from now on, whoever
 * pays for the rest of its team; NULL: to its payer's. Returns what it was. */
struct eng_account *eng_charge_to(struct eng_account *account);

/* Allocate `count` items of `bytes` each, aligned to 128 bytes (two cache lines, which
 * are fetched in pairs), not cleared. NULL: no memory, also when count * bytes
 * overflows. */
void *eng_alloc(size_t count, size_t bytes);

/* Grow or shrink; the first min(old, new) bytes are kept. NULL: the old block stays. */
void *eng_realloc(void *block, size_t count, size_t bytes);

void eng_free(void *block); /* NULL is allowed */

/* Return the number of allocations since the start; a realloc is one. */
uint64_t eng_alloc_count(void);
/* Return the bytes held now. */
uint64_t eng_alloc_bytes(void);

/* Refuse from now on what would bring the bytes held above that, whoever pays; any thread
 * may call it at any time. UINT64_MAX: no ceiling. */
void eng_alloc_set_ceiling(uint64_t bytes);

/* ---- arrays that grow -------------------------------------------------------------- */

/* Return a capacity for `end` items: grown by an eighth, which is what may lie idle, so
 * that adding objects one by one copies each array a logarithmic number of times. */
uint32_t eng_array_grown(uint32_t capacity, uint32_t end);

/* Grow one array of items of `bytes`; `array` is the address of the pointer to it, which
 * is unchanged on failure (PCCD_E_NOMEM). */
int eng_array_grow(void *array, uint32_t capacity, size_t bytes);

/* Make room for `count` items in all in an array with room for *capacity: fit for just so
 * many, extend for some more, as grow does. PCCD_E_NOMEM: all is as before. */
int eng_array_fit(void *array, uint32_t *capacity, uint32_t count, size_t bytes);
int eng_array_extend(void *array, uint32_t *capacity, uint32_t count, size_t bytes);

#endif
