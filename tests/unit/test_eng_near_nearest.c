/* test_eng_near_nearest.c - of each two objects the nearest pair of features is found,
 * and no other.
 */
#include "eng_kit.h"

static const double unit_low[3] = {0, 0, 0};
static const double unit_high[3] = {1, 1, 1};

static struct eng_mesh *box_at(double x, double y, double z)
{
    double low[3] = {x, y, z};
    double high[3] = {x + 1, y + 1, z + 1};
    return kit_box(low, high, false);
}

/* A single triangle. */
static struct eng_mesh *triangle(const double x[3][3])
{
    static const uint32_t corners[1][3] = {{0, 1, 2}};
    return kit_mesh(x, 3, corners, 1);
}

/* A vertex above the inside of a face: a search that cuts off too early, or that looks at
 * one direction of vertex and face only, would answer something else. */
CASE(nearest__is_a_vertex_above_a_face)
{
    static const double floor[3][3] = {{-4, -4, 0}, {4, -4, 0}, {0, 4, 0}};
    static const double spike[3][3] = {{0, 0, 0.5}, {1, 0, 3}, {0, 1, 3}};
    for (int turned = 0; turned < 2; turned++) {
        kit_begin_with(triangle(turned ? spike : floor),
                       triangle(turned ? floor : spike));
        struct eng_step_result result = kit_ask_for(PCCD_NEAR_NEAREST);
        assert_int_equal(result.count, 1);
        const struct pccd_near *record = kit_record(&result, 0);
        kit_check_names(record, PCCD_VF, turned ? 1 : 2, 0, turned ? 2 : 1, 0);
        assert_true(record->d_lo == 0.5 && record->d_hi == 0.5);
        assert_true(record->direction[2] == 1);
        assert_int_equal(PCCD_NEAR_TYPE(record->flags), PCCD_VF);
        assert_int_equal(record->count, 1);
    }
}

/* Two edges across each other: with vertices and faces alone the distance would be too
 * large. */
CASE(nearest__is_two_edges)
{
    static const double lower[3][3] = {{-1, 0, 0}, {1, 0, 0}, {0, 0, -2}};
    static const double upper[3][3] = {{0, -1, 0.25}, {0, 1, 0.25}, {0, 0, 2}};
    kit_begin_with(triangle(lower), triangle(upper));
    struct eng_step_result result = kit_ask_for(PCCD_NEAR_NEAREST);
    assert_int_equal(result.count, 1);
    const struct pccd_near *record = kit_record(&result, 0);
    assert_int_equal(record->kind, PCCD_EE);
    assert_int_equal(record->feature_a, 0); /* of vertices 0 and 1 */
    assert_int_equal(record->feature_b, 0);
    assert_true(record->d_lo == 0.25 && record->param[0] == 0.5f);
}

/* A spike through a floor, far from all its edges, is at distance 0 by what passes
 * through: of the two edges that do the first. By vertices and edges alone it would be
 * 2 away. With a radius its surfaces are nearer than those of a pair that touches; a
 * mask keeps it out. */
