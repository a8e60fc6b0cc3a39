/* test_eng_sieve.c - certain rejections from points on a grid.
 *
 * Source: daemon/engine/kernel/, BOUNDS.md.
 */
#include "eng_case.h"
#include "kernel.h"

#define PAIR_MAX  203u /* more than twelve vectors of the widest set */
#define TOLERANCE 1e-6

/* Pairs, each on a grid of its own: only marks of one pair are compared. */
struct ground {
    enum pccd_kind kind;
    struct eng_query queries[PAIR_MAX];
    struct eng_point points[4 * PAIR_MAX];
    struct eng_mark marks[4 * PAIR_MAX];
    uint32_t corner[4][PAIR_MAX];
    uint32_t a[PAIR_MAX + ENG_SIEVE_SPARE];
    uint32_t b[PAIR_MAX + ENG_SIEVE_SPARE];
};

static struct ground ground;

static void random_query(struct prng *random, struct eng_query *query)
{
    unsigned family = prng_u32(random, 4);
    if (family == 0) {
        kit_plant(random, query->kind, prng_u32(random, 9), query);
        return;
    }
    for (int i = 0; i < 24; i++) {
        double *x = &query->x[i / 12][i / 3 % 4][i % 3];
        *x = family == 1 ? prng_integer(random, 2) : prng_between(random, -1, 1);
        /* Features that move together, apart by about their size or far less. */
        *x += family == 3 && i / 3 % 4 == 0 && i % 3 == 2 ? ldexp(1, -(i % 20)) : 0;
        *x += family > 1 && i >= 12 ? 8 * query->x[0][0][i % 3] : 0;
    }
}

/* A grid that reaches as far as the pair, or up to 2^`coarse_max` times. */
static struct eng_grid grid_of(struct prng *random, const struct eng_query *query,
                               uint32_t coarse_max)
{
    struct eng_grid grid;
    double far = 0;
    int exponent;
    for (int k = 0; k < 3; k++) {
        grid.origin[k] = query->x[0][0][k] + prng_between(random, -1, 1);
        for (int i = 0; i < 8; i++) {
            far = fmax(far, fabs(query->x[i / 4][i % 4][k] - grid.origin[k]));
        }
    }
    frexp(far * 1.001, &exponent);
    grid.scale = ldexp(1, 30 - exponent - (int)prng_u32(random, coarse_max + 1));
    return grid;
}

static void put(struct prng *random, enum pccd_kind kind, uint32_t coarse_max)
{
    ground.kind = kind;
    for (uint32_t i = 0; i < PAIR_MAX; i++) {
        struct eng_query *query = &ground.queries[i];
        query->kind = kind;
        random_query(random, query);
        for (uint32_t k = 0; k < 4; k++) {
            struct eng_point *point = &ground.points[4 * i + k];
            memcpy(point->x0, query->x[0][k], sizeof point->x0);
            memcpy(point->x1, query->x[1][k], sizeof point->x1);
            point->word0 = prng_next(random);
            point->word1 = UINT64_MAX;
            ground.corner[k][i] = 4 * i + k;
        }
        struct eng_grid grid = grid_of(random, query, coarse_max);
        assert_true(eng_kernels_of(ENG_ISA_SCALAR)
                        ->place_points(&ground.points[4 * (size_t)i], 4, NULL, &grid,
                                       &ground.marks[4 * (size_t)i]));
    }
}

static struct eng_sieve sieve_of(float t_end)
{
    bool is_vf = ground.kind == PCCD_VF;
    return (struct eng_sieve){.marks = ground.marks,
                              .a_corner = {ground.corner[0], ground.corner[1]},
                              .b_corner = {ground.corner[is_vf ? 1 : 2],
                                           ground.corner[is_vf ? 2 : 3],
                                           is_vf ? ground.corner[3] : NULL},
                              .t_end = t_end};
}

/* Sifts the first `count` pairs; the rest of the arrays is what no pair may become. */
static uint32_t sift(const struct eng_kernels *kernels, struct eng_sieve *sieve,
                     uint32_t count)
{
    for (uint32_t i = 0; i < PAIR_MAX + ENG_SIEVE_SPARE; i++) {
        ground.a[i] = i >= count ? UINT32_MAX : ground.kind == PCCD_VF ? 4 * i : i;
        ground.b[i] = i >= count ? UINT32_MAX : i;
    }
    return kernels->sift(ground.kind, sieve, ground.a, ground.b, count);
}

