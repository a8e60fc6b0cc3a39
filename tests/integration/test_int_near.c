/* test_int_near.c - what is near, asked of a real daemon and of this process. */
#include "cases.h"

#include <unistd.h>

#include "fixture.h"
#include "grid.h"
#include "must.h"
#include "record_hash.h"

#define SIDE   16u
#define WITHIN 0.08 /* of a grid over a floor: some thousand pairs */

typedef struct pccd_near_settings settings_t;

static const settings_t defaults = PCCD_NEAR_SETTINGS_INIT;

/* Everything that can be asked of surfaces that are open. */
static const enum pccd_near_what whats[] = {PCCD_NEAR_PAIRS, PCCD_NEAR_FEATURES,
                                            PCCD_NEAR_VERTICES, PCCD_NEAR_NEAREST,
                                            PCCD_NEAR_CROSSINGS};
#define WHATS (sizeof whats / sizeof whats[0])

static struct pccd_client *connect_to(const char *url, uint64_t result_bytes)
{
    return test_client(&(struct pccd_options){
        .url = url, .timeout_ms = 60000, .result_bytes = result_bytes});
}

static size_t record_bytes(const struct pccd_answer *answer)
{
    return answer->what == PCCD_NEAR_VERTICES ? sizeof(double) : sizeof(struct pccd_near);
}

static const void *records_of(const struct pccd_answer *answer)
{
    return answer->what == PCCD_NEAR_VERTICES ? (const void *)answer->vertex_bounds
                                              : (const void *)answer->near;
}

/* An answer with the records of all its pages. */
struct whole {
    struct pccd_answer answer;
    uint8_t *records; /* of malloc */
};

static struct whole read_all(struct pccd_client *client, uint32_t scene,
                             struct pccd_answer *page)
{
    struct whole whole = {.answer = *page};
    size_t each = record_bytes(page);
    uint64_t got = 0;

    whole.records = test_room(page->total * each);
    for (;;) {
        assert_true(page->is_near);
        assert_int_equal(page->first, got);
        assert_int_equal(page->total, whole.answer.total);
        if (page->count > 0) {
            memcpy(whole.records + got * each, records_of(page), page->count * each);
        }
        got += page->count;
        assert_int_equal(page->cursor, got);
        pccd_answer_release(client, page);
        if (got == whole.answer.total) {
            return whole;
        }
        assert_int_equal(page->incomplete, PCCD_INCOMPLETE_RESULT_FULL);
        assert_ok(pccd_fetch(client, scene, whole.answer.step, got, page));
    }
}

static struct whole ask(struct pccd_client *client, uint32_t scene,
                        const settings_t *settings)
{
    struct pccd_answer page = PCCD_ANSWER_INIT;

    assert_ok(pccd_ask_near(client, scene, NULL, 0, settings, &page));
    return read_all(client, scene, &page);
}

static void assert_same(const struct whole *a, const struct whole *b)
{
    assert_int_equal(a->answer.what, b->answer.what);
    assert_int_equal(a->answer.total, b->answer.total);
    assert_memory_equal(a->records, b->records,
                        a->answer.total * record_bytes(&a->answer));
    assert_memory_equal(a->answer.hash, b->answer.hash, sizeof a->answer.hash);
    assert_memory_equal(a->answer.counts, b->answer.counts, sizeof a->answer.counts);
    assert_true(a->answer.distance_min == b->answer.distance_min);
    assert_true(a->answer.distance_max == b->answer.distance_max);
    assert_int_equal(a->answer.crossings, b->answer.crossings);
    assert_int_equal(a->answer.verdict, b->answer.verdict);
}

/* Let go of both, after that. */
static void expect_same(struct whole a, struct whole b)
{
    assert_same(&a, &b);
    free(a.records);
    free(b.records);
}

/* The grid, in a session of its own, so that its handles are the same each time. */
static void open_grid(struct test_grid *grid, const char *url, uint64_t result_bytes)
{
    struct pccd_client *client = connect_to(url, result_bytes);

    assert_ok(test_grid_make(client, SIDE, grid));
}

