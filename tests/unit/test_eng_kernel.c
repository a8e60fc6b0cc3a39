/* test_eng_kernel.c - the kernels of every instruction set. */
#include "eng_kit.h"
#include "kernel.h"

#define COUNT_MAX 67u /* more than eight vectors of the widest set */
#define LIMIT     1e18

/* The sets that this processor has besides the reference. */
static unsigned others(const struct eng_kernels *sets[ENG_ISA_COUNT])
{
    unsigned count = 0;
    for (int isa = ENG_ISA_SCALAR + 1; isa < ENG_ISA_COUNT; isa++) {
        const struct eng_kernels *kernels = eng_kernels_of((enum eng_isa)isa);
        if (kernels) {
            assert_int_equal(kernels->isa, isa);
            sets[count++] = kernels;
        }
    }
    return count;
}

/* If a name chose another set than it says, PCCD_CPU would measure the wrong kernels. */
CASE(kernels__are_chosen_by_name)
{
    static const char *const names[ENG_ISA_COUNT] = {"scalar", "sse2",   "sse4",
                                                     "avx2",   "avx512", "neon"};
    const struct eng_kernels *best = NULL;
    for (int isa = 0; isa < ENG_ISA_COUNT; isa++) {
        const struct eng_kernels *kernels = eng_kernels_of((enum eng_isa)isa);
        assert_ptr_equal(eng_kernels_named(names[isa]), kernels);
        best = kernels ? kernels : best;
    }
    assert_non_null(eng_kernels_of(ENG_ISA_SCALAR));
    assert_ptr_equal(eng_kernels_named(NULL), best);
    assert_ptr_equal(eng_kernels_named(""), best);
    assert_null(eng_kernels_named("avx"));
}

/* If a value out of range passed in some lane or in the rest behind the last vector, a
 * step would compute with it. */
CASE(kernels__find_a_bad_value_at_any_place)
{
    static const double bad[] = {NAN, INFINITY, -INFINITY, 1.0000000000000002e18, -2e18};
    double x[COUNT_MAX];
    for (int isa = 0; isa < ENG_ISA_COUNT; isa++) {
        const struct eng_kernels *kernels = eng_kernels_of((enum eng_isa)isa);
        for (uint32_t count = 0; kernels && count <= COUNT_MAX; count++) {
            for (uint32_t i = 0; i < count; i++) {
                x[i] = i % 2 ? LIMIT : -LIMIT;
            }
            assert_true(kernels->all_within(x, count, LIMIT));
            for (uint32_t i = 0; i < count; i++) {
                double good = x[i];
                x[i] = bad[i % 5];
                assert_false(kernels->all_within(x, count, LIMIT));
                x[i] = good;
            }
        }
    }
}

/* If widening differed between sets, a step's input would depend on the processor. */
CASE(kernels__widen_to_the_same_bits)
{
    const struct eng_kernels *sets[ENG_ISA_COUNT];
    const struct eng_kernels *scalar = eng_kernels_of(ENG_ISA_SCALAR);
    unsigned count = others(sets);
    float x[COUNT_MAX];
    double expected[COUNT_MAX];
    double out[COUNT_MAX];
    for (uint32_t i = 0; i < COUNT_MAX; i++) {
        x[i] = ldexpf(i % 2 ? -1.0f - (float)i / 64 : 1.0f, (int)(i * 4) - 149);
    }
    for (uint32_t n = 0; n <= COUNT_MAX; n++) {
        bool good = scalar->widen_within(expected, x, n, LIMIT);
        assert_int_equal(good, n <= 53); /* x[53] is beyond the limit */
        for (unsigned k = 0; k < count; k++) {
            memset(out, 0xff, sizeof out);
            assert_int_equal(sets[k]->widen_within(out, x, n, LIMIT), good);
            assert_memory_equal(out, expected, n * sizeof *out);
        }
    }
}

/* Pairs of every sort: apart along an axis for some time or always, near, touching. */
#define PAIR_COUNT 300u

struct pairs {
    struct eng_point points[4 * PAIR_COUNT];
    uint32_t quads[PAIR_COUNT][4];
};

static void make_pairs(struct prng *random, enum pccd_kind kind, struct pairs *pairs)
{
    for (uint32_t i = 0; i < PAIR_COUNT; i++) {
        struct eng_query query = {.kind = kind};
        double scale = ldexp(1, (int)prng_u32(random, 80) - 40);
        double offset[2] = {prng_between(random, -2, 2), prng_between(random, -2, 2)};
        unsigned family = prng_u32(random, 3);
        if (family == 0) {
            kit_plant(random, kind, prng_u32(random, 9), &query);
        }
        for (int k = 0; k < 24 && family > 0; k++) {
            bool second = k / 3 % 4 >= (kind == PCCD_VF ? 1 : 2);
            double x =
                family == 1 ? prng_integer(random, 2) : prng_between(random, -1, 1);
            query.x[k / 12][k / 3 % 4][k % 3] = x + (second ? offset[k / 12] : 0);
        }
        kit_place(&query, scale, 0);
        for (uint32_t k = 0; k < 4; k++) {
            struct eng_point *point = &pairs->points[4 * i + k];
            memcpy(point->x0, query.x[0][k], sizeof point->x0);
            memcpy(point->x1, query.x[1][k], sizeof point->x1);
            point->word0 = UINT64_MAX - prng_u32(random, 2); /* not a number, or 1 */
            point->word1 = prng_u32(random, 2);
            pairs->quads[i][k] = 4 * i + k;
        }
    }
}

