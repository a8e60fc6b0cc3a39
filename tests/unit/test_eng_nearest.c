/* test_eng_nearest.c - distances of two features, worked out by hand. */
#include "cases.h"
#include "distance.h"

static struct eng_distances distances;

static const uint8_t in_order[4] = {0, 1, 2, 3};
static const uint8_t backwards[4] = {3, 2, 1, 0};

struct expected {
    enum eng_nearest type;
    uint32_t points;
    double length;
    double param[2];
};

/* The distance is a double of few bits, so it is known exactly. */
static void expect(enum pccd_kind kind, const double x[4][3], const uint8_t rank[4],
                   struct expected expected)
{
    for (int first = 0; first < ENG_DISTANCE_STAGES; first++) {
        struct eng_distance distance;
        distances.first = (enum eng_distance_stage)first;
        eng_distance_find(&distances, kind, x, rank, &distance);
        assert_int_equal(distance.type, expected.type);
        assert_int_equal(distance.points, expected.points);
        assert_true(distance.lo == expected.length && distance.hi == expected.length);
        assert_true(distance.param[0] == expected.param[0]);
        assert_true(distance.param[1] == expected.param[1]);
        double square = 0;
        for (int k = 0; k < 3; k++) {
            square += distance.direction[k] * distance.direction[k];
        }
        assert_true(expected.length == 0 ? square == 0 : fabs(square - 1) < 0x1p-30);
        assert_true(eng_distance_within(&distances, kind, x, expected.length));
        assert_true(
            expected.length == 0 ||
            !eng_distance_within(&distances, kind, x, nextafter(expected.length, 0)));
    }
}

