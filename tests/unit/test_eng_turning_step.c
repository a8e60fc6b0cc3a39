/* test_eng_turning_step.c - steps in which objects turn: staged, and beside others. */
#include "eng_answer.h"
#include "eng_kit.h"
#include "eng_way.h"

#include <math.h>

#include "coordinates.h"
#include "joints.h"
#include "method.h"
#include "stage_turning.h"
#include "step_memory.h"

#define OBJECTS 7u
#define JOINTS  4u

/* Kinds of motion of an object in a step. */
enum motion { STANDS, GOES, TURNS };

/* Meshes, and how they move in a step: some on one table of joints. */
struct cast {
    struct eng_mesh *mesh[OBJECTS];
    double (*x[OBJECTS])[3];  /* where they are */
    double (*to[OBJECTS])[3]; /* where they go, if they go straight */
    enum motion motion[OBJECTS];
    uint32_t joint[OBJECTS];
    struct pccd_joint joints[JOINTS];
};

static const struct pccd_joint no_joint = {
    .kind = PCCD_JOINT_FIXED, .parent = PCCD_NO_JOINT, .rotation = {0, 0, 0, 1}};

/* Turn about an axis through a place, from 0 to an angle. */
static struct pccd_joint hinge(uint32_t parent, double x, double y, double z,
                               double angle)
{
    struct pccd_joint joint = no_joint;
    joint.kind = PCCD_JOINT_TURN;
    joint.parent = parent;
    joint.position[0] = x;
    joint.position[1] = y;
    joint.position[2] = z;
    joint.axis[2] = 1;
    joint.to[0] = angle;
    return joint;
}

static void check_staging(struct eng_scene *scene, uint32_t object,
                          const struct pccd_joint *joint)
{
    uint32_t base = 99;
    struct eng_bad_joint bad;
    eng_stage_begin(scene);
    assert_ok(eng_stage_joints(scene, joint, 1, &base, &bad));
    assert_int_equal(base, 0);
    assert_ok(eng_stage_turning(scene, object, 0));
}

static struct eng_mesh *bar(double x)
{
    return kit_box((const double[3]){x, -0.05, -0.05},
                   (const double[3]){x + 1, 0.05, 0.05}, false);
}

static void cast_begin(struct cast *cast, struct prng *random)
{
    for (uint32_t i = 0; i < OBJECTS; i++) {
        const double low[3] = {prng_between(random, -1, 1), prng_between(random, -1, 1),
                               prng_between(random, -0.3, 0.3)};
        const double high[3] = {low[0] + prng_between(random, 0.1, 1),
                                low[1] + prng_between(random, 0.1, 0.5), low[2] + 0.3};
        cast->mesh[i] = i == 0 ? kit_sheet(6, 0) : kit_box(low, high, false);
        uint32_t count = i == 0 ? 49 : 8;
        cast->x[i] = malloc(count * sizeof *cast->x[i]);
        cast->to[i] = malloc(count * sizeof *cast->to[i]);
        memcpy(cast->x[i], eng_mesh_vertices(cast->mesh[i]), count * sizeof *cast->x[i]);
    }
}

static uint32_t vertices_of(const struct cast *cast, uint32_t i)
{
    struct eng_mesh_info info;
    eng_mesh_get_info(cast->mesh[i], &info);
    return info.vertex_count;
}

static void cast_end(struct cast *cast)
{
    for (uint32_t i = 0; i < OBJECTS; i++) {
        eng_mesh_release(cast->mesh[i]);
        free(cast->x[i]);
        free(cast->to[i]);
    }
}

/* Draw how they move: as a rule a few do. */
static void cast_draw(struct cast *cast, struct prng *random)
{
    for (uint32_t j = 0; j < JOINTS; j++) {
        uint32_t parent = j > 0 && prng_below(random, 2) ? j - 1 : PCCD_NO_JOINT;
        const double x = prng_between(random, -1, 1); /* in this order by any compiler */
        const double y = prng_between(random, -1, 1);
        const double turn =
            prng_below(random, 5) == 0 ? 2 * M_PI : prng_between(random, -2, 2);
        cast->joints[j] = hinge(parent, x, y, 0, turn);
        cast->joints[j].axis[0] = prng_between(random, -0.5, 0.5);
        cast->joints[j].from[0] = prng_below(random, 2) ? 0 : prng_between(random, -1, 1);
    }
    uint32_t few = prng_u32(random, 3);
    for (uint32_t i = 0; i < OBJECTS; i++) {
        uint64_t drawn = prng_below(random, few == 0 ? 3 : few == 1 ? 6 : 2);
        cast->motion[i] = drawn == 0 ? TURNS : drawn == 1 && few < 2 ? GOES : STANDS;
        cast->joint[i] = prng_u32(random, JOINTS);
        double by[3] = {prng_between(random, -0.5, 0.5), prng_between(random, -0.5, 0.5),
                        prng_between(random, -0.1, 0.1)};
        for (uint32_t v = 0; v < vertices_of(cast, i); v++) {
            for (int k = 0; k < 3; k++) {
                cast->to[i][v][k] =
                    cast->x[i][v][k] + by[k] + prng_between(random, -0.1, 0.1);
            }
        }
    }
}

/* Stage it, of a scene that stands where the cast does; or of a new one. */
static void cast_stage(const struct cast *cast, struct eng_scene *scene,
                       const uint32_t *idx, bool is_new)
{
    uint32_t base = 0;
    struct eng_bad_joint bad;
    eng_stage_begin(scene);
    assert_ok(eng_stage_joints(scene, cast->joints, JOINTS, &base, &bad));
    for (uint32_t i = 0; i < OBJECTS; i++) {
        const double(*x0)[3] = (const double(*)[3])cast->x[i];
        const double(*x1)[3] =
            cast->motion[i] == GOES ? (const double(*)[3])cast->to[i] : x0;
        uint32_t count = vertices_of(cast, i);
        if (idx[i] == UINT32_MAX) {
            continue;
        }
        if (cast->motion[i] == TURNS) {
            assert_ok(eng_stage_turning(scene, idx[i], base + cast->joint[i]));
        } else if (is_new) {
            assert_ok(eng_stage_x0x1(scene, idx[i], PCCD_FORMAT_F64, 0, count, x0, x1));
        } else if (cast->motion[i] == GOES) {
            assert_ok(eng_stage_x1(scene, idx[i], PCCD_FORMAT_F64, 0, count, x1));
        }
    }
}

