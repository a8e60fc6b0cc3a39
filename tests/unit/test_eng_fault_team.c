/* test_eng_fault_team.c - a step by several threads when memory runs out. */
#include "eng_scarce.h"
#include "step.h"
#include "world.h"

#define TRIANGLES 1100u /* enough for a team */
#define THREADS   4u

static int try_step(struct eng_scene *scene, const struct eng_question *settings,
                    struct eng_step_result *result)
{
    const uint64_t failures = scarce.failures;
    int status = eng_step(scene, settings, result);
    if (status == PCCD_OK && result->incomplete != PCCD_COMPLETE) {
        assert_int_equal(result->incomplete, PCCD_INCOMPLETE_CONTACT_LIMIT);
        assert_true(scarce.failures > failures);
        return PCCD_E_NOMEM;
    }
    return status;
}

/* One step of a new scene, again if memory ran out; the hash of its answer. */
static uint64_t live(struct eng_mesh *mesh, enum pccd_mode mode,
                     enum eng_scheduler scheduler)
{
    struct eng_question settings = ENG_QUESTION_DEFAULT;
    struct eng_step_result result;
    struct eng_scene *scene = NULL;
    uint32_t idx;
    settings.mode = mode;
    settings.threads = THREADS;
    settings.team_always = true;
    settings.tuning.scheduler = scheduler;
    RETRY(eng_scene_new(NULL, &scene));
    RETRY(eng_scene_add(scene, mesh, 1, &idx));
    RETRY(try_step(scene, &settings, &result));
    assert_true(result.count > 5000); /* enough to be merged by all */
    assert_int_equal(result.threads, THREADS);
    uint64_t hash = result.hash[1];
    eng_scene_free(scene);
    return hash;
}

/* If it failed: threads would wait for ever for one that had no memory, or an answer
 * without some of its records would look whole. */
CASE(fault_team__every_allocation_of_a_step_may_fail)
{
    struct prng random = {92};
    struct eng_mesh *mesh = kit_soup(&random, TRIANGLES);
    const uint64_t held = scarce.held_blocks;
    for (int i = 0; i < 4; i++) {
        enum eng_scheduler scheduler = i % 2 ? ENG_SCHEDULER_PAPER : ENG_SCHEDULER_STEAL;
        uint64_t hash = live(mesh, PCCD_MODE_PAIRS, scheduler);
        scarce.goes_on_failing = i >= 2;
        for (uint64_t n = 1, unharmed = 0; unharmed < 3; n++) {
            scarce.countdown = n;
            scarce.failures = 0;
            assert_true(live(mesh, PCCD_MODE_PAIRS, scheduler) == hash);
            unharmed += scarce.failures == 0;
            assert_int_equal(scarce.held_blocks, held);
            assert_true(n > 10 || scarce.failures == 1);
        }
        scarce.countdown = 0;
    }
    eng_mesh_release(mesh);
    assert_int_equal(scarce.held_blocks, 0);
}
