/* tests/unit/test_eng_radix.c - stable radix sorts.
 *
 * Room:     engine (radix.h).
 * Does:     compare with qsort for keys that differ in all, few or no digits.
 * Does not: measure it.
 * Threads:  one.
 * Source:   daemon/engine/radix.h.
 */
#include "eng_kit.h"

#include <stdlib.h>
#include <string.h>

#include "radix.h"

#define ITEMS_MAX 3000u

static struct eng_radix_item items[ITEMS_MAX];
static struct eng_radix_item spare[ITEMS_MAX];
static struct eng_radix_item expected[ITEMS_MAX];

/* By key, then by arrival: what a stable sort yields. */
static int compare(const void *a, const void *b)
{
    const struct eng_radix_item *x = a;
    const struct eng_radix_item *y = b;
    if (x->hi != y->hi) {
        return x->hi < y->hi ? -1 : 1;
    }
    if (x->lo != y->lo) {
        return x->lo < y->lo ? -1 : 1;
    }
    return x->index < y->index ? -1 : x->index > y->index;
}

/* Sort `count` random items whose keys use only the bits of the masks. */
static void check(struct kit_random *random, size_t count, uint64_t mask_hi,
                  uint64_t mask_lo)
{
    for (size_t i = 0; i < count; i++) {
        items[i].hi = kit_u64(random) & mask_hi;
        items[i].lo = kit_u64(random) & mask_lo;
        items[i].index = i;
    }
    memcpy(expected, items, count * sizeof *items);
    qsort(expected, count, sizeof *expected, compare);
    const struct eng_radix_item *sorted = eng_radix_sort(items, spare, count);
    assert_true(sorted == items || sorted == spare);
    if (count > 0) {
        assert_memory_equal(sorted, expected, count * sizeof *sorted);
    }
}

/* If it failed: records or edges would come out of order. */
static void radix__random_keys_sort_as_with_qsort(void **state)
{
    (void)state;
    struct kit_random random = {3};
    for (size_t count = 2; count <= ITEMS_MAX; count += count / 2 + 1) {
        check(&random, count, UINT64_MAX, UINT64_MAX);
        check(&random, count, 0, UINT64_MAX);
        check(&random, count, UINT64_MAX, 0);
        check(&random, count, 0x8000000000000001u, 0x8000000000000001u);
    }
}

/* If it failed: a digit that differs in few keys would be taken for one that is equal. */
static void radix__each_single_digit_counts(void **state)
{
    (void)state;
    struct kit_random random = {4};
    for (unsigned digit = 0; digit < 8; digit++) {
        check(&random, 500, 0, (uint64_t)255 << (8 * digit));
        check(&random, 500, (uint64_t)255 << (8 * digit), 0);
        check(&random, 500, (uint64_t)1 << (8 * digit), (uint64_t)128 << (8 * digit));
    }
}

/* If it failed: the owner of an edge would not be its first triangle. */
static void radix__equal_keys_keep_their_order(void **state)
{
    (void)state;
    struct kit_random random = {5};
    check(&random, ITEMS_MAX, 0, 3);        /* few keys, long runs */
    check(&random, ITEMS_MAX, 1u << 20, 1); /* in digits far apart */
    check(&random, ITEMS_MAX, 0, 0);        /* all equal */
}

/* If it failed: a step with one contact, or with none, would read what is not there. */
static void radix__one_item_and_none_come_back(void **state)
{
    (void)state;
    struct kit_random random = {6};
    check(&random, 1, UINT64_MAX, UINT64_MAX);
    check(&random, 0, UINT64_MAX, UINT64_MAX);
}

static int compare_keys(const void *a, const void *b)
{
    const struct eng_radix_key *x = a;
    const struct eng_radix_key *y = b;
    if (x->key != y->key) {
        return x->key < y->key ? -1 : 1;
    }
    return x->index < y->index ? -1 : x->index > y->index;
}

static void check_keys(struct kit_random *random, size_t count, uint64_t mask)
{
    static struct eng_radix_key keys[ITEMS_MAX];
    static struct eng_radix_key room[ITEMS_MAX];
    static struct eng_radix_key sorted_keys[ITEMS_MAX];
    uint64_t common = kit_u64(random) & ~mask;
    for (size_t i = 0; i < count; i++) {
        keys[i] = (struct eng_radix_key){common | (kit_u64(random) & mask), i};
    }
    memcpy(sorted_keys, keys, count * sizeof *keys);
    qsort(sorted_keys, count, sizeof *sorted_keys, compare_keys);
    const struct eng_radix_key *sorted = eng_radix_sort_keys(keys, room, count);
    assert_true(sorted == keys || sorted == room);
    if (count > 0) {
        assert_memory_equal(sorted, sorted_keys, count * sizeof *sorted);
    }
}

/* If it failed: an answer would come out of order where its names differ in bits that
 * fill no whole number of digits. */
static void radix__short_keys_sort_for_any_bits_that_differ(void **state)
{
    (void)state;
    struct kit_random random = {7};
    const size_t counts[] = {0, 1, 2, 23, 24, 25, 26, 300, ITEMS_MAX};
    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++) {
        check_keys(&random, counts[i], 0);
        check_keys(&random, counts[i], UINT64_MAX);
        check_keys(&random, counts[i], 0x8000000000000001u);
        for (unsigned low = 0; low < 64; low += 3) {
            for (unsigned bits = 1; bits <= 64 - low; bits += 4) {
                check_keys(&random, counts[i] % 1000, (UINT64_MAX >> (64 - bits)) << low);
            }
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(radix__random_keys_sort_as_with_qsort),
        cmocka_unit_test(radix__each_single_digit_counts),
        cmocka_unit_test(radix__equal_keys_keep_their_order),
        cmocka_unit_test(radix__one_item_and_none_come_back),
        cmocka_unit_test(radix__short_keys_sort_for_any_bits_that_differ),
    };
    return cmocka_run_group_tests_name("eng_radix", tests, NULL, NULL);
}
