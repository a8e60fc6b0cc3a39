/* test_eng_near.c - what is near at one moment, against exact arithmetic on all pairs.
 *
 * Random scenes of a few objects whose features touch, cross, are parallel or equally far
 * away; between steps each question is put at either end, by both methods, teams and
 * instruction sets, some of it with a motion in the same request. Every record is
 * computed once more from the definition. A second scene that is asked nothing has to
 * take the same steps.
 */
#include "eng_kit.h"
#include "eng_way.h"
#include "near_judge.h"
#include "sequences.h"

#define SEQUENCES   60
#define STEPS       5u
#define OBJECTS_MAX 3u
#define THREADS_MAX 3u
#define VERTICES    24u
#define TRIANGLES   16u

struct object {
    uint32_t id;
    uint32_t idx[2]; /* in either scene */
    uint32_t vertex_count, triangle_count, edge_count;
    double x[2][VERTICES][3]; /* at both ends of the last motion */
    double next[VERTICES][3];
    uint32_t triangles[TRIANGLES][3];
    uint32_t (*edges)[2];
    double away[3]; /* from where the others are */
    bool self;
};

struct sequence {
    uint64_t seed;
    struct prng prng;
    struct eng_scene *scene; /* that is asked */
    struct eng_scene *other; /* that is not */
    struct object objects[OBJECTS_MAX];
    uint32_t object_count;
    bool ignores; /* the first two objects ignore each other */
    double size;
    double offset[3];
    bool is_sparse; /* objects are far from each other */
    struct eng_question settings;
};

static struct near_sums judged;

static uint32_t draw(struct sequence *s, uint32_t bound)
{
    return prng_u32(&s->prng, bound);
}

static void must(const struct sequence *s, bool holds, const char *what)
{
    if (!holds) {
        char way[WAY_TEXT_MAX];
        way_tell(&s->settings, way);
        fail_msg("PCCD_SEED=%llu, what %d, end %u, d %a, %s: %s",
                 (unsigned long long)s->seed, (int)s->settings.verb, s->settings.end,
                 s->settings.distance, way, what);
    }
}

/* ---- scenes ------------------------------------------------------------------------ */

/* Coarse coordinates make features parallel, coplanar and equally far away. */
static void place_vertex(struct sequence *s, const struct object *object, bool is_coarse,
                         double x[3])
{
    for (int k = 0; k < 3; k++) {
        double at = is_coarse ? draw(s, 5) / 4.0 : prng_between(&s->prng, 0, 1);
        x[k] = s->size * at + s->offset[k] + object->away[k];
    }
}

/* Beside others, or farther from them than floats can tell apart beside its size. */
static void go_away(struct sequence *s, struct object *object)
{
    for (int k = 0; k < 3 && s->is_sparse; k++) {
        double far_away = floor(exp2((double)draw(s, 31))) * (draw(s, 2) ? 1 : -1);
        double beside = 1 + draw(s, 3);
        object->away[k] = draw(s, 3) == 0 ? far_away : draw(s, 2) ? beside : 0;
    }
}

static void make_object(struct sequence *s, struct object *object, bool is_coarse)
{
    memset(object, 0, sizeof *object);
    object->vertex_count = 3 + draw(s, VERTICES - 2);
    object->triangle_count = 1 + draw(s, TRIANGLES);
    go_away(s, object);
    for (uint32_t i = 0; i < object->vertex_count; i++) {
        place_vertex(s, object, is_coarse, object->x[0][i]);
    }
    memcpy(object->x[1], object->x[0], sizeof object->x[0]);
    for (uint32_t i = 0; i < object->triangle_count; i++) {
        for (int k = 0; k < 3; k++) {
            object->triangles[i][k] = draw(s, object->vertex_count);
        }
    }
}

static struct oracle_object view(const struct object *object)
{
    return (struct oracle_object){.object_id = object->id,
                                  .vertex_count = object->vertex_count,
                                  .triangle_count = object->triangle_count,
                                  .x0 = object->x[0],
                                  .x1 = object->x[1],
                                  .triangles = (const uint32_t(*)[3])object->triangles};
}

