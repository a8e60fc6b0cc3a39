/* test_int_batch.c - steps of many scenes by one request. */
#include "cases.h"

#include <signal.h>

#include "daemon.h"
#include "farm.h"
#include "fixture.h"
#include "must.h"
#include "pccd.h"
#include "raw.h"

#define WORLDS 48u
#define SIDE   9u /* 128 triangles */

static struct pccd_client *open_client(const char *url)
{
    return test_client(&(struct pccd_options){.url = url, .timeout_ms = 120000});
}

static void make_farm(struct pccd_client *client, uint32_t count, uint32_t side,
                      struct test_farm *farm)
{
    int status = test_farm_make(client, count, side, farm);

    if (status != 0) {
        fail_msg("%s: %s", pccd_status_name(status), pccd_error_text(client));
    }
}

/* ---- the same answers -------------------------------------------------------------- */

/* Everything that both say. */
static void compare(const struct pccd_batch_answer *all, uint64_t i,
                    const struct pccd_answer *alone)
{
    const struct pccd_scene_answer *scene = &all->scenes[i];

    assert_int_equal(scene->status, 0);
    assert_string_equal(scene->why, "");
    assert_int_equal(scene->incomplete, alone->incomplete);
    assert_int_equal(scene->verdict, alone->verdict);
    assert_int_equal(scene->number, alone->number);
    assert_int_equal(scene->total, alone->total);
    assert_memory_equal(scene->counts, alone->counts, sizeof scene->counts);
    assert_int_equal(scene->possible, alone->possible);
    assert_int_equal(scene->initial, alone->initial);
    assert_int_equal(scene->inside, alone->inside);
    assert_true(scene->toi_first == alone->toi_first);
    assert_true(scene->safe_step == alone->safe_step);
    assert_int_equal(scene->hash[0], alone->hash[0]);
    assert_int_equal(scene->hash[1], alone->hash[1]);
    assert_int_equal(scene->count, alone->count);
    if (all->mode == PCCD_MODE_PAIRS && scene->count > 0) {
        assert_null(pccd_batch_contacts(all, i));
        assert_memory_equal(pccd_batch_pairs(all, i), alone->pairs,
                            scene->count * sizeof *alone->pairs);
    } else if (scene->count > 0) {
        assert_memory_equal(pccd_batch_contacts(all, i), alone->contacts,
                            scene->count * sizeof *alone->contacts);
    }
}

/* Two sessions of the same daemon: one steps its scenes one by one. */
static void compare_all(const char *url, const struct pccd_step_settings *settings)
{
    struct pccd_client *clients[2] = {open_client(url), open_client(url)};
    struct test_farm together, apart;
    uint64_t records = 0;

    make_farm(clients[0], WORLDS, SIDE, &together);
    make_farm(clients[1], WORLDS, SIDE, &apart);
    assert_int_equal(pccd_batch_scenes(together.batch), WORLDS);
    for (uint32_t turn = 1; turn <= 4; turn++) {
        struct pccd_batch_answer all = PCCD_BATCH_ANSWER_INIT;

        assert_ok(test_farm_turn(&together, turn, settings, &all));
        assert_int_equal(all.status, 0);
        assert_int_equal(all.count, WORLDS);
        assert_int_equal(all.failed, 0);
        for (uint32_t i = 0; i < WORLDS; i++) {
            struct pccd_answer alone = PCCD_ANSWER_INIT;

            assert_ok(test_farm_alone(&apart, i, turn, settings, &alone));
            assert_int_equal(all.scenes[i].scene, apart.worlds[i].scene);
            compare(&all, i, &alone);
            records += alone.total;
            pccd_answer_release(clients[1], &alone);
        }
        pccd_batch_release(clients[0], &all);
        assert_null(all.scenes);
    }
    assert_true(records > 0 || settings->mode == PCCD_MODE_ANY);
    test_farm_free(&together);
    test_farm_free(&apart);
    pccd_close(clients[0]);
    pccd_close(clients[1]);
}

/* If it failed, each scene of a batch would have the scratch of a thread, and a thousand
 * scenes take a gigabyte. The first case: nothing else is freed meanwhile. */
CASE(scenes__of_a_batch_share_the_scratch_of_threads)
{
    struct pccd_client *client = open_client(test_shared.url);
    struct pccd_batch_answer answer = PCCD_BATCH_ANSWER_INIT;
    struct test_farm farm;
    uint64_t before, after;

    make_farm(client, 200, SIDE, &farm);
    before = test_stat(client, "engine_bytes_now");
    for (uint32_t turn = 1; turn <= 4; turn++) {
        assert_ok(test_farm_turn(&farm, turn, NULL, &answer));
        pccd_batch_release(client, &answer);
    }
    after = test_stat(client, "engine_bytes_now");
    assert_true(after > before);
    print_message("# %llu bytes a scene\n", (unsigned long long)(after - before) / 200);
    assert_true((after - before) / 200 < 256 * 1024); /* a worker has 800 KB */
    test_farm_free(&farm);
    pccd_close(client);
}

/* If it failed, a scene in a batch would have other contacts than by itself: for any
 * number of threads, in any mode, with a daemon or without. */
