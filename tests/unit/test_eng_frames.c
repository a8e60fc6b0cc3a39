/* test_eng_frames.c - scenes far from the origin, tiny ones, and objects far apart. */
#include "aabb.h"
#include "eng_kit.h"
#include "eng_way.h"
#include "step.h"
#include "topology.h"
#include "wide_state.h"
#include "world.h"

__extension__ typedef __int128 whole;

/* Coordinates are so many of these, which floats and doubles hold as well. */
#define UNIT 0x1p-60

#define SIDE     16u
#define VERTICES ((SIDE + 1) * (SIDE + 1))
#define SHEETS   4u

/* A step may count so much more than the same step in place. */
#define MORE 1.02

/* ---- boxes ------------------------------------------------------------------------- */

static whole whole_of(double x)
{
    return (whole)(x / 0x1p-20) * ((whole)1 << 40) +
           (whole)(fmod(x, 0x1p-20) / UNIT); /* both exact */
}

/* A multiple of UNIT, small or as large as coordinates may be. */
static double some_coordinate(struct prng *random)
{
    int bits = 1 + (int)prng_u32(random, 50);
    double x = prng_integer(random, 0x7fffffff) * ldexp(1, bits - 31);
    return ldexp(x, (int)prng_u32(random, 60) - bits) + UNIT * prng_integer(random, 9);
}

/* If it failed, a box would not hold its point, and a contact could be missed, or it
 * would be larger than it has to be, and a step slower. */
CASE(frames__boxes_hold_their_points_tightly)
{
    struct prng random = {1};
    for (uint32_t i = 0; i < 200000; i++) {
        double x = floor(some_coordinate(&random) / UNIT) * UNIT;
        double origin = i % 4 ? x + floor(some_coordinate(&random) / UNIT) * UNIT
                              : floor(some_coordinate(&random) / UNIT) * UNIT;
        struct eng_box_frame frame = {.origin = {[4] = origin}, .scale = 1};
        float lo;
        float hi;
        eng_bounds_of(&lo, &hi, x, &frame, 4);
        whole exact = whole_of(x) - whole_of(origin);
        assert_true(whole_of((double)lo) <= exact && exact <= whole_of((double)hi));
        if (lo == hi) {
            assert_true(whole_of((double)lo) == exact);
        } else {
            assert_true(nextafterf(lo, INFINITY) == hi);
            assert_true(whole_of((double)lo) < exact && exact < whole_of((double)hi));
        }
    }
}

/* If it failed, an instruction set would have boxes of its own. */
CASE(frames__kernels_make_the_same_boxes)
{
    struct prng random = {2};
    for (uint32_t i = 0; i < 20000; i++) {
        struct eng_point point = {.word0 = 1, .word1 = UINT64_MAX};
        struct eng_box_frame frame = {.scale = i % 3 ? 1 : 0x1p300};
        struct eng_box expected = {.word0 = 0};
        for (int k = 0; k < 3; k++) {
            point.x0[k] = some_coordinate(&random) / frame.scale;
            point.x1[k] = some_coordinate(&random) / frame.scale;
            frame.origin[k] = some_coordinate(&random) / frame.scale;
            frame.origin[4 + k] = prng_u32(&random, 2) ? point.x1[k] : 0;
        }
        eng_box_of_point(&expected, &frame, point.x0, point.x1);
        for (uint32_t n = 0; n < way_kernels_count(); n++) {
            struct eng_extents box;
            way_kernels(n)->box_points(&point, 1, &frame, false, &box);
            for (int k = 0; k < 3; k++) {
                assert_true(-box.side[ENG_LOW0][k] == expected.lo0[k]);
                assert_true(box.side[ENG_HIGH0][k] == expected.hi0[k]);
                assert_true(-box.side[ENG_LOW1][k] == expected.lo1[k]);
                assert_true(box.side[ENG_HIGH1][k] == expected.hi1[k]);
            }
        }
    }
}

/* If it failed, an object would be taken for smaller than it is, and two that meet for
 * apart. */
