/* test_eng_near_objects.c - the nearest features of objects, and how deep they are in
 * each other, against exact arithmetic that looks at everything.
 *
 * Room:     tests/property. May include: daemon/engine, oracle, tests/support,
 *           tests/unit, cmocka.
 * Does:     small objects at random, with coordinates of all bits, on a coarse grid
 *           (where almost everything is equally near, touches, or is met by a ray at an
 *           edge), far away or tiny; moved, asked again for either end, by both methods,
 *           every instruction set and several threads. Every record must be the one that
 *           the oracle finds, with its numbers.
 * Threads:  teams of one to three.
 * Source:   PCCD_SEED repeats a scene; PCCD_PROPERTY_SECONDS says for how long.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "clock.h"
#include "eng_way.h"
#include "near_kit.h"
#include "oracle_distance.h"
#include "oracle_inside.h"

#define SCENES      150
#define ASKED       4u
#define THREADS_MAX 3u
#define OBJECTS_MAX 4u
#define POINTS_MAX  12u

static struct {
    uint64_t scenes;
    uint64_t nearest; /* records */
    uint64_t ties;    /* pairs as near as the one that was reported */
    uint64_t touching;
    uint64_t inside;
    uint64_t outside; /* vertices */
    uint64_t crossings;
} sums;

struct shape {
    struct eng_mesh *mesh;
    uint32_t points;
    uint32_t face_count;
    uint32_t faces[20][3];
    uint32_t edge_count;
    uint32_t edges[60][2];
    bool is_used[POINTS_MAX];
    double x[2][POINTS_MAX][3]; /* at both ends */
};

struct play {
    uint64_t seed;
    struct prng prng;
    struct near_kit kit;
    struct shape shapes[OBJECTS_MAX];
    uint32_t end;
    double grid; /* 0: none */
    double place;
    double scale;
};

static uint32_t draw(struct play *play, uint32_t bound)
{
    return (uint32_t)prng_below(&play->prng, bound);
}

static void must(const struct play *play, bool holds, const char *what)
{
    if (!holds) {
        fail_msg("PCCD_SEED=%llu: %s", (unsigned long long)play->seed, what);
    }
}

static double coordinate(struct play *play, double middle)
{
    double x = play->grid > 0 ? (double)draw(play, 5) * play->grid
                              : prng_between(&play->prng, 0, 1);
    return play->place + play->scale * (middle + x);
}

/* At one end; sometimes all objects are in one place, sometimes beside each other. */
static void place(struct play *play, uint32_t end, double spread)
{
    for (uint32_t i = 0; i < play->kit.count; i++) {
        double middle[3];
        for (int k = 0; k < 3; k++) {
            middle[k] = spread * (double)draw(play, 4);
        }
        for (uint32_t v = 0; v < play->shapes[i].points; v++) {
            for (int k = 0; k < 3; k++) {
                play->shapes[i].x[end][v][k] = coordinate(play, middle[k]);
            }
        }
    }
}

/* Triangles between points at random, or a closed surface: an octahedron with its points
 * anywhere, twice as many faces if it is doubled. */