CASE(scenes__are_answered_as_if_stepped_alone)
{
    for (uint32_t threads = 1; threads <= 2; threads++) {
        for (int mode = 0; mode < PCCD_MODE_COUNT; mode++) {
            const struct pccd_step_settings settings = {
                .struct_bytes = sizeof settings,
                .mode = (enum pccd_mode)mode,
                .threads = threads,
                .separation = mode == PCCD_MODE_FIRST ? 0.01 : 0};

            compare_all(test_shared.url, &settings);
            compare_all(TEST_DIRECT_URL, &settings);
        }
    }
}

/* If it failed, one large scene would keep a batch waiting for one thread, or have other
 * contacts than by itself. */
CASE(scene__that_is_most_of_the_work_is_shared_by_the_team)
{
    struct pccd_client *client = open_client(test_shared.url);
    struct test_farm large, small;
    struct pccd_batch_part parts[9];
    const void *x1[9];
    float(*x)[9][SIDE * SIDE][3] = calloc(1, sizeof *x);
    float(*wide)[3];
    struct pccd_batch *batch = NULL;
    struct pccd_batch_answer answer = PCCD_BATCH_ANSWER_INIT;

    assert_non_null(x);
    make_farm(client, 8, SIDE, &small);
    make_farm(client, 1, 150, &large);
    wide = test_room(large.vertex_count * sizeof *wide);
    for (uint32_t i = 0; i < 8; i++) {
        parts[i] = (struct pccd_batch_part){.scene = small.worlds[i].scene,
                                            .object = small.worlds[i].body,
                                            .count = small.vertex_count};
        x1[i] = (*x)[i];
    }
    parts[8] = (struct pccd_batch_part){.scene = large.worlds[0].scene,
                                        .object = large.worlds[0].body,
                                        .count = large.vertex_count};
    x1[8] = wide;
    assert_ok(pccd_batch_create(client, parts, 9, &batch));
    for (uint32_t turn = 1; turn <= 4; turn++) {
        for (uint32_t i = 0; i < 8; i++) {
            test_farm_positions(&small, i, turn, (*x)[i]);
        }
        test_farm_positions(&large, 0, turn, wide);
        assert_ok(pccd_batch_step(batch, NULL, x1, NULL, &answer));
        assert_int_equal(answer.failed, 0);
        assert_int_equal(answer.scenes[0].threads, 1);
        assert_int_equal(answer.scenes[8].threads, 2);
        assert_int_equal(answer.threads, 2);
        pccd_batch_release(client, &answer);
    }
    free(wide);
    free(x);
    pccd_batch_destroy(batch);
    test_farm_free(&small);
    test_farm_free(&large);
    pccd_close(client);
}

/* ---- what fails -------------------------------------------------------------------- */

/* The farm, where some of the worlds cannot be stepped. */
struct trouble {
    struct test_farm farm;
    uint32_t shared;
    uint32_t shared_object;
    uint32_t small_mesh, small;
    struct pccd_batch_part parts[16];
    struct pccd_batch *batch;
};

enum { GOOD, UNKNOWN, NOT_FINITE, FOREIGN, TWICE, BEYOND, REPLACED, SHARED, GOOD_TOO };

static void make_trouble(struct pccd_client *client, struct trouble *trouble)
{
    const struct pccd_scene_settings shared = {.name = "of many",
                                               .share = PCCD_SHARE_OPEN};
    struct pccd_batch_part *parts = trouble->parts;
    struct test_farm *farm = &trouble->farm;

    make_farm(client, GOOD_TOO + 1, SIDE, farm);
    for (uint32_t i = 0; i <= GOOD_TOO; i++) {
        parts[i] = (struct pccd_batch_part){.scene = farm->worlds[i].scene,
                                            .object = farm->worlds[i].body,
                                            .count = farm->vertex_count};
    }
    assert_ok(pccd_scene_create(client, &shared, &trouble->shared));
    trouble->shared_object = test_object(client, trouble->shared, farm->mesh);
    trouble->small_mesh =
        test_mesh(client, test_triangle_x, PCCD_FORMAT_F32, 3, test_triangle, 1);
    trouble->small =
        test_object(client, farm->worlds[REPLACED].scene, trouble->small_mesh);
    parts[UNKNOWN].scene = 0xfff00fff;
    parts[FOREIGN].object = 0xfff00fff;
    parts[TWICE].scene = parts[GOOD].scene;
    parts[BEYOND].first = 7;
    parts[REPLACED].object = trouble->small;
    parts[REPLACED].count = 3;
    parts[SHARED].scene = trouble->shared;
    parts[SHARED].object = trouble->shared_object;
    assert_ok(pccd_batch_create(client, parts, GOOD_TOO + 1, &trouble->batch));
}

static void submit_trouble(struct trouble *trouble, uint32_t turn, uint64_t *step)
{
    void *x1[GOOD_TOO + 1];

    assert_ok(pccd_batch_begin(trouble->batch, NULL, x1));
    for (uint32_t i = 0; i <= GOOD_TOO; i++) {
        if (i == REPLACED) {
            memcpy(x1[i], test_triangle_x, sizeof test_triangle_x);
        } else {
            test_farm_positions(&trouble->farm, i, turn, x1[i]);
        }
    }
    ((float *)x1[NOT_FINITE])[4] = NAN;
    assert_ok(pccd_batch_commit(trouble->batch, NULL, step));
}

