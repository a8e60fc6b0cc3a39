/* wide_lists.h - sorts many items once along each axis, and splits them by that.
 *
 * Threads: [any]; the memory is one caller's.
 * Source: Bentley 1975 (k-d trees); Vaidya 1989 (lists that stay sorted).
 */
#ifndef ENG_WIDE_LISTS_H
#define ENG_WIDE_LISTS_H

#include "median.h"
#include "wide_range.h"

/* So many items at most, with which all of this stays in near caches; and so many at
 * least, below which the passes do not pay. */
#define ENG_WIDE_LISTS_MAX 4096u
#define ENG_WIDE_LISTS_MIN 256u

struct eng_wide_lists {
    uint64_t words[2][ENG_WIDE_LISTS_MAX];  /* one axis, while it is sorted */
    uint16_t sorted[3][ENG_WIDE_LISTS_MAX]; /* items along each axis */
    uint16_t second[ENG_WIDE_LISTS_MAX];    /* some of them on their way */
    uint8_t is_second[ENG_WIDE_LISTS_MAX];  /* in which half each item is */
    uint32_t id[ENG_WIDE_LISTS_MAX];        /* in the end */
};

/* Items range.first and so on get their ids in order; where they are is not kept. Groups
 * have the same items as by eng_wide_sort, in an order that depends on them alone. */
void eng_wide_lists_sort(struct eng_wide_lists *lists, struct eng_split_item *items,
                         struct eng_wide_range range, uint32_t least);

#endif
