/* test_eng_near_objects.c - the nearest features of objects, how deep they are in each
 * other, and all other pairs of theirs that are near, against exact arithmetic that looks
 * at everything.
 *
 * Small objects at random, some with free edges and points, with coordinates of all bits,
 * on a coarse grid (where almost everything is equally near, touches, or is met by a ray
 * at an edge), far away or tiny, some with radii or left thin for their rest, not all of
 * which may meet; beside each other, or farther apart than floats can tell beside their
 * size; moved, asked again for either end, by both methods, every instruction set and
 * several threads. Every record must be the one that the oracle finds, with its numbers;
 * with a gap, one of the same two objects. Two objects have a nearest pair exactly if
 * there is any pair of theirs. A scene that was asked nothing takes the same steps.
 */
#include "eng_kit.h"
#include "eng_way.h"
#include "near_judge.h"
#include "sequences.h"

#define SCENES      200
#define ASKED       6u
#define QUERIES_MAX 1000u /* exact decisions for one answer about all pairs */
#define THREADS_MAX 3u
#define OBJECTS_MAX 4u
#define POINTS_MAX  12u

static struct near_sums judged;
static uint64_t scenes;
static uint64_t outside; /* vertices in no other object */
static uint64_t of_free; /* nearest pairs of free edges and points .. */
static uint64_t of_rods; /* .. and records of depth of objects that have such */
static uint64_t named;   /* two objects that were named and may not meet */
static uint64_t steps;   /* that had records */

struct shape {
    struct eng_mesh *mesh;
    uint32_t points;
    uint32_t face_count;
    uint32_t faces[20][3];
    uint32_t edge_count, point_count; /* that are named by themselves */
    uint32_t edges[4][2];
    uint32_t named_points[4];
    double registered[POINTS_MAX][3];
    double x[2][POINTS_MAX][3]; /* at both ends */
    double away[3];             /* from where the others are */
    double radii[POINTS_MAX];   /* as the mesh has them, or the object */
    struct eng_object_thickness thickness;
    struct eng_object_filter filter;
};

struct scene {
    uint64_t seed;
    struct prng prng;
    struct shape shapes[OBJECTS_MAX];
    bool is_apart[OBJECTS_MAX][OBJECTS_MAX];   /* they may not meet */
    bool is_ignored[OBJECTS_MAX][OBJECTS_MAX]; /* by name */
    bool is_sparse;                            /* objects are far from each other */
    uint32_t end;
    double grid; /* 0: none */
    double place;
    double scale;
};

static uint32_t draw(struct scene *scene, uint32_t bound)
{
    return prng_u32(&scene->prng, bound);
}

static void must(const struct scene *scene, bool holds, const char *what)
{
    if (!holds) {
        fail_msg("PCCD_SEED=%llu: %s", (unsigned long long)scene->seed, what);
    }
}

static double coordinate(struct scene *scene, double middle)
{
    double x = scene->grid > 0 ? (double)draw(scene, 5) * scene->grid
                               : prng_between(&scene->prng, 0, 1);
    return scene->place + scene->scale * (middle + x);
}

/* At one end; sometimes all objects are in one place, sometimes beside each other. */
static void place(struct scene *scene, uint32_t end, double spread)
{
    for (uint32_t i = 0; i < kit.count; i++) {
        double middle[3];
        for (int k = 0; k < 3; k++) {
            middle[k] = spread * (double)draw(scene, 4);
        }
        for (uint32_t v = 0; v < scene->shapes[i].points; v++) {
            for (int k = 0; k < 3; k++) {
                scene->shapes[i].x[end][v][k] =
                    coordinate(scene, middle[k]) + scene->shapes[i].away[k];
            }
        }
    }
}

/* Beside others, or farther from them than floats can tell apart beside its size. */
static void go_away(struct scene *scene, struct shape *shape)
{
    for (int k = 0; k < 3; k++) {
        double far_away = floor(exp2(draw(scene, 31))) * (draw(scene, 2) ? 1 : -1);
        double beside = 1 + draw(scene, 3);
        shape->away[k] = draw(scene, 3) == 0 ? far_away : draw(scene, 2) ? beside : 0;
    }
}

/* As far as objects on the grid often are from each other. */
static double some_radius(struct scene *scene)
{
    return scene->scale * 0.125 * draw(scene, 5);
}

