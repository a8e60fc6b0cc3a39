/* test_oracle_distance.c - the oracle's distances, on cases that were worked out by hand.
 */
#include "cases.h"
#include "oracle_distance.h"

typedef const double (*points_t)[3];

static const uint8_t in_order[4] = {0, 1, 2, 3};
static const uint8_t backwards[4] = {3, 2, 1, 0};

#define TRIANGLE                                                                         \
    {0, 0, 0}, {4, 0, 0},                                                                \
    {                                                                                    \
        0, 4, 0                                                                          \
    }

static struct oracle_distance find(enum oracle_kind kind, points_t p,
                                   const uint8_t rank[4])
{
    struct oracle_distance distance;
    oracle_distance_find(kind, p, rank, &distance);
    /* What the roundings are of, the comparison finds, too. */
    assert_true(oracle_distance_within(kind, p, distance.hi));
    if (distance.lo > 0) {
        assert_false(oracle_distance_within(kind, p, nextafter(distance.lo, 0)));
    }
    assert_int_equal(oracle_distance_within(kind, p, distance.lo),
                     distance.lo == distance.hi);
    return distance;
}

static void expect(enum oracle_kind kind, points_t p, const uint8_t rank[4],
                   struct oracle_distance expected)
{
    struct oracle_distance distance = find(kind, p, rank);
    assert_int_equal(distance.type, expected.type);
    assert_int_equal(distance.points, expected.points);
    assert_true(distance.lo == expected.lo && distance.hi == expected.hi);
    assert_true(distance.param[0] == expected.param[0]);
    assert_true(distance.param[1] == expected.param[1]);
    for (int k = 0; k < 3; k++) {
        assert_true(distance.direction[k] ==
                    rint(expected.direction[k] * 0x1p32) * 0x1p-32);
    }
}

