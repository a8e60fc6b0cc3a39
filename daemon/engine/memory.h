/* daemon/engine/memory.h - the engine's allocations, counted.
 *
 * Room:     engine. May include: the C library.
 * Does:     malloc, realloc and free of 128-byte aligned blocks, with process-wide
 *           counts, so that "a warm step allocates nothing" is a number in `stats`.
 * Threads:  [any].
 */
#ifndef ENG_MEMORY_H
#define ENG_MEMORY_H

#include <stddef.h>
#include <stdint.h>

/* `count` items of `bytes` each, aligned to 128 bytes (two cache lines, which are fetched
 * in pairs), not cleared. NULL: no memory, also when count * bytes overflows. */
void *eng_alloc(size_t count, size_t bytes);

/* Grow or shrink; the first min(old, new) bytes are kept. NULL: the old block stays. */
void *eng_realloc(void *block, size_t count, size_t bytes);

void eng_free(void *block); /* NULL is allowed */

/* Allocations since the start (a realloc is one), and bytes held now. */
uint64_t eng_alloc_count(void);
uint64_t eng_alloc_bytes(void);

/* From now on allocations that would bring the bytes held above `bytes` fail;
 * UINT64_MAX: none. Returns how many have failed for that since the start. */
uint64_t eng_alloc_limit(uint64_t bytes);

/* A second bound of the same bytes, besides that limit, which another thread may lower
 * and raise at any time. */
void eng_alloc_ceiling(uint64_t bytes);
/* How many have failed for that since the start, which count as failed for the limit, and
 * the bytes that the last of them asked for. */
uint64_t eng_alloc_ceiling_hits(uint64_t *asked);

#endif
