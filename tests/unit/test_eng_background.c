/* test_eng_background.c - large subtrees, built in the background and swapped in.
 *
 * Source: daemon/engine/paper/background.h; paper sections 6.2 and 7.1.
 */
#include "background.h"
#include "eng_blast.h"
#include "paper.h"

#define REGION    40u /* triangles; the whole has 2312 */
#define STEPS_MAX 500u

static struct blast blast;

static void start(double ratio)
{
    blast_init(&blast, &(struct eng_scene_settings){ratio, REGION, 1});
}

static struct eng_question team_of(uint32_t threads, enum eng_scheduler scheduler)
{
    struct eng_question settings = kit_contacts(PCCD_MODE_ALL, PCCD_METHOD_PAPER);
    settings.threads = threads;
    settings.tuning.scheduler = scheduler;
    return settings;
}

static struct eng_step_result stand_still(double t)
{
    return blast_run(&blast, t, t, team_of(1, ENG_SCHEDULER_STEAL));
}

static bool is_busy(const struct eng_scene *scene)
{
    const struct eng_background *background = &eng_paper_of(scene)->background;
    for (uint32_t i = 0; i < background->part_count; i++) {
        if (background->parts[i].state != ENG_BACKGROUND_GONE) {
            return true;
        }
    }
    return false;
}

/* Step on the spot until nothing is being built; returns the triangles swapped in. */
static uint64_t settle(double t, struct eng_step_result *result)
{
    uint64_t triangles = 0;
    for (uint32_t step = 0; step < STEPS_MAX; step++) {
        *result = stand_still(t);
        triangles += result->counters.swapped_triangles;
        assert_int_equal(result->counters.swaps > 0,
                         result->counters.swapped_triangles > 0);
        if (!is_busy(blast.scene)) {
            return triangles;
        }
    }
    fail_msg("still busy after %u steps", STEPS_MAX);
    return 0;
}

/* If it failed: the upper levels of a hierarchy would stay as bad as they have become, or
 * only a long step would make them good. */
CASE(aside__poor_high_nodes_become_good)
{
    const double t = 0.3;
    start(0);
    uint64_t never = stand_still(t).counters.box_tests;
    blast_rebuild(&blast);
    uint64_t fresh = stand_still(t).counters.box_tests;
    blast_deinit(&blast);
    start(0.9);
    struct eng_step_result result;
    assert_true(settle(t, &result) >= BLAST_TRIANGLES);
    uint64_t swapped = result.counters.box_tests;
    assert_true(fresh > 0 && swapped > 0);
    assert_true(never > 3 * fresh);
    assert_true((double)swapped < 1.1 * (double)fresh);
    /* It knows when it is done. */
    for (int step = 0; step < 5; step++) {
        result = stand_still(t);
        assert_int_equal(result.counters.swaps, 0);
        assert_int_equal(result.counters.rebuilds, 0);
        assert_int_equal(result.counters.box_tests, swapped);
    }
    blast_deinit(&blast);
}

/* If it failed: a large scene would be rebuilt within a step, which would then take as
 * long as many: the spikes of the paper's figure 6. */
CASE(aside__shares_are_as_small_as_they_are_told)
{
    struct eng_step_result result;
    start(0.9);
    struct eng_background *background = &eng_paper_of(blast.scene)->background;
    uint32_t swap_step = 0;
    uint64_t swapped = 0;
    for (uint32_t step = 0; step < STEPS_MAX && swapped == 0; step++) {
        background->budget_ns = 20000; /* triangles are listed in a quarter of it */
        result = stand_still(0.3);
        swapped = result.counters.swapped_triangles;
        swap_step = step;
    }
    assert_int_equal(swapped, BLAST_TRIANGLES);
    /* Listing takes a few steps, building several. */
    assert_true(swap_step >= 3);
    blast_deinit(&blast);
}

/* If it failed: contacts would be lost or doubled while a subtree is built in the
 * background, or by its swap. */
CASE(aside__answers_do_not_notice)
{
    const double dt = 0.02;
    uint64_t expected[12][2];
    start(0);
    for (uint32_t step = 0; step < 12; step++) {
        struct eng_step_result result = blast_run(&blast, step * dt, (step + 1) * dt,
                                                  team_of(1, ENG_SCHEDULER_STEAL));
        expected[step][0] = result.hash[0];
        expected[step][1] = result.hash[1];
    }
    blast_deinit(&blast);
    for (int way = 0; way < 8; way++) {
        enum eng_scheduler scheduler =
            way & 1 ? ENG_SCHEDULER_PAPER : ENG_SCHEDULER_STEAL;
        uint64_t swaps = 0;
        start(0.9);
        for (uint32_t step = 0; step < 12; step++) {
            struct eng_step_result result = blast_run(&blast, step * dt, (step + 1) * dt,
                                                      team_of(1u << way / 2, scheduler));
            assert_int_equal(result.hash[0], expected[step][0]);
            assert_int_equal(result.hash[1], expected[step][1]);
            swaps += result.counters.swaps;
        }
        assert_true(swaps > 0);
        blast_deinit(&blast);
    }
}

/* If it failed: a subtree would be swapped into nodes that belong to another object by
 * now. */
CASE(aside__objects_that_go_take_their_subtrees_along)
{
    struct prng random = {66};
    struct eng_mesh *soups[2] = {kit_soup(&random, 400), kit_soup(&random, 3000)};
    start(0.9);
    for (uint32_t round = 0; round < 60; round++) {
        struct eng_background *background = &eng_paper_of(blast.scene)->background;
        uint32_t other;
        assert_ok(eng_scene_add(blast.scene, soups[round % 2], 9, &other));
        for (uint32_t step = 0; step <= round / 4; step++) {
            background->budget_ns =
                8000 + 5000 * (round % 7); /* to be anywhere in the work */
            stand_still(0.05 * round);
        }
        if (round % 3 == 0) {
            assert_ok(eng_scene_replace(blast.scene, blast.idx, soups[0]));
            blast_deinit(&blast);
            start(0.9);
            continue;
        }
        uint32_t gone = other;
        assert_ok(eng_scene_remove(blast.scene, gone));
        struct eng_step_result result = stand_still(0.05 * round);
        assert_int_equal(result.incomplete, PCCD_COMPLETE);
    }
    eng_mesh_release(soups[0]);
    eng_mesh_release(soups[1]);
    blast_deinit(&blast);
}

/* If it failed: every large reconstruction would go to the system for memory. */
CASE(aside__memory_is_taken_once)
{
    struct eng_step_result result;
    uint64_t swapped = 0;
    start(0.9);
    assert_true(settle(0.3, &result) > 0);
    for (uint32_t step = 0; step < 3; step++) {
        stand_still(0); /* contacts take memory too, and what is kept when all stands */
    }
    uint64_t bytes = eng_scene_bytes(blast.scene);
    for (uint32_t round = 1; round < 6; round++) {
        for (uint32_t step = 0; step < 5; step++) {
            result = stand_still(round % 2 ? 0 : 0.3);
            assert_int_equal(result.counters.allocs, 0);
            swapped += result.counters.swapped_triangles;
        }
    }
    assert_true(swapped > 0);
    assert_true(eng_background_bytes(&eng_paper_of(blast.scene)->background) >=
                BLAST_TRIANGLES * sizeof(struct eng_split_item));
    assert_int_equal(eng_scene_bytes(blast.scene), bytes);
    blast_deinit(&blast);
}
