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

/* Two workers, one pool, one answer. */
struct lists {
    struct eng_pool pool;
    struct eng_found found[2];
    struct eng_records sorted;
    struct eng_sorter sorter;
    bool overflowed;
};

static int setup(void **state)
{
    struct lists *lists = calloc(1, sizeof *lists);
    if (!lists) {
        return -1;
    }
    eng_pool_init(&lists->pool);
    *state = lists;
    return 0;
}

static int teardown(void **state)
{
    struct lists *lists = *state;
    eng_pool_deinit(&lists->pool);
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

static void begin(struct lists *lists, uint32_t record_bytes, uint64_t limit)
{
    eng_pool_reset(&lists->pool, 2);
    eng_found_begin(&lists->found[0], &lists->pool, record_bytes, limit);
    eng_found_begin(&lists->found[1], &lists->pool, record_bytes, limit);
}

static int sort(struct lists *lists)
{
    struct eng_found *const both[2] = {&lists->found[0], &lists->found[1]};
    return eng_records_sort(&lists->sorter, both, 2, &lists->sorted, &lists->overflowed);
}

/* All records of both workers, in the order of their lists. */
static void *copy_found(const struct lists *lists)
{
    size_t bytes = lists->found[0].record_bytes;
    unsigned char *copy =
        malloc((lists->found[0].count + lists->found[1].count) * bytes + 1);
    assert_non_null(copy);
    unsigned char *to = copy;
    for (int i = 0; i < 2; i++) {
        for (const struct eng_block *block = lists->found[i].first; block;
             block = block->next) {
            memcpy(to, block->data, block->count * bytes);
            to += block->count * bytes;
        }
    }
    return copy;
}

static void add_contacts(struct lists *lists, struct kit_random *random, uint32_t count)
{
    begin(lists, sizeof(struct eng_contact), LIMIT);
    for (uint32_t i = 0; i < count; i++) {
        struct eng_pair name = random_name(random);
        struct eng_contact *contact = eng_found_add(&lists->found[i >= count / 2]);
        assert_non_null(contact);
        memset(contact, (int)i, sizeof *contact);
        contact->kind = name.kind;
        memcpy(&contact->object_a, &name.object_a, 4 * sizeof name.object_a);
        contact->reserved = i;
    }
    assert_int_equal(lists->found[0].count + lists->found[1].count, count);
    assert_false(lists->found[0].overflowed || lists->found[1].overflowed);
}

static void add_pairs(struct lists *lists, struct kit_random *random, uint32_t count)
{
    begin(lists, sizeof(struct eng_pair), LIMIT);
    for (uint32_t i = 0; i < count; i++) {
        struct eng_pair *pair = eng_found_add(&lists->found[kit_below(random, 2)]);
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
        add_contacts(lists, &random, count);
        size_t bytes = count * sizeof(struct eng_contact);
        struct eng_contact *expected = copy_found(lists);
        qsort(expected, count, sizeof *expected, compare_contacts);
        assert_int_equal(sort(lists), ENG_OK);
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
        add_pairs(lists, &random, count);
        size_t bytes = count * sizeof(struct eng_pair);
        struct eng_pair *expected = copy_found(lists);
        qsort(expected, count, sizeof *expected, compare_pairs);
        assert_int_equal(sort(lists), ENG_OK);
        assert_int_equal(lists->sorted.count, count);
        assert_memory_equal(lists->sorted.data, expected, bytes);
        free(expected);
    }
}

/* If it failed: a step without contacts would have an answer of the wrong form. */
static void result__nothing_sorts_to_nothing(void **state)
{
    struct lists *lists = *state;
    begin(lists, sizeof(struct eng_pair), LIMIT);
    assert_int_equal(sort(lists), ENG_OK);
    assert_int_equal(lists->sorted.count, 0);
    assert_int_equal(lists->sorted.record_bytes, sizeof(struct eng_pair));
    assert_false(lists->overflowed);
}

/* If it failed: a cut answer would look complete, or a full one cut. */
static void result__limit_is_kept_and_told(void **state)
{
    struct lists *lists = *state;
    struct eng_found *found = &lists->found[0];
    const uint64_t limits[] = {0, 1, 5, 1022, 1023, 1024, 3000};
    for (size_t i = 0; i < sizeof limits / sizeof *limits; i++) {
        begin(lists, sizeof(struct eng_contact), limits[i]);
        for (uint64_t k = 0; k < limits[i]; k++) {
            void *record = eng_found_add(found);
            assert_non_null(record);
            memset(record, 0, sizeof(struct eng_contact));
        }
        assert_false(found->overflowed);
        assert_null(eng_found_add(found));
        assert_true(found->overflowed);
        assert_null(eng_found_add(found));
        assert_int_equal(found->count, limits[i]);
        assert_int_equal(sort(lists), ENG_OK);
        assert_true(lists->overflowed);
        assert_int_equal(lists->sorted.count, limits[i]);
        begin(lists, sizeof(struct eng_pair), limits[i]);
        assert_false(found->overflowed); /* a new step begins afresh */
        assert_int_equal(found->count, 0);
    }
}

/* If it failed: two workers would keep twice what one may. */
static void result__limit_counts_all_workers_together(void **state)
{
    struct lists *lists = *state;
    begin(lists, sizeof(struct eng_contact), 100);
    for (int k = 0; k < 120; k++) {
        void *record = eng_found_add(&lists->found[k % 2]);
        assert_non_null(record);
        memset(record, 0, sizeof(struct eng_contact));
    }
    assert_int_equal(sort(lists), ENG_OK);
    assert_true(lists->overflowed);
    assert_int_equal(lists->sorted.count, 100);
}

/* If it failed: every step would allocate again. */
static void result__memory_is_used_again(void **state)
{
    struct lists *lists = *state;
    struct kit_random random = {82};
    add_contacts(lists, &random, 5000);
    assert_int_equal(sort(lists), ENG_OK);
    eng_pool_reset(&lists->pool, 2); /* what was spilled becomes the pool's own */
    uint64_t allocations = eng_alloc_count();
    for (int round = 0; round < 5; round++) {
        add_contacts(lists, &random, 5000);
        assert_int_equal(sort(lists), ENG_OK);
        add_pairs(lists, &random, 5000); /* the smaller record fits as well */
        assert_int_equal(sort(lists), ENG_OK);
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
        TEST(result__limit_counts_all_workers_together),
        TEST(result__memory_is_used_again),      TEST(result__hash_follows_the_content),
    };
    return cmocka_run_group_tests_name("eng_result", tests, NULL, NULL);
}
