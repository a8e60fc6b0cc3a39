/* test_eng_result.c - the records of a step: kept, merged by one thread. */
#include "eng_kit.h"
#include "memory.h"
#include "merge.h"

#define LIMIT 100000u

/* Two workers, one pool, one answer. */
struct lists {
    struct eng_pool pool;
    struct eng_found found[2];
    struct eng_records sorted;
    struct eng_merge merge;
    struct eng_counts counts;
};

static int setup(void **state)
{
    struct lists *lists = calloc(1, sizeof *lists);
    if (!lists) {
        return -1;
    }
    eng_pool_init(&lists->pool);
    eng_merge_init(&lists->merge);
    *state = lists;
    return 0;
}

static int teardown(void **state)
{
    struct lists *lists = *state;
    eng_pool_deinit(&lists->pool);
    eng_records_deinit(&lists->sorted);
    eng_merge_deinit(&lists->merge);
    free(lists);
    return 0;
}

/* Names of any size, and often alike but for one word. */
static struct pccd_pair random_name(struct prng *random)
{
    return (struct pccd_pair){prng_u32(random, 2), kit_word(random), kit_word(random),
                              kit_word(random), kit_word(random)};
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
    const struct pccd_pair *x = a;
    const struct pccd_pair *y = b;
    return x->kind != y->kind ? (x->kind < y->kind ? -1 : 1)
                              : compare_words(&x->object_a, &y->object_a);
}

