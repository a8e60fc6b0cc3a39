/* merge.c - from the lists of all threads to one canonical answer.
 *
 * Threads: merge.h; a share is its thread's up to the first barrier, between the barriers
 * others read it, but not `begin`; after the second they read that.
 */
#include "merge.h"

#include <assert.h>

#include "clock.h"
#include "memory.h"
#include "pccd_types.h"

#define SPLIT_GROUP 8u /* keys looked up side by side */

/* ---- splitters --------------------------------------------------------------------- */

/* Divide the samples, sorted by key, each standing for `index` keys, into `buckets`:
 * a power of two up to ENG_SPLIT_BUCKETS_MAX; count >= 1. */
static void set_splitters(struct eng_splitters *splitters,
                          const struct eng_radix_key *samples, size_t count,
                          uint32_t buckets)
{
    assert(buckets >= 1 && buckets <= ENG_SPLIT_BUCKETS_MAX);
    uint64_t weight = 0;
    for (size_t i = 0; i < count; i++) {
        weight += samples[i].index;
    }
    splitters->buckets = buckets;
    splitters->levels = (uint32_t)__builtin_ctz(buckets);
    size_t at = 0;
    uint64_t below = 0; /* keys before samples[at] */
    for (uint32_t i = 1; i < buckets; i++) {
        while (at + 1 < count &&
               (double)(below + samples[at].index) * buckets <= (double)weight * i) {
            below += samples[at++].index;
        }
        /* In order of size odd places belong to the last level, twice an odd number to
         * the level above it, and so on. */
        uint32_t up = (uint32_t)__builtin_ctz(i);
        splitters->tree[(buckets + i) >> (up + 1)] = samples[at].key;
    }
}

/* The bucket of each key: a larger key has no smaller bucket, equal keys the same. */
static void look_up(const struct eng_splitters *splitters,
                    const uint64_t key[SPLIT_GROUP], uint16_t bucket[SPLIT_GROUP])
{
    size_t place[SPLIT_GROUP];
#pragma GCC unroll 8
    for (unsigned k = 0; k < SPLIT_GROUP; k++) {
        place[k] = 1;
    }
    for (uint32_t level = 0; level < splitters->levels; level++) {
#pragma GCC unroll 8
        for (unsigned k = 0; k < SPLIT_GROUP; k++) { /* a subtraction with borrow */
            place[k] = 2 * place[k] + 1 - (key[k] < splitters->tree[place[k]]);
        }
    }
#pragma GCC unroll 8
    for (unsigned k = 0; k < SPLIT_GROUP; k++) {
        bucket[k] = (uint16_t)(place[k] - splitters->buckets);
    }
}

/* ---- the merge --------------------------------------------------------------------- */

static_assert(sizeof(struct eng_name) == sizeof(struct pccd_pair), "its words");

/* Records below which a second thread costs more than it saves. */
#define SMALL_MAX 3000u

/* Records that are merged within a millisecond by a single thread: not given up. A step
 * that was stopped before has no more (answer.c), and answers what it has found. */
#define SOON_MAX 8192u

/* Buckets: enough for threads to end together, and small enough for the cache, but not so
 * small that their number costs: of a thousand records and more, the passes of a sort
 * take longer for these than for their counters. Samples: a few for each bucket. */
#define BUCKETS_PER_THREAD     8u /* of several, if each has as many as: */
#define RECORDS_PER_BUCKET_MIN 128u
#define RECORDS_PER_BUCKET_MAX 2048u /* far more take twice as long each: sort.c */
#define SAMPLES_MAX            2048u /* of all threads, if each has few */
#define SAMPLES_PER_THREAD_MIN 32u

/* Where the records will be: first the items as they come, then the bucket of each. */
static_assert(sizeof(struct eng_radix_key) + sizeof(uint16_t) <= sizeof(struct pccd_pair),
              "room for both");

static struct eng_radix_key *items_as_they_come(const struct eng_merge *merge)
{
    return (struct eng_radix_key *)(void *)merge->out->data;
}

static uint16_t *buckets_as_they_come(const struct eng_merge *merge)
{
    return (uint16_t *)(items_as_they_come(merge) + merge->total);
}

void eng_merge_init(struct eng_merge *merge)
{
    memset(merge, 0, sizeof *merge);
    atomic_init(&merge->is_given_up, false);
    atomic_init(&merge->arrived, 0);
    atomic_init(&merge->next, 0);
}

void eng_merge_deinit(struct eng_merge *merge)
{
    eng_free(merge->shares);
    eng_free(merge->samples);
    eng_free(merge->items);
    eng_free(merge->folded);
    eng_merge_init(merge);
}

