/* test_eng_brief.c - steps that are certain to end soon. */
#include "eng_kit.h"
#include "step.h"
#include "step_memory.h"
#include "wide_test.h"
#include "world.h"

#define ROUNDS    400u
#define TRIANGLES 8u
#define V         (3 * TRIANGLES)

static struct eng_question settings_of(enum pccd_mode mode, bool brief)
{
    struct eng_question settings = kit_contacts(mode, PCCD_METHOD_DEFAULT);
    settings.brief = brief;
    return settings;
}

/* A scene of one soup. */
static struct eng_scene *soup_new(struct prng *random, uint32_t triangles)
{
    struct eng_mesh *mesh = kit_soup(random, triangles);
    struct eng_scene *scene = kit_scene();
    kit_add(scene, mesh, 7);
    return scene;
}

static void move(struct eng_scene *scene, const double (*x)[3], uint32_t count)
{
    eng_stage_begin(scene);
    assert_ok(eng_stage_x1(scene, 0, PCCD_FORMAT_F64, 0, count, x));
}

static void check_same(const struct eng_step_result *a, const struct eng_step_result *b)
{
    assert_int_equal(a->incomplete, PCCD_COMPLETE);
    assert_int_equal(a->verdict, b->verdict);
    assert_int_equal(a->count, b->count);
    assert_int_equal(a->hash[0], b->hash[0]);
    assert_int_equal(a->hash[1], b->hash[1]);
    assert_true(a->count == 0 ||
                memcmp(a->records, b->records, a->count * a->record_bytes) == 0);
}

/* Choose where the triangles of a soup go: two by two to places apart, or, in a crowd,
 * all to one. */
static void choose_positions(struct prng *random, bool crowd, double (*x)[3])
{
    for (uint32_t i = 0; i < V; i++) {
        for (int k = 0; k < 3; k++) {
            x[i][k] = prng_between(random, 0, crowd ? 1 : 0.3);
        }
        x[i][0] += crowd ? 0 : i / 6;
    }
}

/* If it failed: an answer would depend on which thread was awake. */
CASE(brief__answers_are_those_of_other_steps)
{
    struct prng random = {20261122};
    struct prng same = random;
    struct eng_scene *brief = soup_new(&random, TRIANGLES);
    struct eng_scene *other = soup_new(&same, TRIANGLES);
    uint32_t done = 0;
    uint32_t given_up = 0;
    uint64_t contacts = 0;
    for (uint32_t i = 0; i < ROUNDS; i++) {
        double x[V][3];
        struct eng_step_result a;
        enum pccd_mode mode = (enum pccd_mode)(i / 4 % 3);
        choose_positions(&random, prng_u32(&random, 3) == 0, x);
        move(brief, (const double(*)[3])x, V);
        move(other, (const double(*)[3])x, V);
        struct eng_question settings = settings_of(mode, true);
        int status = eng_step(brief, &settings, &a);
        settings.brief = false;
        if (status == PCCD_E_AGAIN) {
            given_up++;
            status = eng_step(brief, &settings, &a);
        } else {
            done++;
            contacts += a.count;
            assert_int_equal(a.threads, 1);
            assert_int_equal(a.counters.exact, 0);
        }
        assert_ok(status);
        struct eng_step_result b = kit_step(other, &settings);
        check_same(&a, &b);
    }
    assert_true(done >= ROUNDS / 10 && given_up >= ROUNDS / 10 && contacts > 0);
    eng_scene_free(brief);
    eng_scene_free(other);
}

/* If it failed: a client could hold up all others, for 0.3 s with a query that needs
 * exact arithmetic, or with as many as there are pairs of triangles. */
CASE(brief__ends_before_more_tests_than_it_may_do)
{
    /* A corner on a face from beginning to end, along a slanted way. */
    static const double x[6][3] = {{0, 0, 0},          {1, 0, 0.25},
                                   {0, 1, 0.75},       {0.25, 0.25, 0.25},
                                   {0.25, 0.25, 1.25}, {0.75, 0.25, 1.25}};
    static const uint32_t faces[2][3] = {{0, 1, 2}, {3, 4, 5}};
    struct prng random = {20261122};
    struct eng_question settings = settings_of(PCCD_MODE_ALL, true);
    struct eng_step_result result;
    struct eng_scene *crowd = soup_new(&random, TRIANGLES);
    double at[V][3];
    struct eng_mesh *mesh = kit_mesh(x, 6, faces, 2);
    struct eng_scene *touch = kit_scene();
    kit_add(touch, mesh, 1);
    assert_int_equal(eng_step(touch, &settings, &result), PCCD_E_AGAIN);
    assert_int_equal(eng_step_memory_of(touch)->workers[0]->exact.queries, 0);
    assert_true(eng_step_memory_of(touch)->workers[0]->tally.survivors > 0);
    choose_positions(&random, true, at);
    move(crowd, (const double(*)[3])at, V);
    assert_int_equal(eng_step(crowd, &settings, &result), PCCD_E_AGAIN);
    assert_int_equal(eng_step_memory_of(crowd)->workers[0]->exact.queries, 0);
    assert_true(eng_step_memory_of(crowd)->workers[0]->record.tests <= ENG_BRIEF_TESTS);
    settings.brief = false;
    result = kit_step(touch, &settings);
    assert_int_equal(result.count, 1);
    assert_true(result.counters.exact > 0);
    result = kit_step(crowd, &settings);
    assert_true(result.counters.candidates[PCCD_VF] +
                    result.counters.candidates[PCCD_EE] >
                ENG_BRIEF_TESTS);
    eng_scene_free(touch);
    eng_scene_free(crowd);
}

