/* test_eng_solve.c - the certified solver, by cases derived by hand. */
#include "eng_case.h"
#include "vec.h"

#define ULP 0x1p-52

static const double corners[3][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};

/* A vertex from v0 to v1 against the standing face `corners`. */
static struct eng_query vertex_path(const double v0[3], const double v1[3])
{
    double x[2][4][3];
    memcpy(x[0][0], v0, sizeof x[0][0]);
    memcpy(x[1][0], v1, sizeof x[1][0]);
    memcpy(x[0][1], corners, sizeof corners);
    memcpy(x[1][1], corners, sizeof corners);
    return case_query(PCCD_VF, x[0], x[1]);
}

static void check_path(double t, const double v0[3], const double v1[3])
{
    struct eng_query query = vertex_path(v0, v1);
    case_check(&query, t);
}

#define POINT(x, y, z)                                                                   \
    (const double[3])                                                                    \
    {                                                                                    \
        x, y, z                                                                          \
    }

/* The cubic (t - 1/2)^2 + c of a vertex (t, y, 1/4 + c - t) and a face with corners 0,
 * (1, 0, -t), (0, 1, 0); as edges: from the origin to (1, 0, -t), and from that vertex
 * to one step back along y. Contact needs 0 <= t, y and (face) t + y <= 1. */
static struct eng_query parabola(enum pccd_kind kind, double c, double y0, double y1)
{
    const double v0[3] = {0, y0, 0.25 + c};
    const double v1[3] = {1, y1, -0.75 + c};
    const double vf[2][4][3] = {
        {{v0[0], v0[1], v0[2]}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}},
        {{v1[0], v1[1], v1[2]}, {0, 0, 0}, {1, 0, -1}, {0, 1, 0}}};
    const double ee[2][4][3] = {
        {{0, 0, 0}, {1, 0, 0}, {v0[0], v0[1], v0[2]}, {v0[0], v0[1] - 1, v0[2]}},
        {{0, 0, 0}, {1, 0, -1}, {v1[0], v1[1], v1[2]}, {v1[0], v1[1] - 1, v1[2]}}};
    return kind == PCCD_VF ? case_query(PCCD_VF, vf[0], vf[1])
                           : case_query(PCCD_EE, ee[0], ee[1]);
}

static struct eng_query edges(const double x0[4][3], const double x1[4][3])
{
    return case_query(PCCD_EE, x0, x1);
}

/* Edge (0,0,0)-(2,0,0) stands; the other goes from (p, q) by `way`. */
static struct eng_query against_bar(const double p[3], const double q[3],
                                    const double way[3])
{
    double x[2][4][3] = {{{0, 0, 0}, {2, 0, 0}}, {{0, 0, 0}, {2, 0, 0}}};
    for (int k = 0; k < 3; k++) {
        x[0][2][k] = p[k];
        x[0][3][k] = q[k];
        x[1][2][k] = p[k] + way[k];
        x[1][3][k] = q[k] + way[k];
    }
    return edges(x[0], x[1]);
}

static void check_bar(double t, const double p[3], const double q[3], const double way[3])
{
    struct eng_query query = against_bar(p, q, way);
    case_check(&query, t);
}

static void check_normal(const struct eng_query *query, double t, const float normal[3],
                         const float param[2])
{
    struct eng_hit hit;
    case_check(query, t);
    assert_true(eng_solve(query, 1e-6, 1, case_exact(), &hit));
    for (int k = 0; k < 3; k++) {
        assert_true(fabsf(hit.normal[k] - normal[k]) < 1e-6f);
    }
    assert_true(fabsf(hit.param[0] - param[0]) < 1e-5f);
    assert_true(fabsf(hit.param[1] - param[1]) < 1e-5f);
}

