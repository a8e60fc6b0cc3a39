/* tests/unit/test_eng_batch.c - elementary tests of many pairs at once.
 *
 * Room:     engine (batch.h).
 * Does:     compare a batch with eng_solve, one pair at a time, for every instruction
 *           set: pairs in general position, planted contacts, small grids (coplanar and
 *           degenerate), any count.
 * Does not: know the truth: tests of eng_solve do.
 * Threads:  one.
 */
#include "eng_case.h"

#include <math.h>
#include <string.h>

#include "batch.h"

#define PAIR_MAX  ENG_CHUNK_MAX
#define TOLERANCE 1e-6

/* Pairs without a common point, so that each is a query of its own. */
struct chunk {
    enum eng_kind kind;
    uint32_t count;
    struct eng_point points[4 * PAIR_MAX];
    uint32_t quads[PAIR_MAX][4];
    struct eng_query queries[PAIR_MAX];
};

static struct chunk chunk;
static struct eng_batch batch;

static void random_query(struct kit_random *random, struct eng_query *query)
{
    unsigned family = kit_below(random, 4);
    if (family == 0) {
        kit_plant(random, query->kind, kit_below(random, 9), query);
        return;
    }
    for (int i = 0; i < 24; i++) {
        query->x[i / 12][i / 3 % 4][i % 3] = family == 1 ? kit_integer(random, 2)
                                             : family == 2
                                                 ? kit_between(random, -1, 1)
                                                 : 1e6 + kit_between(random, -1, 1);
    }
}

/* The points of all pairs in a random order. */
static void fill(struct kit_random *random, enum eng_kind kind, uint32_t count)
{
    static uint32_t order[4 * PAIR_MAX];
    chunk.kind = kind;
    chunk.count = count;
    for (uint32_t i = 0; i < 4 * count; i++) {
        uint32_t j = kit_below(random, i + 1);
        order[i] = order[j];
        order[j] = i;
    }
    for (uint32_t i = 0; i < count; i++) {
        chunk.queries[i].kind = kind;
        random_query(random, &chunk.queries[i]);
        for (uint32_t k = 0; k < 4; k++) {
            uint32_t at = order[4 * i + k];
            chunk.quads[i][k] = at;
            memcpy(chunk.points[at].x0, chunk.queries[i].x[0][k], 24);
            memcpy(chunk.points[at].x1, chunk.queries[i].x[1][k], 24);
            chunk.points[at].word0 = kit_u64(random); /* the owner's: any bits */
            chunk.points[at].word1 = UINT64_MAX;
        }
    }
}

static uint32_t test(const struct eng_kernels *kernels, double t_end)
{
    memset(batch.index, 0xff, sizeof batch.index);
    memset(batch.hits, 0xff, sizeof batch.hits);
    return eng_batch_test(kernels, chunk.kind, chunk.points,
                          (const uint32_t(*)[4])chunk.quads, chunk.count, TOLERANCE,
                          t_end, case_exact(), &batch);
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
static void batch__answers_are_those_of_single_queries(void **state)
{
    (void)state;
    for (int isa = 0; isa < ENG_ISA_COUNT; isa++) {
        const struct eng_kernels *kernels = eng_kernels_of((enum eng_isa)isa);
        struct kit_random random = {400};
        uint32_t hits = 0;
        for (uint32_t round = 0; kernels && round < 12; round++) {
            fill(&random, round % 2 ? ENG_EE : ENG_VF, PAIR_MAX);
            hits += check(kernels, round % 3 == 0 ? 0.5 : 1);
        }
        assert_true(!kernels || (hits > 2000 && hits < 10000));
    }
}

/* If it failed: pairs behind the last full vector would be lost, or made up. */
static void batch__any_count_is_tested(void **state)
{
    (void)state;
    for (int isa = 0; isa < ENG_ISA_COUNT; isa++) {
        const struct eng_kernels *kernels = eng_kernels_of((enum eng_isa)isa);
        struct kit_random random = {401};
        for (uint32_t count = 0; kernels && count < 40; count++) {
            fill(&random, count % 2 ? ENG_EE : ENG_VF, count);
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
static void batch__stops_after_exact_arithmetic(void **state)
{
    (void)state;
    struct kit_random random = {402};
    unsigned asked = 0;
    fill(&random, ENG_VF, PAIR_MAX);
    batch.owner = &asked;
    batch.should_stop = stop_now;
    test(eng_kernels(), 1);
    batch.should_stop = NULL;
    assert_int_equal(asked, 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(batch__answers_are_those_of_single_queries),
        cmocka_unit_test(batch__any_count_is_tested),
        cmocka_unit_test(batch__stops_after_exact_arithmetic),
    };
    int status = cmocka_run_group_tests_name("eng_batch", tests, NULL, NULL);
    eng_exact_deinit(case_exact());
    return status;
}
