/* test_eng_thick_plays.c - steps of thick objects against all pairs.
 *
 * Play small random scenes of two objects of triangles, edges and points, and compare
 * what steps say in every mode, and what is near, with all pairs decided by the oracle:
 * by both methods, one and two threads, every instruction set; while radii, rest,
 * separation and approach change and much stands still, near the origin and far from it.
 */
#include "eng_kit.h"
#include "eng_way.h"
#include "thick_judge.h"

#define TOLERANCE 1e-6
#define OBJECTS   2u
#define TRIANGLES 4u
#define VERTICES  (TRIANGLES + 2)
#define NAMED_MAX 8u
#define WAYS_MAX  32u

/* ---- the step ---------------------------------------------------------------------- */

/* Mesh of an object, as it is named. */
struct shape {
    uint32_t triangle_count;
    uint32_t edge_count;
    uint32_t point_count;
    uint32_t triangles[TRIANGLES][3];
    uint32_t edges[NAMED_MAX][2];
    uint32_t points[NAMED_MAX];
};

struct body {
    struct eng_mesh *mesh;
    struct shape shape;
    double x[2][VERTICES][3]; /* at both ends of the step */
    double radii[VERTICES];   /* of the mesh; not 0: it has some */
    double thick[VERTICES];   /* these, or the object's own */
    double rest[VERTICES][3]; /* as registered */
    struct eng_object_thickness thickness;
};

struct thick_play {
    struct prng prng;
    struct body bodies[OBJECTS];
    double separation;
    double approach;
    double base; /* where object 1 is along x, .. */
    double far;  /* .. and object 2, beside it */
    double unit;
    uint64_t contacts[PCCD_KIND_COUNT]; /* of all steps so far */
    struct thick_truths truths;
    struct eng_scene *scenes[WAYS_MAX];
};

/* The scene as the oracle takes it. */
static struct thick_step view(struct thick_play *play,
                              struct oracle_object objects[OBJECTS])
{
    for (uint32_t i = 0; i < OBJECTS; i++) {
        struct body *body = &play->bodies[i];
        const struct shape *shape = &body->shape;
        for (uint32_t v = 0; v < VERTICES; v++) {
            body->thick[v] =
                body->thickness.has_radius ? body->thickness.radius : body->radii[v];
        }
        objects[i] =
            (struct oracle_object){.object_id = i + 1,
                                   .vertex_count = VERTICES,
                                   .triangle_count = shape->triangle_count,
                                   .x0 = (const double(*)[3])body->x[0],
                                   .x1 = (const double(*)[3])body->x[1],
                                   .triangles = (const uint32_t(*)[3])shape->triangles,
                                   .edge_count = shape->edge_count,
                                   .point_count = shape->point_count,
                                   .edges = (const uint32_t(*)[2])shape->edges,
                                   .points = shape->points,
                                   .radii = body->thick,
                                   .registered = (const double(*)[3])body->rest,
                                   .rest_distance = body->thickness.rest_distance,
                                   .rest_rings = body->thickness.rest_rings};
    }
    return (struct thick_step){.objects = objects,
                               .object_count = OBJECTS,
                               .separation = play->separation,
                               .approach = play->approach,
                               .tolerance = TOLERANCE};
}

static struct eng_question way(const struct thick_play *play, uint32_t i,
                               enum pccd_mode mode)
{
    struct eng_question settings = kit_contacts(mode, PCCD_METHOD_DEFAULT);
    settings.tolerance = TOLERANCE;
    settings.distance = play->separation;
    settings.approach = play->approach;
    way_choose(i, &settings);
    return settings;
}

