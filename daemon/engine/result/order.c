/* order.c - the canonical order of records, in few bits. */
#include "order.h"

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