CASE(frames__kernels_find_the_bounds)
{
    enum { MOST = 67 };
    struct prng random = {3};
    static double x[MOST][3];
    for (uint32_t count = 0; count <= MOST; count++) {
        struct eng_bounds expected = ENG_NO_BOUNDS;
        for (uint32_t i = 0; i < 3 * count; i++) {
            double y = x[i / 3][i % 3] = prng_integer(&random, 1000);
            expected.low[i % 3] = fmin(expected.low[i % 3], y);
            expected.high[i % 3] = fmax(expected.high[i % 3], y);
        }
        for (uint32_t n = 0; n < way_kernels_count(); n++) {
            struct eng_bounds found = ENG_NO_BOUNDS;
            way_kernels(n)->bound_positions((const double(*)[3])x, count, &found);
            assert_memory_equal(&found, &expected, sizeof found);
        }
    }
}

/* ---- scenes ------------------------------------------------------------------------ */

/* Two pairs of sheets; the two of a pair cross while they move. */
struct ground {
    struct eng_scene *scene;
    uint32_t objects[SHEETS];
};

/* Place a sheet at an end of step `number`: a wave at the place of its pair. What the
 * pair's offset leaves of a coordinate stays when it is moved back by `back`. */
static void place_sheet(uint32_t sheet, uint32_t number, const double offset[3],
                        const double back[3], double scale, double (*x)[3])
{
    for (uint32_t i = 0; i < VERTICES; i++) {
        double u = (double)(i % (SIDE + 1)) / SIDE;
        double v = (double)(i / (SIDE + 1)) / SIDE;
        double wave = 0.1 * sin(9 * u + 5 * v + number + 2.0 * (sheet % 2));
        double at[3] = {u + 0.013 * (sheet % 2), v + 0.007 * (sheet % 2), wave};
        for (int k = 0; k < 3; k++) {
            volatile double moved = at[k] + offset[k];
            x[i][k] = scale * (moved - back[k]);
        }
    }
}

/* The offsets of both pairs, and how far each is moved back. */
struct layout {
    double offset[2][3];
    double back[2][3];
    double scale;
};

static void ground_init(struct ground *ground, const struct layout *layout)
{
    static double x[VERTICES][3];
    ground->scene = kit_scene();
    for (uint32_t i = 0; i < SHEETS; i++) {
        struct eng_mesh *flat = kit_sheet(SIDE, 0);
        uint32_t(*corners)[3] = test_room(flat->info.triangle_count * sizeof *corners);
        assert_int_equal(flat->info.vertex_count, VERTICES);
        eng_mesh_get_corners(flat, corners);
        place_sheet(i, 0, layout->offset[i / 2], layout->back[i / 2], layout->scale, x);
        struct eng_mesh *mesh = kit_mesh(x, VERTICES, corners, flat->info.triangle_count);
        ground->objects[i] = kit_add(ground->scene, mesh, i);
        eng_mesh_release(flat);
        free(corners);
    }
}

/* Step `number`, to where the layout has the sheets. */
static struct eng_step_result ground_step(struct ground *ground,
                                          const struct layout *layout, uint32_t number,
                                          enum pccd_method method, enum pccd_mode mode)
{
    static double x[VERTICES][3];
    struct eng_question settings = kit_contacts(mode, method);
    eng_stage_begin(ground->scene);
    for (uint32_t i = 0; i < SHEETS; i++) {
        place_sheet(i, number, layout->offset[i / 2], layout->back[i / 2], layout->scale,
                    x);
        assert_ok(eng_stage_x1(ground->scene, ground->objects[i], PCCD_FORMAT_F64, 0,
                               VERTICES, x));
    }
    struct eng_step_result result = kit_step(ground->scene, &settings);
    return result;
}

/* `is_same`: differences of coordinates are the same, and so what depends on them. */
static void compare(const struct eng_step_result *far, const struct eng_step_result *near,
                    bool is_same)
{
    uint64_t candidates[2] = {
        far->counters.candidates[PCCD_VF] + far->counters.candidates[PCCD_EE],
        near->counters.candidates[PCCD_VF] + near->counters.candidates[PCCD_EE]};
    assert_true(near->count > 100);
    assert_true((double)far->counters.box_tests <=
                MORE * (double)near->counters.box_tests);
    assert_true((double)candidates[0] <= MORE * (double)candidates[1]);
    assert_int_equal(far->count, near->count);
    if (is_same) {
        assert_int_equal(far->hash[0], near->hash[0]);
        assert_int_equal(far->hash[1], near->hash[1]);
    }
}

