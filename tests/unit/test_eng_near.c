/* test_eng_near.c - pairs, features, bounds and crossings whose answer is known by
 * construction; limits, errors, and what a question leaves as it was.
 */
#include "near_kit.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "eng_way.h"
#include "step.h"

static const enum pccd_near_what whats[] = {PCCD_NEAR_PAIRS, PCCD_NEAR_FEATURES,
                                            PCCD_NEAR_VERTICES, PCCD_NEAR_CROSSINGS};
#define WHATS (sizeof whats / sizeof whats[0])

/* Object 1: a square in the plane z = 0. Object 2: a triangle that stands on its tip,
 * vertex 0, at (1, 0.5, height), above the inside of the floor's face 0. */
static void setup(struct near_kit *kit, double height)
{
    static const double floor[4][3] = {{-4, -4, 0}, {4, -4, 0}, {4, 4, 0}, {-4, 4, 0}};
    static const uint32_t halves[2][3] = {{0, 1, 2}, {0, 2, 3}};
    static const uint32_t corners[1][3] = {{0, 1, 2}};
    const double tent[3][3] = {
        {1, 0.5, height}, {2, 0.5, height + 16}, {1, 1.5, height + 16}};
    near_kit_begin(kit);
    near_kit_add(kit, kit_mesh(floor, 4, halves, 2));
    near_kit_add(kit, kit_mesh(tent, 3, corners, 1));
}

static void stage_tip(struct near_kit *kit, double height)
{
    const double tip[1][3] = {{1, 0.5, height}};
    assert_int_equal(eng_stage_x1(kit->scene, kit->idx[1], PCCD_FORMAT_F64, 0, 1, tip),
                     PCCD_OK);
}

static struct eng_step_result ask_pairs(struct near_kit *kit, double distance,
                                        uint32_t end)
{
    struct eng_question settings = near_kit_settings(PCCD_NEAR_PAIRS);
    settings.distance = distance;
    settings.end = end;
    return near_kit_ask(kit, &settings);
}

/* If it failed: what is exactly as far away as was asked for would be left out, or what
 * is farther by one bit would not. */
static void near__has_what_is_exactly_that_far(void **state)
{
    (void)state;
    struct near_kit kit;
    setup(&kit, 0.1);
    assert_int_equal(ask_pairs(&kit, nextafter(0.1, 0), 1).count, 0);
    struct eng_step_result result = ask_pairs(&kit, 0.1, 1);
    assert_int_equal(result.count, 1);
    const struct pccd_near *record = near_kit_record(&result, 0);
    assert_true(record->kind == PCCD_VF && record->object_a == 2 &&
                record->feature_a == 0 && record->object_b == 1 &&
                record->feature_b == 0);
    assert_true(record->d_lo <= 0.1 && record->d_hi >= 0.1 &&
                record->d_hi - record->d_lo <= 0x1p-36);
    assert_true(record->direction[2] == 1 && record->count == 1);
    near_kit_end(&kit);
}

/* Two edges of the floor end at one corner, and three edges of the tent at its tip. If it
 * failed: the same contact of two corners would be counted once for each of them. */
static void near__merges_pairs_to_their_features(void **state)
{
    (void)state;
    struct near_kit kit;
    static const double left[3][3] = {{0, 0, 0}, {-4, 4, 0}, {-4, -4, 0}};
    static const double right[3][3] = {{1, 0, 0}, {5, 4, 0}, {5, -4, 0}};
    static const uint32_t corners[1][3] = {{0, 1, 2}};
    near_kit_begin(&kit);
    near_kit_add(&kit, kit_mesh(left, 3, corners, 1));
    near_kit_add(&kit, kit_mesh(right, 3, corners, 1));
    struct eng_question settings = near_kit_settings(PCCD_NEAR_FEATURES);
    settings.distance = 1;
    struct eng_step_result result = near_kit_ask(&kit, &settings);
    assert_int_equal(result.count, 1);
    const struct pccd_near *record = near_kit_record(&result, 0);
    assert_true(record->kind == PCCD_VV && record->object_a == 1 &&
                record->feature_a == 0 && record->object_b == 2 &&
                record->feature_b == 0);
    /* Two vertices and their opposite faces, and two edges with two. */
    assert_int_equal(record->count, 6);
    assert_true(record->d_lo == 1 && record->d_hi == 1 && record->direction[0] == -1);
    assert_true(result.counts[PCCD_VV] == 1 && result.distance_min == 1 &&
                result.distance_max == 1);
    near_kit_end(&kit);
}