/* Take the step in every way, and compare the first answer with the truth. */
static void step(struct thick_play *play, enum pccd_mode mode)
{
    struct eng_step_result first;
    void *records = NULL;
    struct oracle_object objects[OBJECTS];
    const struct thick_step seen = view(play, objects);
    thick_judge_forget(&play->truths);
    assert_true(thick_judge_decide(&seen, 4 * play->unit, SIZE_MAX, &play->truths));
    for (uint32_t i = 0; i < way_count(); i++) {
        struct eng_question settings = way(play, i, mode);
        struct eng_step_result result = kit_step(play->scenes[i], &settings);
        assert_true(way_tree_is_sound(play->scenes[i], &result));
        if (i == 0) {
            const char *wrong =
                thick_judge(&seen, &play->truths, &result, play->contacts);
            if (wrong) {
                fail_msg("%s", wrong);
            }
            first = result;
            records = test_copy(result.records, result.count * result.record_bytes);
        }
        assert_int_equal(result.count, first.count);
        assert_memory_equal(result.hash, first.hash, sizeof first.hash);
        assert_memory_equal(result.records, records, first.count * first.record_bytes);
        assert_true(result.safe_step == first.safe_step);
    }
    free(records);
}

/* ---- chance ------------------------------------------------------------------------ */

/* Multiples of a fourth: features are often exactly r apart, or go along at that
 * distance. Or any doubles. */
static double draw_coordinate(struct thick_play *play, double size)
{
    double x = prng_between(&play->prng, -size, size);
    return play->unit * (prng_below(&play->prng, 3) > 0 ? rint(4 * x) / 4 : x);
}

static void draw_point(struct thick_play *play, uint32_t object, double x[3])
{
    for (int k = 0; k < 3; k++) {
        x[k] = draw_coordinate(play, 3);
    }
    x[0] += play->base + (object == 1 ? play->far : 0);
}

static double draw_length(struct thick_play *play)
{
    static const double lengths[8] = {0, 0, 0x1p-2, 0x1p-20, 0.1, 0.5, 1, 0.3};
    return play->unit * lengths[prng_below(&play->prng, 8)];
}

/* ---- what is near ------------------------------------------------------------------ */

static void check_near(struct thick_play *play, const struct eng_step_result *result,
                       double distance, uint32_t end)
{
    const struct pccd_near *records = result->records;
    struct oracle_object objects[OBJECTS];
    const struct thick_step seen = view(play, objects);
    uint64_t at = 0;
    assert_int_equal(result->incomplete, PCCD_COMPLETE);
    for (size_t i = 0; i < play->truths.count; i++) {
        const struct pccd_pair *name = &play->truths.items[i].name;
        if (thick_judge_is_near(&seen, &play->truths.items[i], distance, end)) {
            const struct pccd_near *record = &records[at++];
            assert_true(at <= result->count && name->kind == record->kind &&
                        name->object_a == record->object_a &&
                        name->feature_a == record->feature_a &&
                        name->object_b == record->object_b &&
                        name->feature_b == record->feature_b);
        }
    }
    assert_int_equal(at, result->count);
}

/* The names of a step's pairs are those that are near at an end of it. */
static void ask(struct thick_play *play)
{
    struct eng_step_result first;
    double distance = draw_length(play);
    uint32_t end = prng_u32(&play->prng, 2);
    for (uint32_t i = 0; i < way_count(); i++) {
        struct eng_question settings = way(play, i, PCCD_MODE_ALL);
        settings.verb = PCCD_NEAR_PAIRS;
        settings.distance = distance;
        settings.end = end;
        struct eng_step_result result = kit_near(play->scenes[i], &settings);
        if (i == 0) {
            check_near(play, &result, distance, end);
            first = result;
        }
        assert_int_equal(result.count, first.count);
        assert_memory_equal(result.hash, first.hash, sizeof first.hash);
    }
}

/* ---- plays ------------------------------------------------------------------------- */