/* Steps of a scene as the layout has it, and of one whose pairs are moved back by these
 * offsets, which leaves to coordinates what rounding has left. */
static void compare_layouts(const struct layout *far, const double back[2][3])
{
    struct layout near = *far;
    memcpy(near.back, back, sizeof near.back);
    near.scale = 1;
    for (uint32_t m = 0; m < WAY_METHODS; m++) {
        struct ground grounds[2];
        ground_init(&grounds[0], far);
        ground_init(&grounds[1], &near);
        for (uint32_t i = 1; i < 6; i++) {
            enum pccd_mode mode = i % 3 == 2 ? PCCD_MODE_PAIRS : PCCD_MODE_ALL;
            struct eng_step_result a =
                ground_step(&grounds[0], far, i, way_methods[m], mode);
            struct eng_step_result b =
                ground_step(&grounds[1], &near, i, way_methods[m], mode);
            /* The solver leaves what is smaller than 2^-200 to a search. */
            compare(&a, &b, far->scale > 0x1p-190);
        }
        eng_scene_free(grounds[0].scene);
        eng_scene_free(grounds[1].scene);
    }
}

/* If it failed, a scene on a map, or one in millimetres, would take a thousand times as
 * long as at the origin: boxes had single precision there. */
CASE(frames__a_scene_moved_away_counts_as_in_place)
{
    static const double offsets[] = {1e3, 1e5, 1e6, 5e6, 0x1p30};
    for (uint32_t i = 0; i < sizeof offsets / sizeof *offsets; i++) {
        double o = offsets[i];
        struct layout far = {.offset = {{o, -o, o}, {o + 3, -o, o}}, .scale = 1};
        const double back[2][3] = {{o, -o, o}, {o, -o, o}};
        compare_layouts(&far, back);
    }
}

/* If it failed, tiny scenes would all be one box, or leave the numbers of floats. */
CASE(frames__a_scaled_scene_counts_as_in_place)
{
    static const int exponents[] = {-300, -200, -140, -60, -20, 20, 50};
    const double back[2][3] = {{0}};
    for (uint32_t i = 0; i < sizeof exponents / sizeof *exponents; i++) {
        struct layout far = {.offset = {{0}, {3, 0, 0}}, .scale = ldexp(1, exponents[i])};
        compare_layouts(&far, back);
    }
}

/* Have a step search for a new order of the features to the end, whatever the clock
 * says. */
static void sort_at_once(struct eng_scene *scene)
{
    eng_wide_state_of(scene)->resort.budget_ns = UINT64_MAX / 2;
}

/* If it failed, all boxes of a scene on a map would be made anew when one of its objects
 * moves, or kept in a frame that is not theirs any more; or a new order of the features
 * would make them anew in two steps and not in one. */
CASE(frames__stay_where_little_moves)
{
    enum { JUMP = 4, NEW_ORDER = 6 };
    static double x[VERTICES][3];
    const struct layout layout = {.offset = {{1e6, -2e6, 0}, {1e6 + 3, -2e6, 0}},
                                  .scale = 1};
    struct ground grounds[2]; /* the second makes everything anew */
    struct eng_step_result results[2];
    struct eng_question settings = kit_contacts(PCCD_MODE_ALL, PCCD_METHOD_WIDE);
    ground_init(&grounds[0], &layout);
    ground_init(&grounds[1], &layout);
    for (uint32_t number = 1; number < 12; number++) {
        for (int i = 0; i < 2; i++) {
            settings.tuning.still = i == 0 ? ENG_STILL_KEPT : ENG_STILL_ANEW;
            place_sheet(0, number, layout.offset[0], layout.back[0], 1, x);
            for (uint32_t v = 0; v < VERTICES && number == JUMP; v++) {
                x[v][1] += 1e8; /* it leaves what the frame is fine for, and comes back */
            }
            eng_stage_begin(grounds[i].scene);
            assert_ok(eng_stage_x1(grounds[i].scene, grounds[i].objects[0],
                                   PCCD_FORMAT_F64, 0, VERTICES, x));
            sort_at_once(grounds[i].scene);
            results[i] = kit_step(grounds[i].scene, &settings);
        }
        assert_true(grounds[0].scene->framing.number > 0);
        assert_int_equal(results[0].count, results[1].count);
        assert_memory_equal(results[0].hash, results[1].hash, sizeof results[0].hash);
        assert_int_equal(results[0].counters.swaps, number == NEW_ORDER);
        bool is_anew =
            number == 1 || number == JUMP || number == JUMP + 1 || number == NEW_ORDER;
        assert_int_equal(results[0].counters.still_features == 0, is_anew);
        assert_int_equal(results[1].counters.still_features, 0);
    }
    eng_scene_free(grounds[0].scene);
    eng_scene_free(grounds[1].scene);
}