/* Its way to height z, in an answer of a step. */
static void step_to(struct test_grid *grid, float z, struct pccd_answer *answer)
{
    test_grid_positions(grid, z);
    assert_ok(pccd_step_x1(grid->client, grid->scene, grid->object, grid->x,
                           PCCD_FORMAT_F32, grid->vertex_count, NULL, answer));
}

static void move_to(struct test_grid *grid, float z)
{
    struct pccd_answer answer = PCCD_ANSWER_INIT;

    step_to(grid, z, &answer);
    pccd_answer_release(grid->client, &answer);
}

/* ---- the answer -------------------------------------------------------------------- */

/* If it failed, a distance would be wrong, or one that is asked for exactly left out. */
CASE_CROSSING(near__has_the_distance_that_is_known)
{
    struct test_crossing *crossing = *state;
    struct pccd_client *client = crossing->client;
    settings_t settings = defaults;

    settings.distance = nextafter(1.0, 0.0);
    struct whole whole = ask(client, crossing->scene, &settings);
    assert_int_equal(whole.answer.total, 0);
    assert_true(whole.answer.distance_min == 2e18 && whole.answer.distance_max == 0);
    free(whole.records);
    settings.distance = 1.0;
    whole = ask(client, crossing->scene, &settings);
    assert_int_equal(whole.answer.total, 3);
    assert_int_equal(whole.answer.counts[PCCD_VF], 3);
    assert_int_equal(whole.answer.verdict, PCCD_VERDICT_NONE);
    assert_true(whole.answer.distance_min == 1 && whole.answer.distance_max == 1);
    for (uint32_t i = 0; i < 3; i++) {
        struct pccd_near near;
        memcpy(&near, whole.records + i * sizeof near, sizeof near);
        assert_int_equal(near.kind, PCCD_VF);
        assert_int_equal(PCCD_NEAR_TYPE(near.flags), PCCD_VF);
        assert_int_equal(near.object_a, crossing->object);
        assert_int_equal(near.feature_a, i);
        assert_int_equal(near.object_b, crossing->floor);
        assert_int_equal(near.feature_b, 0);
        assert_true(near.d_lo == 1 && near.d_hi == 1);
        assert_true(near.direction[0] == 0 && near.direction[1] == 0 &&
                    near.direction[2] == 1);
        assert_int_equal(near.count, 1);
    }
    free(whole.records);
}

/* Check the hash of a complete answer. */
static void expect_its_hash(const struct whole *whole)
{
    uint64_t hash[2];

    if (whole->answer.what != PCCD_NEAR_VERTICES) { /* whose hash names the vertices */
        record_hash_2(whole->records, whole->answer.total, sizeof(struct pccd_near),
                      hash);
        assert_memory_equal(whole->answer.hash, hash, sizeof hash);
    }
}

/* If it failed, an answer would depend on who computed it, and how. */
CASE(near__has_the_same_bytes_in_any_way)
{
    struct test_grid grids[2];
    uint64_t most = 0;

    open_grid(&grids[0], test_shared.url, 4u << 20);
    open_grid(&grids[1], TEST_DIRECT_URL, 65536);
    for (int turn = 0; turn < 2; turn++) {
        for (size_t k = 0; k < WHATS; k++) {
            settings_t settings = defaults;
            settings.what = whats[k];
            settings.distance = WITHIN;
            settings.threads = 1;
            struct whole first = ask(grids[0].client, grids[0].scene, &settings);
            most = first.answer.total > most ? first.answer.total : most;
            expect_its_hash(&first);
            for (uint32_t way = 0; way < 8; way++) {
                struct test_grid *grid = &grids[way % 2];
                settings.threads = 1 + way / 2 % 2;
                settings.method = way / 4 % 2 == 0 ? PCCD_METHOD_WIDE : PCCD_METHOD_PAPER;
                struct whole again = ask(grid->client, grid->scene, &settings);
                assert_int_equal(again.answer.method,
                                 settings.what == PCCD_NEAR_NEAREST ||
                                         settings.what == PCCD_NEAR_DEPTH
                                     ? PCCD_METHOD_WIDE
                                     : settings.method);
                assert_same(&first, &again);
                free(again.records);
            }
            free(first.records);
        }
        move_to(&grids[0], 0.02f); /* through the floor */
        move_to(&grids[1], 0.02f);
    }
    assert_true(most > 2048); /* of 1024 a page */
    test_grid_close(&grids[0]);
    test_grid_close(&grids[1]);
}

