/* test_eng_filter.c - certain misses by floats, and by fixed directions. */
#include "eng_kit.h"

#include "kernel.h"

/* ---- floats ------------------------------------------------------------------------ */

/* The answer for one query. */
static bool passes(const struct eng_query *query)
{
    const struct eng_kernels *kernels = eng_kernels();
    const uint32_t quads[1][4] = {{0, 1, 2, 3}};
    struct eng_point points[4] = {0};
    uint32_t kept[1] = {0};
    for (int i = 0; i < 4; i++) {
        memcpy(points[i].x0, query->x[0][i], sizeof points[i].x0);
        memcpy(points[i].x1, query->x[1][i], sizeof points[i].x1);
    }
    return kernels->reject_axes((struct eng_quads){query->kind, points, quads}, 1,
                                kept) == 1 &&
           kernels->filter((struct eng_quads){query->kind, points, quads}, kept, 1,
                           kept) == 1;
}

/* If it failed: a real contact would be thrown away before anybody looks. */
CASE(filter__planted_contacts_pass)
{
    struct prng random = {51};
    for (int round = 0; round < 100000; round++) {
        struct eng_query query;
        kit_plant(&random, round % 2 ? PCCD_EE : PCCD_VF, (unsigned)round / 2 % 9,
                  &query);
        assert_true(passes(&query));
    }
}

/* If it failed: underflow or overflow would turn a contact into a miss. */
CASE(filter__planted_contacts_pass_at_every_scale)
{
    struct prng random = {52};
    /* 2^9 2^50 < 1e18; the smallest bits, 2^-9 2^-1060, are the last denormals but
     * few. */
    for (int exponent = -1060; exponent <= 50; exponent += 5) {
        for (int round = 0; round < 200; round++) {
            struct eng_query query;
            kit_plant(&random, round % 2 ? PCCD_EE : PCCD_VF, prng_u32(&random, 9),
                      &query);
            kit_place(&query, ldexp(1, exponent), 0);
            assert_true(passes(&query));
        }
    }
}

/* If it failed: contacts far from the origin would be lost to cancellation. */
CASE(filter__planted_contacts_pass_far_from_the_origin)
{
    struct prng random = {53};
    for (int round = 0; round < 100000; round++) {
        struct eng_query query;
        double offset = ldexp(prng_integer(&random, 7), (int)prng_u32(&random, 40));
        kit_plant(&random, round % 2 ? PCCD_EE : PCCD_VF, prng_u32(&random, 9), &query);
        kit_place(&query, 1, offset); /* below 2^43: the 2^-9 stay exact */
        assert_true(passes(&query));
    }
}

/* If it failed: degenerate features would be rejected by a sign of zero. */
CASE(filter__degenerate_contacts_pass)
{
    struct prng random = {54};
    for (int round = 0; round < 20000; round++) {
        struct eng_query query;
        kit_plant(&random, round % 2 ? PCCD_EE : PCCD_VF, prng_u32(&random, 9), &query);
        /* Collapse everything onto one moving point, or onto a plane. */
        for (int i = 0; i < 24; i++) {
            int end = i / 12;
            int point = i / 3 % 4;
            if (round % 4 < 2) {
                query.x[end][point][i % 3] = query.x[end][0][i % 3];
            } else if (i % 3 == round % 3) {
                query.x[end][point][i % 3] = 5;
            }
        }
        assert_true(passes(&query));
    }
}

/* If it failed: where products underflow, the sign of their rounding would decide. */
CASE(filter__flat_contacts_pass_where_products_underflow)
{
    struct prng random = {55};
    for (int round = 0; round < 100000; round++) {
        struct eng_query query;
        kit_plant(&random, round % 2 ? PCCD_EE : PCCD_VF, prng_u32(&random, 9), &query);
        for (int i = 0; i < 8; i++) { /* a plane that no axis knows */
            double *x = query.x[i / 4][i % 4];
            x[2] = x[0] + 3 * x[1];
        }
        kit_place(&query, ldexp(1, -350 - (int)prng_u32(&random, 15)), 0);
        assert_true(passes(&query));
    }
}

static void check_rejected(enum pccd_kind kind, const double x0[4][3],
                           const double x1[4][3])
{
    struct eng_query query = {.kind = kind};
    memcpy(query.x[0], x0, sizeof query.x[0]);
    memcpy(query.x[1], x1, sizeof query.x[1]);
    for (int exponent = -200; exponent <= 50; exponent += 10) {
        struct eng_query scaled = query;
        kit_place(&scaled, ldexp(1, exponent), 0);
        assert_false(passes(&scaled));
    }
    kit_place(&query, 1, 1000);
    assert_false(passes(&query));
}

