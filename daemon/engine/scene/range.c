/* range.c - ranges of consecutive indices in growing arrays.
 *
 * Keep the holes sorted. A range handed out lies behind every hole but one that is just
 * being made, so there are never more holes than ranges were out before: `take` grows the
 * list to that number and `give` cannot fail.
 */
#include "range.h"

#include <assert.h>
#include <stdbool.h>
#include <stddef.h>
#include <string.h>

#include "memory.h"

void eng_ranges_init(struct eng_ranges *ranges, uint32_t limit)
{
    memset(ranges, 0, sizeof *ranges);
    ranges->limit = limit;
}

void eng_ranges_deinit(struct eng_ranges *ranges)
{
    eng_free(ranges->holes);
    eng_ranges_init(ranges, 0);
}

static void remove_hole(struct eng_ranges *ranges, uint32_t i)
{
    ranges->hole_count--;
    memmove(&ranges->holes[i], &ranges->holes[i + 1],
            (ranges->hole_count - i) * sizeof *ranges->holes);
}

/* One more range is about to exist, so one more hole may appear when it goes. */
static int reserve_hole(struct eng_ranges *ranges)
{
    if (ranges->taken < ranges->hole_capacity) {
        return PCCD_OK;
    }
    uint32_t capacity = ranges->hole_capacity ? ranges->hole_capacity * 2 : 16;
    struct eng_range *holes = eng_realloc(ranges->holes, capacity, sizeof *holes);
    if (!holes) {
        return PCCD_E_NOMEM;
    }
    ranges->holes = holes;
    ranges->hole_capacity = capacity;
    return PCCD_OK;
}

int eng_ranges_take(struct eng_ranges *ranges, uint32_t count, uint32_t *first)
{
    assert(count >= 1);
    assert(count > 0);
    int status = reserve_hole(ranges);
    if (status != PCCD_OK) {
        return status;
    }
    for (uint32_t i = 0; i < ranges->hole_count; i++) {
        struct eng_range *hole = &ranges->holes[i];
        if (hole->count >= count) {
            *first = hole->first;
            hole->first += count;
            hole->count -= count;
            if (hole->count == 0) {
                remove_hole(ranges, i);
            }
            ranges->taken++;
            return PCCD_OK;
        }
    }
    if (count > ranges->limit - ranges->end) {
        return PCCD_E_LIMIT;
    }
    *first = ranges->end;
    ranges->end += count;
    ranges->taken++;
    return PCCD_OK;
}

void eng_ranges_give(struct eng_ranges *ranges, uint32_t first, uint32_t count)
{
    assert(count >= 1 && count <= ranges->end && first <= ranges->end - count);
    assert(ranges->taken > 0);
    uint32_t i = 0;
    while (i < ranges->hole_count && ranges->holes[i].first < first) {
        i++;
    }
    struct eng_range *below = i > 0 ? &ranges->holes[i - 1] : NULL;
    struct eng_range *above = i < ranges->hole_count ? &ranges->holes[i] : NULL;
    assert(!below || below->first + below->count <= first);
    assert(!above || first + count <= above->first);
    assert(ranges->taken > 0);
    ranges->taken--;
    bool joins_below = below && below->first + below->count == first;
    bool joins_above = above && first + count == above->first;
    if (joins_below) {
        below->count += count;
        if (joins_above) {
            below->count += above->count;
            remove_hole(ranges, i);
        }
    } else if (joins_above) {
        above->first = first;
        above->count += count;
    } else {
        assert(ranges->hole_count < ranges->hole_capacity);
        memmove(&ranges->holes[i + 1], &ranges->holes[i],
                (ranges->hole_count - i) * sizeof *ranges->holes);
        ranges->holes[i] = (struct eng_range){first, count};
        ranges->hole_count++;
    }
    struct eng_range *last = &ranges->holes[ranges->hole_count - 1];
    if (last->first + last->count == ranges->end) {
        ranges->end = last->first;
        ranges->hole_count--;
    }
}
