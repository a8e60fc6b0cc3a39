/* test_eng_turning_scenes.c - whole steps of small scenes in which bodies turn, against
 * an oracle that is asked of every pair of features by intervals.
 *
 * Each of three objects turns on joints, which two of them may share, deforms, goes from
 * one pose to another, or stands; each has some faces, a free edge and a free point.
 * Every mode, by every method, number of threads and instruction set.
 *
 * PCCD_TURNING_SCENES: so many are tried.
 */
#include "cases.h"
#include "coordinates.h"
#include "eng_kit.h"
#include "eng_way.h"
#include "scene.h"
#include "stage_turning.h"
#include "turning_truth.h"

#define OBJECTS    3u
#define VERTICES   9u /* 6 of faces, 2 of the free edge, the free point */
#define FACES      4u
#define EDGES_MAX  (3 * FACES + 1)
#define TOLERANCE  0x1p-20
#define RESOLUTION 0x1p-16

static const uint32_t free_edge[1][2] = {{6, 7}};
static const uint32_t free_point[1] = {8};

struct body {
    double x[2][VERTICES][3]; /* both ends; of what turns, in its frame, the same */
    uint32_t faces[FACES][3];
    uint32_t edges[EDGES_MAX][2]; /* as a mesh numbers them */
    uint32_t edge_count;
    uint32_t joint;
    bool has_pose; /* it goes from where it is registered to .. */
    double pose[12];
    double radius;
    struct eng_mesh *mesh;
};

struct trial {
    uint64_t seed;
    struct prng prng;
    struct turning_drawn drawn; /* its joints are the step's; the rest is of a pair */
    struct body body[OBJECTS];
    double separation;
    struct eng_step_result result;
};

static struct {
    uint64_t pairs, contacts, possible, unknown, incomplete, bodies;
} sums;

/* ---- scenes ------------------------------------------------------------------------ */

static void add_edge(struct body *body, uint32_t a, uint32_t b)
{
    uint32_t low = a < b ? a : b, high = a < b ? b : a, at = body->edge_count;
    for (uint32_t i = 0; i < body->edge_count; i++) {
        if (body->edges[i][0] == low && body->edges[i][1] == high) {
            return;
        }
    }
    for (; at > 0 && (body->edges[at - 1][1] > high ||
                      (body->edges[at - 1][1] == high && body->edges[at - 1][0] > low));
         at--) {
        memcpy(body->edges[at], body->edges[at - 1], sizeof body->edges[at]);
    }
    body->edges[at][0] = low;
    body->edges[at][1] = high;
    body->edge_count++;
}

static struct eng_mesh *make_mesh(struct trial *trial, struct body *body)
{
    const struct eng_mesh_counts counts = {VERTICES, FACES, 1, 1};
    struct eng_mesh *mesh;
    uint32_t bad;
    for (uint32_t f = 0; f < FACES; f++) { /* a strip */
        for (uint32_t k = 0; k < 3; k++) {
            body->faces[f][k] = f + k;
            add_edge(body, f + k, f + (k + 1) % 3);
        }
    }
    add_edge(body, free_edge[0][0], free_edge[0][1]);
    /* All over the place, or small and far from each other. */
    double size = trial->seed % 2 ? 1 : 0.2;
    const double centre[3] = {prng_between(&trial->prng, -1, 1),
                              prng_between(&trial->prng, -1, 1),
                              prng_between(&trial->prng, -1, 1)};
    for (uint32_t i = 0; i < 3 * VERTICES; i++) {
        body->x[0][i / 3][i % 3] =
            (1 - size) * centre[i % 3] + size * prng_between(&trial->prng, -1, 1);
    }
    memcpy(body->x[1], body->x[0], sizeof body->x[0]);
    assert_ok(eng_mesh_make(&counts, &mesh));
    assert_ok(eng_mesh_write_vertices(mesh, PCCD_FORMAT_F64, 0, VERTICES, body->x[0]));
    assert_ok(eng_mesh_write_triangles(mesh, 0, FACES, body->faces, &bad));
    assert_ok(eng_mesh_write_edges(mesh, 0, 1, free_edge, &bad));
    assert_ok(eng_mesh_write_points(mesh, 0, 1, free_point, &bad));
    assert_ok(eng_mesh_commit(mesh, 1));
    return mesh;
}

/* Very many turns take minutes in every way. */
static void slow_down(struct turning_drawn *drawn)
{
    for (uint32_t i = 0; i < 3 * drawn->count; i++) {
        struct pccd_joint *joint = &drawn->joints[i / 3];
        joint->from[i % 3] = fmod(joint->from[i % 3], 20);
        joint->to[i % 3] = fmod(joint->to[i % 3], 20);
    }
}

