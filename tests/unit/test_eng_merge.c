/* test_eng_merge.c - the records of a step: kept, and merged into one answer by any
 * number of threads. */
#include "eng_kit.h"

#include <pthread.h>

#include "memory.h"
#include "merge.h"
#include "record_hash.h"

#define THREADS_MAX 16u
#define NO_LIMIT    UINT32_MAX

struct fixture {
    struct eng_pool pool;
    struct eng_found found[THREADS_MAX];
    struct eng_records out;
    struct eng_merge merge;
    uint32_t threads;
    uint64_t limit;
    uint32_t record_bytes;
};

static int setup(void **state)
{
    struct fixture *f = calloc(1, sizeof *f);
    if (!f) {
        return -1;
    }
    eng_pool_init(&f->pool);
    eng_merge_init(&f->merge);
    f->limit = NO_LIMIT;
    *state = f;
    return 0;
}

static int teardown(void **state)
{
    struct fixture *f = *state;
    eng_pool_deinit(&f->pool);
    eng_records_deinit(&f->out);
    eng_merge_deinit(&f->merge);
    free(f);
    return 0;
}

/* ---- names ------------------------------------------------------------------------ */

enum pattern {
    RANDOM,  /* 46 bits, as those of a large scene */
    WIDE,    /* 129 bits, many alike in all but one word */
    EQUAL,   /* one name */
    SKEWED,  /* nearly all have one first feature */
    CROWDED, /* nearly all lie in a thousandth of the range */
    SORTED,
    REVERSE,
    PATTERNS
};

static struct eng_name name_of(enum pattern pattern, struct prng *random, uint32_t i,
                               uint32_t count)
{
    struct eng_name name = {{prng_u32(random, 2), 3 + prng_u32(random, 5),
                             prng_u32(random, 1u << 20), 3 + prng_u32(random, 5),
                             prng_u32(random, 1u << 20)}};
    switch (pattern) {
    case WIDE:
        for (unsigned k = 1; k < ENG_NAME_WORDS; k++) {
            name.word[k] = kit_word(random);
        }
        return name;
    case EQUAL:
        return (struct eng_name){{1, 7, 7, 7, 7}};
    case SKEWED:
        if (prng_u32(random, 100) > 0) {
            memcpy(name.word, (uint32_t[3]){0, 4, 777777}, 3 * sizeof *name.word);
        }
        return name;
    case CROWDED:
        if (prng_u32(random, 100) > 0) {
            name = (struct eng_name){
                {1, 5, prng_u32(random, 1000), 5, prng_u32(random, 1000)}};
        }
        return name;
    case SORTED:
        return (struct eng_name){{i >= count / 3, 5, i / 7, 5, i}};
    case REVERSE:
        i = count - 1 - i;
        return (struct eng_name){{i >= count / 3, 5, i / 7, 5, i}};
    default:
        return name;
    }
}

/* ---- records ---------------------------------------------------------------------- */

/* `count` records over the lists; `uneven`: nearly all in one. Contacts carry their order
 * of arrival over the lists one after the other, and counts to be taken. */
static void fill(struct fixture *f, struct prng *random, enum pattern pattern,
                 uint32_t count, bool uneven)
{
    eng_pool_reset(&f->pool, f->threads);
    for (uint32_t t = 0; t < f->threads; t++) {
        eng_found_begin(&f->found[t], &f->pool, f->record_bytes, f->limit);
    }
    for (uint32_t i = 0; i < count; i++) {
        uint32_t t = uneven && prng_u32(random, 50) > 0 ? f->threads / 2
                                                        : prng_u32(random, f->threads);
        struct eng_name name = name_of(pattern, random, i, count);
        struct pccd_pair pair;
        memcpy(&pair, &name, sizeof pair);
        struct pccd_contact *contact = eng_found_add(&f->found[t], &pair);
        assert_non_null(contact);
        if (f->record_bytes == sizeof *contact) {
            contact->flags = prng_u32(random, 4);
            contact->toi = prng_between(random, 0, 1);
            contact->toi_hi = (double)i;
            memset(contact->param, (int)i, sizeof contact->param);
            memset(contact->normal, (int)i, sizeof contact->normal);
        }
    }
    uint32_t arrival = 0;
    for (uint32_t t = 0; t < f->threads && f->record_bytes == sizeof(struct pccd_contact);
         t++) {
        for (struct eng_block *block = f->found[t].first; block; block = block->next) {
            struct pccd_contact *contacts = (void *)block->data;
            for (uint32_t i = 0; i < block->count; i++) {
                contacts[i].reserved = arrival++;
            }
        }
    }
}

