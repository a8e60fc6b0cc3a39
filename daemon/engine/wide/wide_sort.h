/* wide_sort.h - sorts items by splits at medians, each at a multiple of the largest power
 * of 16 slots at which the range can be split.
 *
 * Threads: [any]; the memory is one caller's.
 * Source: Bentley 1975 (k-d trees); Sedgewick 1986 (gaps of a Shell sort).
 */
#ifndef ENG_WIDE_SORT_H
#define ENG_WIDE_SORT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "sort.h"

/* Items first .. first + count - 1 of a list; the first goes to a slot. */
struct eng_wide_range {
    size_t first;
    uint32_t slot;
    uint32_t count;
};

/* Sort items[count], from slot 0 on, by splits at the median of the longest axis, each at
 * a multiple of the largest power of 16 at which the range can be split; until none is
 * across a multiple of `least`, 1 or 16. */
void eng_wide_sort(struct eng_split_item *items, uint32_t count, uint32_t least);

/* The same of any range, by parts, for who has to stop between. */
struct eng_wide_sorter {
    uint32_t least;
    uint32_t waiting; /* ranges of the stack */
    struct eng_wide_range stack[64];
    bool is_splitting; /* the one at hand */
    struct eng_wide_range range;
    struct eng_median median;
};

void eng_wide_sorter_begin(struct eng_wide_sorter *sorter, struct eng_wide_range range,
                           uint32_t least);

/* Do one pass over a range of the items, or everything that is below a range of at most
 * `whole` items. False: all was sorted already. */
bool eng_wide_sorter_advance(struct eng_wide_sorter *sorter, struct eng_split_item *items,
                             uint32_t whole);

/* So many items at most, whose words stay in a near cache; and so many at least, below
 * which it does not pay. */
#define ENG_WIDE_WORDS_MAX 16384u
#define ENG_WIDE_WORDS_MIN 256u

/* Split a range down to groups of 16, by words of 64 bits in the place of its items.
 * words[2 * range.count] is scratch. The ids go to ids[range.first] and so on, in an
 * order that depends on the items alone; groups are those of eng_wide_sort. */
void eng_wide_words_sort(uint64_t *words, const struct eng_split_item *items,
                         struct eng_wide_range range, uint32_t *ids);

/* Parts of all three trees, at most. */
#define ENG_WIDE_PARTS_MAX 768u

/* Sort all of parts[count], which have room for ENG_WIDE_PARTS_MAX, down to groups of 16,
 * by as many threads: parallel regions if there are several. words: scratch, for each of
 * several threads 2 * ENG_WIDE_WORDS_MAX, for one as many as for its largest part; NULL:
 * items are sorted without. The items are lost; their ids go to ids[], each to where its
 * item belongs. */
void eng_wide_sort_parts(struct eng_split_item *items, struct eng_wide_range *parts,
                         uint32_t count, int threads, uint64_t *words, uint32_t *ids);

#endif
