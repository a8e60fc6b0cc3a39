/* test_eng_stage.c - the positions of a step. */
#include "eng_kit.h"
#include "step.h"
#include "world.h"

#define OBJECTS 3u
#define V       16u /* vertices of a sheet of 3 x 3 squares */

struct fixture {
    struct eng_scene *scene;
    double at[OBJECTS][V][3]; /* where the scene should stand */
};

static int setup(void **state)
{
    static struct fixture fixture;
    fixture.scene = kit_scene();
    for (uint32_t i = 0; i < OBJECTS; i++) {
        uint32_t idx;
        struct eng_mesh *mesh = kit_sheet(3, i);
        assert_ok(eng_scene_add(fixture.scene, mesh, 10 + i, &idx));
        assert_int_equal(idx, i);
        assert_int_equal(eng_scene_vertex_count(fixture.scene, idx), V);
        memcpy(fixture.at[i], mesh->x, sizeof fixture.at[i]);
        eng_mesh_release(mesh);
    }
    *state = &fixture;
    return 0;
}

static int teardown(void **state)
{
    struct fixture *f = *state;
    eng_scene_free(f->scene);
    return 0;
}

static int run(struct eng_scene *scene)
{
    struct eng_question settings = ENG_QUESTION_DEFAULT;
    struct eng_step_result result;
    settings.mode = PCCD_MODE_ANY;
    return eng_step(scene, &settings, &result);
}

/* Positions of object i at an end of the last step. */
static const double (*end_of(const struct eng_scene *scene, uint32_t i, int end))[3]
{
    unsigned buffer = end ? scene->now : 1 - scene->now;
    return (const double(*)[3])scene->x[buffer] + scene->objects[i].vertices.first;
}

static void check_end(const struct fixture *f, uint32_t i, int end, const double (*x)[3])
{
    assert_memory_equal(end_of(f->scene, i, end), x, V * sizeof *x);
}

/* Everything stands where f->at says. */
static void check_standing(const struct fixture *f)
{
    assert_false(f->scene->staging);
    for (uint32_t i = 0; i < OBJECTS; i++) {
        check_end(f, i, 1, (const double(*)[3])f->at[i]);
    }
}

static void fill(struct prng *random, double (*x)[3], uint32_t count)
{
    for (uint32_t i = 0; i < 3 * count; i++) {
        x[i / 3][i % 3] = prng_between(random, -1, 1);
    }
}

/* If it failed: the start of a step would not be the end of the last one. */
CASE_WITH(stage__x1_moves_from_the_last_end, setup, teardown)
{
    struct fixture *f = *state;
    struct prng random = {40};
    double x[V][3];
    for (int step = 0; step < 5; step++) {
        fill(&random, x, V);
        eng_stage_begin(f->scene);
        assert_ok(eng_stage_x1(f->scene, 1, PCCD_FORMAT_F64, 0, V, x));
        assert_ok(run(f->scene));
        check_end(f, 1, 0, (const double(*)[3])f->at[1]);
        memcpy(f->at[1], x, sizeof x);
        check_standing(f);
        check_end(f, 0, 0, (const double(*)[3])f->at[0]); /* the others stand still */
        check_end(f, 2, 0, (const double(*)[3])f->at[2]);
    }
}

/* If it failed: a teleport would be swept, or floats would not be taken exactly. */
CASE_WITH(stage__x0x1_gives_both_ends, setup, teardown)
{
    struct fixture *f = *state;
    struct prng random = {41};
    float x0[V][3];
    float x1[V][3];
    double expected[2][V][3];
    for (uint32_t i = 0; i < 3 * V; i++) {
        x0[i / 3][i % 3] = (float)prng_between(&random, -1, 1);
        x1[i / 3][i % 3] = (float)prng_between(&random, -1, 1);
        expected[0][i / 3][i % 3] = (double)x0[i / 3][i % 3];
        expected[1][i / 3][i % 3] = (double)x1[i / 3][i % 3];
    }
    eng_stage_begin(f->scene);
    assert_ok(eng_stage_x0x1(f->scene, 2, PCCD_FORMAT_F32, 0, V, x0, x1));
    assert_ok(run(f->scene));
    check_end(f, 2, 0, (const double(*)[3])expected[0]);
    memcpy(f->at[2], expected[1], sizeof expected[1]);
    check_standing(f);
}

