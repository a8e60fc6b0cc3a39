/* test_eng_near.c - what is near at one moment, against exact arithmetic on all pairs.
 *
 * Room:     tests/property. May include: daemon/engine, oracle, tests/support,
 *           tests/unit, cmocka.
 * Does:     random scenes of a few objects whose features touch, cross, are parallel or
 *           equally far away; between steps each question is put at either end, by both
 *           methods, teams and instruction sets, some of it with a motion in the same
 *           request. Every record is computed once more from the definition. A second
 *           scene that is asked nothing has to take the same steps.
 * Threads:  teams of one to three.
 * Source:   PCCD_SEED repeats a sequence; PCCD_PROPERTY_SECONDS says for how long.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "clock.h"
#include "eng_kit.h"
#include "eng_way.h"
#include "hash.h"
#include "near.h"
#include "oracle_distance.h"
#include "oracle_scene.h"
#include "prng.h"
#include "step.h"

#define SEQUENCES   60
#define STEPS       5u
#define OBJECTS_MAX 3u
#define THREADS_MAX 3u
#define VERTICES    24u
#define TRIANGLES   16u
#define RECORDS_MAX 200000u

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
    struct eng_near_settings settings;
};

static struct {
    uint64_t sequences, questions, records, bounds, crossings, free, merged, types[4];
} sums;

static uint32_t draw(struct sequence *s, uint32_t bound)
{
    return (uint32_t)prng_below(&s->prng, bound);
}

static void must(const struct sequence *s, bool holds, const char *what)
{
    if (!holds) {
        char way[WAY_TEXT_MAX];
        way_tell(&s->settings.step, way);
        fail_msg("PCCD_SEED=%llu, what %d, end %u, d %a, %s: %s",
                 (unsigned long long)s->seed, (int)s->settings.what, s->settings.end,
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
    return (struct oracle_object){
        object->id,   object->vertex_count, object->triangle_count,
        object->x[0], object->x[1],         (const uint32_t(*)[3])object->triangles};
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
        assert_int_equal(eng_scene_add(scene, mesh, id, &object->idx[i]), PCCD_OK);
        assert_int_equal(eng_scene_set_filter(scene, object->idx[i], &filter), PCCD_OK);
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
    assert_int_equal(eng_scene_new(NULL, &s->scene), PCCD_OK);
    assert_int_equal(eng_scene_new(NULL, &s->other), PCCD_OK);
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
            assert_int_equal(eng_stage_x1(scene, object->idx[which], PCCD_FORMAT_F64, 0,
                                          object->vertex_count, object->next),
                             PCCD_OK);
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

/* ---- what is due ------------------------------------------------------------------- */

struct due {
    struct pccd_near records[RECORDS_MAX];
    uint32_t count;
    uint64_t touches;
    double bound[OBJECTS_MAX][VERTICES];
};

static struct due due;

static bool may_meet(const struct sequence *s, uint32_t a, uint32_t b)
{
    return a == b ? s->objects[a].self : !(s->ignores && a < 2 && b < 2);
}

struct feature {
    uint32_t object; /* its index here */
    uint32_t feature;
    uint32_t count;
    uint32_t v[3];
};

static struct feature feature_of(const struct sequence *s, uint32_t object,
                                 uint32_t points, uint32_t index)
{
    const struct object *of = &s->objects[object];
    struct feature feature = {object, index, points, {index, index, index}};
    if (points == 2) {
        memcpy(feature.v, of->edges[index], sizeof of->edges[index]);
    } else if (points == 3) {
        memcpy(feature.v, of->triangles[index], sizeof of->triangles[index]);
    }
    return feature;
}

static bool shares(const struct feature *a, const struct feature *b)
{
    bool is_shared = false;
    for (uint32_t i = 0; i < a->count; i++) {
        for (uint32_t k = 0; k < b->count; k++) {
            is_shared |= a->object == b->object && a->v[i] == b->v[k];
        }
    }
    return is_shared;
}

static uint64_t key_of(const struct sequence *s, uint32_t object, uint32_t index)
{
    return (uint64_t)s->objects[object].id << 32 | index;
}

