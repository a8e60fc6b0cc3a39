/* daemon/engine/result/radix.c - stable radix sort of wide keys.
 *
 * Room:     engine.
 * Does:     least significant digit first, 8 bits a pass.
 * Threads:  [any].
 */
#include "radix.h"

#include <string.h>

#define DIGITS 16 /* bytes of a key */

static unsigned digit_of(const struct eng_radix_item *item, unsigned digit)
{
    uint64_t half = digit < 8 ? item->lo : item->hi;
    return (unsigned)(half >> (8 * (digit & 7))) & 255u;
}

static void pass(const struct eng_radix_item *from, struct eng_radix_item *to,
                 size_t count, unsigned digit)
{
    size_t offset[256] = {0};
    for (size_t i = 0; i < count; i++) {
        offset[digit_of(&from[i], digit)]++;
    }
    size_t sum = 0;
    for (unsigned d = 0; d < 256; d++) {
        size_t n = offset[d];
        offset[d] = sum;
        sum += n;
    }
    for (size_t i = 0; i < count; i++) {
        to[offset[digit_of(&from[i], digit)]++] = from[i];
    }
}

struct eng_radix_item *eng_radix_sort(struct eng_radix_item *items,
                                      struct eng_radix_item *spare, size_t count)
{
    uint64_t differ_hi = 0;
    uint64_t differ_lo = 0;
    for (size_t i = 1; i < count; i++) {
        differ_hi |= items[i].hi ^ items[0].hi;
        differ_lo |= items[i].lo ^ items[0].lo;
    }
    for (unsigned digit = 0; digit < DIGITS; digit++) {
        uint64_t half = digit < 8 ? differ_lo : differ_hi;
        if (((half >> (8 * (digit & 7))) & 255u) == 0) {
            continue;
        }
        pass(items, spare, count, digit);
        struct eng_radix_item *swap = items;
        items = spare;
        spare = swap;
    }
    return items;
}