/* Stand where the scene does now. */
static void cast_follow(struct cast *cast, const struct eng_scene *scene,
                        const uint32_t *idx)
{
    for (uint32_t i = 0; i < OBJECTS; i++) {
        memcpy(cast->x[i], eng_scene_positions(scene, idx[i], 1),
               vertices_of(cast, i) * sizeof *cast->x[i]);
    }
}

/* A scene of those objects whose bits are set. */
static struct eng_scene *cast_scene(const struct cast *cast, uint32_t which,
                                    uint32_t idx[OBJECTS])
{
    struct eng_scene *scene = kit_scene();
    for (uint32_t i = 0; i < OBJECTS; i++) {
        idx[i] = UINT32_MAX;
        if (which >> i & 1) {
            assert_ok(eng_scene_add(scene, cast->mesh[i], i + 1, &idx[i]));
        }
    }
    return scene;
}

static const enum pccd_mode modes[4] = {PCCD_MODE_ALL, PCCD_MODE_FIRST, PCCD_MODE_ANY,
                                        PCCD_MODE_FIRST_PER_PAIR};

static void draw_question(struct prng *random, struct eng_question *question)
{
    *question = (struct eng_question)ENG_QUESTION_DEFAULT;
    question->mode = modes[prng_below(random, 4)];
    question->distance = prng_below(random, 3) == 0 ? 0.01 : 0;
}

/* Step with the bar on a hinge at x, and look where that begins and ends, and the next
 * step. */
static void check_poses(double x, bool waits)
{
    const struct pccd_joint joint = hinge(PCCD_NO_JOINT, x, 0, 0, 1.25);
    kit_begin_with(bar(0), kit_sheet(2, 3));
    check_staging(kit.scene, kit.idx[0], &joint);
    assert_int_equal(kit.scene->writes[0].waits, waits);
    struct eng_question settings = ENG_QUESTION_DEFAULT;
    kit_step(kit.scene, &settings);
    for (uint32_t end = 0; end < 2; end++) {
        double m[12];
        common_joint_transform(&joint, 0, end, m);
        for (uint32_t v = 0; v < 8; v++) {
            double at[3];
            const struct eng_mesh *mesh = eng_scene_mesh(kit.scene, kit.idx[0]);
            common_transform(m, eng_mesh_vertices(mesh)[v], at);
            assert_memory_equal(at, eng_scene_positions(kit.scene, kit.idx[0], end)[v],
                                sizeof at);
        }
    }
    double ended[8][3];
    memcpy(ended, eng_scene_positions(kit.scene, kit.idx[0], 1), sizeof ended);
    kit_step(kit.scene, &settings);
    for (uint32_t end = 0; end < 2; end++) {
        assert_memory_equal(ended, eng_scene_positions(kit.scene, kit.idx[0], end),
                            sizeof ended);
    }
}

/* If it failed: a body would begin or end somewhere else than its joints say, or the next
 * step would begin somewhere else; or a daemon would place all its vertices before it
 * gives the slot back, though they are certain to be where coordinates may be, and be
 * late with the answer to a cancel. */
CASE(turning__begins_and_ends_at_its_poses)
{
    check_poses(0.25, true);
    check_poses(0x1p59, false); /* near the limit */
}

/* If it failed: a bar that turns through a post, and ends free of it, would miss it, as
 * it does along its chord; or a step that is not staged would turn it once more. */
CASE(turning__meets_what_its_arc_meets)
{
    const double low[3] = {0.6, 0.6, -1};
    const double high[3] = {0.7, 0.7, 1};
    const struct pccd_joint half = hinge(PCCD_NO_JOINT, 0, 0, 0, 2 * M_PI);
    for (uint32_t way = 0; way < way_count(); way++) {
        kit_begin_with(bar(0), kit_box(low, high, false));
        struct eng_question settings = ENG_QUESTION_DEFAULT;
        way_choose(way, &settings);
        assert_int_equal(kit_step(kit.scene, &settings).count, 0);
        check_staging(kit.scene, kit.idx[0], &half);
        struct eng_step_result result = kit_step(kit.scene, &settings);
        assert_true(result.count > 0);
        assert_true(result.toi_first > 0.1 && result.toi_first < 0.125);
        assert_true(result.safe_step < result.toi_first);
        assert_int_equal(result.incomplete, PCCD_COMPLETE);
        assert_int_equal(kit_step(kit.scene, &settings).count, 0);
        assert_int_equal(kit_step(kit.scene, &settings).count, 0);
    }
}

/* If it failed: a body that ends exactly where it began would count as one that stands,
 * and what it has met would be met again in the next step. */
CASE(turning__moves_also_where_it_ends_where_it_began)
{
    const double low[3] = {1000.6, 1000.6, -1};
    const double high[3] = {1000.7, 1000.7, 1};
    const struct pccd_joint whole = hinge(PCCD_NO_JOINT, 1000, 1000, 0, 2 * M_PI);
    struct eng_question settings = ENG_QUESTION_DEFAULT;
    kit_begin_with(bar(0), kit_box(low, high, false));
    kit_put(kit_sheet(20, 5));
    for (int s = 0; s < 3; s++) {
        check_staging(kit.scene, kit.idx[0], &whole);
        assert_true(kit_step(kit.scene, &settings).count > 0);
        assert_memory_equal(eng_scene_positions(kit.scene, kit.idx[0], 0),
                            eng_scene_positions(kit.scene, kit.idx[0], 1),
                            8 * 3 * sizeof(double));
    }
    assert_int_equal(kit_step(kit.scene, &settings).count, 0);
}