static void expect(const struct pccd_batch_answer *answer, uint32_t i, int status,
                   const char *part)
{
    assert_int_equal(answer->scenes[i].status, status);
    if (strstr(answer->scenes[i].why, part) == NULL) {
        fail_msg("scene %u: \"%s\"", i, answer->scenes[i].why);
    }
}

/* If it failed, one scene with a mistake would spoil the step of all others, or not say
 * what the mistake was. */
CASE(scene__that_fails_does_not_fail_the_others)
{
    static const uint32_t one[1][3] = {{0, 1, 1}};
    struct pccd_client *client = open_client(test_shared.url);
    struct pccd_batch_answer answer = PCCD_BATCH_ANSWER_INIT;
    struct pccd_answer alone = PCCD_ANSWER_INIT;
    struct trouble trouble;
    uint64_t step = 0;

    make_trouble(client, &trouble);
    /* A mesh that has fewer vertices by the time of the step. */
    assert_ok(pccd_mesh_replace(client, trouble.small_mesh, test_triangle_x,
                                PCCD_FORMAT_F32, 2, one, 1, NULL));
    submit_trouble(&trouble, 1, &step);
    assert_ok(pccd_batch_wait(client, step, -1, &answer));
    expect(&answer, UNKNOWN, PCCD_E_HANDLE, "no such scene");
    expect(&answer, NOT_FINITE, PCCD_E_NOTFINITE, "y of vertex 1 is nan");
    expect(&answer, FOREIGN, PCCD_E_HANDLE, "is not in the scene");
    expect(&answer, TWICE, PCCD_E_INVAL, "more than once");
    expect(&answer, BEYOND, PCCD_E_SEGMENT, "vertices from 7 on");
    expect(&answer, REPLACED, PCCD_E_SEGMENT, "generation 2");
    assert_int_equal(answer.scenes[SHARED].status, 0);
    assert_int_equal(answer.scenes[SHARED].number, 1);
    assert_int_equal(answer.failed, 6);
    assert_int_equal(answer.scenes[GOOD].status, 0);
    assert_int_equal(answer.scenes[GOOD_TOO].status, 0);
    assert_true(answer.scenes[GOOD].total > 0 && answer.scenes[GOOD_TOO].total > 0);
    pccd_batch_release(client, &answer);
    /* Who has failed stands where it stood; who has not has moved on. */
    assert_ok(test_farm_alone(&trouble.farm, NOT_FINITE, 1, NULL, &alone));
    assert_int_equal(alone.number, 1);
    assert_true(alone.total > 0);
    pccd_answer_release(client, &alone);
    assert_ok(test_farm_alone(&trouble.farm, GOOD_TOO, 1, NULL, &alone));
    assert_int_equal(alone.number, 2);
    assert_int_equal(alone.total, 0);
    pccd_answer_release(client, &alone);
    pccd_batch_destroy(trouble.batch);
    test_farm_free(&trouble.farm);
    pccd_close(client);
}

/* If it failed, a step that was answered at its deadline, and then could not be made,
 * would be lost: its client would go on from positions that the scene does not have. */
CASE(scene__tells_of_a_step_that_failed_after_its_answer)
{
    struct pccd_step_settings late = PCCD_STEP_SETTINGS_INIT;
    struct pccd_client *client = open_client(test_shared.url);
    struct pccd_batch_answer all = PCCD_BATCH_ANSWER_INIT;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    struct test_farm farm, small;
    uint64_t steps[3];

    late.deadline_ns = 1000000;
    make_farm(client, 300, 30, &farm);
    make_farm(client, 3, SIDE, &small);
    const struct pccd_motion motion = {
        .object = small.worlds[1].body, .count = small.vertex_count, .x1 = small.x};
    assert_ok(test_farm_submit(&farm, 1, NULL, &steps[0]));
    test_farm_positions(&small, 1, 1, small.x);
    small.x[7][1] = NAN;
    assert_ok(pccd_submit(client, small.worlds[1].scene, &motion, 1, &late, &steps[1]));
    assert_ok(test_farm_submit(&small, 1, NULL, &steps[2]));
    assert_ok(pccd_wait(client, steps[1], -1, &answer));
    assert_int_equal(answer.incomplete, PCCD_INCOMPLETE_DEADLINE);
    assert_int_equal(pccd_batch_wait(client, steps[0], 0, &all), PCCD_E_AGAIN);
    pccd_answer_release(client, &answer);
    assert_ok(pccd_batch_wait(client, steps[0], -1, &all));
    pccd_batch_release(client, &all);
    assert_ok(pccd_batch_wait(client, steps[2], -1, &all));
    expect(&all, 1, PCCD_E_NOTFINITE, "y of vertex 7 is nan");
    assert_int_equal(all.failed, 1);
    assert_int_equal(all.scenes[0].number, 1);
    assert_int_equal(all.scenes[2].number, 1);
    pccd_batch_release(client, &all);
    assert_ok(test_farm_turn(&small, 1, NULL, &all)); /* it is told once */
    assert_int_equal(all.failed, 0);
    assert_int_equal(all.scenes[1].number, 1);
    pccd_batch_release(client, &all);
    test_farm_free(&farm);
    test_farm_free(&small);
    pccd_close(client);
}

/* A batch of three scenes that has to end: the second writes two times to the same
 * vertices, and the third has no number. */
