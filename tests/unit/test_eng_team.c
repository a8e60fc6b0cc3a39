/* tests/unit/test_eng_team.c - the same step by any number of threads.
 *
 * Room:     engine (step.h, world.h).
 * Does:     records, hash, counts and boxes compared between one thread and several, for
 *           every mode; warm teams allocate nothing; early ends end all threads.
 * Threads:  up to sixteen, whatever the machine has.
 * Source:   daemon/engine/step.h, schedule.h, refit.h.
 */
#include "eng_kit.h"

#include <stdlib.h>
#include <string.h>

#include "build.h"
#include "step.h"
#include "world.h"

/* Large enough that a step does not stay on one thread. */
#define SHEET_SIDE     30u
#define SOUP_TRIANGLES 1500u
#define SOUP_VERTICES  (3 * SOUP_TRIANGLES)

/* Every team by every scheduler. */
static const struct {
    uint32_t threads;
    enum eng_scheduler scheduler;
} teams[] = {
    {2, ENG_SCHEDULER_STEAL},  {3, ENG_SCHEDULER_STEAL},  {4, ENG_SCHEDULER_STEAL},
    {8, ENG_SCHEDULER_STEAL},  {16, ENG_SCHEDULER_STEAL}, {2, ENG_SCHEDULER_PAPER},
    {3, ENG_SCHEDULER_PAPER},  {4, ENG_SCHEDULER_PAPER},  {8, ENG_SCHEDULER_PAPER},
    {16, ENG_SCHEDULER_PAPER},
};
#define TEAM_COUNT (sizeof teams / sizeof *teams)

struct fixture {
    struct eng_scene *scene;
    uint32_t soup;
    double x0[SOUP_VERTICES][3];
    double x1[SOUP_VERTICES][3];
};

static int setup(void **state)
{
    struct fixture *f = malloc(sizeof *f);
    struct kit_random random = {97};
    uint32_t sheet;
    assert_non_null(f);
    assert_int_equal(eng_scene_new(NULL, &f->scene), ENG_OK);
    struct eng_mesh *mesh = kit_sheet(SHEET_SIDE, 0.5);
    assert_int_equal(eng_scene_add(f->scene, mesh, 2, &sheet), ENG_OK);
    eng_mesh_release(mesh);
    mesh = kit_soup(&random, SOUP_TRIANGLES);
    assert_int_equal(eng_scene_add(f->scene, mesh, 1, &f->soup), ENG_OK);
    eng_mesh_release(mesh);
    const struct eng_object *object = eng_scene_object(f->scene, f->soup);
    for (uint32_t i = 0; i < SOUP_VERTICES; i++) {
        for (int k = 0; k < 3; k++) {
            double x = f->scene->x[f->scene->now][object->vertices.first + i][k];
            f->x0[i][k] = x;
            f->x1[i][k] = x + kit_between(&random, -0.05, 0.05);
        }
    }
    *state = f;
    return 0;
}

static int teardown(void **state)
{
    struct fixture *f = *state;
    eng_scene_free(f->scene);
    free(f);
    return 0;
}

static struct eng_step_result run(struct fixture *f, struct eng_step_settings settings)
{
    struct eng_step_result result;
    eng_stage_begin(f->scene);
    assert_int_equal(
        eng_stage_x0x1(f->scene, f->soup, ENG_F64, 0, SOUP_VERTICES, f->x0, f->x1),
        ENG_OK);
    assert_int_equal(eng_step(f->scene, &settings, &result), ENG_OK);
    assert_true(eng_tree_validate(f->scene));
    return result;
}

static struct eng_step_settings alone_in(enum eng_mode mode)
{
    struct eng_step_settings settings = ENG_STEP_SETTINGS_DEFAULT;
    settings.mode = mode;
    return settings;
}

static struct eng_step_settings team_in(enum eng_mode mode, size_t team)
{
    struct eng_step_settings settings = alone_in(mode);
    settings.threads = teams[team].threads;
    settings.scheduler = teams[team].scheduler;
    return settings;
}

