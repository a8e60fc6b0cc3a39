/* test_eng_sieve_thick.c - what certainly stays apart, from points on a grid.
 *
 * Source: BOUNDS.md, "The sieve: thick features".
 */
#include "distance.h"
#include "eng_case.h"
#include "kernel.h"
#include "thick.h"

struct pair {
    struct eng_thick_query query;
    struct eng_point points[4];
    struct eng_mark marks[4];
    struct eng_grid grid;
};

/* Whole numbers; needles; features beside each other in a plane that is aslant, apart by
 * their size or by far less; many that come nearest for a moment only. */
static void make(struct prng *random, enum pccd_kind kind, bool at_rest,
                 struct pair *pair)
{
    unsigned family = prng_u32(random, 4);
    double apart = family == 3 ? ldexp(1, -(int)prng_u32(random, 24)) : 0;
    memset(pair, 0, sizeof *pair);
    pair->query.query.kind = kind;
    for (int i = 0; i < 8; i++) {
        double *x = pair->query.query.x[i / 4][i % 4];
        bool is_b = i % 4 >= (kind == PCCD_VF ? 1 : 2);
        for (int k = 0; k < 3; k++) {
            x[k] = family == 0 ? prng_integer(random, 2) : prng_between(random, -1, 1);
            x[k] *= family == 2 && k > 0 ? 0x1p-20 : 1;
            x[k] = family == 3 && k == 2 ? 0.3 * x[0] : x[k];
            x[k] += is_b && k == 2 ? apart + (family == 1 ? 2 : 0) : 0;
        }
        if (i >= 4 && (at_rest || prng_u32(random, 4) == 0)) {
            memcpy(x, pair->query.query.x[0][i % 4], 3 * sizeof *x);
        }
    }
}

/* Put it on a grid that reaches as far as the pair, or up to 2^`coarse` times. */
static void put(struct prng *random, uint32_t coarse, struct pair *pair)
{
    double far = 0;
    int exponent;
    for (int k = 0; k < 3; k++) {
        pair->grid.origin[k] = pair->query.query.x[0][0][k] + prng_between(random, -1, 1);
    }
    for (int i = 0; i < 8; i++) {
        const double *x = pair->query.query.x[i / 4][i % 4];
        struct eng_point *point = &pair->points[i % 4];
        memcpy(i < 4 ? point->x0 : point->x1, x, sizeof point->x0);
        for (int k = 0; k < 3; k++) {
            far = fmax(far, fabs(x[k] - pair->grid.origin[k]));
        }
    }
    frexp(far * 1.001, &exponent);
    pair->grid.scale = ldexp(1, 30 - exponent - (int)prng_u32(random, coarse + 1));
    assert_true(
        eng_kernels()->place_points(pair->points, 4, NULL, &pair->grid, pair->marks));
}

/* Return whether the sieve of a set leaves the pair, with a distance, as often as lanes
 * are filled with it. */
static bool stays(const struct eng_kernels *kernels, const struct pair *pair, double r,
                  uint32_t copies, bool planes_first)
{
    static const uint32_t number[4] = {0, 1, 2, 3};
    uint32_t a[64 + ENG_SIEVE_SPARE] = {0};
    uint32_t b[64 + ENG_SIEVE_SPARE] = {0};
    const uint32_t *of_b = number + (pair->query.query.kind == PCCD_VF ? 1 : 2);
    struct eng_sieve sieve = {.marks = pair->marks,
                              .a_corner = {number, number + 1},
                              .b_corner = {of_b, of_b + 1, of_b + 2},
                              .t_end = 1,
                              .cubic_first = planes_first};
    float reach = nextafterf((float)(r * pair->grid.scale), INFINITY);
    uint32_t kept =
        kernels->sift_thick(pair->query.query.kind, &sieve, reach, a, b, copies);
    assert_true(kept == 0 || kept == copies);
    return kept > 0;
}