static void draw_thickness(struct thick_play *play)
{
    static const double approaches[4] = {0, 0, 0.25, 0.1};
    play->approach = approaches[prng_below(&play->prng, 4)];
    if (prng_below(&play->prng, 3) == 0) {
        return;
    }
    for (uint32_t object = 0; object < OBJECTS; object++) {
        struct body *body = &play->bodies[object];
        body->thickness = (struct eng_object_thickness){
            .has_radius = prng_below(&play->prng, 3) > 0, .radius = draw_length(play)};
        if (prng_below(&play->prng, 3) == 0) {
            body->thickness.rest_distance = 4 * draw_length(play);
            body->thickness.rest_rings = prng_u32(&play->prng, 3);
        }
        for (uint32_t i = 0; i < way_count(); i++) {
            assert_ok(eng_scene_set_thickness(play->scenes[i], object, &body->thickness));
        }
    }
    play->separation = prng_below(&play->prng, 2) ? 0 : draw_length(play);
}

/* A strip; a triangle with a tail and what lies around; rods, of which one is named twice
 * and one has no length; a cloud, in which one vertex is not named. */
static const struct shape shapes[] = {
    {.triangle_count = 4, .triangles = {{0, 1, 2}, {1, 2, 3}, {2, 3, 4}, {3, 4, 5}}},
    {1, 4, 3, {{0, 1, 2}}, {{3, 2}, {0, 1}, {4, 3}, {5, 5}}, {1, 4, 5}},
    {0, 5, 2, {{0}}, {{5, 5}, {1, 0}, {1, 2}, {0, 1}, {3, 3}}, {4, 2}},
    {.edge_count = 3, .edges = {{0, 1}, {4, 2}, {3, 5}}},
    {.point_count = 6, .points = {5, 0, 3, 2, 0, 1}},
};
#define SHAPES (sizeof shapes / sizeof shapes[0])

/* A body's shape at its first positions, with radii of vertices if any is not 0. */
static struct eng_mesh *make_mesh(const struct body *body)
{
    const struct shape *shape = &body->shape;
    const struct eng_mesh_counts counts = {VERTICES, shape->triangle_count,
                                           shape->edge_count, shape->point_count};
    bool is_thick = false;
    for (uint32_t v = 0; v < VERTICES; v++) {
        is_thick = is_thick || body->radii[v] > 0;
    }
    return kit_mesh_of(&(struct kit_shape){counts, body->x[1], shape->triangles,
                                           shape->edges, shape->points,
                                           is_thick ? body->radii : NULL});
}

/* Begin a play with objects of the first `kinds` of the shapes. */
static void begin(struct thick_play *play, uint64_t seed, uint32_t kinds, double base,
                  double far, double unit)
{
    *play = (struct thick_play){.prng = {seed}, .base = base, .far = far, .unit = unit};
    assert_true(way_count() <= WAYS_MAX);
    for (uint32_t i = 0; i < way_count(); i++) {
        play->scenes[i] = kit_scene();
    }
    for (uint32_t object = 0; object < OBJECTS; object++) {
        struct body *body = &play->bodies[object];
        bool has_radii = prng_below(&play->prng, 2) > 0;
        for (uint32_t v = 0; v < VERTICES; v++) {
            draw_point(play, object, body->x[1][v]);
            body->radii[v] = has_radii ? draw_length(play) : 0;
        }
        memcpy(body->rest, body->x[1], sizeof body->rest);
        body->shape = shapes[prng_below(&play->prng, kinds)];
        body->mesh = make_mesh(body);
        for (uint32_t i = 0; i < way_count(); i++) {
            uint32_t idx;
            assert_ok(eng_scene_add(play->scenes[i], body->mesh, object + 1, &idx));
            assert_int_equal(idx, object);
        }
    }
}

static void end(struct thick_play *play)
{
    thick_judge_forget(&play->truths);
    for (uint32_t i = 0; i < way_count(); i++) {
        eng_scene_free(play->scenes[i]);
    }
    for (uint32_t object = 0; object < OBJECTS; object++) {
        eng_mesh_release(play->bodies[object].mesh);
    }
}

