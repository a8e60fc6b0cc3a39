/* test_eng_near_depth.c - vertices inside closed meshes are found, with their distance
 * to the surface.
 */
#include "eng_kit.h"

struct box {
    double low[3];
    double high[3];
    bool inward;
};

/* Boxes as one mesh. */
static struct eng_mesh *boxes(const struct box *box, uint32_t count)
{
    double x[64][3];
    uint32_t corners[64][3];
    assert_true(count <= 5);
    for (uint32_t i = 0; i < count; i++) {
        struct eng_mesh *mesh = kit_box(box[i].low, box[i].high, box[i].inward);
        memcpy(x + 8 * i, eng_mesh_vertices(mesh), 8 * sizeof x[0]);
        eng_mesh_get_corners(mesh, corners + 12 * i);
        for (uint32_t k = 0; k < 36; k++) {
            corners[12 * i + k / 3][k % 3] += 8 * i;
        }
        eng_mesh_release(mesh);
    }
    return kit_mesh(x, 8 * count, corners, 12 * count);
}

static struct eng_mesh *cube(double low, double high)
{
    return boxes(&(struct box){{low, low, low}, {high, high, high}, false}, 1);
}

/* A closed mesh of four faces around a vertex at `tip`, far from everything else in its
 * other vertices. */
static struct eng_mesh *spike(double x, double y, double z)
{
    double corner[4][3] = {{x, y, z}, {90, 1, 2}, {90, 7, -3}, {90, -4, 9}};
    static const uint32_t faces[4][3] = {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}};
    return kit_mesh(corner, 4, faces, 4);
}

static struct eng_step_result ask(struct eng_mesh *a, struct eng_mesh *b)
{
    kit_begin_with(a, b);
    return kit_ask_for(PCCD_NEAR_DEPTH);
}

/* A box with one corner in another: that corner alone, and how deep it is. A corner that
 * is counted from both sides, or none, would be wrong. */
CASE(depth__is_of_the_vertices_inside)
{
    struct eng_step_result result = ask(cube(0, 2), cube(1.5, 4));
    assert_int_equal(result.count, 2); /* 0's corner (2, 2, 2) is in the other, too */
    const struct pccd_near *record = kit_record(&result, 0);
    assert_int_equal(record->kind, PCCD_VF);
    assert_int_equal(record->object_a, 1);
    assert_int_equal(record->feature_a, 7);
    assert_int_equal(record->object_b, 2);
    assert_true(record->d_lo == 0.5 && record->d_hi == 0.5);
    assert_int_equal(kit_record(&result, 1)->object_a, 2);
    assert_int_equal(kit_record(&result, 1)->feature_a, 0);
    assert_true(result.distance_max == 0.5);
}

/* The whole of one in another: all its vertices, the face of the least number among
 * equally near ones. */
CASE(depth__is_of_a_mesh_inside_another)
{
    struct eng_step_result result = ask(cube(0, 8), cube(3, 4));
    assert_int_equal(result.count, 8);
    for (uint64_t i = 0; i < 8; i++) {
        const struct pccd_near *record = kit_record(&result, i);
        assert_int_equal(record->object_a, 2);
        assert_int_equal(record->feature_a, i);
        assert_true(record->d_lo == (i == 7 ? 4 : 3));
    }
    /* Of (3, 3, 3) the faces of x = 0, y = 0 and z = 0 are as far away: face 0 or 1 is
     * the first, and both have the foot. */
    assert_int_equal(kit_record(&result, 0)->feature_b, 0);
}

/* If it failed, what is on the surface would be inside: on a face, on an edge, on a
 * vertex. */
CASE(depth__leaves_out_what_is_on_the_surface)
{
    static const double places[][3] = {{4, 1, 1}, {4, 4, 1}, {4, 4, 4}, {4, 2, 2},
                                       {2, 4, 1}, {0, 1, 2}, {1, 0, 2}, {1, 2, 0}};
    for (size_t i = 0; i < sizeof places / sizeof places[0]; i++) {
        struct eng_step_result result =
            ask(cube(0, 4), spike(places[i][0], places[i][1], places[i][2]));
        assert_int_equal(result.count, 0);
    }
}

/* In an octahedron the ray along +x from the middle meets a vertex, others meet edges;
 * from outside it touches them. A count that has such a crossing twice, or not at all,
 * would call an inside an outside. */
