/* test_eng_effort.c - when a team pays for a step. */
#include "eng_kit.h"
#include "step_memory.h"

#define MS 1000000u

/* If it failed: every small request would wake a team, or no large one would. */
CASE(effort__unknown_scenes_go_by_their_size)
{
    struct eng_effort effort;
    eng_effort_forget(&effort);
    assert_false(eng_effort_pays(&effort, PCCD_MODE_ALL, 2));
    assert_false(eng_effort_pays(&effort, PCCD_MODE_ALL, 100));
    assert_true(eng_effort_pays(&effort, PCCD_MODE_ALL, 10000));
    assert_true(eng_effort_pays(&effort, PCCD_MODE_ALL, UINT32_MAX));
}

/* If it failed: a scene whose triangles are far apart, or crowded, would be taken for
 * another. */
CASE(effort__known_scenes_go_by_their_work)
{
    struct eng_effort effort;
    eng_effort_forget(&effort);
    eng_effort_learn(&effort, PCCD_MODE_ALL, MS / 100);
    assert_false(eng_effort_pays(&effort, PCCD_MODE_ALL, UINT32_MAX));
    eng_effort_forget(&effort);
    eng_effort_learn(&effort, PCCD_MODE_ALL, 100 * MS);
    assert_true(eng_effort_pays(&effort, PCCD_MODE_ALL, 2));
    eng_effort_learn(&effort, PCCD_MODE_ANY, MS / 100);
    assert_true(eng_effort_pays(&effort, PCCD_MODE_ALL, 2));
    assert_false(eng_effort_pays(&effort, PCCD_MODE_ANY, 2));
    eng_effort_forget(&effort);
    assert_false(eng_effort_pays(&effort, PCCD_MODE_ALL, 2));
}

/* Work from which a team pays after steps that did or did not. */
static uint64_t border(bool paid)
{
    struct eng_effort effort;
    uint64_t work_ns = 1000;
    eng_effort_forget(&effort);
    do {
        work_ns += 1000;
        effort.paid = paid;
        effort.work_ns[PCCD_MODE_ALL] = work_ns;
    } while (!eng_effort_pays(&effort, PCCD_MODE_ALL, 2));
    return work_ns;
}

/* If it failed: a scene at the border would be taken by one thread and by many in turn,
 * and its times would jump. */
CASE(effort__border_scenes_stay_with_the_last_answer)
{
    struct eng_effort effort;
    uint64_t up = border(false);
    uint64_t down = border(true);
    assert_true(down > 50000 && up < 2 * MS);
    assert_true(up >= 3 * down / 2);
    uint64_t middle = (up + down) / 2;
    eng_effort_forget(&effort);
    for (uint32_t i = 0; i < 100; i++) {
        eng_effort_learn(&effort, PCCD_MODE_ALL, middle + (i % 2 ? middle / 8 : 0));
        assert_false(eng_effort_pays(&effort, PCCD_MODE_ALL, 2));
    }
    effort.paid = true;
    for (uint32_t i = 0; i < 100; i++) {
        eng_effort_learn(&effort, PCCD_MODE_ALL, middle - (i % 2 ? middle / 8 : 0));
        assert_true(eng_effort_pays(&effort, PCCD_MODE_ALL, 2));
    }
}

/* If it failed: a thread that lost its processor once would wake teams for a small scene
 * from then on. */
CASE(effort__one_odd_step_changes_little)
{
    struct eng_effort effort;
    eng_effort_forget(&effort);
    eng_effort_learn(&effort, PCCD_MODE_ALL, 100000);
    eng_effort_learn(&effort, PCCD_MODE_ALL, 50 * MS);
    assert_false(eng_effort_pays(&effort, PCCD_MODE_ALL, 2));
    eng_effort_learn(&effort, PCCD_MODE_ALL, 100000);
    assert_int_equal(effort.work_ns[PCCD_MODE_ALL], 100000);
    for (int i = 0; i < 10; i++) { /* but a change that lasts is believed */
        eng_effort_learn(&effort, PCCD_MODE_ALL, 50 * MS);
    }
    assert_true(eng_effort_pays(&effort, PCCD_MODE_ALL, 2));
    eng_effort_learn(&effort, PCCD_MODE_ALL, 0);
    assert_true(eng_effort_pays(&effort, PCCD_MODE_ALL, 2));
}

/* The answers to so many steps in a row, each of which takes that long. Returns how many
 * a team had. */
static uint32_t run_steps(struct eng_effort *effort, uint64_t alone_ns, uint64_t team_ns,
                          uint32_t count)
{
    uint32_t teams = 0;
    for (uint32_t i = 0; i < count; i++) {
        bool by_team = eng_effort_pays(effort, PCCD_MODE_ALL, 2);
        teams += by_team;
        eng_effort_learn(effort, PCCD_MODE_ALL, 400000);
        eng_effort_time(effort, PCCD_MODE_ALL, by_team, by_team ? team_ns : alone_ns);
    }
    return teams;
}