static void add_object(struct sequence *s, uint32_t id, bool is_coarse)
{
    struct object *object = &s->objects[s->object_count++];
    make_object(s, object, is_coarse);
    object->id = id;
    object->self = draw(s, 5) > 0;
    struct eng_mesh *mesh =
        kit_mesh((const double(*)[3])object->x[0], object->vertex_count,
                 (const uint32_t(*)[3])object->triangles, object->triangle_count);
    struct oracle_object seen = view(object);
    object->edges = oracle_edges(&seen, &object->edge_count);
    for (int i = 0; i < 2; i++) {
        struct eng_scene *scene = i ? s->other : s->scene;
        struct eng_object_filter filter = ENG_OBJECT_FILTER_DEFAULT;
        filter.self = object->self;
        assert_ok(eng_scene_add(scene, mesh, id, &object->idx[i]));
        assert_ok(eng_scene_set_filter(scene, object->idx[i], &filter));
    }
    eng_mesh_release(mesh);
}

static void begin(struct sequence *s, uint64_t seed)
{
    static const double far_away[] = {0, 0, 0, 1e3, 1e9, -1e17};
    memset(s, 0, sizeof *s);
    s->seed = seed;
    s->prng.state = seed;
    s->size = exp2(draw(s, 3) ? 0 : floor(prng_between(&s->prng, -300, 50)));
    for (int k = 0; k < 3; k++) {
        s->offset[k] = s->size == 1 ? far_away[draw(s, 6)] : 0;
    }
    s->scene = kit_scene();
    s->other = kit_scene();
    s->is_sparse = s->size == 1 && draw(s, 2);
    bool is_coarse = draw(s, 2);
    uint32_t count = 1 + draw(s, OBJECTS_MAX);
    for (uint32_t i = 0; i < count; i++) {
        add_object(s, 10 - 3 * i, is_coarse); /* ids go down as indices go up */
    }
    s->ignores = count > 1 && draw(s, 4) == 0;
    if (s->ignores) {
        eng_scene_ignore(s->scene, s->objects[0].idx[0], s->objects[1].idx[0], true);
        eng_scene_ignore(s->other, s->objects[0].idx[1], s->objects[1].idx[1], true);
    }
}

static void end(struct sequence *s)
{
    for (uint32_t i = 0; i < s->object_count; i++) {
        free(s->objects[i].edges);
    }
    eng_scene_free(s->scene);
    eng_scene_free(s->other);
}

/* New positions of some objects, staged in a scene. */
static void draw_motion(struct sequence *s)
{
    bool is_coarse = draw(s, 2);
    for (uint32_t i = 0; i < s->object_count; i++) {
        struct object *object = &s->objects[i];
        bool moves = draw(s, 3) > 0;
        if (moves && draw(s, 4) == 0) {
            go_away(s, object);
        }
        memcpy(object->next, object->x[1], sizeof object->next);
        for (uint32_t v = 0; moves && v < object->vertex_count; v++) {
            if (draw(s, 3) > 0) {
                place_vertex(s, object, is_coarse, object->next[v]);
            }
        }
    }
}

static void stage(struct sequence *s, struct eng_scene *scene, int which)
{
    eng_stage_begin(scene);
    for (uint32_t i = 0; i < s->object_count; i++) {
        const struct object *object = &s->objects[i];
        if (memcmp(object->next, object->x[1], sizeof object->next) != 0) {
            assert_ok(eng_stage_x1(scene, object->idx[which], PCCD_FORMAT_F64, 0,
                                   object->vertex_count, object->next));
        }
    }
}

static void arrive(struct sequence *s)
{
    for (uint32_t i = 0; i < s->object_count; i++) {
        struct object *object = &s->objects[i];
        memcpy(object->x[0], object->x[1], sizeof object->x[0]);
        memcpy(object->x[1], object->next, sizeof object->x[1]);
    }
}

static bool may_meet(const void *context, uint32_t id_a, uint32_t id_b)
{
    const struct sequence *s = context;
    uint32_t a = 0;
    uint32_t b = 0;
    for (uint32_t i = 0; i < s->object_count; i++) {
        a = s->objects[i].id == id_a ? i : a;
        b = s->objects[i].id == id_b ? i : b;
    }
    return a == b ? s->objects[a].self : !(s->ignores && a < 2 && b < 2);
}

static void check_answer(const struct sequence *s, const struct eng_step_result *result)
{
    struct oracle_object objects[OBJECTS_MAX];
    for (uint32_t i = 0; i < s->object_count; i++) {
        const struct object *object =
            &s->objects[s->object_count - 1 - i]; /* ids go down */
        objects[i] = view(object);
        objects[i].x0 = objects[i].x1 = object->x[s->settings.end];
    }
    const struct oracle_moment moment = {.objects = objects,
                                         .object_count = s->object_count,
                                         .may_meet = may_meet,
                                         .context = s};
    const char *wrong = near_judge(&moment, &s->settings, result, UINT64_MAX, &judged);
    must(s, !wrong, wrong);
}

