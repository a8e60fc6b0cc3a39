/* pool.h - blocks of memory that the threads of a step take for their results.
 *
 * Hand out blocks of a fixed size without a lock. The pool is as large as the last step
 * needed, so a warm step takes nothing from the system, whichever thread finds most. A
 * step that needs more gets it, block by block.
 *
 * Threads: take: any worker; the rest: [compute], between steps.
 */
#ifndef ENG_POOL_H
#define ENG_POOL_H

#include <assert.h>
#include <stdatomic.h>
#include <stdint.h>

#define ENG_BLOCK_BYTES        65536u
#define ENG_BLOCK_HEADER_BYTES 64u

struct eng_block {
    struct eng_block *next;       /* of the list that took it */
    struct eng_block *spill_next; /* of the pool's own list; NULL in the array */
    uint32_t count;               /* records in it */
    unsigned char pad[ENG_BLOCK_HEADER_BYTES - 20];
    unsigned char data[ENG_BLOCK_BYTES - ENG_BLOCK_HEADER_BYTES];
};

static_assert(sizeof(struct eng_block) == ENG_BLOCK_BYTES, "header and data");

struct eng_pool {
    struct eng_block *blocks; /* [capacity] */
    struct eng_block *lent;   /* [lent_count] somebody else's, which are taken first */
    uint32_t capacity, lent_count;
    atomic_uint taken; /* this step; beyond these and its own they come from the system */
    _Atomic(struct eng_block *) spilled; /* those that do, linked by spill_next */
};

void eng_pool_init(struct eng_pool *pool);
void eng_pool_deinit(struct eng_pool *pool);

/* Take every block back. If the last step needed more than there are, grow to a quarter
 * more than it took and two for each worker, whose last block is partly empty: the same
 * step again takes none from the system. If memory is short, the old size stays. */
void eng_pool_reset(struct eng_pool *pool, uint32_t workers);

/* After a reset: take blocks of `memory`, of 64 bytes' alignment, before its own, until
 * the next reset at least and this is called again. NULL: of none. */
void eng_pool_lend(struct eng_pool *pool, void *memory, uint64_t bytes);

/* An empty block, or NULL: no memory. [team] */
struct eng_block *eng_pool_take(struct eng_pool *pool);

uint64_t eng_pool_bytes(const struct eng_pool *pool);

#endif