/* If it failed: what a body meets only where its arc leaves the chords would never be
 * looked for. */
CASE(turning__sweeps_more_than_its_chords)
{
    struct pccd_joint joint = hinge(PCCD_NO_JOINT, 0, 0, 0, 0.15);
    joint.from[0] = -0.05;
    struct eng_question settings = ENG_QUESTION_DEFAULT;
    for (int by_chords = 0; by_chords < 2; by_chords++) {
        settings.team_always = by_chords;
        kit_begin_with(kit_box((const double[3]){9.95, -0.05, -0.05},
                               (const double[3]){10.05, 0.05, 0.05}, false),
                       kit_box((const double[3]){10.047, -0.01, -1},
                               (const double[3]){10.2, 0.01, 1}, false));
        kit_step(kit.scene, &settings);
        check_staging(kit.scene, kit.idx[0], &joint);
        struct eng_step_result result = kit_step(kit.scene, &settings);
        assert_true(result.count > 0);
        assert_true(result.toi_first > 0.05 && result.toi_first < 0.25);
    }
}

/* If it failed: along chords, what grows would be looked for where it begins, or as large
 * as it is there. */
CASE(turning__meets_what_grows)
{
    struct pccd_joint joint = hinge(PCCD_NO_JOINT, 0, 0, 0, 0.2);
    struct eng_question settings = ENG_QUESTION_DEFAULT;
    struct answer want;
    joint.from[0] = -0.8; /* too far for chords, unless a test wants them */
    for (int by_chords = 0; by_chords < 2; by_chords++) {
        settings.team_always = by_chords;
        kit_begin_with(bar(0), kit_box((const double[3]){0.9, 0.1, -0.2},
                                       (const double[3]){1.1, 0.4, 1}, false));
        const double(*x1)[3] = eng_mesh_vertices(eng_scene_mesh(kit.scene, kit.idx[1]));
        double x0[8][3];
        for (int v = 0; v < 8; v++) {
            for (int k = 0; k < 3; k++) {
                x0[v][k] = 0.01 * x1[v][k] + 0.4; /* beside the way of the bar */
            }
        }
        check_staging(kit.scene, kit.idx[0], &joint);
        assert_ok(eng_stage_x0x1(kit.scene, kit.idx[1], PCCD_FORMAT_F64, 0, 8,
                                 (const double(*)[3])x0, x1));
        struct eng_step_result result = kit_step(kit.scene, &settings);
        if (by_chords == 0) {
            assert_true(result.count > 0);
            answer_keep(&result, &want);
        }
        assert_null(answer_difference(&want, &result));
    }
    answer_free(&want);
}

/* If it failed: an answer would depend on the way in which it was found, or on the steps
 * before. */
CASE(turning__gives_the_same_bytes_in_every_way)
{
    struct prng random = {prng_seed()};
    for (int sequence = 0; sequence < 24; sequence++) {
        struct cast cast;
        uint32_t idx[OBJECTS];
        cast_begin(&cast, &random);
        struct eng_scene *scene = cast_scene(&cast, UINT32_MAX, idx);
        enum pccd_mode mode = modes[sequence % 4];
        for (int s = 0; s < 5; s++) {
            struct eng_question question;
            struct eng_step_result result;
            cast_draw(&cast, &random);
            draw_question(&random, &question);
            question.mode = s < 4 ? mode : question.mode;
            struct eng_question plain = question;
            struct answer want;
            uint32_t fresh_idx[OBJECTS];
            struct eng_scene *fresh = cast_scene(&cast, UINT32_MAX, fresh_idx);
            cast_stage(&cast, fresh, fresh_idx, true);
            result = kit_step(fresh, &plain);
            answer_keep(&result, &want);
            eng_scene_free(fresh);
            way_draw(&random, 4, &question);
            cast_stage(&cast, scene, idx, false);
            result = kit_step(scene, &question);
            const char *difference = answer_difference(&want, &result);
            if (difference) {
                char text[WAY_TEXT_MAX];
                way_tell(&question, text);
                fail_msg("seed %llu, sequence %d, step %d, mode %d, %s: %s",
                         (unsigned long long)prng_seed(), sequence, s, (int)question.mode,
                         text, difference);
            }
            answer_free(&want);
            cast_follow(&cast, scene, idx);
        }
        eng_scene_free(scene);
        cast_end(&cast);
    }
}

/* Three sheets of which one turns. */
static struct eng_step_result step_of_sheets(struct eng_mesh *const meshes[3],
                                             const struct eng_question *question)
{
    uint32_t idx[3];
    struct eng_bad_joint bad;
    uint32_t base;
    struct pccd_joint joint = hinge(PCCD_NO_JOINT, 0.4, 0.4, 0, 12);
    joint.axis[0] = 0.3;
    eng_scene_free(kit.scene);
    kit.scene = kit_scene();
    for (uint32_t k = 0; k < 3; k++) {
        assert_ok(eng_scene_add(kit.scene, meshes[k], k + 1, &idx[k]));
    }
    eng_stage_begin(kit.scene);
    assert_ok(eng_stage_joints(kit.scene, &joint, 1, &base, &bad));
    assert_ok(eng_stage_turning(kit.scene, idx[0], base));
    return kit_step(kit.scene, question);
}

/* If it failed: what is known of bodies that are too much to decide would depend on how
 * many threads there were, on what a thread had done before, or on how soon it knew of
 * the earliest contact: that with the sheet of two triangles, whose pair of objects is
 * the last one for a single thread. */
