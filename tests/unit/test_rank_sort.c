/* test_rank_sort.c - numbers sorted with what is attached. */
#include "cases.h"
#include "prng.h"
#include "rank_sort.h"

#define KEYS 3000u

/* If it failed, ranks would number vertices in another order than one process, and find
 * other contacts, or none: some keys differ in few bits, which may be anywhere. */
CASE(rank_sort__sorts_and_keeps_the_order_of_equal_keys)
{
    static struct ranks_key keys[KEYS], other[KEYS], slow[KEYS];
    static const uint64_t masks[] = {
        0,          1,          0x7ff,           0x800,      0xfffff,    0x80000001ull,
        UINT64_MAX, 1ull << 63, 0xff00000000ull, 0xffffffff, 0xfff01ull, 3ull << 62 | 3};
    struct prng random = {prng_seed()};
    for (size_t m = 0; m < sizeof masks / sizeof *masks; m++) {
        for (uint32_t count = 0; count <= KEYS; count = count * 5 + 1) {
            uint64_t same = prng_next(&random) & ~masks[m];
            for (uint32_t i = 0; i < count; i++) {
                uint64_t key = same | (prng_next(&random) & masks[m]);
                uint32_t at = i;
                keys[i] = (struct ranks_key){key, i};
                for (; at > 0 && slow[at - 1].key > key; at--) {
                    slow[at] = slow[at - 1];
                }
                slow[at] = keys[i];
            }
            const struct ranks_key *sorted = ranks_sort(keys, other, count);
            assert_true(sorted == keys || sorted == other);
            for (uint32_t i = 0; i < count; i++) {
                assert_true(sorted[i].key == slow[i].key);
                assert_true(sorted[i].value == slow[i].value);
            }
        }
    }
}

/* If it failed: the same of what leaves name. */
CASE(rank_sort__sorts_words_by_their_upper_halves)
{
    static uint64_t words[KEYS], other[KEYS];
    static struct ranks_key keys[KEYS], more[KEYS];
    static const uint32_t masks[] = {0,       1,           0x7ff,     0x800,
                                     0xfffff, 0x80000001u, UINT32_MAX};
    struct prng random = {prng_seed()};
    for (size_t m = 0; m < sizeof masks / sizeof *masks; m++) {
        for (uint32_t count = 0; count <= KEYS; count = count * 5 + 1) {
            uint32_t same = (uint32_t)prng_next(&random) & ~masks[m];
            for (uint32_t i = 0; i < count; i++) {
                uint32_t key = same | ((uint32_t)prng_next(&random) & masks[m]);
                keys[i] = (struct ranks_key){key, (uint32_t)prng_next(&random)};
                words[i] = (uint64_t)key << 32 | keys[i].value;
            }
            const uint64_t *sorted = ranks_sort_words(words, other, count);
            const struct ranks_key *slow = ranks_sort(keys, more, count);
            for (uint32_t i = 0; i < count; i++) {
                assert_true(sorted[i] == (slow[i].key << 32 | slow[i].value));
            }
        }
    }
}

/* If it failed, a rank would take one vertex for another that came before. */
CASE(recent__knows_numbers_or_forgets_them)
{
    static struct ranks_recent recent;
    struct prng random = {prng_seed()};
    uint32_t known = 0;
    ranks_recent_begin(&recent);
    for (uint32_t i = 0; i < 100000; i++) {
        uint32_t number = i / 100 + (uint32_t)(prng_next(&random) % 3000);
        bool is_known;
        uint32_t *value = ranks_recent_value(&recent, number, &is_known);
        assert_true(!is_known || *value == number * 3);
        known += is_known;
        *value = number * 3;
    }
    assert_true(known > 10000);
}
