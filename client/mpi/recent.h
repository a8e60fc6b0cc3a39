/* recent.h - what was said of numbers that came shortly before.
 *
 * Remember a value for each of some thousand numbers. Leaves along the curve name a
 * vertex, or an edge, again soon after the first time, so that it need be looked for only
 * then.
 *
 * Threads: [any]; the memory is one caller's.
 */
#ifndef RANKS_RECENT_H
#define RANKS_RECENT_H

#include <stdbool.h>
#include <stdint.h>
#include <string.h>

/* All of it stays in the first cache. */
#define RANKS_RECENT_BITS 11u

struct ranks_recent {
    struct ranks_recent_entry {
        uint32_t number;
        uint32_t value;
    } entries[1u << RANKS_RECENT_BITS];
};

/* No number is known; none is UINT32_MAX. */
static inline void ranks_recent_begin(struct ranks_recent *recent)
{
    memset(recent, 0xff, sizeof *recent);
}

/* The entry of a number, which has it already if *is_known; else another one is
 * forgotten, and the value is to be written. */
static inline uint32_t *ranks_recent_value(struct ranks_recent *recent, uint32_t number,
                                           bool *is_known)
{
    uint32_t place = number * 2654435769u >> (32 - RANKS_RECENT_BITS);
    struct ranks_recent_entry *entry = &recent->entries[place];
    *is_known = entry->number == number;
    entry->number = number;
    return &entry->value;
}

#endif