static int compare_words(const uint32_t *a, const uint32_t *b, int count)
{
    for (int i = 0; i < count; i++) {
        if (a[i] != b[i]) {
            return a[i] < b[i] ? -1 : 1;
        }
    }
    return 0;
}

static int compare_pairs(const void *a, const void *b)
{
    return compare_words(a, b, 5);
}

static int compare_contacts(const void *a, const void *b)
{
    const struct pccd_contact *x = a;
    const struct pccd_contact *y = b;
    int order = compare_words(&x->kind, &y->kind, 1);
    order = order != 0 ? order : compare_words(&x->object_a, &y->object_a, 4);
    return order != 0 ? order : compare_words(&x->reserved, &y->reserved, 1);
}

/* All records, sorted by the C library. */
static void *expect(const struct fixture *f, uint32_t count)
{
    unsigned char *copy = test_room((size_t)count * f->record_bytes);
    unsigned char *to = copy;
    for (uint32_t t = 0; t < f->threads; t++) {
        for (const struct eng_block *block = f->found[t].first; block;
             block = block->next) {
            memcpy(to, block->data, (size_t)block->count * f->record_bytes);
            to += (size_t)block->count * f->record_bytes;
        }
    }
    qsort(copy, count, f->record_bytes,
          f->record_bytes == sizeof(struct pccd_pair) ? compare_pairs : compare_contacts);
    return copy;
}

/* ---- teams ------------------------------------------------------------------------ */

struct place {
    struct fixture *fixture;
    pthread_barrier_t *barrier;
    uint32_t thread;
};

static void *run_share(void *argument)
{
    struct place *place = argument;
    struct eng_merge *merge = &place->fixture->merge;
    eng_merge_survey(merge, place->fixture->threads, place->thread);
    pthread_barrier_wait(place->barrier);
    if (eng_merge_is_by_all(merge)) {
        eng_merge_fill_buckets(merge, place->thread);
        pthread_barrier_wait(place->barrier);
        eng_merge_finish(merge, place->thread);
    }
    return NULL;
}

/* The flag of the step. */
static atomic_bool is_cancelled;

/* As a step does it; `lists` may be more than the threads that turn up. */
static int merge(struct fixture *f, uint32_t lists, struct eng_counts *counts,
                 uint64_t hash[2])
{
    struct eng_found *found[THREADS_MAX];
    struct place places[THREADS_MAX];
    pthread_t threads[THREADS_MAX];
    pthread_barrier_t barrier;
    for (uint32_t t = 0; t < lists; t++) {
        found[t] = &f->found[t];
    }
    int status = eng_merge_begin(&f->merge, found, lists, &f->out);
    if (status != PCCD_OK) {
        return status;
    }
    eng_merge_set_cancel(&f->merge, &is_cancelled);
    if (f->threads > 1) {
        assert_int_equal(pthread_barrier_init(&barrier, NULL, f->threads), 0);
        for (uint32_t t = 0; t < f->threads; t++) {
            places[t] = (struct place){f, &barrier, t};
            assert_int_equal(pthread_create(&threads[t], NULL, run_share, &places[t]), 0);
        }
        for (uint32_t t = 0; t < f->threads; t++) {
            assert_int_equal(pthread_join(threads[t], NULL), 0);
        }
        pthread_barrier_destroy(&barrier);
    }
    status = eng_merge_end(&f->merge, counts);
    if (status == PCCD_OK) {
        eng_hash_end(counts->hash, f->out.count, hash);
    }
    return status;
}