static void make(struct play *play, struct shape *shape, bool is_closed)
{
    static const uint32_t closed[8][3] = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                                          {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
    uint32_t copies = 1 + draw(play, 2);
    double x[POINTS_MAX][3];
    memset(shape, 0, sizeof *shape);
    shape->points = is_closed ? 6 * copies : 3 + draw(play, POINTS_MAX - 3);
    shape->face_count = is_closed ? 8 * copies : 1 + draw(play, 12);
    for (uint32_t i = 0; i < shape->face_count; i++) {
        bool turns = i >= 8 && shape->points == 12 && play->seed % 3 == 0;
        for (uint32_t k = 0; k < 3; k++) {
            uint32_t corner = turns ? (3 - k) % 3 : k;
            shape->faces[i][k] = is_closed ? closed[i % 8][corner] + 6 * (i / 8)
                                           : draw(play, shape->points);
        }
    }
    for (uint32_t v = 0; v < shape->points; v++) {
        for (int k = 0; k < 3; k++) {
            x[v][k] = prng_between(&play->prng, 0, 1);
        }
    }
    shape->mesh = kit_mesh((const double(*)[3])x, shape->points,
                           (const uint32_t(*)[3])shape->faces, shape->face_count);
    struct eng_mesh_info info;
    eng_mesh_get_info(shape->mesh, &info);
    shape->edge_count = info.edge_count;
    memcpy(shape->edges, eng_mesh_edges(shape->mesh),
           info.edge_count * sizeof shape->edges[0]);
    for (uint32_t i = 0; i < 3 * shape->face_count; i++) {
        shape->is_used[shape->faces[i / 3][i % 3]] = true;
    }
    near_kit_add(&play->kit, shape->mesh);
}

static void move(struct play *play)
{
    eng_stage_begin(play->kit.scene);
    for (uint32_t i = 0; i < play->kit.count; i++) {
        const struct shape *shape = &play->shapes[i];
        assert_int_equal(eng_stage_x0x1(play->kit.scene, play->kit.idx[i],
                                        PCCD_FORMAT_F64, 0, shape->points, shape->x[0],
                                        shape->x[1]),
                         PCCD_OK);
    }
}

/* ---- the truth ------------------------------------------------------------------ */

/* A pair as records name it, with its points. */
struct truth {
    bool is_made;
    enum oracle_kind kind;
    struct pccd_pair name;
    uint8_t rank[4];
    double p[4][3];
};

static void set_point(const struct play *play, struct truth *truth, int i,
                      uint32_t object, uint32_t v)
{
    memcpy(truth->p[i], play->shapes[object].x[play->end][v], sizeof truth->p[i]);
}

/* Ranks by (object, vertex), as the points were set. */
static void set_ranks(struct truth *truth, const uint32_t object[4], const uint32_t v[4])
{
    for (int i = 0; i < 4; i++) {
        truth->rank[i] = 0;
        for (int j = 0; j < 4; j++) {
            bool is_less = object[j] != object[i] ? object[j] < object[i]
                           : v[j] != v[i]         ? v[j] < v[i]
                                                  : j < i;
            truth->rank[i] = (uint8_t)(truth->rank[i] + is_less);
        }
    }
}

static struct truth vf(const struct play *play, uint32_t a, uint32_t v, uint32_t b,
                       uint32_t f)
{
    const uint32_t *corner = play->shapes[b].faces[f];
    struct truth truth = {true, ORACLE_VF, {PCCD_VF, a + 1, v, b + 1, f}, {0}, {{0}}};
    set_point(play, &truth, 0, a, v);
    for (int k = 0; k < 3; k++) {
        set_point(play, &truth, 1 + k, b, corner[k]);
    }
    set_ranks(&truth, (const uint32_t[4]){a, b, b, b},
              (const uint32_t[4]){v, corner[0], corner[1], corner[2]});
    return truth;
}

static struct truth ee(const struct play *play, uint32_t a, uint32_t e, uint32_t b,
                       uint32_t f)
{
    const uint32_t *of_a = play->shapes[a].edges[e];
    const uint32_t *of_b = play->shapes[b].edges[f];
    struct truth truth = {true, ORACLE_EE, {PCCD_EE, a + 1, e, b + 1, f}, {0}, {{0}}};
    for (int k = 0; k < 2; k++) {
        set_point(play, &truth, k, a, of_a[k]);
        set_point(play, &truth, 2 + k, b, of_b[k]);
    }
    set_ranks(&truth, (const uint32_t[4]){a, a, b, b},
              (const uint32_t[4]){of_a[0], of_a[1], of_b[0], of_b[1]});
    return truth;
}

/* Looked at in canonical order, so the first of equals stays. */
static void look(struct truth *best, struct truth truth)
{
    int sign = best->is_made
                   ? oracle_distance_compare(truth.kind, (const double(*)[3])truth.p,
                                             best->kind, (const double(*)[3])best->p)
                   : -1;
    sums.ties += sign == 0;
    if (sign < 0) {
        *best = truth;
    }
}

static struct truth nearest_of(const struct play *play, uint32_t a, uint32_t b)
{
    struct truth best = {0};
    for (int turned = 0; turned < 2; turned++) {
        uint32_t of_vertex = turned ? b : a;
        uint32_t of_face = turned ? a : b;
        for (uint32_t v = 0; v < play->shapes[of_vertex].points; v++) {
            for (uint32_t f = 0; play->shapes[of_vertex].is_used[v] &&
                                 f < play->shapes[of_face].face_count;
                 f++) {
                look(&best, vf(play, of_vertex, v, of_face, f));
            }
        }
    }
    for (uint32_t e = 0; e < play->shapes[a].edge_count; e++) {
        for (uint32_t f = 0; f < play->shapes[b].edge_count; f++) {
            look(&best, ee(play, a, e, b, f));
        }
    }
    return best;
}

static bool is_record(const struct truth *truth, const struct pccd_near *record)
{
    struct oracle_distance distance;
    oracle_distance_find(truth->kind, (const double(*)[3])truth->p, truth->rank,
                         &distance);
    bool is_same = record->kind == truth->name.kind &&
                   record->object_a == truth->name.object_a &&
                   record->feature_a == truth->name.feature_a &&
                   record->object_b == truth->name.object_b &&
                   record->feature_b == truth->name.feature_b &&
                   record->d_lo == distance.lo && record->d_hi == distance.hi &&
                   record->count == 1 && (record->flags & 0xffu) == 0 &&
                   PCCD_NEAR_TYPE(record->flags) == (uint32_t)distance.type;
    for (int i = 0; i < 2; i++) {
        is_same = is_same && record->param[i] == (float)distance.param[i];
    }
    for (int k = 0; k < 3; k++) {
        is_same = is_same && record->direction[k] == (float)distance.direction[k];
    }
    sums.touching += distance.hi == 0;
    return is_same;
}

static const struct pccd_near *record_of(const struct eng_near_result *result,
                                         const struct pccd_pair *name)
{
    for (uint64_t i = 0; i < result->count; i++) {
        const struct pccd_near *record = near_kit_record(result, i);
        if (record->kind == name->kind && record->object_a == name->object_a &&
            record->feature_a == name->feature_a && record->object_b == name->object_b &&
            record->feature_b == name->feature_b) {
            return record;
        }
    }
    return NULL;
}

/* ---- questions ------------------------------------------------------------------ */

static struct eng_near_result ask(struct play *play, enum pccd_near_what what,
                                  double distance)
{
    struct eng_near_settings settings = near_kit_settings(what);
    struct eng_near_result result;
    way_draw(&play->prng, THREADS_MAX, &settings.step);
    settings.step.team_always = true;
    settings.distance = distance;
    settings.end = play->end;
    assert_int_equal(eng_near(play->kit.scene, &settings, &result), PCCD_OK);
    must(play, result.incomplete == PCCD_COMPLETE, "it is not complete");
    return result;
}

static void check_nearest(struct play *play)
{
    double distance =
        draw(play, 2) == 0 ? INFINITY : play->scale * (double)draw(play, 3) * 0.5;
    struct eng_near_result result = ask(play, PCCD_NEAR_NEAREST, distance);
    uint64_t count = 0;
    for (uint32_t a = 0; a < play->kit.count; a++) {
        for (uint32_t b = a + 1; b < play->kit.count; b++) {
            struct truth truth = nearest_of(play, a, b);
            const struct pccd_near *record = record_of(&result, &truth.name);
            bool is_within =
                distance == INFINITY ||
                oracle_distance_within(truth.kind, (const double(*)[3])truth.p, distance);
            must(play, is_within == (record != NULL), "another pair is the nearest");
            must(play, !record || is_record(&truth, record), "a number is wrong");
            count += is_within;
        }
    }
    must(play, result.count == count, "there are records of nothing");
    sums.nearest += count;
}

static struct truth face_of(const struct play *play, uint32_t a, uint32_t v, uint32_t b)
{
    struct truth best = {0};
    for (uint32_t f = 0; f < play->shapes[b].face_count; f++) {
        look(&best, vf(play, a, v, b, f));
    }
    return best;
}

/* Edges of an object that pass through faces of another. */
static uint64_t crossings_of(const struct play *play, uint32_t a, uint32_t b)
{
    uint64_t count = 0;
    for (uint32_t i = 0; i < play->shapes[a].edge_count; i++) {
        for (uint32_t f = 0; f < play->shapes[b].face_count; f++) {
            double p[5][3];
            for (int k = 0; k < 2; k++) {
                memcpy(p[k], play->shapes[a].x[play->end][play->shapes[a].edges[i][k]],
                       sizeof p[k]);
            }
            for (int k = 0; k < 3; k++) {
                memcpy(p[2 + k],
                       play->shapes[b].x[play->end][play->shapes[b].faces[f][k]],
                       sizeof p[k]);
            }
            count += oracle_crosses((const double(*)[3])p);
        }
    }
    return count;
}

static void check_depth(struct play *play)
{
    struct eng_near_result result = ask(play, PCCD_NEAR_DEPTH, 0);
    uint64_t count = 0;
    uint64_t crossings = 0;
    for (uint32_t i = 0; i < play->kit.count * play->kit.count; i++) {
        uint32_t a = i / play->kit.count;
        uint32_t b = i % play->kit.count;
        crossings += a != b ? crossings_of(play, a, b) : 0;
    }
    must(play, result.crossings == crossings, "other edges pass through");
    sums.crossings += crossings;
    for (uint32_t i = 0; i < play->kit.count * play->kit.count * POINTS_MAX; i++) {
        uint32_t v = i % POINTS_MAX;
        uint32_t a = i / POINTS_MAX % play->kit.count;
        uint32_t b = i / POINTS_MAX / play->kit.count;
        const struct shape *shape = &play->shapes[b];
        int64_t winding;
        if (a == b || v >= play->shapes[a].points) {
            continue;
        }
        bool is_inside = oracle_winding(play->shapes[a].x[play->end][v],
                                        (const double(*)[3])shape->x[play->end],
                                        (const uint32_t(*)[3])shape->faces,
                                        shape->face_count, &winding) &&
                         winding != 0;
        if (is_inside) {
            struct truth truth = face_of(play, a, v, b);
            const struct pccd_near *record = record_of(&result, &truth.name);
            must(play, record != NULL, "a vertex inside has not that record");
            must(play, is_record(&truth, record), "a number is wrong");
        }
        count += is_inside;
        sums.outside += !is_inside;
    }
    must(play, result.count == count, "there are records of nothing");
    sums.inside += count;
}

static void live(uint64_t seed)
{
    static const double places[][2] = {{0, 1},        {0, 1},         {1e6, 1},
                                       {-3, 0x1p-40}, {1e12, 0x1p12}, {0, 1e-200},
                                       {1e17, 0x1p20}};
    struct play play = {.seed = seed, .prng = {seed}};
    uint32_t at = draw(&play, sizeof places / sizeof places[0]);
    bool is_closed = draw(&play, 2) == 0;
    play.place = places[at][0];
    play.scale = places[at][1];
    play.grid = draw(&play, 2) == 0 ? 0.25 : 0;
    near_kit_begin(&play.kit);
    uint32_t count = 2 + draw(&play, OBJECTS_MAX - 1);
    for (uint32_t i = 0; i < count; i++) {
        make(&play, &play.shapes[i], is_closed);
    }
    for (uint32_t i = 0; i < ASKED; i++) {
        if (i == 0 || draw(&play, 2) == 0) {
            double spread = draw(&play, 3) == 0 ? 0.5 : draw(&play, 4) == 0 ? 1e6 : 0;
            place(&play, 0, spread);
            place(&play, 1, spread);
            move(&play);
        }
        play.end = draw(&play, 2);
        if (is_closed && draw(&play, 4) > 0) {
            check_depth(&play);
        } else {
            check_nearest(&play);
        }
    }
    near_kit_end(&play.kit);
    sums.scenes++;
}

/* If this failed, a body would be taken for farther away than it is, or for outside of
 * what it is in; or the answer would depend on how it was found. */
static void objects__are_as_near_and_as_deep_as_the_oracle_says(void **state)
{
    const char *seconds = getenv("PCCD_PROPERTY_SECONDS");
    uint64_t end_ns = common_now_ns();
    struct prng prng = {prng_seed()};
    (void)state;
    end_ns += seconds ? (uint64_t)(strtod(seconds, NULL) * 1e9) : 0;
    for (uint64_t i = 0; seconds ? common_now_ns() < end_ns : i < SCENES; i++) {
        live(i == 0 ? prng.state : prng_next(&prng));
    }
    print_message("# %llu scenes: %llu nearest, %llu ties, %llu touching; %llu inside, "
                  "%llu not, %llu crossings\n",
                  (unsigned long long)sums.scenes, (unsigned long long)sums.nearest,
                  (unsigned long long)sums.ties, (unsigned long long)sums.touching,
                  (unsigned long long)sums.inside, (unsigned long long)sums.outside,
                  (unsigned long long)sums.crossings);
    if (!getenv("PCCD_SEED") && sums.scenes >= SCENES) {
        assert_true(sums.nearest > 0 && sums.ties > 0 && sums.touching > 0 &&
                    sums.inside > 0 && sums.outside > 0 && sums.crossings > 0);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(objects__are_as_near_and_as_deep_as_the_oracle_says),
    };
    return cmocka_run_group_tests_name("eng_near_objects", tests, NULL, NULL);
}