/* Return how far two vertices are apart along an axis, or by their places: often a
 * distance that is met exactly. */
static double distance_between(struct sequence *s)
{
    double x[2][3];
    for (int i = 0; i < 2; i++) {
        const struct object *object = &s->objects[draw(s, s->object_count)];
        memcpy(x[i], object->x[s->settings.end][draw(s, object->vertex_count)],
               sizeof x[i]);
    }
    uint32_t k = draw(s, 4);
    double d =
        k < 3 ? fabs(x[0][k] - x[1][k])
              : hypot(hypot(x[0][0] - x[1][0], x[0][1] - x[1][1]), x[0][2] - x[1][2]);
    return fmin(d, 1e18);
}

static void ask(struct sequence *s, bool moves)
{
    static const enum pccd_near_what questions[] = {
        PCCD_NEAR_PAIRS, PCCD_NEAR_FEATURES, PCCD_NEAR_VERTICES, PCCD_NEAR_CROSSINGS};
    static const double distances[] = {0, 0.25, 0.1, 0.5, 1e-3};
    struct eng_step_result result;
    s->settings = (struct eng_question)ENG_QUESTION_DEFAULT;
    s->settings.verb = questions[draw(s, 4)];
    s->settings.end = draw(s, 2);
    s->settings.distance = s->size * distances[draw(s, 5)];
    if (s->settings.verb == PCCD_NEAR_VERTICES && draw(s, 2)) {
        s->settings.objects[0] = s->objects[draw(s, s->object_count)].id;
    }
    way_draw(&s->prng, THREADS_MAX, &s->settings);
    if (moves) {
        draw_motion(s);
        stage(s, s->scene, 0);
        arrive(s);
    }
    if (draw(s, 3) == 0) {
        s->settings.distance = distance_between(s);
    }
    must(s, eng_near(s->scene, &s->settings, &result) == PCCD_OK, "it is answered");
    must(s, result.incomplete == PCCD_COMPLETE, "it is complete");
    check_answer(s, &result);
}

/* A step of both scenes; what was asked of the one changes nothing. */
static void step_both(struct sequence *s)
{
    struct eng_question settings = ENG_QUESTION_DEFAULT;
    struct eng_step_result result[2];
    settings.mode = (enum pccd_mode)draw(s, PCCD_MODE_COUNT);
    way_draw(&s->prng, THREADS_MAX, &settings);
    s->settings = settings;
    draw_motion(s);
    for (int i = 0; i < 2; i++) {
        struct eng_scene *scene = i ? s->other : s->scene;
        stage(s, scene, i);
        result[i] = kit_step(scene, &settings);
    }
    arrive(s);
    must(s, result[0].count == result[1].count, "a step's records, counted");
    must(s, memcmp(result[0].hash, result[1].hash, sizeof result[0].hash) == 0,
         "a step's hash");
    must(s, result[0].verdict == result[1].verdict, "a step's verdict");
}

static void play(uint64_t seed)
{
    static struct sequence s;
    begin(&s, seed);
    for (uint32_t i = 0; i < STEPS; i++) {
        uint32_t questions = draw(&s, 3);
        for (uint32_t k = 0; k < questions; k++) {
            ask(&s, false);
        }
        step_both(&s);
    }
    ask(&s, false);
    ask(&s, true);
    ask(&s, true);
    ask(&s, false);
    end(&s);
}

/* If it failed: somebody would be told of a distance, a crossing or a safe bound that is
 * not so, or not be told; or asking would change what the next step answers. */
CASE(near__is_what_the_oracle_finds)
{
    sequences_live(play, SEQUENCES, NULL);
    print_message(
        "# %llu questions, %llu pairs, %llu features, %llu merged, %llu bounds, "
        "%llu crossings, %llu free; vf %llu ee %llu ve %llu vv %llu\n",
        (unsigned long long)judged.judged, (unsigned long long)judged.pairs,
        (unsigned long long)judged.features, (unsigned long long)judged.merged,
        (unsigned long long)judged.bounds, (unsigned long long)judged.crossings,
        (unsigned long long)judged.free, (unsigned long long)judged.types[PCCD_VF],
        (unsigned long long)judged.types[PCCD_EE],
        (unsigned long long)judged.types[PCCD_VE],
        (unsigned long long)judged.types[PCCD_VV]);
    assert_true(judged.pairs > 0 && judged.merged > 0 && judged.crossings > 0);
    if (!getenv("PCCD_SEED")) {
        assert_true(judged.free > 0);
    }
}