static void load(const struct sequence *s, const struct feature *a,
                 const struct feature *b, double p[5][3], uint8_t rank[5])
{
    uint64_t keys[5];
    uint32_t n = 0;
    for (int side = 0; side < 2; side++) {
        const struct feature *f = side ? b : a;
        for (uint32_t i = 0; i < f->count; i++) {
            memcpy(p[n], s->objects[f->object].x[s->settings.end][f->v[i]], sizeof p[n]);
            keys[n++] = key_of(s, f->object, f->v[i]);
        }
    }
    for (uint32_t i = 0; i < n; i++) {
        rank[i] = 0;
        for (uint32_t k = 0; k < n; k++) {
            rank[i] =
                (uint8_t)(rank[i] + (keys[k] < keys[i] || (keys[k] == keys[i] && k < i)));
        }
    }
}

static void add_due(const struct sequence *s, uint32_t kind, const struct feature *a,
                    const struct feature *b, const struct oracle_distance *at)
{
    assert_true(due.count < RECORDS_MAX);
    struct pccd_near *record = &due.records[due.count++];
    *record = (struct pccd_near){.kind = kind,
                                 .flags = (uint32_t)at->type << 8,
                                 .object_a = s->objects[a->object].id,
                                 .feature_a = a->feature,
                                 .object_b = s->objects[b->object].id,
                                 .feature_b = b->feature,
                                 .d_lo = at->lo,
                                 .d_hi = at->hi,
                                 .count = 1};
    for (int k = 0; k < 3; k++) {
        record->direction[k] = (float)at->direction[k];
    }
    record->param[0] = (float)at->param[0];
    record->param[1] = (float)at->param[1];
}

static uint32_t edge_of(const struct object *object, uint32_t v, uint32_t w)
{
    for (uint32_t e = 0; e < object->edge_count; e++) {
        if (object->edges[e][0] == (v < w ? v : w) &&
            object->edges[e][1] == (v < w ? w : v)) {
            return e;
        }
    }
    fail_msg("no edge %u %u", v, w);
    return 0;
}

/* The features between which the distance is, and what the oracle says of these two
 * alone. */
static void add_closest(const struct sequence *s, const struct feature *a,
                        const struct feature *b, const struct oracle_distance *at)
{
    struct feature near[2] = {*a, *b};
    for (uint32_t side = 0; side < 2; side++) {
        struct feature *f = &near[side];
        uint32_t kept = 0;
        for (uint32_t i = 0; i < (side ? b : a)->count; i++) {
            if (at->points >> (i + (side ? a->count : 0)) & 1) {
                f->v[kept++] = (side ? b : a)->v[i];
            }
        }
        f->count = kept;
        f->feature = kept == 1   ? f->v[0]
                     : kept == 2 ? edge_of(&s->objects[f->object], f->v[0], f->v[1])
                                 : f->feature;
        if (kept == 2) {
            memcpy(f->v, s->objects[f->object].edges[f->feature], 2 * sizeof f->v[0]);
        }
    }
    bool turned =
        near[0].count > near[1].count || (near[0].count == 1 && near[1].count == 1 &&
                                          key_of(s, near[0].object, near[0].v[0]) >
                                              key_of(s, near[1].object, near[1].v[0]));
    const struct feature *first = &near[turned];
    const struct feature *second = &near[!turned];
    uint32_t kind = first->count == 2    ? (uint32_t)PCCD_EE
                    : second->count == 3 ? (uint32_t)PCCD_VF
                    : second->count == 2 ? (uint32_t)PCCD_VE
                                         : (uint32_t)PCCD_VV;
    struct oracle_distance found = *at;
    double p[5][3];
    double q[4][3];
    uint8_t rank[5];
    load(s, first, second, p, rank);
    if (kind == PCCD_VE || kind == PCCD_VV) {
        static const uint8_t any[4] = {0, 1, 2, 3};
        memcpy(q[0], p[0], sizeof q[0]);
        memcpy(q[1], p[0], sizeof q[1]);
        memcpy(q[2], p[1], sizeof q[2]);
        memcpy(q[3], p[kind == PCCD_VE ? 2 : 1], sizeof q[3]);
        oracle_distance_find(ORACLE_EE, (const double(*)[3])q, any, &found);
        found.type = at->type;
        found.param[0] = 0;
        found.param[1] = kind == PCCD_VE ? found.param[1] : 0;
    }
    sums.types[kind]++;
    add_due(s, kind, first, second, &found);
}

