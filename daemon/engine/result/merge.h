/* merge.h - sorts what all threads have found into one answer, the same for any number of
 * threads.
 *
 * Sort the records of all lists together, into one piece, by (kind, object a, feature a,
 * object b, feature b); count and hash them. All threads of a step do it together, inside
 * its parallel region, with two barriers; one thread does it alone where there is only
 * one, or little to sort. The sort is stable: equal names stay in the order of lists and
 * arrival.
 *
 * Threads: begin, end: [compute]; survey, divide, finish: [team].
 *
 * Each thread takes a sample of its own list, whoever comes last
 * chooses keys and buckets | barrier | each divides its list into the buckets | barrier |
 * buckets are taken on demand: sorted, gathered, counted, hashed. A list is its owner's
 * to divide, however long: it took the owner far longer to find the records in it.
 */
#ifndef ENG_MERGE_H
#define ENG_MERGE_H

#include "merge_data.h"
#include "result.h"

void eng_merge_init(struct eng_merge *merge);
void eng_merge_deinit(struct eng_merge *merge);
uint64_t eng_merge_bytes(const struct eng_merge *merge);

/* Get ready to merge `count` lists into `out`; they are read by survey or end. All have
 * the same record_bytes and limit, and keys by one order or none; count >= 1. Records are
 * hashed unless merge->no_hash is set then. PCCD_E_NOMEM. */
int eng_merge_begin(struct eng_merge *merge, struct eng_found *const *lists,
                    uint32_t count, struct eng_records *out);

/* `cancel` is looked at every few thousand records from now on; NULL: nothing is. */
void eng_merge_set_cancel(struct eng_merge *merge, const atomic_bool *cancel);

/* The three shares of a thread of a parallel region of `threads`, with a barrier of all
 * between them; at most begin's count, lists beyond it are left out. [team]
 *
 * survey   when list number `thread` is complete: look at it.
 * divide   only if eng_merge_is_shared, which is the same for all after the barrier.
 * finish   likewise: sort, gather, count and hash buckets until there are no more. */
void eng_merge_survey(struct eng_merge *merge, uint32_t threads, uint32_t thread);
void eng_merge_divide(struct eng_merge *merge, uint32_t thread);
void eng_merge_finish(struct eng_merge *merge, uint32_t thread);

/* Cancelled before all was done: nothing is in `out`. After the barriers, and after end,
 * the same for all. */
static inline bool eng_merge_is_given_up(const struct eng_merge *merge)
{
    return atomic_load_explicit(&merge->is_given_up, memory_order_relaxed);
}

static inline bool eng_merge_is_shared(const struct eng_merge *merge)
{
    return merge->state == ENG_MERGE_SHARED;
}

/* After the region, or without one: do what is left. The first `limit` records in
 * canonical order are in `out`, merge->total says how many there were.
 * PCCD_E_NOMEM: `out` is empty. */
int eng_merge_end(struct eng_merge *merge, struct eng_counts *counts);

#endif
