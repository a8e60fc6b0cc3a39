/* rank_sort.h - sorts numbers with something attached, in linear time. */
#ifndef RANKS_RANK_SORT_H
#define RANKS_RANK_SORT_H

#include <stdint.h>

struct ranks_key {
    uint64_t key;
    uint64_t value;
};

/* Sorts count keys; `other` has room for as many. Returns where they are: `keys` or
 * `other`. */
struct ranks_key *ranks_sort(struct ranks_key *keys, struct ranks_key *other,
                             uint64_t count);

/* The same of words, by their upper 32 bits: half as many bytes for each pass. */
uint64_t *ranks_sort_words(uint64_t *words, uint64_t *other, uint64_t count);

#endif
