/* test_eng_team.c - the same step by any number of threads. */
#include "eng_crew.h"
#include "memory.h"
#include "paper_work.h"
#include "record_hash.h"
#include "trees.h"
#include "worker.h"

/* If it failed: the answer would depend on the machine or on the day. */
CASE_WITH(team__same_records_for_any_number_of_threads, crew_setup, crew_teardown)
{
    struct crew *crew = *state;
    for (int mode = PCCD_MODE_ALL; mode < PCCD_MODE_COUNT; mode++) {
        struct eng_step_result alone = crew_run(crew, crew_alone((enum pccd_mode)mode));
        assert_int_equal(alone.threads, 1);
        assert_int_equal(alone.incomplete, PCCD_COMPLETE);
        assert_true(mode == PCCD_MODE_ANY || alone.count > 0);
        size_t bytes = alone.count * alone.record_bytes;
        void *records = test_copy(alone.records, bytes);
        for (size_t i = 0; i < crew_count(); i++) {
            for (int round = 0; round < 3; round++) {
                struct eng_step_result team =
                    crew_run(crew, crew_team((enum pccd_mode)mode, i));
                assert_true(team.threads > 1);
                assert_int_equal(team.incomplete, PCCD_COMPLETE);
                assert_int_equal(team.verdict, alone.verdict);
                assert_int_equal(team.count, alone.count);
                assert_int_equal(team.hash[0], alone.hash[0]);
                assert_int_equal(team.hash[1], alone.hash[1]);
                assert_true(bytes == 0 || memcmp(team.records, records, bytes) == 0);
            }
        }
        free(records);
    }
}

/* If it failed: a pair of boxes would be tested twice or not at all by some team, and
 * only luck would keep the answer. */
CASE_WITH(team__same_work_for_any_number_of_threads, crew_setup, crew_teardown)
{
    struct crew *crew = *state;
    struct eng_step_result alone = crew_run(crew, crew_alone(PCCD_MODE_ALL));
    for (size_t i = 0; i < crew_count(); i++) {
        struct eng_step_result team = crew_run(crew, crew_team(PCCD_MODE_ALL, i));
        assert_int_equal(team.counters.task_units, alone.counters.task_units);
        assert_int_equal(team.counters.box_tests, alone.counters.box_tests);
        assert_int_equal(team.counters.leaf_pairs, alone.counters.leaf_pairs);
        assert_int_equal(team.counters.candidates[PCCD_VF],
                         alone.counters.candidates[PCCD_VF]);
        assert_int_equal(team.counters.candidates[PCCD_EE],
                         alone.counters.candidates[PCCD_EE]);
        assert_int_equal(team.counters.survivors, alone.counters.survivors);
    }
}

/* If it failed: a node's box would be refit before its children's by some team. */
CASE_WITH(team__refit_gives_the_same_boxes, crew_setup, crew_teardown)
{
    struct crew *crew = *state;
    size_t bytes = eng_trees_of(crew->scene)->node_ranges.end *
                   sizeof *eng_trees_of(crew->scene)->nodes;
    crew->scene->settings.rebuild_ratio = 1e-9; /* nothing is as poor: the same nodes */
    crew_run(crew, crew_alone(PCCD_MODE_ANY));
    void *nodes = test_copy(eng_trees_of(crew->scene)->nodes, bytes);
    for (size_t i = 0; i < crew_count(); i++) {
        memset(eng_trees_of(crew->scene)->nodes[eng_trees_of(crew->scene)->root].lo0,
               0xff, 12); /* must be written again */
        crew_run(crew, crew_team(PCCD_MODE_ANY, i));
        assert_memory_equal(eng_trees_of(crew->scene)->nodes, nodes, bytes);
    }
    free(nodes);
}

/* If it failed: every step of a team would go to the system for memory. */
CASE_WITH(team__warm_steps_allocate_nothing, crew_setup, crew_teardown)
{
    struct crew *crew = *state;
    for (size_t i = 0; i < crew_count(); i++) {
        crew_run(crew, crew_team(PCCD_MODE_ALL, i));
        for (int round = 0; round < 5; round++) {
            struct eng_step_result team = crew_run(crew, crew_team(PCCD_MODE_ALL, i));
            assert_int_equal(team.counters.allocs, 0);
            assert_int_equal(team.counters.builds, 0);
        }
    }
}

