/* tests/unit/test_eng_result.c - the records of a step: kept, sorted, hashed.
 *
 * Room:     engine (result.h).
 * Does:     canonical order for both record kinds, limits, hashes, memory reuse.
 * Does not: find contacts.
 * Threads:  one.
 * Source:   daemon/engine/result.h, step.h.
 */
#include "eng_kit.h"

#include <stdlib.h>
#include <string.h>

#include "memory.h"
#include "result.h"

#define LIMIT 100000u

struct lists {
    struct eng_records found;
    struct eng_records sorted;
    struct eng_sorter sorter;
};

static int setup(void **state)
{
    *state = calloc(1, sizeof(struct lists));
    return *state ? 0 : -1;
}

static int teardown(void **state)
{
    struct lists *lists = *state;
    eng_records_deinit(&lists->found);
    eng_records_deinit(&lists->sorted);
    eng_sorter_deinit(&lists->sorter);
    free(lists);
    return 0;
}

/* Names of any size, and often alike but for one word. */
static uint32_t random_word(struct kit_random *random)
{
    switch (kit_below(random, 4)) {
    case 0:
        return kit_below(random, 3);
    case 1:
        return UINT32_MAX - kit_below(random, 3); /* the high bit */
    case 2:
        return 0x80000000u;
    default:
        return (uint32_t)kit_u64(random);
    }
}

static struct eng_pair random_name(struct kit_random *random)
{
    return (struct eng_pair){kit_below(random, 2), random_word(random),
                             random_word(random), random_word(random),
                             random_word(random)};
}

static int compare_words(const uint32_t *a, const uint32_t *b)
{
    for (int i = 0; i < 4; i++) {
        if (a[i] != b[i]) {
            return a[i] < b[i] ? -1 : 1;
        }
    }
    return 0;
}

static int compare_pairs(const void *a, const void *b)
{
    const struct eng_pair *x = a;
    const struct eng_pair *y = b;
    return x->kind != y->kind ? (x->kind < y->kind ? -1 : 1)
                              : compare_words(&x->object_a, &y->object_a);
}

/* By name, then by arrival (kept in `reserved`). */
static int compare_contacts(const void *a, const void *b)
{
    const struct eng_contact *x = a;
    const struct eng_contact *y = b;
    int order = x->kind != y->kind ? (x->kind < y->kind ? -1 : 1)
                                   : compare_words(&x->object_a, &y->object_a);
    return order != 0 ? order : (x->reserved < y->reserved ? -1 : 1);
}

static void add_contacts(struct eng_records *records, struct kit_random *random,
                         uint32_t count)
{
    eng_records_begin(records, sizeof(struct eng_contact), LIMIT);
    for (uint32_t i = 0; i < count; i++) {
        struct eng_pair name = random_name(random);
        struct eng_contact *contact = eng_records_add(records);
        assert_non_null(contact);
        memset(contact, (int)i, sizeof *contact);
        contact->kind = name.kind;
        memcpy(&contact->object_a, &name.object_a, 4 * sizeof name.object_a);
        contact->reserved = i;
    }
    assert_int_equal(records->count, count);
    assert_false(records->overflowed);
}

static void add_pairs(struct eng_records *records, struct kit_random *random,
                      uint32_t count)
{
    eng_records_begin(records, sizeof(struct eng_pair), LIMIT);
    for (uint32_t i = 0; i < count; i++) {
        struct eng_pair *pair = eng_records_add(records);
        assert_non_null(pair);
        *pair = random_name(random);
    }
}

/* If it failed: the same contacts would come back in another order another time. */
static void result__contacts_sort_canonically(void **state)
{
    struct lists *lists = *state;
    struct kit_random random = {80};
    for (uint32_t count = 1; count < 6000; count = count * 2 + 1) {
        add_contacts(&lists->found, &random, count);
        size_t bytes = count * sizeof(struct eng_contact);
        struct eng_contact *expected = malloc(bytes);
        assert_non_null(expected);
        memcpy(expected, lists->found.data, bytes);
        qsort(expected, count, sizeof *expected, compare_contacts);
        assert_int_equal(eng_records_sort(&lists->sorter, &lists->found, &lists->sorted),
                         ENG_OK);
        assert_int_equal(lists->sorted.count, count);
        assert_int_equal(lists->sorted.record_bytes, sizeof(struct eng_contact));
        assert_memory_equal(lists->sorted.data, expected, bytes);
        free(expected);
    }
}

/* If it failed: candidate pairs would be sorted by the wrong words. */
static void result__pairs_sort_canonically(void **state)
{
    struct lists *lists = *state;
    struct kit_random random = {81};
    for (uint32_t count = 1; count < 6000; count = count * 2 + 1) {
        add_pairs(&lists->found, &random, count);
        size_t bytes = count * sizeof(struct eng_pair);
        struct eng_pair *expected = malloc(bytes);
        assert_non_null(expected);
        memcpy(expected, lists->found.data, bytes);
        qsort(expected, count, sizeof *expected, compare_pairs);
        assert_int_equal(eng_records_sort(&lists->sorter, &lists->found, &lists->sorted),
                         ENG_OK);
        assert_int_equal(lists->sorted.count, count);
        assert_memory_equal(lists->sorted.data, expected, bytes);
        free(expected);
    }
}