/* If it failed: what a step has given up would be moved twice, or meet nothing. */
CASE(brief__given_up_has_moved_once)
{
    struct prng random = {20261122};
    struct eng_question settings = settings_of(PCCD_MODE_ALL, true);
    struct eng_step_result result;
    struct eng_scene *scene = soup_new(&random, TRIANGLES);
    settings.tuning.still = ENG_STILL_ANEW; /* what stands is brief */
    double before[V][3];
    double x[V][3];
    memcpy(before, eng_scene_positions(scene, 0, 1), sizeof before);
    choose_positions(&random, true, x);
    move(scene, (const double(*)[3])x, V);
    assert_int_equal(eng_step(scene, &settings, &result), PCCD_E_AGAIN);
    assert_memory_equal(eng_scene_positions(scene, 0, 1), x, sizeof x);
    settings.brief = false;
    result = kit_step(scene, &settings);
    uint64_t count = result.count;
    assert_true(count > 0);
    assert_memory_equal(eng_scene_positions(scene, 0, 0), before, sizeof before);
    assert_memory_equal(eng_scene_positions(scene, 0, 1), x, sizeof x);
    /* The one after it stands still; and one that is staged is not the one given up. */
    result = kit_step(scene, &settings);
    assert_memory_equal(eng_scene_positions(scene, 0, 0), x, sizeof x);
    settings.brief = true;
    assert_int_equal(eng_step(scene, &settings, &result), PCCD_E_AGAIN);
    move(scene, (const double(*)[3])before, V);
    settings.brief = false;
    result = kit_step(scene, &settings);
    assert_int_equal(result.count, count);
    assert_memory_equal(eng_scene_positions(scene, 0, 0), x, sizeof x);
    assert_memory_equal(eng_scene_positions(scene, 0, 1), before, sizeof before);
    eng_scene_free(scene);
}

static bool can(const struct eng_scene *scene)
{
    struct eng_question settings = settings_of(PCCD_MODE_ALL, false);
    return eng_step_can_be_brief(scene, &settings, true);
}

/* Return whether a step that writes nothing can be brief in this mode. */
static bool can_rest(const struct eng_scene *scene, enum pccd_mode mode)
{
    struct eng_question settings = settings_of(mode, false);
    return eng_step_can_be_brief(scene, &settings, false);
}

/* Run two steps of it. */
static void warm(struct eng_scene *scene)
{
    struct eng_question settings = settings_of(PCCD_MODE_ALL, false);
    for (int i = 0; i < 2; i++) {
        kit_step(scene, &settings);
    }
    /* Whatever else the machine did meanwhile. */
    eng_step_memory_of(scene)->effort[PCCD_METHOD_WIDE].work_ns[PCCD_MODE_ALL] = 1000;
}

/* If it failed: the loop would build hierarchies, or make boxes of thousands. */
CASE(brief__only_small_scenes_that_are_warm_can_be)
{
    struct prng random = {20261122};
    struct eng_question settings = settings_of(PCCD_MODE_ALL, false);
    struct eng_step_result result;
    struct eng_scene *scene = soup_new(&random, TRIANGLES);
    struct eng_scene *large = soup_new(&random, 65);
    uint32_t idx;
    assert_false(can(scene)); /* its trees are not there */
    warm(scene);
    warm(large);
    assert_true(can(scene));
    assert_false(can(large));
    eng_step_memory_of(scene)->effort[PCCD_METHOD_WIDE].work_ns[PCCD_MODE_ALL] = 1000000;
    assert_false(can(scene));
    warm(scene);
    settings.mode = PCCD_MODE_FIRST; /* nothing is known of it */
    assert_false(eng_step_can_be_brief(scene, &settings, true));
    settings = settings_of(PCCD_MODE_PAIRS, true);
    assert_int_equal(eng_step(scene, &settings, &result), PCCD_E_INVAL);
    settings = settings_of(PCCD_MODE_ALL, true);
    settings.method = PCCD_METHOD_PAPER;
    assert_false(eng_step_can_be_brief(scene, &settings, true));
    assert_int_equal(eng_step(scene, &settings, &result), PCCD_E_INVAL);
    struct eng_mesh *mesh = kit_sheet(1, 9);
    assert_ok(eng_scene_add(scene, mesh, 8, &idx));
    assert_false(can(scene)); /* its trees are to be put together */
    warm(scene);
    assert_true(can(scene));
    for (uint32_t id = 9; id < 80; id++) {
        assert_ok(eng_scene_add(scene, mesh, id, &idx));
    }
    for (uint32_t i = 1; i <= idx; i++) {
        assert_ok(eng_scene_remove(scene, i));
    }
    warm(scene);
    assert_false(can(scene)); /* the places of 72 objects are looked at */
    eng_mesh_release(mesh);
    eng_scene_free(scene);
    eng_scene_free(large);
}

