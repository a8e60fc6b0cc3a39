/* test_eng_batch.c - elementary tests of many pairs at once. */
#include "batch.h"
#include "eng_case.h"
#include "kinds.h"
#include "solve.h"

#define PAIR_MAX  ENG_CHUNK_MAX
#define TOLERANCE 1e-6

/* Pairs without a common point, so that each is a query of its own. */
struct chunk {
    enum pccd_kind kind;
    uint32_t count;
    struct eng_point points[4 * PAIR_MAX];
    uint32_t quads[PAIR_MAX][4];
    struct eng_query queries[PAIR_MAX];
};

static struct chunk chunk;
static struct eng_batch batch;

static void random_query(struct prng *random, struct eng_query *query)
{
    unsigned family = prng_u32(random, 4);
    if (family == 0) {
        kit_plant(random, query->kind, prng_u32(random, 9), query);
        return;
    }
    for (int i = 0; i < 24; i++) {
        query->x[i / 12][i / 3 % 4][i % 3] = family == 1 ? prng_integer(random, 2)
                                             : family == 2
                                                 ? prng_between(random, -1, 1)
                                                 : 1e6 + prng_between(random, -1, 1);
    }
}

/* Features that pass through the origin, or through the same places as each other, with
 * coordinates as far apart as they may be: decisions take longest. */
static void slow_query(struct prng *random, struct eng_query *query)
{
    double pool[8];
    for (int i = 0; i < 8; i++) {
        pool[i] = ldexp(prng_between(random, -1, 1), i % 2 ? 59 : -1074 + 9 * i);
    }
    for (int i = 0; i < 24; i++) {
        query->x[i / 12][i / 3 % 4][i % 3] = pool[prng_u32(random, 8)];
    }
    for (int i = 0; i < 12; i++) {
        if (prng_u32(random, 2)) {
            query->x[1][i / 3][i % 3] = -query->x[0][i / 3][i % 3];
        }
    }
}

/* Features in a plane as they begin, which a line of that plane keeps apart. */
static void resting_query(struct prng *random, struct eng_query *query)
{
    const int split = query->kind == PCCD_VF ? 1 : 2;
    double angle = prng_between(random, 0, 6);
    double at[2] = {cos(angle), sin(angle)};
    for (int i = 0; i < 4; i++) {
        double along = prng_between(random, -1, 1);
        double across = prng_between(random, 0.002, 0.05) * (i < split ? -1 : 1);
        double *start = query->x[0][i];
        double *end = query->x[1][i];
        start[0] = along * at[0] - across * at[1];
        start[1] = along * at[1] + across * at[0];
        start[2] = 0;
        end[0] = start[0] + prng_between(random, -0.001, 0.001);
        end[1] = start[1] + prng_between(random, -0.001, 0.001);
        end[2] = prng_between(random, -1, 1);
    }
}

/* The points of all pairs in a random order. */
static void fill_with(void (*make)(struct prng *random, struct eng_query *query),
                      struct prng *random, enum pccd_kind kind, uint32_t count)
{
    static uint32_t order[4 * PAIR_MAX];
    chunk.kind = kind;
    chunk.count = count;
    for (uint32_t i = 0; i < 4 * count; i++) {
        uint32_t j = prng_u32(random, i + 1);
        order[i] = order[j];
        order[j] = i;
    }
    for (uint32_t i = 0; i < count; i++) {
        chunk.queries[i].kind = kind;
        make(random, &chunk.queries[i]);
        for (uint32_t k = 0; k < 4; k++) {
            uint32_t at = order[4 * i + k];
            chunk.quads[i][k] = at;
            memcpy(chunk.points[at].x0, chunk.queries[i].x[0][k], 24);
            memcpy(chunk.points[at].x1, chunk.queries[i].x[1][k], 24);
            chunk.points[at].word0 = prng_next(random); /* the owner's: any bits */
            chunk.points[at].word1 = UINT64_MAX;
        }
    }
}