/* The last object has one radius for all, whatever its mesh has, or leaves pairs thin. */
static void set_thickness(struct scene *scene, struct shape *shape)
{
    struct eng_object_thickness *thickness = &shape->thickness;
    thickness->has_radius = draw(scene, 2) > 0;
    if (thickness->has_radius) {
        thickness->radius = some_radius(scene);
        for (uint32_t v = 0; v < shape->points; v++) {
            shape->radii[v] = thickness->radius;
        }
    }
    thickness->rest_rings = draw(scene, 3) == 0 ? 1 : 0;
    thickness->rest_distance = draw(scene, 3) == 0 ? 0.25 : 0;
    assert_ok(eng_scene_set_thickness(kit.scene, kit.idx[kit.count - 1], thickness));
}

/* Some two objects may not meet, for their masks or by name. */
static void separate(struct scene *scene)
{
    const struct eng_object_filter alone = {1, 2, true};
    uint32_t only = draw(scene, 3 * kit.count); /* meets itself alone, or not even */
    for (uint32_t a = 0; a < kit.count; a++) {
        for (uint32_t b = 0; b < a; b++) {
            bool is_ignored = draw(scene, 5) == 0;
            assert_ok(eng_scene_ignore(kit.scene, kit.idx[a], kit.idx[b], is_ignored));
            scene->is_ignored[a][b] = is_ignored;
            scene->is_apart[a][b] = scene->is_apart[b][a] =
                is_ignored || a == only || b == only;
        }
    }
    if (only < kit.count) {
        scene->shapes[only].filter = alone;
        assert_ok(eng_scene_set_filter(kit.scene, kit.idx[only], &alone));
    }
}

/* Some shapes have edges and points by themselves, or nothing else. */
static void add_free(struct scene *scene, struct shape *shape)
{
    uint32_t more = draw(scene, 5);
    shape->points +=
        more < POINTS_MAX - shape->points ? more : POINTS_MAX - shape->points;
    shape->edge_count = draw(scene, 5);
    shape->point_count = draw(scene, 5);
    for (uint32_t i = 0; i < 4; i++) {
        shape->edges[i][0] = draw(scene, shape->points);
        shape->edges[i][1] = draw(scene, shape->points);
        shape->named_points[i] = draw(scene, shape->points);
    }
    if (draw(scene, 3) == 0 && shape->edge_count + shape->point_count > 0) {
        shape->face_count = 0;
    }
}

/* Triangles between points at random, or a closed surface: an octahedron with its points
 * anywhere, twice as many faces if it is doubled. */
