/* sort.h - two ways to sort: split a list at the median of one coordinate, as builders of
 * trees do, and order items by a key, digit by digit.
 *
 * Threads: [any]; no allocation.
 * Source: Hoare 1961 (selection); Floyd, Rivest 1975 (a pivot beside the median of a
 * sample); Edelkamp, Weiss 2016 (blocks, without branches); Musser 1997 (a bound for
 * unlucky or hostile input).
 */
#ifndef ENG_SORT_H
#define ENG_SORT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* ---- at a median ------------------------------------------------------------------- */

struct eng_split_item {
    float centroid[3];
    uint32_t id; /* triangle, or root node of an object; distinct within a list */
};

/* Return for 64 items a bit each that comes before the pivot along an axis (kernel.h). */
typedef uint64_t eng_come_before_fn(const struct eng_split_item *items,
                                    const struct eng_split_item *pivot, int axis);

/* Reorder items[count] so that none of the first `middle` comes after any of the rest
 * along `axis` (0 .. 2); equal centroids are ordered by id, so the halves are the same
 * sets whatever the order was. O(count) as a rule, O(count log count) at worst. */
void eng_median_split(struct eng_split_item *items, uint32_t count, uint32_t middle,
                      int axis, eng_come_before_fn *come_before);

/* The same in rounds of at most one pass over the items, for who has to stop between. */
struct eng_median {
    uint32_t middle;
    int axis;
    eng_come_before_fn *come_before;
    uint32_t low; /* the range in which the median still is */
    uint32_t high;
    uint32_t rounds_left;
};

void eng_median_begin(struct eng_median *median, uint32_t count, uint32_t middle,
                      int axis, eng_come_before_fn *come_before);

/* Do one round; true: the items are split. */
bool eng_median_round(struct eng_median *median, struct eng_split_item *items);

/* Return the axis along which the centroids of items[count] extend most; count >= 1. */
int eng_median_axis(const struct eng_split_item *items, uint32_t count);

/* ---- items by a key of 64 bits ----------------------------------------------------- */

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