static void note_bounds(const struct sequence *s, const struct feature *f, double lo)
{
    (void)s;
    for (uint32_t i = 0; i < f->count; i++) {
        double *bound = &due.bound[f->object][f->v[i]];
        *bound = fmin(*bound, lo);
    }
}

static void test_pair(const struct sequence *s, uint32_t kind, const struct feature *a,
                      const struct feature *b)
{
    double p[5][3];
    uint8_t rank[5];
    enum oracle_kind as = kind == PCCD_VF ? ORACLE_VF : ORACLE_EE;
    if (shares(a, b) || !may_meet(s, a->object, b->object)) {
        return;
    }
    load(s, a, b, p, rank);
    if (kind == (uint32_t)PCCD_EF) {
        struct oracle_distance nothing = {.type = ORACLE_NEAREST_VF};
        if (oracle_crosses((const double(*)[3])p)) {
            add_due(s, kind, a, b, &nothing);
        }
        return;
    }
    bool crosses = s->settings.what == PCCD_NEAR_CROSSINGS;
    if (!oracle_distance_within(as, (const double(*)[3])p,
                                crosses ? 0 : s->settings.distance)) {
        return;
    }
    struct oracle_distance at;
    switch (s->settings.what) {
    case PCCD_NEAR_CROSSINGS:
        due.touches++;
        return;
    case PCCD_NEAR_VERTICES:
        oracle_distance_find(as, (const double(*)[3])p, rank, &at);
        note_bounds(s, a, at.lo);
        note_bounds(s, b, at.lo);
        return;
    case PCCD_NEAR_FEATURES:
        oracle_distance_find(as, (const double(*)[3])p, rank, &at);
        add_closest(s, a, b, &at);
        return;
    default:
        oracle_distance_find(as, (const double(*)[3])p, rank, &at);
        add_due(s, kind, a, b, &at);
    }
}

/* Is vertex v of any triangle? Others are not tested. */
static bool is_named(const struct object *object, uint32_t v)
{
    for (uint32_t i = 0; i < object->triangle_count; i++) {
        for (int k = 0; k < 3; k++) {
            if (object->triangles[i][k] == v) {
                return true;
            }
        }
    }
    return false;
}

static void test_objects(const struct sequence *s, uint32_t a, uint32_t b)
{
    const struct object *of_a = &s->objects[a];
    const struct object *of_b = &s->objects[b];
    for (uint32_t f = 0; f < of_b->triangle_count; f++) {
        struct feature face = feature_of(s, b, 3, f);
        for (uint32_t v = 0; v < of_a->vertex_count; v++) {
            struct feature vertex = feature_of(s, a, 1, v);
            if (is_named(of_a, v)) {
                test_pair(s, PCCD_VF, &vertex, &face);
            }
        }
        for (uint32_t e = 0;
             s->settings.what == PCCD_NEAR_CROSSINGS && e < of_a->edge_count; e++) {
            struct feature edge = feature_of(s, a, 2, e);
            test_pair(s, (uint32_t)PCCD_EF, &edge, &face);
        }
    }
    for (uint32_t e = 0; e < of_a->edge_count; e++) {
        struct feature first = feature_of(s, a, 2, e);
        for (uint32_t f = 0; f < of_b->edge_count; f++) {
            struct feature second = feature_of(s, b, 2, f);
            if (key_of(s, a, e) < key_of(s, b, f)) {
                test_pair(s, PCCD_EE, &first, &second);
            }
        }
    }
}

static int compare(const void *a, const void *b)
{
    const struct pccd_near *x = a;
    const struct pccd_near *y = b;
    const uint32_t names[2][5] = {
        {x->kind, x->object_a, x->feature_a, x->object_b, x->feature_b},
        {y->kind, y->object_a, y->feature_a, y->object_b, y->feature_b}};
    for (int i = 0; i < 5; i++) {
        if (names[0][i] != names[1][i]) {
            return names[0][i] < names[1][i] ? -1 : 1;
        }
    }
    return 0;
}

static void merge_due(void)
{
    uint32_t kept = 0;
    for (uint32_t i = 0; i < due.count; i++) {
        if (kept > 0 && compare(&due.records[kept - 1], &due.records[i]) == 0) {
            due.records[kept - 1].count++;
            sums.merged++;
        } else {
            due.records[kept++] = due.records[i];
        }
    }
    due.count = kept;
}

