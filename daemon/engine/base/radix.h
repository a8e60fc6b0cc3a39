/* radix.h - sorts items by a key of 64 bits (a stable radix sort). */
#ifndef ENG_RADIX_H
#define ENG_RADIX_H

#include <stddef.h>
#include <stdint.h>

struct eng_radix_key {
    uint64_t key;
    uint64_t index; /* carried along */
};

/* Sort items[count] ascending by key, equal keys in their order of arrival; spare has
 * room for count items too. Returns whichever of the two holds the result. O(count) for
 * each digit that differs; no allocation. */
struct eng_radix_key *eng_radix_sort(struct eng_radix_key *items,
                                     struct eng_radix_key *spare, size_t count);

/* Sort words[count] by `bits` of their bits, from bit `low` on; otherwise the same. Best
 * where all of them fit into a near cache. */
uint64_t *eng_radix_sort_words(uint64_t *words, uint64_t *spare, size_t count,
                               unsigned low, unsigned bits);

#endif