#define AT(x, y, z) ((const double[4][3]){{x, y, z}, {0, 0, 0}, {4, 0, 0}, {0, 4, 0}})
#define RESULT(type, points, length, param0, param1)                                     \
    ((struct expected){ENG_NEAREST_##type, points, length, {param0, param1}})

/* If it failed: a distance would be measured to the wrong part of a face, or a foot on an
 * edge would be said to be inside the face. */
CASE(distance__of_a_vertex_is_to_the_part_of_fewest_points)
{
    expect(PCCD_VF, AT(1, 2, 3), in_order, RESULT(VF, 15, 3, .25, .5));
    expect(PCCD_VF, AT(3, -3, 4), in_order, RESULT(VE, 7, 5, .75, 0));
    expect(PCCD_VF, AT(0, -3, 4), in_order, RESULT(VV, 3, 5, 0, 0));
    expect(PCCD_VF, AT(1, 0, 3), in_order, RESULT(VE, 7, 3, .25, 0));
    expect(PCCD_VF, AT(1, 3, 3), in_order, RESULT(VE, 13, 3, .25, .75));
    expect(PCCD_VF, AT(4, 0, 3), in_order, RESULT(VV, 5, 3, 1, 0));
    expect(PCCD_VF, AT(1, 1, 0), in_order, RESULT(VF, 15, 0, .25, .25));
    expect(PCCD_VF, AT(0, 4, 0), in_order, RESULT(VV, 9, 0, 0, 1));
}

/* If it failed: faces that are segments or points would have no answer, or one that
 * depends on the order of the corners. */
CASE(distance__to_a_degenerate_face_takes_the_least_ranks)
{
    static const double line[4][3] = {{2, 0, 1}, {0, 0, 0}, {4, 0, 0}, {8, 0, 0}};
    static const double dot[4][3] = {{2, 0, 0}, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}};
    expect(PCCD_VF, line, in_order, RESULT(VE, 7, 1, .5, 0));
    expect(PCCD_VF, line, (const uint8_t[]){0, 2, 3, 1}, RESULT(VE, 11, 1, 0, .25));
    expect(PCCD_VF, dot, in_order, RESULT(VV, 3, 2, 0, 0));
    expect(PCCD_VF, dot, backwards, RESULT(VV, 9, 2, 0, 1));
}

/* If it failed: edges would be measured between the wrong places, or parallel ones would
 * be EE, which have no common perpendicular of their own. */
CASE(distance__of_edges_is_at_ends_where_they_are_parallel)
{
    static const double crossed[4][3] = {{-1, 0, 2}, {3, 0, 2}, {0, -3, 0}, {0, 1, 0}};
    static const double beside[4][3] = {{1, 3, 4}, {5, 6, 8}, {0, 0, 0}, {4, 0, 0}};
    static const double meet[4][3] = {{-1, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}};
    static const double shifted[4][3] = {{0, 0, 1}, {4, 0, 1}, {1, 0, 0}, {5, 0, 0}};
    static const double aligned[4][3] = {{0, 0, 1}, {4, 0, 1}, {4, 0, 0}, {0, 0, 0}};
    static const double dots[4][3] = {{0, 0, 2}, {0, 0, 2}, {0, 0, 0}, {0, 0, 0}};
    expect(PCCD_EE, crossed, in_order, RESULT(EE, 15, 2, .25, .75));
    expect(PCCD_EE, beside, in_order, RESULT(VE, 13, 5, 0, .25));
    expect(PCCD_EE, meet, in_order, RESULT(EE, 15, 0, .5, .5));
    expect(PCCD_EE, shifted, in_order, RESULT(VE, 14, 1, 1, .75));
    expect(PCCD_EE, shifted, backwards, RESULT(VE, 7, 1, .25, 0));
    expect(PCCD_EE, aligned, in_order, RESULT(VV, 9, 1, 0, 1));
    expect(PCCD_EE, aligned, (const uint8_t[]){1, 0, 2, 3}, RESULT(VV, 6, 1, 1, 0));
    expect(PCCD_EE, dots, backwards, RESULT(VV, 10, 2, 1, 1));
}

/* Whole numbers, some less a little, in a few planes, and some points in one place. */
static void make_close(uint64_t *seed, double x[4][3])
{
    for (int i = 0; i < 4; i++) {
        for (int k = 0; k < 3; k++) {
            *seed = *seed * 6364136223846793005u + 1442695040888963407u;
            unsigned draw = (unsigned)(*seed >> 40);
            x[i][k] = draw % 5 + (draw / 8 % 4 == 0   ? 0x1p-60
                                  : draw / 8 % 4 == 1 ? .1
                                                      : 0);
        }
        if (*seed >> 33 & 1 && i > 0) {
            x[i][1] = x[i - 1][1];
        }
        if (*seed >> 34 & 3 && i > 1) {
            memcpy(x[i], x[0], *seed >> 36 & 1 ? sizeof x[i] : 0);
        }
    }
}

/* If it failed: what lies in one place or along an axis, as meshes at rest do, would be
 * said otherwise by doubles than by integers; or doubles would never say it, and each
 * such pair take as long as a hundred others. */
CASE(distance__in_one_place_or_along_an_axis_is_known_by_doubles)
{
    uint64_t seed = 5;
    uint64_t before = distances.decided[ENG_DISTANCE_BY_DOUBLES];
    for (unsigned round = 0; round < 20000; round++) {
        double x[4][3];
        struct eng_distance found[2];
        enum pccd_kind kind = round % 2 ? PCCD_EE : PCCD_VF;
        make_close(&seed, x);
        for (int by = 0; by < 2; by++) {
            memset(&found[by], 0, sizeof found[by]);
            distances.first =
                by == 0 ? ENG_DISTANCE_BY_DOUBLES : ENG_DISTANCE_BY_INTEGERS;
            eng_distance_find(&distances, kind, (const double(*)[3])x, in_order,
                              &found[by]);
            double d = found[0].hi;
            assert_true(eng_distance_within(&distances, kind, (const double(*)[3])x, d));
            assert_int_equal(
                eng_distance_below(&distances, kind, (const double(*)[3])x, d),
                found[0].lo < d);
        }
        assert_memory_equal(&found[0], &found[1], sizeof found[0]);
    }
    assert_true(distances.decided[ENG_DISTANCE_BY_DOUBLES] - before > 30000);
    distances.first = ENG_DISTANCE_BY_DOUBLES;
    before = distances.decided[ENG_DISTANCE_BY_DOUBLES];
    static const double corner[4][3] = {{4, 0, 0}, {0, 0, 0}, {4, 0, 0}, {0, 4, 0}};
    static const double ends[4][3] = {{1, 2, 3}, {5, 6, 7}, {1, 2, 4}, {1, 2, 3}};
    const double(*const points[])[3] = {corner, ends, AT(1, 1, 3), AT(1, 1, .1)};
    for (int i = 0; i < 4; i++) {
        struct eng_distance distance;
        eng_distance_find(&distances, i == 1 ? PCCD_EE : PCCD_VF, points[i], in_order,
                          &distance);
    }
    assert_int_equal(distances.decided[ENG_DISTANCE_BY_DOUBLES] - before, 4);
}

static bool crosses(double x0, double y0, double z0, double x1, double y1, double z1)
{
    const double x[5][3] = {{x0, y0, z0}, {x1, y1, z1}, {0, 0, 0}, {4, 0, 0}, {0, 4, 0}};
    distances.first = ENG_DISTANCE_BY_DOUBLES;
    bool answer = eng_distance_crosses(&distances, x);
    for (int first = 1; first < ENG_DISTANCE_STAGES; first++) {
        distances.first = (enum eng_distance_stage)first;
        assert_int_equal(eng_distance_crosses(&distances, x), answer);
    }
    return answer;
}

/* Expect where an edge passes through a face in the plane z = 0, by every stage. */
static void expect_crossing(double z0, double z1, double position)
{
    const double x[5][3] = {{1, 1, z0}, {1, 1, z1}, {0, 0, 0}, {4, 0, 0}, {0, 4, 0}};
    const double turned[5][3] = {{1, 1, z0}, {1, 1, z1}, {0, 0, 0}, {0, 4, 0}, {4, 0, 0}};
    for (int first = 0; first < ENG_DISTANCE_STAGES; first++) {
        distances.first = (enum eng_distance_stage)first;
        assert_true(eng_distance_crossing(&distances, x) == position);
        assert_true(eng_distance_crossing(&distances, turned) == position);
    }
}

/* If it failed: whoever pulls two surfaces apart would begin in the wrong place, or in
 * another one after an update of the processor. */
CASE(crossing__is_at_the_nearest_multiple)
{
    expect_crossing(1, -1, .5);
    expect_crossing(-1, 3, .25);
    expect_crossing(1, -2, 1431655765 * 0x1p-32);   /* a third: 0x55555555.55.. */
    expect_crossing(1, -(0x1p33 - 1), 0);           /* half of a multiple: to even */
    expect_crossing(3, -(0x1p33 - 3), 2 * 0x1p-32); /* one and a half */
    expect_crossing(0x1p33 - 1, -1, 1);             /* near the other end */
    expect_crossing(0x1p-1000, -0x1p-1001, 2863311531 * 0x1p-32);
    expect_crossing(1e18, -1e-300, 1);
}

/* If it failed: an edge that only touches would count as passing through, or one that
 * passes through as touching. */
CASE(crossing__is_strict)
{
    assert_true(crosses(1, 1, 1, 1, 1, -1));
    assert_true(crosses(0x1p-900, 0x1p-900, 1, 0x1p-900, 0x1p-900, -1));
    assert_false(crosses(1, 1, 0, 1, 1, -1)); /* an end on the face */
    assert_false(crosses(1, 1, 2, 1, 1, 1));  /* above it */
    assert_false(crosses(1, 0, 1, 1, 0, -1)); /* through an edge */
    assert_false(crosses(4, 0, 1, 4, 0, -1)); /* through a corner */
    assert_false(crosses(3, 3, 1, 3, 3, -1)); /* past it */
    assert_false(crosses(-9, 1, 0, 9, 1, 0)); /* in its plane */
}

static int set_up(void **state)
{
    (void)state;
    return eng_distances_init(&distances);
}

static int tear_down(void **state)
{
    (void)state;
    eng_distances_deinit(&distances);
    return 0;
}

CASES_WITH(set_up, tear_down);