CASE(nearest__of_what_crosses_is_the_first_crossing)
{
    static const double floor[3][3] = {{-30, -30, 0}, {30, -30, 0}, {0, 30, 0}};
    static const double spike[3][3] = {{0, 0, -2}, {1, 0, 6}, {0, 1, 6}};
    for (int turned = 0; turned < 2; turned++) {
        kit_begin_with(triangle(turned ? spike : floor),
                       triangle(turned ? floor : spike));
        struct eng_question settings = kit_question(PCCD_NEAR_NEAREST);
        for (int way = 0; way < 4; way++) { /* from anew, then warm */
            settings.distance = way % 2 == 0 ? INFINITY : 0;
            struct eng_step_result result = kit_ask(&settings);
            assert_int_equal(result.count, 1);
            assert_int_equal(result.counts[PCCD_EF], 1);
            const struct pccd_near *record = kit_record(&result, 0);
            assert_int_equal(record->kind, PCCD_EF);
            assert_int_equal(record->object_a, turned ? 1 : 2);
            assert_int_equal(record->feature_a, 0); /* of vertices 0 and 1 */
            assert_int_equal(record->object_b, turned ? 2 : 1);
            assert_int_equal(record->feature_b, 0);
            assert_true(record->d_lo == 0 && record->d_hi == 0);
            assert_true(record->param[0] == 0.25f && record->param[1] == 0);
            assert_true(result.distance_min == 0 && result.distance_max == 0);
            assert_int_equal(record->count, 1);
            assert_int_equal(record->flags, 0);
        }
        struct pccd_near of_crossings[2];
        settings = kit_question(PCCD_NEAR_NEAREST);
        struct eng_step_result result = kit_ask(&settings);
        of_crossings[0] = *kit_record(&result, 0);
        settings = kit_question(PCCD_NEAR_CROSSINGS);
        result = kit_ask(&settings);
        of_crossings[1] = *kit_record(&result, 0);
        assert_int_equal(result.count, 2);
        assert_memory_equal(&of_crossings[0], &of_crossings[1], sizeof of_crossings[0]);
        assert_ok(eng_scene_ignore(kit.scene, kit.idx[0], kit.idx[1], true));
        settings = kit_question(PCCD_NEAR_NEAREST);
        result = kit_ask(&settings);
        assert_int_equal(result.count, 0);
    }
}

/* A box inside a box passes through nothing: its surface is as far from the other as it
 * is; that it is inside, DEPTH says. */
CASE(nearest__of_a_box_inside_a_box_is_no_crossing)
{
    static const double low[3] = {-2, -2, -2};
    static const double high[3] = {4, 4, 4};
    kit_begin_with(kit_box(unit_low, unit_high, false), kit_box(low, high, false));
    struct eng_question settings = kit_question(PCCD_NEAR_NEAREST);
    struct eng_step_result result = kit_ask(&settings);
    assert_int_equal(result.count, 1);
    assert_true(kit_record(&result, 0)->d_lo == 2);
    settings = kit_question(PCCD_NEAR_DEPTH);
    result = kit_ask(&settings);
    assert_int_equal(result.count, 8);
    assert_int_equal(result.crossings, 0);
}

/* Two boxes side by side: every pair of their facing sides has the distance 0.5. Without
 * the tie rule the answer would be whichever was found first. */
CASE(nearest__of_equals_is_the_first_in_order)
{
    kit_begin_with(kit_box(unit_low, unit_high, false), box_at(1.5, 0, 0));
    struct eng_step_result result = kit_ask_for(PCCD_NEAR_NEAREST);
    assert_int_equal(result.count, 1);
    const struct pccd_near *record = kit_record(&result, 0);
    /* The first vertex of object 1 with x = 1, and the first face of object 2 that has
     * its neighbour: faces 0 and 1 are the side z = 0 with vertices 0 2 3 1. */
    kit_check_names(record, PCCD_VF, 1, 1, 2, 0);
    assert_true(record->d_lo == 0.5 && record->d_hi == 0.5);
    assert_int_equal(PCCD_NEAR_TYPE(record->flags), PCCD_VV);
}

/* Distances that differ in the last bit of a coordinate, far below what rounded lengths
 * tell apart: compared as doubles, the earlier of the two would win. */
CASE(nearest__is_told_from_one_that_is_hardly_farther)
{
    static const double floor[3][3] = {{-9, -9, 0}, {9, -9, 0}, {0, 9, 0}};
    double spikes[6][3] = {{0.1, 0.2, 0.7}, {0.3, 0, 3},  {0, 0.3, 3},
                           {-0.4, 0.1, 0},  {-0.3, 0, 3}, {0, -0.3, 3}};
    static const uint32_t corners[2][3] = {{0, 1, 2}, {3, 4, 5}};
    spikes[3][2] = nextafter(0.7, 0);
    kit_begin_with(triangle(floor), kit_mesh(spikes, 6, corners, 2));
    struct eng_step_result result = kit_ask_for(PCCD_NEAR_NEAREST);
    assert_int_equal(kit_record(&result, 0)->feature_a, 3);
}