/* If it failed: the answer would depend on the machine or on the day. */
static void team__same_records_for_any_number_of_threads(void **state)
{
    struct fixture *f = *state;
    for (int mode = ENG_MODE_ALL; mode <= ENG_MODE_PAIRS; mode++) {
        struct eng_step_result alone = run(f, alone_in((enum eng_mode)mode));
        assert_int_equal(alone.threads, 1);
        assert_int_equal(alone.incomplete, ENG_COMPLETE);
        assert_true(mode == ENG_MODE_ANY || alone.count > 0);
        size_t bytes = alone.count * alone.record_bytes;
        void *records = malloc(bytes + 1);
        assert_non_null(records);
        if (bytes > 0) {
            memcpy(records, alone.records, bytes);
        }
        for (size_t i = 0; i < TEAM_COUNT; i++) {
            for (int round = 0; round < 3; round++) {
                struct eng_step_result team = run(f, team_in((enum eng_mode)mode, i));
                assert_true(team.threads > 1);
                assert_int_equal(team.incomplete, ENG_COMPLETE);
                assert_int_equal(team.verdict, alone.verdict);
                assert_int_equal(team.count, alone.count);
                assert_int_equal(team.hash_hi, alone.hash_hi);
                assert_int_equal(team.hash_lo, alone.hash_lo);
                assert_true(bytes == 0 || memcmp(team.records, records, bytes) == 0);
            }
        }
        free(records);
    }
}

/* If it failed: a pair of boxes would be tested twice or not at all by some team, and
 * only luck would keep the answer. */
static void team__same_work_for_any_number_of_threads(void **state)
{
    struct fixture *f = *state;
    struct eng_step_result alone = run(f, alone_in(ENG_MODE_ALL));
    for (size_t i = 0; i < TEAM_COUNT; i++) {
        struct eng_step_result team = run(f, team_in(ENG_MODE_ALL, i));
        assert_int_equal(team.counters.task_units, alone.counters.task_units);
        assert_int_equal(team.counters.box_tests, alone.counters.box_tests);
        assert_int_equal(team.counters.leaf_pairs, alone.counters.leaf_pairs);
        assert_int_equal(team.counters.candidates_vf, alone.counters.candidates_vf);
        assert_int_equal(team.counters.candidates_ee, alone.counters.candidates_ee);
        assert_int_equal(team.counters.survivors, alone.counters.survivors);
    }
}

/* If it failed: a node's box would be refit before its children's by some team. */
static void team__refit_gives_the_same_boxes(void **state)
{
    struct fixture *f = *state;
    size_t bytes = f->scene->node_ranges.end * sizeof *f->scene->nodes;
    run(f, alone_in(ENG_MODE_ANY));
    void *nodes = malloc(bytes);
    assert_non_null(nodes);
    memcpy(nodes, f->scene->nodes, bytes);
    for (size_t i = 0; i < TEAM_COUNT; i++) {
        memset(f->scene->nodes[f->scene->root].lo0, 0xff, 12); /* must be written again */
        run(f, team_in(ENG_MODE_ANY, i));
        assert_memory_equal(f->scene->nodes, nodes, bytes);
    }
    free(nodes);
}

/* If it failed: every step of a team would go to the system for memory. */
static void team__warm_steps_allocate_nothing(void **state)
{
    struct fixture *f = *state;
    for (size_t i = 0; i < TEAM_COUNT; i++) {
        run(f, team_in(ENG_MODE_ALL, i));
        for (int round = 0; round < 5; round++) {
            struct eng_step_result team = run(f, team_in(ENG_MODE_ALL, i));
            assert_int_equal(team.counters.allocs, 0);
            assert_int_equal(team.counters.builds, 0);
        }
    }
}

/* If it failed: a cancelled step would go on in the threads that did not see it, or hang.
 * */
static void team__early_ends_end_every_thread(void **state)
{
    struct fixture *f = *state;
    for (size_t i = 0; i < TEAM_COUNT; i++) {
        atomic_bool cancel = true;
        struct eng_step_settings settings = team_in(ENG_MODE_ALL, i);
        settings.cancel = &cancel;
        assert_int_equal(run(f, settings).incomplete, ENG_INCOMPLETE_CANCELLED);
        settings = team_in(ENG_MODE_ALL, i);
        settings.deadline_ns = 1;
        assert_int_equal(run(f, settings).incomplete, ENG_INCOMPLETE_DEADLINE);
        settings = team_in(ENG_MODE_ALL, i);
        settings.contact_max = 3;
        struct eng_step_result cut = run(f, settings);
        assert_int_equal(cut.incomplete, ENG_INCOMPLETE_CONTACT_LIMIT);
        assert_int_equal(cut.count, 3);
    }
}

