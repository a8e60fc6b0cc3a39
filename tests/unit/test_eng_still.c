/* test_eng_still.c - when what stands still is looked for. */
#include "eng_kit.h"
#include "step.h"
#include "world.h"

#define SIDE 40u
#define V    ((SIDE + 1) * (SIDE + 1))

/* Does vertex i move, where one of `stride` does, or the first part of that size? */
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