static void check_ends_at_once(const char *url)
{
    struct pccd_step_settings late = PCCD_STEP_SETTINGS_INIT;
    struct pccd_client *client = open_client(url);
    struct pccd_batch_answer all = PCCD_BATCH_ANSWER_INIT;
    struct pccd_answer alone = PCCD_ANSWER_INIT;
    const enum pccd_status owed[3] = {PCCD_OK, PCCD_E_SEGMENT, PCCD_E_NOTFINITE};
    struct pccd_batch_part parts[4];
    struct pccd_batch *batch;
    struct test_farm farm;
    float bad[SIDE * SIDE][3];
    const void *x1[4];

    late.deadline_ns = 1;
    make_farm(client, 3, SIDE, &farm);
    assert_int_equal(farm.vertex_count, SIDE * SIDE);
    test_farm_positions(&farm, 1, 1, farm.x);
    memcpy(bad, farm.x, sizeof bad);
    bad[7][1] = NAN;
    for (uint32_t i = 0; i < 4; i++) {
        const struct test_world *world = &farm.worlds[i - (i > 1)];
        parts[i] = (struct pccd_batch_part){
            .scene = world->scene, .object = world->body, .count = farm.vertex_count};
        x1[i] = i == 3 ? bad : farm.x;
    }
    assert_ok(pccd_batch_create(client, parts, 4, &batch));
    assert_ok(pccd_batch_step(batch, NULL, x1, &late, &all));
    assert_int_equal(all.count, 3);
    assert_int_equal(all.failed, 0);
    assert_int_equal(all.incomplete, 3);
    for (uint32_t i = 0; i < 3; i++) {
        assert_int_equal(all.scenes[i].scene, farm.worlds[i].scene);
        assert_int_equal(all.scenes[i].status, 0);
        assert_int_equal(all.scenes[i].incomplete, PCCD_INCOMPLETE_DEADLINE);
        assert_true(all.scenes[i].number <= 1); /* 0: answered before its turn */
        assert_int_equal(all.scenes[i].count, 0);
        assert_true(all.scenes[i].toi_first == 2);
    }
    pccd_batch_release(client, &all);
    for (uint32_t i = 0; i < 3; i++) { /* it is told once; the other one has moved */
        if (owed[i] != PCCD_OK) {
            assert_int_equal(test_farm_alone(&farm, i, 1, NULL, &alone), owed[i]);
            pccd_answer_release(client, &alone);
        }
        assert_ok(test_farm_alone(&farm, i, 1, NULL, &alone));
        assert_int_equal(alone.number, 2 - (owed[i] != PCCD_OK));
        assert_int_equal(alone.total > 0, owed[i] != PCCD_OK);
        pccd_answer_release(client, &alone);
    }
    pccd_batch_destroy(batch);
    test_farm_free(&farm);
    pccd_close(client);
}

/* If it failed, the answer of a batch that has to end would wait until all of its scenes
 * were read, or have moved; or one that cannot move then would be lost. The daemon's loop
 * answers before its turn, and direct: in it. */
CASE(batch__that_has_to_end_is_answered_before_the_rest_moves)
{
    check_ends_at_once(test_shared.url);
    check_ends_at_once(TEST_DIRECT_URL);
}

/* If it failed, a scene would be stepped in another order than it was asked for. */
CASE(batch__is_computed_between_the_steps_around_it)
{
    struct pccd_client *client = open_client(test_shared.url);
    struct pccd_batch_answer all = PCCD_BATCH_ANSWER_INIT;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    struct test_farm farm;
    uint64_t steps[3];

    make_farm(client, 4, SIDE, &farm);
    for (int i = 0; i < 3; i++) {
        const struct pccd_motion motion = {
            .object = farm.worlds[2].body, .count = farm.vertex_count, .x1 = farm.x};

        test_farm_positions(&farm, 2, 1 + (uint32_t)i, farm.x);
        assert_int_equal(i == 1 ? test_farm_submit(&farm, 2, NULL, &steps[i])
                                : pccd_submit(client, farm.worlds[2].scene, &motion, 1,
                                              NULL, &steps[i]),
                         0);
    }
    assert_int_equal(steps[1], steps[0] + 1);
    assert_int_equal(steps[2], steps[1] + 4); /* each scene has a number */
    assert_int_equal(pccd_wait(client, steps[1], -1, &answer), PCCD_E_INVAL);
    assert_int_equal(pccd_batch_wait(client, steps[0], -1, &all), PCCD_E_INVAL);
    assert_ok(pccd_wait(client, steps[0], -1, &answer));
    assert_int_equal(answer.number, 1);
    pccd_answer_release(client, &answer);
    assert_ok(pccd_batch_wait(client, steps[1], -1, &all));
    assert_int_equal(all.step, steps[1]);
    assert_int_equal(all.scenes[2].number, 2);
    assert_int_equal(all.scenes[3].number, 1);
    assert_true(all.scenes[2].total > 0);
    pccd_batch_release(client, &all);
    assert_int_equal(
        pccd_poll(client, &answer) == PCCD_E_AGAIN || answer.step == steps[2], true);
    if (answer.step != steps[2]) {
        assert_ok(pccd_wait(client, steps[2], -1, &answer));
    }
    assert_int_equal(answer.number, 3);
    pccd_answer_release(client, &answer);
    assert_int_equal(pccd_batch_poll(client, &all), PCCD_E_AGAIN);
    test_farm_free(&farm);
    pccd_close(client);
}

/* ---- pages and limits -------------------------------------------------------------- */