CASE(turning__ends_at_its_limits_in_every_way_alike)
{
    uint64_t limited[PCCD_MODE_COUNT] = {0};
    for (uint32_t n = 0; n < 2 * 5 * 4; n++) {
        const bool divided = n % 2;
        struct eng_mesh *meshes[3] = {kit_sheet(divided ? 16 : 12, 0.1),
                                      kit_sheet(divided ? 16 : 10, -0.3),
                                      kit_sheet(1, 0.15)};
        struct answer want;
        uint32_t incomplete = 0;
        for (uint32_t i = 0; i < way_count(); i++) {
            struct eng_question question = ENG_QUESTION_DEFAULT;
            way_choose(i, &question);
            question.mode = modes[n / 2 % 4];
            question.threads = i % 2 ? 1 + i % 8 : question.threads;
            question.turning_tests = 1u << (8 + n / 8);
            struct eng_step_result result = step_of_sheets(meshes, &question);
            if (i == 0) {
                answer_keep(&result, &want);
                incomplete = result.incomplete;
                limited[question.mode] += incomplete == PCCD_INCOMPLETE_UNDECIDED;
            }
            const char *difference = answer_difference(&want, &result);
            if (difference || incomplete != result.incomplete) {
                fail_msg("%llu tests, mode %d, way %u, %u threads: %s",
                         (unsigned long long)question.turning_tests, (int)question.mode,
                         i, question.threads, difference ? difference : "incomplete");
            }
        }
        answer_free(&want);
        for (uint32_t k = 0; k < 3; k++) {
            eng_mesh_release(meshes[k]);
        }
    }
    assert_true(limited[PCCD_MODE_ALL] > 0 && limited[PCCD_MODE_FIRST_PER_PAIR] > 0);
    assert_true(limited[PCCD_MODE_FIRST] > 0);
    assert_true(limited[PCCD_MODE_FIRST] < limited[PCCD_MODE_ALL]);
}

/* If it failed: an answer that leaves pairs undecided would be cut as one that is late,
 * and which records it has would depend on who found them. */
CASE(turning__is_not_late_at_its_limits)
{
    const struct eng_question question = ENG_QUESTION_DEFAULT;
    struct eng_stop stop;
    struct eng_worker worker = {.stop = &stop};
    eng_stop_init(&stop, &question);
    eng_worker_lack(&worker, PCCD_INCOMPLETE_UNDECIDED);
    assert_false(eng_worker_is_late(&worker, 1000));
    eng_worker_stop(&worker, PCCD_INCOMPLETE_DEADLINE);
    assert_true(eng_worker_is_late(&worker, 1000));
}

/* If it failed: what stands would be left out of an answer that leaves pairs undecided,
 * if a step before had told of it. */
CASE(turning__keeps_what_stands_at_its_limits)
{
    const double low[3] = {0.2, 0.2, 0.01};
    const double high[3] = {0.4, 0.4, 0.2};
    const struct pccd_joint joint = hinge(PCCD_NO_JOINT, 0.1, 0, 0, 1.25);
    struct answer want;
    for (int step = 0; step < 2; step++) {
        struct eng_question question = ENG_QUESTION_DEFAULT;
        question.distance = 0.05;
        kit_begin_with(bar(0), kit_box(low, high, false));
        kit_put(kit_sheet(3, 0));
        if (step > 0) {
            kit_step(kit.scene, &question);
            kit_step(kit.scene, &question);
        }
        question.turning_tests = 2;
        check_staging(kit.scene, kit.idx[0], &joint);
        struct eng_step_result result = kit_step(kit.scene, &question);
        assert_int_equal(result.incomplete, PCCD_INCOMPLETE_UNDECIDED);
        assert_true(result.count > 0);
        if (step == 0) {
            answer_keep(&result, &want);
        } else {
            assert_true(result.counters.kept_records > 0);
            assert_null(answer_difference(&want, &result));
        }
    }
    answer_free(&want);
}

static int compare_contacts(const void *a, const void *b)
{
    const struct pccd_contact *x = a;
    const struct pccd_contact *y = b;
    const uint32_t of_x[5] = {x->kind, x->object_a, x->feature_a, x->object_b,
                              x->feature_b};
    const uint32_t of_y[5] = {y->kind, y->object_a, y->feature_a, y->object_b,
                              y->feature_b};
    for (int i = 0; i < 5; i++) {
        if (of_x[i] != of_y[i]) {
            return of_x[i] < of_y[i] ? -1 : 1;
        }
    }
    return 0;
}

/* If it failed: what two objects meet would depend on the others, or be lost beside
 * them. */
CASE(turning__is_the_union_of_what_each_two_give)
{
    struct prng random = {prng_seed() + 1};
    for (int round = 0; round < 12; round++) {
        struct cast cast;
        uint32_t idx[OBJECTS];
        cast_begin(&cast, &random);
        cast_draw(&cast, &random);
        struct eng_question question = ENG_QUESTION_DEFAULT;
        question.distance = round % 2 ? 0.02 : 0;
        struct pccd_contact *all = NULL;
        uint64_t count = 0;
        for (uint32_t a = 0; a < OBJECTS; a++) {
            for (uint32_t b = a + 1; b < OBJECTS; b++) {
                struct eng_scene *scene = cast_scene(&cast, 1u << a | 1u << b, idx);
                const struct eng_object_filter filter = {1, UINT64_MAX, false};
                assert_ok(eng_scene_set_filter(scene, idx[a], &filter));
                assert_ok(eng_scene_set_filter(scene, idx[b], &filter));
                cast_stage(&cast, scene, idx, false);
                struct eng_step_result result = kit_step(scene, &question);
                all = realloc(all, (count + result.count + 1) * sizeof *all);
                assert_non_null(all);
                if (result.count > 0) {
                    memcpy(all + count, result.records, result.count * sizeof *all);
                }
                count += result.count;
                eng_scene_free(scene);
            }
        }
        qsort(all, count, sizeof *all, compare_contacts);
        struct eng_scene *scene = cast_scene(&cast, UINT32_MAX, idx);
        const struct eng_object_filter filter = {1, UINT64_MAX, false};
        for (uint32_t i = 0; i < OBJECTS; i++) {
            assert_ok(eng_scene_set_filter(scene, idx[i], &filter));
        }
        cast_stage(&cast, scene, idx, false);
        struct eng_step_result result = kit_step(scene, &question);
        assert_int_equal(result.count, count);
        assert_memory_equal(result.records, all, count * sizeof *all);
        eng_scene_free(scene);
        free(all);
        cast_end(&cast);
    }
}

