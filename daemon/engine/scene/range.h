/* range.h - hands out ranges of consecutive indices in an array, so that objects come and
 * go without moving others.
 *
 * Threads: one thread for one allocator.
 */
#ifndef ENG_RANGE_H
#define ENG_RANGE_H

#include <stdint.h>

#include "pccd_types.h"

struct eng_range {
    uint32_t first;
    uint32_t count;
};

struct eng_ranges {
    struct eng_range *holes; /* free, sorted by first, never adjacent, all below end */
    uint32_t hole_count;
    uint32_t hole_capacity;
    uint32_t taken; /* ranges handed out and not given back */
    uint32_t end;   /* first index never handed out, or handed back at the end */
    uint32_t limit; /* end never passes it */
};

void eng_ranges_init(struct eng_ranges *ranges, uint32_t limit);
void eng_ranges_deinit(struct eng_ranges *ranges);

/* First fit, else from the end. count >= 1. PCCD_E_LIMIT: would pass the limit;
 * PCCD_E_NOMEM. */
int eng_ranges_take(struct eng_ranges *ranges, uint32_t count, uint32_t *first);

/* Give a taken range back; merges with neighbouring holes. Cannot fail: take reserves the
 * room that the list of holes may need. */
void eng_ranges_give(struct eng_ranges *ranges, uint32_t first, uint32_t count);

#endif
