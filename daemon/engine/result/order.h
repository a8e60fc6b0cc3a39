/* order.h - the canonical order of records, packed into one 64-bit key as a rule, and the
 * hash of an answer.
 *
 * Read the five words that order a record, and pack them into as many bits as their
 * ranges need, most significant first. One 64-bit word is usually enough: two kinds, a
 * few objects and 2^20 features a side take 46 bits.
 */
#ifndef ENG_ORDER_H
#define ENG_ORDER_H

#include <assert.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include "pccd_types.h"

#define ENG_NAME_WORDS 5u

/* Kind, object a, feature a, object b, feature b. */
struct eng_name {
    uint32_t word[ENG_NAME_WORDS];
};

/* A contact has its flags between kind and objects. */
static_assert(offsetof(struct pccd_contact, object_a) == 8 &&
                  offsetof(struct pccd_contact, feature_b) == 20 &&
                  offsetof(struct pccd_pair, feature_b) == 16,
              "names");

/* The smallest and the largest value of each word. */
struct eng_name_range {
    struct eng_name low;
    struct eng_name high;
};

/* Where the words lie in a key. */
struct eng_order {
    struct eng_name low;
    uint8_t width[ENG_NAME_WORDS]; /* bits of word - low */
    uint8_t shift[ENG_NAME_WORDS]; /* words == 1: places to the left */
    uint32_t words;                /* of a key: 1 to 3 */
};

/* Return a word of the name of a pccd_pair or pccd_contact record, wherever that is. */
static inline uint32_t eng_name_word(const unsigned char *record, uint32_t record_bytes,
                                     unsigned word)
{
    uint32_t value;
    bool has_flags = record_bytes != sizeof(struct pccd_pair) && word > 0;
    memcpy(&value, record + 4 * (word + (has_flags ? 1 : 0)), sizeof value);
    return value;
}

static inline struct eng_name eng_name_of(const unsigned char *record,
                                          uint32_t record_bytes)
{
    struct eng_name name;
    for (unsigned i = 0; i < ENG_NAME_WORDS; i++) {
        name.word[i] = eng_name_word(record, record_bytes, i);
    }
    return name;
}

/* Compare two names in canonical order: below, equal or above zero. */
static inline int eng_name_compare(const struct eng_name *a, const struct eng_name *b)
{
    for (unsigned i = 0; i < ENG_NAME_WORDS; i++) {
        if (a->word[i] != b->word[i]) {
            return a->word[i] < b->word[i] ? -1 : 1;
        }
    }
    return 0;
}

static inline void eng_name_write(const struct eng_name *name, unsigned char *record,
                                  uint32_t record_bytes)
{
    if (record_bytes == sizeof(struct pccd_pair)) {
        memcpy(record, name, sizeof *name);
    } else {
        memcpy(record + offsetof(struct pccd_contact, kind), &name->word[0], 4);
        memcpy(record + offsetof(struct pccd_contact, object_a), &name->word[1], 16);
    }
}

/* Set the range to that of no names. */
void eng_name_range_init(struct eng_name_range *range);

static inline void eng_name_range_add(struct eng_name_range *range,
                                      const struct eng_name *name)
{
#pragma GCC unroll 5
    for (unsigned i = 0; i < ENG_NAME_WORDS; i++) {
        uint32_t word = name->word[i];
        range->low.word[i] = word < range->low.word[i] ? word : range->low.word[i];
        range->high.word[i] = word > range->high.word[i] ? word : range->high.word[i];
    }
}

void eng_order_set(struct eng_order *order, const struct eng_name_range *range);

/* Return a word of the key of a name, which is within the order's range: names compare as
 * their keys, word 0 first. */
uint64_t eng_order_wide_key(const struct eng_order *order, const struct eng_name *name,
                            uint32_t word);

static inline uint64_t eng_order_key(const struct eng_order *order,
                                     const struct eng_name *name)
{
    if (order->words > 1) {
        return eng_order_wide_key(order, name, 0);
    }
    uint64_t key = 0;
#pragma GCC unroll 5
    for (unsigned i = 0; i < ENG_NAME_WORDS; i++) {
        key |= (uint64_t)(name->word[i] - order->low.word[i]) << order->shift[i];
    }
    return key;
}

/* Return word 0 of the key of a record, whose words go into registers: a name put
 * together in memory and read at once would wait for the parts to arrive there. */
static inline uint64_t eng_order_key_of(const struct eng_order *order,
                                        const unsigned char *record,
                                        uint32_t record_bytes)
{
    if (order->words > 1) {
        struct eng_name name = eng_name_of(record, record_bytes);
        return eng_order_wide_key(order, &name, 0);
    }
    uint64_t key = 0;
#pragma GCC unroll 5
    for (unsigned i = 0; i < ENG_NAME_WORDS; i++) {
        uint32_t word = eng_name_word(record, record_bytes, i);
        key |= (uint64_t)(word - order->low.word[i]) << order->shift[i];
    }
    return key;
}

/* ---- the hash of an answer --------------------------------------------------------- */

/* Version 2 of the hash (proto/PROTOCOL.md, "The hash of an answer"): the sum, modulo
 * 2^128, of the XXH3-128 of each record and of the number of records. A sum does not ask
 * for an order, so each thread adds up the records at hand, and pages or parts of a scene
 * add up as well. Whether the order is canonical is for tests to check. */

/* Hashes of records, added up; 0 for none. */
__extension__ typedef unsigned __int128 eng_hash_sum;

/* Return the hash that `count` records, one behind the other, add. */
eng_hash_sum eng_hash_records(const void *records, uint64_t count, uint32_t record_bytes);

/* Set `hash` to that of all `count` records whose sum is known: hash[0] high, hash[1]
 * low. */
void eng_hash_end(eng_hash_sum sum, uint64_t count, uint64_t hash[2]);

/* Set `hash` to that of an answer in mode any: XXH3-128 of the verdict. */
void eng_hash_verdict(uint32_t verdict, uint64_t hash[2]);

#endif