/* If it failed: some later step would free what a team has left, a millisecond of it. */
CASE(brief__scenes_that_had_a_team_cannot_be)
{
    struct prng random = {20261122};
    struct eng_question settings = settings_of(PCCD_MODE_ALL, false);
    struct eng_scene *scene = soup_new(&random, TRIANGLES);
    warm(scene);
    assert_true(can(scene));
    settings.threads = 2;
    settings.team_always = true;
    struct eng_step_result result = kit_step(scene, &settings);
    assert_int_equal(result.threads, 2);
    warm(scene);
    assert_false(can(scene));
    settings.brief = true;
    int status = eng_step(scene, &settings, &result);
    assert_true(status == PCCD_E_AGAIN || (status == PCCD_OK && result.threads == 1));
    eng_scene_free(scene);
}

/* ---- for one client ---- */

/* If it failed: a client that is alone would wait for threads to wake; or others would
 * for its step, or it would wait for as much as is not brief. */
CASE(brief__of_one_who_is_alone_may_be_larger)
{
    struct prng random = {20261129};
    struct eng_question settings = settings_of(PCCD_MODE_ALL, true);
    struct eng_step_result result;
    struct eng_scene *scene = soup_new(&random, 1000);
    struct eng_scene *large = soup_new(&random, 3000);
    static double x[3000][3];
    uint64_t *work_ns;
    warm(scene);
    warm(large);
    work_ns = &eng_step_memory_of(scene)->effort[PCCD_METHOD_WIDE].work_ns[0];
    *work_ns = 200000;
    assert_false(can(scene));
    settings.alone = true;
    assert_true(eng_step_can_be_brief(scene, &settings, true));
    assert_false(eng_step_can_be_brief(large, &settings, true));
    *work_ns = 1000000;
    assert_false(eng_step_can_be_brief(scene, &settings, true));
    *work_ns = 200000;
    for (uint32_t i = 0; i < 3000; i++) {
        for (int k = 0; k < 3; k++) {
            x[i][k] = prng_between(&random, 0, 1);
        }
    }
    move(scene, (const double(*)[3])x, 3000);
    assert_int_equal(eng_step(scene, &settings, &result), PCCD_E_AGAIN); /* a crowd */
    assert_true(eng_step_memory_of(scene)->workers[0]->record.tests <=
                ENG_BRIEF_TESTS_ALONE);
    for (uint32_t i = 0; i < 40; i++) { /* what was for nothing is not tried at once */
        *work_ns = 200000;
        assert_int_equal(eng_step_can_be_brief(scene, &settings, true), i >= 32);
        settings.brief = false;
        kit_step(scene, &settings);
        settings.brief = true;
    }
    eng_scene_free(scene);
    eng_scene_free(large);
}

/* ---- at rest ----------------------------------------------------------------------- */

#define LARGE 2000u /* triangles */

/* Steps that write nothing, until nothing has moved in one. */
static void settle(struct eng_scene *scene, enum pccd_mode mode)
{
    struct eng_question settings = settings_of(mode, false);
    for (int i = 0; i < 3; i++) {
        kit_step(scene, &settings);
    }
}

/* Everything moves, and the step is computed. */
static void stir(struct eng_scene *scene, struct prng *random)
{
    static double x[3 * LARGE][3];
    struct eng_question settings = settings_of(PCCD_MODE_ALL, false);
    uint32_t count = eng_scene_vertex_count(scene, 0);
    assert_true(count <= 3 * LARGE);
    for (uint32_t i = 0; i < count; i++) { /* two by two to places apart */
        for (int k = 0; k < 3; k++) {
            x[i][k] = prng_between(random, 0, 0.3);
        }
        x[i][0] += i / 6;
    }
    move(scene, (const double(*)[3])x, count);
    kit_step(scene, &settings);
}

/* If it failed: who asks for a large scene at rest would wait for threads to wake, or be
 * told something else than by these. */
