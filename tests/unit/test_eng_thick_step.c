/* test_eng_thick_step.c - steps of thick objects that were made by hand. */
#include "eng_kit.h"
#include "eng_way.h"
#include "thickness.h"
#include "world.h"

static struct eng_question way(uint32_t i, enum pccd_mode mode, double separation)
{
    struct eng_question settings = kit_contacts(mode, PCCD_METHOD_DEFAULT);
    settings.distance = separation;
    way_choose(i, &settings);
    return settings;
}

/* Two triangles that lie 1 apart. */
static struct eng_mesh *two_triangles(void)
{
    static const double at[6][3] = {{0, 0, 0}, {0, 0.5, 0}, {0, 0, 0.5},
                                    {1, 0, 0}, {1, 0.5, 0}, {1, 0, 0.5}};
    static const uint32_t corners[2][3] = {{0, 1, 2}, {3, 4, 5}};
    return kit_mesh(at, 6, corners, 2);
}

/* A triangle of length 20 along x. */
static void add_triangle(struct eng_scene *scene, uint32_t id, double x, double y)
{
    const double at[3][3] = {{x, y, 0}, {x + 20, y + 0.5, 0}, {x, y, 0.5}};
    static const uint32_t corners[1][3] = {{0, 1, 2}};
    struct eng_mesh *mesh = kit_mesh(at, 3, corners, 1);
    kit_add(scene, mesh, id);
}

static void add_long_triangle(struct eng_scene *scene, uint32_t id, double x)
{
    add_triangle(scene, id, x, 0);
}

/* Objects far from the origin, of which one is far from the others. Two, 50 apart, go 60
 * along x together, and r is 55. If it failed: frames, in which their boxes are 110
 * apart, would be taken for the way between them, and the contact be missed. */
CASE(step__finds_what_is_within_r_across_a_gap)
{
    for (uint32_t i = 0; i < way_count(); i++) {
        struct eng_question settings = way(i, PCCD_MODE_ANY, 55);
        struct eng_scene *scene = kit_scene();
        add_long_triangle(scene, 1, 0x1p40);
        add_long_triangle(scene, 2, 0x1p40 + 70);
        add_long_triangle(scene, 3, 0x1p40 + 0x1p20);
        eng_stage_begin(scene);
        for (uint32_t object = 0; object < 2; object++) {
            double x[3][3];
            memcpy(x, eng_scene_positions(scene, object, 1), sizeof x);
            for (int v = 0; v < 3; v++) {
                x[v][0] += 60;
            }
            assert_ok(eng_stage_x1(scene, object, PCCD_FORMAT_F64, 0, 3, x));
        }
        struct eng_step_result result = kit_step(scene, &settings);
        assert_int_equal(result.verdict, PCCD_VERDICT_YES);
        eng_scene_free(scene);
    }
}

/* Half of 2^-1074, the least separation there is, is rounded to 0. If it failed, boxes
 * would not grow, and pairs be missed that are just as far apart. */
CASE(step__grows_boxes_for_the_least_separation)
{
    struct eng_question settings = way(0, PCCD_MODE_ANY, 0x1p-1074);
    struct eng_scene *scene = kit_scene();
    kit_add(scene, two_triangles(), 1);
    eng_stage_begin(scene);
    (void)kit_step(scene, &settings);
    assert_true(eng_thickness_growth(scene, &scene->objects[0], 0) > 0);
    eng_scene_free(scene);
}

/* Three soups that go through each other, and are as thick as `radius`. Of the pairs 0, 1
 * and 1, 2 and 2, 0 those are ignored that `ignored` has a bit of. */
static struct eng_scene *three_soups(double radius, unsigned ignored)
{
    struct eng_scene *scene = kit_scene();
    struct prng random = {11};
    for (uint32_t i = 0; i < 3; i++) {
        const struct eng_object_thickness thickness = {.has_radius = true,
                                                       .radius = radius * (i + 1)};
        uint32_t idx = kit_add(scene, kit_soup(&random, 60), i + 1);
        const struct eng_object_filter alone = {1, UINT64_MAX, .self = false};
        assert_ok(eng_scene_set_thickness(scene, idx, &thickness));
        assert_ok(eng_scene_set_filter(scene, idx, &alone));
    }
    for (uint32_t i = 0; i < 3; i++) {
        assert_ok(eng_scene_ignore(scene, i, (i + 1) % 3, ignored >> i & 1));
    }
    return scene;
}