/* Boxes that touch, and one inside another: distance 0 has no direction, and what is
 * inside is as far away as its surface. */
CASE(nearest__touches_or_is_inside)
{
    kit_begin_with(kit_box(unit_low, unit_high, false), box_at(1, 0.25, 0.25));
    static const double low[3] = {-2, -2, -2};
    static const double high[3] = {4, 4, 4};
    kit_put(kit_box(low, high, false));
    struct eng_step_result result = kit_ask_for(PCCD_NEAR_NEAREST);
    assert_int_equal(result.count, 3);
    for (uint64_t i = 0; i < 3; i++) {
        const struct pccd_near *record = kit_record(&result, i);
        bool touches = record->object_a + record->object_b == 3;
        assert_true(touches == (record->d_hi == 0));
        assert_true(touches == (record->direction[0] == 0 && record->direction[1] == 0 &&
                                record->direction[2] == 0));
        assert_true(touches || record->d_lo == 2);
    }
}

/* `distance` is within it when it is exactly that far, and leaves out what is farther: a
 * search that ended early otherwise would lose the record of the next test. */
CASE(nearest__has_no_record_beyond_the_distance)
{
    kit_begin_with(kit_box(unit_low, unit_high, false), box_at(1.5, 0, 0));
    kit_put(box_at(0, 3, 0));
    struct eng_question settings = kit_question(PCCD_NEAR_NEAREST);
    settings.distance = 0.5;
    assert_int_equal(kit_ask(&settings).count, 1);
    settings.distance = nextafter(0.5, 0);
    assert_int_equal(kit_ask(&settings).count, 0);
    settings.distance = 2;
    assert_int_equal(kit_ask(&settings).count, 2);
}

/* Masks and ignored pairs leave pairs of objects out, also two that are named; objects
 * that are named are asked for alone. */
CASE(nearest__is_of_objects_that_may_meet)
{
    struct eng_step_result result;
    kit_begin();
    for (int i = 0; i < 4; i++) {
        kit_put(box_at(2 * i, 0, 0));
    }
    struct eng_question settings = kit_question(PCCD_NEAR_NEAREST);
    assert_int_equal(kit_ask(&settings).count, 6);
    assert_ok(eng_scene_ignore(kit.scene, kit.idx[0], kit.idx[1], true));
    assert_int_equal(kit_ask(&settings).count, 5);
    settings.objects[1] = 1;
    assert_int_equal(kit_ask(&settings).count, 2);
    settings.objects[0] = 2;
    assert_int_equal(kit_ask(&settings).count, 0);
    settings.objects[0] = 3;
    result = kit_ask(&settings);
    assert_int_equal(result.count, 1);
    assert_true(kit_record(&result, 0)->d_lo == 3);
    static const struct eng_object_filter alone = {1, 0, true};
    assert_ok(eng_scene_set_filter(kit.scene, kit.idx[2], &alone));
    assert_int_equal(kit_ask(&settings).count, 0);
    settings.objects[0] = 9;
    assert_int_equal(eng_near(kit.scene, &settings, &result), PCCD_E_HANDLE);
    settings.objects[0] = 1;
    assert_int_equal(eng_near(kit.scene, &settings, &result), PCCD_E_INVAL);
}

/* With a gap the reported distance is true and at most that much too large, the flag says
 * so, and there is no hash. */