/* Check that the sieve keeps pairs as they were, in their order. Return how many it
 * rejects that miss. */
static uint32_t check(uint32_t kept, float t_end)
{
    uint32_t rejected = 0;
    for (uint32_t i = 0, at = 0; i < PAIR_MAX; i++) {
        if (at < kept && ground.b[at] == i) {
            assert_int_equal(ground.a[at], ground.kind == PCCD_VF ? 4 * i : i);
            at++;
            continue;
        }
        struct eng_hit hit;
        bool found = eng_solve(&ground.queries[i], TOLERANCE, 1, case_exact(), &hit);
        assert_false(found && hit.toi_hi <= (double)t_end);
        rejected += !found;
    }
    return rejected;
}

/* If it failed: a contact would be thrown away before anybody looks. */
CASE(sieve__what_it_rejects_misses)
{
    struct prng random = {81};
    uint32_t rejected[2] = {0, 0};
    uint32_t later = 0;
    for (uint32_t round = 0; round < 400; round++) {
        float t_end = round % 3 == 0 ? (float)prng_between(&random, 0, 1) : 1;
        put(&random, round % 2 ? PCCD_EE : PCCD_VF, round % 4 < 2 ? 0 : 28);
        struct eng_sieve sieve = sieve_of(t_end);
        sieve.cubic_first = round % 8 < 4;
        sieve.swept = round % 16 < 8;
        uint32_t kept = sift(eng_kernels(), &sieve, PAIR_MAX);
        uint32_t misses = check(kept, t_end);
        rejected[round % 4 / 2] += t_end < 1 ? 0 : misses;
        later += PAIR_MAX - kept - misses;
    }
    /* Fine grids let it reject, coarse ones less; and a time leaves contacts behind. */
    assert_true(rejected[0] > 5000 && rejected[0] > rejected[1] && later > 1000);
}

/* If it failed: a contact at a multiple of its rounding would be lost, or one that begins
 * at the time to which it looks. */
CASE(sieve__contacts_at_its_last_time_pass)
{
    struct prng random = {82};
    for (uint32_t round = 0; round < 1000; round++) {
        uint32_t eighths = round % 9;
        float t_end = (float)eighths / 8;
        put(&random, round % 2 ? PCCD_EE : PCCD_VF, 28);
        for (uint32_t i = 0; i < PAIR_MAX; i++) { /* contacts at exactly t_end */
            struct eng_query *query = &ground.queries[i];
            kit_plant(&random, ground.kind, eighths, query);
            for (uint32_t k = 0; k < 4; k++) {
                memcpy(ground.points[4 * i + k].x0, query->x[0][k], 24);
                memcpy(ground.points[4 * i + k].x1, query->x[1][k], 24);
            }
            struct eng_grid grid = grid_of(&random, query, 28);
            eng_kernels()->place_points(&ground.points[4 * (size_t)i], 4, NULL, &grid,
                                        &ground.marks[4 * (size_t)i]);
        }
        struct eng_sieve sieve = sieve_of(t_end);
        sieve.cubic_first = round % 4 < 2;
        sieve.swept = round % 8 < 4;
        assert_int_equal(sift(eng_kernels(), &sieve, PAIR_MAX), PAIR_MAX);
    }
}

/* If a set sifted otherwise, or lost what lies behind the last full vector, survivors
 * would be counted otherwise on another processor, or contacts be lost. */