/* If it failed: the plainest contact would have a wrong time, place or side. */
CASE(solve__plain_hits_have_time_place_and_side)
{
    const float up[3] = {0, 0, 1};
    const float down[3] = {0, 0, -1};
    struct eng_query fall = vertex_path(POINT(0.25, 0.5, 3), POINT(0.25, 0.5, -1));
    struct eng_query rise = vertex_path(POINT(0.25, 0.5, -1), POINT(0.25, 0.5, 3));
    check_normal(&fall, 0.75, up, (const float[2]){0.25f, 0.5f});
    check_normal(&rise, 0.25, down, (const float[2]){0.25f, 0.5f});
    /* From second to first: the edge that stands is first, the falling one is above
     * it. */
    struct eng_query bar =
        against_bar(POINT(0.5, -1, 3), POINT(0.5, 3, 3), POINT(0, 0, -4));
    check_normal(&bar, 0.75, down, (const float[2]){0.25f, 0.25f});
    struct eng_query other = case_order(&bar, 1);
    check_normal(&other, 0.75, up, (const float[2]){0.25f, 0.25f});
}

/* If it failed: features that pass beside each other would be called contacts. */
CASE(solve__plain_misses_are_misses)
{
    check_path(CASE_MISS, POINT(0.75, 0.75, 3), POINT(0.75, 0.75, -1));
    check_path(CASE_MISS, POINT(-0.25, 0.5, 3), POINT(-0.25, 0.5, -1));
    check_path(CASE_MISS, POINT(0.25, 0.25, 3), POINT(0.25, 0.25, 0.125));
    check_path(CASE_MISS, POINT(0.25, 0.25, 1), POINT(0.25, 0.25, 1)); /* at rest */
    check_bar(CASE_MISS, POINT(3, -1, 3), POINT(3, 1, 3), POINT(0, 0, -4));
    check_bar(CASE_MISS, POINT(1, 1, 3), POINT(1, 2, 3), POINT(0, 0, -4));
    check_bar(CASE_MISS, POINT(1, -1, 3), POINT(1, 1, 3), POINT(0, 0, -2));
}

/* If it failed: boundaries of a feature would not belong to it, or reach beyond it. */
CASE(solve__closed_boundaries_count_and_one_ulp_does_not)
{
    check_path(0.75, POINT(0, 0, 3), POINT(0, 0, -1));
    check_path(0.75, POINT(0, 1, 3), POINT(0, 1, -1));
    check_path(0.75, POINT(0.5, 0.5, 3), POINT(0.5, 0.5, -1));
    check_path(0.75, POINT(0.5, 0, 3), POINT(0.5, 0, -1));
    check_path(CASE_MISS, POINT(0.5, 0.5 + ULP, 3), POINT(0.5, 0.5 + ULP, -1));
    check_path(CASE_MISS, POINT(0.5, -0x1p-100, 3), POINT(0.5, -0x1p-100, -1));
    check_path(CASE_MISS, POINT(1 + ULP, 0, 3), POINT(1 + ULP, 0, -1));
    check_bar(0.75, POINT(0, -1, 3), POINT(0, 1, 3), POINT(0, 0, -4));
    check_bar(0.75, POINT(1, 0, 3), POINT(1, 1, 3), POINT(0, 0, -4));
    check_bar(0.75, POINT(2, 0, 3), POINT(3, 0, 3), POINT(0, 0, -4));
    check_bar(CASE_MISS, POINT(1, 0x1p-100, 3), POINT(1, 1, 3), POINT(0, 0, -4));
    check_bar(CASE_MISS, POINT(-0x1p-100, -1, 3), POINT(-0x1p-100, 1, 3),
              POINT(0, 0, -4));
}