/* By name, then by arrival (kept in `reserved`). */
static int compare_contacts(const void *a, const void *b)
{
    const struct pccd_contact *x = a;
    const struct pccd_contact *y = b;
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
    int status = eng_merge_begin(&lists->merge, both, 2, &lists->sorted);
    return status == PCCD_OK ? eng_merge_end(&lists->merge, &lists->counts) : status;
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

static void add_contacts(struct lists *lists, struct prng *random, uint32_t count)
{
    begin(lists, sizeof(struct pccd_contact), LIMIT);
    for (uint32_t i = 0; i < count; i++) {
        struct pccd_pair name = random_name(random);
        struct pccd_contact *contact =
            eng_found_add(&lists->found[i >= count / 2], &name);
        assert_non_null(contact);
        memset(&contact->toi, (int)i,
               sizeof *contact - offsetof(struct pccd_contact, toi));
        contact->flags = i & 3;
        contact->reserved = i;
    }
    assert_int_equal(lists->found[0].count + lists->found[1].count, count);
    assert_false(lists->found[0].overflowed || lists->found[1].overflowed);
}

static void add_pairs(struct lists *lists, struct prng *random, uint32_t count)
{
    begin(lists, sizeof(struct pccd_pair), LIMIT);
    for (uint32_t i = 0; i < count; i++) {
        struct pccd_pair name = random_name(random);
        assert_non_null(eng_found_add(&lists->found[prng_u32(random, 2)], &name));
    }
}

/* Sort lists that `add` fills, and compare with qsort. */
static void check_sorting(struct lists *lists, uint64_t seed, size_t record_bytes,
                          void (*add)(struct lists *, struct prng *, uint32_t),
                          int (*compare)(const void *, const void *))
{
    struct prng random = {seed};
    for (uint32_t count = 1; count < 6000; count = count * 2 + 1) {
        add(lists, &random, count);
        void *expected = copy_found(lists);
        qsort(expected, count, record_bytes, compare);
        assert_ok(sort(lists));
        assert_int_equal(lists->sorted.count, count);
        assert_int_equal(lists->sorted.record_bytes, record_bytes);
        assert_memory_equal(lists->sorted.data, expected, count * record_bytes);
        free(expected);
    }
}

/* If it failed: the same contacts would come back in another order another time. */
CASE_WITH(result__contacts_sort_canonically, setup, teardown)
{
    check_sorting(*state, 80, sizeof(struct pccd_contact), add_contacts,
                  compare_contacts);
}

/* If it failed: candidate pairs would be sorted by the wrong words. */
CASE_WITH(result__pairs_sort_canonically, setup, teardown)
{
    check_sorting(*state, 81, sizeof(struct pccd_pair), add_pairs, compare_pairs);
}

/* If it failed: a step without contacts would have an answer of the wrong form. */
CASE_WITH(result__nothing_sorts_to_nothing, setup, teardown)
{
    struct lists *lists = *state;
    begin(lists, sizeof(struct pccd_pair), LIMIT);
    assert_ok(sort(lists));
    assert_int_equal(lists->sorted.count, 0);
    assert_int_equal(lists->sorted.record_bytes, sizeof(struct pccd_pair));
    assert_int_equal(lists->merge.total, 0);
    assert_true(lists->counts.toi_first == 2);
}

static const struct pccd_pair no_name = {0, 0, 0, 0, 0};

static void add_empty(struct eng_found *found)
{
    unsigned char *record = eng_found_add(found, &no_name);
    assert_non_null(record);
    memset(record, 0, sizeof(struct pccd_contact));
}

/* If it failed: a cut answer would look complete, or a full one cut. */
CASE_WITH(result__limit_is_kept_and_told, setup, teardown)
{
    struct lists *lists = *state;
    struct eng_found *found = &lists->found[0];
    const uint64_t limits[] = {0, 1, 5, 1022, 1023, 1024, 3000};
    for (size_t i = 0; i < sizeof limits / sizeof *limits; i++) {
        begin(lists, sizeof(struct pccd_contact), limits[i]);
        for (uint64_t k = 0; k < limits[i]; k++) {
            add_empty(found);
        }
        assert_false(found->overflowed);
        assert_int_equal(found->count, limits[i]);
        assert_ok(sort(lists));
        assert_int_equal(lists->sorted.count, limits[i]);
        assert_int_equal(lists->merge.total, limits[i]);
        eng_found_add(found, &no_name);
        assert_ok(sort(lists));
        assert_int_equal(lists->sorted.count, limits[i]);
        assert_true(found->overflowed || lists->merge.total > limits[i]);
        begin(lists, sizeof(struct pccd_pair), limits[i]);
        assert_false(found->overflowed); /* a new step begins afresh */
        assert_int_equal(found->count, 0);
    }
}

/* If it failed: a list would grow without a bound, or keep what came first instead of
 * what is first. */
CASE_WITH(result__long_list_keeps_the_first_in_order, setup, teardown)
{
    struct lists *lists = *state;
    struct prng random = {84};
    const uint64_t limits[] = {1, 700, 4000, 10000};
    static struct pccd_pair all[20000];
    for (size_t i = 0; i < sizeof limits / sizeof *limits; i++) {
        begin(lists, sizeof(struct pccd_pair), limits[i]);
        struct eng_found *found = &lists->found[0];
        for (size_t k = 0; k < sizeof all / sizeof *all; k++) {
            all[k] = random_name(&random);
            eng_found_add(found, &all[k]);
            assert_in_range(found->count, 0,
                            limits[i] + limits[i] / 4 + found->per_block);
        }
        qsort(all, sizeof all / sizeof *all, sizeof *all, compare_pairs);
        assert_true(found->overflowed);
        assert_ok(sort(lists));
        assert_int_equal(lists->sorted.count, limits[i]);
        assert_memory_equal(lists->sorted.data, all, limits[i] * sizeof *all);
    }
}

/* Names whose keys are one word. */
#define OBJECT_MOST  3u
#define FEATURE_MOST 0xfffffu

static struct pccd_pair small_name(struct prng *random)
{
    return (struct pccd_pair){prng_u32(random, 2), prng_u32(random, OBJECT_MOST + 1),
                              prng_u32(random, FEATURE_MOST + 1),
                              prng_u32(random, OBJECT_MOST + 1),
                              prng_u32(random, FEATURE_MOST + 1)};
}

/* Records all[count], as many at a time as a random number says. */
static void add_many(struct eng_found *found, const struct pccd_pair *all, uint32_t count,
                     struct prng *random)
{
    const struct eng_name_range range = {
        .high = {{1, OBJECT_MOST, FEATURE_MOST, OBJECT_MOST, FEATURE_MOST}}};
    assert_true(eng_found_expect(found, &range));
    for (uint32_t k = 0; k < count;) {
        void *slots;
        uint64_t *keys;
        uint32_t wanted = 1 + prng_u32(random, 700);
        wanted = wanted < count - k ? wanted : count - k;
        uint32_t n = eng_found_open(found, wanted, &slots, &keys);
        assert_in_range(n, 0, wanted);
        if (n == 0) {
            eng_found_add(found, &all[k++]);
            continue;
        }
        n = prng_u32(random, 2) ? n : 1 + prng_u32(random, n);
        memcpy(slots, &all[k], n * sizeof *all);
        for (uint32_t i = 0; i < n; i++) {
            struct eng_name name;
            memcpy(&name, &all[k + i], sizeof name);
            keys[i] = eng_order_key(&found->order, &name);
        }
        eng_found_close(found, n);
        k += n;
    }
}

/* If it failed: what a chunk finds at once would be kept otherwise than what is found one
 * by one: lost, without a limit, or out of order. */
CASE_WITH(result__many_at_a_time_are_kept_as_one_by_one, setup, teardown)
{
    struct lists *lists = *state;
    struct prng random = {85};
    const uint64_t limits[] = {0, 1, 700, 4000, 10000, 20000};
    static struct pccd_pair all[20000];
    const uint32_t count = sizeof all / sizeof *all;
    for (size_t i = 0; i < sizeof limits / sizeof *limits; i++) {
        begin(lists, sizeof(struct pccd_pair), limits[i]);
        for (uint32_t k = 0; k < count; k++) {
            all[k] = small_name(&random);
        }
        add_many(&lists->found[0], all, count, &random);
        qsort(all, count, sizeof *all, compare_pairs);
        assert_true(lists->found[0].overflowed == (limits[i] < count));
        assert_in_range(lists->found[0].count, 0,
                        limits[i] + limits[i] / 4 + lists->found[0].per_block);
        assert_ok(sort(lists));
        assert_int_equal(lists->sorted.count, limits[i]);
        assert_memory_equal(lists->sorted.data, all, limits[i] * sizeof *all);
    }
}

/* If it failed: names of which a word does not hold the keys would lose bits of these. */
CASE_WITH(result__keys_of_several_words_are_not_kept, setup, teardown)
{
    struct lists *lists = *state;
    const struct eng_name_range range = {.high = {{1, 3, UINT32_MAX, 3, UINT32_MAX / 2}}};
    begin(lists, sizeof(struct pccd_pair), LIMIT);
    assert_false(eng_found_expect(&lists->found[0], &range));
    assert_false(lists->found[0].has_keys);
}

/* If it failed: two workers would keep twice what one may. */
CASE_WITH(result__limit_counts_all_workers_together, setup, teardown)
{
    struct lists *lists = *state;
    begin(lists, sizeof(struct pccd_contact), 100);
    for (int k = 0; k < 120; k++) {
        add_empty(&lists->found[k % 2]);
    }
    assert_ok(sort(lists));
    assert_int_equal(lists->merge.total, 120);
    assert_int_equal(lists->sorted.count, 100);
}

/* If it failed: every step would allocate again. */
CASE_WITH(result__memory_is_used_again, setup, teardown)
{
    struct lists *lists = *state;
    struct prng random = {82};
    add_contacts(lists, &random, 5000);
    assert_ok(sort(lists));
    eng_pool_reset(&lists->pool, 2); /* what was spilled becomes the pool's own */
    add_pairs(lists, &random, 5000); /* of two lists they take more scratch */
    assert_ok(sort(lists));
    uint64_t allocations = eng_alloc_count();
    for (int round = 0; round < 5; round++) {
        add_contacts(lists, &random, 5000);
        assert_ok(sort(lists));
        add_pairs(lists, &random, 5000); /* the smaller record fits as well */
        assert_ok(sort(lists));
    }
    assert_int_equal(eng_alloc_count(), allocations);
}

static bool lies_in(const struct eng_block *block, const struct eng_block *memory,
                    uint32_t count)
{
    return block >= memory && block < memory + count;
}

/* If it failed: a step would take memory beside what it was lent, or go on to use that
 * when it is somebody else's again. */
CASE_WITH(result__lent_memory_is_taken_first, setup, teardown)
{
    struct lists *lists = *state;
    enum { LENT = 3, TAKEN = 9 };
    static _Alignas(ENG_BLOCK_HEADER_BYTES) struct eng_block memory[LENT + 1];
    for (int round = 0; round < 3; round++) {
        eng_pool_reset(&lists->pool, 1);
        eng_pool_lend(&lists->pool, memory, sizeof memory - 1);
        for (int i = 0; i < TAKEN; i++) {
            struct eng_block *block = eng_pool_take(&lists->pool);
            assert_non_null(block);
            assert_true(lies_in(block, memory, LENT + 1) == (i < LENT));
            assert_true(i >= LENT || block == &memory[i]);
            memset(block->data, i, sizeof block->data);
        }
    }
    eng_pool_reset(&lists->pool, 1);
    /* Its own are as many as it took of these, with a quarter and two more. */
    assert_int_equal(eng_pool_bytes(&lists->pool), 9 * sizeof *memory);
    eng_pool_lend(&lists->pool, NULL, 0);
    assert_false(lies_in(eng_pool_take(&lists->pool), memory, LENT + 1));
}