/* Some more than two rounds in which a step's memory counts (step_memory.c). */
#define MANY_STEPS 600

/* If it failed: beside other processes, where small scenes are now and then taken for
 * large ones, every scene of a daemon would come to hold the memory of a whole team. Or
 * those that want one now and then would make it anew each time. */
CASE_WITH(team__workers_go_when_no_step_wants_them, crew_setup, crew_teardown)
{
    struct crew *crew = *state;
    struct eng_scene *scene = crew->scene;
    struct eng_question alone = crew_alone(PCCD_MODE_ANY);
    struct eng_question team = crew_team(PCCD_MODE_ANY, 0);
    struct eng_step_result result = crew_run(crew, team);
    uint64_t before = eng_alloc_bytes();
    team.team_always = true;
    for (int i = 0; i < MANY_STEPS; i++) {
        result = kit_step(scene, i % 100 == 99 ? &team : &alone);
        assert_int_equal(result.counters.allocs, 0);
    }
    assert_int_equal(eng_alloc_bytes(), before);
    for (int i = 0; i < MANY_STEPS; i++) {
        result = kit_step(scene, &alone);
    }
    size_t one =
        sizeof(struct eng_worker) + sizeof(struct eng_paper_work) + eng_exact_bytes();
    assert_in_range(before - eng_alloc_bytes(), one, 2 * one);
    assert_int_equal(crew_run(crew, team).threads, team.threads);
    assert_int_equal(eng_alloc_bytes(), before);
}

/* If it failed: a cancelled step would go on in the threads that did not see it, or hang.
 * Or boxes would be searched that the refit, which stops too, has not made. */
CASE_WITH(team__early_ends_end_every_thread, crew_setup, crew_teardown)
{
    struct crew *crew = *state;
    for (size_t i = 0; i < 2 * crew_count(); i++) {
        atomic_bool cancel = true;
        struct eng_question settings = crew_team(PCCD_MODE_ALL, i / 2);
        settings.method = i % 2 ? PCCD_METHOD_WIDE : PCCD_METHOD_PAPER;
        settings.cancel = &cancel;
        struct eng_step_result result = crew_run(crew, settings);
        assert_int_equal(result.incomplete, PCCD_INCOMPLETE_CANCELLED);
        assert_true(i % 2 == 0 || result.counters.box_tests == 0);
        settings.cancel = NULL;
        settings.deadline_ns = 1;
        assert_int_equal(crew_run(crew, settings).incomplete, PCCD_INCOMPLETE_DEADLINE);
    }
}

/* If it failed: which records a cut answer holds would depend on who found them. */
CASE_WITH(team__cut_answers_hold_the_first_records, crew_setup, crew_teardown)
{
    struct crew *crew = *state;
    for (int k = 0; k < 6; k++) {
        enum pccd_mode mode = k % 2 ? PCCD_MODE_PAIRS : PCCD_MODE_ALL;
        struct eng_step_result whole = crew_run(crew, crew_alone(mode));
        const uint64_t limits[] = {3, whole.count / 20, whole.count - 1};
        uint64_t limit = limits[k / 2];
        uint64_t hash[2];
        record_hash_2(whole.records, limit, whole.record_bytes, hash);
        for (size_t i = 0; i < crew_count(); i++) {
            struct eng_question settings = crew_team(mode, i);
            settings.contact_max = limit;
            struct eng_step_result cut = crew_run(crew, settings);
            assert_int_equal(cut.incomplete, PCCD_INCOMPLETE_CONTACT_LIMIT);
            assert_int_equal(cut.count, limit);
            assert_int_equal(cut.counts[PCCD_VF] + cut.counts[PCCD_EE], limit);
            assert_int_equal(cut.hash[0], hash[0]);
            assert_int_equal(cut.hash[1], hash[1]);
        }
    }
}

/* Small triangles fall on large ones: every third one lies flat and lands at the same
 * time, before all corners of the others. */
#define PAIRS 600u

