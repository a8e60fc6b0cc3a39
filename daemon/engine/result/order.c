/* order.c - the canonical order of records, in few bits, and the hash of an answer. */
#include "order.h"

/* In this file: with a length that the compiler knows, a record takes 60 instructions. */
#define XXH_INLINE_ALL
#include <xxhash.h>

#define WORD_BITS 64u

void eng_name_range_init(struct eng_name_range *range)
{
    memset(&range->low, 0xff, sizeof range->low);
    memset(&range->high, 0, sizeof range->high);
}

void eng_order_set(struct eng_order *order, const struct eng_name_range *range)
{
    uint32_t bits = 0;
    order->low = range->low;
    for (unsigned i = ENG_NAME_WORDS; i-- > 0;) {
        uint32_t span = range->high.word[i] - range->low.word[i];
        uint32_t width = span == 0 ? 0 : 32 - (uint32_t)__builtin_clz(span);
        order->width[i] = (uint8_t)width;
        order->shift[i] = width == 0 ? 0 : (uint8_t)bits; /* a 0 may stand anywhere */
        bits += width;
    }
    order->words = bits <= WORD_BITS ? 1 : (bits + WORD_BITS - 1) / WORD_BITS;
}

/* The key begins at the top of its first word; what does not fit goes on in the next. */
uint64_t eng_order_wide_key(const struct eng_order *order, const struct eng_name *name,
                            uint32_t word)
{
    uint64_t key = 0;
    uint32_t end = 0; /* bits of the key so far */
    for (unsigned i = 0; i < ENG_NAME_WORDS; i++) {
        uint64_t value = name->word[i] - order->low.word[i];
        uint32_t begin = end;
        end += order->width[i];
        if (end <= word * WORD_BITS || begin >= (word + 1) * WORD_BITS) {
            continue;
        }
        if (end <= (word + 1) * WORD_BITS) {
            key |= value << ((word + 1) * WORD_BITS - end);
        } else {
            key |= value >> (end - (word + 1) * WORD_BITS);
        }
    }
    return key;
}

/* ---- the hash of an answer --------------------------------------------------------- */

static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__,
              "records are hashed as they lie");

static inline eng_hash_sum hash_bytes(const void *data, size_t bytes)
{
    XXH128_hash_t hash = XXH3_128bits(data, bytes);
    return (eng_hash_sum)hash.high64 << 64 | hash.low64;
}

static inline eng_hash_sum add_up(const unsigned char *record, uint64_t count,
                                  size_t record_bytes)
{
    eng_hash_sum sum = 0;
    for (uint64_t i = 0; i < count; i++) {
        sum += hash_bytes(record + i * record_bytes, record_bytes);
    }
    return sum;
}

eng_hash_sum eng_hash_records(const void *records, uint64_t count, uint32_t record_bytes)
{
    assert(records || count == 0);
    switch (record_bytes) {
    case sizeof(struct pccd_contact):
        return add_up(records, count, sizeof(struct pccd_contact));
    case sizeof(struct pccd_pair):
        return add_up(records, count, sizeof(struct pccd_pair));
    default:
        return add_up(records, count, record_bytes);
    }
}

static void tell(eng_hash_sum sum, uint64_t hash[2])
{
    hash[0] = (uint64_t)(sum >> 64);
    hash[1] = (uint64_t)sum;
}

void eng_hash_end(eng_hash_sum sum, uint64_t count, uint64_t hash[2])
{
    tell(sum + hash_bytes(&count, sizeof count), hash);
}

void eng_hash_verdict(uint32_t verdict, uint64_t hash[2])
{
    tell(hash_bytes(&verdict, sizeof verdict), hash);
}
