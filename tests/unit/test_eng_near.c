/* test_eng_near.c - pairs, features, bounds and crossings whose answer is known by
 * construction; limits, errors, and what a question leaves as it was.
 */
#include "eng_kit.h"
#include "eng_way.h"
#include "record_hash.h"

static const enum pccd_near_what whats[] = {PCCD_NEAR_PAIRS, PCCD_NEAR_FEATURES,
                                            PCCD_NEAR_VERTICES, PCCD_NEAR_CROSSINGS};
#define WHATS (sizeof whats / sizeof whats[0])

/* Object 1: a square in the plane z = 0. Object 2: a triangle that stands on its tip,
 * vertex 0, at (1, 0.5, height), above the inside of the floor's face 0. */
static void setup(double height)
{
    static const double floor[4][3] = {{-4, -4, 0}, {4, -4, 0}, {4, 4, 0}, {-4, 4, 0}};
    static const uint32_t halves[2][3] = {{0, 1, 2}, {0, 2, 3}};
    static const uint32_t corners[1][3] = {{0, 1, 2}};
    const double tent[3][3] = {
        {1, 0.5, height}, {2, 0.5, height + 16}, {1, 1.5, height + 16}};
    kit_begin_with(kit_mesh(floor, 4, halves, 2), kit_mesh(tent, 3, corners, 1));
}

static void stage_tip(double height)
{
    const double tip[1][3] = {{1, 0.5, height}};
    assert_ok(eng_stage_x1(kit.scene, kit.idx[1], PCCD_FORMAT_F64, 0, 1, tip));
}

static struct eng_step_result ask_pairs(double distance, uint32_t end)
{
    struct eng_question settings = kit_question(PCCD_NEAR_PAIRS);
    settings.distance = distance;
    settings.end = end;
    return kit_ask(&settings);
}

/* If it failed: what is exactly as far away as was asked for would be left out, or what
 * is farther by one bit would not. */
CASE(near__has_what_is_exactly_that_far)
{
    setup(0.1);
    assert_int_equal(ask_pairs(nextafter(0.1, 0), 1).count, 0);
    struct eng_step_result result = ask_pairs(0.1, 1);
    assert_int_equal(result.count, 1);
    const struct pccd_near *record = kit_record(&result, 0);
    kit_check_names(record, PCCD_VF, 2, 0, 1, 0);
    assert_true(record->d_lo <= 0.1 && record->d_hi >= 0.1 &&
                record->d_hi - record->d_lo <= 0x1p-36);
    assert_true(record->direction[2] == 1 && record->count == 1);
}

/* Two edges of the floor end at one corner, and three edges of the tent at its tip. If it
 * failed: the same contact of two corners would be counted once for each of them. */
CASE(near__merges_pairs_to_their_features)
{
    static const double left[3][3] = {{0, 0, 0}, {-4, 4, 0}, {-4, -4, 0}};
    static const double right[3][3] = {{1, 0, 0}, {5, 4, 0}, {5, -4, 0}};
    static const uint32_t corners[1][3] = {{0, 1, 2}};
    kit_begin_with(kit_mesh(left, 3, corners, 1), kit_mesh(right, 3, corners, 1));
    struct eng_question settings = kit_question(PCCD_NEAR_FEATURES);
    settings.distance = 1;
    struct eng_step_result result = kit_ask(&settings);
    assert_int_equal(result.count, 1);
    const struct pccd_near *record = kit_record(&result, 0);
    kit_check_names(record, PCCD_VV, 1, 0, 2, 0);
    /* Two vertices and their opposite faces, and two edges with two. */
    assert_int_equal(record->count, 6);
    assert_true(record->d_lo == 1 && record->d_hi == 1 && record->direction[0] == -1);
    assert_true(result.counts[PCCD_VV] == 1 && result.distance_min == 1 &&
                result.distance_max == 1);
}

/* Sheets above each other: each vertex of one is nearest to one of the other, by some 40
 * pairs of their faces and edges. If it failed: an answer of few features would be cut
 * because their pairs are many, or the last ones would be counted in part (sheets of 24
 * squares a side are too small to see that). */