static uint32_t samples_of(uint32_t threads)
{
    uint32_t samples = SAMPLES_MAX / threads;
    return samples > SAMPLES_PER_THREAD_MIN ? samples : SAMPLES_PER_THREAD_MIN;
}

uint64_t eng_merge_bytes(const struct eng_merge *merge)
{
    return merge->capacity * sizeof *merge->items +
           merge->share_capacity * sizeof *merge->shares +
           (merge->share_capacity == 0
                ? 0
                : (uint64_t)merge->share_capacity * samples_of(merge->share_capacity) *
                      sizeof *merge->samples) +
           (merge->folded ? ENG_SPLIT_BUCKETS_MAX * sizeof *merge->folded : 0);
}

static int reserve_shares(struct eng_merge *merge, uint32_t count)
{
    if (count <= merge->share_capacity) {
        return PCCD_OK;
    }
    struct eng_merge_share *shares = eng_alloc(count, sizeof *shares);
    /* Fewer threads take more samples each, but no more together. */
    size_t samples_max = (size_t)count * SAMPLES_PER_THREAD_MIN;
    samples_max = samples_max > SAMPLES_MAX ? samples_max : SAMPLES_MAX;
    struct eng_name *samples = eng_alloc(samples_max, sizeof *samples);
    if (!shares || !samples) {
        eng_free(shares);
        eng_free(samples);
        return PCCD_E_NOMEM;
    }
    eng_free(merge->shares);
    eng_free(merge->samples);
    merge->shares = shares;
    merge->samples = samples;
    merge->share_capacity = count;
    return PCCD_OK;
}

static int reserve_scratch(struct eng_merge *merge)
{
    if (merge->total > UINT32_MAX) {
        return PCCD_E_NOMEM;
    }
    if (merge->folds && !merge->folded) {
        merge->folded = eng_alloc(ENG_SPLIT_BUCKETS_MAX, sizeof *merge->folded);
        if (!merge->folded) {
            return PCCD_E_NOMEM;
        }
    }
    uint64_t wanted = merge->total * (eng_merge_needs_other(merge) ? 2 : 1);
    if (wanted > merge->capacity) {
        uint64_t capacity = wanted + wanted / 2;
        struct eng_radix_key *items = eng_alloc(capacity, sizeof *items);
        if (!items) {
            return PCCD_E_NOMEM;
        }
        eng_free(merge->items);
        merge->items = items;
        merge->capacity = capacity;
    }
    return eng_records_reserve(merge->out, merge->total);
}

int eng_merge_begin(struct eng_merge *merge, struct eng_found *const *lists,
                    uint32_t count, struct eng_records *out)
{
    assert(count >= 1 && lists[0] && out);
    int status = reserve_shares(merge, count);
    if (status != PCCD_OK) {
        return status;
    }
    for (uint32_t i = 0; i < count; i++) {
        merge->shares[i].found = lists[i];
    }
    merge->threads = count;
    merge->folds = lists[0]->folds;
    merge->is_cut = merge->no_hash = false;
    merge->out = out;
    merge->state = ENG_MERGE_OPEN;
    merge->begin_ns = 0;
    merge->cancel = NULL;
    atomic_store_explicit(&merge->is_given_up, false, memory_order_relaxed);
    atomic_store_explicit(&merge->arrived, 0, memory_order_relaxed);
    atomic_store_explicit(&merge->next, 0, memory_order_relaxed);
    return PCCD_OK;
}

void eng_merge_set_cancel(struct eng_merge *merge, const atomic_bool *cancel)
{
    merge->cancel = cancel;
}

/* Return whether to go no further. Relaxed: the flags are hints; the barriers order the
 * rest. */
static bool must_give_up(struct eng_merge *merge)
{
    if (merge->total <= SOON_MAX) {
        return false;
    }
    if (eng_merge_is_given_up(merge)) {
        return true;
    }
    if (merge->cancel == NULL ||
        !atomic_load_explicit(merge->cancel, memory_order_relaxed)) {
        return false;
    }
    atomic_store_explicit(&merge->is_given_up, true, memory_order_relaxed);
    return true;
}

/* A sample of a list, at even distances. */
static void look_at(struct eng_merge *merge, uint32_t threads, uint32_t thread)
{
    struct eng_merge_share *share = &merge->shares[thread];
    const struct eng_found *found = share->found;
    uint32_t samples_max = samples_of(threads);
    struct eng_name *samples = merge->samples + (size_t)thread * samples_max;
    uint64_t stride = found->count / samples_max + 1;
    uint64_t to_next = 0; /* records until the next sample */
    share->sample_count = 0;
    share->counts = ENG_COUNTS_NONE;
    for (const struct eng_block *block = found->first; block; block = block->next) {
        for (; to_next < block->count; to_next += stride) {
            samples[share->sample_count++] = eng_name_of(
                block->data + to_next * found->record_bytes, found->record_bytes);
        }
        to_next -= block->count;
    }
}