/* If it failed, records that do not fit the result region would be lost. */
CASE(records__that_do_not_fit_are_fetched)
{
    struct pccd_client *client = NULL;
    struct pccd_batch_answer all = PCCD_BATCH_ANSWER_INIT;
    struct test_farm farm;
    uint32_t cut = 0;
    uint64_t totals[16];

    client = test_client(
        &(struct pccd_options){.url = test_shared.url, .result_bytes = 65536});
    make_farm(client, 16, 12, &farm);
    assert_ok(test_farm_turn(&farm, 1, NULL, &all));
    assert_int_equal(all.failed, 0);
    assert_true(all.total * sizeof(struct pccd_contact) > 65536);
    for (uint32_t i = 0; i < 16; i++) {
        bool is_cut = all.scenes[i].count < all.scenes[i].total;

        assert_int_equal(all.scenes[i].incomplete,
                         is_cut ? PCCD_INCOMPLETE_RESULT_FULL : PCCD_COMPLETE);
        cut += is_cut;
        totals[i] = all.scenes[i].total;
    }
    assert_true(cut > 0 && all.incomplete == cut);
    pccd_batch_release(client, &all);
    for (uint32_t i = 0; i < 16; i++) {
        struct pccd_answer page = PCCD_ANSWER_INIT;

        assert_ok(pccd_fetch(client, farm.worlds[i].scene, all.step + i, 1, &page));
        assert_int_equal(page.first, 1);
        assert_int_equal(page.cursor, totals[i]);
        assert_int_equal(page.contacts[0].object_a, farm.worlds[i].body);
        pccd_answer_release(client, &page);
    }
    test_farm_free(&farm);
    pccd_close(client);
}

/* One batch by hand; the table is in slot 0. */
static struct proto_BATCH_SUBMIT_request write_batch(struct test_raw *raw,
                                                     const uint32_t *scenes,
                                                     uint32_t count, uint32_t segments)
{
    uint64_t seq = 0;

    for (uint32_t i = 0; i < count; i++) {
        const struct proto_batch_scene entry = {scenes[i], i == 0 ? segments : 0};

        memcpy(test_raw_payload(raw, 0) + i * sizeof entry, &entry, sizeof entry);
    }
    seq = test_raw_publish(raw, 0);
    return (struct proto_BATCH_SUBMIT_request){
        .slot = 0, .seq = seq, .scenes = count, .segments = segments};
}

/* If it failed, a request that makes no sense would be computed, or the daemon read what
 * is not there. */
CASE(request__that_makes_no_sense_is_refused)
{
    static struct test_raw raw;
    struct proto_SCENE_CREATE_request create = {.want = 0};
    struct proto_SCENE_CREATE_result scene;
    struct proto_BATCH_SUBMIT_request batch;
    struct proto_BATCH_SUBMIT_result result;

    assert_ok(test_raw_session(&raw, test_shared.socket, 2, 4096));
    assert_ok(test_raw_call(&raw, PROTO_METHOD_SCENE_CREATE, &create, &scene));
#define REFUSE(status, field, value)                                                     \
    do {                                                                                 \
        batch = write_batch(&raw, &scene.scene, 1, 0);                                   \
        batch.field = value;                                                             \
        assert_int_equal(                                                                \
            test_raw_call(&raw, PROTO_METHOD_BATCH_SUBMIT, &batch, &result), status);    \
    } while (0)
    REFUSE(PCCD_E_LIMIT, scenes, 65537);
    REFUSE(PCCD_E_LIMIT, segments, 65537);
    REFUSE(PCCD_E_INVAL, scenes, 0);
    REFUSE(PCCD_E_SEGMENT, scenes, 600); /* 4800 bytes of 4096 */
    REFUSE(PCCD_E_SEGMENT, segments, 1); /* the table has none */
    REFUSE(PCCD_E_SLOT_STALE, seq, 4711 * 2);
    REFUSE(PCCD_E_INVAL, slot, 7);
    REFUSE(PCCD_E_INVAL, mode, PCCD_MODE_COUNT);
    REFUSE(PCCD_E_INVAL, tolerance, 2.0);
    REFUSE(PCCD_E_INVAL, separation, -1.0);
    REFUSE(0, step, 5);
    assert_int_equal(result.step, 5);
    assert_int_equal(result.count, 1);
    assert_int_equal(result.failed, 0);
    batch = write_batch(&raw, &scene.scene, 1, 2); /* of which no table speaks truth */
    assert_ok(test_raw_call(&raw, PROTO_METHOD_BATCH_SUBMIT, &batch, &result));
    assert_int_equal(result.failed, 1);
    test_raw_close(&raw);
}

/* If it failed, a batch of more scenes than answers fit would end in nothing. */
CASE(answers__that_never_fit_are_refused_before_anything_moves)
{
    struct pccd_batch_answer all = PCCD_BATCH_ANSWER_INIT;
    struct pccd_batch_answer held = PCCD_BATCH_ANSWER_INIT;
    struct test_farm farm, less;

    struct pccd_client *client = test_client(
        &(struct pccd_options){.url = test_shared.url, .result_bytes = 65536});
    make_farm(client, 250, 2, &farm); /* 80 000 bytes of answers */
    assert_int_equal(test_farm_turn(&farm, 1, NULL, &all), PCCD_E_LIMIT);
    test_farm_free(&farm);
    make_farm(client, 150, 2, &less);
    assert_ok(test_farm_turn(&less, 1, NULL, &held));
    assert_int_equal(test_farm_turn(&less, 2, NULL, &all), PCCD_E_BUSY);
    pccd_batch_release(client, &held);
    assert_ok(test_farm_turn(&less, 2, NULL, &all));
    assert_int_equal(all.scenes[149].number, 2);
    pccd_batch_release(client, &all);
    test_farm_free(&less);
    pccd_close(client);
}