static void fill_pairs(double (*x0)[3], double (*x1)[3], uint32_t (*triangles)[3])
{
    const double corners[3][2] = {{0, 0}, {1, 0}, {0, 1}};
    struct prng random = {98};
    for (uint32_t v = 0; v < 6 * PAIRS; v++) {
        uint32_t pair = v / 6;
        bool falls = v % 6 >= 3;
        double first = pair % 3 == 0 ? 0.25 : prng_between(&random, 0.3, 0.875);
        x0[v][0] =
            3 * (pair % 30) + (falls ? 0.125 : 0) + corners[v % 3][0] * (falls ? 0.5 : 1);
        x0[v][1] =
            3 * (pair / 30) + (falls ? 0.125 : 0) + corners[v % 3][1] * (falls ? 0.5 : 1);
        x0[v][2] = falls ? first : 0;
        memcpy(x1[v], x0[v], sizeof x1[v]);
        x1[v][2] = falls ? first - 1 : 0;
        triangles[v / 3][v % 3] = v;
    }
}

/* If it failed: which contacts mode first gives would depend on how soon the earliest was
 * met, so on the number of threads. */
CASE_WITH(team__first_is_what_all_says_it_is, crew_setup, crew_teardown)
{
    static double x0[6 * PAIRS][3];
    static double x1[6 * PAIRS][3];
    static uint32_t triangles[2 * PAIRS][3];
    struct crew *crew = *state;
    uint32_t pairs;
    fill_pairs(x0, x1, triangles);
    struct eng_mesh *mesh = kit_mesh(x0, 6 * PAIRS, triangles, 2 * PAIRS);
    assert_ok(eng_scene_remove(crew->scene, crew->soup));
    pairs = kit_add(crew->scene, mesh, 3);
    uint64_t expected = 0;
    for (int threads = 0; threads < 5; threads++) {
        struct eng_question settings =
            crew_alone(threads == 0 ? PCCD_MODE_ALL : PCCD_MODE_FIRST);
        settings.threads = threads == 0 ? 1 : (uint32_t)threads;
        settings.team_always = true;
        eng_stage_begin(crew->scene);
        assert_ok(
            eng_stage_x0x1(crew->scene, pairs, PCCD_FORMAT_F64, 0, 6 * PAIRS, x0, x1));
        struct eng_step_result result = kit_step(crew->scene, &settings);
        const struct pccd_contact *contacts = result.records;
        double bound = 2;
        for (uint64_t i = 0; i < result.count; i++) {
            bound = contacts[i].toi_hi < bound ? contacts[i].toi_hi : bound;
        }
        uint64_t early = 0;
        for (uint64_t i = 0; i < result.count; i++) {
            early += contacts[i].toi <= bound;
        }
        expected = threads == 0 ? early : expected;
        assert_true(bound < 0.26 && expected > PAIRS / 4 && expected < PAIRS * 2);
        assert_int_equal(early, expected);
    }
}

/* If it failed: a team larger than its scene would hang, or lose the few pairs. */
CASE_WITH(team__larger_than_its_scene, crew_setup, crew_teardown)
{
    struct crew *crew = *state;
    struct prng random = {7};
    assert_ok(eng_scene_remove(crew->scene, crew->soup));
    assert_ok(eng_scene_remove(crew->scene, crew->sheet));
    for (uint32_t triangles = 1; triangles <= 5; triangles++) {
        kit_add(crew->scene, kit_soup(&random, triangles), triangles);
        struct eng_question settings = crew_alone(PCCD_MODE_ALL);
        struct eng_step_result alone = kit_step(crew->scene, &settings);
        for (size_t i = 0; i < crew_count(); i++) {
            settings = crew_team(PCCD_MODE_ALL, i);
            settings.team_always = true;
            struct eng_step_result team = kit_step(crew->scene, &settings);
            assert_int_equal(team.threads, settings.threads);
            assert_int_equal(team.counters.task_units, alone.counters.task_units);
            assert_int_equal(team.counters.box_tests, alone.counters.box_tests);
            assert_int_equal(team.hash[0], alone.hash[0]);
            assert_int_equal(team.hash[1], alone.hash[1]);
        }
    }
}