/* If it failed: a step that begins in contact would not say so. */
CASE(solve__touch_at_the_start_is_initial)
{
    check_path(0, POINT(0.25, 0.25, 0), POINT(0.25, 0.25, 1));
    check_path(0, POINT(0.25, 0.25, 0), POINT(0.25, 0.25, 0));
    check_path(0, POINT(0.25, 0.25, 0), POINT(0.5, 0.25, 0));
    check_path(0, POINT(0, 0, 0), POINT(-1, -1, 0));
    check_path(0, POINT(0.5, 0.5, 0), POINT(1, 1, 1));
    check_bar(0, POINT(1, -1, 0), POINT(1, 1, 0), POINT(0, 0, 1));
    check_bar(0, POINT(2, 0, 0), POINT(2, 1, 0), POINT(1, 0, 0));
    check_bar(0, POINT(1, 0, 0), POINT(5, 0, 0), POINT(0, 0, 0));
}

/* If it failed: a contact at the very end would belong to no step at all. */
CASE(solve__touch_at_the_end_is_found)
{
    check_path(1, POINT(0.25, 0.25, 1), POINT(0.25, 0.25, 0));
    check_path(1, POINT(0.75, 0.75, 1), POINT(0, 0, 0));
    check_path(1, POINT(-1, 0.5, 0), POINT(0, 0.5, 0)); /* in the plane */
    check_path(CASE_MISS, POINT(0.25, 0.25, 1), POINT(0.25, 0.25, 0x1p-60));
    check_path(CASE_MISS, POINT(-1, 0.5, 0), POINT(-0x1p-60, 0.5, 0));
    check_bar(1, POINT(1, -1, 1), POINT(1, 1, 1), POINT(0, 0, -1));
    check_bar(1, POINT(1, 1, 0), POINT(1, 2, 0), POINT(0, -1, 0));
    check_bar(1, POINT(3, 0, 0), POINT(4, 0, 0), POINT(-1, 0, 0));
    check_bar(CASE_MISS, POINT(1, -1, 1), POINT(1, 1, 1), POINT(0, 0, -1 + 0x1p-53));
}

/* If it failed: a contact without passing through would be lost, or one invented. */
CASE(solve__double_roots_are_told_from_near_ones)
{
    for (enum pccd_kind kind = PCCD_VF; kind <= PCCD_EE; kind++) {
        struct eng_query graze = parabola(kind, 0, 0.25, 0.25);
        struct eng_query over = parabola(kind, 0x1p-50, 0.25, 0.25);
        struct eng_query under = parabola(kind, -0x1p-50, 0.25, 0.25);
        struct eng_query beside = parabola(kind, 0, -0.25, -0.25);
        case_check(&graze, 0.5);
        case_check(&over, CASE_MISS);
        case_check(&under, 0.5 - 0x1p-25);
        case_check(&beside, CASE_MISS);
    }
}

/* If it failed: the second crossing would be reported as the first contact. */
CASE(solve__the_first_of_two_crossings_counts)
{
    for (enum pccd_kind kind = PCCD_VF; kind <= PCCD_EE; kind++) {
        /* (t - 1/4)(t - 3/4): both inside, only the second inside, none. */
        struct eng_query both = parabola(kind, -0.0625, 0.125, 0.125);
        struct eng_query second = parabola(kind, -0.0625, -0.25, 0.25);
        struct eng_query none = parabola(kind, -0.0625, -0.5, -0.25);
        case_check(&both, 0.25);
        case_check(&second, 0.75);
        case_check(&none, CASE_MISS);
    }
}

/* If it failed: motion within one plane, as of cloth on a table, would be undecided. */
CASE(solve__coplanar_motion_is_decided)
{
    check_path(0.5, POINT(-1, 0.25, 0), POINT(1, 0.25, 0));
    check_path(0.25, POINT(-1, 0.25, 0), POINT(3, 0.25, 0));
    check_path(CASE_MISS, POINT(-1, -0.5, 0), POINT(1, -0.5, 0));
    check_path(0.5, POINT(-1, 1, 0), POINT(1, 1, 0)); /* past a corner, touching */
    check_path(CASE_MISS, POINT(-1, 1 + ULP, 0), POINT(1, 1 + ULP, 0));
    check_path(0.5, POINT(3, -2, 0), POINT(-1, 2, 0)); /* in line with the long side */
    check_path(0.25, POINT(1.5, -0.5, 0), POINT(-0.5, 1.5, 0));
    check_bar(0.25, POINT(1, 1, 0), POINT(1, 2, 0), POINT(0, -4, 0));
    check_bar(CASE_MISS, POINT(3, 1, 0), POINT(3, 2, 0), POINT(0, -4, 0));
    check_bar(0.5, POINT(4, 0, 0), POINT(5, 0, 0), POINT(-4, 0, 0)); /* on one line */
    check_bar(CASE_MISS, POINT(4, 0, 0), POINT(5, 0, 0), POINT(-1, 0, 0));
}