/* Sheets above each other: each vertex of one is nearest to one of the other, by some 40
 * pairs of their faces and edges. If it failed: an answer of few features would be cut
 * because their pairs are many, or the last ones would be counted in part. */
static void near__folds_features_before_it_cuts(void **state)
{
    (void)state;
    struct near_kit kit;
    near_kit_begin(&kit);
    near_kit_add(&kit, kit_sheet(40, 0));
    near_kit_add(&kit, kit_sheet(40, 0x1p-10));
    struct eng_question settings = near_kit_settings(PCCD_NEAR_FEATURES);
    settings.distance = 0x1p-10;
    struct eng_step_result result = near_kit_ask(&kit, &settings);
    uint64_t count = result.count;
    uint64_t pairs = 0;
    struct pccd_near *all = calloc(count, sizeof *all);
    assert_non_null(all);
    memcpy(all, result.records, count * sizeof *all);
    for (uint64_t i = 0; i < count; i++) {
        pairs += all[i].count;
    }
    assert_true(pairs > 10 * count && count > 1000);
    for (uint32_t threads = 1; threads <= 2; threads++) {
        settings.threads = threads;
        settings.contact_max = count;
        assert_int_equal(eng_near(kit.scene, &settings, &result), PCCD_OK);
        assert_int_equal(result.incomplete, PCCD_COMPLETE);
        assert_int_equal(result.count, count);
        assert_memory_equal(result.records, all, count * sizeof *all);
        settings.contact_max = count / 3;
        assert_int_equal(eng_near(kit.scene, &settings, &result), PCCD_OK);
        assert_int_equal(result.incomplete, PCCD_INCOMPLETE_CONTACT_LIMIT);
        assert_int_equal(result.count, count / 3);
        for (uint64_t i = 0; i < result.count; i++) {
            const struct pccd_near *record = near_kit_record(&result, i);
            assert_int_equal(record->kind, all[i].kind);
            assert_int_equal(record->feature_a, all[i].feature_a);
            assert_int_equal(record->count, all[i].count);
        }
    }
    free(all);
    near_kit_end(&kit);
}

/* If it failed: a vertex could move by more than is safe, or all would be held back by
 * what is near one of them. */
static void near__bounds_the_points_of_pairs(void **state)
{
    (void)state;
    struct near_kit kit;
    setup(&kit, 0.25);
    struct eng_question settings = near_kit_settings(PCCD_NEAR_VERTICES);
    settings.distance = 0.375;
    struct eng_step_result result = near_kit_ask(&kit, &settings);
    const double *bounds = result.records;
    static const double want[7] = {0.25, 0.25, 0.25, 0.375, 0.25, 0.375, 0.375};
    assert_int_equal(result.count, 7);
    assert_int_equal(result.record_bytes, sizeof(double));
    assert_memory_equal(bounds, want, sizeof want);
    settings.objects[0] = 2;
    result = near_kit_ask(&kit, &settings);
    assert_int_equal(result.count, 3);
    assert_memory_equal(result.records, want + 4, 3 * sizeof want[0]);
    settings.objects[0] = 9;
    assert_int_equal(eng_near(kit.scene, &settings, &result), PCCD_E_HANDLE);
    near_kit_end(&kit);
}

/* The floor has a radius of 0.0625, the tip's vertex one of its own. If it failed: thick
 * surfaces would meet although each vertex has moved by less than half its bound. */