/* If it failed, one object far away would make the step of all others as slow as if they
 * were far away themselves. */
CASE(frames__objects_far_apart_count_as_in_place)
{
    static const double ways[][3] = {
        {0x1p30, 0, 0}, {0, -0x1p30, 0}, {0x1p30, 0x1p30, -0x1p30}, {1e6, 0, 1e4}};
    for (uint32_t i = 0; i < sizeof ways / sizeof *ways; i++) {
        struct layout far = {.scale = 1};
        double back[2][3] = {{0}};
        for (int k = 0; k < 3; k++) {
            far.offset[1][k] = ways[i][k];
            back[1][k] = ways[i][k] - (ways[i][k] > 0 ? 3 : ways[i][k] < 0 ? -3 : 0);
        }
        compare_layouts(&far, (const double(*)[3])back);
    }
}

/* If it failed, a vehicle that drives far would be slower from step to step, or be made
 * anew at each; the first pair of sheets stays where it was. */
CASE(frames__what_travels_counts_as_in_place)
{
    const double per_step = 12345.678;
    for (uint32_t m = 0; m < WAY_METHODS; m++) {
        struct layout far = {.offset = {{0}, {3, 0, 0}}, .scale = 1};
        struct layout near = far;
        struct ground grounds[2];
        ground_init(&grounds[0], &far);
        ground_init(&grounds[1], &near);
        for (uint32_t i = 1; i * per_step < 1e7; i++) {
            far.offset[1][0] = near.offset[1][0] = 3 + i * per_step;
            near.back[1][0] = i * per_step;
            struct eng_step_result a =
                ground_step(&grounds[0], &far, i, way_methods[m], PCCD_MODE_ALL);
            struct eng_step_result b =
                ground_step(&grounds[1], &near, i, way_methods[m], PCCD_MODE_ALL);
            assert_true((double)a.counters.box_tests <=
                        MORE * (double)b.counters.box_tests);
            assert_true((double)a.counters.candidates[PCCD_EE] <=
                        MORE * (double)b.counters.candidates[PCCD_EE]);
            assert_true(i == 1 || a.counters.builds == 0);
            assert_true(a.counters.swaps <= b.counters.swaps);
            assert_true(b.count > 100);
        }
        eng_scene_free(grounds[0].scene);
        eng_scene_free(grounds[1].scene);
    }
}

/* The most that a box may be larger for being a whole number of cells. */
static double cells_of_boxes(const struct eng_scene *scene, enum pccd_tree tree, int axis)
{
    const struct eng_wide *wide = eng_wide_of(scene);
    return tree == PCCD_TREE_TRIANGLES || !wide->has_quantised
               ? 0
               : 3 / ((double)wide->quantising.scale[axis] * scene->framing.scale);
}

