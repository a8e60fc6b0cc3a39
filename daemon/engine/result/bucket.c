/* bucket.c - one bucket of an answer. */
#include "merge.h"

#include <assert.h>

static_assert(sizeof(struct pccd_contact) == 64 && sizeof(struct pccd_pair) == 20,
              "records");

/* Records copied while the next ones are on their way to the cache. */
#define AHEAD 32u

/* Bytes of records that are copied, then counted into the hash: so few that the processor
 * fetches the next ones while it computes. */
#define PIECE_BYTES 1024u

/* Sort items whose keys agree in all words before `word`, in place. A key has three words
 * at most, so that is the depth. */
static void sort_items(const struct eng_merge *merge, struct eng_radix_key *items,
                       struct eng_radix_key *spare, size_t count, uint32_t word)
{
    struct eng_radix_key *sorted = eng_radix_sort(items, spare, count);
    if (sorted != items) {
        memcpy(items, sorted, count * sizeof *items);
    }
    if (word + 1 == merge->order.words) {
        return;
    }
    for (size_t begin = 0, end; begin < count; begin = end) {
        uint64_t key = items[begin].key;
        for (end = begin + 1; end < count && items[end].key == key; end++) {
        }
        if (end - begin == 1) {
            continue;
        }
        for (size_t i = begin; i < end; i++) {
            const unsigned char *record = (const void *)(uintptr_t)items[i].index;
            struct eng_name name = eng_name_of(record, merge->out->record_bytes);
            items[i].key = eng_order_wide_key(&merge->order, &name, word + 1);
        }
        sort_items(merge, items + begin, spare, end - begin, word + 1);
    }
}

/* Records of items[count], of which more follow up to items[end]. */
static void gather_contacts(struct pccd_contact *to, const struct eng_radix_key *items,
                            size_t count, size_t end, struct eng_counts *counts)
{
    for (size_t i = 0; i < count; i++) {
        if (i + AHEAD < end) {
            __builtin_prefetch((const void *)(uintptr_t)items[i + AHEAD].index);
        }
        memcpy(&to[i], (const void *)(uintptr_t)items[i].index, sizeof to[i]);
        eng_counts_contact(counts, &to[i]);
    }
}

static bool have_one_name(const struct pccd_contact *a, const struct pccd_contact *b)
{
    return a->kind == b->kind && a->object_a == b->object_a &&
           a->feature_a == b->feature_a && a->object_b == b->object_b &&
           a->feature_b == b->feature_b;
}

/* Keep the first of neighbours with one name. Returns how many there are. */
static uint32_t gather_folded(struct pccd_contact *to, const struct eng_radix_key *items,
                              size_t count, struct eng_counts *counts)
{
    uint32_t kept = 0;
    for (size_t i = 0; i < count; i++) {
        const struct pccd_contact *next = (const void *)(uintptr_t)items[i].index;
        if (i + AHEAD < count) {
            __builtin_prefetch((const void *)(uintptr_t)items[i + AHEAD].index);
        }
        if (kept > 0 && have_one_name(&to[kept - 1], next)) {
            to[kept - 1].reserved += next->reserved;
            continue;
        }
        memcpy(&to[kept++], next, sizeof *next);
        counts->kind[next->kind]++;
    }
    return kept;
}

static void gather_pairs(struct pccd_pair *to, const struct eng_radix_key *items,
                         size_t count, size_t end, struct eng_counts *counts)
{
    for (size_t i = 0; i < count; i++) {
        if (i + AHEAD < end) {
            __builtin_prefetch((const void *)(uintptr_t)items[i + AHEAD].index);
        }
        memcpy(&to[i], (const void *)(uintptr_t)items[i].index, sizeof to[i]);
        counts->kind[to[i].kind]++;
    }
}

/* Copy the records of items[count] to their places, count and hash them. */
static void gather(const struct eng_merge *merge, unsigned char *to,
                   const struct eng_radix_key *items, size_t count,
                   struct eng_counts *counts)
{
    uint32_t bytes = merge->out->record_bytes;
    const size_t piece = PIECE_BYTES / bytes;
    for (size_t i = 0; i < count; i += piece) {
        size_t n = count - i < piece ? count - i : piece;
        unsigned char *place = to + i * bytes;
        if (bytes == sizeof(struct pccd_pair)) {
            gather_pairs((struct pccd_pair *)(void *)place, items + i, n, count - i,
                         counts);
        } else {
            gather_contacts((struct pccd_contact *)(void *)place, items + i, n, count - i,
                            counts);
        }
        counts->hash += merge->no_hash ? 0 : eng_hash_records(place, n, bytes);
    }
}

/* Bring the parts of bucket `b` together, list by list; one list's are together. *place:
 * of its first record in the answer. They may lie at the end of these places: a record is
 * at least as long as an item, so that those to come are behind what is filled. */
static struct eng_radix_key *collect(struct eng_merge *merge, uint32_t b, uint32_t *place,
                                     uint32_t *count)
{
    const struct eng_merge_share *first = &merge->shares[0];
    uint32_t position = 0;
    uint32_t n = 0;
    for (uint32_t t = 0; t < merge->threads; t++) {
        const struct eng_merge_share *share = &merge->shares[t];
        position += share->begin[b] - share->first;
        n += share->begin[b + 1] - share->begin[b];
    }
    *place = position;
    *count = n;
    if (merge->threads == 1) {
        return merge->items + first->begin[b];
    }
    struct eng_radix_key *together =
        merge->items + merge->total + position; /* if not there */
    if (!eng_merge_needs_other(merge)) {
        unsigned char *end =
            merge->out->data + ((size_t)position + n) * merge->out->record_bytes;
        together = (struct eng_radix_key *)(void *)end - n;
    }
    struct eng_radix_key *items = together;
    for (uint32_t t = 0; t < merge->threads; t++) {
        const struct eng_merge_share *share = &merge->shares[t];
        uint32_t part = share->begin[b + 1] - share->begin[b];
        memcpy(items, merge->items + share->begin[b], part * sizeof *items);
        items += part;
    }
    return together;
}

void eng_bucket_finish(struct eng_merge *merge, uint32_t b, struct eng_counts *counts)
{
    assert(b < merge->splitters.buckets);
    uint32_t begin;
    uint32_t count;
    struct eng_radix_key *items = collect(merge, b, &begin, &count);
    if (merge->folds) {
        merge->folded[b] = (struct eng_merge_fold){begin, 0};
    }
    if (count == 0 || begin >= merge->kept) {
        return;
    }
    uint64_t kept = merge->kept - begin < count ? merge->kept - begin : count;
    /* The places of the records are the sort's scratch before they are filled: 20 bytes
     * or more for 16, behind at most 4 to the next place that is aligned; or 64, and the
     * last 16 of them have items. */
    unsigned char *to = merge->out->data + (size_t)begin * merge->out->record_bytes;
    uintptr_t place = ((uintptr_t)to + 7) & ~(uintptr_t)7;
    sort_items(merge, items, (struct eng_radix_key *)place, count, 0);
    if (merge->folds) {
        kept = gather_folded((struct pccd_contact *)(void *)to, items, kept, counts);
        merge->folded[b].count = (uint32_t)kept;
        counts->hash += eng_hash_records(to, kept, merge->out->record_bytes);
    } else {
        gather(merge, to, items, kept, counts);
    }
}
