/* daemon/engine/result/merge.h - from the lists of all threads to one canonical answer.
 *
 * Room:     engine. May include: hash.h, order.h, result.h, split.h.
 * Does:     sort the records of all lists together, into one piece, by (kind, object a,
 *           feature a, object b, feature b); count and hash them. All threads of a step
 *           do it together, inside its parallel region, with two barriers; one thread
 *           does it alone where there is only one, or little to sort. The sort is stable:
 *           equal names stay in the order of lists and arrival.
 * Threads:  begin, end: [compute]; survey, divide, finish: [team].
 * Source:   sample sort; bytes moved and times in bench/kernels.c.
 *
 * Each thread takes a sample of its own list, whoever comes last
 * chooses keys and buckets | barrier | each divides its list into the buckets | barrier |
 * buckets are taken on demand: sorted, gathered, counted, hashed. A list is its owner's
 * to divide, however long: it took the owner far longer to find the records in it.
 */
#ifndef ENG_MERGE_H
#define ENG_MERGE_H

#include <stdatomic.h>
#include <stdbool.h>

#include "hash.h"
#include "order.h"
#include "result.h"
#include "split.h"

/* Counts over records. */
struct eng_counts {
    uint64_t vf;
    uint64_t possible;
    uint64_t initial;
    double toi_first; /* 2: none */
};

/* One list's part. Counts and places are 32 bits: a step of more records than that is out
 * of memory. */
struct eng_merge_share {
    _Alignas(128) struct eng_found *found;
    struct eng_counts counts; /* of the buckets that this thread took */
    uint32_t first;           /* its place among the items */
    uint32_t count;
    uint32_t sample_count;
    uint32_t begin[ENG_SPLIT_BUCKETS_MAX + 1]; /* of its part of each bucket */
};

enum eng_merge_state {
    ENG_MERGE_OPEN = 0, /* nothing done */
    ENG_MERGE_SMALL,    /* left to one thread */
    ENG_MERGE_SHARED,   /* done by all */
    ENG_MERGE_NOMEM
};

struct eng_merge {
    struct eng_merge_share *shares; /* [share_capacity] */
    struct eng_name *samples;       /* [share_capacity][a share's] */
    uint32_t share_capacity;
    uint32_t threads; /* lists of this step */
    struct eng_records *out;
    enum eng_merge_state state;
    uint64_t begin_ns; /* when the last list came */
    uint64_t total;    /* records in the lists */
    uint64_t kept;     /* of these, in the answer */
    struct eng_order order;
    struct eng_splitters splitters;
    uint32_t position[ENG_SPLIT_BUCKETS_MAX]; /* of a bucket in the answer */
    uint32_t size[ENG_SPLIT_BUCKETS_MAX];     /* of a bucket, kept or not */
    /* Scratch, one allocation of `capacity` records. */
    struct eng_radix_key *items; /* list by list, each by buckets */
    struct eng_radix_key *other; /* bucket by bucket */
    struct eng_hash_sum *sums;   /* of the answer's blocks */
    uint16_t *buckets;           /* of the items before they are divided */
    uint64_t capacity;
    const atomic_bool *cancel; /* set by any thread: give the merge up; may be NULL */
    _Alignas(128) atomic_bool is_given_up;
    atomic_uint arrived;            /* lists looked at */
    _Alignas(128) atomic_uint next; /* bucket to be taken */
};

void eng_merge_init(struct eng_merge *merge);
void eng_merge_deinit(struct eng_merge *merge);
uint64_t eng_merge_bytes(const struct eng_merge *merge);

/* Get ready to merge `count` lists into `out`; they are read by survey or end. All have
 * the same record_bytes and limit; count >= 1. ENG_E_NOMEM. */
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
 * ENG_E_NOMEM: `out` is empty. */
int eng_merge_end(struct eng_merge *merge, struct eng_counts *counts, uint64_t hash[2]);

#endif