/* Somewhere else, turned and pressed by something. */
static void set_pose(struct trial *trial, struct body *body)
{
    body->has_pose = true;
    for (int i = 0; i < 12; i++) {
        body->pose[i] = (i % 5 == 0) + prng_between(&trial->prng, -0.5, 0.5);
    }
    for (uint32_t i = 0; i < VERTICES; i++) {
        common_transform(body->pose, body->x[0][i], body->x[1][i]);
    }
}

static void begin(struct trial *trial, uint64_t seed)
{
    *trial = (struct trial){.seed = seed, .prng = {seed}};
    struct turning_drawn *drawn = &trial->drawn;
    uint32_t shared = PCCD_NO_JOINT;
    drawn->size = 1;
    bool is_thick = prng_below(&trial->prng, 2) == 0;
    bool is_apart = is_thick && prng_below(&trial->prng, 2);
    trial->separation = is_apart ? prng_between(&trial->prng, 0, 0.2) : 0;
    for (uint32_t i = 0; i < OBJECTS; i++) {
        struct body *body = &trial->body[i];
        body->mesh = make_mesh(trial, body);
        body->joint = PCCD_NO_JOINT;
        body->radius = is_thick && prng_below(&trial->prng, 2) ? 0.1 : 0;
        uint64_t motion = prng_below(&trial->prng, 8);
        if (motion < 4 || i == 0) {
            drawn->way = (enum turning_way)prng_u32(&trial->prng, TURNING_CHAIN);
            shared = turning_draw_joints(&trial->prng, drawn,
                                         motion % 2 ? shared : PCCD_NO_JOINT);
            body->joint = shared;
        } else if (motion < 6) {
            set_pose(trial, body);
        } else if (motion == 6) {
            for (uint32_t k = 0; k < 3 * VERTICES; k++) {
                body->x[1][k / 3][k % 3] = prng_between(&trial->prng, -1, 1);
            }
        }
    }
    slow_down(drawn);
}

