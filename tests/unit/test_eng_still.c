/* test_eng_still.c - when what stands still is looked for. */
#include "eng_kit.h"
#include "world.h"

#define SIDE 40u
#define V    ((SIDE + 1) * (SIDE + 1))

/* Return whether vertex i moves, where one of `stride` does, or the first part of that
 * size. */
static bool moves(uint32_t i, uint32_t stride, bool in_one_piece)
{
    return in_one_piece ? i * stride < V : i % stride == 0;
}

/* Features that the step leaves as they are, of a few in which such a part goes up and
 * down. */
static uint64_t still_features(uint32_t stride, bool in_one_piece)
{
    struct eng_question settings = ENG_QUESTION_DEFAULT;
    struct eng_step_result result = {0};
    uint32_t idx;
    struct eng_mesh *mesh = kit_sheet(SIDE, 0);
    assert_int_equal(mesh->info.vertex_count, V);
    struct eng_scene *scene = kit_scene();
    assert_ok(eng_scene_add(scene, mesh, 1, &idx));
    for (uint32_t step = 0; step < 6; step++) {
        static double x[V][3];
        memcpy(x, mesh->x, sizeof x);
        for (uint32_t i = 0; i < V; i++) {
            x[i][2] += moves(i, stride, in_one_piece) ? 0.01 * (step % 2) : 0;
        }
        eng_stage_begin(scene);
        assert_ok(eng_stage_x1(scene, idx, PCCD_FORMAT_F64, 0, V, x));
        result = kit_step(scene, &settings);
    }
    eng_mesh_release(mesh);
    eng_scene_free(scene);
    return result.counters.still_features;
}

/* If it failed: a step would look for what stands in every block and hardly find any,
 * which takes longer than to search all; or it would search all where half of the blocks
 * stand. */
CASE(still__is_looked_for_where_blocks_stand)
{
    assert_int_equal(still_features(2, false), 0);
    assert_true(still_features(2, true) > V);
    assert_true(still_features(50, false) > V); /* most blocks stand */
    assert_true(still_features(50, true) > V);
}

/* Counts pairs by their first features; one thread, as the step has. */
static void count_pairs(void *weigher, const struct pccd_pair *pairs, uint32_t count)
{
    uint32_t(*of_sheet)[2 * V] = weigher;
    for (uint32_t i = 0; i < count; i++) {
        (*of_sheet)[pairs[i].feature_a % (2 * V)]++;
    }
}

/* Two sheets that pass through each other, and then stand in two steps. If it failed:
 * ranks would be cut by pairs that are not looked for, or a step after one that was
 * weighed would take its answer, which has no records, for that of what stands. */
CASE(still__step_that_is_weighed_leaves_no_answer)
{
    struct eng_question settings = ENG_QUESTION_DEFAULT;
    static uint32_t pairs[2 * V];
    static double x[V][3];
    uint32_t idx[2];
    uint64_t weighed = 0;
    struct eng_mesh *mesh = kit_sheet(SIDE, 0);
    struct eng_scene *scene = kit_scene();
    assert_ok(eng_scene_add(scene, mesh, 1, &idx[0]));
    assert_ok(eng_scene_add(scene, mesh, 2, &idx[1]));
    memcpy(x, mesh->x, sizeof x);
    for (uint32_t i = 0; i < V; i++) {
        x[i][2] += i % 2 ? 0.01 : -0.01;
    }
    eng_stage_begin(scene);
    assert_ok(eng_stage_x1(scene, idx[0], PCCD_FORMAT_F64, 0, V, x));
    assert_true(kit_step(scene, &settings).count > 0);
    settings.weigh = count_pairs;
    settings.weigher = pairs;
    struct eng_step_result result = kit_step(scene, &settings);
    assert_int_equal(result.count, 0);
    for (uint32_t i = 0; i < 2 * V; i++) {
        weighed += pairs[i];
    }
    assert_int_equal(weighed, result.counters.survivors);
    assert_true(weighed > V);
    settings.weigh = NULL;
    assert_true(kit_step(scene, &settings).count > 0);
    eng_mesh_release(mesh);
    eng_scene_free(scene);
}

#define SMALL_SIDE 8u
#define SMALL_V    ((SMALL_SIDE + 1) * (SMALL_SIDE + 1))
#define FEW        10u

/* Two large sheets stand on each other, and one of two small ones, far from these, goes
 * to and fro through the other. If it failed: the first records of an answer that is too
 * long would not be the first of all. */
CASE(still__first_records_of_a_long_answer_are_of_what_stands)
{
    struct eng_question question = ENG_QUESTION_DEFAULT;
    static double small_x[SMALL_V][3];
    struct pccd_contact kept[FEW];
    uint32_t idx[4];
    struct eng_mesh *large = kit_sheet(SIDE, 0);
    struct eng_mesh *small = kit_sheet(SMALL_SIDE, 5);
    struct eng_scene *scene = kit_scene();
    for (uint32_t i = 0; i < 4; i++) {
        assert_ok(eng_scene_add(scene, i < 2 ? large : small, i + 1, &idx[i]));
    }
    for (uint32_t step = 0; step < 5; step++) {
        memcpy(small_x, small->x, sizeof small_x);
        for (uint32_t i = 0; i < SMALL_V; i++) {
            small_x[i][2] += step % 2 ? 0.01 : -0.01;
        }
        eng_stage_begin(scene);
        assert_ok(eng_stage_x1(scene, idx[2], PCCD_FORMAT_F64, 0, SMALL_V, small_x));
        question.contact_max = step < 4 ? UINT64_MAX : FEW;
        struct eng_step_result result = kit_step(scene, &question);
        assert_true(result.count >= FEW);
        if (step == 3) { /* the large sheets' come first */
            assert_true(result.counters.kept_records >= FEW);
            memcpy(kept, result.records, sizeof kept);
            assert_int_equal(kept[FEW - 1].object_a, 1);
            assert_int_equal(
                ((const struct pccd_contact *)result.records)[result.count - 1].object_a,
                3);
        } else if (step == 4) {
            assert_true(result.counters.kept_records > 0);
            assert_int_equal(result.incomplete, PCCD_INCOMPLETE_CONTACT_LIMIT);
            assert_int_equal(result.count, FEW);
            assert_memory_equal(result.records, kept, sizeof kept);
        }
    }
    eng_mesh_release(large);
    eng_mesh_release(small);
    eng_scene_free(scene);
}
