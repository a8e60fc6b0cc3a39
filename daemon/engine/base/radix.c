/* radix.c - a stable radix sort. */
#include "radix.h"

#include <stdbool.h>
#include <string.h>

/* Bits of a digit: of more items wider ones, as a pass costs more than its counters. */
#define DIGIT_MAX 9u
#define DIGIT_FEW 8u
#define FEW_ITEMS 512u

/* Items that are sorted sooner by insertion than by passes. */
#define INSERTION_MAX 24u

/* So many items, of keys that differ in few enough bits, are sorted as words of these
 * bits and the item's place: half as many bytes for each pass, which stay in the first
 * cache, so that wider digits pay, too. */
#define PLACE_BITS     12u
#define WORDS_MAX      (1u << PLACE_BITS)
#define WORD_DIGIT_MAX 11u
#define WORD_DIGIT_FEW 9u
#define FEW_WORDS      1024u

static void insert_all(struct eng_radix_key *items, size_t count)
{
    for (size_t i = 1; i < count; i++) {
        struct eng_radix_key item = items[i];
        size_t at = i;
        while (at > 0 && items[at - 1].key > item.key) {
            items[at] = items[at - 1];
            at--;
        }
        items[at] = item;
    }
}

/* Of how many items have each digit: where the first of them belongs. */
static void begin_digits(uint32_t *offset, uint64_t mask)
{
    uint32_t sum = 0;
    for (size_t d = 0; d <= mask; d++) {
        uint32_t n = offset[d];
        offset[d] = sum;
        sum += n;
    }
}

static void pass(const struct eng_radix_key *from, struct eng_radix_key *to, size_t count,
                 unsigned shift, unsigned bits)
{
    uint32_t offset[1u << DIGIT_MAX];
    uint64_t mask = ((uint64_t)1 << bits) - 1;
    memset(offset, 0, (mask + 1) * sizeof *offset);
    for (size_t i = 0; i < count; i++) {
        offset[from[i].key >> shift & mask]++;
    }
    begin_digits(offset, mask);
    for (size_t i = 0; i < count; i++) {
        to[offset[from[i].key >> shift & mask]++] = from[i];
    }
}

static void word_pass(const uint64_t *from, uint64_t *to, size_t count, unsigned shift,
                      unsigned bits)
{
    uint32_t offset[1u << WORD_DIGIT_MAX];
    uint64_t mask = ((uint64_t)1 << bits) - 1;
    memset(offset, 0, (mask + 1) * sizeof *offset);
    for (size_t i = 0; i < count; i++) {
        offset[from[i] >> shift & mask]++;
    }
    begin_digits(offset, mask);
    for (size_t i = 0; i < count; i++) {
        to[offset[from[i] >> shift & mask]++] = from[i];
    }
}

/* The passes that words of such keys take. */
static unsigned word_digits(size_t count, unsigned bits)
{
    unsigned most = count < FEW_WORDS ? WORD_DIGIT_FEW : WORD_DIGIT_MAX;
    return (bits + most - 1) / most;
}

uint64_t *eng_radix_sort_words(uint64_t *words, uint64_t *spare, size_t count,
                               unsigned low, unsigned bits)
{
    unsigned digits = word_digits(count, bits);
    unsigned size = digits > 0 ? (bits + digits - 1) / digits : 0;
    for (unsigned digit = 0; digit < digits; digit++) {
        word_pass(words, spare, count, low + digit * size, size);
        uint64_t *swap = words;
        words = spare;
        spare = swap;
    }
    return words;
}

/* Keys differ in `bits` bits from bit `low` on, at most 64 - PLACE_BITS. The words are in
 * two halves of spare; sorted they are in the second one, so that items can be written
 * over them from the front: item i ends where word i does, at most. */
static void sort_words(const struct eng_radix_key *items, struct eng_radix_key *spare,
                       size_t count, unsigned low, unsigned bits)
{
    uint64_t *first = (uint64_t *)(void *)spare;
    uint64_t *second = first + count;
    bool is_even = word_digits(count, bits) % 2 == 0;
    uint64_t *from = is_even ? second : first;
    for (size_t i = 0; i < count; i++) {
        from[i] = items[i].key >> low << PLACE_BITS | i;
    }
    (void)eng_radix_sort_words(from, is_even ? first : second, count, PLACE_BITS, bits);
    for (size_t i = 0; i < count; i++) {
        spare[i] = items[second[i] & (WORDS_MAX - 1)];
    }
}

struct eng_radix_key *eng_radix_sort(struct eng_radix_key *items,
                                     struct eng_radix_key *spare, size_t count)
{
    uint64_t differ = 0;
    if (count <= INSERTION_MAX) {
        insert_all(items, count);
        return items;
    }
    for (size_t i = 1; i < count; i++) {
        differ |= items[i].key ^ items[0].key;
    }
    if (differ == 0) {
        return items;
    }
    /* Digits of one size between the first and the last bit that differ. */
    unsigned low = (unsigned)__builtin_ctzll(differ);
    unsigned bits = 64 - (unsigned)__builtin_clzll(differ) - low;
    if (count <= WORDS_MAX && bits <= 64 - PLACE_BITS) {
        sort_words(items, spare, count, low, bits);
        return spare;
    }
    unsigned most = count < FEW_ITEMS ? DIGIT_FEW : DIGIT_MAX;
    unsigned digits = (bits + most - 1) / most;
    unsigned size = (bits + digits - 1) / digits;
    for (unsigned digit = 0; digit < digits; digit++) {
        unsigned shift = low + digit * size;
        if ((differ >> shift & (((uint64_t)1 << size) - 1)) == 0) {
            continue;
        }
        pass(items, spare, count, shift, size);
        struct eng_radix_key *swap = items;
        items = spare;
        spare = swap;
    }
    return items;
}