static void near__takes_radii_off_bounds(void **state)
{
    (void)state;
    static const struct eng_object_thickness thick = {.has_radius = true,
                                                      .radius = 0.0625};
    static const double floor[4][3] = {{-4, -4, 0}, {4, -4, 0}, {4, 4, 0}, {-4, 4, 0}};
    static const uint32_t halves[2][3] = {{0, 1, 2}, {0, 2, 3}};
    static const double spike[3][3] = {{1, 0.5, 0.25}, {2, 0.5, 16}, {1, 1.5, 16}};
    static const double radii[3] = {0.0625, 0, 0};
    static const uint32_t corners[1][3] = {{0, 1, 2}};
    static const double want[3][7] = {
        {0.125, 0.125, 0.125, 0.25, 0.125, 0.25, 0.25}, /* of a distance of 0.25 */
        {0.125, 0.125, 0.125, 0.125, 0.125, 0.125, 0.125},
        {0, 0, 0, 0, 0, 0, 0}}; /* with a radius of 0.5 */
    struct near_kit kit;
    near_kit_begin(&kit);
    near_kit_add(&kit, kit_mesh(floor, 4, halves, 2));
    near_kit_add(&kit, kit_mesh_thick(spike, 3, corners, 1, radii));
    struct eng_question settings = near_kit_settings(PCCD_NEAR_VERTICES);
    for (int i = 0; i < 3; i++) {
        struct eng_object_thickness more = thick;
        more.radius = i == 2 ? 0.5 : thick.radius;
        assert_int_equal(eng_scene_set_thickness(kit.scene, kit.idx[0], &more), PCCD_OK);
        settings.distance = i == 1 ? 0.125 : 0.25;
        struct eng_step_result result = near_kit_ask(&kit, &settings);
        assert_memory_equal(result.records, want[i], sizeof want[i]);
        assert_true(result.distance_min == want[i][0] &&
                    result.distance_max == want[i][0]);
    }
    near_kit_end(&kit);
}

/* The tip through the floor, on it, and above it. If it failed: an intersection would be
 * taken for none. */
static void near__says_whether_anything_crosses_or_touches(void **state)
{
    (void)state;
    static const double heights[3] = {-1, 0, 0x1p-60};
    static const uint64_t crossings[3] = {2, 0, 0};
    static const enum pccd_verdict verdicts[3] = {PCCD_VERDICT_YES, PCCD_VERDICT_YES,
                                                  PCCD_VERDICT_NO};
    for (int i = 0; i < 3; i++) {
        struct near_kit kit;
        setup(&kit, heights[i]);
        struct eng_question settings = near_kit_settings(PCCD_NEAR_CROSSINGS);
        struct eng_step_result result = near_kit_ask(&kit, &settings);
        assert_int_equal(result.count, crossings[i]);
        assert_int_equal(result.crossings, crossings[i]);
        assert_int_equal(result.verdict, verdicts[i]);
        settings.method = PCCD_METHOD_WIDE;
        assert_int_equal(eng_near(kit.scene, &settings, &result), PCCD_OK);
        assert_int_equal(result.verdict, verdicts[i]);
        /* What touches need not be looked for where something crosses. */
        assert_true(i == 2 || (result.counters.candidates[PCCD_EE] == 0) == (i == 0));
        if (i == 0) { /* of which nothing is kept */
            settings.contact_max = 0;
            assert_int_equal(eng_near(kit.scene, &settings, &result), PCCD_OK);
            assert_int_equal(result.incomplete, PCCD_INCOMPLETE_CONTACT_LIMIT);
            assert_int_equal(result.verdict, PCCD_VERDICT_NONE);
            assert_int_equal(result.count, 0);
        }
        near_kit_end(&kit);
    }
}

/* Before any step both ends are as registered; a question that moves has the old place at
 * end 0. If it failed: answers would be about another moment. */