CASE(nearest__with_a_gap_is_near_enough)
{
    kit_begin_with(kit_sheet(12, 0), kit_sheet(9, 0.5));
    struct eng_question settings = kit_question(PCCD_NEAR_NEAREST);
    settings.gap = 0.25;
    struct eng_step_result result = kit_ask(&settings);
    assert_int_equal(result.count, 1);
    assert_true(kit_record(&result, 0)->flags & PCCD_NEAR_GAP);
    assert_true(kit_record(&result, 0)->d_lo >= 0.5 &&
                kit_record(&result, 0)->d_hi <= 0.75);
    assert_true(result.hash[0] == 0 && result.hash[1] == 0);
}

/* Object 3 is thick and far away. If it failed: because of it, a search of the other two
 * could end at a pair that is farther than was asked for, which then is no answer. */
CASE(nearest__with_a_gap_has_a_record_as_without)
{
    static const double floor[3][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    static const double spike[3][3] = {{0, 0, 0.5}, {1, 0, 0.1}, {0, 1, 0.5}};
    static const double away[3][3] = {{100, 0, 0}, {101, 0, 0}, {100, 1, 0}};
    static const struct eng_object_thickness thick = {.has_radius = true, .radius = 1};
    for (int gap = 0; gap <= 4; gap++) {
        kit_begin_with(triangle(floor), triangle(spike));
        kit_put(triangle(away));
        assert_ok(eng_scene_set_thickness(kit.scene, kit.idx[2], &thick));
        struct eng_question settings = kit_question(PCCD_NEAR_NEAREST);
        settings.distance = 0.25;
        settings.gap = 0.5 * gap;
        struct eng_step_result result = kit_ask(&settings);
        assert_int_equal(result.count, 1);
        assert_true(result.distance_max <= 0.25);
    }
}

/* Two spikes over a floor, of which the farther one is thick at its tip: 1 up with no
 * radius, 2 up with radius 1.5. */
static void set_up_spikes(double tip_radius)
{
    static const double floor[3][3] = {{-99, -99, 0}, {99, -99, 0}, {0, 99, 0}};
    static const double spikes[6][3] = {{0, 0, 1},  {1, 0, 30},  {0, 1, 30},
                                        {10, 0, 2}, {11, 0, 30}, {10, 1, 30}};
    static const uint32_t corners[2][3] = {{0, 1, 2}, {3, 4, 5}};
    const double radii[6] = {0, 0, 0, tip_radius, 0, 0};
    kit_begin_with(triangle(floor), kit_mesh_thick(spikes, 6, corners, 2, radii));
}

/* If it failed, a body would be taken for as far away as the nearest of its thin
 * features, though it counts how far surfaces are apart; and another question about the
 * same distance would have what this one denies. */
CASE(nearest__is_of_surfaces)
{
    set_up_spikes(1.5);
    struct eng_question settings = kit_question(PCCD_NEAR_NEAREST);
    static const double distances[] = {INFINITY, 2, 0.5};
    for (int i = 0; i < 3; i++) {
        settings.distance = distances[i];
        struct eng_step_result result = kit_ask(&settings);
        assert_int_equal(result.count, 1);
        assert_int_equal(kit_record(&result, 0)->feature_a, 3);
        assert_true(kit_record(&result, 0)->d_lo == 2);
    }
    settings.distance = nextafter(0.5, 0);
    for (int i = 0; i < 3; i++) {
        settings.gap = i;
        assert_int_equal(kit_ask(&settings).count, 0);
    }
}

/* Both surfaces are 1 away, but for a radius that is larger or less by 2^-52. If it
 * failed: pairs would be compared by sums that are rounded. */
CASE(nearest__tells_surfaces_apart_by_the_last_bit)
{
    static const double tips[3] = {1, 1 + 0x1p-52, 1 - 0x1p-53};
    static const uint32_t want[3] = {0, 3, 0}; /* of equals the first */
    for (int i = 0; i < 3; i++) {
        set_up_spikes(tips[i]);
        struct eng_question settings = kit_question(PCCD_NEAR_NEAREST);
        struct eng_step_result result = kit_ask(&settings);
        assert_int_equal(kit_record(&result, 0)->feature_a, want[i]);
        settings.distance = 1 - 0x1p-52;
        result = kit_ask(&settings);
        assert_int_equal(result.count, want[i] == 3);
    }
}

/* Where the last search ended is where the next one begins, and nothing more: after the
 * objects have moved far, after one has another mesh, and for another end of the step. */
CASE(nearest__does_not_depend_on_the_last_answer)
{
    kit_begin_with(kit_sheet(6, 0), kit_sheet(5, 1));
    struct eng_question settings = kit_question(PCCD_NEAR_NEAREST);
    struct eng_step_result result = kit_ask(&settings);
    assert_true(kit_record(&result, 0)->d_lo == 1);
    const struct eng_mesh *mesh = eng_scene_mesh(kit.scene, kit.idx[1]);
    uint32_t count = eng_scene_vertex_count(kit.scene, kit.idx[1]);
    double x[64][3];
    memcpy(x, eng_mesh_vertices(mesh), count * sizeof x[0]);
    for (uint32_t i = 0; i < count; i++) {
        x[i][0] += 5;
        x[i][2] = 0;
    }
    eng_stage_begin(kit.scene);
    assert_ok(eng_stage_x1(kit.scene, kit.idx[1], PCCD_FORMAT_F64, 0, count, x));
    result = kit_near(kit.scene, &settings);
    assert_true(kit_record(&result, 0)->d_lo == 4);
    settings.end = 0;
    result = kit_near(kit.scene, &settings);
    assert_true(kit_record(&result, 0)->d_lo == 1);
}

/* A mesh in the place of another has other features under the same numbers: vertex 0,
 * which was one of the nearest pair, is now in no triangle, and does not count. */
CASE(nearest__forgets_what_was_replaced)
{
    static const double x[4][3] = {{0.1, 0.1, 0.9}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    static const uint32_t corners[1][3] = {{1, 2, 3}};
    kit_begin_with(kit_sheet(6, 0), kit_sheet(5, 1));
    struct eng_question settings = kit_question(PCCD_NEAR_NEAREST);
    struct eng_step_result result = kit_ask(&settings);
    assert_int_equal(kit_record(&result, 0)->object_a, 1);
    assert_int_equal(kit_record(&result, 0)->feature_a, 0);
    struct eng_mesh *mesh = kit_mesh(x, 4, corners, 1);
    assert_ok(eng_scene_replace(kit.scene, kit.idx[0], mesh));
    eng_mesh_release(mesh);
    result = kit_ask(&settings);
    assert_int_equal(kit_record(&result, 0)->feature_a, 1);
    assert_true(kit_record(&result, 0)->d_lo == 1);
}

/* Far from the origin, far from each other, and tiny: boxes are measured in frames there,
 * in which objects are nearer to each other than they are. */
CASE(nearest__is_found_wherever_objects_are)
{
    static const double places[][2] = {
        {1e9, 1}, {0, 0x1p-300}, {1e15, 0x1p10}, {5, 0x1p-20}};
    for (size_t i = 0; i < sizeof places / sizeof places[0]; i++) {
        double at = places[i][0];
        double size = places[i][1];
        kit_begin();
        for (int j = 0; j < 3; j++) { /* the third far away from the others */
            double begin = at + size * (j == 2 ? 0x1p20 : 2 * j);
            double low[3] = {begin, begin, at};
            double high[3] = {begin + size, begin + size, at + size};
            kit_put(kit_box(low, high, false));
        }
        struct eng_step_result result = kit_ask_for(PCCD_NEAR_NEAREST);
        assert_int_equal(result.count, 3);
        double true_one = size * sqrt(2);
        assert_true(fabs(result.distance_min - true_one) < 1e-6 * true_one);
    }
}