/* If it failed: the filter would filter nothing, and every pair would be solved. */
CASE(filter__obvious_misses_are_rejected)
{
    /* Above the plane of a tilted face all the time, boxes overlapping. */
    const double above[4][3] = {{1, 1, 1.5}, {0, 0, 0}, {2, 0, 1}, {0, 2, 1}};
    const double above1[4][3] = {{1, 1, 1.25}, {0, 0, 0}, {2, 0, 1}, {0, 2, 1}};
    check_rejected(PCCD_VF, above, above1);
    /* Beyond the long side of a face in its own plane: only a diagonal separates. */
    const double beside[4][3] = {{0.75, 0.75, 0}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    check_rejected(PCCD_VF, beside, beside);
    /* Crossed edges that stay apart in z, tilted so that their boxes meet. */
    const double crossed[4][3] = {{-1, -1, 0}, {1, 1, 1}, {-1, 1, 0.75}, {1, -1, 1.75}};
    check_rejected(PCCD_EE, crossed, crossed);
    /* Parallel diagonal edges side by side, moving along each other. */
    const double parallel[4][3] = {{0, 0, 0}, {2, 2, 0}, {0.5, 0, 0}, {2.5, 2, 0}};
    const double parallel1[4][3] = {{1, 1, 0}, {3, 3, 0}, {0.5, 0, 0}, {2.5, 2, 0}};
    check_rejected(PCCD_EE, parallel, parallel1);
}

/* ---- fixed directions between two features ----------------------------------------- */

#define DIRECTIONS 9

static const int directions[DIRECTIONS][3] = {{1, 0, 0},  {0, 1, 0},  {0, 0, 1},
                                              {1, 1, 0},  {1, -1, 0}, {0, 1, 1},
                                              {0, 1, -1}, {1, 0, 1},  {-1, 0, 1}};

/* Return whether the second feature is above the first at both ends, or below it at
 * both. */
static bool is_apart_along(const struct eng_query *query, const int d[3])
{
    int split = query->kind == PCCD_VF ? 1 : 2;
    bool above = true;
    bool below = true;
    for (int end = 0; end < 2; end++) {
        for (int a = 0; a < split; a++) {
            for (int b = split; b < 4; b++) {
                double gap = 0; /* of small whole numbers: exact */
                for (int k = 0; k < 3; k++) {
                    gap += d[k] * (query->x[end][b][k] - query->x[end][a][k]);
                }
                above = above && gap > 0;
                below = below && gap < 0;
            }
        }
    }
    return above || below;
}

/* If it failed: a direction would be left out, or a pair that only a direction between
 * them tells apart, or one that changes sides, would be dropped. */
CASE(separate__says_what_nine_directions_say)
{
    struct prng random = {811};
    int alone[2][DIRECTIONS] = {{0}};
    int apart = 0;
    enum { ROUNDS = 200000 };
    for (int round = 0; round < ROUNDS; round++) {
        struct eng_query query = {.kind = round % 2 ? PCCD_EE : PCCD_VF};
        for (int i = 0; i < 24; i++) {
            query.x[i / 12][i / 3 % 4][i % 3] = prng_integer(&random, 6);
        }
        int count = 0;
        int last = 0;
        for (int k = 0; k < DIRECTIONS; k++) {
            if (is_apart_along(&query, directions[k])) {
                count++;
                last = k;
            }
        }
        assert_int_equal(eng_query_separates(&query), count > 0);
        apart += count > 0;
        alone[query.kind == PCCD_EE][last] += count == 1;
    }
    for (int k = 0; k < DIRECTIONS; k++) {
        assert_true(alone[0][k] > 50 && alone[1][k] > 50);
    }
    assert_true(apart > ROUNDS / 50 && apart < ROUNDS / 2);
}

/* If it failed: a contact would be missed whose sums of coordinates are rounded. */
CASE(separate__never_drops_a_contact)
{
    struct prng random = {812};
    for (int round = 0; round < 60000; round++) {
        struct eng_query query;
        kit_plant(&random, round % 2 ? PCCD_EE : PCCD_VF, prng_u32(&random, 9), &query);
        assert_false(eng_query_separates(&query));
        /* A sixth of the numbers moved by a bit: less than any margin. */
        struct eng_query near = query;
        for (int i = 0; i < 24; i++) {
            double *x = &near.x[i / 12][i / 3 % 4][i % 3];
            *x = prng_u32(&random, 6) == 0 ? *x * (1 + 0x1p-52) : *x;
        }
        assert_true(!eng_query_separates(&near) || is_apart_along(&near, directions[0]) ||
                    is_apart_along(&near, directions[1]) ||
                    is_apart_along(&near, directions[2]));
    }
}
