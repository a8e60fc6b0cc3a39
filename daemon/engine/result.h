/* daemon/engine/result.h - the records of a step: kept, sorted, hashed.
 *
 * Room:     engine. May include: step.h.
 * Does:     append records in any order; put them into the canonical order; hash them.
 * Threads:  one thread for one list.
 */
#ifndef ENG_RESULT_H
#define ENG_RESULT_H

#include "radix.h"
#include "step.h"

/* Records of one kind: eng_contact or eng_pair. Memory stays for the next step. */
struct eng_records {
    unsigned char *data;
    uint32_t record_bytes;
    uint64_t count;
    uint64_t capacity; /* in records of record_bytes */
    uint64_t capacity_bytes;
    uint64_t limit;    /* records kept at most */
    bool overflowed;   /* more came than could be kept */
};

void eng_records_begin(struct eng_records *records, uint32_t record_bytes, uint64_t limit);
void eng_records_deinit(struct eng_records *records);

/* Room for one more record, or NULL: the limit is reached or memory ran out (overflowed). */
void *eng_records_add(struct eng_records *records);

/* Scratch of the sort; memory stays for the next step. */
struct eng_sorter {
    struct eng_radix_item *items;
    struct eng_radix_item *spare;
    uint64_t capacity;
};

void eng_sorter_deinit(struct eng_sorter *sorter);

/* Sort the records of all lists together by (kind, object a, feature a, object b,
 * feature b) into `out`; all have the same record_bytes; list_count is 1 .. 65536. Every record begins with the five words of struct eng_pair, for
 * contacts with `flags` in between. ENG_E_NOMEM: all unchanged. */
int eng_records_sort(struct eng_sorter *sorter, struct eng_records *const *lists,
                     uint32_t list_count, struct eng_records *out);

/* XXH3-128 of `bytes`: hash[0] high, hash[1] low. */
void eng_hash(const void *data, size_t bytes, uint64_t hash[2]);

#endif
