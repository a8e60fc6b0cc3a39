/* wide_sort.h - sorts items by splits at medians, each at a multiple of the largest power
 * of 16 slots at which the range can be split.
 *
 * Threads: [any]; the memory is one caller's.
 * Source: Bentley 1975 (k-d trees); Vaidya 1989 (lists that stay sorted).
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

/* So many items at most, with which all of this stays in near caches; and so many at
 * least, below which the passes do not pay. */
#define ENG_WIDE_LISTS_MAX 4096u
#define ENG_WIDE_LISTS_MIN 256u

struct eng_wide_lists {
    uint64_t words[2][ENG_WIDE_LISTS_MAX];  /* one axis, while it is sorted */
    uint16_t sorted[3][ENG_WIDE_LISTS_MAX]; /* items along each axis */
    uint16_t second[ENG_WIDE_LISTS_MAX];    /* some of them on their way */
    uint8_t is_second[ENG_WIDE_LISTS_MAX];  /* in which half each item is */
    uint32_t *id;                           /* in the end */
};

/* Split a range down to groups of 16. The ids go to ids[range.first] and so on, in an
 * order that depends on the items alone; groups have the same items as by
 * eng_wide_sort. */
void eng_wide_lists_sort(struct eng_wide_lists *lists, const struct eng_split_item *items,
                         struct eng_wide_range range, uint32_t *ids);

/* Parts of all three trees, at most. */
#define ENG_WIDE_PARTS_MAX 768u

/* Sort all of parts[count], which have room for ENG_WIDE_PARTS_MAX, down to groups of 16,
 * by as many threads: parallel regions if there are several. lists[threads]: with which
 * many items are sorted sooner; NULL: without. The items are lost; their ids go to ids[],
 * each to where its item belongs. */
void eng_wide_sort_parts(struct eng_split_item *items, struct eng_wide_range *parts,
                         uint32_t count, int threads, struct eng_wide_lists *lists,
                         uint32_t *ids);

#endif
