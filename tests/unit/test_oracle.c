/* test_oracle.c - the exact oracle on cases that were worked out by hand. */
#include "cases.h"
#include "oracle_scene.h"
#include "prng.h"

typedef const double (*points_t)[3];

/* A vertex that moves against the triangle (0,0,0) (4,0,0) (0,4,0) at rest. */
#define VERTEX_TO_FLOOR(x0, y0, z0, x1, y1, z1)                                          \
    {                                                                                    \
        {x0, y0, z0}, {0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {x1, y1, z1}, {0, 0, 0},          \
            {4, 0, 0},                                                                   \
        {                                                                                \
            0, 4, 0                                                                      \
        }                                                                                \
    }

/* Truth that is expected of one query: contact or none, its first time as a fraction. */
struct expected {
    bool hits;
    long numerator;
    unsigned long denominator;
};

static const struct expected never = {false, 0, 1};

static void expect(enum oracle_kind kind, const double p[8][3], struct expected expected)
{
    mpq_t lo;
    mpq_t hi;
    mpq_t time;
    mpq_inits(lo, hi, time, NULL);
    bool hits = oracle_first_contact(kind, p, 0x1p-80, lo, hi);
    assert_int_equal(hits, expected.hits);
    assert_int_equal(kind == ORACLE_VF ? oracle_vf(p) : oracle_ee(p), expected.hits);
    if (hits) {
        mpq_set_si(time, expected.numerator, expected.denominator);
        mpq_canonicalize(time);
        assert_true(mpq_cmp(lo, time) <= 0);
        assert_true(mpq_cmp(time, hi) <= 0);
        mpq_sub(hi, hi, lo);
        assert_true(mpq_get_d(hi) <= 0x1p-80);
        /* At that moment there is a contact, and none in the first 1023/1024 of the
         * way. */
        assert_true(oracle_contact_in(kind, p, time, time));
        if (mpq_sgn(time) > 0) {
            mpq_set_ui(lo, 0, 1);
            mpq_set_ui(hi, 1023, 1024);
            mpq_mul(hi, hi, time);
            assert_false(oracle_contact_in(kind, p, lo, hi));
        }
    }
    mpq_clears(lo, hi, time, NULL);
}

static struct expected at(long numerator, unsigned long denominator)
{
    return (struct expected){true, numerator, denominator};
}

/* If this failed, the plainest contact would be missed or late. */
CASE(oracle_vf__finds_a_vertex_that_falls_through_a_face)
{
    const double half[8][3] = VERTEX_TO_FLOOR(1, 1, 1, 1, 1, -1);
    const double third[8][3] = VERTEX_TO_FLOOR(1, 1, 1, 1, 1, -2);
    const double beside[8][3] = VERTEX_TO_FLOOR(3, 3, 1, 3, 3, -1);
    expect(ORACLE_VF, half, at(1, 2));
    expect(ORACLE_VF, third, at(1, 3));
    expect(ORACLE_VF, beside, never);
}

/* If this failed, the closed end of the step or of a face would be treated as open. */
CASE(oracle_vf__counts_touching_at_the_very_end)
{
    const double inside[8][3] = VERTEX_TO_FLOOR(1, 1, 1, 1, 1, 0);
    const double on_edge[8][3] = VERTEX_TO_FLOOR(2, 2, 1, 2, 2, 0);
    const double on_corner[8][3] = VERTEX_TO_FLOOR(4, 0, 1, 4, 0, 0);
    const double above[8][3] = VERTEX_TO_FLOOR(1, 1, 1, 1, 1, 0x1p-1074);
    const double outside[8][3] = VERTEX_TO_FLOOR(2, 2, 1, 2, 2 + 0x1p-51, 0);
    expect(ORACLE_VF, inside, at(1, 1));
    expect(ORACLE_VF, on_edge, at(1, 1));
    expect(ORACLE_VF, on_corner, at(1, 1));
    expect(ORACLE_VF, above, never);
    expect(ORACLE_VF, outside, never);
    assert_true(oracle_touching_at(ORACLE_VF, inside, 1));
    assert_false(oracle_touching_at(ORACLE_VF, inside, 0));
    assert_false(oracle_touching_at(ORACLE_VF, above, 1));
}

/* If this failed, contacts that are there from the start or never go away would be
 * lost. */
CASE(oracle_vf__counts_static_touching)
{
    const double rest[8][3] = VERTEX_TO_FLOOR(1, 1, 0, 1, 1, 0);
    const double leaves[8][3] = VERTEX_TO_FLOOR(1, 1, 0, 1, 1, 1);
    const double apart[8][3] = VERTEX_TO_FLOOR(1, 1, 1, 1, 1, 1);
    expect(ORACLE_VF, rest, at(0, 1));
    expect(ORACLE_VF, leaves, at(0, 1));
    expect(ORACLE_VF, apart, never);
    assert_true(oracle_touching_at(ORACLE_VF, leaves, 0));
    assert_false(oracle_touching_at(ORACLE_VF, leaves, 1));
}

/* If this failed, a double root of the cubic would be taken for none. */
CASE(oracle_vf__finds_a_graze)
{
    /* The vertex (t, 0, 1/4) is (t - 1/2)^2 above the plane z = (1 - t) x. */
    const double graze[8][3] = {{0, 0, 0.25}, {-8, -8, -8}, {8, -8, 8}, {0, 8, 0},
                                {1, 0, 0.25}, {-8, -8, 0},  {8, -8, 0}, {0, 8, 0}};
    double miss[8][3];
    memcpy(miss, graze, sizeof miss);
    expect(ORACLE_VF, graze, at(1, 2));
    miss[0][2] = miss[4][2] = 0.25 + 0x1p-52;
    expect(ORACLE_VF, (points_t)miss, never);
}

/* If this failed, motion within one plane would be judged by the vanishing cubic. */
CASE(oracle_vf__follows_coplanar_motion)
{
    const double slides_in[8][3] = VERTEX_TO_FLOOR(-1, 1, 0, 1, 1, 0);
    const double slides_past[8][3] = VERTEX_TO_FLOOR(5, 0, 0, 0, 5, 0);
    const double slides_along_edge[8][3] = VERTEX_TO_FLOOR(-3, 0, 0, 5, 0, 0);
    const double corner_only[8][3] = VERTEX_TO_FLOOR(-1, 3, 0, 1, 5, 0);
    const double starts_inside[8][3] = VERTEX_TO_FLOOR(1, 1, 0, 9, 9, 0);
    expect(ORACLE_VF, slides_in, at(1, 2));
    expect(ORACLE_VF, slides_past, never);
    expect(ORACLE_VF, slides_along_edge, at(3, 8));
    expect(ORACLE_VF, corner_only, at(1, 2));
    expect(ORACLE_VF, starts_inside, at(0, 1));
}

/* If this failed, a face without area would be transparent or would have one. */
CASE(oracle_vf__sees_a_face_without_area)
{
    /* The face is the segment from (0,0,0) to (4,0,0), its third corner in the middle. */
    const double hit[8][3] = {{1, 0, 1},  {0, 0, 0}, {4, 0, 0}, {2, 0, 0},
                              {1, 0, -2}, {0, 0, 0}, {4, 0, 0}, {2, 0, 0}};
    const double beside[8][3] = {{1, 1, 1},  {0, 0, 0}, {4, 0, 0}, {2, 0, 0},
                                 {1, 1, -2}, {0, 0, 0}, {4, 0, 0}, {2, 0, 0}};
    /* The face is a point that the vertex runs through. */
    const double point[8][3] = {{0, 0, 0}, {1, 2, 3}, {1, 2, 3}, {1, 2, 3},
                                {3, 6, 9}, {1, 2, 3}, {1, 2, 3}, {1, 2, 3}};
    /* The vertex is on a side of the face all the time, while the face turns over. */
    const double flat[8][3] = {{1, 0, 0}, {0, 0, 0}, {4, 0, 0}, {2, 1, 1},
                               {1, 0, 0}, {0, 0, 0}, {4, 0, 0}, {2, -1, 1}};
    /* The face loses its area at t = 1/2, just when the vertex goes through its plane. */
    const double closes[8][3] = {{1, 0, -1}, {0, 0, 0}, {4, 0, 0}, {2, 1, 0},
                                 {1, 0, 1},  {0, 0, 0}, {4, 0, 0}, {2, -1, 0}};
    expect(ORACLE_VF, hit, at(1, 3));
    expect(ORACLE_VF, beside, never);
    expect(ORACLE_VF, point, at(1, 3));
    expect(ORACLE_VF, flat, at(0, 1));
    expect(ORACLE_VF, closes, at(1, 2));
}

/* If this failed, points that coincide for ever, or never, would be confused. */
CASE(oracle_vf__compares_identical_points)
{
    const double same[8][3] = {{1, 2, 3}, {1, 2, 3}, {1, 2, 3}, {1, 2, 3},
                               {5, 6, 7}, {5, 6, 7}, {5, 6, 7}, {5, 6, 7}};
    const double parallel[8][3] = {{1, 2, 3}, {1, 2, 4}, {1, 2, 4}, {1, 2, 4},
                                   {5, 6, 7}, {5, 6, 8}, {5, 6, 8}, {5, 6, 8}};
    expect(ORACLE_VF, same, at(0, 1));
    expect(ORACLE_EE, same, at(0, 1));
    expect(ORACLE_VF, parallel, never);
    expect(ORACLE_EE, parallel,
           at(0, 1)); /* the second edge is a point of the first's end */
}

/* If this failed, the plainest contact of edges would be missed or late. */
CASE(oracle_ee__finds_edges_that_cross)
{
    const double cross[8][3] = {{-1, 0, 1},  {1, 0, 1},  {0, -1, 0}, {0, 1, 0},
                                {-1, 0, -4}, {1, 0, -4}, {0, -1, 0}, {0, 1, 0}};
    const double ends[8][3] = {{0, 0, 1},  {1, 0, 1},  {0, 0, 0}, {0, 1, 0},
                               {0, 0, -1}, {1, 0, -1}, {0, 0, 0}, {0, 1, 0}};
    const double short_of[8][3] = {{0x1p-1074, 0, 1},  {1, 0, 1},  {0, 0, 0}, {0, 1, 0},
                                   {0x1p-1074, 0, -1}, {1, 0, -1}, {0, 0, 0}, {0, 1, 0}};
    expect(ORACLE_EE, cross, at(1, 5));
    expect(ORACLE_EE, ends, at(1, 2));
    expect(ORACLE_EE, short_of, never);
}

/* If this failed, parallel edges, whose normal vanishes, would be judged by it. */
CASE(oracle_ee__compares_parallel_edges)
{
    const double overlap[8][3] = {{0, 0, 1},  {4, 0, 1},  {1, 0, 0}, {9, 0, 0},
                                  {0, 0, -2}, {4, 0, -2}, {1, 0, 0}, {9, 0, 0}};
    const double apart[8][3] = {{0, 0, 1},  {4, 0, 1},  {5, 0, 0}, {9, 0, 0},
                                {0, 0, -2}, {4, 0, -2}, {5, 0, 0}, {9, 0, 0}};
    const double collinear[8][3] = {{0, 0, 0}, {1, 0, 0}, {3, 0, 0}, {4, 0, 0},
                                    {0, 0, 0}, {1, 0, 0}, {0, 0, 0}, {1, 0, 0}};
    const double collinear_away[8][3] = {{0, 0, 0}, {1, 0, 0}, {3, 0, 0}, {4, 0, 0},
                                         {0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {9, 0, 0}};
    const double passes[8][3] = {{0, 0, 0}, {1, 0, 0}, {-3, 0, 0}, {-2, 0, 0},
                                 {0, 0, 0}, {1, 0, 0}, {7, 0, 0},  {8, 0, 0}};
    expect(ORACLE_EE, overlap, at(1, 3));
    expect(ORACLE_EE, apart, never);
    expect(ORACLE_EE, collinear, at(2, 3));
    expect(ORACLE_EE, collinear_away, never);
    expect(ORACLE_EE, passes, at(1, 5));
}

/* If this failed, an edge that has shrunk to a point would be transparent or thick. */
CASE(oracle_ee__sees_an_edge_without_length)
{
    const double hit[8][3] = {{0, 0, 0}, {4, 0, 0}, {1, 0, 1},  {1, 0, 1},
                              {0, 0, 0}, {4, 0, 0}, {1, 0, -1}, {1, 0, -1}};
    const double beside[8][3] = {{0, 0, 0}, {4, 0, 0}, {5, 0, 1},  {5, 0, 1},
                                 {0, 0, 0}, {4, 0, 0}, {5, 0, -1}, {5, 0, -1}};
    const double points[8][3] = {{0, 0, 0}, {0, 0, 0}, {-1, -2, -3}, {-1, -2, -3},
                                 {0, 0, 0}, {0, 0, 0}, {3, 6, 9},    {3, 6, 9}};
    const double points_miss[8][3] = {{0, 0, 0}, {0, 0, 0}, {-1, -2, -3}, {-1, -2, -3},
                                      {0, 0, 0}, {0, 0, 0}, {3, 6, 8},    {3, 6, 8}};
    expect(ORACLE_EE, hit, at(1, 2));
    expect(ORACLE_EE, beside, never);
    expect(ORACLE_EE, points, at(1, 4));
    expect(ORACLE_EE, points_miss, never);
}

/* If this failed, edges that slide in a common plane would be judged by the cubic. */
CASE(oracle_ee__follows_coplanar_motion)
{
    const double slides_in[8][3] = {{0, -1, 0}, {0, 1, 0}, {3, 0, 0},  {5, 0, 0},
                                    {0, -1, 0}, {0, 1, 0}, {-2, 0, 0}, {0, 0, 0}};
    const double slides_past[8][3] = {{0, -1, 0}, {0, 1, 0}, {1, 2, 0},  {5, 2, 0},
                                      {0, -1, 0}, {0, 1, 0}, {-5, 2, 0}, {-1, 2, 0}};
    const double starts_crossed[8][3] = {{0, -1, 0}, {0, 1, 0}, {-1, 0, 0}, {1, 0, 0},
                                         {0, -1, 0}, {0, 1, 0}, {7, 0, 0},  {9, 0, 0}};
    expect(ORACLE_EE, slides_in, at(3, 5));
    expect(ORACLE_EE, slides_past, never);
    expect(ORACLE_EE, starts_crossed, at(0, 1));
}

/* If this failed, an irrational time would be compared with a double as if it were
 * one. */
CASE(oracle_first__compares_irrational_times)
{
    /* The vertex (t, 0, 1/2) under the plane z = t x: contact where t^2 = 1/2. */
    const double p[8][3] = {{0, 0, 0.5}, {-8, -8, 0},  {8, -8, 0}, {0, 8, 0},
                            {1, 0, 0.5}, {-8, -8, -8}, {8, -8, 8}, {0, 8, 0}};
    struct oracle_first *first = oracle_first_new(ORACLE_VF, p);
    double root = 0.70710678118654752;
    double above = root * root > 0.5 ? root : nextafter(root, 1);
    assert_non_null(first);
    assert_int_equal(oracle_first_compare(first, nextafter(above, 0)), 1);
    assert_int_equal(oracle_first_compare(first, above), -1);
    assert_int_equal(oracle_first_compare(first, 0), 1);
    assert_int_equal(oracle_first_compare(first, 1), -1);
    oracle_first_free(first);
}

/* If this failed, an exact time would not be equal to itself. */
CASE(oracle_first__is_equal_to_an_exact_time)
{
    const double p[8][3] = VERTEX_TO_FLOOR(1, 1, 3, 1, 1, -5);
    struct oracle_first *first = oracle_first_new(ORACLE_VF, p);
    assert_non_null(first);
    assert_int_equal(oracle_first_compare(first, 0.375), 0);
    assert_int_equal(oracle_first_compare(first, nextafter(0.375, 0)), 1);
    assert_int_equal(oracle_first_compare(first, nextafter(0.375, 1)), -1);
    oracle_first_free(first);
}

static void random_query(struct prng *prng, double p[8][3])
{
    uint64_t side = 1 + prng_below(prng, 4);
    uint64_t style = prng_below(prng, 4);
    for (int k = 0; k < 24; k++) {
        p[k / 3][k % 3] = (double)prng_below(prng, 2 * side + 1) - (double)side;
        if (style == 1 && k % 3 == 2) {
            p[k / 3][2] = 0;
        } else if (style == 2 && k >= 12 && prng_below(prng, 2)) {
            p[k / 3][k % 3] = p[k / 3 - 4][k % 3];
        } else if (style == 3) {
            p[k / 3][k % 3] += 0x1p-20 * (double)prng_below(prng, 3);
        }
    }
}

/* If this failed, the two ways to an answer (the first contact of the whole step; the
 * motion cut at a time and put together again) would disagree somewhere on degenerate
 * input. */
CASE(oracle__answers_parts_like_the_whole)
{
    struct prng prng = {prng_seed()};
    mpq_t zero;
    mpq_t cut;
    mpq_t one;
    print_message("# PCCD_SEED=%llu\n", (unsigned long long)prng.state);
    mpq_inits(zero, cut, one, NULL);
    mpq_set_ui(one, 1, 1);
    for (int i = 0; i < 4000; i++) {
        enum oracle_kind kind = prng_below(&prng, 2) ? ORACLE_EE : ORACLE_VF;
        double moving[8][3];
        random_query(&prng, moving);
        points_t p = (points_t)moving;
        uint64_t below = 2 + prng_below(&prng, 8);
        double t = (double)(1 + prng_below(&prng, 15)) / 16;
        mpq_set_ui(cut, 1 + prng_below(&prng, below - 1), below);
        mpq_canonicalize(cut);
        bool whole = oracle_hits(kind, p);
        bool early = oracle_contact_in(kind, p, zero, cut);
        bool late = oracle_contact_in(kind, p, cut, one);
        assert_int_equal(whole, early || late);
        assert_int_equal(whole, oracle_contact_in(kind, p, zero, one));
        assert_int_equal(oracle_touching_at(kind, p, 0),
                         oracle_contact_in(kind, p, zero, zero));
        assert_int_equal(oracle_touching_at(kind, p, 1),
                         oracle_contact_in(kind, p, one, one));
        struct oracle_first *first = oracle_first_new(kind, p);
        mpq_set_d(cut, t);
        assert_int_equal(first && oracle_first_compare(first, t) <= 0,
                         oracle_contact_in(kind, p, zero, cut));
        oracle_first_free(first);
    }
    mpq_clears(zero, cut, one, NULL);
}

/* If this failed, brute force would pass over a pair, test neighbours, or misname
 * edges. */
CASE(oracle_scene__lists_every_pair_once)
{
    /* A triangle pierced by an edge of a second one; vertex 6 is in no triangle. */
    const double x[7][3] = {{0, 0, 0},  {4, 0, 0}, {0, 4, 0}, {1, 1, 1},
                            {1, 1, -1}, {9, 9, 0}, {1, 1, 0}};
    const uint32_t triangles[2][3] = {{0, 1, 2}, {3, 4, 5}};
    struct oracle_object object = {.object_id = 7,
                                   .vertex_count = 7,
                                   .triangle_count = 2,
                                   .x0 = x,
                                   .x1 = x,
                                   .triangles = triangles};
    struct oracle_contacts contacts;
    uint32_t count;
    uint32_t(*edges)[2] = oracle_edges(&object, &count);
    const uint32_t expected[6][2] = {{0, 1}, {0, 2}, {1, 2}, {3, 4}, {3, 5}, {4, 5}};
    assert_int_equal(count, 6);
    assert_memory_equal(edges, expected, sizeof expected);
    free(edges);
    /* Edge 3-5 passes over the face; nothing touches but edge 3-4 through its inside,
     * which is neither VF nor EE. Moved so that vertex 4 starts on the face and 3-4
     * leaves it. */
    oracle_scene(&object, 1, &contacts);
    assert_int_equal(contacts.count, 0);
    oracle_contacts_deinit(&contacts);
    double y[7][3];
    memcpy(y, x, sizeof y);
    y[4][2] = 1;
    object.x1 = (points_t)y;
    oracle_scene(&object, 1, &contacts);
    assert_int_equal(contacts.count, 2);
    const struct oracle_pair vertex_meets_face = {ORACLE_VF, 7, 4, 7, 0};
    const struct oracle_pair edges_meet = {ORACLE_EE, 7, 2, 7, 5};
    assert_int_equal(oracle_pair_compare(&contacts.pairs[0], &vertex_meets_face), 0);
    assert_int_equal(oracle_pair_compare(&contacts.pairs[1], &edges_meet), 0);
    oracle_contacts_deinit(&contacts);
}