/* If it failed: a rigid motion would not have the bits that its documentation
 * promises. */
CASE_WITH(stage__rigid_is_the_documented_formula, setup, teardown)
{
    struct fixture *f = *state;
    struct prng random = {42};
    double m[2][12];
    double expected[2][V][3];
    const double(*rest)[3] = (const double(*)[3])f->scene->objects[0].mesh->x;
    for (int step = 0; step < 3; step++) {
        for (int i = 0; i < 24; i++) {
            m[i / 12][i % 12] = prng_between(&random, -2, 2);
        }
        for (uint32_t i = 0; i < 2 * 3 * V; i++) {
            const double *row = m[i / (3 * V)] + 4 * (i % 3);
            const double *x = rest[i / 3 % V];
            volatile double a = row[0] * x[0]; /* volatile: no operation may be fused */
            volatile double b = row[1] * x[1];
            volatile double c = row[2] * x[2];
            volatile double sum = a + b;
            sum = sum + c;
            expected[i / (3 * V)][i / 3 % V][i % 3] = sum + row[3];
        }
        eng_stage_begin(f->scene);
        assert_ok(eng_stage_rigid(f->scene, 0, 0, V, m[0], m[1]));
        assert_ok(run(f->scene));
        check_end(f, 0, 0, (const double(*)[3])expected[0]);
        memcpy(f->at[0], expected[1], sizeof expected[1]);
        check_standing(f);
    }
}

/* If it failed: writing a part of an object would disturb the rest of it. */
CASE_WITH(stage__ranges_move_only_their_vertices, setup, teardown)
{
    struct fixture *f = *state;
    struct prng random = {43};
    for (int step = 0; step < 200; step++) {
        double start[V][3];
        double x[V][3];
        double x0[V][3];
        uint32_t first = prng_u32(&random, V);
        uint32_t count = 1 + prng_u32(&random, V - first);
        uint32_t object = prng_u32(&random, OBJECTS);
        bool both = prng_u32(&random, 2);
        fill(&random, x, count);
        fill(&random, x0, count);
        memcpy(start, f->at[object], sizeof start);
        eng_stage_begin(f->scene);
        if (both) {
            assert_ok(
                eng_stage_x0x1(f->scene, object, PCCD_FORMAT_F64, first, count, x0, x));
            memcpy(start[first], x0, count * sizeof *x0);
        } else {
            assert_ok(eng_stage_x1(f->scene, object, PCCD_FORMAT_F64, first, count, x));
        }
        memcpy(f->at[object][first], x, count * sizeof *x);
        if (first > 2) { /* a second range of the same object */
            fill(&random, x, 2);
            assert_ok(eng_stage_x1(f->scene, object, PCCD_FORMAT_F64, 0, 2, x));
            memcpy(f->at[object][0], x, 2 * sizeof *x);
        }
        assert_ok(run(f->scene));
        check_end(f, object, 0, (const double(*)[3])start);
        check_standing(f);
    }
}

/* If it failed: a step that gives every start would leave its predecessor's positions in
 * some buffer for a later step, or for objects that come, to find. */
