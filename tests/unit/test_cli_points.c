/* test_cli_points.c - stencils, points and manifolds of records, by hand and by brute
 * force. */
#include "cases.h"

#include <math.h>
#include <string.h>

#include "pccd.h"
#include "prng.h"

#define POINTS 24u

static const uint32_t triangle[1][3] = {{2, 0, 1}};
static const struct pccd_edge edges[3] = {{0, 1}, {0, 2}, {1, 2}};
static const double low[3][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
static const double high[3][3] = {{0, 0, 3}, {2, 0, 3}, {0, 2, 5}};

static struct pccd_body body(uint32_t object, uint32_t first)
{
    return (struct pccd_body){.object = object,
                              .first = first,
                              .vertex_count = 3,
                              .triangle_count = 1,
                              .edge_count = 3,
                              .triangles = triangle[0],
                              .edges = edges,
                              .x0 = low[0]};
}

static struct pccd_contact contact(uint32_t kind, uint32_t a, uint32_t feature_a,
                                   uint32_t b, uint32_t feature_b)
{
    return (struct pccd_contact){.kind = kind,
                                 .object_a = a,
                                 .feature_a = feature_a,
                                 .object_b = b,
                                 .feature_b = feature_b,
                                 .toi = 0.5,
                                 .toi_hi = 0.5,
                                 .param = {0.25F, 0.5F},
                                 .normal = {0, 0, 1}};
}

/* If it failed, a force would be put on other vertices than those that meet. */
CASE(stencils__name_the_vertices_of_every_kind)
{
    const struct pccd_body bodies[2] = {body(5, 10), body(9, 100)};
    const struct pccd_contact contacts[4] = {
        contact(PCCD_VF, 9, 1, 5, 0), contact(PCCD_EE, 5, 1, 9, 2),
        contact(PCCD_VE, 9, 2, 5, 2), contact(PCCD_VV, 5, 0, 5, 2)};
    static const uint32_t wanted[4][4] = {
        {101, 12, 10, 11}, {10, 12, 101, 102}, {102, 11, 12, 12}, {10, 12, 12, 12}};
    static const double weights_wanted[4][4] = {{1, -0.25, -0.25, -0.5},
                                                {0.75, 0.25, -0.5, -0.5},
                                                {1, -0.5, -0.5, 0},
                                                {1, -1, 0, 0}};
    struct pccd_near near = {.kind = PCCD_EF,
                             .object_a = 5,
                             .feature_a = 1,
                             .object_b = 9,
                             .feature_b = 0,
                             .param = {0.25F, 0}};
    uint32_t vertices[4][4];
    double weights[4][4];

    assert_int_equal(pccd_stencils(bodies, 2, contacts, 4, vertices, weights), 0);
    assert_memory_equal(vertices, wanted, sizeof wanted);
    for (int i = 0; i < 16; i++) {
        assert_true(weights[i / 4][i % 4] == weights_wanted[i / 4][i % 4]);
    }
    assert_int_equal(pccd_near_stencils(bodies, 2, &near, 1, vertices, weights), 0);
    assert_true(vertices[0][0] == 10 && vertices[0][1] == 12 && vertices[0][3] == 12);
    assert_true(weights[0][0] == 0.75 && weights[0][1] == 0.25 && weights[0][2] == 0);
    near.kind = PCCD_VF;
    assert_int_equal(pccd_near_stencils(bodies, 2, &near, 1, vertices, NULL), 0);
    assert_int_equal(vertices[0][0], 11);
    assert_int_equal(pccd_stencils(bodies, 2, contacts, 4, NULL, weights), 0);
}

/* If it failed, a spark would fly where nothing meets. */
CASE(points__are_where_the_features_are_then)
{
    static const double turn0[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    static const double turn1[12] = {2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 1, 4};
    struct pccd_body bodies[2] = {body(5, 0), body(9, 3)};
    const struct pccd_contact contacts[2] = {contact(PCCD_VF, 9, 1, 5, 0),
                                             contact(PCCD_EE, 5, 1, 9, 2)};
    /* Vertex 1 half way from (1 0 0) to (2 0 3); in the face 2 0 1 of the other. */
    static const double wanted[2][2][3] = {{{1.5, 0, 1.5}, {0.5, 0.25, 0}},
                                           {{0, 0.25, 0}, {0.75, 0.75, 2}}};
    double points[2][2][3];

    bodies[1].x1 = high[0];
    assert_int_equal(pccd_points(bodies, 2, contacts, 2, points), 0);
    assert_memory_equal(points, wanted, sizeof wanted);
    bodies[1].x1 = NULL;
    bodies[1].m0 = turn0;
    bodies[1].m1 = turn1;
    assert_int_equal(pccd_points(bodies, 2, contacts, 2, points), 0);
    assert_true(points[0][0][0] == 1.5 && points[0][0][1] == 0 && points[0][0][2] == 2);
    const struct pccd_near near = {.kind = PCCD_EF,
                                   .object_a = 9,
                                   .feature_a = 2,
                                   .object_b = 5,
                                   .param = {0.5F, 0}};
    assert_int_equal(pccd_near_points(bodies, 2, &near, 1, 1, points), 0);
    assert_memory_equal(points[0][0], points[0][1], sizeof points[0][0]);
    assert_true(points[0][0][0] == 1 && points[0][0][1] == 1 && points[0][0][2] == 4);
}

/* ---- manifolds --------------------------------------------------------------------- */

static double (*sought)[3]; /* the points, for area_of */

static double area_of(uint32_t a, uint32_t b, uint32_t c)
{
    return fabs((sought[b][0] - sought[a][0]) * (sought[c][1] - sought[a][1]) -
                (sought[b][1] - sought[a][1]) * (sought[c][0] - sought[a][0]));
}

/* Twice the area of the hull of four points: that of a triangle of them, or what its
 * diagonals span; two other pairs span less. */
static double area_of_four(const uint32_t p[4])
{
    static const int ways[3][4] = {{0, 1, 2, 3}, {0, 2, 1, 3}, {0, 3, 1, 2}};
    double largest = 0;
    for (int i = 0; i < 4; i++) {
        largest = fmax(largest, area_of(p[(i + 1) % 4], p[(i + 2) % 4], p[(i + 3) % 4]));
    }
    for (int i = 0; i < 3; i++) {
        double d[2][2];
        for (int k = 0; k < 2; k++) {
            d[0][k] = sought[p[ways[i][1]]][k] - sought[p[ways[i][0]]][k];
            d[1][k] = sought[p[ways[i][3]]][k] - sought[p[ways[i][2]]][k];
        }
        largest = fmax(largest, fabs(d[0][0] * d[1][1] - d[0][1] * d[1][0]));
    }
    return largest;
}

static double largest_of_all(uint32_t count)
{
    double largest = 0;
    uint32_t p[4];
    for (p[0] = 0; p[0] < count; p[0]++) {
        for (p[1] = p[0]; p[1] < count; p[1]++) {
            for (p[2] = p[1]; p[2] < count; p[2]++) {
                for (p[3] = p[2]; p[3] < count; p[3]++) {
                    largest = fmax(largest, area_of_four(p));
                }
            }
        }
    }
    return largest;
}

/* If it failed, a box would tip over that stands on its floor. */
CASE(manifold__spans_the_largest_area)
{
    struct prng prng = {prng_seed()};
    uint32_t full = 0;
    for (uint32_t round = 0; round < 300; round++) {
        double x[POINTS][3];
        struct pccd_contact contacts[POINTS];
        struct pccd_manifold manifold;
        uint64_t total = 0;
        uint32_t count = 1 + prng_u32(&prng, round < 20 ? POINTS : 12);
        bool is_grid = prng_below(&prng, 2) == 0; /* many in a line, or at one place */
        struct pccd_body bodies[2] = {{.object = 1, .vertex_count = count, .x0 = x[0]},
                                      {.object = 2, .vertex_count = count, .x0 = x[0]}};
        for (uint32_t i = 0; i < count; i++) {
            double turn = prng_between(&prng, 0, 6.3);
            x[i][0] = is_grid ? prng_integer(&prng, 2) : cos(turn);
            x[i][1] = is_grid ? prng_integer(&prng, 2) : 2 * sin(turn);
            x[i][2] = prng_between(&prng, 0, 0.01);
            contacts[i] = contact(PCCD_VV, 1, i, 2, i);
            contacts[i].normal[2] = -1;
        }
        assert_ok(pccd_manifolds(bodies, 2, contacts, count, 0, &manifold, 1, &total));
        assert_int_equal(total, 1);
        assert_in_range(manifold.count, 1, 4);
        full += manifold.count == 4;
        uint32_t p[4];
        for (uint32_t i = 0; i < 4; i++) {
            uint32_t at = i < manifold.count ? i : manifold.count - 1;
            const struct pccd_manifold_point *point = &manifold.points[at];
            p[i] = (uint32_t)point->record;
            assert_memory_equal(point->point, x[p[i]], sizeof point->point);
            assert_true(point->normal[2] == 1 && point->distance == 0);
            assert_true(i == 0 || i >= manifold.count || p[i] > p[i - 1]);
        }
        sought = x;
        assert_true(area_of_four(p) >= largest_of_all(count) * (1 - 1e-12));
    }
    assert_true(full > 100);
}

/* If it failed, points of other bodies would be in it, or of another time, or a normal
 * would point into the floor. */
CASE(manifold__is_of_each_two_bodies)
{
    const struct pccd_body bodies[3] = {body(1, 0), body(2, 3), body(7, 6)};
    struct pccd_contact contacts[5] = {
        contact(PCCD_VF, 2, 0, 1, 0), contact(PCCD_VF, 2, 1, 1, 0),
        contact(PCCD_VF, 1, 2, 2, 0), contact(PCCD_VF, 7, 0, 1, 0),
        contact(PCCD_EE, 1, 0, 1, 1)};
    struct pccd_near near[2];
    struct pccd_manifold manifolds[3];
    uint64_t total;

    contacts[0].toi = 0.75;
    contacts[1].toi = 0.5;
    contacts[2].toi = 0.625;
    assert_int_equal(pccd_manifolds(bodies, 3, contacts, 5, 0, manifolds, 3, &total), 0);
    assert_int_equal(total, 3);
    assert_true(manifolds[0].object_a == 1 && manifolds[0].object_b == 1);
    assert_true(manifolds[1].object_a == 1 && manifolds[1].object_b == 2);
    assert_true(manifolds[2].object_a == 1 && manifolds[2].object_b == 7);
    assert_true(manifolds[1].count == 1 && manifolds[1].points[0].record == 1 &&
                manifolds[1].points[0].toi == 0.5 &&
                manifolds[1].points[0].normal[2] == 1);
    assert_ok(pccd_manifolds(bodies, 3, contacts, 5, 0.125, manifolds, 2, &total));
    assert_true(total == 3 && manifolds[1].count == 2 &&
                manifolds[1].points[1].record == 2 &&
                manifolds[1].points[1].normal[2] == -1);
    for (int i = 0; i < 2; i++) {
        near[i] = (struct pccd_near){.kind = PCCD_VV,
                                     .object_a = 7,
                                     .feature_a = (uint32_t)i,
                                     .object_b = 2,
                                     .d_lo = 0.5 + i,
                                     .d_hi = 0.5 + i};
    }
    assert_ok(pccd_near_manifolds(bodies, 3, near, 2, 0.5, 1, manifolds, 3, &total));
    assert_true(total == 1 && manifolds[0].object_a == 2 && manifolds[0].count == 1 &&
                manifolds[0].points[0].distance == 0.5);
    assert_ok(pccd_near_manifolds(bodies, 3, near, 2, 0.25, 1, manifolds, 3, &total));
    assert_int_equal(total, 0);
    assert_ok(pccd_near_manifolds(bodies, 3, near, 2, 2, 1, NULL, 0, &total));
    assert_int_equal(total, 1);
}

/* If it failed, memory that is nobody's would be read. */
CASE(points__refuse_what_is_not_there)
{
    struct pccd_body bodies[2] = {body(5, 0), body(9, 3)};
    const struct pccd_contact good = contact(PCCD_VF, 9, 1, 5, 0);
    struct pccd_contact bad = good;
    struct pccd_manifold manifold;
    uint32_t vertices[1][4];
    double points[1][2][3];
    uint64_t total;

#define REFUSES(call, status_, text)                                                     \
    assert_int_equal((call), (status_));                                                 \
    assert_non_null(strstr(pccd_error_text(NULL), (text)))
    bad.object_b = 6;
    REFUSES(pccd_stencils(bodies, 2, &bad, 1, vertices, NULL), PCCD_E_HANDLE,
            "record 0: no body is object 0x6");
    bad = contact(PCCD_VF, 9, 1, 5, 1);
    REFUSES(pccd_stencils(bodies, 2, &bad, 1, vertices, NULL), PCCD_E_INDEX,
            "object 0x5 has no face 1");
    bad = contact(PCCD_VF, 9, 3, 5, 0);
    REFUSES(pccd_stencils(bodies, 2, &bad, 1, vertices, NULL), PCCD_E_INDEX,
            "no vertex 3");
    bad = contact(PCCD_EE, 9, 3, 5, 0);
    REFUSES(pccd_manifolds(bodies, 2, &bad, 1, 0, &manifold, 1, &total), PCCD_E_INDEX,
            "no edge 3");
    bad.kind = 77;
    REFUSES(pccd_points(bodies, 2, &bad, 1, points), PCCD_E_INVAL, "kind 77");
    REFUSES(pccd_stencils(bodies, 2, NULL, 1, vertices, NULL), PCCD_E_INVAL, "NULL");
    REFUSES(pccd_points(bodies, 2, &good, 1, NULL), PCCD_E_INVAL, "points is NULL");
    REFUSES(pccd_manifolds(bodies, 2, &good, 1, NAN, &manifold, 1, &total), PCCD_E_INVAL,
            "time is");
    REFUSES(pccd_manifolds(bodies, 2, &good, 1, 0, &manifold, 1, NULL), PCCD_E_INVAL,
            "total is NULL");
    bodies[0].vertex_count = 2;
    REFUSES(pccd_stencils(bodies, 2, &good, 1, vertices, NULL), PCCD_E_INDEX, "face 0");
    bodies[0].vertex_count = 3;
    bodies[1].x0 = NULL;
    REFUSES(pccd_points(bodies, 2, &good, 1, points), PCCD_E_INVAL, "x0 of body 1");
    bodies[1].m0 = low[0];
    REFUSES(pccd_stencils(bodies, 2, &good, 1, vertices, NULL), PCCD_E_INVAL,
            "one of m0 and m1");
    bodies[1] = body(5, 3);
    REFUSES(pccd_stencils(bodies, 2, &good, 1, vertices, NULL), PCCD_E_INVAL,
            "body 1 does not come after");
#undef REFUSES
}