CASE(sieve__keeps_the_same_pairs_by_every_set)
{
    struct prng random = {83};
    for (uint32_t round = 0; round < 300; round++) {
        uint32_t count = round < 200 ? round : PAIR_MAX;
        float t_end = round % 3 == 0 ? (float)prng_between(&random, 0, 1) : 1;
        uint32_t expected[PAIR_MAX];
        uint32_t kept = 0;
        bool cubic_first = false;
        put(&random, round % 2 ? PCCD_EE : PCCD_VF, 20);
        for (int isa = 0; isa < ENG_ISA_COUNT; isa++) {
            const struct eng_kernels *kernels = eng_kernels_of((enum eng_isa)isa);
            if (!kernels) {
                continue;
            }
            struct eng_sieve sieve = sieve_of(t_end);
            sieve.cubic_first = round % 8 < 4;
            sieve.in_time = round % 5 == 0;
            sieve.swept = round % 7 < 3;
            uint32_t n = sift(kernels, &sieve, count);
            if (isa == ENG_ISA_SCALAR) {
                kept = n;
                cubic_first = sieve.cubic_first;
                memcpy(expected, ground.b, n * sizeof *expected);
            }
            assert_int_equal(n, kept);
            assert_memory_equal(ground.b, expected, n * sizeof *expected);
            assert_int_equal(sieve.cubic_first, cubic_first);
        }
    }
}

/* If it failed: the sieve would leave everything to what comes behind it. */
CASE(sieve__obvious_misses_are_rejected)
{
    static const struct {
        enum pccd_kind kind;
        double x[2][4][3];
    } misses[] = {
        /* Never at the same place in x and in y at a time; boxes overlap. */
        {PCCD_VF,
         {{{0, 3, 0}, {3, 0, 0}, {4, 0, 0}, {3, 1, 1}},
          {{4, 0, 0}, {3, 3, 0}, {4, 3, 0}, {3, 4, 1}}}},
        /* Above the plane of a tilted face all the time. */
        {PCCD_VF,
         {{{1, 1, 1.5}, {0, 0, 0}, {2, 0, 1}, {0, 2, 1}},
          {{1, 1, 1.25}, {0, 0, 0}, {2, 0, 1}, {0, 2, 1}}}},
        /* Beyond the long side of a face in its own plane. */
        {PCCD_VF,
         {{{0.75, 0.75, 0}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}},
          {{0.75, 0.75, 0}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}},
        /* Parallel diagonal edges side by side, moving along each other. */
        {PCCD_EE,
         {{{0, 0, 0}, {2, 2, 0}, {0.5, 0, 0}, {2.5, 2, 0}},
          {{1, 1, 0}, {3, 3, 0}, {0.5, 0, 0}, {2.5, 2, 0}}}},
        /* Crossed edges that stay apart in z, tilted so that their boxes meet. */
        {PCCD_EE,
         {{{-1, -1, 0}, {1, 1, 1}, {-1, 1, 0.75}, {1, -1, 1.75}},
          {{-1, -1, 0}, {1, 1, 1}, {-1, 1, 0.75}, {1, -1, 1.75}}}},
    };
    struct prng random = {84};
    for (size_t i = 0; i < sizeof misses / sizeof misses[0]; i++) {
        for (uint32_t n = 0; n < 20; n++) { /* features down to 2^10 units */
            struct eng_grid grid = {{1000, -500, 3}, ldexp(1, 30 - (int)n)};
            put(&random, misses[i].kind, 0);
            for (uint32_t k = 0; k < 4; k++) {
                for (int c = 0; c < 3; c++) {
                    ground.points[k].x0[c] = misses[i].x[0][k][c] / 8 + grid.origin[c];
                    ground.points[k].x1[c] = misses[i].x[1][k][c] / 8 + grid.origin[c];
                }
            }
            assert_true(
                eng_kernels()->place_points(ground.points, 4, NULL, &grid, ground.marks));
            struct eng_sieve sieve = sieve_of(1);
            sieve.swept = n % 2;
            assert_int_equal(sift(eng_kernels(), &sieve, 1), 0);
        }
    }
}

/* b lies above a along one axis at t = 0 and one at t = 1, by so many units. All is so
 * small on the grid that neither time nor cubic nor diagonals reject it. */
static void put_apart(const struct eng_kernels *kernels, const uint32_t axis[2],
                      const double gap[2])
{
    static const struct eng_grid grid = {{0, 0, 0}, 1};
    for (uint32_t k = 0; k < 4 * PAIR_MAX; k++) {
        bool is_b = k % 4 >= (ground.kind == PCCD_VF ? 1 : 2);
        struct eng_point *point = &ground.points[k];
        for (uint32_t c = 0; c < 3; c++) {
            double x = k >> c & 1;
            point->x0[c] = c != axis[0] ? x : is_b ? gap[0] : 0;
            point->x1[c] = c != axis[1] ? x : is_b ? gap[1] : 0;
        }
    }
    assert_true(
        kernels->place_points(ground.points, 4 * PAIR_MAX, NULL, &grid, ground.marks));
}

