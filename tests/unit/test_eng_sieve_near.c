/* test_eng_sieve_near.c - what is certainly not near, from points on a grid.
 *
 * Source: BOUNDS.md, "The sieve: what is near".
 */
#include "distance.h"
#include "eng_case.h"
#include "kernel.h"
#include "kinds.h"

/* One pair: up to five points, of a, then of b. */
struct pair {
    uint32_t kind;
    double x[5][3];
    struct eng_mark marks[5];
    struct eng_grid grid;
};

static uint32_t points_of(uint32_t kind)
{
    return common_kinds[kind].points[0] + common_kinds[kind].points[1];
}

/* Whole numbers, many of whose distances tie; needles; features beside each other, apart
 * by their size or by far less. */
static void make(struct prng *random, uint32_t kind, struct pair *pair)
{
    unsigned family = prng_u32(random, 4);
    double apart = family == 3 ? ldexp(1, -(int)prng_u32(random, 24)) : 0;
    pair->kind = kind;
    for (uint32_t i = 0; i < points_of(kind); i++) {
        bool is_b = i >= common_kinds[kind].points[0];
        for (int k = 0; k < 3; k++) {
            double *x = &pair->x[i][k];
            *x = family == 0 ? prng_integer(random, 2) : prng_between(random, -1, 1);
            *x *= family == 2 && k > 0 ? 0x1p-26 : 1;
            *x = family == 3 && k == 2 ? 0.3 * pair->x[i][0] : *x;
            *x += is_b && k == 2 ? apart : 0;
        }
    }
}

/* Put it on a grid that reaches as far as the pair, or up to 2^`coarse` times. */
static void put(struct prng *random, uint32_t coarse, uint32_t end, struct pair *pair)
{
    struct eng_point points[5];
    double far = 0;
    int exponent;
    memset(points, 0, sizeof points);
    for (int k = 0; k < 3; k++) {
        pair->grid.origin[k] = pair->x[0][k] + prng_between(random, -1, 1);
    }
    for (uint32_t i = 0; i < points_of(pair->kind); i++) {
        for (int k = 0; k < 3; k++) {
            double x = pair->x[i][k];
            far = fmax(far, fabs(x - pair->grid.origin[k]));
            (end == 0 ? points[i].x0 : points[i].x1)[k] = x;
            (end == 0 ? points[i].x1 : points[i].x0)[k] = pair->grid.origin[k];
        }
    }
    frexp(far * 1.001, &exponent);
    pair->grid.scale = ldexp(1, 30 - exponent - (int)prng_u32(random, coarse + 1));
    assert_true(eng_kernels()->place_points(points, points_of(pair->kind), NULL,
                                            &pair->grid, pair->marks));
}

/* A distance in cells, rounded up. */
static float cells_of(const struct pair *pair, double d)
{
    return nextafterf((float)(d * pair->grid.scale), INFINITY);
}

/* Return whether the sieve of a set leaves the pair, with a distance, as often as lanes
 * are filled with it. `prunes`: by what its marks say, too. */
static bool is_kept(const struct eng_kernels *kernels, const struct pair *pair,
                    uint32_t end, double d, bool prunes, uint32_t copies)
{
    static const uint32_t number[5] = {0, 1, 2, 3, 4};
    uint32_t a[64 + ENG_SIEVE_SPARE] = {0};
    uint32_t b[64 + ENG_SIEVE_SPARE] = {0};
    const uint32_t *of_b = number + common_kinds[pair->kind].points[0];
    struct eng_sieve sieve = {.marks = pair->marks,
                              .a_corner = {number, number + 1},
                              .b_corner = {of_b, of_b + 1, of_b + 2},
                              .t_end = 1,
                              .prunes = prunes,
                              .end = end};
    uint32_t kept =
        kernels->sift_near(pair->kind, &sieve, cells_of(pair, d), a, b, copies);
    assert_true(kept == 0 || kept == copies);
    return kept > 0;
}

static bool stays(const struct eng_kernels *kernels, const struct pair *pair,
                  uint32_t end, double d, uint32_t copies)
{
    return is_kept(kernels, pair, end, d, false, copies);
}

/* Something is as near to a point of the pair as `own`, if that is less than d. */
static void know(struct pair *pair, uint32_t end, uint32_t point, double d, double own)
{
    float cells[2] = {cells_of(pair, d), cells_of(pair, fmin(d, own))};
    int32_t bits[2];
    memcpy(bits, cells, sizeof bits);
    struct eng_mark *mark = &pair->marks[point];
    *(end == 0 ? &mark->less0 : &mark->less1) = bits[0] - bits[1];
}

/* Distances that the exact rule puts just beyond the pair, or at it. */
static double length_of(struct eng_distances *distances, const struct pair *pair)
{
    const uint8_t rank[4] = {0, 1, 2, 3};
    struct eng_distance distance;
    eng_distance_find(distances, (enum pccd_kind)pair->kind, (const double(*)[3])pair->x,
                      rank, &distance);
    double d = distance.lo;
    return eng_distance_within(distances, (enum pccd_kind)pair->kind,
                               (const double(*)[3])pair->x, d)
               ? d
               : distance.hi;
}

