/* daemon/engine/result/radix.h - stable radix sorts.
 *
 * Room:     engine. May include: the C library.
 * Does:     sort items by a key of 128 or of 64 bits; passes over digits that are equal
 *           in all keys are skipped, so the cost follows the information in the keys.
 * Threads:  [any].
 */
#ifndef ENG_RADIX_H
#define ENG_RADIX_H

#include <stddef.h>
#include <stdint.h>

struct eng_radix_item {
    uint64_t hi; /* more significant half of the key */
    uint64_t lo;
    uint64_t index; /* carried along */
};

/* Sort items[count] ascending by (hi, lo), equal keys in their order of arrival; spare
 * has room for count items too. Returns whichever of the two holds the result. O(count)
 * for each digit that differs; no allocation. */
struct eng_radix_item *eng_radix_sort(struct eng_radix_item *items,
                                      struct eng_radix_item *spare, size_t count);

struct eng_radix_key {
    uint64_t key;
    uint64_t index; /* carried along */
};

/* The same by 64 bits. */
struct eng_radix_key *eng_radix_sort_keys(struct eng_radix_key *items,
                                          struct eng_radix_key *spare, size_t count);

#endif