/* If it failed, a program's mistake would be another one's crash. */
CASE(batch__that_makes_no_sense_is_not_made)
{
    struct pccd_client *client = open_client(test_shared.url);
    struct pccd_batch_part parts[2] = {{.scene = 1, .object = 1, .count = 1},
                                       {.scene = 1, .object = 0}};
    struct pccd_batch *batch = NULL;
    struct pccd_step_settings settings = PCCD_STEP_SETTINGS_INIT;
    uint64_t step = 0;
    void *x1[2];

    assert_int_equal(pccd_batch_create(client, parts, 0, &batch), PCCD_E_INVAL);
    assert_int_equal(pccd_batch_create(client, parts, 2, &batch), PCCD_E_INVAL);
    assert_int_equal(pccd_batch_create(client, parts, 65537, &batch), PCCD_E_LIMIT);
    parts[0].count = 0;
    assert_int_equal(pccd_batch_create(client, parts, 1, &batch), PCCD_E_INVAL);
    parts[0].count = 1;
    assert_null(batch);
    assert_ok(pccd_batch_create(client, parts, 1, &batch));
    assert_int_equal(pccd_batch_commit(batch, NULL, &step), PCCD_E_STATE);
    assert_ok(pccd_batch_begin(batch, NULL, x1));
    assert_int_equal(pccd_batch_begin(batch, NULL, x1), PCCD_E_STATE);
    settings.hold = true;
    assert_int_equal(pccd_batch_commit(batch, &settings, &step), PCCD_E_INVAL);
    assert_ok(pccd_batch_begin(batch, NULL, x1)); /* it was aborted */
    pccd_batch_destroy(batch);
    pccd_close(client);
}

/* ---- time -------------------------------------------------------------------------- */

/* Check where all scenes are after a turn, whatever came of it: a step in which nothing
 * moves and then the turn back say the same as in a farm that had all its time. */
static void check_places(struct test_farm *farm, struct test_farm *other, uint32_t turn)
{
    struct pccd_batch_answer all[2] = {PCCD_BATCH_ANSWER_INIT, PCCD_BATCH_ANSWER_INIT};

    assert_ok(test_farm_turn(farm, turn, NULL, &all[0]));
    assert_ok(test_farm_turn(other, turn, NULL, &all[1]));
    for (uint32_t i = 0; i < farm->count; i++) {
        assert_int_equal(all[0].scenes[i].incomplete, PCCD_COMPLETE);
        assert_memory_equal(all[0].scenes[i].hash, all[1].scenes[i].hash, 16);
        assert_true(all[0].scenes[i].total > 0);
    }
    pccd_batch_release(farm->client, &all[0]);
    pccd_batch_release(other->client, &all[1]);
}

static uint32_t count_incomplete(const struct pccd_batch_answer *answer, uint32_t why)
{
    uint32_t count = 0;

    for (uint64_t i = 0; i < answer->count; i++) {
        count += answer->scenes[i].incomplete == why;
        assert_true(answer->scenes[i].incomplete == why ||
                    answer->scenes[i].incomplete == PCCD_COMPLETE);
        assert_int_equal(answer->scenes[i].status, 0);
    }
    assert_int_equal(count, answer->incomplete);
    return count;
}

/* If it failed, a batch whose time is over would go on, lose what it had, or leave scenes
 * where nobody knows. */
CASE(deadline__cuts_what_is_not_done)
{
    struct pccd_client *clients[2] = {open_client(test_shared.url),
                                      open_client(test_shared.url)};
    struct pccd_step_settings settings = PCCD_STEP_SETTINGS_INIT;
    struct pccd_batch_answer answer = PCCD_BATCH_ANSWER_INIT;
    struct test_farm farm, other;
    uint64_t whole_ns;
    uint32_t late = 0;

    make_farm(clients[0], 200, 24, &farm);
    make_farm(clients[1], 200, 24, &other);
    for (uint32_t turn = 1; turn <= 2; turn++) {
        check_places(&farm, &other, turn);
    }
    assert_ok(test_farm_turn(&farm, 3, NULL, &answer));
    whole_ns = answer.queue_ns + answer.batch_ns;
    pccd_batch_release(clients[0], &answer);
    assert_ok(test_farm_turn(&other, 3, NULL, &answer));
    pccd_batch_release(clients[1], &answer);
    /* Half of the time, or less where this machine has become slower. */
    for (uint32_t turn = 4; turn < 20 && (late == 0 || late == 200); turn++) {
        settings.deadline_ns = late == 200 ? 2 * whole_ns : whole_ns / 2;
        whole_ns = settings.deadline_ns;
        assert_ok(test_farm_turn(&farm, turn, &settings, &answer));
        late = count_incomplete(&answer, PCCD_INCOMPLETE_DEADLINE);
        pccd_batch_release(clients[0], &answer);
        assert_ok(test_farm_turn(&other, turn, NULL, &answer));
        pccd_batch_release(clients[1], &answer);
        if (late > 0 && late < 200) {
            check_places(&farm, &other, turn + 1);
        }
    }
    assert_true(late > 0 && late < 200);
    settings.deadline_ns = 1; /* before anything: all are moved, and nothing is found */
    assert_ok(test_farm_turn(&farm, 20, &settings, &answer));
    assert_int_equal(count_incomplete(&answer, PCCD_INCOMPLETE_DEADLINE), 200);
    pccd_batch_release(clients[0], &answer);
    test_farm_free(&farm);
    test_farm_free(&other);
    pccd_close(clients[0]);
    pccd_close(clients[1]);
}