CASE(brief__what_is_at_rest_can_be_however_large_it_is)
{
    struct prng random = {20261125};
    struct eng_scene *scene = soup_new(&random, LARGE);
    for (int mode = 0; mode < PCCD_MODE_PAIRS; mode++) {
        struct eng_question settings = settings_of((enum pccd_mode)mode, false);
        stir(scene, &random);
        assert_false(can_rest(scene, settings.mode));
        settle(scene, settings.mode);
        assert_true(can_rest(scene, settings.mode));
        assert_false(can(scene)); /* if something is staged */
        settings.brief = true;
        struct eng_step_result result = kit_step(scene, &settings);
        assert_true(can_rest(scene, settings.mode)); /* and again */
        assert_int_equal(result.threads, 1);
        assert_int_equal(result.counters.box_tests, 0);
        settings.brief = false;
        settings.tuning.still = ENG_STILL_ANEW;
        uint64_t count = result.count;
        uint64_t hash = result.hash[0];
        struct eng_step_result anew = kit_step(scene, &settings);
        assert_true(anew.count == count && anew.hash[0] == hash);
        assert_int_equal(anew.verdict, result.verdict);
    }
    eng_scene_free(scene);
}

/* If it failed: the loop would make boxes of all features, search all pairs, go through
 * any number of records, or free what a team has left. */
CASE(brief__what_is_not_at_rest_cannot_be)
{
    struct prng random = {20261125};
    struct eng_question settings = settings_of(PCCD_MODE_ALL, false);
    struct eng_scene *scene = soup_new(&random, LARGE);
    const struct eng_step_memory *memory = eng_step_memory_of(scene);
    double x[1][3] = {{0.5, 0.5, 0.5}};
    stir(scene, &random);
    kit_step(scene, &settings);
    assert_false(can_rest(scene, PCCD_MODE_ALL)); /* it moved in the step before */
    settle(scene, PCCD_MODE_ALL);
    assert_true(can_rest(scene, PCCD_MODE_ALL));
    assert_false(can_rest(scene, PCCD_MODE_FIRST));
    assert_false(can_rest(scene, PCCD_MODE_PAIRS));
    move(scene, (const double(*)[3])x, 1);
    eng_stage_abort(scene); /* where the last step began is to be copied */
    assert_false(can_rest(scene, PCCD_MODE_ALL));
    settle(scene, PCCD_MODE_ALL);
    struct eng_object_filter filter = ENG_OBJECT_FILTER_DEFAULT;
    filter.self = false;
    assert_ok(eng_scene_set_filter(scene, 0, &filter));
    assert_false(can_rest(scene, PCCD_MODE_ALL));
    settle(scene, PCCD_MODE_ALL);
    assert_true(can_rest(scene, PCCD_MODE_ALL));
    uint32_t idx;
    struct eng_mesh *mesh = kit_sheet(1, 9);
    assert_ok(eng_scene_add(scene, mesh, 8, &idx));
    assert_false(can_rest(scene, PCCD_MODE_ALL));
    settle(scene, PCCD_MODE_ALL);
    assert_true(can_rest(scene, PCCD_MODE_ALL));
    /* A step by two leaves a worker; a round of steps by one thread later it is freed. */
    settings.threads = 2;
    settings.team_always = true;
    settings.tuning.still = ENG_STILL_ANEW;
    kit_step(scene, &settings);
    assert_int_equal(memory->worker_count, 2);
    uint32_t freed = 0;
    for (int i = 0; i < 1000 && memory->worker_count == 2; i++) {
        settings = settings_of(PCCD_MODE_ALL, can_rest(scene, PCCD_MODE_ALL));
        kit_step(scene, &settings);
        freed += memory->worker_count == 1 && !settings.brief;
    }
    assert_int_equal(freed, 1);
    eng_mesh_release(mesh);
    eng_scene_free(scene);
}

/* If it failed: a step that was taken for a brief one would make the boxes of a large
 * scene, and search it until it has tested as much as it may. */
CASE(brief__large_scenes_give_up_before_they_search)
{
    struct prng random = {20261125};
    struct eng_question settings = settings_of(PCCD_MODE_ALL, true);
    struct eng_step_result result;
    struct eng_scene *scene = soup_new(&random, LARGE);
    double x[1][3] = {{0.5, 0.5, 0.5}};
    stir(scene, &random);
    settle(scene, PCCD_MODE_ALL);
    move(scene, (const double(*)[3])x, 1);
    assert_int_equal(eng_step(scene, &settings, &result), PCCD_E_AGAIN);
    assert_int_equal(eng_step_memory_of(scene)->workers[0]->record.box_tests, 0);
    settings.brief = false;
    result = kit_step(scene, &settings);
    assert_true(result.counters.box_tests > 0);
    eng_scene_free(scene);
}