/* Small triangles fall on large ones. Every other pair is fast, and its time is bracketed
 * closely; the slow ones meet later, but with a wide tolerance may have begun at once. */
#define PAIRS 600u

static void fill_pairs(double (*x0)[3], double (*x1)[3], uint32_t (*triangles)[3])
{
    const double corners[3][2] = {{0, 0}, {1, 0}, {0, 1}};
    struct kit_random random = {98};
    for (uint32_t v = 0; v < 6 * PAIRS; v++) {
        uint32_t pair = v / 6;
        bool falls = v % 6 >= 3;
        double height = pair % 2 ? 0x1p-10 : 1;
        double first = kit_between(&random, 0.25, 0.875);
        x0[v][0] =
            3 * (pair % 30) + (falls ? 0.125 : 0) + corners[v % 3][0] * (falls ? 0.5 : 1);
        x0[v][1] =
            3 * (pair / 30) + (falls ? 0.125 : 0) + corners[v % 3][1] * (falls ? 0.5 : 1);
        x0[v][2] = falls ? height * first : 0;
        memcpy(x1[v], x0[v], sizeof x1[v]);
        x1[v][2] = falls ? height * (first - 1) : 0;
        triangles[v / 3][v % 3] = v;
    }
}

/* If it failed: which contacts mode first gives would depend on how soon the earliest was
 * met, so on the number of threads. */
static void team__first_is_what_all_says_it_is(void **state)
{
    static double x0[6 * PAIRS][3];
    static double x1[6 * PAIRS][3];
    static uint32_t triangles[2 * PAIRS][3];
    struct fixture *f = *state;
    uint32_t pairs;
    fill_pairs(x0, x1, triangles);
    struct eng_mesh *mesh = kit_mesh((const double(*)[3])x0, 6 * PAIRS,
                                     (const uint32_t(*)[3])triangles, 2 * PAIRS);
    assert_int_equal(eng_scene_remove(f->scene, f->soup), ENG_OK);
    assert_int_equal(eng_scene_add(f->scene, mesh, 3, &pairs), ENG_OK);
    eng_mesh_release(mesh);
    uint64_t expected = 0;
    for (int threads = 0; threads < 5; threads++) {
        struct eng_step_settings settings =
            alone_in(threads == 0 ? ENG_MODE_ALL : ENG_MODE_FIRST);
        struct eng_step_result result;
        settings.threads = threads == 0 ? 1 : (uint32_t)threads;
        settings.tolerance = 1;
        eng_stage_begin(f->scene);
        assert_int_equal(eng_stage_x0x1(f->scene, pairs, ENG_F64, 0, 6 * PAIRS, x0, x1),
                         ENG_OK);
        assert_int_equal(eng_step(f->scene, &settings, &result), ENG_OK);
        const struct eng_contact *contacts = result.records;
        double bound = 2;
        for (uint64_t i = 0; i < result.count; i++) {
            bound = contacts[i].toi_hi < bound ? contacts[i].toi_hi : bound;
        }
        uint64_t early = 0;
        for (uint64_t i = 0; i < result.count; i++) {
            early += contacts[i].toi <= bound;
        }
        expected = threads == 0 ? early : expected;
        assert_true(bound < 0.5 && expected > PAIRS / 4);
        assert_int_equal(early, expected);
    }
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, setup, teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(team__same_records_for_any_number_of_threads),
        TEST(team__first_is_what_all_says_it_is),
        TEST(team__same_work_for_any_number_of_threads),
        TEST(team__refit_gives_the_same_boxes),
        TEST(team__warm_steps_allocate_nothing),
        TEST(team__early_ends_end_every_thread),
    };
    return cmocka_run_group_tests_name("eng_team", tests, NULL, NULL);
}