CASE(near__folds_features_before_it_cuts)
{
    kit_begin_with(kit_sheet(32, 0), kit_sheet(32, 0x1p-10));
    struct eng_question settings = kit_question(PCCD_NEAR_FEATURES);
    settings.distance = 0x1p-10;
    struct eng_step_result result = kit_ask(&settings);
    uint64_t count = result.count;
    uint64_t pairs = 0, hash[2];
    struct pccd_near *all = test_copy(result.records, count * sizeof *all);
    for (uint64_t i = 0; i < count; i++) {
        pairs += all[i].count;
    }
    assert_true(pairs > 10 * count && count > 1000);
    for (uint32_t threads = 1; threads <= 2; threads++) {
        settings.threads = threads;
        settings.contact_max = count;
        result = kit_near(kit.scene, &settings);
        assert_int_equal(result.incomplete, PCCD_COMPLETE);
        assert_int_equal(result.count, count);
        assert_memory_equal(result.records, all, count * sizeof *all);
        settings.contact_max = count / 3;
        result = kit_near(kit.scene, &settings);
        assert_int_equal(result.incomplete, PCCD_INCOMPLETE_CONTACT_LIMIT);
        assert_int_equal(result.count, count / 3);
        record_hash_2(all, count / 3, sizeof *all, hash);
        assert_memory_equal(result.hash, hash, sizeof hash);
        assert_int_equal(result.counts[PCCD_VV], count / 3);
        for (uint64_t i = 0; i < result.count; i++) {
            const struct pccd_near *record = kit_record(&result, i);
            assert_int_equal(record->kind, all[i].kind);
            assert_int_equal(record->feature_a, all[i].feature_a);
            assert_int_equal(record->count, all[i].count);
        }
    }
    free(all);
}

/* If it failed: a vertex could move by more than is safe, or all would be held back by
 * what is near one of them. */
CASE(near__bounds_the_points_of_pairs)
{
    setup(0.25);
    struct eng_question settings = kit_question(PCCD_NEAR_VERTICES);
    settings.distance = 0.375;
    struct eng_step_result result = kit_ask(&settings);
    const double *bounds = result.records;
    static const double want[7] = {0.25, 0.25, 0.25, 0.375, 0.25, 0.375, 0.375};
    assert_int_equal(result.count, 7);
    assert_int_equal(result.record_bytes, sizeof(double));
    assert_memory_equal(bounds, want, sizeof want);
    settings.objects[0] = 2;
    result = kit_ask(&settings);
    assert_int_equal(result.count, 3);
    assert_memory_equal(result.records, want + 4, 3 * sizeof want[0]);
    settings.objects[0] = 9;
    assert_int_equal(eng_near(kit.scene, &settings, &result), PCCD_E_HANDLE);
}

/* The floor has a radius of 0.0625, the tip's vertex one of its own. If it failed: thick
 * surfaces would meet although each vertex has moved by less than half its bound. */
CASE(near__takes_radii_off_bounds)
{
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
    kit_begin_with(kit_mesh(floor, 4, halves, 2),
                   kit_mesh_thick(spike, 3, corners, 1, radii));
    struct eng_question settings = kit_question(PCCD_NEAR_VERTICES);
    for (int i = 0; i < 3; i++) {
        struct eng_object_thickness more = thick;
        more.radius = i == 2 ? 0.5 : thick.radius;
        assert_ok(eng_scene_set_thickness(kit.scene, kit.idx[0], &more));
        settings.distance = i == 1 ? 0.125 : 0.25;
        struct eng_step_result result = kit_ask(&settings);
        assert_memory_equal(result.records, want[i], sizeof want[i]);
        assert_true(result.distance_min == want[i][0] &&
                    result.distance_max == want[i][0]);
    }
}

/* The tip through the floor, on it, and above it. If it failed: an intersection would be
 * taken for none. */
CASE(near__says_whether_anything_crosses_or_touches)
{
    static const double heights[3] = {-1, 0, 0x1p-60};
    static const uint64_t crossings[3] = {2, 0, 0};
    static const enum pccd_verdict verdicts[3] = {PCCD_VERDICT_YES, PCCD_VERDICT_YES,
                                                  PCCD_VERDICT_NO};
    for (int i = 0; i < 3; i++) {
        setup(heights[i]);
        struct eng_question settings = kit_question(PCCD_NEAR_CROSSINGS);
        struct eng_step_result result = kit_ask(&settings);
        assert_int_equal(result.count, crossings[i]);
        assert_int_equal(result.crossings, crossings[i]);
        assert_int_equal(result.verdict, verdicts[i]);
        settings.method = PCCD_METHOD_WIDE;
        result = kit_near(kit.scene, &settings);
        assert_int_equal(result.verdict, verdicts[i]);
        /* What touches need not be looked for where something crosses. */
        assert_true(i == 2 || (result.counters.candidates[PCCD_EE] == 0) == (i == 0));
        if (i == 0) { /* of which nothing is kept */
            settings.contact_max = 0;
            result = kit_near(kit.scene, &settings);
            assert_int_equal(result.incomplete, PCCD_INCOMPLETE_CONTACT_LIMIT);
            assert_int_equal(result.verdict, PCCD_VERDICT_NONE);
            assert_int_equal(result.count, 0);
        }
    }
}