static void find_due(const struct sequence *s)
{
    due.count = 0;
    due.touches = 0;
    for (uint32_t i = 0; i < OBJECTS_MAX * VERTICES; i++) {
        due.bound[i / VERTICES][i % VERTICES] = s->settings.distance;
    }
    for (uint32_t a = 0; a < s->object_count; a++) {
        for (uint32_t b = 0; b < s->object_count; b++) {
            test_objects(s, a, b);
        }
    }
    qsort(due.records, due.count, sizeof due.records[0], compare);
    if (s->settings.what == PCCD_NEAR_FEATURES) {
        merge_due();
    }
}

/* ---- what is answered -------------------------------------------------------------- */

static void check_bounds(const struct sequence *s, const struct eng_near_result *result)
{
    const double *bound = result->records;
    for (uint32_t i = s->object_count; i-- > 0;) { /* ids go down */
        if (s->settings.objects[0] != 0 && s->objects[i].id != s->settings.objects[0]) {
            continue;
        }
        for (uint32_t v = 0; v < s->objects[i].vertex_count; v++) {
            must(s, *bound++ == due.bound[i][v], "the bound of a vertex");
            sums.bounds++;
        }
    }
    must(s, (uint64_t)(bound - (const double *)result->records) == result->count,
         "how many bounds there are");
}

static void check_records(const struct sequence *s, const struct eng_near_result *result)
{
    const struct pccd_near *records = result->records;
    must(s, result->count == due.count, "how many records there are");
    for (uint32_t i = 0; i < due.count; i++) {
        must(s, compare(&records[i], &due.records[i]) == 0, "the name of a record");
        must(s, memcmp(&records[i], &due.records[i], sizeof *records) == 0,
             "what a record says");
    }
    uint64_t hash[2];
    eng_hash_end(eng_hash_records(due.records, due.count, sizeof due.records[0]),
                 due.count, hash);
    must(s, memcmp(hash, result->hash, sizeof hash) == 0, "the hash");
    sums.records += due.count;
}

/* How far two vertices are apart along an axis, or by their places: often a distance that
 * is met exactly. */
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
    const struct eng_step_settings defaults = ENG_STEP_SETTINGS_DEFAULT;
    struct eng_near_result result;
    s->settings = (struct eng_near_settings){.step = defaults,
                                             .what = questions[draw(s, 4)],
                                             .end = draw(s, 2),
                                             .distance = s->size * distances[draw(s, 5)]};
    if (s->settings.what == PCCD_NEAR_VERTICES && draw(s, 2)) {
        s->settings.objects[0] = s->objects[draw(s, s->object_count)].id;
    }
    way_draw(&s->prng, THREADS_MAX, &s->settings.step);
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
    find_due(s);
    sums.questions++;
    if (s->settings.what == PCCD_NEAR_VERTICES) {
        check_bounds(s, &result);
        return;
    }
    check_records(s, &result);
    if (s->settings.what == PCCD_NEAR_CROSSINGS) {
        bool is_free = due.count == 0 && due.touches == 0;
        must(s, result.crossings == due.count, "how many crossings there are");
        must(s, result.verdict == (is_free ? PCCD_VERDICT_NO : PCCD_VERDICT_YES),
             "whether the state is free of intersections");
        sums.crossings += due.count;
        sums.free += is_free;
    }
}

