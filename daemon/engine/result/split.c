/* split.c - buckets of about the same size for any keys. */
#include "split.h"

#include <assert.h>

void eng_splitters_set(struct eng_splitters *splitters,
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

void eng_splitters_find(const struct eng_splitters *splitters,
                        const uint64_t key[ENG_SPLIT_GROUP],
                        uint16_t bucket[ENG_SPLIT_GROUP])
{
    uint32_t place[ENG_SPLIT_GROUP];
#pragma GCC unroll 8
    for (unsigned k = 0; k < ENG_SPLIT_GROUP; k++) {
        place[k] = 1;
    }
    for (uint32_t level = 0; level < splitters->levels; level++) {
#pragma GCC unroll 8
        for (unsigned k = 0; k < ENG_SPLIT_GROUP; k++) {
            place[k] = 2 * place[k] + (key[k] >= splitters->tree[place[k]]);
        }
    }
#pragma GCC unroll 8
    for (unsigned k = 0; k < ENG_SPLIT_GROUP; k++) {
        bucket[k] = (uint16_t)(place[k] - splitters->buckets);
    }
}