/* Before any step both ends are as registered; a question that moves has the old place at
 * end 0. If it failed: answers would be about another moment. */
CASE(near__is_of_the_end_that_was_asked_for)
{
    setup(0.5);
    assert_int_equal(ask_pairs(0.5, 0).count, 1);
    assert_int_equal(ask_pairs(0.5, 1).count, 1);
    struct eng_question settings = kit_question(PCCD_NEAR_PAIRS);
    settings.distance = 0.5;
    eng_stage_begin(kit.scene);
    stage_tip(3);
    struct eng_step_result result = kit_near(kit.scene, &settings);
    assert_int_equal(result.count, 0);
    assert_int_equal(ask_pairs(0.5, 0).count, 1);
    assert_int_equal(ask_pairs(3, 1).count, 1);
}

/* Writes that are only tried leave both ends as they are; those of a staging that is
 * aborted leave the present end, and what they touched stands there. If it failed, a
 * frame that somebody holds, or a request that failed, would move what others ask about;
 * and boxes of positions that never were would be kept by the next step. */
CASE(near__goes_by_no_staging_that_is_given_up)
{
    struct eng_question plain = ENG_QUESTION_DEFAULT;
    for (uint32_t i = 0; i < 2 * WAY_METHODS; i++) {
        bool is_trial = i % 2 == 0;
        setup(0.5);
        eng_stage_begin(kit.scene);
        stage_tip(3);
        plain.method = way_methods[i / 2];
        struct eng_step_result step = kit_step(kit.scene, &plain);
        if (is_trial) {
            eng_stage_validate(kit.scene);
        } else {
            eng_stage_begin(kit.scene);
        }
        stage_tip(-7);
        eng_stage_abort(kit.scene);
        struct eng_step_result result = ask_pairs(is_trial ? 0.5 : 3, 0);
        assert_int_equal(result.count, 1);
        assert_true(kit_record(&result, 0)->d_lo == (is_trial ? 0.5 : 3));
        result = ask_pairs(3, 1);
        assert_true(kit_record(&result, 0)->d_lo == 3);
        eng_stage_begin(kit.scene);
        step = kit_step(kit.scene, &plain);
        assert_int_equal(step.count, 0);
        assert_int_equal(ask_pairs(2.9, 0).count, 0);
    }
}

/* If it failed: what came since the last step would be near nothing until the next one,
 * as the tree over the objects is another one, without boxes; and what went would still
 * be near. */
CASE(near__sees_what_comes_and_goes_at_rest)
{
    struct eng_question settings = kit_question(PCCD_NEAR_PAIRS);
    settings.distance = 0.126; /* to decide 0.125 itself takes exact arithmetic */
    kit_begin();
    kit_put(kit_sheet(6, 4));
    uint64_t alone = kit_ask(&settings).count;
    kit_put(kit_sheet(6, 4.125));
    uint64_t more = kit_ask(&settings).count - alone;
    assert_true(more > alone);
    for (uint32_t i = 2; i < 6; i++) {
        kit_put(kit_sheet(6, 4 + 0.125 * i));
        assert_int_equal(kit_ask(&settings).count, alone + i * more);
    }
    for (uint32_t i = 0; i < 4; i++) {
        assert_ok(eng_scene_remove(kit.scene, kit.idx[i]));
        assert_int_equal(kit_ask(&settings).count, alone + (4 - i) * more);
    }
}

/* If it failed: the answer of a step would change, or be gone, while its client reads
 * it. */
CASE(near__leaves_the_answer_of_the_last_step)
{
    struct eng_question plain = ENG_QUESTION_DEFAULT;
    struct eng_thread_record thread;
    setup(0.5);
    eng_stage_begin(kit.scene);
    stage_tip(-0.5);
    struct eng_step_result step = kit_step(kit.scene, &plain);
    assert_int_equal(step.count, 1);
    struct pccd_contact contact = *(const struct pccd_contact *)step.records;
    thread = step.thread_records[0];
    for (uint32_t i = 0; i < WHATS; i++) {
        struct eng_question settings = kit_question(whats[i]);
        settings.distance = 100;
        kit_ask(&settings);
        assert_memory_equal(step.records, &contact, sizeof contact);
        assert_memory_equal(step.thread_records, &thread, sizeof thread);
    }
}

/* If it failed: a question would be slow, or fail for want of memory, however often it
 * has been asked. */