/* If it failed: a pair would be lost that only rounding to the grid holds apart, or that
 * is apart along one axis first and along another then; or none would be rejected. */
CASE(sieve__swept_pairs_need_two_units_of_one_axis)
{
    static const double gaps[] = {1, 2, -1, -2};
    struct prng random = {86};
    for (uint32_t i = 0; i < 2 * 9 * 16; i++) {
        const uint32_t axis[2] = {i / 2 % 3, i / 6 % 3};
        const double gap[2] = {gaps[i / 18 % 4], gaps[i / 72]};
        bool is_apart = axis[0] == axis[1] && gap[0] == gap[1] && fabs(gap[0]) == 2;
        put(&random, i % 2 ? PCCD_EE : PCCD_VF, 0);
        for (int isa = 0; isa < ENG_ISA_COUNT; isa++) {
            const struct eng_kernels *kernels = eng_kernels_of((enum eng_isa)isa);
            if (kernels) {
                put_apart(kernels, axis, gap);
                struct eng_sieve sieve = sieve_of(1);
                assert_int_equal(sift(kernels, &sieve, PAIR_MAX), PAIR_MAX);
                sieve.swept = true;
                assert_int_equal(sift(kernels, &sieve, PAIR_MAX),
                                 is_apart ? 0 : PAIR_MAX);
            }
        }
    }
}

/* If it failed: marks would be off by more than the margins of the sieve hold, or be
 * other ones on another processor. */
CASE(marks__are_the_nearest_whole_numbers)
{
    struct prng random = {85};
    struct eng_grid grid = {{1e6, -3, 0.1}, 0x1p20};
    struct eng_point points[7] = {0};
    for (uint32_t round = 0; round < 2000; round++) {
        struct eng_mark expected[7] = {0};
        for (int i = 0; i < 42; i++) {
            double q = round % 2 ? prng_integer(&random, 9) / 2
                                 : prng_between(&random, -0x1p29, 0x1p29);
            double x = grid.origin[i % 3] + q * 0x1p-20;
            double scaled = rint((x - grid.origin[i % 3]) * 0x1p20);
            struct eng_point *point = &points[i / 6];
            (i % 6 < 3 ? point->x0 : point->x1)[i % 3] = x;
            (i % 6 < 3 ? expected[i / 6].q0 : expected[i / 6].q1)[i % 3] =
                (int32_t)scaled;
            point->word0 = prng_next(&random);
            point->word1 = UINT64_MAX; /* not a number */
        }
        for (int isa = 0; isa < ENG_ISA_COUNT; isa++) {
            const struct eng_kernels *kernels = eng_kernels_of((enum eng_isa)isa);
            struct eng_mark marks[7];
            if (kernels) {
                assert_true(kernels->place_points(points, 7, NULL, &grid, marks));
                assert_memory_equal(marks, expected, sizeof expected);
            }
        }
    }
}

/* If it failed: a mark that has no place in 32 bits would stand for a point nearby, and
 * contacts be lost. */
CASE(marks__beyond_the_grid_are_told)
{
    const struct eng_grid grid = {{10, 0, -5}, 0x1p10};
    const double far[] = {0x1p20, -0x1p20, 1e18, -1e18, 0x1p20 - 0x1p-8};
    for (int isa = 0; isa < ENG_ISA_COUNT; isa++) {
        const struct eng_kernels *kernels = eng_kernels_of((enum eng_isa)isa);
        for (int i = 0; kernels && i < 30 * 5; i++) {
            struct eng_point points[5] = {0};
            struct eng_mark marks[5];
            struct eng_point *point = &points[i / 30];
            double *x = &(i % 2 ? point->x0 : point->x1)[i / 2 % 3];
            *x = grid.origin[i / 2 % 3] + ENG_GRID_REACH / grid.scale;
            assert_true(kernels->place_points(points, 5, NULL, &grid, marks));
            *x = grid.origin[i / 2 % 3] + far[i / 6 % 5];
            assert_false(kernels->place_points(points, 5, NULL, &grid, marks));
        }
    }
}

CASES_WITH(NULL, case_end);
