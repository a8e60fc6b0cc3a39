/* test_eng_near_objects.c - the nearest features of objects, and how deep they are in
 * each other, against exact arithmetic that looks at everything.
 *
 * Room:     tests/property. May include: daemon/engine, oracle, tests/support,
 *           tests/unit, cmocka.
 * Does:     small objects at random, with coordinates of all bits, on a coarse grid
 *           (where almost everything is equally near, touches, or is met by a ray at an
 *           edge), far away or tiny, some with radii; moved, asked again for either end,
 *           by both methods, every instruction set and several threads. Every record must
 *           be the one that the oracle finds, with its numbers.
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

#include "eng_way.h"
#include "near_kit.h"
#include "oracle_objects.h"
#include "sequences.h"

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
    uint64_t thick; /* nearest that are farther than asked, but not than with radii */
} sums;

struct shape {
    struct eng_mesh *mesh;
    uint32_t points;
    uint32_t face_count;
    uint32_t faces[20][3];
    double x[2][POINTS_MAX][3]; /* at both ends */
    double radii[POINTS_MAX];   /* as the mesh has them, or the object */
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

/* As far as objects on the grid often are from each other. */
static double some_radius(struct play *play)
{
    return play->scale * 0.125 * draw(play, 5);
}

/* The last object has one radius for all, whatever its mesh has. */
static void set_radius(struct play *play, struct shape *shape)
{
    const struct eng_object_thickness thickness = {.has_radius = true,
                                                   .radius = some_radius(play)};
    for (uint32_t v = 0; v < shape->points; v++) {
        shape->radii[v] = thickness.radius;
    }
    assert_int_equal(eng_scene_set_thickness(
                         play->kit.scene, play->kit.idx[play->kit.count - 1], &thickness),
                     PCCD_OK);
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
    bool has_radii = draw(play, 2) > 0;
    for (uint32_t v = 0; has_radii && v < shape->points; v++) {
        shape->radii[v] = some_radius(play);
    }
    shape->mesh = kit_mesh_thick((const double(*)[3])x, shape->points,
                                 (const uint32_t(*)[3])shape->faces, shape->face_count,
                                 has_radii ? shape->radii : NULL);
    near_kit_add(&play->kit, shape->mesh);
    if (draw(play, 3) == 0) {
        set_radius(play, shape);
    }
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

struct truth {
    struct oracle_object objects[OBJECTS_MAX];
    struct oracle_moment moment;
    struct oracle_nears nears;
};

/* The scene as the oracle takes it. Ids of objects are their places + 1 (near_kit.h). */
static void begin_truth(const struct play *play, struct truth *truth)
{
    for (uint32_t i = 0; i < play->kit.count; i++) {
        const struct shape *shape = &play->shapes[i];
        const double(*x)[3] = (const double(*)[3])shape->x[play->end];
        truth->objects[i] =
            (struct oracle_object){.object_id = i + 1,
                                   .vertex_count = shape->points,
                                   .triangle_count = shape->face_count,
                                   .x0 = x,
                                   .x1 = x,
                                   .triangles = (const uint32_t(*)[3])shape->faces,
                                   .radii = shape->radii};
    }
    truth->moment = (struct oracle_moment){
        .objects = truth->objects, .object_count = play->kit.count, .is_thick = true};
}

/* All of it, and nothing else. */
static void compare(const struct play *play, double distance,
                    const struct eng_near_result *result, struct truth *truth)
{
    for (uint64_t i = 0; i < result->count && i < truth->nears.count; i++) {
        const struct pccd_near *is = near_kit_record(result, i);
        const struct pccd_near *must_be = &truth->nears.items[i].record;
        must(play,
             is->kind == must_be->kind && is->object_a == must_be->object_a &&
                 is->feature_a == must_be->feature_a &&
                 is->object_b == must_be->object_b && is->feature_b == must_be->feature_b,
             "another pair is nearer, or a vertex is not inside");
        must(play, memcmp(is, must_be, sizeof *is) == 0, "a number is wrong");
        sums.touching += is->d_hi == 0;
        sums.thick += is->d_lo > distance;
    }
    must(play, result->count == truth->nears.count, "there are too many or too few");
    sums.ties += truth->nears.ties;
    oracle_nears_deinit(&truth->nears);
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
    static const uint32_t all[2] = {0, 0};
    double distance =
        draw(play, 2) == 0 ? INFINITY : play->scale * (double)draw(play, 3) * 0.5;
    struct eng_near_result result = ask(play, PCCD_NEAR_NEAREST, distance);
    struct truth truth;
    begin_truth(play, &truth);
    assert_true(
        oracle_objects_nearest(&truth.moment, all, distance, UINT64_MAX, &truth.nears));
    compare(play, distance, &result, &truth);
    sums.nearest += result.count;
}

static void check_depth(struct play *play)
{
    static const uint32_t all[2] = {0, 0};
    struct eng_near_result result = ask(play, PCCD_NEAR_DEPTH, 0);
    struct truth truth;
    uint64_t crossings;
    begin_truth(play, &truth);
    assert_true(
        oracle_objects_depth(&truth.moment, all, UINT64_MAX, &truth.nears, &crossings));
    compare(play, INFINITY, &result, &truth);
    must(play, result.crossings == crossings, "other edges pass through");
    sums.crossings += crossings;
    sums.inside += result.count;
    for (uint32_t i = 0; i < play->kit.count; i++) {
        sums.outside += play->shapes[i].points * (play->kit.count - 1);
    }
    sums.outside -= result.count;
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
    (void)state;
    sequences_live(live, SCENES, NULL);
    print_message("# %llu scenes: %llu nearest, %llu ties, %llu touching; %llu inside, "
                  "%llu not, %llu crossings; %llu by their radii\n",
                  (unsigned long long)sums.scenes, (unsigned long long)sums.nearest,
                  (unsigned long long)sums.ties, (unsigned long long)sums.touching,
                  (unsigned long long)sums.inside, (unsigned long long)sums.outside,
                  (unsigned long long)sums.crossings, (unsigned long long)sums.thick);
    if (!getenv("PCCD_SEED") && sums.scenes >= SCENES) {
        assert_true(sums.nearest > 0 && sums.ties > 0 && sums.touching > 0 &&
                    sums.inside > 0 && sums.outside > 0 && sums.crossings > 0 &&
                    sums.thick > 0);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(objects__are_as_near_and_as_deep_as_the_oracle_says),
    };
    return cmocka_run_group_tests_name("eng_near_objects", tests, NULL, NULL);
}
