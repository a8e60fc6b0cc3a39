/* rank_sort.h - sorts numbers with something attached, in linear time, and remembers
 * what was said of numbers shortly before. */
#ifndef RANKS_RANK_SORT_H
#define RANKS_RANK_SORT_H

#include <stdbool.h>
#include <stdint.h>
#include <string.h>

struct ranks_key {
    uint64_t key;
    uint64_t value;
};

/* Sort count keys; `other` has room for as many. Returns where they are: `keys` or
 * `other`. */
struct ranks_key *ranks_sort(struct ranks_key *keys, struct ranks_key *other,
                             uint64_t count);

/* Sort words so, by their upper 32 bits: half as many bytes for each pass. */
uint64_t *ranks_sort_words(uint64_t *words, uint64_t *other, uint64_t count);

/* ---- A value for each of some thousand numbers. Leaves along the curve name a vertex,
 * or an edge, again soon after the first time, so that it need be looked for only
 * then. */

/* All of it stays in the first cache. */
#define RANKS_RECENT_BITS 11u

struct ranks_recent {
    struct ranks_recent_entry {
        uint32_t number;
        uint32_t value;
    } entries[1u << RANKS_RECENT_BITS];
};

/* Begin with no number known; none is UINT32_MAX. */
static inline void ranks_recent_begin(struct ranks_recent *recent)
{
    memset(recent, 0xff, sizeof *recent);
}

/* Return the value in the entry of a number, which has it already if *is_known; else
 * another number is forgotten, and the value is to be written. */
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