static void fill(struct prng *random, enum pccd_kind kind, uint32_t count)
{
    fill_with(random_query, random, kind, count);
}

static uint32_t test(const struct eng_kernels *kernels, double t_end)
{
    memset(batch.index, 0xff, sizeof batch.index);
    memset(batch.hits, 0xff, sizeof batch.hits);
    struct eng_question question = ENG_QUESTION_DEFAULT;
    question.tolerance = TOLERANCE;
    const struct eng_pairs pairs = {.question = &question,
                                    .kind = chunk.kind,
                                    .count = chunk.count,
                                    .points = chunk.points,
                                    .quads = (const uint32_t(*)[4])chunk.quads,
                                    .t_end = t_end};
    batch.kernels = kernels;
    batch.contacts = case_exact();
    return eng_batch_test(&batch, &pairs);
}

static void assert_same_hit(const struct eng_hit *a, const struct eng_hit *b)
{
    assert_int_equal(a->flags, b->flags);
    assert_memory_equal(&a->toi, &b->toi, sizeof a->toi);
    assert_memory_equal(&a->toi_hi, &b->toi_hi, sizeof a->toi_hi);
    assert_memory_equal(a->param, b->param, sizeof a->param);
    assert_memory_equal(a->normal, b->normal, sizeof a->normal);
}

/* Everything that a batch says is what eng_solve says, and nothing is left out. */
static uint32_t check(const struct eng_kernels *kernels, double t_end)
{
    static const struct eng_hit *found[PAIR_MAX];
    uint32_t count = test(kernels, t_end);
    memset(found, 0, sizeof found);
    for (uint32_t i = 0; i < count; i++) {
        assert_in_range(batch.index[i], 0, chunk.count - 1);
        assert_null(found[batch.index[i]]);
        found[batch.index[i]] = &batch.hits[i];
    }
    assert_in_range(batch.survivors, count, chunk.count);
    for (uint32_t i = 0; i < chunk.count; i++) {
        struct eng_hit hit;
        bool expected =
            eng_solve(&chunk.queries[i], TOLERANCE, t_end, case_exact(), &hit);
        assert_int_equal(found[i] != NULL, expected);
        if (expected) {
            assert_same_hit(found[i], &hit);
        }
    }
    return count;
}

/* If it failed: the answer would depend on the method, on the processor, or on which
 * pairs happen to be tested together. */
CASE(batch__answers_are_those_of_single_queries)
{
    for (int isa = 0; isa < ENG_ISA_COUNT; isa++) {
        const struct eng_kernels *kernels = eng_kernels_of((enum eng_isa)isa);
        struct prng random = {400};
        uint32_t hits = 0;
        for (uint32_t round = 0; kernels && round < 12; round++) {
            fill(&random, round % 2 ? PCCD_EE : PCCD_VF, PAIR_MAX);
            hits += check(kernels, round % 3 == 0 ? 0.5 : 1);
        }
        assert_true(!kernels || (hits > 2000 && hits < 10000));
    }
}

/* If it failed: bodies that rest on one another would take a search for every two
 * features that lie side by side. */
CASE(batch__pairs_that_rest_side_by_side_take_no_search)
{
    for (int isa = 0; isa < ENG_ISA_COUNT; isa++) {
        const struct eng_kernels *kernels = eng_kernels_of((enum eng_isa)isa);
        struct prng random = {404};
        for (uint32_t round = 0; kernels && round < 4; round++) {
            fill_with(resting_query, &random, round % 2 ? PCCD_EE : PCCD_VF, PAIR_MAX);
            assert_int_equal(check(kernels, round < 2 ? 0.5 : 1), 0);
            assert_true(batch.survivors > PAIR_MAX / 8);
            assert_int_equal(batch.unsure_count, 0);
        }
    }
}