/* If it failed, to move and ask at once would answer about another moment than a step
 * and a question, or leave the scene elsewhere. */
CASE(near__moves_and_asks_at_once)
{
    struct test_grid apart;
    struct test_grid once;
    struct pccd_answer steps[2] = {PCCD_ANSWER_INIT, PCCD_ANSWER_INIT};

    open_grid(&apart, test_shared.url, 4u << 20);
    open_grid(&once, test_shared.url, 4u << 20);
    for (uint32_t turn = 0; turn < 4; turn++) {
        const float z = turn % 2 == 0 ? 0.02f : 0.5f;
        struct pccd_answer page = PCCD_ANSWER_INIT;
        settings_t settings = defaults;
        settings.distance = WITHIN;
        settings.at_begin = turn / 2 != 0;
        move_to(&apart, z);
        test_grid_positions(&once, z);
        const struct pccd_motion motion = {.object = once.object,
                                           .count = once.vertex_count,
                                           .format = PCCD_FORMAT_F32,
                                           .x1 = once.x};
        assert_ok(pccd_ask_near(once.client, once.scene, &motion, 1, &settings, &page));
        expect_same(ask(apart.client, apart.scene, &settings),
                    read_all(once.client, once.scene, &page));
        settings.at_begin =
            !settings.at_begin; /* of the same movement, which is the last */
        expect_same(ask(apart.client, apart.scene, &settings),
                    ask(once.client, once.scene, &settings));
    }
    step_to(&apart, -0.5f, &steps[0]);
    step_to(&once, -0.5f, &steps[1]);
    assert_true(steps[0].total > 0);
    assert_memory_equal(steps[0].hash, steps[1].hash, sizeof steps[0].hash);
    assert_int_equal(steps[1].number, 1); /* what moves by the way is not counted */
    test_grid_close(&apart);
    test_grid_close(&once);
}

/* If it failed, a frame that is written in place could not be asked about. */
CASE_CROSSING(near__is_asked_with_a_frame)
{
    struct test_crossing *crossing = *state;
    struct pccd_client *client = crossing->client;
    settings_t settings = defaults;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    struct pccd_frame frame;
    uint64_t steps[2];
    float x[3][3];
    void *to = NULL;

    settings.distance = 0.5;
    test_crossing_positions(x, 0.5f);
    assert_ok(pccd_frame_begin(client, crossing->scene, 1, sizeof x, &frame));
    assert_ok(pccd_frame_x1(&frame, crossing->object, PCCD_FORMAT_F32, 0, 3, &to));
    memcpy(to, x, sizeof x);
    assert_ok(pccd_submit_near(client, crossing->scene, NULL, 0, &settings, steps));
    assert_ok(pccd_frame_commit_near(&frame, &settings, &steps[1]));
    assert_int_equal(pccd_frame_commit_near(&frame, &settings, &steps[1]), PCCD_E_INVAL);
    assert_int_equal(steps[1], steps[0] + 1);
    for (uint32_t i = 0; i < 2; i++) {
        assert_ok(pccd_wait(client, steps[i], -1, &answer));
        assert_int_equal(answer.step, steps[i]);
        assert_int_equal(answer.total, i * 3);
        pccd_answer_release(client, &answer);
    }
    settings.tuning[0] = 'x';
    assert_ok(pccd_frame_begin(client, crossing->scene, 1, sizeof x, &frame));
    memset(settings.tuning, 'x', sizeof settings.tuning);
    assert_int_equal(pccd_frame_commit_near(&frame, &settings, &steps[1]), PCCD_E_INVAL);
    test_crossing_positions(x, 1); /* no slot is lost */
    assert_ok(test_crossing_step(crossing, x, NULL, &answer));
    pccd_answer_release(client, &answer);
    assert_true(test_crossing_turn(crossing));
}