/* If it failed: steps of some hundred microseconds would wait for a thread whose
 * processor another process has, or not take a team where nothing is in its way. */
CASE(effort__near_the_border_the_clock_decides)
{
    struct eng_effort effort;
    eng_effort_forget(&effort);
    eng_effort_learn(&effort, PCCD_MODE_ALL, 400000);
    assert_in_range(run_steps(&effort, 400000, 250000, 320), 300, 319);
    /* others come: the team waits for milliseconds */
    assert_in_range(run_steps(&effort, 400000, 4000000, 320), 8, 20);
    /* and go */
    (void)run_steps(&effort, 400000, 250000, 1600);
    assert_in_range(run_steps(&effort, 400000, 250000, 320), 300, 319);
    eng_effort_forget(&effort); /* much work: whatever the clock says */
    eng_effort_time(&effort, PCCD_MODE_ALL, true, 50 * MS);
    eng_effort_time(&effort, PCCD_MODE_ALL, false, 10 * MS);
    eng_effort_learn(&effort, PCCD_MODE_ALL, 10 * MS);
    for (int i = 0; i < 100; i++) {
        assert_true(eng_effort_pays(&effort, PCCD_MODE_ALL, 2));
    }
}

/* If it failed: a scene of which little moves would be taken for the work of its first
 * step for ever, however long that was off its processor: teams would be woken for some
 * microseconds of work, and no step be brief. */
CASE(effort__one_slow_step_is_forgotten_where_most_stands)
{
    test_skip_emulated("an emulator takes many times as long for a step");
    struct prng random = {3};
    struct eng_effort effort;
    struct eng_question settings = ENG_QUESTION_DEFAULT;
    uint64_t still = 0;
    double x[24][3];
    uint32_t idx[2];
    eng_effort_forget(&effort);
    eng_effort_learn(&effort, PCCD_MODE_ALL, 8 * MS);
    eng_effort_learn_part(&effort, PCCD_MODE_ALL, 0, MS);
    eng_effort_learn_part(&effort, PCCD_MODE_ALL, 0.5, 5 * MS); /* no more than known */
    assert_int_equal(effort.work_ns[PCCD_MODE_ALL], 8 * MS);
    eng_effort_learn_part(&effort, PCCD_MODE_ALL, 0.5, 3 * MS);
    assert_int_equal(effort.work_ns[PCCD_MODE_ALL], 6 * MS);
    struct eng_scene *scene = kit_scene();
    for (uint32_t i = 0; i < 2; i++) {
        idx[i] = kit_add(scene, kit_soup(&random, 8), 1 + i);
    }
    settings.threads = 2;
    struct eng_step_result result = kit_step(scene, &settings);
    uint64_t *work_ns =
        eng_step_memory_of(scene)->effort[result.method].work_ns + PCCD_MODE_ALL;
    *work_ns = 50 * MS; /* as if others had had the processor */
    for (int i = 0; i < 100; i++) {
        for (int k = 0; k < 24; k++) {
            for (int axis = 0; axis < 3; axis++) {
                x[k][axis] = prng_between(&random, 0, 1);
            }
        }
        eng_stage_begin(scene);
        assert_ok(eng_stage_x1(scene, idx[1], PCCD_FORMAT_F64, 0, 24, x));
        result = kit_step(scene, &settings);
        still += result.counters.still_features;
    }
    assert_true(still > 0 && *work_ns < 2 * MS);
    eng_scene_free(scene);
}

/* If it failed: steps would not ask, or would go on with what they knew of objects that
 * are gone. */
CASE(effort__steps_go_by_it)
{
    struct prng random = {3};
    struct eng_question settings = ENG_QUESTION_DEFAULT;
    uint32_t large;
    settings.threads = 2;
    settings.tuning.still = ENG_STILL_ANEW;
    struct eng_scene *scene = kit_scene();
    struct eng_mesh *mesh = kit_soup(&random, 8);
    kit_add(scene, mesh, 1);
    struct eng_step_result result = kit_step(scene, &settings);
    assert_int_equal(result.threads, 1);
    mesh = kit_soup(&random, 20000);
    large = kit_add(scene, mesh, 2);
    for (int i = 0; i < 3; i++) {
        result = kit_step(scene, &settings);
        assert_int_equal(result.threads, 2);
    }
    settings.tuning.still = ENG_STILL_KEPT; /* nothing moves: there is nothing to share */
    result = kit_step(scene, &settings);
    assert_int_equal(result.threads, 1);
    settings.tuning.still = ENG_STILL_ANEW;
    assert_ok(eng_scene_remove(scene, large));
    result = kit_step(scene, &settings);
    assert_int_equal(result.threads, 1);
    eng_scene_free(scene);
}