/* If it failed: a kind would be announced to users, and the first step would crash. */
CASE(batch__every_kind_has_its_row_in_every_table)
{
    for (int kind = 0; kind < PCCD_KIND_COUNT; kind++) {
        bool is_of_free = kind == PCCD_VE || kind == PCCD_VV; /* only at a distance */
        assert_true((eng_solvers[kind].search == NULL) == is_of_free);
        assert_in_range(common_kinds[kind].points[0], 1, 3);
        assert_in_range(common_kinds[kind].points[1], 1, 3);
        for (int isa = 0; isa < ENG_ISA_COUNT; isa++) {
            const struct eng_kernels *kernels = eng_kernels_of((enum eng_isa)isa);
            assert_true(!kernels || kernels->join_features[kind]);
        }
    }
}

/* If it failed: pairs behind the last full vector would be lost, or made up. */
CASE(batch__any_count_is_tested)
{
    for (int isa = 0; isa < ENG_ISA_COUNT; isa++) {
        const struct eng_kernels *kernels = eng_kernels_of((enum eng_isa)isa);
        struct prng random = {401};
        for (uint32_t count = 0; kernels && count < 40; count++) {
            fill(&random, count % 2 ? PCCD_EE : PCCD_VF, count);
            check(kernels, 1);
        }
    }
}

static bool stop_now(void *owner)
{
    ++*(unsigned *)owner;
    return true;
}

/* If it failed: a deadline would wait for a chunk full of exact arithmetic. */
CASE(batch__stops_after_exact_arithmetic)
{
    struct prng random = {402};
    unsigned asked = 0;
    fill(&random, PCCD_VF, PAIR_MAX);
    batch.owner = &asked;
    batch.should_stop = stop_now;
    test(eng_kernels(), 1);
    batch.should_stop = NULL;
    assert_int_equal(asked, 1);
}

struct looks {
    uint32_t made;
    uint32_t enough; /* this one and those after it ask for a stop */
};

static bool look(void *owner)
{
    struct looks *looks = owner;
    return ++looks->made >= looks->enough;
}

static uint32_t test_with_looks(struct looks *looks, uint32_t enough)
{
    *looks = (struct looks){0, enough};
    batch.owner = looks;
    batch.should_stop = look;
    uint32_t count = test(eng_kernels(), 1);
    batch.should_stop = NULL;
    return count;
}

/* If it failed: a deadline would wait for a decision, however long it takes; or a pair
 * that was given up would have an answer; or looking would change one. */
CASE(batch__stops_within_a_decision)
{
    static struct eng_hit hits[64];
    static uint32_t index[64];
    struct prng random = {403};
    struct looks looks;
    uint32_t within = 0; /* looks from inside a decision */
    for (uint32_t round = 0; round < 20; round++) {
        fill_with(slow_query, &random, round % 2 ? PCCD_EE : PCCD_VF, 64);
        uint32_t count = test(eng_kernels(), 1);
        memcpy(hits, batch.hits, count * sizeof *hits);
        memcpy(index, batch.index, count * sizeof *index);
        assert_int_equal(test_with_looks(&looks, UINT32_MAX), count);
        assert_memory_equal(batch.index, index, count * sizeof *index);
        uint32_t all = looks.made;
        within += all > batch.unsure_count ? all - batch.unsure_count : 0;
        for (uint32_t enough = 1; enough <= all; enough += 1 + all / 8) {
            uint32_t part = test_with_looks(&looks, enough);
            assert_int_equal(looks.made, enough);
            assert_in_range(part, 0, count);
            for (uint32_t i = 0; i < part; i++) {
                assert_int_equal(batch.index[i], index[i]);
                assert_same_hit(&batch.hits[i], &hits[i]);
            }
        }
        assert_int_equal(test(eng_kernels(), 1), count); /* nothing is left of it */
    }
    assert_true(within > 100);
}

CASES_WITH(NULL, case_end);