static void check_counts(const struct fixture *f, const struct eng_counts *counts)
{
    struct eng_counts expected = {.toi_first = 2};
    for (uint64_t i = 0; i < f->out.count; i++) {
        const unsigned char *record = f->out.data + i * f->record_bytes;
        struct pccd_contact contact;
        expected.kind[PCCD_VF] += eng_name_of(record, f->record_bytes).word[0] == PCCD_VF;
        if (f->record_bytes == sizeof contact) {
            memcpy(&contact, record, sizeof contact);
            expected.possible += !(contact.flags & PCCD_PROVED);
            expected.initial += (contact.flags & PCCD_INITIAL) != 0;
            expected.toi_first =
                contact.toi < expected.toi_first ? contact.toi : expected.toi_first;
        }
    }
    assert_int_equal(counts->kind[PCCD_VF], expected.kind[PCCD_VF]);
    assert_int_equal(counts->possible, expected.possible);
    assert_int_equal(counts->initial, expected.initial);
    assert_true(counts->toi_first == expected.toi_first);
}

static void check(struct fixture *f, struct prng *random, enum pattern pattern,
                  uint32_t count, bool uneven)
{
    struct eng_counts counts;
    uint64_t hash[2];
    uint64_t whole[2];
    fill(f, random, pattern, count, uneven);
    unsigned char *expected = expect(f, count);
    assert_ok(merge(f, f->threads, &counts, hash));
    uint64_t kept = count < f->limit ? count : f->limit;
    assert_int_equal(f->merge.total, count);
    assert_int_equal(f->out.count, kept);
    assert_int_equal(f->out.record_bytes, f->record_bytes);
    if (kept > 0) {
        assert_memory_equal(f->out.data, expected, kept * f->record_bytes);
    }
    record_hash_2(expected, kept, f->record_bytes, whole);
    assert_memory_equal(hash, whole, sizeof whole);
    check_counts(f, &counts);
    free(expected);
}

static const uint32_t records[2] = {sizeof(struct pccd_pair),
                                    sizeof(struct pccd_contact)};

/* If it failed: answers would depend on the number of threads, or names of some
 * distribution would come out of order. */
CASE_WITH(merge__equals_qsort_for_any_names_and_threads, setup, teardown)
{
    struct fixture *f = *state;
    struct prng random = {85};
    const uint32_t counts[] = {0, 1, 2, 40, 2999, 3001, 20011};
    const uint32_t threads[] = {1, 2, 3, 4, 7, 16};
    for (size_t t = 0; t < sizeof threads / sizeof *threads; t++) {
        f->threads = threads[t];
        for (size_t i = 0; i < 2 * sizeof counts / sizeof *counts; i++) {
            f->record_bytes = records[i % 2];
            for (enum pattern pattern = RANDOM; pattern < PATTERNS; pattern++) {
                check(f, &random, pattern, counts[i / 2], false);
            }
        }
    }
}

/* If it failed: a thread that found nearly all, or nothing, would be left out. */
CASE_WITH(merge__takes_lists_of_uneven_length, setup, teardown)
{
    struct fixture *f = *state;
    struct prng random = {86};
    for (uint32_t threads = 2; threads <= 16; threads += 7) {
        f->threads = threads;
        for (uint32_t i = 0; i < 2 * PATTERNS; i++) {
            f->record_bytes = records[i % 2];
            check(f, &random, (enum pattern)(i / 2), 9000, true);
            check(f, &random, (enum pattern)(i / 2), 5, true);
        }
    }
}

/* If it failed: many records would be divided by sizes that do not hold them. */
CASE_WITH(merge__sorts_many_records, setup, teardown)
{
    struct fixture *f = *state;
    struct prng random = {87};
    for (uint32_t i = 0; i < 4; i++) {
        f->threads = i < 2 ? 1 : 4;
        f->record_bytes = records[i % 2];
        check(f, &random, i < 2 ? RANDOM : CROWDED, 300000, false);
    }
}

/* If it failed: a cut answer would hold other records than the first, or be hashed and
 * counted beyond its end. */
