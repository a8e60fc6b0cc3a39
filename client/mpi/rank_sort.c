/* rank_sort.c - radix sort, the lowest digit first. */
#include "rank_sort.h"

#include <string.h>

#define DIGIT_BITS 11u
#define DIGITS     (1u << DIGIT_BITS)

/* The bits in which keys differ. */
static uint64_t differing(const struct ranks_key *keys, uint64_t count)
{
    uint64_t bits = 0;
    for (uint64_t i = 1; i < count; i++) {
        bits |= keys[i].key ^ keys[0].key;
    }
    return bits;
}

/* Turn how many have each digit into where the first of them belongs. */
static void begin_digits(uint64_t next[DIGITS])
{
    uint64_t before = 0;
    for (uint32_t d = 0; d < DIGITS; d++) {
        uint64_t here = next[d];
        next[d] = before;
        before += here;
    }
}

static void sort_by_digit(const struct ranks_key *keys, struct ranks_key *to,
                          uint64_t count, uint32_t shift)
{
    uint64_t next[DIGITS];
    memset(next, 0, sizeof next);
    for (uint64_t i = 0; i < count; i++) {
        next[keys[i].key >> shift & (DIGITS - 1)]++;
    }
    begin_digits(next);
    for (uint64_t i = 0; i < count; i++) {
        to[next[keys[i].key >> shift & (DIGITS - 1)]++] = keys[i];
    }
}

static void sort_words_by_digit(const uint64_t *words, uint64_t *to, uint64_t count,
                                uint32_t shift)
{
    uint64_t next[DIGITS];
    memset(next, 0, sizeof next);
    for (uint64_t i = 0; i < count; i++) {
        next[words[i] >> shift & (DIGITS - 1)]++;
    }
    begin_digits(next);
    for (uint64_t i = 0; i < count; i++) {
        to[next[words[i] >> shift & (DIGITS - 1)]++] = words[i];
    }
}

uint64_t *ranks_sort_words(uint64_t *words, uint64_t *other, uint64_t count)
{
    uint64_t bits = 0;
    uint32_t shift = 32;
    for (uint64_t i = 1; i < count; i++) {
        bits |= (words[i] ^ words[0]) >> 32;
    }
    while (bits != 0) {
        uint32_t skipped = (uint32_t)__builtin_ctzll(bits);
        shift += skipped;
        sort_words_by_digit(words, other, count, shift);
        uint64_t *sorted = other;
        other = words;
        words = sorted;
        bits = bits >> skipped >> DIGIT_BITS;
        shift += DIGIT_BITS;
    }
    return words;
}

struct ranks_key *ranks_sort(struct ranks_key *keys, struct ranks_key *other,
                             uint64_t count)
{
    uint64_t bits = differing(keys, count);
    uint32_t shift = 0;
    while (bits != 0) {
        uint32_t skipped = (uint32_t)__builtin_ctzll(bits);
        shift += skipped;
        sort_by_digit(keys, other, count, shift);
        struct ranks_key *sorted = other;
        other = keys;
        keys = sorted;
        bits = bits >> skipped >> DIGIT_BITS;
        shift += DIGIT_BITS;
    }
    return keys;
}