CASE(near__asked_once_more_allocates_nothing)
{
    for (uint32_t i = 0; i < WHATS * WAY_METHODS * 2; i++) {
        struct eng_step_result result;
        struct eng_question settings = kit_question(whats[i % WHATS]);
        settings.distance = 0.15;
        settings.method = way_methods[i / WHATS % WAY_METHODS];
        settings.threads = 1 + i / WHATS / WAY_METHODS;
        settings.team_always = true;
        kit_begin_with(kit_sheet(8, 0), kit_sheet(6, 0.125));
        for (int times = 0; times < 4; times++) {
            result = kit_near(kit.scene, &settings);
        }
        assert_int_equal(result.counters.allocs, 0);
        assert_true(result.counters.candidates[PCCD_EE] > 0);
    }
}

/* If it failed: a question that cannot be answered would be, or would move the scene. */
CASE(near__refuses_settings_out_of_range)
{
    struct eng_step_result result;
    setup(0.5);
    for (uint32_t i = 0; i < 8; i++) {
        struct eng_question settings = kit_question(PCCD_NEAR_PAIRS);
        const double bad[] = {-0x1p-1074, NAN, INFINITY, 1.1e18};
        settings.distance = i < 4 ? bad[i] : 0.5;
        settings.end = i == 4 ? 2 : 1;
        settings.verb = i == 5 ? PCCD_NEAR_COUNT : PCCD_NEAR_PAIRS;
        settings.threads = i == 6 ? 0 : 1;
        settings.method = i == 7 ? PCCD_METHOD_COUNT : PCCD_METHOD_DEFAULT;
        eng_stage_begin(kit.scene);
        stage_tip(3);
        assert_int_equal(eng_near(kit.scene, &settings, &result), PCCD_E_INVAL);
    }
    assert_int_equal(ask_pairs(0.5, 1).count, 1);
    struct eng_question crossings = kit_question(PCCD_NEAR_CROSSINGS);
    crossings.distance = NAN; /* not looked at */
    result = kit_near(kit.scene, &crossings);
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

static void add_strip(double from, double to)
{
    double x[12][3];
    uint32_t triangles[10][3];
    lay(x, from, to);
    for (uint32_t i = 0; i < 10; i++) {
        for (uint32_t k = 0; k < 3; k++) {
            triangles[i][k] = i + k;
        }
    }
    kit_put(kit_mesh(x, 12, triangles, 10));
}

/* If it failed: where a scene is so sparse that gaps between its objects are shortened,
 * an object that shrinks would seem to leave its neighbour behind. */
CASE(near__finds_what_lies_beside_what_shrinks)
{
    for (uint32_t m = 0; m < WAY_METHODS; m++) {
        struct eng_question step = ENG_QUESTION_DEFAULT;
        double x[12][3];
        kit_begin();
        add_strip(0, 10);
        add_strip(11, 11.5);
        add_strip(1e9, 1e9 + 10);
        step.method = way_methods[m];
        eng_stage_begin(kit.scene);
        lay(x, 0, 1);
        eng_stage_x1(kit.scene, kit.idx[0], PCCD_FORMAT_F64, 0, 12, x);
        lay(x, 2, 2.5);
        eng_stage_x1(kit.scene, kit.idx[1], PCCD_FORMAT_F64, 0, 12, x);
        kit_step(kit.scene, &step);
        struct eng_question settings = kit_question(PCCD_NEAR_PAIRS);
        settings.method = way_methods[m];
        settings.distance = 1;
        settings.end = 1;
        struct eng_step_result result = kit_ask(&settings);
        uint64_t between = 0;
        for (uint64_t i = 0; i < result.count; i++) {
            const struct pccd_near *record = kit_record(&result, i);
            between += record->object_a != record->object_b;
        }
        assert_true(between > 0);
    }
}

/* If it failed: a distance larger than the whole scene would find less than a smaller
 * one, as it is beyond the numbers that boxes are compared in. */
CASE(near__of_any_distance_finds_all_pairs)
{
    for (uint32_t m = 0; m < WAY_METHODS; m++) {
        setup(1000);
        struct eng_question settings = kit_question(PCCD_NEAR_PAIRS);
        settings.method = way_methods[m];
        settings.end = 1;
        for (settings.distance = 2e3; settings.distance < 1e18; settings.distance *= 30) {
            struct eng_step_result result = kit_ask(&settings);
            /* 3 vertices and 2 faces, 4 and 1, 3 edges and 5; within the floor 2 vertices
             * and faces, and a pair of edges on either side. */
            assert_int_equal(result.count, 3 * 2 + 4 + 3 * 5 + 2 + 2);
        }
    }
}