/* If it failed: collapsed faces would be skipped, or hit everything. */
CASE(solve__collapsed_faces_are_what_is_left_of_them)
{
    const double segment0[4][3] = {{1.5, 0, 1}, {0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
    const double segment1[4][3] = {{1.5, 0, -1}, {0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
    const double at_point0[4][3] = {{0, 0, 0}, {1, 1, 1}, {1, 1, 1}, {1, 1, 1}};
    const double at_point1[4][3] = {{2, 2, 2}, {1, 1, 1}, {1, 1, 1}, {1, 1, 1}};
    const double closing0[4][3] = {{0.25, 0, 1}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    const double closing1[4][3] = {{0.25, 0, -1}, {0, 0, 0}, {1, 0, 0}, {0, -1, 0}};
    struct eng_query query = case_query(PCCD_VF, segment0, segment1);
    case_check(&query, 0.5);
    query.x[0][0][0] = query.x[1][0][0] = 2.5; /* beyond its end */
    case_check(&query, CASE_MISS);
    query.x[0][0][0] = query.x[1][0][0] = 1.5;
    query.x[0][0][1] = query.x[1][0][1] = 0x1p-80; /* beside it */
    case_check(&query, CASE_MISS);
    query = case_query(PCCD_VF, at_point0, at_point1);
    case_check(&query, 0.5);
    query.x[1][0][2] = 2 + 2 * ULP;
    case_check(&query, CASE_MISS);
    query = case_query(PCCD_VF, closing0, closing1); /* a segment at the very moment */
    case_check(&query, 0.5);
    query.x[0][0][0] = query.x[1][0][0] = -0.25;
    case_check(&query, CASE_MISS);
}

/* If it failed: edges without length or direction would be skipped, or hit everything. */
CASE(solve__collapsed_and_parallel_edges_are_decided)
{
    const double meet0[4][3] = {{0, 0, 0}, {0, 0, 0}, {2, 4, 8}, {2, 4, 8}};
    const double meet1[4][3] = {{4, 8, 16}, {4, 8, 16}, {2, 4, 8}, {2, 4, 8}};
    check_bar(0.5, POINT(1, 0, 1), POINT(1, 0, 1), POINT(0, 0, -2));
    check_bar(0.5, POINT(2, 0, 1), POINT(2, 0, 1), POINT(0, 0, -2));
    check_bar(CASE_MISS, POINT(2 + 2 * ULP, 0, 1), POINT(2 + 2 * ULP, 0, 1),
              POINT(0, 0, -2));
    check_bar(CASE_MISS, POINT(1, 0x1p-80, 1), POINT(1, 0x1p-80, 1), POINT(0, 0, -2));
    struct eng_query points = edges(meet0, meet1);
    case_check(&points, 0.5);
    points.x[1][2][0] = points.x[1][3][0] = 2.25;
    case_check(&points, CASE_MISS);
    check_bar(0.5, POINT(1, 0, 1), POINT(3, 0, 1), POINT(0, 0, -2)); /* overlapping */
    check_bar(0.5, POINT(0, 0, 1), POINT(2, 0, 1), POINT(0, 0, -2)); /* the same */
    check_bar(0.5, POINT(2, 0, 1), POINT(4, 0, 1), POINT(0, 0, -2)); /* end to end */
    check_bar(CASE_MISS, POINT(3, 0, 1), POINT(5, 0, 1), POINT(0, 0, -2));
    check_bar(CASE_MISS, POINT(2 + 2 * ULP, 0, 1), POINT(4, 0, 1), POINT(0, 0, -2));
    check_bar(CASE_MISS, POINT(0, 0, 1), POINT(2, 0, 1), POINT(0, 0, 0));
}

/* If it failed: an exactly known contact would be missed, or reported too late. */
CASE(solve__planted_contacts_are_never_missed_nor_late)
{
    struct prng random = {60};
    for (int round = 0; round < 20000; round++) {
        struct eng_query query;
        struct eng_hit hit;
        unsigned eighths = prng_u32(&random, 9);
        kit_plant(&random, round % 2 ? PCCD_EE : PCCD_VF, eighths, &query);
        assert_true(eng_solve(&query, 1e-6, 1, case_exact(), &hit));
        case_check_form(&query, 1e-6, &hit);
        assert_true(hit.toi <= eighths / 8.0);
    }
}

/* Points on a coarse grid: most queries are degenerate, coplanar or just touching. */
static struct eng_query grid_query(struct prng *random, enum pccd_kind kind,
                                   uint32_t bound)
{
    struct eng_query query = {.kind = kind};
    for (int i = 0; i < 24; i++) {
        query.x[i / 12][i / 3 % 4][i % 3] = prng_integer(random, bound);
    }
    return query;
}

/* If it failed: the answer would depend on which end, corner or direction comes first, or
 * there would be a contact before the time that is called the first. */
CASE(solve__answers_agree_from_every_side)
{
    struct prng random = {61};
    int hits = 0;
    enum { ROUNDS = 3000 };
    for (int round = 0; round < ROUNDS; round++) {
        enum pccd_kind kind = round % 2 ? PCCD_EE : PCCD_VF;
        struct eng_query query = grid_query(&random, kind, 1 + (uint32_t)round % 3);
        struct eng_query back = case_reversed(&query);
        struct eng_hit hit;
        struct eng_hit other;
        bool found = eng_solve(&query, 1e-6, 1, case_exact(), &hit);
        assert_int_equal(eng_solve(&back, 1e-6, 1, case_exact(), &other), found);
        assert_int_equal(eng_exact_meets(case_exact(), &query, 0, 1), found);
        for (unsigned order = 1; order < case_order_count(kind); order++) {
            struct eng_query same = case_order(&query, order);
            assert_int_equal(eng_solve(&same, 1e-6, 1, case_exact(), &other), found);
            assert_true(!found || (other.toi <= hit.toi_hi && hit.toi <= other.toi_hi));
        }
        if (found) {
            case_check_form(&query, 1e-6, &hit);
            hits++;
        }
        if (found && hit.toi > 0) {
            assert_false(eng_exact_meets(case_exact(), &query, 0, nextafter(hit.toi, 0)));
            assert_true(eng_exact_meets(case_exact(), &query, hit.toi, hit.toi_hi));
        }
    }
    assert_in_range(hits, ROUNDS / 20, ROUNDS - ROUNDS / 20);
}

/* If it failed: mode first would give other bytes than mode all for the same contact. */
CASE(solve__end_time_decides_whether_not_what)
{
    struct prng random = {62};
    for (int round = 0; round < 6000; round++) {
        enum pccd_kind kind = round % 2 ? PCCD_EE : PCCD_VF;
        struct eng_query query;
        struct eng_hit hit;
        struct eng_hit other;
        if (round % 4 < 2) {
            kit_plant(&random, kind, 1 + prng_u32(&random, 8), &query);
        } else {
            query = grid_query(&random, kind, 2);
        }
        memset(&hit, 0, sizeof hit);
        if (!eng_solve(&query, 1e-6, 1, case_exact(), &hit)) {
            assert_false(eng_solve(&query, 1e-6, 0.5, case_exact(), &other));
            continue;
        }
        const double ends[] = {hit.toi, hit.toi_hi, 0.5 * (1 + hit.toi)};
        for (int i = 0; i < 3; i++) {
            memset(&other, 0, sizeof other);
            assert_true(eng_solve(&query, 1e-6, ends[i], case_exact(), &other));
            assert_memory_equal(&other, &hit, sizeof hit);
        }
        if (hit.toi > 0) {
            const double early[] = {nextafter(hit.toi, 0), 0.5 * hit.toi, 0};
            for (int i = 0; i < 3; i++) {
                assert_false(eng_solve(&query, 1e-6, early[i], case_exact(), &other));
            }
        }
    }
}

/* If it failed: an early contact would be found up to the end of the step, but not up to
 * its own time: its bracket begins before the span in which it is proved. */
CASE(solve__a_bracket_may_begin_before_its_span)
{
    const struct eng_query query = {
        PCCD_EE,
        {{{-0x1.00ae931497bb9p+0, 0x1.9c6a1e5ce8cffp-1, -0x1.86a5af2c0eeep-4},
          {-0x1.555c52c0afe58p-1, 0x1.046b04294f965p-1, 0x1.03e7540ba2fb2p+0},
          {-0x1.4bfea0853b20cp-1, 0x1.2c709b2589042p-1, 0x1.80cff48c6a7bp-1},
          {-0x1.64b21990ef20cp-1, 0x1.1186bd019281p-1, 0x1.d6a1e0f8a1e16p-1}},
         {{-0x1.bb637e00f31e3p-1, -0x1.10674c910aeccp-1, 0x1.2d1dda545bef6p+0},
          {-0x1.0f9ae0fa1d82bp-1, -0x1.a86eaff56c185p-1, 0x1.24a89c074bdf2p+1},
          {-0x1.06500ef0660cp-1, -0x1.8089b64220b3ep-1, 0x1.02e445c5007dfp+1},
          {-0x1.1eaa7f8c74446p-1, -0x1.9b69ef4f106dfp-1, 0x1.186ba565018bdp+1}}}};
    struct eng_hit whole;
    struct eng_hit early;
    assert_true(eng_solve(&query, 1e-12, 1, case_exact(), &whole));
    assert_true(eng_solve(&query, 1e-12, whole.toi, case_exact(), &early));
    assert_true(early.toi == whole.toi && early.toi_hi == whole.toi_hi);
}

/* If it failed: a vertex projected onto a surface in the last step, and so coplanar with
 * it up to rounding, would be pushed out on the wrong side. */
CASE(solve__normal_names_the_exact_side_at_the_start)
{
    struct prng random = {311};
    uint32_t looked_at = 0;
    for (int i = 0; i < 3000; i++) {
        struct eng_query query = {.kind = PCCD_VF};
        double b[3];
        double c[3];
        double n[3];
        for (int k = 0; k < 9; k++) {
            double x = prng_between(&random, -1, 1);
            query.x[0][1 + k / 3][k % 3] = x;
            query.x[1][1 + k / 3][k % 3] = x;
        }
        eng_sub(b, query.x[0][2], query.x[0][1]);
        eng_sub(c, query.x[0][3], query.x[0][1]);
        eng_cross(n, b, c);
        for (int k = 0; k < 3; k++) {
            query.x[0][0][k] = query.x[0][1][k] + 0.3 * b[k] + 0.3 * c[k];
        }
        int side = eng_exact_moment(case_exact(), &query, 0).side;
        for (int k = 0; k < 3; k++) {
            query.x[1][0][k] = query.x[0][0][k] - side * n[k];
        }
        struct eng_hit hit;
        if (side == 0) {
            continue;
        }
        assert_true(eng_solve(&query, 1e-6, 1, case_exact(), &hit));
        double along = 0;
        for (int k = 0; k < 3; k++) {
            along += (double)hit.normal[k] * n[k];
        }
        assert_true(along * side > 0);
        looked_at++;
    }
    assert_true(looked_at > 1000);
}

CASES_WITH(NULL, case_end);