/* The union of a level's boxes holds every vertex at t = 1, and hardly more. */
static void check_level(const struct eng_scene *scene, enum pccd_tree tree,
                        uint32_t level, uint32_t boxes)
{
    struct pccd_box *box = test_room(boxes * sizeof *box);
    const double(*x)[3] = (const double(*)[3])scene->x[scene->now];
    assert_int_equal(eng_level_boxes(scene, tree, level, 0, boxes, box), boxes);
    for (int k = 0; k < 3; k++) {
        double low = INFINITY;
        double high = -INFINITY;
        for (uint32_t i = 0; i < boxes; i++) {
            low = fmin(low, (double)box[i].low1[k]);
            high = fmax(high, (double)box[i].high1[k]);
        }
        double least = INFINITY;
        double most = -INFINITY;
        for (uint32_t v = 0; v < scene->vertex_ranges.end; v++) {
            least = fmin(least, x[v][k]);
            most = fmax(most, x[v][k]);
        }
        assert_true(low <= least && most <= high);
        double cells = cells_of_boxes(scene, tree, k);
        assert_true(least - low <= cells + 0x1p-21 * fmax(1, fabs(least)));
        assert_true(high - most <= cells + 0x1p-21 * fmax(1, fabs(most)));
    }
    free(box);
}

/* If it failed, who looks at the hierarchies of a scene would see boxes that are not
 * where its objects are. */
CASE(frames__boxes_that_are_shown_are_in_coordinates)
{
    struct layout far = {.offset = {{0, 0, 0x1p28}, {0x1p30, 0, 0}}, .scale = 1};
    for (uint32_t m = 0; m < WAY_METHODS; m++) {
        struct ground ground;
        ground_init(&ground, &far);
        ground_step(&ground, &far, 1, way_methods[m], PCCD_MODE_ALL);
        assert_true(ground.scene->framing.number > 0);
        bool is_wide = way_methods[m] == PCCD_METHOD_WIDE;
        uint32_t seen = 0;
        for (enum pccd_tree tree = 0; tree < PCCD_TREE_COUNT; tree++) {
            for (uint32_t level = 0; level < 3; level++) {
                uint32_t boxes = eng_level_boxes(ground.scene, tree, level, 0, 0, NULL);
                assert_true(boxes == 0 || is_wide == (tree != PCCD_TREE_TRIANGLES));
                if (boxes > 0) {
                    check_level(ground.scene, tree, level, boxes);
                    seen++;
                }
            }
        }
        assert_true(seen >= 3);
        /* A step by the other method has other frames. */
        ground_step(&ground, &far, 2, way_methods[1 - m], PCCD_MODE_ALL);
        enum pccd_tree old = is_wide ? PCCD_TREE_FACES : PCCD_TREE_TRIANGLES;
        assert_int_equal(eng_level_boxes(ground.scene, old, 0, 0, 0, NULL), 0);
        eng_scene_free(ground.scene);
    }
}

/* If it failed, a vertex that no triangle uses would decide where the boxes of all others
 * are measured from; files have such at the origin. */
CASE(frames__a_vertex_in_no_triangle_does_not_count)
{
    static double x[VERTICES + 1][3];
    struct layout far = {.offset = {{0x1p30, 0, 0}}, .scale = 1};
    struct eng_mesh *flat = kit_sheet(SIDE, 0);
    uint32_t count = flat->info.triangle_count;
    uint32_t(*corners)[3] = test_room(count * sizeof *corners);
    uint32_t object;
    eng_mesh_get_corners(flat, corners);
    place_sheet(0, 0, far.offset[0], far.back[0], 1, x); /* the last stays at 0 */
    struct eng_mesh *mesh = kit_mesh(x, VERTICES + 1, corners, count);
    assert_true(mesh->bounds.low[0] >= 0x1p30);
    struct eng_scene *scene = kit_scene();
    assert_ok(eng_scene_add(scene, mesh, 1, &object));
    eng_stage_begin(scene);
    assert_ok(eng_stage_x1(scene, object, PCCD_FORMAT_F64, 0, VERTICES + 1, x));
    struct eng_question settings = ENG_QUESTION_DEFAULT;
    struct eng_step_result result = kit_step(scene, &settings);
    assert_true(scene->framing.number > 0);
    assert_true(result.counters.candidates[PCCD_EE] < 20ull * VERTICES);
    assert_true(scene->objects[object].bounds[scene->now].low[0] >= 0x1p30);
    eng_scene_free(scene);
    eng_mesh_release(mesh);
    eng_mesh_release(flat);
    free(corners);
}