CASE(depth__decides_rays_through_edges_and_vertices)
{
    struct eng_step_result result;
    static const double x[6][3] = {{4, 0, 0},  {-4, 0, 0}, {0, 4, 0},
                                   {0, -4, 0}, {0, 0, 4},  {0, 0, -4}};
    static const uint32_t faces[8][3] = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                                         {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
    static const double inside[][3] = {{0, 0, 0},  {-1, 0, 0}, {0, 1, 0},
                                       {0, 0, -1}, {-1, 1, 0}, {0, -1, 1}};
    static const double outside[][3] = {{-5, 0, 0}, {-4, 1, 0}, {-4, 0, -1}, {-3, 2, 0},
                                        {-1, 4, 0}, {-2, 0, 4}, {-3, -4, 0}};
    for (size_t i = 0; i < sizeof inside / sizeof inside[0]; i++) {
        result = ask(kit_mesh(x, 6, faces, 8),
                     spike(inside[i][0], inside[i][1], inside[i][2]));
        assert_int_equal(result.count, 1);
    }
    for (size_t i = 0; i < sizeof outside / sizeof outside[0]; i++) {
        result = ask(kit_mesh(x, 6, faces, 8),
                     spike(outside[i][0], outside[i][1], outside[i][2]));
        for (uint64_t k = 0; k < result.count; k++) { /* no vertex of the spike */
            assert_int_equal(kit_record(&result, k)->object_a, 1);
        }
    }
}

/* Shells within shells: winding number 2 is inside; 1 - 1 is outside; one that is turned
 * inside out is as closed as another. */
CASE(depth__goes_by_the_winding_number)
{
    struct box shells[2] = {{{0, 0, 0}, {8, 8, 8}, false}, {{2, 2, 2}, {6, 6, 6}, false}};
    for (int i = 0; i < 4; i++) {
        shells[0].inward = i % 2 == 1;
        shells[1].inward = i / 2 == 1;
        struct eng_step_result result = ask(boxes(shells, 2), spike(4, 4, 3.5));
        bool cancels = shells[0].inward != shells[1].inward;
        assert_int_equal(result.count, cancels ? 0 : 1);
        assert_true(cancels || result.distance_max == 1.5);
    }
}

/* Crossed bars: no vertex of either is in the other, and yet the 4 long edges of the thin
 * one pass through 2 sides of the other each. If crossings were not counted, the bars
 * would be taken for apart. */
CASE(depth__counts_what_passes_through)
{
    struct eng_step_result result =
        ask(boxes(&(struct box){{-8, -1, -1}, {8, 1, 1}, false}, 1),
            boxes(&(struct box){{-0.5, -9, -0.5}, {0.5, 9, 0.5}, false}, 1));
    assert_int_equal(result.count, 0);
    assert_true(result.distance_max == 0);
    assert_true(result.crossings >= 8);
    result = ask(boxes(&(struct box){{-8, -1, -1}, {8, 1, 1}, false}, 1),
                 boxes(&(struct box){{-0.5, -9, 3}, {0.5, 9, 4}, false}, 1));
    assert_int_equal(result.crossings, 0);
}

/* A mesh with a hole has no inside: the error names the first edge that shows it. */
CASE(depth__names_what_is_open)
{
    static const double x[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    /* Without its fourth face; the third is turned round. */
    static const uint32_t faces[3][3] = {{0, 1, 2}, {0, 2, 3}, {0, 1, 3}};
    struct eng_step_result result;
    kit_begin_with(cube(0, 1), kit_mesh(x, 4, faces, 3));
    struct eng_question settings = kit_question(PCCD_NEAR_DEPTH);
    for (int i = 0; i < 2; i++) { /* the second time it is known */
        assert_int_equal(eng_near(kit.scene, &settings, &result), PCCD_E_INVAL);
        assert_int_equal(result.open_object, 2);
        assert_int_equal(result.open_edge[0], 0);
        assert_int_equal(result.open_edge[1], 1);
        assert_int_equal(result.open_runs[0], 2);
        assert_int_equal(result.open_runs[1], 0);
    }
    /* It matters only where it is asked for. */
    kit_put(cube(0.25, 0.5));
    settings.objects[0] = 1;
    settings.objects[1] = 3;
    assert_int_equal(kit_ask(&settings).count, 8);
}

/* A box of which some vertices and edges are foreign, and perhaps the last face is
 * missing. */
static struct eng_mesh *part(struct box box, uint64_t own, bool is_open)
{
    struct eng_mesh *whole = boxes(&box, 1);
    uint32_t corners[12][3];
    eng_mesh_get_corners(whole, corners);
    struct eng_mesh *mesh =
        kit_mesh(eng_mesh_vertices(whole), 8, corners, is_open ? 11 : 12);
    assert_ok(eng_mesh_set_own(mesh, &own, &own));
    eng_mesh_release(whole);
    return mesh;
}

/* If it failed, ranks would count a vertex twice, or not at all: what two scenes say, of
 * which each has some vertices and edges as its own, is together what one says. */
CASE(depth__of_parts_is_that_of_their_own_vertices)
{
    static const uint64_t own[3] = {UINT64_MAX, 0x5a341, ~UINT64_C(0x5a341)};
    static const struct box corner[2] = {{{0, 0, 0}, {2, 2, 2}, false},
                                         {{1.5, 1.5, 1.5}, {4, 4, 4}, false}};
    static const struct box bar[2] = {{{-8, -1, -1}, {8, 1, 1}, false},
                                      {{-0.5, -9, -0.5}, {0.5, 9, 0.5}, false}};
    uint64_t crossings[3];
    struct eng_step_result result[3];
    struct pccd_near records[3][4];
    for (int i = 0; i < 3; i++) {
        result[i] = ask(part(corner[0], own[i], false), part(corner[1], own[i], false));
        assert_true(result[i].count <= 4);
        memcpy(records[i], result[i].records, result[i].count * sizeof records[0][0]);
        crossings[i] =
            ask(part(bar[0], own[i], false), part(bar[1], own[i], false)).crossings;
    }
    assert_int_equal(result[0].count, 2);
    assert_int_equal(result[1].count, 1); /* vertex 0 of the second, not 7 of the first */
    assert_int_equal(result[2].count, 1);
    assert_memory_equal(&records[0][0], &records[2][0], sizeof records[0][0]);
    assert_memory_equal(&records[0][1], &records[1][0], sizeof records[0][0]);
    assert_true(crossings[1] > 0 && crossings[2] > 0);
    assert_int_equal(crossings[1] + crossings[2], crossings[0]);
}

/* A part of a closed mesh has open edges; and a vertex within it may lie outside of the
 * box of what is there. If it failed, ranks could not be asked how deep anything is. */
CASE(depth__of_a_part_needs_only_what_rays_meet)
{
    static const double x[3][3] = {{4, 0, 0}, {4, 4, 0}, {4, 0, 4}};
    static const uint32_t face[1][3] = {{0, 1, 2}};
    const uint64_t all = UINT64_MAX;
    const struct box inside = {{1, 1, 1}, {1.5, 1.5, 1.5}, false};
    struct eng_mesh *mesh = kit_mesh(x, 3, face, 1);
    assert_ok(eng_mesh_set_own(mesh, &all, &all));
    struct eng_step_result result = ask(mesh, part(inside, all, true));
    assert_int_equal(result.count, 8); /* a ray from each vertex passes it */
    assert_int_equal(kit_record(&result, 0)->object_a, 2);
    assert_true(kit_record(&result, 0)->d_lo == 3);
}

/* If the ray ended where coordinates do that are measured from the origin, nothing would
 * be deep in what lies at the other end of the numbers from the finest object. */
CASE(depth__is_found_as_far_as_numbers_go)
{
    static const double bridge[3][3] = {
        {-1e18, -5e9, -5e9}, {1e18, -5e9, -5e9}, {1e18, -6e9, -5e9}};
    static const uint32_t face[1][3] = {{0, 1, 2}};
    const double middle = 9.9e17;
    const struct box fine = {{-1e18, 0, 0}, {-1e18 + 1024, 1e3, 1e3}, false};
    const struct box outer = {
        {middle - 1e9, -1e9, -1e9}, {middle + 1e9, 1e9, 1e9}, false};
    const struct box inner = {
        {middle - 1e8, -1e8, -1e8}, {middle + 1e8, 1e8, 1e8}, false};
    struct eng_question question = kit_question(PCCD_NEAR_DEPTH);
    question.objects[0] = 2;
    question.objects[1] = 1;
    kit_begin_with(boxes(&outer, 1), boxes(&inner, 1));
    kit_put(boxes(&fine, 1));
    kit_put(kit_mesh(bridge, 3, face, 1));
    assert_int_equal(kit_ask(&question).count, 8);
}
