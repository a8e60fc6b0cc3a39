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
 *
 * Source: Frazer, McKellar: Samplesort (1970); Sanders, Winkel: Super scalar sample sort
 * (2004) for the tree without branches.
 */
#ifndef ENG_MERGE_H
#define ENG_MERGE_H

#include <stdatomic.h>
#include <stdbool.h>

#include "kinds.h"
#include "order.h"
#include "result.h"
#include "sort.h"

#define ENG_SPLIT_BUCKETS_MAX 1024u

/* Divides keys into buckets of about equal size. */
struct eng_splitters {
    uint32_t buckets; /* a power of two */
    uint32_t levels;
    uint64_t tree[ENG_SPLIT_BUCKETS_MAX]; /* breadth-first from place 1 on */
};

/* The sums that a thread makes over the records of an answer that it puts into place. */
struct eng_counts {
    uint64_t kind[PCCD_KINDS_MAX]; /* records of each */
    uint64_t possible;
    uint64_t initial;
    uint64_t inside;     /* PCCD_INSIDE without PCCD_INITIAL */
    uint64_t coincident; /* PCCD_INITIAL, in a vertex of both features */
    double toi_first;    /* 2: none */
    eng_hash_sum hash;   /* of the records, without their number */
};
#define ENG_COUNTS_NONE ((struct eng_counts){.toi_first = 2})

/* Count a contact, but for its hash. */
static inline void eng_counts_contact(struct eng_counts *counts,
                                      const struct pccd_contact *contact)
{
    uint32_t flags = contact->flags;
    counts->kind[contact->kind]++;
    counts->possible += !(flags & PCCD_PROVED);
    counts->initial += (flags & PCCD_INITIAL) != 0;
    counts->inside += (flags & (PCCD_INITIAL | PCCD_INSIDE)) == PCCD_INSIDE;
    if ((flags & PCCD_INITIAL) != 0) {
        counts->coincident += common_is_at_vertices(contact->param);
    }
    counts->toi_first =
        contact->toi < counts->toi_first ? contact->toi : counts->toi_first;
}

static inline void eng_counts_add(struct eng_counts *to, const struct eng_counts *from)
{
    for (uint32_t kind = 0; kind < PCCD_KINDS_MAX; kind++) {
        to->kind[kind] += from->kind[kind];
    }
    to->possible += from->possible;
    to->initial += from->initial;
    to->inside += from->inside;
    to->coincident += from->coincident;
    to->hash += from->hash;
    to->toi_first = from->toi_first < to->toi_first ? from->toi_first : to->toi_first;
}

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

/* A bucket when it is folded: records that begin at `first` in the answer. */
struct eng_merge_fold {
    uint32_t first;
    uint32_t count;
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
    uint64_t kept;     /* of these, in the answer; before they are folded */
    bool folds;        /* the lists do */
    bool is_cut;       /* after the end: there were more than the limit */
    bool no_hash;      /* counts.hash stays 0 */
    struct eng_order order;
    struct eng_splitters splitters;
    /* Scratch, [capacity]: list by list, each by buckets. What else there is to write
     * down has the places of the records in `out` before they are filled: the items as
     * they come and the bucket of each, 18 bytes a record; then, bucket by bucket, the
     * items of several lists together, 16 bytes, and as many for their sort. Pairs have
     * 20: of several lists their items are together behind the others in here. */
    struct eng_radix_key *items;
    struct eng_merge_fold *folded; /* if it folds: [ENG_SPLIT_BUCKETS_MAX] */
    uint64_t capacity;
    const atomic_bool *cancel; /* set by any thread: give the merge up; may be NULL */
    _Alignas(128) atomic_bool is_given_up;
    atomic_uint arrived;            /* lists looked at */
    _Alignas(128) atomic_uint next; /* bucket to be taken */
};

/* Return whether the places of the records have no room for items beside those that are
 * sorted. */
static inline bool eng_merge_needs_other(const struct eng_merge *merge)
{
    return merge->threads > 1 && merge->out->record_bytes < 2 * sizeof *merge->items;
}

/* Sort bucket `b`, put its records into the answer, and add what they are to *counts. */
void eng_bucket_finish(struct eng_merge *merge, uint32_t b, struct eng_counts *counts);

void eng_merge_init(struct eng_merge *merge);
void eng_merge_deinit(struct eng_merge *merge);
uint64_t eng_merge_bytes(const struct eng_merge *merge);

/* Get ready to merge `count` lists into `out`; they are read by survey or end. All have
 * the same record_bytes and limit, and keys by one order or none; count >= 1. Records are
 * hashed unless merge->no_hash is set then. PCCD_E_NOMEM. */
int eng_merge_begin(struct eng_merge *merge, struct eng_found *const *lists,
                    uint32_t count, struct eng_records *out);

/* Look at `cancel` every few thousand records from now on; NULL: at nothing. */
void eng_merge_set_cancel(struct eng_merge *merge, const atomic_bool *cancel);

/* Do the three shares of a thread of a parallel region of `threads`, with a barrier of
 * all between them; at most begin's count, lists beyond it are left out. [team]
 *
 * survey   when list number `thread` is complete: look at it.
 * divide   only if eng_merge_is_by_all, which is the same for all after the barrier.
 * finish   after that: sort, gather, count and hash buckets until there are no more. */
void eng_merge_survey(struct eng_merge *merge, uint32_t threads, uint32_t thread);
void eng_merge_fill_buckets(struct eng_merge *merge, uint32_t thread);
void eng_merge_finish(struct eng_merge *merge, uint32_t thread);

/* Return whether it was cancelled before all was done: nothing is in `out`. After the
 * barriers, and after end, the same for all. */
static inline bool eng_merge_is_given_up(const struct eng_merge *merge)
{
    return atomic_load_explicit(&merge->is_given_up, memory_order_relaxed);
}

/* Return whether all threads sort and write the records, each some buckets; else one
 * does. */
static inline bool eng_merge_is_by_all(const struct eng_merge *merge)
{
    return merge->state == ENG_MERGE_SHARED;
}

/* Do what is left, after the region or without one. The first `limit` records in
 * canonical order are in `out`, merge->total says how many there were. PCCD_E_NOMEM:
 * `out` is empty. PCCD_OK with eng_merge_is_given_up: it is empty, too. */
int eng_merge_end(struct eng_merge *merge, struct eng_counts *counts);

#endif