static uint32_t bucket_count(uint64_t total, uint32_t threads)
{
    uint32_t wanted = threads > 1 ? BUCKETS_PER_THREAD * threads : 1;
    uint32_t buckets = 1;
    while (buckets < ENG_SPLIT_BUCKETS_MAX &&
           (total / buckets > RECORDS_PER_BUCKET_MAX ||
            (buckets < wanted && total / buckets >= 2 * RECORDS_PER_BUCKET_MIN))) {
        buckets *= 2;
    }
    return buckets;
}

static void choose_buckets(struct eng_merge *merge)
{
    uint32_t samples_max = samples_of(merge->threads);
    size_t count = 0; /* at most one a record: the items have room */
    for (uint32_t t = 0; t < merge->threads; t++) {
        const struct eng_merge_share *share = &merge->shares[t];
        const struct eng_name *samples = merge->samples + (size_t)t * samples_max;
        for (uint32_t i = 0; i < share->sample_count; i++) {
            merge->items[count].key = eng_order_key(&merge->order, &samples[i]);
            merge->items[count++].index = share->count / share->sample_count;
        }
    }
    set_splitters(&merge->splitters,
                  eng_radix_sort(merge->items, items_as_they_come(merge), count), count,
                  bucket_count(merge->total, merge->threads));
}

/* All lists are looked at: choose memory, keys and buckets. One thread. */
static int plan(struct eng_merge *merge)
{
    struct eng_name_range range;
    const struct eng_found *found = merge->shares[0].found;
    eng_name_range_init(&range);
    merge->total = 0;
    for (uint32_t t = 0; t < merge->threads; t++) {
        struct eng_merge_share *share = &merge->shares[t];
        share->first = (uint32_t)merge->total;
        share->count = (uint32_t)share->found->count;
        merge->total += share->found->count;
        if (share->count > 0) { /* the range of nothing is not within any other */
            eng_name_range_add(&range, &share->found->range.low);
            eng_name_range_add(&range, &share->found->range.high);
        }
    }
    bool is_all = merge->folds || merge->total < found->limit;
    merge->kept = is_all ? merge->total : found->limit;
    merge->out->record_bytes = found->record_bytes;
    merge->out->count = 0;
    merge->splitters.buckets = 0;
    if (merge->total == 0) {
        return PCCD_OK; /* the answer's memory may be NULL, which has no places */
    }
    int status = reserve_scratch(merge);
    if (status == PCCD_OK) {
        if (found->has_keys) {
            merge->order = found->order;
        } else {
            eng_order_set(&merge->order, &range);
        }
        choose_buckets(merge);
    }
    return status;
}

/* Keys of a list, in the order of arrival, and the bucket of each; `count`: of a bucket's
 * records, 0 before. False: given up. */
static bool find_buckets(struct eng_merge *merge, const struct eng_merge_share *share,
                         uint32_t *count)
{
    struct eng_radix_key *item = items_as_they_come(merge) + share->first;
    uint16_t *bucket = buckets_as_they_come(merge) + share->first;
    uint32_t bytes = share->found->record_bytes;
    for (struct eng_block *block = share->found->first; block; block = block->next) {
        const uint64_t *keys =
            share->found->has_keys ? eng_found_keys(share->found, block) : NULL;
        if (must_give_up(merge)) {
            return false;
        }
        for (uint32_t i = 0; i < block->count; i += SPLIT_GROUP) {
            uint64_t key[SPLIT_GROUP] = {0};
            uint16_t found[SPLIT_GROUP];
            uint32_t left = block->count - i;
            uint32_t n = left < SPLIT_GROUP ? left : SPLIT_GROUP;
            for (uint32_t k = 0; k < n; k++) {
                const unsigned char *record = block->data + (size_t)(i + k) * bytes;
                key[k] =
                    keys ? keys[i + k] : eng_order_key_of(&merge->order, record, bytes);
                *item++ = (struct eng_radix_key){key[k], (uintptr_t)record};
            }
            look_up(&merge->splitters, key, found);
            for (uint32_t k = 0; k < n; k++) {
                count[found[k]]++;
                *bucket++ = found[k];
            }
        }
    }
    return true;
}

