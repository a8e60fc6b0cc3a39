/* daemon/engine/result/result.h - the records of a step: kept, sorted, hashed.
 *
 * Room:     engine. May include: pool.h, radix.h, step.h.
 * Does:     append records in any order; put them into the canonical order; hash them.
 * Threads:  one thread for one list.
 */
#ifndef ENG_RESULT_H
#define ENG_RESULT_H

#include "pool.h"
#include "radix.h"
#include "step.h"

/* What one worker found, eng_contact or eng_pair records, in blocks of the
 * step's pool. */
struct eng_found {
    struct eng_pool *pool;
    struct eng_block *first;
    struct eng_block *last;
    uint32_t record_bytes;
    uint32_t per_block;
    uint64_t count;
    uint64_t limit;  /* records kept at most */
    bool overflowed; /* more came than could be kept */
};

void eng_found_begin(struct eng_found *found, struct eng_pool *pool,
                     uint32_t record_bytes, uint64_t limit);

/* Room for one more record, or NULL: the limit is reached or memory ran
 * out (overflowed). */
void *eng_found_add(struct eng_found *found);

/* The answer: records in one piece. Memory stays for the next step. */
struct eng_records {
    unsigned char *data;
    uint32_t record_bytes;
    uint64_t count;
    uint64_t capacity_bytes;
};

void eng_records_deinit(struct eng_records *records);

/* Scratch of the sort; memory stays for the next step. */
struct eng_sorter {
    struct eng_radix_item *items;
    struct eng_radix_item *spare;
    uint64_t capacity;
};

void eng_sorter_deinit(struct eng_sorter *sorter);

/* Sort the records of all lists together by (kind, object a, feature a, object b, feature
 * b) into `out`. All have the same record_bytes; list_count >= 1. At most the lists'
 * `limit` records are kept; *overflowed if there were more, or a list lost some.
 * ENG_E_NOMEM: `out` is empty. */
int eng_records_sort(struct eng_sorter *sorter, struct eng_found *const *lists,
                     uint32_t list_count, struct eng_records *out, bool *overflowed);

/* XXH3-128 of `bytes`: hash[0] high, hash[1] low. */
void eng_hash(const void *data, size_t bytes, uint64_t hash[2]);

#endif