static void near__is_of_the_end_that_was_asked_for(void **state)
{
    (void)state;
    struct near_kit kit;
    struct eng_step_result result;
    setup(&kit, 0.5);
    assert_int_equal(ask_pairs(&kit, 0.5, 0).count, 1);
    assert_int_equal(ask_pairs(&kit, 0.5, 1).count, 1);
    struct eng_question settings = near_kit_settings(PCCD_NEAR_PAIRS);
    settings.distance = 0.5;
    eng_stage_begin(kit.scene);
    stage_tip(&kit, 3);
    assert_int_equal(eng_near(kit.scene, &settings, &result), PCCD_OK);
    assert_int_equal(result.count, 0);
    assert_int_equal(ask_pairs(&kit, 0.5, 0).count, 1);
    assert_int_equal(ask_pairs(&kit, 3, 1).count, 1);
    near_kit_end(&kit);
}

/* Writes that are only tried leave both ends as they are; those of a staging that is
 * aborted leave the present end, and what they touched stands there. If it failed, a
 * frame that somebody holds, or a request that failed, would move what others ask about;
 * and boxes of positions that never were would be kept by the next step. */
static void near__goes_by_no_staging_that_is_given_up(void **state)
{
    (void)state;
    struct eng_question plain = ENG_QUESTION_DEFAULT;
    for (uint32_t i = 0; i < 2 * WAY_METHODS; i++) {
        struct near_kit kit;
        struct eng_step_result step;
        bool is_trial = i % 2 == 0;
        setup(&kit, 0.5);
        eng_stage_begin(kit.scene);
        stage_tip(&kit, 3);
        plain.method = way_methods[i / 2];
        assert_int_equal(eng_step(kit.scene, &plain, &step), PCCD_OK);
        if (is_trial) {
            eng_stage_validate(kit.scene);
        } else {
            eng_stage_begin(kit.scene);
        }
        stage_tip(&kit, -7);
        eng_stage_abort(kit.scene);
        struct eng_step_result result = ask_pairs(&kit, is_trial ? 0.5 : 3, 0);
        assert_int_equal(result.count, 1);
        assert_true(near_kit_record(&result, 0)->d_lo == (is_trial ? 0.5 : 3));
        result = ask_pairs(&kit, 3, 1);
        assert_true(near_kit_record(&result, 0)->d_lo == 3);
        eng_stage_begin(kit.scene);
        assert_int_equal(eng_step(kit.scene, &plain, &step), PCCD_OK);
        assert_int_equal(step.count, 0);
        assert_int_equal(ask_pairs(&kit, 2.9, 0).count, 0);
        near_kit_end(&kit);
    }
}

/* If it failed: what came since the last step would be near nothing until the next one,
 * as the tree over the objects is another one, without boxes; likewise when some went. */
static void near__sees_what_comes_and_goes_at_rest(void **state)
{
    (void)state;
    struct near_kit kit;
    struct eng_question settings = near_kit_settings(PCCD_NEAR_PAIRS);
    settings.distance = 0.125;
    near_kit_begin(&kit);
    near_kit_add(&kit, kit_sheet(6, 4));
    uint64_t alone = near_kit_ask(&kit, &settings).count;
    near_kit_add(&kit, kit_sheet(6, 4.125));
    uint64_t more = near_kit_ask(&kit, &settings).count - alone;
    assert_true(more > alone);
    for (uint32_t i = 2; i < 6; i++) {
        near_kit_add(&kit, kit_sheet(6, 4 + 0.125 * i));
        assert_int_equal(near_kit_ask(&kit, &settings).count, alone + i * more);
    }
    for (uint32_t i = 0; i < 4; i++) {
        assert_int_equal(eng_scene_remove(kit.scene, kit.idx[i]), PCCD_OK);
        assert_int_equal(near_kit_ask(&kit, &settings).count, alone + (4 - i) * more);
    }
    near_kit_end(&kit);
}

/* If it failed: the answer of a step would change, or be gone, while its client reads
 * it. */