/* A step of both scenes; what was asked of the one changes nothing. */
static void step_both(struct sequence *s)
{
    struct eng_step_settings settings = ENG_STEP_SETTINGS_DEFAULT;
    struct eng_step_result result[2];
    settings.mode = (enum pccd_mode)draw(s, PCCD_MODE_COUNT);
    way_draw(&s->prng, THREADS_MAX, &settings);
    s->settings.step = settings;
    draw_motion(s);
    for (int i = 0; i < 2; i++) {
        struct eng_scene *scene = i ? s->other : s->scene;
        stage(s, scene, i);
        assert_int_equal(eng_step(scene, &settings, &result[i]), PCCD_OK);
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
    sums.sequences++;
}

/* If it failed: somebody would be told of a distance, a crossing or a safe bound that is
 * not so, or not be told; or asking would change what the next step answers. */
static void near__is_what_the_oracle_finds(void **state)
{
    const char *seconds = getenv("PCCD_PROPERTY_SECONDS");
    uint64_t until_ns =
        seconds ? common_now_ns() + strtoull(seconds, NULL, 0) * 1000000000 : 0;
    uint64_t seed = prng_seed();
    (void)state;
    for (uint64_t i = 0; until_ns ? common_now_ns() < until_ns : i < SEQUENCES; i++) {
        play(seed + i);
    }
    print_message("# %llu sequences, %llu questions, %llu records, %llu merged, "
                  "%llu bounds, %llu crossings, %llu free; vf %llu ee %llu ve %llu vv "
                  "%llu\n",
                  (unsigned long long)sums.sequences, (unsigned long long)sums.questions,
                  (unsigned long long)sums.records, (unsigned long long)sums.merged,
                  (unsigned long long)sums.bounds, (unsigned long long)sums.crossings,
                  (unsigned long long)sums.free, (unsigned long long)sums.types[PCCD_VF],
                  (unsigned long long)sums.types[PCCD_EE],
                  (unsigned long long)sums.types[PCCD_VE],
                  (unsigned long long)sums.types[PCCD_VV]);
    assert_true(sums.records > 0 && sums.merged > 0 && sums.crossings > 0);
    if (!getenv("PCCD_SEED")) {
        assert_true(sums.free > 0);
    }
}

/* A strip of triangles along x. */
static uint32_t add_strip(struct eng_scene *scene, uint32_t id, double from, double to)
{
    double x[12][3];
    uint32_t triangles[10][3];
    uint32_t idx;
    for (uint32_t i = 0; i < 12; i++) {
        x[i][0] = from + (to - from) * (i / 2) / 5;
        x[i][1] = i % 2;
        x[i][2] = 0;
    }
    for (uint32_t i = 0; i < 10; i++) {
        for (uint32_t k = 0; k < 3; k++) {
            triangles[i][k] = i + k;
        }
    }
    struct eng_mesh *mesh =
        kit_mesh((const double(*)[3])x, 12, (const uint32_t(*)[3])triangles, 10);
    assert_int_equal(eng_scene_add(scene, mesh, id, &idx), PCCD_OK);
    eng_mesh_release(mesh);
    return idx;
}

static void stretch(struct eng_scene *scene, uint32_t idx, double from, double to)
{
    double x[12][3];
    for (uint32_t i = 0; i < 12; i++) {
        x[i][0] = from + (to - from) * (i / 2) / 5;
        x[i][1] = i % 2;
        x[i][2] = 0;
    }
    assert_int_equal(eng_stage_x1(scene, idx, PCCD_FORMAT_F64, 0, 12, x), PCCD_OK);
}

/* If it failed: where a scene is so sparse that gaps between its objects are shortened,
 * an object that shrinks would seem to leave its neighbour behind. */
static void near__finds_what_lies_beside_what_shrinks(void **state)
{
    const struct eng_step_settings defaults = ENG_STEP_SETTINGS_DEFAULT;
    (void)state;
    for (uint32_t m = 0; m < WAY_METHODS; m++) {
        struct eng_scene *scene;
        struct eng_step_settings step = defaults;
        struct eng_step_result stepped;
        struct eng_near_result result;
        assert_int_equal(eng_scene_new(NULL, &scene), PCCD_OK);
        uint32_t shrinks = add_strip(scene, 1, 0, 10);
        uint32_t follows = add_strip(scene, 2, 11, 11.5);
        add_strip(scene, 3, 1e9, 1e9 + 10);
        step.method = way_methods[m];
        eng_stage_begin(scene);
        stretch(scene, shrinks, 0, 1);
        stretch(scene, follows, 2, 2.5);
        assert_int_equal(eng_step(scene, &step, &stepped), PCCD_OK);
        struct eng_near_settings settings = {
            .step = step, .what = PCCD_NEAR_PAIRS, .end = 1, .distance = 1};
        assert_int_equal(eng_near(scene, &settings, &result), PCCD_OK);
        uint32_t between = 0;
        for (uint64_t i = 0; i < result.count; i++) {
            const struct pccd_near *record = (const struct pccd_near *)result.records + i;
            between += record->object_a != record->object_b;
        }
        assert_true(between > 0);
        eng_scene_free(scene);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(near__is_what_the_oracle_finds),
        cmocka_unit_test(near__finds_what_lies_beside_what_shrinks),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
