/* result.h - the list in which one thread collects the records that it finds.
 *
 * Threads: one thread for one list.
 */
#ifndef ENG_RESULT_H
#define ENG_RESULT_H

#include <assert.h>
#include <stdatomic.h>
#include <stdint.h>

#include "order.h"

/* ---- blocks of memory that the threads of a step take ------------------------------ */

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

/* Lend blocks of `memory`, of 64 bytes' alignment, to the pool after a reset: it takes
 * them before its own, until the next reset at least and this is called again. NULL:
 * none. */
void eng_pool_lend(struct eng_pool *pool, void *memory, uint64_t bytes);

/* Take an empty block; NULL: no memory. [team] */
struct eng_block *eng_pool_take(struct eng_pool *pool);

uint64_t eng_pool_bytes(const struct eng_pool *pool);

/* The records that one worker found, pccd_contact or pccd_pair records, in blocks of the
 * step's pool. */
struct eng_found {
    struct eng_pool *pool;
    struct eng_block *first;
    struct eng_block *last; /* those after it are empty */
    uint32_t record_bytes;
    uint32_t per_block;
    uint64_t count;
    struct eng_name_range range; /* of their names, or wider */
    bool has_keys; /* a block has, behind its records, a key of each by `order` */
    struct eng_order order;
    uint64_t limit; /* of the answer: of more, the first in order are kept */
    bool folds; /* set after begin: records of one name become one whose `reserved`, the
                 * count of a near, is the sum of theirs; else false */
    /* Set after begin: of contacts, those of mode first are the answer: the first of
     * these, not of all that were found, are kept; else false. */
    bool is_of_earliest;
    uint64_t most; /* then: more records than that are cut, if it is more than usual */
    bool is_cut;   /* there were more; none after `cut_at` is kept */
    struct eng_name cut_at;
    bool overflowed; /* more came than were kept */
};

void eng_found_begin(struct eng_found *found, struct eng_pool *pool,
                     uint32_t record_bytes, uint64_t limit);

/* Expect all names of the list, which is empty, to be within a range. If a word holds
 * their keys it keeps these from now on; returns whether it does. */
bool eng_found_expect(struct eng_found *found, const struct eng_name_range *range);

/* Return the keys of a block's records, in a list that has_keys. */
static inline uint64_t *eng_found_keys(const struct eng_found *found,
                                       struct eng_block *block)
{
    return (uint64_t *)(void *)(block->data +
                                (size_t)found->per_block * found->record_bytes);
}

/* Add one more record, named, for the caller to fill in before the next call. NULL: it
 * comes after `limit` others in order, or memory ran out (overflowed). */
void *eng_found_add(struct eng_found *found, const struct pccd_pair *name);

/* Offer slots for the next records, `count` at most and >= 1, for the caller to fill in,
 * names as well: *slots; and their keys, *keys, one after the other, of a list that
 * has_keys, else *keys is not set, and the caller adds the names to the list's range.
 * Return how many. 0: eng_found_add knows what becomes of the next one; it may move
 * records. */
uint32_t eng_found_open(struct eng_found *found, uint32_t count, void **slots,
                        uint64_t **keys);
/* Count the first `count` of these slots as filled in. */
void eng_found_close(struct eng_found *found, uint32_t count);

/* The answer: records in one piece. Memory stays for the next step. */
struct eng_records {
    unsigned char *data;
    uint32_t record_bytes;
    uint64_t count;
    uint64_t capacity_bytes;
};

/* Keep `count` records at most, those that were found first. */
void eng_found_keep(struct eng_found *found, uint64_t count);

void eng_records_deinit(struct eng_records *records);

/* Make room for `count` records of record_bytes each, whose content is lost, or, by
 * extend, is kept. PCCD_E_NOMEM: all is as before. */
int eng_records_reserve(struct eng_records *records, uint64_t count);
int eng_records_extend(struct eng_records *records, uint64_t count);

#endif