/* Divide a list into the buckets. */
void eng_merge_fill_buckets(struct eng_merge *merge, uint32_t thread)
{
    assert(thread < merge->threads);
    struct eng_merge_share *share = &merge->shares[thread];
    uint32_t buckets = merge->splitters.buckets;
    uint32_t *begin = share->begin;
    uint32_t at = share->first;
    memset(begin, 0, (buckets + 1) * sizeof *begin);
    if (!find_buckets(merge, share, begin + 1)) {
        return;
    }
    /* begin[b + 1] becomes the next free place of bucket b, and at the end, when the
     * bucket is full, where the next one begins. */
    for (uint32_t b = 0; b < buckets; b++) {
        uint32_t n = begin[b + 1];
        begin[b + 1] = at;
        at += n;
    }
    begin[0] = share->first;
    const struct eng_radix_key *item = items_as_they_come(merge) + share->first;
    const uint16_t *bucket = buckets_as_they_come(merge) + share->first;
    for (uint32_t i = 0; i < share->count; i++) {
        merge->items[begin[bucket[i] + 1]++] = item[i];
    }
}

void eng_merge_finish(struct eng_merge *merge, uint32_t thread)
{
    assert(thread < merge->threads);
    struct eng_counts counts = ENG_COUNTS_NONE; /* apart from the other threads' */
    for (;;) {
        /* Relaxed: each bucket is handed out once; the barriers order the rest. */
        uint32_t b = atomic_fetch_add_explicit(&merge->next, 1, memory_order_relaxed);
        if (b >= merge->splitters.buckets || must_give_up(merge)) {
            break;
        }
        eng_bucket_finish(merge, b, &counts);
    }
    merge->shares[thread].counts = counts;
}

void eng_merge_survey(struct eng_merge *merge, uint32_t threads, uint32_t thread)
{
    look_at(merge, threads, thread);
    /* Acquire and release: whoever comes last reads what all have written. */
    if (atomic_fetch_add_explicit(&merge->arrived, 1, memory_order_acq_rel) + 1 ==
        threads) {
        merge->begin_ns = common_now_ns();
        merge->threads = threads;
        int status = plan(merge);
        merge->state = status != PCCD_OK          ? ENG_MERGE_NOMEM
                       : merge->total < SMALL_MAX ? ENG_MERGE_SMALL
                                                  : ENG_MERGE_SHARED;
    }
}

static void merge_alone(struct eng_merge *merge)
{
    if (merge->state == ENG_MERGE_OPEN) {
        merge->begin_ns = common_now_ns();
        for (uint32_t t = 0; t < merge->threads; t++) {
            look_at(merge, merge->threads, t);
        }
        merge->state = plan(merge) == PCCD_OK ? ENG_MERGE_SMALL : ENG_MERGE_NOMEM;
    }
    if (merge->state == ENG_MERGE_SMALL && merge->total > 0) {
        for (uint32_t t = 0; t < merge->threads; t++) {
            eng_merge_fill_buckets(merge, t);
        }
        eng_merge_finish(merge, 0);
    }
}

/* Move the folded buckets together. Of more than the limit the first ones are kept and
 * hashed; who answers counts them. */
static void close_up(struct eng_merge *merge, struct eng_counts *counts)
{
    uint64_t limit = merge->shares[0].found->limit;
    struct pccd_contact *records = (struct pccd_contact *)(void *)merge->out->data;
    uint64_t end = 0;
    for (uint32_t b = 0; b < merge->splitters.buckets; b++) {
        const struct eng_merge_fold *part = &merge->folded[b];
        if (part->first != end && part->count > 0) {
            memmove(records + end, records + part->first, part->count * sizeof *records);
        }
        end += part->count;
    }
    merge->out->count = end;
    merge->is_cut = end > limit;
    if (merge->is_cut) {
        merge->out->count = limit;
        counts->hash = eng_hash_records(records, limit, sizeof *records);
    }
}

int eng_merge_end(struct eng_merge *merge, struct eng_counts *counts)
{
    assert(merge->out); /* begun */
    merge_alone(merge);
    *counts = ENG_COUNTS_NONE;
    if (merge->state == ENG_MERGE_NOMEM) {
        merge->out->count = 0;
        return PCCD_E_NOMEM;
    }
    if (eng_merge_is_given_up(merge)) {
        merge->out->count = 0;
        return PCCD_OK;
    }
    merge->out->count = merge->kept;
    merge->is_cut = merge->kept < merge->total;
    for (uint32_t t = 0; t < merge->threads; t++) {
        eng_counts_add(counts, &merge->shares[t].counts);
    }
    if (merge->folds) {
        close_up(merge, counts);
    }
    return PCCD_OK;
}