/* If it failed: a step without contacts would have an answer of the wrong form. */
static void result__nothing_sorts_to_nothing(void **state)
{
    struct lists *lists = *state;
    eng_records_begin(&lists->found, sizeof(struct eng_pair), LIMIT);
    assert_int_equal(eng_records_sort(&lists->sorter, &lists->found, &lists->sorted),
                     ENG_OK);
    assert_int_equal(lists->sorted.count, 0);
    assert_int_equal(lists->sorted.record_bytes, sizeof(struct eng_pair));
    assert_false(lists->sorted.overflowed);
}

/* If it failed: a cut answer would look complete, or a full one cut. */
static void result__limit_is_kept_and_told(void **state)
{
    struct lists *lists = *state;
    const uint64_t limits[] = {0, 1, 5, 1023, 1024, 1025, 3000};
    for (size_t i = 0; i < sizeof limits / sizeof *limits; i++) {
        eng_records_begin(&lists->found, sizeof(struct eng_contact), limits[i]);
        for (uint64_t k = 0; k < limits[i]; k++) {
            void *record = eng_records_add(&lists->found);
            assert_non_null(record);
            memset(record, 0, sizeof(struct eng_contact));
        }
        assert_false(lists->found.overflowed);
        assert_null(eng_records_add(&lists->found));
        assert_true(lists->found.overflowed);
        assert_null(eng_records_add(&lists->found));
        assert_int_equal(lists->found.count, limits[i]);
        assert_int_equal(eng_records_sort(&lists->sorter, &lists->found, &lists->sorted),
                         ENG_OK);
        assert_true(lists->sorted.overflowed);
        assert_int_equal(lists->sorted.count, limits[i]);
        eng_records_begin(&lists->found, sizeof(struct eng_pair), limits[i]);
        assert_false(lists->found.overflowed); /* a new step begins afresh */
        assert_int_equal(lists->found.count, 0);
    }
}

/* If it failed: every step would allocate again. */
static void result__memory_is_used_again(void **state)
{
    struct lists *lists = *state;
    struct kit_random random = {82};
    add_contacts(&lists->found, &random, 5000);
    assert_int_equal(eng_records_sort(&lists->sorter, &lists->found, &lists->sorted),
                     ENG_OK);
    uint64_t allocations = eng_alloc_count();
    for (int round = 0; round < 5; round++) {
        add_contacts(&lists->found, &random, 5000);
        assert_int_equal(eng_records_sort(&lists->sorter, &lists->found, &lists->sorted),
                         ENG_OK);
        add_pairs(&lists->found, &random, 5000); /* the smaller record fits as well */
        assert_int_equal(eng_records_sort(&lists->sorter, &lists->found, &lists->sorted),
                         ENG_OK);
    }
    assert_int_equal(eng_alloc_count(), allocations);
}

/* If it failed: two answers could not be compared by their hashes. */
static void result__hash_follows_the_content(void **state)
{
    (void)state;
    uint8_t a[300];
    uint8_t b[301];
    for (size_t i = 0; i < sizeof a; i++) {
        a[i] = (uint8_t)(i * 31);
    }
    memcpy(b + 1, a, sizeof a); /* elsewhere in memory, not aligned */
    uint64_t first[2];
    uint64_t second[2];
    eng_hash(a, sizeof a, first);
    eng_hash(b + 1, sizeof a, second);
    assert_memory_equal(first, second, sizeof first);
    for (size_t bit = 0; bit < 8 * sizeof a; bit++) {
        b[1 + bit / 8] ^= (uint8_t)(1u << bit % 8);
        eng_hash(b + 1, sizeof a, second);
        assert_memory_not_equal(first, second, sizeof first);
        b[1 + bit / 8] ^= (uint8_t)(1u << bit % 8);
    }
    eng_hash(a, 0, first);
    eng_hash(NULL, 0, second);
    assert_memory_equal(first, second, sizeof first);
    assert_true(first[0] == 0x99aa06d3014798d8u && first[1] == 0x6001c324468d497fu);
}

#define TEST(function) cmocka_unit_test_setup_teardown(function, setup, teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(result__contacts_sort_canonically), TEST(result__pairs_sort_canonically),
        TEST(result__nothing_sorts_to_nothing),  TEST(result__limit_is_kept_and_told),
        TEST(result__memory_is_used_again),      TEST(result__hash_follows_the_content),
    };
    return cmocka_run_group_tests_name("eng_result", tests, NULL, NULL);
}