/* If a set filtered otherwise, or looked at the words between the coordinates, survivors
 * would be counted otherwise on another processor, or contacts be lost. */
CASE(kernels__filter_the_same_pairs)
{
    static struct pairs pairs;
    const struct eng_kernels *sets[ENG_ISA_COUNT];
    const struct eng_kernels *scalar = eng_kernels_of(ENG_ISA_SCALAR);
    unsigned set_count = others(sets);
    struct prng random = {71};
    uint32_t apart = 0;
    uint32_t filtered = 0;
    for (uint32_t round = 0; round < 200; round++) {
        enum pccd_kind kind = round % 2 ? PCCD_EE : PCCD_VF;
        uint32_t count = round < 100 ? round : PAIR_COUNT;
        uint32_t expected[2][PAIR_COUNT];
        uint32_t kept[PAIR_COUNT];
        make_pairs(&random, kind, &pairs);
        const uint32_t(*quads)[4] = (const uint32_t(*)[4])pairs.quads;
        uint32_t n = scalar->reject_axes((struct eng_quads){kind, pairs.points, quads},
                                         count, expected[0]);
        uint32_t m = scalar->filter((struct eng_quads){kind, pairs.points, quads},
                                    expected[0], n, expected[1]);
        apart += count - n;
        filtered += n - m;
        for (unsigned k = 0; k < set_count; k++) {
            assert_int_equal(
                sets[k]->reject_axes((struct eng_quads){kind, pairs.points, quads}, count,
                                     kept),
                n);
            assert_memory_equal(kept, expected[0], n * sizeof *kept);
            assert_int_equal(
                sets[k]->filter((struct eng_quads){kind, pairs.points, quads}, kept, n,
                                kept),
                m);
            assert_memory_equal(kept, expected[1], m * sizeof *kept);
        }
    }
    assert_true(apart > 5000 && filtered > 5000);
}

static struct eng_bracketed bracket(const struct eng_kernels *kernels,
                                    enum pccd_kind kind, const struct pairs *pairs,
                                    uint32_t index[PAIR_COUNT],
                                    struct eng_hit hits[PAIR_COUNT],
                                    uint32_t unsure[PAIR_COUNT])
{
    struct eng_bracketed out = {.index = index, .hits = hits, .unsure = unsure};
    uint32_t list[PAIR_COUNT];
    for (uint32_t i = 0; i < PAIR_COUNT; i++) {
        list[i] = i;
    }
    memset(hits, 0, PAIR_COUNT * sizeof *hits);
    kernels->bracket(
        (struct eng_quads){kind, pairs->points, (const uint32_t(*)[4])pairs->quads}, list,
        PAIR_COUNT, 1e-6, 1, &out);
    return out;
}

/* If a set solved otherwise, the same scene would have other times, places and normals
 * on another processor, or a contact that is proved here would be searched for there. */
CASE(kernels__bracket_to_the_same_bits)
{
    static struct pairs pairs;
    static struct eng_hit expected_hits[PAIR_COUNT];
    static struct eng_hit hits[PAIR_COUNT];
    uint32_t expected_list[2][PAIR_COUNT];
    uint32_t list[2][PAIR_COUNT];
    const struct eng_kernels *sets[ENG_ISA_COUNT];
    unsigned set_count = others(sets);
    struct prng random = {72};
    uint32_t hit_count = 0;
    uint32_t unsure_count = 0;
    for (uint32_t round = 0; round < 200; round++) {
        enum pccd_kind kind = round % 2 ? PCCD_EE : PCCD_VF;
        make_pairs(&random, kind, &pairs);
        struct eng_bracketed expected =
            bracket(eng_kernels_of(ENG_ISA_SCALAR), kind, &pairs, expected_list[0],
                    expected_hits, expected_list[1]);
        hit_count += expected.hit_count;
        unsure_count += expected.unsure_count;
        /* As many pairs go through the stages together in every set, so the order is the
         * same too. */
        for (unsigned k = 0; k < set_count; k++) {
            struct eng_bracketed out =
                bracket(sets[k], kind, &pairs, list[0], hits, list[1]);
            assert_int_equal(out.hit_count, expected.hit_count);
            assert_int_equal(out.unsure_count, expected.unsure_count);
            assert_memory_equal(list[0], expected_list[0],
                                out.hit_count * sizeof list[0][0]);
            assert_memory_equal(list[1], expected_list[1],
                                out.unsure_count * sizeof list[1][0]);
            assert_memory_equal(hits, expected_hits, sizeof hits);
        }
    }
    assert_true(hit_count > 5000 && unsure_count > 5000 && unsure_count < 50000);
}