/* If it failed: masks, groups or ignored pairs would not hold for what turns; or it would
 * meet itself. */
CASE(turning__heeds_who_may_meet)
{
    const double low[3] = {0.6, 0.6, -1};
    const double high[3] = {0.7, 0.7, 1};
    const struct pccd_joint joint = hinge(PCCD_NO_JOINT, 0, 0, 0, 3);
    struct eng_question settings = ENG_QUESTION_DEFAULT;
    for (int how = 0; how < 4; how++) {
        const struct eng_object_filter other = {2, 2, true};
        kit_begin_with(bar(0), kit_box(low, high, false));
        assert_ok(how == 1   ? eng_scene_set_filter(kit.scene, kit.idx[1], &other)
                  : how == 2 ? eng_scene_ignore(kit.scene, kit.idx[1], kit.idx[0], true)
                  : how == 3 ? eng_scene_remove(kit.scene, kit.idx[1])
                             : 0);
        check_staging(kit.scene, kit.idx[0], &joint);
        assert_int_equal(kit_step(kit.scene, &settings).count > 0, how == 0);
    }
}

/* If it failed: what stands would be looked for in every step, or what it is known to do
 * would be lost, or kept for what has turned. Mode any asks for the rest of the scene. */
CASE(turning__keeps_what_stands)
{
    const double low[3] = {0.6, 0.6, -1};
    const double high[3] = {0.7, 0.7, 1};
    for (enum pccd_mode mode = PCCD_MODE_ALL; mode <= PCCD_MODE_ANY; mode++) {
        struct eng_question settings = ENG_QUESTION_DEFAULT;
        settings.mode = mode;
        kit_begin_with(bar(0), kit_box(low, high, false));
        kit_put(kit_sheet(20, 5));
        kit_step(kit.scene, &settings);
        kit_step(kit.scene, &settings);
        for (int s = 0; s < 4; s++) { /* it meets in every other */
            const struct pccd_joint joint =
                hinge(PCCD_NO_JOINT, 0, 0, 0, s % 2 ? 3.0 : -0.5);
            check_staging(kit.scene, kit.idx[0], &joint);
            struct eng_step_result result = kit_step(kit.scene, &settings);
            if (mode == PCCD_MODE_ANY) {
                assert_int_equal(result.verdict,
                                 s % 2 ? PCCD_VERDICT_YES : PCCD_VERDICT_NO);
            } else {
                assert_int_equal(result.count > 0, s % 2);
            }
            assert_false(eng_methods[PCCD_METHOD_WIDE]->has_boxes(kit.scene));
        }
    }
}

/* If it failed: two that stand and meet would be taken not to, once a step was over
 * before it began: by what the last one knew, or by its deadline. */
CASE(turning__forgets_nothing_in_a_step_that_is_over)
{
    const double low[3] = {0.6, 0.6, -1}, within[3] = {0.65, 0.65, -1.5};
    const double high[3] = {0.7, 0.7, 1}, beyond[3] = {0.8, 0.8, 1.5};
    for (int is_cut = 0; is_cut < 2; is_cut++) {
        struct eng_question settings = ENG_QUESTION_DEFAULT;
        settings.mode = PCCD_MODE_ANY;
        kit_begin_with(bar(0), kit_box(low, high, false));
        kit_put(kit_box(within, beyond, false));
        for (int s = 0; s < 5; s++) {
            const struct pccd_joint joint = hinge(PCCD_NO_JOINT, 0, 0, 0, -0.5);
            settings.deadline_ns = is_cut && s % 2 == 0;
            check_staging(kit.scene, kit.idx[0], &joint);
            struct eng_step_result result = kit_step(kit.scene, &settings);
            assert_int_equal(result.verdict, is_cut && s == 0 ? PCCD_VERDICT_NONE
                                                              : PCCD_VERDICT_YES);
        }
    }
}

/* If it failed: a mesh in many objects, all of which move, would cost each of them boxes
 * in the first step. */
CASE(bodies__of_one_mesh_need_no_boxes)
{
    struct eng_question settings = ENG_QUESTION_DEFAULT;
    double m[2][12] = {{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}};
    memcpy(m[1], m[0], sizeof m[0]);
    for (int shares = 0; shares < 2; shares++) {
        kit_begin();
        struct eng_mesh *mesh = kit_sheet(8, 0);
        uint32_t count = shares ? 20 : 10, idx[20];
        for (uint32_t i = 0; i < count; i++) {
            assert_ok(eng_scene_add(kit.scene, mesh, 100 + i, &idx[i]));
            assert_ok(eng_scene_set_filter(kit.scene, idx[i],
                                           &(struct eng_object_filter){1, 1, false}));
        }
        eng_stage_begin(kit.scene);
        for (uint32_t i = 0; i < count; i++) {
            m[0][11] = 100 * i;
            m[1][11] = 100 * i + 0.5;
            assert_ok(eng_stage_rigid(kit.scene, idx[i], 0, 81, m[0], m[1]));
        }
        kit_step(kit.scene, &settings);
        assert_int_equal(eng_methods[PCCD_METHOD_WIDE]->has_boxes(kit.scene), !shares);
        eng_mesh_release(mesh);
    }
}

/* If it failed: a step would be answered that has no answer, or moved before it was
 * refused. */