/* If it failed, the depth would be another one here than there, or none. */
CASE(near__tells_how_deep_a_mesh_is_in_another)
{
    static const double x[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    static const uint32_t faces[4][3] = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
    const double still[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    const double off[12] = {1, 0, 0, 0.125, 0, 1, 0, 0.125, 0, 0, 1, 0.125};
    const char *const urls[2] = {test_shared.url, TEST_DIRECT_URL};
    struct whole wholes[2];
    settings_t settings = defaults;

    settings.what = PCCD_NEAR_DEPTH;
    for (int i = 0; i < 2; i++) {
        struct pccd_client *client = connect_to(urls[i], 65536);
        struct pccd_answer page = PCCD_ANSWER_INIT;
        uint32_t objects[2];
        uint32_t scene = test_scene(client);
        uint32_t mesh = test_mesh(client, x, PCCD_FORMAT_F64, 4, faces, 4);
        objects[0] = test_object(client, scene, mesh);
        objects[1] = test_object(client, scene, mesh);
        const struct pccd_motion motion = {
            .object = objects[1], .count = 4, .m0 = still, .m1 = off};
        assert_ok(pccd_ask_near(client, scene, &motion, 1, &settings, &page));
        wholes[i] = read_all(client, scene, &page);
        pccd_close(client);
    }
    assert_int_equal(wholes[0].answer.total, 1); /* its corner, an eighth from three */
    assert_true(wholes[0].answer.distance_max == 0.125);
    assert_true(wholes[0].answer.crossings > 0);
    expect_same(wholes[0], wholes[1]);
}

/* ---- pages ------------------------------------------------------------------------- */

/* If it failed, the pages of one of the two answers would be lost by the other. */
CASE(near__keeps_an_answer_beside_that_of_the_step)
{
    struct pccd_answer step = PCCD_ANSWER_INIT;
    struct pccd_answer page = PCCD_ANSWER_INIT;
    struct test_grid grid;
    settings_t settings = defaults;

    open_grid(&grid, test_shared.url, 65536);
    move_to(&grid, 0.5f);
    step_to(&grid, -0.5f, &step);
    assert_true(step.total > 1);
    const uint64_t number = step.step;
    struct pccd_contact second = step.contacts[1];
    pccd_answer_release(grid.client, &step);
    settings.distance = WITHIN;
    struct whole first = ask(grid.client, grid.scene, &settings);
    assert_true(first.answer.total > 2);
    for (int turn = 0; turn < 2; turn++) {
        assert_ok(pccd_fetch(grid.client, grid.scene, number, 1, &page));
        assert_false(page.is_near);
        assert_memory_equal(page.contacts, &second, sizeof second);
        pccd_answer_release(grid.client, &page);
        assert_ok(pccd_fetch(grid.client, grid.scene, first.answer.step, 2, &page));
        assert_true(page.is_near);
        assert_memory_equal(page.near, first.records + 2 * sizeof *page.near,
                            page.count * sizeof *page.near);
        pccd_answer_release(grid.client, &page);
    }
    /* Another step takes the place of the step's answer alone, */
    move_to(&grid, 0.5f);
    assert_int_equal(pccd_fetch(grid.client, grid.scene, number, 1, &page), PCCD_E_STATE);
    assert_ok(pccd_fetch(grid.client, grid.scene, first.answer.step, 0, &page));
    pccd_answer_release(grid.client, &page);
    assert_int_equal(pccd_fetch(grid.client, grid.scene, first.answer.step,
                                first.answer.total + 1, &page),
                     PCCD_E_INVAL);
    assert_non_null(strstr(pccd_error_text(grid.client), "beyond the answer's"));
    /* another question that of the first, and the end of an object both. */
    struct whole other = ask(grid.client, grid.scene, &settings);
    assert_int_equal(pccd_fetch(grid.client, grid.scene, first.answer.step, 0, &page),
                     PCCD_E_STATE);
    assert_ok(pccd_scene_remove(grid.client, grid.scene, grid.floor));
    assert_int_equal(pccd_fetch(grid.client, grid.scene, other.answer.step, 0, &page),
                     PCCD_E_STATE);
    assert_non_null(strstr(pccd_error_text(grid.client), "no answer to scene.near"));
    free(first.records);
    free(other.records);
    test_grid_close(&grid);
}

/* If it failed, a question would cost the next step what it knows of the last one, or
 * change what it finds. */
CASE(near__leaves_steps_as_they_are)
{
    struct test_grid asked;
    struct test_grid silent;
    settings_t settings = defaults;

    open_grid(&asked, test_shared.url, 4u << 20);
    open_grid(&silent, test_shared.url, 4u << 20);
    settings.distance = WITHIN;
    for (int turn = 0; turn < 6; turn++) {
        struct pccd_answer a = PCCD_ANSWER_INIT;
        struct pccd_answer b = PCCD_ANSWER_INIT;
        float z = turn % 2 == 0 ? -0.02f : 0.02f;
        settings.what = whats[(unsigned)turn % WHATS];
        settings.at_begin = turn / 2 % 2 == 0;
        free(ask(asked.client, asked.scene, &settings).records);
        step_to(&asked, z, &a);
        step_to(&silent, z, &b);
        assert_true(a.total > 0);
        assert_int_equal(a.total, b.total);
        assert_memory_equal(a.hash, b.hash, sizeof a.hash);
        assert_int_equal(a.number, b.number);
        pccd_answer_release(asked.client, &a);
        pccd_answer_release(silent.client, &b);
    }
    test_grid_close(&asked);
    test_grid_close(&silent);
}

/* ---- refusals ---------------------------------------------------------------------- */

struct refusal {
    settings_t settings;
    int status;
    const char *text;
};

#define ASKED(...)                                                                       \
    {                                                                                    \
        .struct_bytes = sizeof(settings_t), __VA_ARGS__                                  \
    }

/* If it failed, what cannot be asked would be answered somehow, or nobody would know what
 * was wrong. */
CASE_CROSSING(near__refuses_by_name)
{
    struct test_crossing *crossing = *state;
    struct pccd_client *client = crossing->client;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    const struct refusal rows[] = {
        {ASKED(.what = (enum pccd_near_what)6), PCCD_E_INVAL, "unknown what 6"},
        {ASKED(.method = PCCD_METHOD_COUNT), PCCD_E_INVAL, "unknown method 3"},
        {ASKED(.tuning = "steal"), PCCD_E_INVAL, "tuning: "},
        {ASKED(.distance = -0.5), PCCD_E_INVAL, "distance is -0.5, not 0 to 1e+18"},
        {ASKED(.distance = NAN), PCCD_E_INVAL, "distance is "},
        {ASKED(.distance = INFINITY), PCCD_E_INVAL, "distance is inf"},
        {ASKED(.distance = 1.1e18), PCCD_E_LIMIT, "distance is 1.1e+18, at most 1e+18"},
        {ASKED(.what = PCCD_NEAR_VERTICES, .distance = INFINITY), PCCD_E_INVAL, "is inf"},
        {ASKED(.what = PCCD_NEAR_NEAREST, .distance = -INFINITY), PCCD_E_INVAL, "-inf"},
        {ASKED(.what = PCCD_NEAR_NEAREST, .gap = -1), PCCD_E_INVAL, "gap is -1"},
        {ASKED(.what = PCCD_NEAR_NEAREST, .gap = INFINITY), PCCD_E_INVAL, "gap is inf"},
        {ASKED(.what = PCCD_NEAR_NEAREST, .gap = 2e18), PCCD_E_LIMIT, "gap is 2e+18"},
        {ASKED(.what = PCCD_NEAR_NEAREST, .object_a = 7, .object_b = 7), PCCD_E_INVAL,
         "object_a and object_b are both 0x7"},
        {ASKED(.what = PCCD_NEAR_VERTICES, .object_a = crossing->object + 9),
         PCCD_E_HANDLE, "is not in the scene"},
        {ASKED(.what = PCCD_NEAR_NEAREST, .object_a = crossing->object, .object_b = 5),
         PCCD_E_HANDLE, "object_b 0x5 is not in the scene"},
        {ASKED(.what = PCCD_NEAR_DEPTH), PCCD_E_INVAL, "run along the edge"},
        {ASKED(.object_a = crossing->object), PCCD_E_INVAL, "what = 0 is asked of all"},
        {ASKED(.what = PCCD_NEAR_CROSSINGS, .object_b = crossing->object), PCCD_E_INVAL,
         "object_b is 0x"},
        {ASKED(.what = PCCD_NEAR_VERTICES, .object_b = crossing->object), PCCD_E_INVAL,
         "what = 2 is asked of all"},
    };

    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        int status =
            pccd_ask_near(client, crossing->scene, NULL, 0, &rows[i].settings, &answer);
        if (status != rows[i].status ||
            strstr(pccd_error_text(client), rows[i].text) == NULL) {
            fail_msg("row %zu: %d, \"%s\"", i, status, pccd_error_text(client));
        }
    }
    assert_int_equal(pccd_ask_near(client, crossing->scene + 1, NULL, 0, NULL, &answer),
                     PCCD_E_HANDLE);
    assert_int_equal(pccd_ask_near(client, crossing->scene, NULL, 1, NULL, &answer),
                     PCCD_E_INVAL);
    assert_int_equal(pccd_ask_near(client, crossing->scene, NULL, 0, NULL, NULL),
                     PCCD_E_INVAL);
    assert_int_equal(pccd_ask_near(NULL, crossing->scene, NULL, 0, NULL, &answer),
                     PCCD_E_INVAL);
    assert_true(test_crossing_turn(crossing));
}

/* If it failed, a movement would be done though its question was refused. */
CASE_CROSSING(near__that_fails_moves_nothing)
{
    struct test_crossing *crossing = *state;
    struct pccd_client *client = crossing->client;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    settings_t settings = defaults;
    float x[4][3] = {{0}}; /* the mesh has three */
    struct pccd_motion motion = {
        .object = crossing->object, .count = 3, .format = PCCD_FORMAT_F32, .x1 = x};

    test_crossing_positions(x, -1);
    settings.what = PCCD_NEAR_NEAREST;
    settings.object_a = crossing->object + 9;
    assert_int_equal(
        pccd_ask_near(client, crossing->scene, &motion, 1, &settings, &answer),
        PCCD_E_HANDLE);
    settings = defaults;
    x[1][2] = NAN;
    assert_int_equal(
        pccd_ask_near(client, crossing->scene, &motion, 1, &settings, &answer),
        PCCD_E_NOTFINITE);
    motion.count = 4;
    assert_int_equal(
        pccd_ask_near(client, crossing->scene, &motion, 1, &settings, &answer),
        PCCD_E_SEGMENT);
    assert_true(test_crossing_turn(crossing)); /* from above to below, not along z = -1 */
}

static double distance_at(struct test_crossing *crossing, uint32_t end)
{
    settings_t settings = defaults;
    struct pccd_answer answer = PCCD_ANSWER_INIT;

    settings.what = PCCD_NEAR_NEAREST;
    settings.distance = INFINITY;
    settings.at_begin = end == 0;
    assert_ok(
        pccd_ask_near(crossing->client, crossing->scene, NULL, 0, &settings, &answer));
    pccd_answer_release(crossing->client, &answer);
    return answer.distance_min;
}

/* If it failed, half of a frame that was refused would be taken for where a step
 * began. */
CASE_CROSSING(near__forgets_the_beginning_when_a_step_fails)
{
    struct test_crossing *crossing = *state;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    float x[3][3];

    test_crossing_positions(x, -3);
    assert_ok(test_crossing_step(crossing, x, NULL, &answer));
    pccd_answer_release(crossing->client, &answer);
    assert_true(distance_at(crossing, 0) == 1); /* as it was registered */
    assert_true(distance_at(crossing, 1) == 3);
    test_crossing_positions(x, -5);
    x[2][1] = NAN;
    assert_int_equal(test_crossing_step(crossing, x, NULL, &answer), PCCD_E_NOTFINITE);
    assert_true(distance_at(crossing, 0) == 3);
    assert_true(distance_at(crossing, 1) == 3);
}

/* If it failed, one of two objects that a refused step names would have begun where it
 * did, and the other where it is: a state that never was. */
CASE_CROSSING(near__forgets_the_beginning_of_all_that_a_failed_step_names)
{
    struct test_crossing *crossing = *state;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    float x[3][3];
    float floor[3][3];
    struct pccd_motion motions[2] = {
        {.object = crossing->object, .count = 3, .format = PCCD_FORMAT_F32, .x1 = x},
        {.object = crossing->floor, .count = 3, .format = PCCD_FORMAT_F32, .x1 = floor}};

    test_crossing_positions(x, -3);
    memcpy(floor, test_floor_x, sizeof floor);
    for (int i = 0; i < 3; i++) {
        floor[i][2] = 0.5F;
    }
    assert_ok(pccd_step(crossing->client, crossing->scene, motions, 2, NULL, &answer));
    pccd_answer_release(crossing->client, &answer);
    assert_true(distance_at(crossing, 0) == 1);
    x[2][1] = NAN;
    for (int i = 0; i < 2; i++) { /* the one that is not finite comes first, or last */
        assert_int_equal(
            pccd_step(crossing->client, crossing->scene, motions, 2, NULL, &answer),
            PCCD_E_NOTFINITE);
        assert_true(distance_at(crossing, 0) == 3.5);
        assert_true(distance_at(crossing, 1) == 3.5);
        struct pccd_motion first = motions[0];
        motions[0] = motions[1];
        motions[1] = first;
    }
}

/* ---- shared scenes ----------------------------------------------------------------- */

/* One client in the scene, with a triangle or the floor in it. */
struct member {
    struct pccd_client *client;
    uint32_t scene;
    uint32_t object;
};

static struct member open_member(const char *name, const float x[3][3])
{
    struct member member = {.client = test_client_at(test_shared.url)};
    const struct pccd_scene_settings settings = {
        .name = name, .share = PCCD_SHARE_OPEN, .rights = 0644};

    assert_ok(pccd_scene_create(member.client, &settings, &member.scene));
    uint32_t mesh = test_mesh(member.client, x, PCCD_FORMAT_F32, 3, test_triangle, 1);
    member.object = test_object(member.client, member.scene, mesh);
    return member;
}

/* If it failed, a question would take along what waits for a step, or a step would not
 * any more. */
CASE(near__leaves_held_frames_where_they_are)
{
    struct pccd_step_settings hold = {.struct_bytes = sizeof hold, .hold = true};
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    struct member cloth = open_member("near held", test_triangle_x);
    struct member obstacle = open_member("near held", test_floor_x);
    const double up[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0.75};
    const double still[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    const struct pccd_motion lift = {
        .object = obstacle.object, .count = 3, .m0 = still, .m1 = up};
    const struct pccd_motion stay = {
        .object = cloth.object, .count = 3, .m0 = still, .m1 = still};
    settings_t settings = defaults;
    uint64_t step = 0;

    assert_ok(pccd_submit(obstacle.client, obstacle.scene, &lift, 1, &hold, &step));
    assert_ok(pccd_wait_held(obstacle.client, step, -1));
    settings.distance = 10;
    for (uint32_t moves = 0; moves < 2; moves++) { /* of either member */
        struct member *member = moves == 0 ? &obstacle : &cloth;
        assert_ok(pccd_ask_near(member->client, member->scene, &stay, moves, &settings,
                                &answer));
        assert_true(answer.distance_min == 1);
        pccd_answer_release(member->client, &answer);
        assert_int_equal(pccd_wait(obstacle.client, step, 0, &answer), PCCD_E_AGAIN);
    }
    assert_ok(pccd_step(cloth.client, cloth.scene, &stay, 1, NULL, &answer));
    assert_int_equal(answer.number, 1); /* no question was a step */
    pccd_answer_release(cloth.client, &answer);
    assert_ok(pccd_wait(obstacle.client, step, -1, &answer));
    assert_ok(pccd_ask_near(cloth.client, cloth.scene, NULL, 0, &settings, &answer));
    assert_true(answer.distance_min == 0.25);
    pccd_answer_release(cloth.client, &answer);
    pccd_close(cloth.client);
    pccd_close(obstacle.client);
}

/* If it failed, who may only read could move, or could not ask; or would read the pages
 * of another's question as its own. */
CASE(near__is_asked_by_every_member)
{
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    struct pccd_scene_news news;
    struct member owner;
    struct member reader = {NULL, 0, 0};
    settings_t settings = defaults;
    float x[3][3];

    if (geteuid() != 0 || test_is_direct()) {
        test_skip("only root can act as another user, and only to a daemon");
    }
    owner = open_member("near read", test_triangle_x);
    reader.client = test_connect_as_other();
    assert_non_null(reader.client);
    assert_ok(pccd_scene_join(reader.client, 0, "near read", &reader.scene));
    settings.distance = 1;
    assert_ok(pccd_ask_near(reader.client, reader.scene, NULL, 0, &settings, &answer));
    assert_int_equal(answer.total, 0); /* there is nothing but the triangle */
    const uint64_t number = answer.step;
    test_crossing_positions(x, 0);
    const struct pccd_motion motion = {
        .object = owner.object, .count = 3, .format = PCCD_FORMAT_F32, .x1 = x};
    assert_int_equal(
        pccd_ask_near(reader.client, reader.scene, &motion, 1, &settings, &answer),
        PCCD_E_ACCESS);
    assert_non_null(strstr(pccd_error_text(reader.client), "may only read"));
    assert_ok(pccd_ask_near(owner.client, owner.scene, &motion, 1, &settings, &answer));
    assert_int_equal(pccd_fetch(reader.client, reader.scene, number, 0, &answer),
                     PCCD_E_STATE);
    assert_non_null(strstr(pccd_error_text(reader.client), "another session's"));
    /* Nobody is told of a step. */
    assert_int_equal(pccd_scene_wait(reader.client, reader.scene, 0, &news),
                     PCCD_E_AGAIN);
    pccd_close(reader.client);
    pccd_close(owner.client);
}

/* ---- what shows -------------------------------------------------------------------- */

struct seen {
    uint32_t requests;
};

static void see(void *context, const struct pccd_trace_event *events, uint32_t count)
{
    struct seen *seen = context;

    for (uint32_t i = 0; i < count; i++) {
        const char *method = pccd_method_name(events[i].a);
        seen->requests += events[i].kind == PCCD_TRACE_REQUEST && method != NULL &&
                          strcmp(method, "scene.near") == 0;
    }
}

/* If it failed, nobody would see in counters or in a trace what a daemon was asked. */
CASE_CROSSING(near__shows_in_counters_and_traces)
{
    struct test_crossing *crossing = *state;
    struct pccd_client *client = crossing->client;
    struct pccd_trace_info info;
    settings_t settings = defaults;
    struct seen seen = {0};
    const uint64_t nears = test_stat(client, "nears");
    const uint64_t records = test_stat(client, "near_records");
    const uint64_t steps = test_stat(client, "steps");

    settings.distance = 1;
    assert_ok(pccd_trace_start(client, 0, 0, NULL));
    for (int i = 0; i < 2; i++) {
        free(ask(client, crossing->scene, &settings).records);
    }
    assert_ok(pccd_trace_stop(client, &info));
    assert_ok(pccd_trace_dump(client, see, &seen));
    assert_int_equal(seen.requests, 2);
    assert_int_equal(test_stat(client, "nears"), nears + 2);
    assert_int_equal(test_stat(client, "near_records"), records + 6);
    assert_int_equal(test_stat(client, "steps"), steps);
    assert_true(test_stat(client, "ns_near") > 0);
}

CASES_WITH(test_shared_start, test_shared_stop);