static void make(struct scene *scene, struct shape *shape, bool is_closed)
{
    static const uint32_t closed[8][3] = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                                          {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
    uint32_t copies = 1 + draw(scene, 2);
    double(*x)[3] = shape->registered;
    memset(shape, 0, sizeof *shape);
    shape->points = is_closed ? 6 * copies : 3 + draw(scene, POINTS_MAX - 3);
    shape->face_count = is_closed ? 8 * copies : 1 + draw(scene, 12);
    for (uint32_t i = 0; i < shape->face_count; i++) {
        bool turns = i >= 8 && shape->points == 12 && scene->seed % 3 == 0;
        for (uint32_t k = 0; k < 3; k++) {
            uint32_t corner = turns ? (3 - k) % 3 : k;
            shape->faces[i][k] = is_closed ? closed[i % 8][corner] + 6 * (i / 8)
                                           : draw(scene, shape->points);
        }
    }
    if (draw(scene, 2) == 0) {
        add_free(scene, shape);
    }
    for (uint32_t v = 0; v < shape->points; v++) {
        for (int k = 0; k < 3; k++) {
            x[v][k] = prng_between(&scene->prng, 0, 1);
        }
    }
    bool has_radii = draw(scene, 2) > 0;
    for (uint32_t v = 0; has_radii && v < shape->points; v++) {
        shape->radii[v] = some_radius(scene);
    }
    shape->mesh =
        kit_mesh_of(&(struct kit_shape){.counts = {shape->points, shape->face_count,
                                                   shape->edge_count, shape->point_count},
                                        .x = shape->registered,
                                        .triangles = shape->faces,
                                        .edges = shape->edges,
                                        .points = shape->named_points,
                                        .radii = has_radii ? shape->radii : NULL});
    kit_put(shape->mesh);
    shape->filter = (struct eng_object_filter)ENG_OBJECT_FILTER_DEFAULT;
    if (scene->is_sparse) {
        go_away(scene, shape);
    }
    if (draw(scene, 3) == 0) {
        set_thickness(scene, shape);
    }
}

static void move(struct scene *scene, struct eng_scene *at, const uint32_t *idx)
{
    eng_stage_begin(at);
    for (uint32_t i = 0; i < kit.count; i++) {
        const struct shape *shape = &scene->shapes[i];
        assert_ok(eng_stage_x0x1(at, idx[i], PCCD_FORMAT_F64, 0, shape->points,
                                 shape->x[0], shape->x[1]));
    }
}

/* A step of the scene, and of one that is made anew and was asked nothing. */
static void check_step(struct scene *scene)
{
    struct eng_question settings = ENG_QUESTION_DEFAULT;
    struct eng_step_result results[2];
    struct eng_scene *fresh = kit_scene();
    uint32_t idx[OBJECTS_MAX];
    settings.mode = (enum pccd_mode)draw(scene, PCCD_MODE_COUNT);
    for (uint32_t a = 0; a < kit.count; a++) {
        const struct shape *shape = &scene->shapes[a];
        assert_ok(eng_scene_add(fresh, shape->mesh, a + 1, &idx[a]));
        assert_ok(eng_scene_set_filter(fresh, idx[a], &shape->filter));
        assert_ok(eng_scene_set_thickness(fresh, idx[a], &shape->thickness));
        for (uint32_t b = 0; b < a; b++) {
            assert_ok(eng_scene_ignore(fresh, idx[a], idx[b], scene->is_ignored[a][b]));
        }
    }
    for (int i = 0; i < 2; i++) {
        struct eng_scene *at = i == 0 ? kit.scene : fresh;
        way_draw(&scene->prng, THREADS_MAX, &settings);
        move(scene, at, i == 0 ? kit.idx : idx);
        results[i] = kit_step(at, &settings);
    }
    must(scene, results[0].count == results[1].count, "a step's records, counted");
    must(scene,
         memcmp(results[0].hash, results[1].hash, sizeof results[0].hash) == 0 &&
             results[0].verdict == results[1].verdict,
         "a step's hash or verdict");
    steps += results[0].count > 0;
    eng_scene_free(fresh);
}

/* ---- the truth ------------------------------------------------------------------ */

static bool may_meet(const void *context, uint32_t id_a, uint32_t id_b)
{
    const struct scene *scene = context;
    return !scene->is_apart[id_a - 1][id_b - 1];
}

/* ---- questions ------------------------------------------------------------------ */

/* The scene as the oracle takes it. Ids of objects are their places + 1 (eng_kit.h). */
static const char *judge(const struct scene *scene, const struct eng_question *settings,
                         const struct eng_step_result *result)
{
    struct oracle_object objects[OBJECTS_MAX];
    const struct oracle_moment moment = {.objects = objects,
                                         .object_count = kit.count,
                                         .may_meet = may_meet,
                                         .context = scene};
    bool is_of_objects =
        settings->verb == PCCD_NEAR_NEAREST || /* it takes few decisions */
        settings->verb == PCCD_NEAR_DEPTH;
    for (uint32_t i = 0; i < kit.count; i++) {
        const struct shape *shape = &scene->shapes[i];
        const double(*x)[3] = (const double(*)[3])shape->x[scene->end];
        objects[i] =
            (struct oracle_object){.object_id = i + 1,
                                   .vertex_count = shape->points,
                                   .triangle_count = shape->face_count,
                                   .x0 = x,
                                   .x1 = x,
                                   .triangles = (const uint32_t(*)[3])shape->faces,
                                   .edges = (const uint32_t(*)[2])shape->edges,
                                   .edge_count = shape->edge_count,
                                   .points = shape->named_points,
                                   .point_count = shape->point_count,
                                   .radii = shape->radii,
                                   .registered = (const double(*)[3])shape->registered,
                                   .rest_distance = shape->thickness.rest_distance,
                                   .rest_rings = shape->thickness.rest_rings};
    }
    return near_judge(&moment, settings, result, is_of_objects ? UINT64_MAX : QUERIES_MAX,
                      &judged);
}

static struct eng_step_result ask(struct scene *scene, struct eng_question settings)
{
    way_draw(&scene->prng, THREADS_MAX, &settings);
    settings.team_always = true;
    settings.end = scene->end;
    struct eng_step_result result = kit_near(kit.scene, &settings);
    must(scene, result.incomplete == PCCD_COMPLETE, "it is not complete");
    return result;
}

static struct eng_step_result check(struct scene *scene, struct eng_question settings)
{
    struct eng_step_result result = ask(scene, settings);
    settings.end = scene->end;
    const char *wrong = judge(scene, &settings, &result);
    must(scene, !wrong, wrong);
    return result;
}

/* Add which objects have a pair in an answer. */
static void add_twos(const struct eng_step_result *result,
                     bool twos[OBJECTS_MAX][OBJECTS_MAX])
{
    for (uint64_t i = 0; i < result->count; i++) {
        const struct pccd_near *record = kit_record(result, i);
        uint32_t a = record->object_a - 1;
        uint32_t b = record->object_b - 1;
        twos[a][b] = twos[b][a] = a != b;
    }
}

/* One rule says what is within the distance: what pairs or crossings have. */
static void check_rule(struct scene *scene, const struct eng_question *nearest,
                       bool is_near[OBJECTS_MAX][OBJECTS_MAX])
{
    struct eng_question settings = *nearest;
    bool twos[OBJECTS_MAX][OBJECTS_MAX] = {{false}};
    settings.objects[0] = settings.objects[1] = 0;
    settings.verb = PCCD_NEAR_PAIRS;
    struct eng_step_result result = ask(scene, settings);
    add_twos(&result, twos);
    settings.verb = PCCD_NEAR_CROSSINGS;
    result = ask(scene, settings);
    add_twos(&result, twos);
    for (uint32_t a = 0; a < kit.count; a++) {
        for (uint32_t b = 0; b < kit.count; b++) {
            bool is_asked = true;
            for (int side = 0; side < 2; side++) {
                uint32_t only = nearest->objects[side];
                is_asked = is_asked && (only == 0 || only == a + 1 || only == b + 1);
            }
            must(scene, is_near[a][b] == (is_asked && twos[a][b]),
                 "nearest differs from pairs and crossings in who is near");
        }
    }
}

static void check_nearest(struct scene *scene)
{
    struct eng_question settings = kit_question(PCCD_NEAR_NEAREST);
    bool twos[OBJECTS_MAX][OBJECTS_MAX] = {{false}};
    if (draw(scene, 3) > 0) {
        settings.distance = scene->scale * (double)draw(scene, 9) * 0.125;
    }
    if (draw(scene, 2) == 0) {
        settings.gap = scene->scale * (double)draw(scene, 9) * 0.125;
    }
    for (int side = 0; side < 2 && draw(scene, 2) == 0; side++) {
        settings.objects[side] = 1 + draw(scene, kit.count);
    }
    if (settings.objects[0] == settings.objects[1]) {
        settings.objects[0] = 0;
    }
    named += settings.objects[0] != 0 && settings.objects[1] != 0 &&
             scene->is_apart[settings.objects[0] - 1][settings.objects[1] - 1];
    struct eng_step_result result = check(scene, settings);
    add_twos(&result, twos);
    of_free += result.counts[PCCD_VE] + result.counts[PCCD_VV];
    if (isfinite(settings.distance)) {
        check_rule(scene, &settings, twos);
    }
}

/* Return how far two vertices are apart along an axis, or by their places: often a
 * distance that is met exactly. */
static double distance_between(struct scene *scene)
{
    const double *x[2];
    double d[3];
    uint32_t k = draw(scene, 4);
    for (int side = 0; side < 2; side++) {
        const struct shape *shape = &scene->shapes[draw(scene, kit.count)];
        x[side] = shape->x[scene->end][draw(scene, shape->points)];
    }
    for (int i = 0; i < 3; i++) {
        d[i] = fabs(x[0][i] - x[1][i]);
    }
    return fmin(k < 3 ? d[k] : hypot(hypot(d[0], d[1]), d[2]), 1e18);
}

static void check_pairs(struct scene *scene)
{
    static const enum pccd_near_what whats[] = {PCCD_NEAR_PAIRS, PCCD_NEAR_FEATURES,
                                                PCCD_NEAR_VERTICES, PCCD_NEAR_CROSSINGS};
    struct eng_question settings = kit_question(whats[draw(scene, 4)]);
    settings.distance = draw(scene, 3) > 0 ? scene->scale * (double)draw(scene, 6) * 0.125
                                           : distance_between(scene);
    if (settings.verb == PCCD_NEAR_VERTICES && draw(scene, 2) > 0) {
        settings.objects[0] = 1 + draw(scene, kit.count);
    }
    check(scene, settings);
}

static void check_depth(struct scene *scene)
{
    struct eng_step_result result = check(scene, kit_question(PCCD_NEAR_DEPTH));
    for (uint32_t i = 0; i < kit.count * kit.count; i++) {
        uint32_t a = i / kit.count;
        uint32_t b = i % kit.count;
        outside += a != b && !scene->is_apart[a][b] ? scene->shapes[a].points : 0;
    }
    outside -= result.count;
    for (uint64_t i = 0; i < result.count; i++) {
        const struct shape *of = &scene->shapes[kit_record(&result, i)->object_a - 1];
        of_rods += of->edge_count + of->point_count > 0;
    }
}

static void live(uint64_t seed)
{
    static const double places[][2] = {{0, 1},         {0, 1},         {1e6, 1},
                                       {-3, 0x1p-40},  {1e12, 0x1p12}, {0, 1e-200},
                                       {1e17, 0x1p20}, {0, 0x1p36}};
    struct scene scene = {.seed = seed, .prng = {seed}};
    uint32_t at = draw(&scene, sizeof places / sizeof places[0]);
    bool is_closed = draw(&scene, 2) == 0;
    scene.place = places[at][0];
    scene.scale = places[at][1];
    scene.grid = draw(&scene, 2) == 0 ? 0.25 : 0;
    scene.is_sparse = scene.scale == 1 && draw(&scene, 3) == 0;
    kit_begin();
    uint32_t count = 2 + draw(&scene, OBJECTS_MAX - 1);
    for (uint32_t i = 0; i < count; i++) {
        make(&scene, &scene.shapes[i], is_closed);
    }
    if (draw(&scene, 2) == 0) {
        separate(&scene);
    }
    for (uint32_t i = 0; i < ASKED; i++) {
        if (i == 0 || draw(&scene, 2) == 0) {
            double spread = draw(&scene, 3) == 0 ? 0.5 : draw(&scene, 4) == 0 ? 1e6 : 0;
            place(&scene, 0, spread);
            place(&scene, 1, spread);
            if (draw(&scene, 3) == 0) {
                check_step(&scene);
            } else { /* the question moves the scene */
                move(&scene, kit.scene, kit.idx);
            }
        }
        scene.end = draw(&scene, 2);
        uint32_t question = draw(&scene, 4);
        if (question == 0 && is_closed) {
            check_depth(&scene);
        } else if (question == 1) {
            check_pairs(&scene);
        } else {
            check_nearest(&scene);
        }
    }
    scenes++;
}

/* If this failed, a body would be taken for farther away than it is, or for outside of
 * what it is in; or the answer would depend on how it was found. */
CASE(objects__are_as_near_and_as_deep_as_the_oracle_says)
{
    sequences_live(live, SCENES, NULL);
    print_message("# %llu scenes, %llu steps with records, %llu named in vain, %llu not "
                  "inside, %llu of free edges and points, %llu deep\n",
                  (unsigned long long)scenes, (unsigned long long)steps,
                  (unsigned long long)named, (unsigned long long)outside,
                  (unsigned long long)of_free, (unsigned long long)of_rods);
    near_sums_tell(&judged);
    if (!getenv("PCCD_SEED") && scenes >= SCENES) {
        assert_true(judged.nearest > 0 && judged.ties > 0 &&
                    judged.touching_objects > 0 && judged.inside > 0 && outside > 0 &&
                    judged.through > 0 && judged.thick > 0 && judged.crossed > 0 &&
                    judged.gaps > 0 && judged.others > 0 && named > 0 &&
                    judged.pairs > 0 && judged.bounds > 0 && of_free > 0 && of_rods > 0);
        assert_true(judged.merged > 0 && judged.crossings > 0 && judged.free > 0 &&
                    judged.at_distance > 0 && steps > 0);
    }
}
