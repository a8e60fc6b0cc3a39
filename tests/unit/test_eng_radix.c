/* test_eng_radix.c - a stable radix sort. */
#include "eng_kit.h"
#include "sort.h"

#define ITEMS_MAX 3000u

static int compare(const void *a, const void *b)
{
    const struct eng_radix_key *x = a;
    const struct eng_radix_key *y = b;
    if (x->key != y->key) {
        return x->key < y->key ? -1 : 1;
    }
    return x->index < y->index ? -1 : x->index > y->index;
}

static void check(struct prng *random, size_t count, uint64_t mask)
{
    static struct eng_radix_key keys[ITEMS_MAX];
    static struct eng_radix_key room[ITEMS_MAX];
    static struct eng_radix_key sorted_keys[ITEMS_MAX];
    uint64_t common = prng_next(random) & ~mask;
    for (size_t i = 0; i < count; i++) {
        keys[i] = (struct eng_radix_key){common | (prng_next(random) & mask), i};
    }
    memcpy(sorted_keys, keys, count * sizeof *keys);
    qsort(sorted_keys, count, sizeof *sorted_keys, compare);
    const struct eng_radix_key *sorted = eng_radix_sort(keys, room, count);
    assert_true(sorted == keys || sorted == room);
    if (count > 0) {
        assert_memory_equal(sorted, sorted_keys, count * sizeof *sorted);
    }
}

/* If it failed: an answer would come out of order where its names differ in bits that
 * fill no whole number of digits. */
CASE(radix__keys_sort_for_any_bits_that_differ)
{
    struct prng random = {7};
    const size_t counts[] = {0, 1, 2, 23, 24, 25, 26, 300, ITEMS_MAX};
    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++) {
        check(&random, counts[i], 0);
        check(&random, counts[i], UINT64_MAX);
        check(&random, counts[i], 0x8000000000000001u);
        for (unsigned low = 0; low < 64; low += 3) {
            for (unsigned bits = 1; bits <= 64 - low; bits += 4) {
                check(&random, counts[i] % 1000, (UINT64_MAX >> (64 - bits)) << low);
            }
        }
    }
}

/* If it failed: an answer of threads would depend on which of them had found it. */
CASE(radix__equal_keys_keep_their_order)
{
    struct prng random = {5};
    check(&random, ITEMS_MAX, 3);                     /* few keys, long runs */
    check(&random, ITEMS_MAX, (uint64_t)1 << 52 | 1); /* in digits far apart */
}