CASE(turning__refuses_what_has_no_answer)
{
    const struct pccd_joint joint = hinge(PCCD_NO_JOINT, 0, 0, 0, 3);
    kit_begin_with(bar(0), bar(3));
    struct eng_question settings = ENG_QUESTION_DEFAULT;
    kit_step(kit.scene, &settings);
    double before[8][3];
    memcpy(before, eng_scene_positions(kit.scene, kit.idx[0], 1), sizeof before);
    for (int what = 0; what < 4; what++) {
        struct eng_step_result result;
        struct eng_question asked = ENG_QUESTION_DEFAULT;
        assert_null(eng_turning_refuses(&asked));
        asked.mode = what == 0 ? PCCD_MODE_PAIRS : PCCD_MODE_ALL;
        asked.touching = what == 1 ? PCCD_TOUCHING_LEFT_OUT : PCCD_TOUCHING_KEPT;
        asked.span[0] = what == 2 ? 0.5 : 0;
        asked.resolution = what == 3 ? -1 : 0;
        assert_true(what == 3 || eng_turning_refuses(&asked));
        check_staging(kit.scene, kit.idx[0], &joint);
        assert_int_equal(eng_step(kit.scene, &asked, &result), PCCD_E_INVAL);
        assert_memory_equal(before, eng_scene_positions(kit.scene, kit.idx[0], 1),
                            sizeof before);
    }
    check_staging(kit.scene, kit.idx[0], &joint);
    kit_step(kit.scene, &settings);
    struct eng_step_result result;
    settings.span[1] = 0.5; /* a part of the step that was */
    assert_int_equal(eng_step(kit.scene, &settings, &result), PCCD_E_INVAL);
}

/* If it failed: a bar that turns about itself in the middle of a plate, and so meets
 * nothing on its way, would be called free; or one beside it would not. */
CASE(turning__tells_how_it_begins)
{
    static const double plate[3][3] = {{0.5, -9, -9}, {0.5, 9, -9}, {0.5, 0, 18}};
    static const uint32_t corners[1][3] = {{0, 1, 2}};
    struct pccd_joint joint = hinge(PCCD_NO_JOINT, 0, 0, 0, 3);
    joint.axis[0] = 1;
    joint.axis[2] = 0;
    for (int way = 0; way < 8; way++) {
        bool crosses = way % 2 == 0;
        struct eng_question asked = ENG_QUESTION_DEFAULT;
        asked.mode = way / 2 % 2 == 0 ? PCCD_MODE_FIRST : PCCD_MODE_ANY;
        asked.tells_start = way < 4;
        kit_begin_with(bar(crosses ? 0 : 0.75), kit_mesh(plate, 3, corners, 1));
        check_staging(kit.scene, kit.idx[0], &joint);
        struct eng_step_result result = kit_step(kit.scene, &asked);
        bool is_told = crosses && asked.tells_start;
        assert_int_equal(result.count, 0);
        assert_int_equal(result.crossings > 0, is_told);
        assert_true(result.safe_step == (is_told ? 0 : 1));
        if (asked.mode == PCCD_MODE_ANY) {
            assert_int_equal(result.verdict,
                             is_told ? PCCD_VERDICT_POSSIBLE : PCCD_VERDICT_NO);
        }
    }
}

/* If it failed: a wheel that turns very often would cost as much as often as it turns, or
 * what it meets in its first turn be told of a later one, or not. */
CASE(turning__many_turns_cost_hardly_more_than_one)
{
    const double two_pi = 2 * M_PI;
    for (int meets = 0; meets < 2; meets++) {
        const double low[3] = {meets ? 0.9 : 1.01, -0.04, -0.03};
        const double high[3] = {2, 0.03, 0.04};
        uint64_t tests[2];
        double toi[2];
        for (int often = 0; often < 2; often++) {
            double turns = often ? 1e5 : 1;
            struct pccd_joint joint = hinge(PCCD_NO_JOINT, 0, 0, 0, 0);
            joint.from[0] = 1;
            joint.to[0] = 1 + turns * two_pi;
            kit_begin_with(bar(0), kit_box(low, high, false));
            check_staging(kit.scene, kit.idx[0], &joint);
            struct eng_question asked = ENG_QUESTION_DEFAULT;
            struct eng_step_result result = kit_step(kit.scene, &asked);
            assert_int_equal(result.incomplete, PCCD_COMPLETE);
            assert_int_equal(result.count > 0, meets);
            assert_int_equal(result.possible, 0);
            tests[often] = result.counters.box_tests + result.counters.leaf_pairs;
            toi[often] = result.toi_first * turns;
        }
        assert_in_range(tests[1], 0, 20 * tests[0]);
        assert_true(!meets || fabs(toi[1] - toi[0]) < 1e5 * 2e-6);
    }
}

/* If it failed: a bad table would be staged, or not named; or staging that is given up
 * would leave something. */
CASE(staging__refuses_bad_joints)
{
    struct pccd_joint joints[2] = {hinge(PCCD_NO_JOINT, 0, 0, 0, 3),
                                   hinge(1, 0, 0, 0, 3)};
    uint32_t base;
    struct eng_bad_joint bad;
    kit_begin_with(bar(0), bar(3));
    assert_int_equal(eng_stage_joints(kit.scene, joints, 2, &base, &bad), PCCD_E_INVAL);
    assert_null(bad.why);
    eng_stage_begin(kit.scene);
    assert_int_equal(eng_stage_joints(kit.scene, joints, 2, &base, &bad), PCCD_E_INVAL);
    assert_int_equal(bad.joint, 1);
    assert_non_null(bad.why);
    assert_int_equal(eng_stage_turning(kit.scene, kit.idx[0], 0), PCCD_E_INVAL);
    joints[1].parent = 0;
    assert_ok(eng_stage_joints(kit.scene, joints, 2, &base, &bad));
    assert_ok(eng_stage_joints(kit.scene, joints, 2, &base, &bad));
    assert_int_equal(base, 2);
    assert_ok(eng_stage_turning(kit.scene, kit.idx[0], 3));
    assert_int_equal(eng_stage_turning(kit.scene, kit.idx[1], 4), PCCD_E_INVAL);
    assert_false(eng_stage_overlaps(kit.scene));
    assert_ok(eng_stage_turning(kit.scene, kit.idx[0], 3));
    assert_true(eng_stage_overlaps(kit.scene));
    eng_stage_abort(kit.scene);
    struct eng_question settings = ENG_QUESTION_DEFAULT;
    settings.mode = PCCD_MODE_PAIRS; /* nothing turns */
    kit_step(kit.scene, &settings);
}

