/* rank_sort.c - radix sort, the lowest byte first.
 *
 * Room:     client/mpi.
 * Does:     leave out bytes in which all keys agree.
 * Threads:  [any].
 * Source:   rank_sort.h.
 */
#include "rank_sort.h"

#include <stdbool.h>
#include <string.h>

#define DIGITS 256u

static bool all_are_equal(const uint64_t counts[DIGITS], uint64_t count)
{
    for (uint32_t d = 0; d < DIGITS; d++) {
        if (counts[d] != 0) {
            return counts[d] == count;
        }
    }
    return true;
}

struct ranks_key *ranks_sort(struct ranks_key *keys, struct ranks_key *other,
                             uint64_t count)
{
    uint64_t counts[8][DIGITS];
    memset(counts, 0, sizeof counts);
    for (uint64_t i = 0; i < count; i++) {
        for (uint32_t byte = 0; byte < 8; byte++) {
            counts[byte][keys[i].key >> 8 * byte & 255u]++;
        }
    }
    for (uint32_t byte = 0; byte < 8; byte++) {
        if (all_are_equal(counts[byte], count)) {
            continue;
        }
        uint64_t before = 0;
        for (uint32_t d = 0; d < DIGITS; d++) {
            uint64_t here = counts[byte][d];
            counts[byte][d] = before;
            before += here;
        }
        for (uint64_t i = 0; i < count; i++) {
            other[counts[byte][keys[i].key >> 8 * byte & 255u]++] = keys[i];
        }
        struct ranks_key *sorted = other;
        other = keys;
        keys = sorted;
    }
    return keys;
}