/* Each goes half its size along an axis of its own. */
static void stage_soups(struct eng_scene *scene)
{
    eng_stage_begin(scene);
    for (uint32_t i = 0; i < 3; i++) {
        const double back[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
        double there[12];
        memcpy(there, back, sizeof there);
        there[4 * i + 3] = 0.5;
        assert_ok(eng_stage_rigid(scene, i, 0, 180, back, there));
    }
}

/* Add a hash of the contacts of the soups: a sum over them. */
static void add_hash(uint32_t i, struct eng_scene *scene, double separation,
                     uint64_t hash[2])
{
    struct eng_question settings = way(i, PCCD_MODE_ALL, separation);
    stage_soups(scene);
    struct eng_step_result result = kit_step(scene, &settings);
    assert_true(result.count > 100);
    for (uint64_t k = 0; k < result.count; k++) {
        const struct pccd_contact *contact =
            (const struct pccd_contact *)result.records + k;
        uint64_t words[sizeof *contact / 8];
        memcpy(words, contact, sizeof words);
        for (size_t w = 0; w < sizeof words / sizeof *words; w++) {
            hash[w % 2] += words[w] * (2 * w + 1);
        }
    }
}

/* If it failed: a pair with a clearance would meet at another distance than such a
 * separation, its box would be too small, or it would go on meeting at a clearance that
 * it has no longer. */
CASE(step__knows_clearances_of_pairs)
{
    static const double clearances[3] = {0, 0.04, 0};
    for (uint32_t i = 0; i < way_count(); i++) {
        uint64_t is[2] = {0, 0};
        uint64_t then[2] = {0, 0};
        uint64_t due[2] = {0, 0};
        for (uint32_t pair = 0; pair < 3; pair++) { /* the last one keeps its radii */
            struct eng_scene *one = three_soups(pair < 2 ? 0 : 0.001, 7u ^ 1u << pair);
            add_hash(i, one, 0.003 + clearances[pair], due);
            eng_scene_free(one);
        }
        struct eng_scene *scene = three_soups(0.001, 0);
        add_hash(i, scene, 0.003, then);
        assert_ok(eng_scene_set_pair_clearance(scene, 1, 0, clearances[0]));
        assert_ok(eng_scene_set_pair_clearance(scene, 1, 2, 0.5));
        assert_ok(eng_scene_set_pair_clearance(scene, 2, 1, clearances[1]));
        add_hash(i, scene, 0.003, is);
        assert_memory_equal(is, due, sizeof is);
        assert_ok(eng_scene_ignore(scene, 0, 1, false));
        assert_ok(eng_scene_ignore(scene, 2, 1, true));
        assert_ok(eng_scene_ignore(scene, 2, 1, false));
        memset(is, 0, sizeof is);
        add_hash(i, scene, 0.003, is);
        assert_memory_equal(is, then, sizeof is);
        eng_scene_free(scene);
    }
}

/* If it failed: an object would meet at its radii, or boxes would be too small, once it
 * has another mesh; or a step would count what begins within distances of all kinds. */
CASE(step__keeps_clearances_of_a_mesh_that_is_replaced)
{
    struct eng_question settings = way(0, PCCD_MODE_ANY, 0);
    struct eng_step_result result;
    struct eng_scene *scene = kit_scene();
    kit_add(scene, two_triangles(), 1);
    add_long_triangle(scene, 2, 5);
    assert_ok(eng_scene_set_pair_clearance(scene, 0, 1, 4.5));
    eng_stage_begin(scene);
    assert_int_equal(kit_step(scene, &settings).verdict, PCCD_VERDICT_YES);
    struct eng_mesh *mesh = two_triangles();
    assert_ok(eng_scene_replace(scene, 0, mesh));
    eng_mesh_release(mesh);
    eng_stage_begin(scene);
    assert_int_equal(kit_step(scene, &settings).verdict, PCCD_VERDICT_YES);
    settings.tells_start = true;
    settings.approach = 0.5;
    assert_int_equal(eng_step(scene, &settings, &result), PCCD_E_INVAL);
    assert_int_equal(eng_scene_set_pair_clearance(scene, 0, 1, -1), PCCD_E_INVAL);
    assert_int_equal(eng_scene_set_pair_clearance(scene, 0, 0, 1), PCCD_E_INVAL);
    eng_scene_free(scene);
}

#define RODS 40u

/* Rods between whole places, with noise, whose ends come to few such places. */
static void draw_rods(struct prng *random, double x[2][2 * RODS][3])
{
    double to[3][3];
    for (uint32_t i = 0; i < 9; i++) {
        to[i / 3][i % 3] = (double)prng_u32(random, 3) - 1;
    }
    for (uint32_t i = 0; i < 6 * RODS; i++) {
        double noise = ((double)prng_u32(random, 19) - 9) * 1e-8;
        double place = (double)prng_u32(random, 3) - 1;
        x[0][i / 3][i % 3] = place + (prng_u32(random, 2) ? noise : 0);
        x[1][i / 3][i % 3] = to[i / 6 % 3][i % 3] + (prng_u32(random, 4) ? 0 : noise);
    }
}

static struct eng_scene *scene_of_rods(double x[2 * RODS][3])
{
    const struct eng_mesh_counts counts = {2 * RODS, 0, RODS, 0};
    const struct eng_object_thickness thickness = {.has_radius = true, .radius = 0.25};
    uint32_t ends[RODS][2];
    uint32_t idx;
    for (uint32_t i = 0; i < 2 * RODS; i++) {
        ends[i / 2][i % 2] = i;
    }
    struct eng_mesh *mesh =
        kit_mesh_of(&(struct kit_shape){.counts = counts, .x = x, .edges = ends});
    struct eng_scene *scene = kit_scene();
    assert_ok(eng_scene_add(scene, mesh, 1, &idx));
    assert_ok(eng_scene_set_thickness(scene, idx, &thickness));
    eng_mesh_release(mesh);
    return scene;
}

static void step_rods(struct eng_scene *scene, uint32_t i, double x[2][2 * RODS][3],
                      struct eng_step_result *result)
{
    struct eng_question settings = way(i, PCCD_MODE_ALL, 0);
    settings.approach = 0.3;
    eng_stage_begin(scene);
    assert_ok(eng_stage_x0x1(scene, 0, PCCD_FORMAT_F64, 0, 2 * RODS, x[0], x[1]));
    assert_ok(eng_step(scene, &settings, result));
}

/* A step of rods that shrink to points, by a scene that knows nothing else and by one
 * whose rods were all at one point before. If it failed: a pair would be left undecided,
 * and whether it is told would depend on the boxes and lists that were kept. */
CASE(step__of_rods_does_not_depend_on_the_step_before)
{
    static double x[2][2 * RODS][3];
    static double same[2][2 * RODS][3];
    struct prng random = {5};
    for (uint32_t round = 0; round < 2 * way_count(); round++) {
        struct eng_step_result fresh;
        struct eng_step_result result;
        draw_rods(&random, x);
        struct eng_scene *scene = scene_of_rods(x[0]);
        struct eng_scene *other = scene_of_rods(x[0]);
        step_rods(scene, round % way_count(), x, &fresh);
        step_rods(other, round % way_count(), same, &result);
        step_rods(other, round % way_count(), x, &result);
        assert_true(fresh.count > 0 && fresh.possible == 0);
        assert_int_equal(result.count, fresh.count);
        assert_memory_equal(result.hash, fresh.hash, sizeof fresh.hash);
        eng_scene_free(scene);
        eng_scene_free(other);
    }
}

/* A body of two triangles that lie 1 apart is moved by poses, which prove without
 * thickness that it does not meet itself. If it failed: they would be said to prove that
 * of thick bodies, too. */
CASE(step__tests_thick_bodies_that_poses_move)
{
    static const double pose[2][12] = {{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0},
                                       {1, 0, 0, 3, 0, 1, 0, 0, 0, 0, 1, 0}};
    for (uint32_t method = 0; method < WAY_METHODS; method++) {
        struct eng_question settings = way(method, PCCD_MODE_ALL, 0);
        struct eng_step_result result = {0};
        struct eng_mesh *mesh = two_triangles();
        uint32_t idx;
        assert_ok(eng_mesh_sort_features(mesh, 1));
        struct eng_scene *scene = kit_scene();
        idx = kit_add(scene, mesh, 1);
        for (int i = 0; i < 20; i++) {
            settings.distance = i == 19 ? 1.5 : 0;
            eng_stage_begin(scene);
            assert_ok(eng_stage_rigid(scene, idx, 0, 6, pose[i % 2], pose[(i + 1) % 2]));
            if (i == 19) {
                assert_true(result.counters.rigid_objects == 1 && result.count == 0);
            }
            result = kit_step(scene, &settings);
        }
        assert_true(result.counters.rigid_objects == 0 && result.count > 0 &&
                    result.initial == result.count && result.crowded);
        eng_scene_free(scene);
    }
}

/* Two triangles that lie 1 apart, within r. If it failed: what is exactly as near at rest
 * as the object wants it to be would be left thin, or what is nearer would not. */
CASE(step__leaves_thin_what_is_nearer_at_rest)
{
    for (uint32_t i = 0; i < 2 * WAY_METHODS; i++) {
        struct eng_question settings = way(i / 2, PCCD_MODE_ALL, 1.5);
        const struct eng_object_thickness thickness = {
            .rest_distance = i % 2 == 0 ? 1 : nextafter(1, 2)};
        struct eng_mesh *mesh = two_triangles();
        uint32_t idx;
        struct eng_scene *scene = kit_scene();
        assert_ok(eng_scene_add(scene, mesh, 1, &idx));
        assert_ok(eng_scene_set_thickness(scene, idx, &thickness));
        struct eng_step_result result = kit_step(scene, &settings);
        assert_true((result.count > 0) == (i % 2 == 0));
        eng_mesh_release(mesh);
        eng_scene_free(scene);
    }
}

/* Two objects touch from the beginning; a third one is far away. If it failed: who has
 * one thick object would be told that it is too thick, whatever it is that touches. */
CASE(step__is_crowded_by_thick_objects_alone)
{
    static const struct eng_object_thickness thick = {.has_radius = true, .radius = 1};
    for (uint32_t i = 0; i < 2 * WAY_METHODS; i++) {
        struct eng_question settings =
            way(i / 2, i % 2 == 0 ? PCCD_MODE_ALL : PCCD_MODE_FIRST, 0);
        struct eng_step_result result;
        struct eng_scene *scene = kit_scene();
        add_long_triangle(scene, 1, 0);
        add_long_triangle(scene, 2, 0); /* in the same place */
        add_long_triangle(scene, 3, 1000);
        for (uint32_t object = 3; object-- > 0;) { /* the last one is far away */
            assert_ok(eng_scene_set_thickness(scene, object, &thick));
            eng_stage_begin(scene);
            result = kit_step(scene, &settings);
            assert_true(result.count > 0 && result.initial == result.count);
            assert_int_equal(result.crowded, object < 2);
        }
        eng_scene_free(scene);
    }
}

/* Two triangles touch from the beginning: corner at corner, or a corner on an edge. If it
 * failed: who registers a surface that is split would not be told, or who has bodies that
 * rest on each other would be. */
CASE(step__counts_what_touches_in_vertices)
{
    static const struct eng_object_thickness thick = {.has_radius = true, .radius = 1};
    for (uint32_t i = 0; i < 4 * WAY_METHODS; i++) {
        bool is_split = i % 2 == 0;
        struct eng_question settings =
            way(i / 4, i % 4 < 2 ? PCCD_MODE_ALL : PCCD_MODE_FIRST, 0);
        struct eng_step_result result;
        struct eng_scene *scene = kit_scene();
        add_long_triangle(scene, 1, 0);
        add_triangle(scene, 2, is_split ? 0 : 10, is_split ? 0 : 0.25);
        for (uint32_t again = 0; again < 2; again++) { /* the second is kept */
            eng_stage_begin(scene);
            result = kit_step(scene, &settings);
            assert_true(result.count > 0 && result.initial == result.count);
            assert_int_equal(result.coincident, is_split ? result.count : 0);
            assert_int_equal(result.crowded, is_split);
        }
        assert_ok(eng_scene_set_thickness(scene, 0, &thick));
        eng_stage_begin(scene);
        result = kit_step(scene, &settings);
        assert_true(result.coincident == 0 && result.crowded);
        eng_scene_free(scene);
    }
}

/* If it failed: nonsense would be taken for a length. */
CASE(step__refuses_what_is_no_length)
{
    static const struct {
        double length;
        int status;
    } lengths[] = {{-1, PCCD_E_INVAL},     {NAN, PCCD_E_INVAL}, {INFINITY, PCCD_E_INVAL},
                   {1.1e18, PCCD_E_LIMIT}, {1e18, PCCD_OK},     {0, PCCD_OK}};
    struct eng_mesh *committed = two_triangles();
    struct eng_mesh *mesh;
    uint32_t idx;
    struct eng_scene *scene = kit_scene();
    assert_ok(eng_scene_add(scene, committed, 1, &idx));
    assert_ok(eng_mesh_new(3, 1, &mesh));
    for (size_t i = 0; i < sizeof lengths / sizeof lengths[0]; i++) {
        struct eng_object_thickness thickness = {.has_radius = true,
                                                 .radius = lengths[i].length};
        struct eng_question settings = way(0, PCCD_MODE_ALL, 0);
        struct eng_step_result result;
        assert_int_equal(eng_scene_set_thickness(scene, idx, &thickness),
                         lengths[i].status);
        assert_int_equal(eng_mesh_write_radii(mesh, 2, 1, &lengths[i].length),
                         lengths[i].status);
        thickness = (struct eng_object_thickness){.rest_distance = lengths[i].length};
        assert_int_equal(eng_scene_set_thickness(scene, idx, &thickness),
                         lengths[i].status);
        settings.distance = lengths[i].length;
        assert_int_equal(eng_step(scene, &settings, &result), lengths[i].status);
        settings.distance = 0;
        settings.approach = lengths[i].length == 0 ? 1 : lengths[i].length;
        assert_int_equal(eng_step(scene, &settings, &result), PCCD_E_INVAL);
    }
    struct eng_object_thickness thickness;
    assert_ok(eng_scene_get_thickness(scene, idx, &thickness));
    assert_true(!thickness.has_radius && thickness.rest_distance == 0);
    assert_int_equal(eng_scene_get_thickness(scene, 9, &thickness), PCCD_E_INVAL);
    thickness.rest_rings = 9;
    assert_int_equal(eng_scene_set_thickness(scene, idx, &thickness), PCCD_E_LIMIT);
    double radius = 1;
    assert_int_equal(eng_mesh_write_radii(mesh, 3, 1, &radius), PCCD_E_INVAL);
    assert_int_equal(eng_mesh_write_radii(committed, 0, 1, &radius), PCCD_E_STATE);
    eng_mesh_release(mesh);
    eng_mesh_release(committed);
    eng_scene_free(scene);
}

/* If this failed, nobody could stop a search that takes long; or one that was stopped
 * would have changed something, or would be taken for done. */
CASE(rings__are_not_kept_when_they_were_cancelled)
{
    struct eng_mesh *mesh = kit_sheet(4, 0);
    struct eng_mesh *other = kit_sheet(5, 0);
    const struct eng_object_thickness thickness = {.rest_rings = 3};
    atomic_bool cancel = true;
    uint32_t idx;
    struct eng_scene *scene = kit_scene();
    assert_ok(eng_scene_add(scene, mesh, 1, &idx));
    assert_int_equal(eng_scene_prepare_rings(scene, 9, NULL, 3, NULL), PCCD_E_INVAL);
    assert_int_equal(eng_scene_prepare_rings(scene, idx, NULL, 9, NULL), PCCD_E_LIMIT);
    uint64_t bytes = eng_mesh_bytes(mesh);
    assert_ok(eng_scene_prepare_rings(scene, idx, NULL, 0, &cancel));
    assert_int_equal(eng_scene_prepare_rings(scene, idx, NULL, 3, &cancel),
                     PCCD_E_CANCELLED);
    assert_int_equal(eng_scene_prepare_rings(scene, idx, other, 3, &cancel),
                     PCCD_E_CANCELLED);
    assert_int_equal(eng_mesh_bytes(mesh), bytes);
    assert_ok(eng_scene_set_thickness(scene, idx, &thickness));
    assert_true(eng_mesh_bytes(mesh) > bytes);
    assert_ok(eng_scene_prepare_rings(scene, idx, NULL, 3, &cancel));
    cancel = false;
    assert_ok(eng_scene_prepare_rings(scene, idx, other, 3, &cancel));
    assert_ok(eng_scene_replace(scene, idx, other));
    eng_scene_free(scene);
    eng_mesh_release(mesh);
    eng_mesh_release(other);
}