CASE_WITH(merge__limit_keeps_the_first_in_order, setup, teardown)
{
    struct fixture *f = *state;
    struct prng random = {88};
    const uint64_t limits[] = {1, 2, 17, 4000, 7999, 8000};
    for (size_t i = 0; i < 2 * sizeof limits / sizeof *limits; i++) {
        f->record_bytes = records[i % 2];
        for (f->threads = 1; f->threads <= 5; f->threads += 2) {
            /* The lists may hold more together than the answer, as in a step. */
            f->limit = NO_LIMIT;
            fill(f, &random, RANDOM, 8000, false);
            unsigned char *expected = expect(f, 8000);
            struct eng_counts counts;
            uint64_t hash[2];
            uint64_t whole[2];
            f->found[0].limit = limits[i / 2];
            assert_ok(merge(f, f->threads, &counts, hash));
            assert_int_equal(f->out.count, limits[i / 2]);
            assert_int_equal(f->merge.total, 8000);
            assert_memory_equal(f->out.data, expected, f->out.count * f->record_bytes);
            record_hash_2(expected, f->out.count, f->record_bytes, whole);
            assert_memory_equal(hash, whole, sizeof whole);
            check_counts(f, &counts);
            free(expected);
        }
    }
}

/* If it failed: a team smaller than asked for would wait for lists that nobody brings. */
CASE_WITH(merge__leaves_out_lists_without_a_thread, setup, teardown)
{
    struct fixture *f = *state;
    struct prng random = {89};
    struct eng_counts counts;
    uint64_t hash[2];
    f->threads = 3;
    f->record_bytes = sizeof(struct pccd_pair);
    fill(f, &random, RANDOM, 7000, false);
    unsigned char *expected = expect(f, 7000);
    assert_ok(merge(f, 8, &counts, hash));
    assert_int_equal(f->out.count, 7000);
    assert_memory_equal(f->out.data, expected, 7000 * sizeof(struct pccd_pair));
    free(expected);
}

/* If it failed: a step that is cancelled while it merges would go on for milliseconds, or
 * hand out places that nobody has filled; or one that was stopped before, with few
 * records, would answer nothing of what it has found. */
CASE_WITH(merge__is_given_up_when_cancelled_unless_it_is_short, setup, teardown)
{
    struct fixture *f = *state;
    struct prng random = {92};
    struct eng_counts counts;
    uint64_t hash[2];
    for (uint32_t i = 0; i < 6; i++) {
        f->record_bytes = records[i % 2];
        f->threads = 1 + i / 2 * 3;
        fill(f, &random, RANDOM, 20000, false);
        atomic_store(&is_cancelled, true);
        assert_ok(merge(f, f->threads, &counts, hash));
        assert_true(eng_merge_is_given_up(&f->merge));
        assert_int_equal(f->out.count, 0);
        check_counts(f, &counts);
        check(f, &random, RANDOM, 8000, false);
        assert_false(eng_merge_is_given_up(&f->merge));
        atomic_store(&is_cancelled, false);
        check(f, &random, RANDOM, 20000, false); /* and the next is whole again */
        assert_false(eng_merge_is_given_up(&f->merge));
    }
}

/* If it failed: a step would allocate again after the same step. */
CASE_WITH(merge__warm_allocates_nothing, setup, teardown)
{
    struct fixture *f = *state;
    struct prng random = {90};
    for (uint32_t i = 0; i < 12; i++) {
        uint64_t before = 0;
        f->record_bytes = records[i % 2];
        f->threads = 1 + 5 * (i % 3);
        for (int round = 0; round < 3; round++) {
            fill(f, &random, WIDE, 5000, false);
            before = round == 0 ? before : eng_alloc_count();
            struct eng_counts counts;
            uint64_t hash[2];
            assert_ok(merge(f, f->threads, &counts, hash));
            assert_true(round == 0 || eng_alloc_count() == before);
        }
    }
    assert_true(eng_merge_bytes(&f->merge) > 5000 * sizeof(struct eng_radix_key));
}

static void check_evenness(const struct fixture *f, uint32_t count)
{
    uint32_t largest = 0;
    for (uint32_t b = 0; b < f->merge.splitters.buckets; b++) {
        uint32_t size = 0;
        for (uint32_t t = 0; t < f->merge.threads; t++) {
            const uint32_t *begin = f->merge.shares[t].begin;
            size += begin[b + 1] - begin[b];
        }
        largest = size > largest ? size : largest;
    }
    assert_true(f->merge.splitters.buckets >= 64);
    assert_in_range(largest, 1, 4 * count / f->merge.splitters.buckets);
}