static void near__leaves_the_answer_of_the_last_step(void **state)
{
    (void)state;
    struct near_kit kit;
    struct eng_question plain = ENG_QUESTION_DEFAULT;
    struct eng_step_result step;
    struct eng_thread_record thread;
    setup(&kit, 0.5);
    eng_stage_begin(kit.scene);
    stage_tip(&kit, -0.5);
    assert_int_equal(eng_step(kit.scene, &plain, &step), PCCD_OK);
    assert_int_equal(step.count, 1);
    struct pccd_contact contact = *(const struct pccd_contact *)step.records;
    thread = step.thread_records[0];
    for (uint32_t i = 0; i < WHATS; i++) {
        struct eng_question settings = near_kit_settings(whats[i]);
        settings.distance = 100;
        near_kit_ask(&kit, &settings);
        assert_memory_equal(step.records, &contact, sizeof contact);
        assert_memory_equal(step.thread_records, &thread, sizeof thread);
    }
    near_kit_end(&kit);
}

/* If it failed: a question would be slow, or fail for want of memory, however often it
 * has been asked. */
static void near__asked_once_more_allocates_nothing(void **state)
{
    (void)state;
    for (uint32_t i = 0; i < WHATS * WAY_METHODS * 2; i++) {
        struct near_kit kit;
        struct eng_step_result result;
        struct eng_question settings = near_kit_settings(whats[i % WHATS]);
        settings.distance = 0.25;
        settings.method = way_methods[i / WHATS % WAY_METHODS];
        settings.threads = 1 + i / WHATS / WAY_METHODS;
        settings.team_always = true;
        near_kit_begin(&kit);
        near_kit_add(&kit, kit_sheet(12, 0));
        near_kit_add(&kit, kit_sheet(9, 0.125));
        for (int times = 0; times < 4; times++) {
            assert_int_equal(eng_near(kit.scene, &settings, &result), PCCD_OK);
        }
        assert_int_equal(result.counters.allocs, 0);
        assert_true(result.counters.candidates[PCCD_EE] > 0);
        near_kit_end(&kit);
    }
}

/* If it failed: a question that cannot be answered would be, or would move the scene. */
static void near__refuses_settings_out_of_range(void **state)
{
    (void)state;
    struct near_kit kit;
    struct eng_step_result result;
    setup(&kit, 0.5);
    for (uint32_t i = 0; i < 8; i++) {
        struct eng_question settings = near_kit_settings(PCCD_NEAR_PAIRS);
        const double bad[] = {-0x1p-1074, NAN, INFINITY, 1.1e18};
        settings.distance = i < 4 ? bad[i] : 0.5;
        settings.end = i == 4 ? 2 : 1;
        settings.verb = i == 5 ? PCCD_NEAR_COUNT : PCCD_NEAR_PAIRS;
        settings.threads = i == 6 ? 0 : 1;
        settings.method = i == 7 ? PCCD_METHOD_COUNT : PCCD_METHOD_DEFAULT;
        eng_stage_begin(kit.scene);
        stage_tip(&kit, 3);
        assert_int_equal(eng_near(kit.scene, &settings, &result), PCCD_E_INVAL);
    }
    assert_int_equal(ask_pairs(&kit, 0.5, 1).count, 1);
    struct eng_question crossings = near_kit_settings(PCCD_NEAR_CROSSINGS);
    crossings.distance = NAN; /* not looked at */
    assert_int_equal(eng_near(kit.scene, &crossings, &result), PCCD_OK);
    near_kit_end(&kit);
}

/* Strips of triangles along x, from one place to another. */
static void lay(double x[12][3], double from, double to)
{
    for (uint32_t i = 0; i < 12; i++) {
        x[i][0] = from + (to - from) * (i / 2) / 5;
        x[i][1] = i % 2;
        x[i][2] = 0;
    }
}