/* If it failed: a joint far down a chain would be refused, or one beyond the limit
 * taken. */
CASE(staging__takes_chains_up_to_the_limit)
{
    struct pccd_joint joints[129];
    uint32_t base;
    struct eng_bad_joint bad;
    for (uint32_t i = 0; i < 129; i++) {
        joints[i] = hinge(i == 0 ? PCCD_NO_JOINT : i - 1, 0.001, 0, 0, 0.01);
    }
    kit_begin_with(bar(0), bar(3));
    eng_stage_begin(kit.scene);
    assert_ok(eng_stage_joints(kit.scene, joints, 129, &base, &bad));
    assert_int_equal(eng_stage_turning(kit.scene, kit.idx[0], 128), PCCD_E_LIMIT);
    eng_stage_abort(kit.scene);
    eng_stage_begin(kit.scene);
    assert_ok(eng_stage_joints(kit.scene, joints, 129, &base, &bad));
    assert_ok(eng_stage_turning(kit.scene, kit.idx[0], 127));
    struct eng_question settings = ENG_QUESTION_DEFAULT;
    assert_int_equal(kit_step(kit.scene, &settings).incomplete, PCCD_COMPLETE);
}

/* If it failed: a step that is asked for in the loop would be computed there however long
 * it takes, or not be computed at all. */
CASE(turning__is_never_brief)
{
    const struct pccd_joint joint = hinge(PCCD_NO_JOINT, 0, 0, 0, 3);
    const double low[3] = {0.6, 0.6, -1};
    const double high[3] = {0.7, 0.7, 1};
    kit_begin_with(bar(0), kit_box(low, high, false));
    struct eng_question settings = ENG_QUESTION_DEFAULT;
    struct eng_step_result result;
    kit_step(kit.scene, &settings);
    settings.alone = true;
    /* However long that took here: such a step would be brief, if nothing turned. */
    eng_step_memory_of(kit.scene)->effort[PCCD_METHOD_WIDE].work_ns[settings.mode] = 1;
    assert_true(eng_step_can_be_brief(kit.scene, &settings, true));
    settings.brief = true;
    check_staging(kit.scene, kit.idx[0], &joint);
    assert_int_equal(eng_step(kit.scene, &settings, &result), PCCD_E_AGAIN);
    settings.brief = false;
    assert_true(kit_step(kit.scene, &settings).count > 0);
    assert_int_equal(kit_step(kit.scene, &settings).count, 0);
}

/* If it failed: what is near after such a step would be asked of other positions than
 * those where it began and ended. */
CASE(turning__ends_where_questions_look)
{
    struct prng random = {prng_seed() + 2};
    for (int round = 0; round < 4; round++) {
        struct cast cast;
        uint32_t idx[OBJECTS];
        cast_begin(&cast, &random);
        cast_draw(&cast, &random);
        struct eng_scene *scene = cast_scene(&cast, UINT32_MAX, idx);
        struct eng_question settings = ENG_QUESTION_DEFAULT;
        cast_stage(&cast, scene, idx, false);
        kit_step(scene, &settings);
        uint32_t moved_idx[OBJECTS];
        struct eng_scene *moved = cast_scene(&cast, UINT32_MAX, moved_idx);
        eng_stage_begin(moved);
        for (uint32_t i = 0; i < OBJECTS; i++) {
            assert_ok(eng_stage_x0x1(moved, moved_idx[i], PCCD_FORMAT_F64, 0,
                                     vertices_of(&cast, i),
                                     eng_scene_positions(scene, idx[i], 0),
                                     eng_scene_positions(scene, idx[i], 1)));
        }
        kit_step(moved, &settings);
        for (uint32_t end = 0; end < 2; end++) {
            struct eng_question near = kit_question(PCCD_NEAR_PAIRS);
            struct answer want;
            near.distance = 0.1;
            near.end = end;
            struct eng_step_result result = kit_near(moved, &near);
            answer_keep(&result, &want);
            result = kit_near(scene, &near);
            assert_null(answer_difference(&want, &result));
            answer_free(&want);
        }
        eng_scene_free(moved);
        eng_scene_free(scene);
        cast_end(&cast);
    }
}

static bool is_stopped(void *asked)
{
    uint32_t *left = asked;
    return *left == 0 || --*left == 0;
}

/* If it failed: a step that is to end would go on, say that it is whole, or spoil the
 * next one. */
CASE(turning__ends_when_it_is_to_end)
{
    const struct pccd_joint joint = hinge(PCCD_NO_JOINT, 0.01, 0, 0, 200);
    kit_begin_with(kit_sheet(24, 0.001), kit_sheet(25, 0));
    struct answer want;
    for (uint32_t i = 0; i < 8; i++) {
        struct eng_question settings = ENG_QUESTION_DEFAULT;
        uint32_t left = 40 * i;
        settings.resolution = 1e-3;
        settings.threads = 1 + i % 2;
        settings.team_always = true;
        settings.mode = i % 4 < 2 ? PCCD_MODE_ALL : PCCD_MODE_FIRST;
        settings.is_stopped = is_stopped;
        settings.asked = &left;
        settings.deadline_ns = i == 5 ? 1 : 0;
        check_staging(kit.scene, kit.idx[0], &joint);
        struct eng_step_result result = kit_step(kit.scene, &settings);
        if (result.incomplete != PCCD_COMPLETE) {
            assert_int_equal(result.incomplete, i == 5 ? PCCD_INCOMPLETE_DEADLINE
                                                       : PCCD_INCOMPLETE_CANCELLED);
            assert_true(result.safe_step == 0);
        }
        assert_true(i > 0 || result.incomplete == PCCD_INCOMPLETE_CANCELLED);
    }
    for (int i = 0; i < 2; i++) {
        const struct pccd_joint short_joint = hinge(PCCD_NO_JOINT, 0.01, 0, 0, 0.25);
        struct eng_question settings = ENG_QUESTION_DEFAULT;
        if (i == 1) {
            kit_begin_with(kit_sheet(24, 0.001), kit_sheet(25, 0));
        }
        check_staging(kit.scene, kit.idx[0], &short_joint);
        struct eng_step_result result = kit_step(kit.scene, &settings);
        if (i == 0) {
            answer_keep(&result, &want);
        } else {
            assert_null(answer_difference(&want, &result));
        }
    }
    answer_free(&want);
}