/* If it failed: a pair that is near, by a hair's breadth or by the width of the grid's
 * cells, would be thrown away before anybody looks. */
CASE(sieve_near__what_it_rejects_is_farther)
{
    struct prng random = {91};
    struct eng_distances distances;
    uint32_t rejected[2] = {0, 0}; /* on fine grids, on any */
    assert_ok(eng_distances_init(&distances));
    for (uint32_t round = 0; round < 120000; round++) {
        struct pair pair;
        uint32_t end = round / 2 % 2;
        bool is_fine = round % 8 < 4;
        make(&random, round % 2 ? PCCD_EE : PCCD_VF, &pair);
        put(&random, is_fine ? 0 : 28, end, &pair);
        double d = length_of(&distances, &pair);
        assert_true(stays(eng_kernels(), &pair, end, d, 1));
        rejected[!is_fine] += !stays(eng_kernels(), &pair, end, d / 2, 1);
    }
    /* Of half their distance most are rejected where the grid is fine. */
    assert_true(rejected[0] > 40000 && rejected[1] < rejected[0]);
    eng_distances_deinit(&distances);
}

/* If it failed: an edge that passes through a face would not be told, or the sieve would
 * leave everything to what comes behind it. */
CASE(sieve_near__no_crossing_is_rejected)
{
    struct prng random = {92};
    struct eng_distances distances;
    uint32_t crossings = 0;
    uint32_t rejected = 0;
    assert_ok(eng_distances_init(&distances));
    for (uint32_t round = 0; round < 120000; round++) {
        struct pair pair;
        uint32_t end = round % 2;
        make(&random, PCCD_EF, &pair);
        put(&random, round % 4 < 2 ? 0 : 28, end, &pair);
        bool is_left = stays(eng_kernels(), &pair, end, 0, 1);
        if (eng_distance_crosses(&distances, (const double(*)[3])pair.x)) {
            assert_true(is_left);
            crossings++;
        }
        rejected += !is_left;
    }
    assert_true(crossings > 3000 && rejected > 20000);
    eng_distances_deinit(&distances);
}

/* If a set sifted otherwise, or lost what lies behind the last full vector, work would be
 * counted otherwise on another processor, or pairs be lost. */
CASE(sieve_near__keeps_the_same_pairs_by_every_set)
{
    struct prng random = {93};
    for (uint32_t round = 0; round < 30000; round++) {
        struct pair pair;
        static const uint32_t kinds[] = {PCCD_VF, PCCD_EE, PCCD_EF};
        uint32_t end = round % 2;
        make(&random, kinds[round % 3], &pair);
        put(&random, 24, end, &pair);
        double d = prng_between(&random, 0, 1) * ldexp(1, -(int)prng_u32(&random, 30));
        bool expected =
            stays(eng_kernels_of(ENG_ISA_SCALAR), &pair, end, d, 1 + round % 5);
        for (int isa = 0; isa < ENG_ISA_COUNT; isa++) {
            const struct eng_kernels *kernels = eng_kernels_of((enum eng_isa)isa);
            if (kernels) {
                assert_int_equal(stays(kernels, &pair, end, d, 1 + round % 64), expected);
            }
        }
    }
}

/* If it failed: a pair that is nearer to one of its points than all others would be
 * thrown away, as the others are nearer to something else; or none would be. */
CASE(sieve_near__looks_as_far_as_the_least_known_of_its_points)
{
    struct prng random = {94};
    uint32_t rejected = 0;
    for (uint32_t round = 0; round < 30000; round++) {
        struct pair pair;
        uint32_t end = round / 2 % 2;
        double far = 0;
        make(&random, round % 2 ? PCCD_EE : PCCD_VF, &pair);
        put(&random, 24, end, &pair);
        for (uint32_t i = 0; i < 4; i++) {
            double own =
                prng_between(&random, 0, 1) * ldexp(1, -(int)prng_u32(&random, 3));
            know(&pair, end, i, 0.75, own);
            far = fmax(far, fmin(own, 0.75));
        }
        bool expected = stays(eng_kernels(), &pair, end, far, 1);
        rejected += !expected && stays(eng_kernels(), &pair, end, 0.75, 1);
        for (int isa = 0; isa < ENG_ISA_COUNT; isa++) {
            const struct eng_kernels *kernels = eng_kernels_of((enum eng_isa)isa);
            if (kernels) {
                uint32_t copies = 1 + round % 64;
                assert_int_equal(is_kept(kernels, &pair, end, 0.75, true, copies),
                                 expected);
                assert_int_equal(is_kept(kernels, &pair, 1 - end, 0.75, true, copies),
                                 is_kept(kernels, &pair, 1 - end, 0.75, false, copies));
            }
        }
    }
    assert_true(rejected > 300);
}
