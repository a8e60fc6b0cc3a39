/* split.h - divides keys into buckets of about equal size, for a sort by several threads.
 *
 * Choose keys that divide a sample evenly, and find the bucket of a key. Where keys are
 * dense the buckets are narrow, so that none is much larger than the others.
 *
 * Threads: set: one thread; find: [any] after it.
 * Source: Frazer, McKellar: Samplesort (1970); Sanders, Winkel: Super scalar sample sort
 * (2004) for the tree without branches.
 */
#ifndef ENG_SPLIT_H
#define ENG_SPLIT_H

#include "radix.h"

#define ENG_SPLIT_BUCKETS_MAX 1024u
#define ENG_SPLIT_GROUP       8u /* keys looked up side by side */

struct eng_splitters {
    uint32_t buckets; /* a power of two */
    uint32_t levels;
    uint64_t tree[ENG_SPLIT_BUCKETS_MAX]; /* breadth-first from place 1 on */
};

/* Divide the samples, sorted by key, each standing for `index` keys, into `buckets`:
 * a power of two up to ENG_SPLIT_BUCKETS_MAX; count >= 1. */
void eng_splitters_set(struct eng_splitters *splitters,
                       const struct eng_radix_key *samples, size_t count,
                       uint32_t buckets);

/* The bucket of each key: a larger key has no smaller bucket, equal keys the same. */
void eng_splitters_find(const struct eng_splitters *splitters,
                        const uint64_t key[ENG_SPLIT_GROUP],
                        uint16_t bucket[ENG_SPLIT_GROUP]);

#endif