/* If it failed: where names crowd, one thread would have nearly all to sort. */
CASE_WITH(merge__buckets_are_even_for_any_names, setup, teardown)
{
    struct fixture *f = *state;
    struct prng random = {91};
    const enum pattern patterns[] = {RANDOM, CROWDED, SKEWED, SORTED, REVERSE};
    f->threads = 4;
    f->record_bytes = sizeof(struct pccd_pair);
    for (size_t i = 0; i < sizeof patterns / sizeof *patterns; i++) {
        check(f, &random, patterns[i], 100000, i % 2 == 1);
        check_evenness(f, 100000);
    }
}

/* If it failed: where one thread has found everything, one would also sort all of it, in
 * a piece that nothing can interrupt. */
CASE_WITH(merge__buckets_are_even_beside_a_list_of_nothing, setup, teardown)
{
    struct fixture *f = *state;
    struct prng random = {93};
    struct eng_counts counts;
    uint64_t hash[2];
    for (uint32_t i = 0; i < 2; i++) {
        f->record_bytes = records[i];
        f->threads = 1;
        fill(f, &random, SORTED, 100000, false);
        f->threads = 2;
        eng_found_begin(&f->found[1], &f->pool, f->record_bytes, f->limit);
        assert_ok(merge(f, f->threads, &counts, hash));
        assert_int_equal(f->out.count, 100000);
        check_evenness(f, 100000);
    }
}

/* ---- what two workers have found, by one thread ----------------------------------- */

static void begin(struct fixture *f, uint32_t record_bytes, uint64_t limit)
{
    f->threads = 1;
    f->record_bytes = record_bytes;
    eng_pool_reset(&f->pool, 2);
    for (int i = 0; i < 2; i++) {
        eng_found_begin(&f->found[i], &f->pool, record_bytes, limit);
    }
}

static void sort(struct fixture *f)
{
    struct eng_counts counts;
    uint64_t hash[2];
    assert_ok(merge(f, 2, &counts, hash));
    assert_true(f->out.count > 0 || counts.toi_first == 2);
}