#define AT(x, y, z) ((const double[4][3]){{x, y, z}, TRIANGLE})
#define RESULT(type, points, length, param0, param1, x, y, z)                            \
    ((struct oracle_distance){                                                           \
        ORACLE_NEAREST_##type, points, length, length, {param0, param1}, {x, y, z}})

/* If it failed: a vertex over a face, beside an edge or beyond a corner would get the
 * distance to another part of it. */
CASE(distance__finds_each_part_of_a_face)
{
    expect(ORACLE_VF, AT(1, 2, 3), in_order, RESULT(VF, 15, 3, .25, .5, 0, 0, 1));
    expect(ORACLE_VF, AT(1, 2, -3), in_order, RESULT(VF, 15, 3, .25, .5, 0, 0, -1));
    expect(ORACLE_VF, AT(3, -3, 4), in_order, RESULT(VE, 7, 5, .75, 0, 0, -.6, .8));
    expect(ORACLE_VF, AT(-3, 1, 4), in_order, RESULT(VE, 11, 5, 0, .25, -.6, 0, .8));
    expect(ORACLE_VF, AT(0, -3, 4), in_order, RESULT(VV, 3, 5, 0, 0, 0, -.6, .8));
    expect(ORACLE_VF, AT(8, 0, 3), in_order, RESULT(VV, 5, 5, 1, 0, .8, 0, .6));
    expect(ORACLE_VF, AT(0, 4, 0), in_order, RESULT(VV, 9, 0, 0, 1, 0, 0, 0));
}

/* If it failed: a foot exactly on an edge would be given to the face, or one exactly at a
 * corner to an edge. */
CASE(distance__takes_the_fewest_points)
{
    expect(ORACLE_VF, AT(1, 0, 3), in_order, RESULT(VE, 7, 3, .25, 0, 0, 0, 1));
    expect(ORACLE_VF, AT(1, 3, 3), in_order, RESULT(VE, 13, 3, .25, .75, 0, 0, 1));
    expect(ORACLE_VF, AT(0, 0, 3), in_order, RESULT(VV, 3, 3, 0, 0, 0, 0, 1));
    expect(ORACLE_VF, AT(4, 0, 3), in_order, RESULT(VV, 5, 3, 1, 0, 0, 0, 1));
    expect(ORACLE_VF, AT(1, 1, 0), in_order, RESULT(VF, 15, 0, .25, .25, 0, 0, 0));
}

/* If it failed: degenerate features would have no order, or one that depends on the order
 * in which they are tried. */
CASE(distance__takes_the_least_ranks_among_equals)
{
    static const double line[4][3] = {{2, 0, 1}, {0, 0, 0}, {4, 0, 0}, {8, 0, 0}};
    static const double dot[4][3] = {{2, 0, 0}, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}};
    static const double twice[4][3] = {{2, 0, 1}, {0, 0, 0}, {2, 0, 0}, {8, 0, 0}};
    expect(ORACLE_VF, line, in_order, RESULT(VE, 7, 1, .5, 0, 0, 0, 1));
    expect(ORACLE_VF, line, (const uint8_t[]){0, 2, 3, 1},
           RESULT(VE, 11, 1, 0, .25, 0, 0, 1));
    expect(ORACLE_VF, dot, in_order, RESULT(VV, 3, 2, 0, 0, 1, 0, 0));
    expect(ORACLE_VF, dot, backwards, RESULT(VV, 9, 2, 0, 1, 1, 0, 0));
    expect(ORACLE_VF, twice, in_order, RESULT(VV, 5, 1, 1, 0, 0, 0, 1));
}

/* If it failed: edges would be measured between the wrong places. */
CASE(distance__finds_each_part_of_edges)
{
    static const double crossed[4][3] = {{-1, 0, 2}, {3, 0, 2}, {0, -3, 0}, {0, 1, 0}};
    static const double beside[4][3] = {{1, 3, 4}, {5, 6, 8}, {0, 0, 0}, {4, 0, 0}};
    static const double other[4][3] = {{0, 0, 0}, {4, 0, 0}, {5, 6, 8}, {1, 3, 4}};
    static const double far[4][3] = {{0, 0, 0}, {4, 0, 0}, {9, 0, 0}, {12, 1, 0}};
    static const double meet[4][3] = {{-1, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}};
    expect(ORACLE_EE, crossed, in_order, RESULT(EE, 15, 2, .25, .75, 0, 0, 1));
    expect(ORACLE_EE, beside, in_order, RESULT(VE, 13, 5, 0, .25, 0, .6, .8));
    expect(ORACLE_EE, other, in_order, RESULT(VE, 11, 5, .25, 1, 0, -.6, -.8));
    expect(ORACLE_EE, far, in_order, RESULT(VV, 6, 5, 1, 0, -1, 0, 0));
    expect(ORACLE_EE, meet, in_order, RESULT(EE, 15, 0, .5, .5, 0, 0, 0));
}

/* If it failed: parallel edges would be EE, whose normal is 0, or any of their ends. */
CASE(distance__of_parallel_edges_is_at_their_ends)
{
    static const double shifted[4][3] = {{0, 0, 1}, {4, 0, 1}, {1, 0, 0}, {5, 0, 0}};
    static const double aligned[4][3] = {{0, 0, 1}, {4, 0, 1}, {4, 0, 0}, {0, 0, 0}};
    static const double dots[4][3] = {{0, 0, 2}, {0, 0, 2}, {0, 0, 0}, {0, 0, 0}};
    expect(ORACLE_EE, shifted, in_order, RESULT(VE, 14, 1, 1, .75, 0, 0, 1));
    expect(ORACLE_EE, shifted, backwards, RESULT(VE, 7, 1, .25, 0, 0, 0, 1));
    expect(ORACLE_EE, aligned, in_order, RESULT(VV, 9, 1, 0, 1, 0, 0, 1));
    expect(ORACLE_EE, aligned, (const uint8_t[]){1, 0, 2, 3},
           RESULT(VV, 6, 1, 1, 0, 0, 0, 1));
    expect(ORACLE_EE, dots, in_order, RESULT(VV, 5, 2, 0, 0, 0, 0, 1));
    expect(ORACLE_EE, dots, backwards, RESULT(VV, 10, 2, 1, 1, 0, 0, 1));
}

/* If it failed: a bracket would be too wide, off, or would lose what a double can say. */
CASE(distance__is_rounded_to_33_bits)
{
    struct oracle_distance distance;
    distance = find(ORACLE_VF, AT(-1, -1, 0), in_order);
    assert_true(distance.lo == floor(sqrt(2) * 0x1p32) * 0x1p-32);
    assert_true(distance.hi == distance.lo + 0x1p-32);
    assert_true(distance.direction[0] == -rint(sqrt(0.5) * 0x1p32) * 0x1p-32);
    distance = find(ORACLE_VF, AT(1, 1, 1 + 0x1p-32), in_order);
    assert_true(distance.lo == 1 + 0x1p-32 && distance.hi == distance.lo);
    distance = find(ORACLE_VF, AT(1, 1, 1 + 0x1p-33), in_order);
    assert_true(distance.lo == 1 && distance.hi == 1 + 0x1p-32);
    distance = find(ORACLE_VF, AT(1, 1, 2 - 0x1p-52), in_order);
    assert_true(distance.lo == 2 - 0x1p-32 && distance.hi == 2);
    distance = find(ORACLE_VF, AT(1, 1, 0x1p-1074), in_order);
    assert_true(distance.lo == 0x1p-1074 && distance.hi == distance.lo);
    /* Half of the least number there is. */
    static const double least[4][3] = {
        {0x1p-1074, 0, 0}, {0, 0, 0}, {0x1p-1074, 0x1p-1074, 0}, {0, 0, 0}};
    distance = find(ORACLE_VF, least, in_order);
    assert_true(distance.lo == 0 && distance.hi == 0x1p-1074);
    distance = find(ORACLE_VF, AT(1e18, 1e18, 1e18), in_order);
    assert_true(distance.lo < 1.7320508076e18 && distance.hi > 1.7320508075e18);
    assert_true(distance.hi - distance.lo == 0x1p28);
}

/* If it failed: halves would be rounded by chance. */
CASE(distance__rounds_halves_to_even)
{
    static const double ends[4][3] = {{0x1p-32, 0, 1}, {0, 0, 0}, {2, 0, 0}, {0, 2, 0}};
    static const double three[4][3] = {{0x3p-32, 1, 1}, {0, 0, 0}, {2, 0, 0}, {0, 4, 0}};
    assert_true(find(ORACLE_VF, ends, in_order).param[0] == 0);
    assert_true(find(ORACLE_VF, three, in_order).param[0] == 0x2p-32);
}

#define CROSSES(x0, y0, z0, x1, y1, z1)                                                  \
    oracle_crosses((const double[5][3]){{x0, y0, z0}, {x1, y1, z1}, TRIANGLE})

/* If it failed: edges that only touch would count as passing through, or those that pass
 * through as touching. */
CASE(crossing__is_strict)
{
    static const double flat[5][3] = {
        {1, 1, -1}, {1, 1, 1}, {0, 0, 0}, {1, 1, 0}, {2, 2, 0}};
    assert_true(CROSSES(1, 1, 1, 1, 1, -1));
    assert_true(CROSSES(1, 1, -1, 1, 1, 1));
    assert_true(CROSSES(0x1p-1000, 0x1p-1000, 1, 0x1p-1000, 0x1p-1000, -1));
    assert_false(CROSSES(1, 1, 0, 1, 1, -1)); /* an end on the face */
    assert_false(CROSSES(1, 1, 2, 1, 1, 1));  /* above it */
    assert_false(CROSSES(1, 0, 1, 1, 0, -1)); /* through an edge */
    assert_false(CROSSES(4, 0, 1, 4, 0, -1)); /* through a corner */
    assert_false(CROSSES(3, 3, 1, 3, 3, -1)); /* past it */
    assert_false(CROSSES(-9, 1, 0, 9, 1, 0)); /* in its plane */
    assert_false(CROSSES(1, 1, 1, 1, 1, 1));  /* without length */
    assert_false(oracle_crosses(flat));       /* no inside */
}