/* Move all, some or none of the vertices. */
static void move(struct thick_play *play)
{
    uint64_t part = prng_below(&play->prng, 3);
    for (uint32_t i = 0; i < way_count(); i++) {
        eng_stage_begin(play->scenes[i]);
    }
    for (uint32_t object = 0; object < OBJECTS; object++) {
        struct body *body = &play->bodies[object];
        memcpy(body->x[0], body->x[1], sizeof body->x[0]);
        for (uint32_t v = 0; v < VERTICES; v++) {
            if (part == 0 || (part == 1 && prng_below(&play->prng, VERTICES) > 0)) {
                continue;
            }
            draw_point(play, object, body->x[1][v]);
            for (uint32_t i = 0; i < way_count(); i++) {
                assert_ok(eng_stage_x1(play->scenes[i], object, PCCD_FORMAT_F64, v, 1,
                                       body->x[1][v]));
            }
        }
    }
}

/* Adds the contacts to contacts[..], by kind. */
static void play_steps(uint64_t seed, uint32_t kinds, double base, double far,
                       double unit, uint64_t *contacts)
{
    struct thick_play play;
    begin(&play, seed, kinds, base, far, unit);
    enum pccd_mode mode = (enum pccd_mode)(seed % PCCD_MODE_COUNT);
    for (uint32_t i = 0; i < 5; i++) {
        if (i == 0 || prng_below(&play.prng, 2)) {
            draw_thickness(&play);
        }
        move(&play);
        step(&play, mode);
        if (prng_below(&play.prng, 2)) {
            draw_thickness(&play);
        }
        ask(&play);
    }
    for (uint32_t kind = 0; kind < PCCD_KIND_COUNT; kind++) {
        contacts[kind] += play.contacts[kind];
    }
    end(&play);
}

/* If it failed: pairs that come within r would be missed or invented, at another time or
 * by some way of finding them; or boxes and records of an earlier radius would be
 * kept. */
CASE(step__says_of_thick_objects_what_all_pairs_say)
{
    uint64_t contacts[PCCD_KIND_COUNT] = {0};
    for (uint64_t i = 0; i < 8; i++) {
        play_steps(prng_seed() + i, 1, 0, 0.5, 1, contacts);
    }
}

/* Objects that lie apart, where their boxes are measured in frames: of tiny features, and
 * far from the origin. If it failed: frames would take objects within r for apart. */
CASE(step__says_so_where_boxes_have_frames)
{
    uint64_t contacts[PCCD_KIND_COUNT] = {0};
    for (uint64_t i = 0; i < 8; i++) {
        double unit = i % 2 ? 0x1p-40 : 1;
        double base = i % 4 == 0 ? 0x1p40 : 0;
        play_steps(prng_seed() + 100 + i, SHAPES, base, unit * (i % 3 ? 7 : 0x1p40), unit,
                   contacts);
    }
}

/* If it failed: free edges or points would be missed or taken for what they are not, by a
 * method, a number of threads or an instruction set: a rod that passes through a rod, two
 * points that come within r, a point that is named and a corner besides. */
CASE(step__says_of_edges_and_points_what_all_pairs_say)
{
    uint64_t contacts[PCCD_KIND_COUNT] = {0};
    for (uint64_t i = 0; i < 32; i++) {
        play_steps(prng_seed() + 200 + i, SHAPES, 0, 0.5, 1, contacts);
    }
    print_message(
        "contacts: VF %llu, EE %llu, VE %llu, VV %llu\n",
        (unsigned long long)contacts[PCCD_VF], (unsigned long long)contacts[PCCD_EE],
        (unsigned long long)contacts[PCCD_VE], (unsigned long long)contacts[PCCD_VV]);
    for (uint32_t kind = 0; kind < PCCD_KIND_COUNT; kind++) {
        assert_true(contacts[kind] > 0);
    }
}