CASE_WITH(stage__all_starts_or_some_give_the_same_ends, setup, teardown)
{
    struct fixture *f = *state;
    struct prng random = {45};
    for (int step = 0; step < 300; step++) {
        double start[OBJECTS][V][3];
        memcpy(start, f->at, sizeof start);
        if (step % 20 == 19) { /* comes and goes: the arrays grow, numbers stay */
            uint32_t idx;
            idx = kit_add(f->scene, kit_sheet(3 + (uint32_t)step / 20, 9), 77);
            check_standing(f);
            assert_ok(eng_scene_remove(f->scene, idx));
        }
        eng_stage_begin(f->scene);
        for (uint32_t i = 0; i < OBJECTS; i++) {
            double x[V][3];
            uint32_t kind = step % 3 > 0 ? 0 : prng_u32(&random, 3);
            fill(&random, x, V);
            if (kind == 0) {
                fill(&random, start[i], V / 2);
                assert_ok(
                    eng_stage_x0x1(f->scene, i, PCCD_FORMAT_F64, 0, V / 2, start[i], x));
                assert_ok(eng_stage_x0x1(f->scene, i, PCCD_FORMAT_F64, V / 2, V / 2,
                                         start[i] + V / 2, x + V / 2));
            } else if (kind == 1) {
                assert_ok(eng_stage_x1(f->scene, i, PCCD_FORMAT_F64, 0, V, x));
            }
            if (kind < 2) {
                memcpy(f->at[i], x, sizeof x);
            }
        }
        assert_ok(run(f->scene));
        for (uint32_t i = 0; i < OBJECTS; i++) {
            check_end(f, i, 0, (const double(*)[3])start[i]);
        }
        check_standing(f);
    }
}