static struct eng_scene *stage(const struct trial *trial)
{
    struct eng_scene *scene = kit_scene();
    struct eng_bad_joint bad;
    uint32_t idx[OBJECTS], base;
    for (uint32_t i = 0; i < OBJECTS; i++) {
        const struct eng_object_thickness thickness = {.has_radius = true,
                                                       .radius = trial->body[i].radius};
        assert_ok(eng_scene_add(scene, trial->body[i].mesh, i + 1, &idx[i]));
        assert_ok(eng_scene_set_thickness(scene, idx[i], &thickness));
        if (trial->body[i].has_pose) { /* a body is not tested against itself */
            const struct eng_object_filter alone = {1, UINT64_MAX, .self = false};
            assert_ok(eng_scene_set_filter(scene, idx[i], &alone));
        }
    }
    eng_stage_begin(scene);
    assert_ok(
        eng_stage_joints(scene, trial->drawn.joints, trial->drawn.count, &base, &bad));
    for (uint32_t i = 0; i < OBJECTS; i++) {
        const struct body *body = &trial->body[i];
        if (body->joint != PCCD_NO_JOINT) {
            assert_ok(eng_stage_turning(scene, idx[i], base + body->joint));
        } else if (body->has_pose) {
            static const double here[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
            assert_ok(eng_stage_rigid(scene, idx[i], 0, VERTICES, here, body->pose));
        } else {
            assert_ok(
                eng_stage_x1(scene, idx[i], PCCD_FORMAT_F64, 0, VERTICES, body->x[1]));
        }
    }
    return scene;
}

static void end(struct trial *trial)
{
    for (uint32_t i = 0; i < OBJECTS; i++) {
        eng_mesh_release(trial->body[i].mesh);
    }
}

/* ---- the truth --------------------------------------------------------------------- */

static const uint32_t points_of[PCCD_KIND_COUNT][2] = {{1, 3}, {2, 2}, {1, 2}, {1, 1}};

/* Return how many features of so many points an object has, of a kind of pairs. */
static uint32_t count_of(const struct body *body, uint32_t points)
{
    return points == 1 ? VERTICES : points == 2 ? body->edge_count : FACES;
}

static const uint32_t *feature(const struct body *body, uint32_t points,
                               const uint32_t *index)
{
    return points == 1 ? index : points == 2 ? body->edges[*index] : body->faces[*index];
}

static bool is_of_kind(const struct body *body, enum pccd_kind kind, uint32_t points,
                       uint32_t index)
{
    const uint32_t *v = feature(body, points, &index);
    bool is_free = points == 1 ? *v == free_point[0] : v[0] == free_edge[0][0];
    return (kind != PCCD_VE && kind != PCCD_VV) || is_free;
}

static void set_pair(struct trial *trial, const struct pccd_pair *pair)
{
    struct turning_drawn *drawn = &trial->drawn;
    const uint32_t objects[2] = {pair->object_a - 1, pair->object_b - 1};
    const uint32_t features[2] = {pair->feature_a, pair->feature_b};
    uint32_t at = 0;
    drawn->kind = (enum pccd_kind)pair->kind;
    for (uint32_t side = 0; side < 2; side++) {
        const struct body *body = &trial->body[objects[side]];
        uint32_t points = points_of[pair->kind][side];
        const uint32_t *v = feature(body, points, &features[side]);
        drawn->points[side] = points;
        drawn->link[side] = body->joint;
        drawn->radius[side] = body->radius;
        for (uint32_t i = 0; i < points; i++, at++) {
            memcpy(drawn->x[0][at], body->x[0][v[i]], sizeof drawn->x[0][at]);
            memcpy(drawn->x[1][at], body->x[1][v[i]], sizeof drawn->x[1][at]);
        }
    }
    drawn->radius[2] = trial->separation;
}

static const struct pccd_contact *find(const struct trial *trial,
                                       const struct pccd_pair *pair)
{
    const struct pccd_contact *records = trial->result.records;
    for (uint64_t i = 0; i < trial->result.count; i++) {
        const struct pccd_contact *is = &records[i];
        if (is->kind == pair->kind && is->object_a == pair->object_a &&
            is->feature_a == pair->feature_a && is->object_b == pair->object_b &&
            is->feature_b == pair->feature_b) {
            return is;
        }
    }
    return NULL;
}

/* Return what is wrong with the answer about a pair; NULL: nothing. */
static const char *misjudged(struct trial *trial, enum pccd_mode mode,
                             const struct turning_truth *is,
                             const struct pccd_contact *record)
{
    bool may_lack = mode == PCCD_MODE_FIRST && is->met_by >= trial->result.toi_first;
    if (mode == PCCD_MODE_ANY) {
        return is->met_by <= 1 && trial->result.verdict == PCCD_VERDICT_NO
                   ? "the verdict is NO, and it meets"
                   : NULL;
    }
    if (!record) {
        return is->met_by <= 1 && !may_lack ? "it is missing" : NULL;
    }
    bool is_proved = (record->flags & PCCD_PROVED) != 0;
    sums.contacts += is_proved;
    sums.possible += !is_proved;
    if (is->met_by < record->toi) {
        return "it meets before toi";
    }
    if (is_proved && (is->is_free || is->free_until > record->toi_hi)) {
        return "it is proved, and free until after toi_hi";
    }
    if ((record->flags & PCCD_INITIAL) != 0 && (is->free_until > 0 || !is_proved)) {
        return "it is initial, and free at first";
    }
    return !is_proved && turning_truth(&trial->drawn, record->toi, record->toi_hi,
                                       2 * RESOLUTION, TOLERANCE / 4, 100)
                             .is_free
               ? "it is possible, and farther than that"
               : NULL;
}

/* Judge all pairs of a kind of two objects; return how many have records. */
static uint64_t judge_kind(struct trial *trial, enum pccd_mode mode, enum pccd_kind kind,
                           uint32_t a, uint32_t b, bool *is_free)
{
    const struct body *of[2] = {&trial->body[a], &trial->body[b]};
    const uint32_t *points = points_of[kind];
    uint64_t found = 0;
    for (uint32_t i = 0; i < count_of(of[0], points[0]); i++) {
        for (uint32_t j = 0; j < count_of(of[1], points[1]); j++) {
            const struct pccd_pair pair = {(uint32_t)kind, a + 1, i, b + 1, j};
            if (!is_of_kind(of[0], kind, points[0], i) ||
                !is_of_kind(of[1], kind, points[1], j)) {
                continue;
            }
            set_pair(trial, &pair);
            const double *r = trial->drawn.radius;
            if ((kind == PCCD_VE || kind == PCCD_VV) && r[0] + r[1] + r[2] == 0) {
                continue; /* without thickness they meet nothing */
            }
            const struct turning_truth is =
                turning_truth(&trial->drawn, 0, 1, 0, TOLERANCE / 4, 100);
            const struct pccd_contact *record = find(trial, &pair);
            const char *what = misjudged(trial, mode, &is, record);
            if (what) {
                fail_msg("PCCD_SEED=%llu: kind %d, %u of %u and %u of %u: %s; toi %.17g, "
                         "the oracle: %.17g .. %.17g",
                         (unsigned long long)trial->seed, (int)kind, i, a + 1, j, b + 1,
                         what, record ? record->toi : 2, is.free_until, is.met_by);
            }
            found += record != NULL;
            sums.pairs++;
            sums.unknown += !is.is_free && is.met_by > 1;
            *is_free = *is_free && is.is_free;
        }
    }
    return found;
}

static void judge(struct trial *trial, enum pccd_mode mode)
{
    uint64_t found = 0;
    bool is_free = true;
    for (uint32_t a = 0; a < OBJECTS; a++) {
        for (uint32_t b = 0; b < OBJECTS; b++) {
            bool turns = trial->body[a].joint != PCCD_NO_JOINT ||
                         trial->body[b].joint != PCCD_NO_JOINT;
            for (uint32_t kind = 0; kind < PCCD_KIND_COUNT && turns && a != b; kind++) {
                if (points_of[kind][0] != points_of[kind][1] || a < b) {
                    found +=
                        judge_kind(trial, mode, (enum pccd_kind)kind, a, b, &is_free);
                }
            }
        }
    }
    bool all_turn = true;
    for (uint32_t i = 0; i < OBJECTS; i++) {
        all_turn = all_turn && trial->body[i].joint != PCCD_NO_JOINT;
    }
    if (mode == PCCD_MODE_ANY && all_turn && is_free) {
        assert_int_equal(trial->result.verdict, PCCD_VERDICT_NO);
    }
    /* What does not turn meets itself, and others that do not. */
    const struct pccd_contact *records = trial->result.records;
    for (uint64_t i = 0; i < trial->result.count; i++) {
        const struct body *body = trial->body;
        found += body[records[i].object_a - 1].joint == PCCD_NO_JOINT &&
                 body[records[i].object_b - 1].joint == PCCD_NO_JOINT;
    }
    assert_int_equal(found, trial->result.count); /* nothing else */
}

static uint64_t wanted(void)
{
    const char *text = getenv("PCCD_TURNING_SCENES");
    return text ? (uint64_t)strtod(text, NULL) : 100;
}

/* If it failed: trees, boxes or threads would lose or invent what single pairs of
 * features that turn do, or modes would leave out what they must not. */
CASE(scenes__meet_where_intervals_say_in_every_way)
{
    uint64_t most = wanted();
    for (uint64_t n = 0; n < most; n++) {
        static struct trial trial;
        struct eng_scene *first = NULL;
        uint64_t draw = n / 2 % 4;
        enum pccd_mode mode = draw == 0   ? PCCD_MODE_FIRST
                              : draw == 1 ? PCCD_MODE_ANY
                                          : PCCD_MODE_ALL;
        begin(&trial, prng_seed() + n);
        for (uint32_t i = 0; i < way_count(); i++) {
            struct eng_question settings = ENG_QUESTION_DEFAULT;
            struct eng_scene *scene = stage(&trial);
            settings.mode = mode;
            settings.tolerance = TOLERANCE;
            settings.resolution = RESOLUTION;
            settings.distance = trial.separation;
            way_choose(i, &settings);
            struct eng_step_result result = kit_step(scene, &settings);
            sums.bodies += way_was_by_bodies(scene);
            if (i == 0) {
                trial.result = result;
                first = scene;
                continue;
            }
            if (result.count != trial.result.count ||
                memcmp(result.hash, trial.result.hash, sizeof result.hash) != 0 ||
                result.verdict != trial.result.verdict) {
                fail_msg("PCCD_SEED=%llu: mode %d, way %u: %llu records, not %llu, or "
                         "others; incomplete %d, not %d",
                         (unsigned long long)trial.seed, (int)mode, i,
                         (unsigned long long)result.count,
                         (unsigned long long)trial.result.count, (int)result.incomplete,
                         (int)trial.result.incomplete);
            }
            eng_scene_free(scene);
        }
        sums.incomplete += trial.result.incomplete != PCCD_COMPLETE;
        if (trial.result.incomplete == PCCD_COMPLETE) {
            judge(&trial, mode);
        }
        eng_scene_free(first);
        end(&trial);
    }
    printf("# %llu scenes, %llu pairs: %llu meet, %llu are possible; the oracle cannot "
           "tell %llu; %llu scenes not complete; %llu steps in body space\n",
           (unsigned long long)most, (unsigned long long)sums.pairs,
           (unsigned long long)sums.contacts, (unsigned long long)sums.possible,
           (unsigned long long)sums.unknown, (unsigned long long)sums.incomplete,
           (unsigned long long)sums.bodies);
    assert_true(most < 100 || sums.bodies > 0);
    assert_true(sums.contacts > 0 && sums.incomplete <= 1 + most / 50);
}