/* If it failed, a batch that nobody wants any more would take its time. */
CASE(cancel__ends_a_batch_soon)
{
    struct pccd_client *client = open_client(test_shared.url);
    struct pccd_batch_answer answer = PCCD_BATCH_ANSWER_INIT;
    struct test_farm farm;
    uint64_t step = 0;

    make_farm(client, 200, 24, &farm);
    assert_ok(test_farm_turn(&farm, 1, NULL, &answer));
    pccd_batch_release(client, &answer);
    assert_ok(test_farm_submit(&farm, 2, NULL, &step));
    assert_ok(pccd_cancel(client, step));
    assert_ok(pccd_batch_wait(client, step, -1, &answer));
    assert_true(count_incomplete(&answer, PCCD_INCOMPLETE_CANCELLED) > 0);
    pccd_batch_release(client, &answer);
    assert_ok(test_farm_submit(&farm, 3, NULL, &step));
    pccd_abandon(client, step);
    assert_ok(test_farm_turn(&farm, 4, NULL, &answer));
    assert_int_equal(answer.scenes[0].number, 4);
    assert_int_equal(answer.incomplete, 0);
    pccd_batch_release(client, &answer);
    test_farm_free(&farm);
    pccd_close(client);
}

/* If it failed, somebody with a large batch would keep everybody else waiting. */
CASE(others__are_served_beside_a_long_batch)
{
    struct pccd_client *clients[2] = {open_client(test_shared.url),
                                      open_client(test_shared.url)};
    struct pccd_batch_answer answer = PCCD_BATCH_ANSWER_INIT;
    struct pccd_answer alone = PCCD_ANSWER_INIT;
    struct test_farm farm, small;
    uint64_t step = 0;
    uint32_t served = 0;

    make_farm(clients[0], 300, 30, &farm);
    make_farm(clients[1], 1, 4, &small);
    assert_ok(test_farm_submit(&farm, 1, NULL, &step));
    while (pccd_batch_wait(clients[0], step, 0, &answer) == PCCD_E_AGAIN) {
        served++;
        assert_ok(test_farm_alone(&small, 0, served, NULL, &alone));
        pccd_answer_release(clients[1], &alone);
    }
    assert_int_equal(answer.failed, 0);
    assert_true(served >= 3);
    pccd_batch_release(clients[0], &answer);
    test_farm_free(&farm);
    test_farm_free(&small);
    pccd_close(clients[0]);
    pccd_close(clients[1]);
}

/* ---- what others see --------------------------------------------------------------- */

/* A scene as it is listed, beside its answer. */
struct listing {
    const struct test_farm *farm;
    const struct pccd_batch_answer *answer;
    uint32_t seen;
};

static void check_listed(void *context, const struct pccd_scene_info *info)
{
    struct listing *listing = context;
    for (uint32_t i = 0; i < listing->farm->count; i++) {
        const struct pccd_scene_answer *scene = &listing->answer->scenes[i];
        if (info->scene == listing->farm->worlds[i].scene) {
            assert_int_equal(info->steps, 1);
            assert_int_equal(info->total, scene->total);
            assert_memory_equal(info->hash, scene->hash, sizeof info->hash);
            assert_int_equal(info->ns_step, scene->ns_step);
            listing->seen++;
        }
    }
}

/* Progress of a session's batch, as it is listed. */
struct progress {
    uint64_t session;
    uint32_t batch, done;
};

static void take_progress(void *context, const struct pccd_session_info *info)
{
    struct progress *progress = context;
    if (info->session == progress->session) {
        progress->batch = info->batch;
        progress->done = info->batch_done;
    }
}

/* By name; a value of each thread is added to the others. */
struct thread_values {
    uint64_t threads, batch, number, ns_step, scenes, tests;
};