static bool is_counted(void *asked)
{
    ++*(uint32_t *)asked;
    return false;
}

/* If it failed: a step would not look at the clock while it finds out where long chains
 * take its objects, nor while it goes through all pairs of these: for many times as long
 * as may pass. */
CASE(turning__looks_at_the_clock_between_objects)
{
    enum { BODIES = 200, LINKS = 100 };
    static struct pccd_joint links[LINKS];
    const double low[3] = {0, 0, 0};
    const double high[3] = {1, 1, 1};
    struct eng_scene *scene = kit_scene();
    struct eng_mesh *mesh = kit_box(low, high, false);
    uint32_t idx[BODIES];
    uint32_t base;
    struct eng_bad_joint bad;
    for (uint32_t i = 0; i < LINKS; i++) {
        links[i] = hinge(i > 0 ? i - 1 : PCCD_NO_JOINT, 0.001, 0, 0, 0.5);
    }
    for (uint32_t i = 0; i < BODIES; i++) {
        const struct eng_object_filter alone = {0, 0, false};
        assert_ok(eng_scene_add(scene, mesh, i + 1, &idx[i]));
        assert_ok(eng_scene_set_filter(scene, idx[i], &alone));
    }
    eng_stage_begin(scene);
    assert_ok(eng_stage_joints(scene, links, LINKS, &base, &bad));
    for (uint32_t i = 0; i < BODIES; i++) {
        assert_ok(eng_stage_turning(scene, idx[i], base + LINKS - 1));
    }
    struct eng_question settings = ENG_QUESTION_DEFAULT;
    uint32_t asked = 0;
    settings.threads = 1;
    settings.is_stopped = is_counted;
    settings.asked = &asked;
    assert_int_equal(kit_step(scene, &settings).count, 0);
    assert_true(asked >= BODIES + BODIES * (BODIES - 1) / 2 / 4096);
    eng_scene_free(scene);
    eng_mesh_release(mesh);
}

/* If it failed: who looks at the hierarchies after a step that makes no boxes, for all
 * objects turn, would see boxes that nobody has made, or the process would end. */
CASE(turning__shows_no_boxes_that_were_not_made)
{
    const struct pccd_joint joint = hinge(PCCD_NO_JOINT, 0, 0, 0, 1);
    for (uint32_t way = 0; way < way_count(); way++) {
        struct eng_question settings = ENG_QUESTION_DEFAULT;
        struct pccd_box boxes[16];
        way_choose(way, &settings);
        kit_begin_with(bar(0), bar(2));
        check_staging(kit.scene, kit.idx[0], &joint);
        assert_ok(eng_stage_turning(kit.scene, kit.idx[1], 0));
        for (int step = 0; step < 2; step++) { /* in the last one nothing turns */
            kit_step(kit.scene, &settings);
            uint32_t seen = 0;
            for (enum pccd_tree tree = 0; tree < PCCD_TREE_TRIANGLES; tree++) {
                for (uint32_t level = 0; level < 3; level++) {
                    seen += eng_level_boxes(kit.scene, tree, level, 0, 16, boxes);
                }
            }
            assert_int_equal(seen > 0, settings.method == PCCD_METHOD_WIDE && step > 0);
        }
    }
}

/* If it failed: a step that ended while it made the boxes of an object that goes straight
 * would leave boxes to the next ones that are not whole. */
CASE(turning__makes_boxes_anew_when_it_was_stopped)
{
    enum { SIDE = 60, VERTICES = (SIDE + 1) * (SIDE + 1) };
    static double x[VERTICES][3];
    const struct pccd_joint joint = hinge(PCCD_NO_JOINT, 0.25, 0.25, 0, 0.5);
    struct eng_question settings = ENG_QUESTION_DEFAULT;
    struct answer want[2];
    settings.threads = 1;
    settings.is_stopped = is_stopped;
    for (uint32_t stop_at = 0; stop_at < 40; stop_at++) { /* first round: never */
        kit_begin_with(bar(0), kit_sheet(SIDE, 0.06));
        for (uint32_t step = 0; step < 4; step++) {
            uint32_t left = step == 1 && stop_at > 0 ? stop_at : UINT32_MAX;
            check_staging(kit.scene, kit.idx[0], &joint);
            memcpy(x, eng_scene_positions(kit.scene, kit.idx[1], 1), sizeof x);
            for (uint32_t v = 0; v < VERTICES; v++) {
                x[v][2] += step == 2 ? -0.02 : 0.0005 * (v % 3);
            }
            if (step < 3) { /* it stands in the last one */
                assert_ok(eng_stage_x1(kit.scene, kit.idx[1], PCCD_FORMAT_F64, 0,
                                       VERTICES, (const double(*)[3])x));
            }
            settings.asked = &left;
            struct eng_step_result result = kit_step(kit.scene, &settings);
            if (step > 1 && stop_at == 0) {
                answer_keep(&result, &want[step - 2]);
            } else if (step > 1) {
                assert_null(answer_difference(&want[step - 2], &result));
            }
        }
    }
    answer_free(&want[0]);
    answer_free(&want[1]);
}
