/* wide_range.h - where a range of slots is split.
 *
 * Threads: [any]; inline only.
 */
#ifndef ENG_WIDE_RANGE_H
#define ENG_WIDE_RANGE_H

#include <assert.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "boxes.h"

/* Items first .. first + count - 1 of a list; the first goes to a slot. */
struct eng_wide_range {
    size_t first;
    uint32_t slot;
    uint32_t count;
};

/* Is a range across a multiple of `step` slots, so that it is to be split there? */
static inline bool eng_wide_is_across(struct eng_wide_range range, uint64_t step)
{
    return range.slot % step + range.count > step;
}

/* Of a range across a multiple of `least`: how many items come before the split, which is
 * at a multiple of the largest power of 16 at which there can be one. */
static inline uint32_t eng_wide_middle_of(struct eng_wide_range range, uint32_t least)
{
    uint64_t step = least;
    while (eng_wide_is_across(range, step * ENG_WIDE)) {
        step *= ENG_WIDE;
    }
    uint64_t middle = ((uint64_t)range.slot + range.count / 2 + step / 2) / step * step;
    assert(middle > range.slot && middle - range.slot < range.count);
    return (uint32_t)(middle - range.slot);
}

#endif