static void add_strip(struct near_kit *kit, double from, double to)
{
    double x[12][3];
    uint32_t triangles[10][3];
    lay(x, from, to);
    for (uint32_t i = 0; i < 10; i++) {
        for (uint32_t k = 0; k < 3; k++) {
            triangles[i][k] = i + k;
        }
    }
    near_kit_add(
        kit, kit_mesh((const double(*)[3])x, 12, (const uint32_t(*)[3])triangles, 10));
}

/* If it failed: where a scene is so sparse that gaps between its objects are shortened,
 * an object that shrinks would seem to leave its neighbour behind. */
static void near__finds_what_lies_beside_what_shrinks(void **state)
{
    (void)state;
    for (uint32_t m = 0; m < WAY_METHODS; m++) {
        struct near_kit kit;
        struct eng_question step = ENG_QUESTION_DEFAULT;
        struct eng_step_result stepped;
        double x[12][3];
        near_kit_begin(&kit);
        add_strip(&kit, 0, 10);
        add_strip(&kit, 11, 11.5);
        add_strip(&kit, 1e9, 1e9 + 10);
        step.method = way_methods[m];
        eng_stage_begin(kit.scene);
        lay(x, 0, 1);
        eng_stage_x1(kit.scene, kit.idx[0], PCCD_FORMAT_F64, 0, 12, x);
        lay(x, 2, 2.5);
        eng_stage_x1(kit.scene, kit.idx[1], PCCD_FORMAT_F64, 0, 12, x);
        assert_int_equal(eng_step(kit.scene, &step, &stepped), PCCD_OK);
        struct eng_question settings = near_kit_settings(PCCD_NEAR_PAIRS);
        settings.method = way_methods[m];
        settings.distance = 1;
        settings.end = 1;
        struct eng_step_result result = near_kit_ask(&kit, &settings);
        uint64_t between = 0;
        for (uint64_t i = 0; i < result.count; i++) {
            const struct pccd_near *record = near_kit_record(&result, i);
            between += record->object_a != record->object_b;
        }
        assert_true(between > 0);
        near_kit_end(&kit);
    }
}

/* If it failed: a distance larger than the whole scene would find less than a smaller
 * one, as it is beyond the numbers that boxes are compared in. */
static void near__of_any_distance_finds_all_pairs(void **state)
{
    (void)state;
    for (uint32_t m = 0; m < WAY_METHODS; m++) {
        struct near_kit kit;
        setup(&kit, 1000);
        struct eng_question settings = near_kit_settings(PCCD_NEAR_PAIRS);
        settings.method = way_methods[m];
        settings.end = 1;
        for (settings.distance = 2e3; settings.distance < 1e18; settings.distance *= 30) {
            struct eng_step_result result = near_kit_ask(&kit, &settings);
            /* 3 vertices and 2 faces, 4 and 1, 3 edges and 5; within the floor 2 vertices
             * and faces, and a pair of edges on either side. */
            assert_int_equal(result.count, 3 * 2 + 4 + 3 * 5 + 2 + 2);
        }
        near_kit_end(&kit);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(near__has_what_is_exactly_that_far),
        cmocka_unit_test(near__merges_pairs_to_their_features),
        cmocka_unit_test(near__folds_features_before_it_cuts),
        cmocka_unit_test(near__bounds_the_points_of_pairs),
        cmocka_unit_test(near__takes_radii_off_bounds),
        cmocka_unit_test(near__says_whether_anything_crosses_or_touches),
        cmocka_unit_test(near__is_of_the_end_that_was_asked_for),
        cmocka_unit_test(near__goes_by_no_staging_that_is_given_up),
        cmocka_unit_test(near__sees_what_comes_and_goes_at_rest),
        cmocka_unit_test(near__leaves_the_answer_of_the_last_step),
        cmocka_unit_test(near__asked_once_more_allocates_nothing),
        cmocka_unit_test(near__finds_what_lies_beside_what_shrinks),
        cmocka_unit_test(near__of_any_distance_finds_all_pairs),
        cmocka_unit_test(near__refuses_settings_out_of_range),
    };
    return cmocka_run_group_tests_name("eng_near", tests, NULL, NULL);
}