/* If it failed: a range of a rigid object would use the wrong registered positions. */
CASE_WITH(stage__rigid_range_uses_its_own_rest_positions, setup, teardown)
{
    struct fixture *f = *state;
    const double here[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    const double up[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 8};
    eng_stage_begin(f->scene);
    assert_ok(eng_stage_rigid(f->scene, 1, 5, 4, here, up));
    assert_ok(run(f->scene));
    for (uint32_t v = 5; v < 9; v++) {
        f->at[1][v][2] += 8;
    }
    check_standing(f);
}

/* If it failed: what was staged and thrown away would show in a later step. */
CASE_WITH(stage__abort_leaves_positions_as_before, setup, teardown)
{
    struct fixture *f = *state;
    struct prng random = {44};
    double x[V][3];
    for (int round = 0; round < 20; round++) {
        eng_stage_begin(f->scene);
        for (uint32_t i = 0; i < OBJECTS; i++) {
            fill(&random, x, V);
            uint32_t count = 1 + prng_u32(&random, V);
            if (prng_u32(&random, 2)) {
                eng_stage_x1(f->scene, i, PCCD_FORMAT_F64, 0, count, x);
            } else {
                eng_stage_x0x1(f->scene, i, PCCD_FORMAT_F64, 0, count, x, x);
            }
        }
        eng_stage_abort(f->scene);
        check_standing(f);
        if (round % 3 == 0) { /* nothing staged: everything stands still */
            assert_ok(run(f->scene));
            check_standing(f);
            for (uint32_t i = 0; i < OBJECTS; i++) {
                check_end(f, i, 0, (const double(*)[3])f->at[i]);
            }
        } else if (round % 3 == 1) { /* a part of one object moves */
            fill(&random, x, 3);
            eng_stage_begin(f->scene);
            assert_ok(eng_stage_x1(f->scene, 0, PCCD_FORMAT_F64, 4, 3, x));
            assert_ok(run(f->scene));
            check_end(f, 0, 0, (const double(*)[3])f->at[0]);
            memcpy(f->at[0][4], x, 3 * sizeof *x);
            check_standing(f);
        }
    }
}

/* If it failed: a bad number in the last vertex would leave half a step behind. */
CASE_WITH(stage__refused_coordinates_leave_positions_as_before, setup, teardown)
{
    struct fixture *f = *state;
    struct prng random = {45};
    const double bad[] = {NAN, INFINITY, -INFINITY, 1.0000001e18};
    double good[V][3];
    double x[V][3];
    double identity[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    double m[12];
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        fill(&random, good, V);
        memcpy(x, good, sizeof x);
        x[V - 1][2] = bad[i];
        memcpy(m, identity, sizeof m);
        m[prng_u32(&random, 12)] = bad[i];
        for (int kind = 0; kind < 5; kind++) {
            int status = PCCD_OK;
            eng_stage_begin(f->scene);
            assert_ok(eng_stage_x1(f->scene, 0, PCCD_FORMAT_F64, 0, V, good));
            status =
                kind == 0   ? eng_stage_x1(f->scene, 1, PCCD_FORMAT_F64, 0, V, x)
                : kind == 1 ? eng_stage_x0x1(f->scene, 1, PCCD_FORMAT_F64, 0, V, x, good)
                : kind == 2 ? eng_stage_x0x1(f->scene, 1, PCCD_FORMAT_F64, 0, V, good, x)
                : kind == 3 ? eng_stage_rigid(f->scene, 1, 0, V, m, identity)
                            : eng_stage_rigid(f->scene, 1, 0, V, identity, m);
            assert_int_equal(status, PCCD_E_NOTFINITE);
            eng_stage_abort(f->scene);
            check_standing(f);
            assert_ok(run(f->scene));
            check_standing(f);
        }
    }
    /* Legal numbers whose transform is beyond the limit. */
    m[0] = m[1] = m[3] = 1e18;
    eng_stage_begin(f->scene);
    assert_int_equal(eng_stage_rigid(f->scene, 1, 0, V, identity, m), PCCD_E_NOTFINITE);
    eng_stage_abort(f->scene);
    check_standing(f);
}

/* If it failed: two writes to one vertex would leave the order of arrival to decide. */
CASE_WITH(stage__overlapping_ranges_are_refused, setup, teardown)
{
    struct fixture *f = *state;
    struct prng random = {46};
    double x[V][3];
    int refused = 0;
    for (int round = 0; round < 500; round++) {
        bool written[OBJECTS][V] = {{false}};
        bool overlap = false;
        double next[OBJECTS][V][3];
        memcpy(next, f->at, sizeof next);
        eng_stage_begin(f->scene);
        for (uint32_t i = 0; i < 4; i++) {
            uint32_t object = prng_u32(&random, OBJECTS);
            uint32_t first = prng_u32(&random, V);
            uint32_t count = 1 + prng_u32(&random, V - first < 6 ? V - first : 6);
            fill(&random, x, count);
            assert_ok(eng_stage_x1(f->scene, object, PCCD_FORMAT_F64, first, count, x));
            memcpy(next[object][first], x, count * sizeof *x);
            for (uint32_t v = first; v < first + count; v++) {
                overlap |= written[object][v];
                written[object][v] = true;
            }
        }
        assert_int_equal(run(f->scene), overlap ? PCCD_E_SEGMENT : PCCD_OK);
        if (!overlap) {
            memcpy(f->at, next, sizeof next);
        }
        refused += overlap;
        check_standing(f);
    }
    assert_in_range(refused, 50, 450); /* both happened */
}

/* If it failed: a write outside its object would hit a neighbour's vertices. */
CASE_WITH(stage__ranges_outside_the_object_are_refused, setup, teardown)
{
    struct fixture *f = *state;
    double x[V + 1][3] = {{0}};
    double m[12] = {0};
    eng_stage_begin(f->scene);
    assert_int_equal(eng_stage_x1(f->scene, 0, PCCD_FORMAT_F64, 0, 0, x), PCCD_E_INVAL);
    assert_int_equal(eng_stage_x1(f->scene, 0, PCCD_FORMAT_F64, 0, V + 1, x),
                     PCCD_E_INVAL);
    assert_int_equal(eng_stage_x1(f->scene, 0, PCCD_FORMAT_F64, V, 1, x), PCCD_E_INVAL);
    assert_int_equal(eng_stage_x1(f->scene, 0, PCCD_FORMAT_F64, V - 1, 2, x),
                     PCCD_E_INVAL);
    assert_int_equal(eng_stage_x1(f->scene, 0, PCCD_FORMAT_F64, UINT32_MAX, 2, x),
                     PCCD_E_INVAL);
    assert_int_equal(eng_stage_x1(f->scene, 0, PCCD_FORMAT_F64, 2, UINT32_MAX, x),
                     PCCD_E_INVAL);
    assert_int_equal(eng_stage_x1(f->scene, OBJECTS, PCCD_FORMAT_F64, 0, 1, x),
                     PCCD_E_INVAL);
    assert_int_equal(eng_stage_x1(f->scene, UINT32_MAX, PCCD_FORMAT_F64, 0, 1, x),
                     PCCD_E_INVAL);
    assert_int_equal(eng_stage_x0x1(f->scene, 0, PCCD_FORMAT_F64, V, 1, x, x),
                     PCCD_E_INVAL);
    assert_int_equal(eng_stage_rigid(f->scene, 0, 1, V, m, m), PCCD_E_INVAL);
    eng_stage_abort(f->scene);
    assert_int_equal(eng_stage_x1(f->scene, 0, PCCD_FORMAT_F64, 0, V, x), PCCD_E_INVAL);
    check_standing(f);
}

/* If it failed: a step refused for its settings would move the scene all the same. */
CASE_WITH(stage__refused_settings_leave_positions_as_before, setup, teardown)
{
    struct fixture *f = *state;
    double x[V][3] = {{0}};
    for (int which = 0; which < 7; which++) {
        struct eng_question settings = ENG_QUESTION_DEFAULT;
        struct eng_step_result result;
        settings.mode = which == 0 ? PCCD_MODE_COUNT : PCCD_MODE_ALL;
        settings.method = which == 1 ? 9 : PCCD_METHOD_DEFAULT;
        settings.threads = which == 2 ? 0 : 1;
        settings.tolerance = which == 3   ? 0
                             : which == 4 ? 1.5
                             : which == 5 ? NAN
                             : which == 6 ? 0.9e-12
                                          : 1e-6;
        eng_stage_begin(f->scene);
        assert_ok(eng_stage_x0x1(f->scene, 0, PCCD_FORMAT_F64, 0, V, x, x));
        assert_int_equal(eng_step(f->scene, &settings, &result), PCCD_E_INVAL);
        check_standing(f);
    }
}

/* If it failed: the tree would change under the ranges that a step has staged. */
CASE_WITH(stage__objects_neither_come_nor_go_while_staging, setup, teardown)
{
    struct fixture *f = *state;
    uint32_t idx = 77;
    struct eng_mesh *mesh = kit_sheet(3, 9);
    eng_stage_begin(f->scene);
    assert_int_equal(eng_scene_add(f->scene, mesh, 99, &idx), PCCD_E_STATE);
    assert_int_equal(eng_scene_remove(f->scene, 0), PCCD_E_STATE);
    assert_int_equal(idx, 77);
    assert_int_equal(eng_scene_object_count(f->scene), OBJECTS);
    eng_stage_abort(f->scene);
    idx = kit_add(f->scene, mesh, 99);
    check_standing(f); /* the arrays have grown, the others stay */
}

/* Scenes with one sheet of 101 x 101 vertices, which several threads copy. */
#define LARGE_SIDE 100u
#define LARGE_V    ((LARGE_SIDE + 1) * (LARGE_SIDE + 1))

/* The bounds of object 1 at both ends are those of its vertices. */
static void check_bounds(const struct fixture *f)
{
    for (int end = 0; end < 2; end++) {
        const double(*x)[3] = end_of(f->scene, 1, end);
        const struct eng_bounds *bounds =
            &f->scene->objects[1].bounds[end ? f->scene->now : 1 - f->scene->now];
        for (int k = 0; k < 3; k++) {
            double low = INFINITY;
            double high = -INFINITY;
            for (uint32_t i = 0; i < V; i++) {
                low = fmin(low, x[i][k]);
                high = fmax(high, x[i][k]);
            }
            assert_true(bounds->low[k] == low && bounds->high[k] == high);
        }
    }
}

/* If it failed: boxes would be measured from where the object is not, which takes longer,
 * and far from the origin find too many pairs. Most parts do not have what is farthest
 * out, and where they do, what comes in its place may be nearer. */
CASE_WITH(stage__bounds_follow_the_parts_that_move, setup, teardown)
{
    struct fixture *f = *state;
    struct prng random = {41};
    double x0[V][3];
    double x1[V][3];
    for (int step = 0; step < 2000; step++) {
        uint32_t first = prng_u32(&random, V);
        uint32_t count = 1 + prng_u32(&random, V - first);
        fill(&random, x0, V);
        fill(&random, x1, V);
        eng_stage_begin(f->scene);
        if (step % 5 == 0) {
            assert_ok(eng_stage_x0x1(f->scene, 1, PCCD_FORMAT_F64, first, count, x0, x1));
        } else {
            assert_ok(eng_stage_x1(f->scene, 1, PCCD_FORMAT_F64, first, count, x1));
        }
        if (step % 3 == 0 && first > 0) {
            assert_ok(eng_stage_x1(f->scene, 1, PCCD_FORMAT_F64, 0, 1, x1[0]));
        }
        if (step % 7 == 0) {
            eng_stage_abort(f->scene);
            continue;
        }
        assert_ok(run(f->scene));
        check_bounds(f);
    }
}

static struct eng_scene *large_scene(void)
{
    uint32_t idx;
    struct eng_mesh *mesh = kit_sheet(LARGE_SIDE, 0);
    struct eng_scene *scene = kit_scene();
    assert_ok(eng_scene_add(scene, mesh, 1, &idx));
    assert_int_equal(eng_scene_vertex_count(scene, idx), LARGE_V);
    eng_mesh_release(mesh);
    return scene;
}

/* If it failed: a large object would be somewhere else when several threads copy its
 * positions, or a bad coordinate among them would pass. */
CASE(stage__a_team_copies_what_one_thread_does)
{
    static double x[2][LARGE_V][3];
    struct prng random = {11};
    for (uint32_t threads = 1; threads <= 4; threads++) {
        struct eng_scene *scene = large_scene();
        fill(&random, x[0], LARGE_V);
        fill(&random, x[1], LARGE_V);
        eng_stage_begin(scene);
        eng_stage_share(scene, threads, NULL);
        assert_ok(eng_stage_x0x1(scene, 0, PCCD_FORMAT_F64, 0, LARGE_V, x[0], x[1]));
        assert_ok(run(scene));
        assert_memory_equal(end_of(scene, 0, 0), x[0], sizeof x[0]);
        assert_memory_equal(end_of(scene, 0, 1), x[1], sizeof x[1]);
        for (uint32_t bad = 0; bad < LARGE_V; bad += LARGE_V / 7) {
            double kept = x[0][bad][1];
            x[0][bad][1] = NAN;
            eng_stage_begin(scene);
            eng_stage_share(scene, threads, NULL);
            assert_int_equal(eng_stage_x1(scene, 0, PCCD_FORMAT_F64, 0, LARGE_V, x[0]),
                             PCCD_E_NOTFINITE);
            eng_stage_abort(scene);
            x[0][bad][1] = kept;
        }
        assert_memory_equal(end_of(scene, 0, 1), x[1], sizeof x[1]);
        eng_scene_free(scene);
    }
}

/* If it failed: what is written in place would not move, or leave a trace of nothing. */
CASE_WITH(stage__lent_places_are_a_write_or_nothing, setup, teardown)
{
    struct fixture *f = *state;
    struct prng random = {49};
    for (uint32_t round = 0; round < 40; round++) {
        double(*x[2])[3] = {f->at[1]}, now[2][V][3];
        bool has_start = round % 2 > 0, moves = round / 2 % 4 == 0;
        assert_int_equal(eng_stage_map(f->scene, 1, has_start ? x : NULL, x + 1), 0);
        fill(&random, x[0], has_start ? V : 0);
        fill(&random, x[1], V);
        for (int end = 0; end < 2; end++) {
            memcpy(now[end], moves ? x[end] : f->at[1], sizeof now[end]);
        }
        if (round / 2 % 4 < 2) { /* else nobody says what became of it, or 2: nothing */
            x[1][V - 1][2] = moves ? x[1][V - 1][2] : NAN;
            eng_stage_begin(f->scene);
            int status = eng_stage_mapped(f->scene, 1, has_start);
            assert_int_equal(status, moves ? PCCD_OK : PCCD_E_NOTFINITE);
        }
        if (round / 2 % 4 == 1) {
            eng_stage_abort(f->scene);
        } else if (round / 2 % 4 == 2) {
            eng_stage_unmap(f->scene, 1);
        }
        assert_ok(run(f->scene));
        check_end(f, 1, 0, (const double(*)[3])now[0]);
        memcpy(f->at[1], now[1], sizeof now[1]);
    }
    check_standing(f);
}