/* If it failed: a step without contacts would have an answer of the wrong form. */
CASE_WITH(result__nothing_sorts_to_nothing, setup, teardown)
{
    struct fixture *f = *state;
    begin(f, sizeof(struct pccd_pair), NO_LIMIT);
    sort(f);
    assert_int_equal(f->out.count, 0);
    assert_int_equal(f->out.record_bytes, sizeof(struct pccd_pair));
    assert_int_equal(f->merge.total, 0);
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
    struct fixture *f = *state;
    struct eng_found *found = &f->found[0];
    const uint64_t limits[] = {0, 1, 5, 1022, 1023, 1024, 3000};
    for (size_t i = 0; i < sizeof limits / sizeof *limits; i++) {
        begin(f, sizeof(struct pccd_contact), limits[i]);
        for (uint64_t k = 0; k < limits[i]; k++) {
            add_empty(found);
        }
        assert_false(found->overflowed);
        assert_int_equal(found->count, limits[i]);
        sort(f);
        assert_int_equal(f->out.count, limits[i]);
        assert_int_equal(f->merge.total, limits[i]);
        eng_found_add(found, &no_name);
        sort(f);
        assert_int_equal(f->out.count, limits[i]);
        assert_true(found->overflowed || f->merge.total > limits[i]);
        begin(f, sizeof(struct pccd_pair), limits[i]);
        assert_false(found->overflowed); /* a new step begins afresh */
        assert_int_equal(found->count, 0);
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

/* Records beyond a limit, one by one or many at a time, against qsort. */
static void check_long_list(struct fixture *f, struct prng *random, uint64_t limit,
                            bool many_at_a_time)
{
    static struct pccd_pair all[20000];
    const uint32_t count = sizeof all / sizeof *all;
    struct eng_found *found = &f->found[0];
    begin(f, sizeof(struct pccd_pair), limit);
    for (uint32_t k = 0; k < count; k++) {
        struct eng_name name = name_of(WIDE, random, k, count);
        memcpy(&all[k], &name, sizeof all[k]);
        all[k] = many_at_a_time ? small_name(random) : all[k];
        if (!many_at_a_time) {
            eng_found_add(found, &all[k]);
            assert_in_range(found->count, 0, limit + limit / 4 + found->per_block);
        }
    }
    if (many_at_a_time) {
        add_many(found, all, count, random);
        assert_in_range(found->count, 0, limit + limit / 4 + found->per_block);
    }
    qsort(all, count, sizeof *all, compare_pairs);
    assert_true(found->overflowed == (limit < count));
    sort(f);
    assert_int_equal(f->out.count, limit);
    assert_memory_equal(f->out.data, all, limit * sizeof *all);
}

/* If it failed: a list would grow without a bound, or keep what came first instead of
 * what is first. */
CASE_WITH(result__long_list_keeps_the_first_in_order, setup, teardown)
{
    const uint64_t limits[] = {1, 700, 4000, 10000};
    struct prng random = {84};
    for (size_t i = 0; i < sizeof limits / sizeof *limits; i++) {
        check_long_list(*state, &random, limits[i], false);
    }
}

/* If it failed: what a chunk finds at once would be kept otherwise than what is found one
 * by one: lost, without a limit, or out of order. */
CASE_WITH(result__many_at_a_time_are_kept_as_one_by_one, setup, teardown)
{
    const uint64_t limits[] = {0, 1, 700, 4000, 10000, 20000};
    struct prng random = {85};
    for (size_t i = 0; i < sizeof limits / sizeof *limits; i++) {
        check_long_list(*state, &random, limits[i], true);
    }
}

/* If it failed: names of which a word does not hold the keys would lose bits of these. */
CASE_WITH(result__keys_of_several_words_are_not_kept, setup, teardown)
{
    struct fixture *f = *state;
    const struct eng_name_range range = {.high = {{1, 3, UINT32_MAX, 3, UINT32_MAX / 2}}};
    begin(f, sizeof(struct pccd_pair), NO_LIMIT);
    assert_false(eng_found_expect(&f->found[0], &range));
    assert_false(f->found[0].has_keys);
}

/* If it failed: two workers would keep twice what one may. */
CASE_WITH(result__limit_counts_all_workers_together, setup, teardown)
{
    struct fixture *f = *state;
    begin(f, sizeof(struct pccd_contact), 100);
    for (int k = 0; k < 120; k++) {
        add_empty(&f->found[k % 2]);
    }
    sort(f);
    assert_int_equal(f->merge.total, 120);
    assert_int_equal(f->out.count, 100);
}

/* If it failed: every step would allocate again. */
CASE_WITH(result__memory_is_used_again, setup, teardown)
{
    struct fixture *f = *state;
    struct prng random = {82};
    uint64_t allocations = 0;
    for (uint32_t i = 0; i < 14; i++) { /* contacts, and pairs, which are smaller */
        f->threads = 2;
        f->record_bytes = records[1 - i % 2];
        fill(f, &random, WIDE, 5000, false);
        f->threads = 1;
        sort(f);
        allocations = i < 4 ? eng_alloc_count() : allocations;
        assert_int_equal(eng_alloc_count(), allocations);
    }
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
    struct fixture *f = *state;
    enum { LENT = 3, TAKEN = 9 };
    static _Alignas(ENG_BLOCK_HEADER_BYTES) struct eng_block memory[LENT + 1];
    for (int round = 0; round < 3; round++) {
        eng_pool_reset(&f->pool, 1);
        eng_pool_lend(&f->pool, memory, sizeof memory - 1);
        for (int i = 0; i < TAKEN; i++) {
            struct eng_block *block = eng_pool_take(&f->pool);
            assert_non_null(block);
            assert_true(lies_in(block, memory, LENT + 1) == (i < LENT));
            assert_true(i >= LENT || block == &memory[i]);
            memset(block->data, i, sizeof block->data);
        }
    }
    eng_pool_reset(&f->pool, 1);
    /* Its own are as many as it took of these, with a quarter and two more. */
    assert_int_equal(eng_pool_bytes(&f->pool), 9 * sizeof *memory);
    eng_pool_lend(&f->pool, NULL, 0);
    assert_false(lies_in(eng_pool_take(&f->pool), memory, LENT + 1));
}