/* Edges beside each other, of which one turns and is parallel to the other at some time:
 * only then they are coplanar, and where they would cross is nowhere. If it failed: that
 * they miss would be found by searches. */
CASE(kernels__bracket_tells_that_parallel_edges_pass)
{
    static struct pairs pairs;
    static struct eng_hit hits[PAIR_COUNT];
    uint32_t list[2][PAIR_COUNT];
    struct prng random = {74};
    for (uint32_t i = 0; i < PAIR_COUNT; i++) {
        double along[3];
        for (int k = 0; k < 3; k++) {
            along[k] = prng_between(&random, 0.25, 1);
        }
        const double up[3] = {-along[1], along[0], 0};
        const double side[3] = {-along[2] * along[0], -along[2] * along[1],
                                along[0] * along[0] + along[1] * along[1]};
        double turn = prng_between(&random, 0.25, 0.75);
        for (int end = 0; end < 2; end++) {
            double x[4][3];
            for (int k = 0; k < 3; k++) {
                x[0][k] = end * 0.3;
                x[1][k] = x[0][k] + along[k];
                x[2][k] = x[0][k] + side[k];
                x[3][k] = x[2][k] + 1.5 * along[k] + (end - turn) * up[k];
            }
            for (uint32_t k = 0; k < 4; k++) {
                struct eng_point *point = &pairs.points[4 * i + k];
                memcpy(end ? point->x1 : point->x0, x[k], sizeof x[k]);
                pairs.quads[i][k] = 4 * i + k;
            }
        }
    }
    struct eng_bracketed out =
        bracket(eng_kernels_of(ENG_ISA_SCALAR), PCCD_EE, &pairs, list[0], hits, list[1]);
    assert_int_equal(out.hit_count, 0);
    assert_int_equal(out.unsure_count, 0);
}

/* Points anywhere, whose cubics have one, two or three roots, in any order with their
 * turns. If the bracket kernel decided fewer of them, answers would be right and steps
 * slow: a search takes ten times as long. */
CASE(kernels__bracket_decides_what_is_in_general_position)
{
    static struct pairs pairs;
    static struct eng_hit hits[PAIR_COUNT];
    uint32_t list[2][PAIR_COUNT];
    struct prng random = {73};
    uint32_t hit_count = 0;
    uint32_t unsure_count = 0;
    for (uint32_t round = 0; round < 100; round++) {
        enum pccd_kind kind = round % 2 ? PCCD_EE : PCCD_VF;
        for (uint32_t i = 0; i < 4 * PAIR_COUNT; i++) {
            for (int k = 0; k < 3; k++) {
                pairs.points[i].x0[k] = prng_between(&random, -1, 1);
                pairs.points[i].x1[k] = prng_between(&random, -1, 1);
            }
            pairs.quads[i / 4][i % 4] = i;
        }
        struct eng_bracketed out =
            bracket(eng_kernels_of(ENG_ISA_SCALAR), kind, &pairs, list[0], hits, list[1]);
        hit_count += out.hit_count;
        unsure_count += out.unsure_count;
    }
    assert_in_range(hit_count, 2000, 30000);
    assert_in_range(unsure_count, 0, 3);
}

/* If one set said otherwise than another, trees would depend on the processor, and where
 * it forgot equal places, lists of them would not be divided at all. */
CASE(kernels__say_which_items_come_before)
{
    struct prng random = {46};
    for (int isa = 0; isa < ENG_ISA_COUNT; isa++) {
        const struct eng_kernels *kernels = eng_kernels_of((enum eng_isa)isa);
        for (int round = 0; kernels && round < 300; round++) {
            struct eng_split_item items[64];
            int axis = round % 3;
            for (uint32_t i = 0; i < 64; i++) {
                for (int k = 0; k < 3; k++) {
                    items[i].centroid[k] = round % 2 ? (float)prng_between(&random, -1, 1)
                                                     : (float)prng_u32(&random, 3);
                }
                items[i].id = (i * 37 + (uint32_t)round) % 64 + (i % 2 ? 1u << 31 : 0);
            }
            struct eng_split_item pivot = items[round % 64];
            uint64_t bits = kernels->come_before(items, &pivot, axis);
            for (uint32_t i = 0; i < 64; i++) {
                float x = items[i].centroid[axis], of_pivot = pivot.centroid[axis];
                bool before = x < of_pivot || (x == of_pivot && items[i].id < pivot.id);
                assert_int_equal(bits >> i & 1, before);
            }
        }
    }
}