static void take_value(void *context, const char *name, uint64_t value, const char *text)
{
    struct thread_values *values = context;
    (void)text;
#define TAKE(field)                                                                      \
    if (strcmp(name, #field) == 0) {                                                     \
        values->field = value;                                                           \
    }
    TAKE(threads)
    TAKE(batch)
    TAKE(number)
    TAKE(ns_step)
#undef TAKE
    values->scenes += strcmp(name, "scenes") == 0 ? value : 0;
    values->tests += strcmp(name, "tests") == 0 ? value : 0;
}

/* If it failed, somebody who looks why a daemon is busy would see a step that was made
 * long before, or nothing, while threads are at a batch. */
CASE(batch__is_what_threads_are_seen_to_do)
{
    struct pccd_client *client = open_client(test_shared.url);
    struct pccd_client *other = open_client(test_shared.url);
    struct pccd_batch_answer answer = PCCD_BATCH_ANSWER_INIT;
    struct pccd_answer alone = PCCD_ANSWER_INIT;
    struct thread_values values = {.threads = 0};
    struct progress progress = {.session = 0};
    struct pccd_daemon_info self;
    struct test_farm farm;
    uint64_t step = 0;
    uint32_t seen = 0, last = 0;

    make_farm(client, 300, 30, &farm);
    assert_ok(test_farm_alone(&farm, 0, 1, NULL, &alone));
    pccd_answer_release(client, &alone);
    assert_ok(pccd_daemon(client, &self));
    progress.session = self.session;
    assert_ok(test_farm_submit(&farm, 2, NULL, &step));
    while (pccd_batch_wait(client, step, 0, &answer) == PCCD_E_AGAIN) {
        assert_ok(pccd_list_sessions(other, take_progress, &progress));
        if (progress.batch != 0) {
            assert_int_equal(progress.batch, 300);
            assert_in_range(progress.done, last, 300);
            seen += progress.done > last && progress.done < 300;
            last = progress.done;
        }
    }
    assert_true(seen > 0);
    assert_ok(pccd_list_sessions(other, take_progress, &progress));
    assert_int_equal(progress.batch, 0);
    assert_ok(pccd_stats_thread(client, false, 0, take_value, &values, NULL));
    assert_int_equal(values.batch, 300);
    assert_int_equal(values.threads, answer.threads);
    assert_int_equal(values.ns_step, answer.batch_ns);
    for (uint32_t i = 1; i < answer.threads; i++) {
        assert_ok(pccd_stats_thread(client, true, i, take_value, &values, NULL));
    }
    assert_int_equal(values.scenes, 300); /* each by one thread */
    assert_true(values.tests > 0);
    pccd_batch_release(client, &answer);
    assert_ok(test_farm_alone(&farm, 0, 3, NULL, &alone));
    pccd_answer_release(client, &alone);
    values.batch = 1;
    assert_ok(pccd_stats_thread(client, false, 0, take_value, &values, NULL));
    assert_int_equal(values.batch, 0);
    test_farm_free(&farm);
    pccd_close(other);
    pccd_close(client);
}

/* If it failed, lists and watchers would not know of steps that a batch makes. */
CASE(steps__of_a_batch_are_listed_and_watched)
{
    struct pccd_client *client = open_client(test_shared.url);
    struct pccd_client *other = open_client(test_shared.url);
    struct pccd_batch_answer answer = PCCD_BATCH_ANSWER_INIT;
    struct pccd_daemon_info self;
    struct pccd_step_event event;
    struct test_farm farm;
    uint64_t number = 0;

    make_farm(client, 5, SIDE, &farm);
    assert_ok(pccd_daemon(client, &self));
    assert_ok(pccd_watch_start(other, self.session, 0));
    assert_ok(test_farm_turn(&farm, 1, NULL, &answer));
    for (uint32_t i = 0; i < farm.count; i++) {
        assert_ok(pccd_watch_next(other, -1, &event));
        assert_int_equal(event.session, self.session);
        assert_int_equal(event.scene, farm.worlds[i].scene);
        assert_int_equal(event.step, answer.step + i);
        assert_int_equal(event.status, 0);
        assert_int_equal(event.total, answer.scenes[i].total);
        assert_memory_equal(event.hash, answer.scenes[i].hash, sizeof event.hash);
        assert_true(event.number > number);
        number = event.number;
    }
    struct listing listing = {.farm = &farm, .answer = &answer};
    assert_ok(pccd_list_scenes(client, 0, check_listed, &listing));
    assert_int_equal(listing.seen, farm.count);
    pccd_batch_release(client, &answer);
    test_farm_free(&farm);
    pccd_close(other);
    pccd_close(client);
}

/* Otherwise who watches would see a step that fails alone, and none of a batch's. */
CASE(batch__that_fails_is_watched_scene_by_scene)
{
    struct pccd_client *client = NULL;
    struct pccd_client *other = open_client(test_shared.url);
    struct pccd_batch_answer held = PCCD_BATCH_ANSWER_INIT;
    struct pccd_batch_answer answer = PCCD_BATCH_ANSWER_INIT;
    struct pccd_daemon_info self;
    struct pccd_step_event event;
    struct test_farm farm;

    client = test_client(
        &(struct pccd_options){.url = test_shared.url, .result_bytes = 65536});
    make_farm(client, 100, 2, &farm);
    assert_ok(test_farm_turn(&farm, 1, NULL, &held));
    assert_ok(pccd_daemon(client, &self));
    assert_ok(pccd_watch_start(other, self.session, 0));
    assert_int_equal(test_farm_turn(&farm, 2, NULL, &answer), PCCD_E_BUSY);
    for (uint32_t i = 0; i < farm.count; i++) {
        assert_ok(pccd_watch_next(other, 10000, &event));
        assert_int_equal(event.session, self.session);
        assert_int_equal(event.scene, farm.worlds[i].scene);
        assert_int_equal(event.step, held.step + farm.count + i);
        assert_int_equal(event.status, PCCD_E_BUSY);
        assert_int_equal(event.number, 0);
        assert_int_equal(event.total, 0);
    }
    pccd_batch_release(client, &held);
    test_farm_free(&farm);
    pccd_close(other);
    pccd_close(client);
}

CASES_WITH_DAEMON("--threads", "2");