static bool meets(struct eng_thick *thick, struct pair *pair, double r)
{
    struct eng_hit hit;
    pair->query.radius[0] = r;
    return eng_thick_solve(thick, case_exact(), &pair->query, 1e-6, 1, &hit);
}

/* The distance of a pair at rest, rounded up. */
static double length_of(struct eng_distances *distances, const struct pair *pair)
{
    const uint8_t rank[4] = {0, 1, 2, 3};
    struct eng_distance distance;
    eng_distance_find(distances, pair->query.query.kind,
                      (const double(*)[3])pair->query.query.x[0], rank, &distance);
    return distance.hi;
}

/* A distance at which the pair meets, and 2^-40 less at which it does not. */
static double least_of(struct eng_thick *thick, struct pair *pair)
{
    double low = 0;
    double high = 16;
    for (int i = 0; i < 64 && high - low > 0x1p-40 * high && high > 0x1p-60; i++) {
        double r = low == 0 ? high / 8 : 0.5 * (low + high);
        if (meets(thick, pair, r)) {
            high = r;
        } else {
            low = r;
        }
    }
    return high;
}

/* Return whether the kernel that reads the points would reject the pair, too. */
static bool is_beyond(const struct pair *pair, double r)
{
    static const uint32_t quads[1][4] = {{0, 1, 2, 3}};
    uint32_t kept;
    return eng_kernels()->reject_thick(
               (struct eng_quads){pair->query.query.kind, pair->points, quads}, 1, &r,
               &kept) == 0;
}

/* If it failed: a pair that comes within r, by a hair's breadth or by the width of the
 * grid's cells, would be thrown away before anybody looks; or what integers give up would
 * be told or not for how the scene's grid lies. */
CASE(sieve_thick__what_it_rejects_stays_farther)
{
    struct prng random = {94};
    struct eng_thick thick;
    struct eng_distances distances;
    uint32_t rejected[2] = {0, 0}; /* on fine grids, on any */
    assert_ok(eng_thick_init(&thick));
    assert_ok(eng_distances_init(&distances));
    for (uint32_t round = 0; round < 160000; round++) {
        struct pair pair;
        bool is_fine = round % 8 < 4;
        bool at_rest = round % 32 != 0;
        make(&random, round % 3 ? PCCD_EE : PCCD_VF, at_rest, &pair);
        put(&random, is_fine ? 0 : 28, &pair);
        double r = at_rest ? length_of(&distances, &pair) : least_of(&thick, &pair);
        assert_true(stays(eng_kernels(), &pair, r, 1, round % 4 < 2));
        assert_false(is_beyond(&pair, r));
        if (!stays(eng_kernels(), &pair, r / 2, 1, round % 4 < 2)) {
            assert_true(is_beyond(&pair, r / 2));
            rejected[!is_fine]++;
        }
    }
    assert_true(rejected[0] > 40000 && rejected[1] < rejected[0]);
    eng_distances_deinit(&distances);
    eng_thick_deinit(&thick);
}

/* If a set sifted otherwise, or lost what lies behind the last full vector, work would be
 * counted otherwise on another processor, or pairs be lost. */
CASE(sieve_thick__keeps_the_same_pairs_by_every_set)
{
    struct prng random = {95};
    for (uint32_t round = 0; round < 30000; round++) {
        struct pair pair;
        make(&random, round % 2 ? PCCD_EE : PCCD_VF, false, &pair);
        put(&random, 24, &pair);
        double r = prng_between(&random, 0, 1) * ldexp(1, -(int)prng_u32(&random, 30));
        bool is_first = round % 4 < 2;
        bool expected =
            stays(eng_kernels_of(ENG_ISA_SCALAR), &pair, r, 1 + round % 5, is_first);
        for (int isa = 0; isa < ENG_ISA_COUNT; isa++) {
            const struct eng_kernels *kernels = eng_kernels_of((enum eng_isa)isa);
            if (kernels) {
                assert_int_equal(stays(kernels, &pair, r, 1 + round % 64, is_first),
                                 expected);
            }
        }
    }
}
