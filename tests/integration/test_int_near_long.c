/* test_int_near_long.c - questions about what is near that end early, or whose daemon
 * does. */
#include "cases.h"

#include <signal.h>
#include <unistd.h>

#include "crossing.h"
#include "daemon.h"
#include "grid.h"
#include "must.h"
#include "raw.h"

#define SIDE        250u /* a step of 20 ms and more; its slot is copied: 750 KB */
#define SIDE_SMALL  40u
#define SIDE_CRASH  100u
#define MS          1000000u
#define GENEROUS_MS 2000 /* the aim is 2 ms, of a machine that is left alone */
#define RING        200u /* two of that size: a second, and more */
#define PI          3.14159265358979323846
#define FAR         1e18 /* everything is within it */

typedef struct pccd_near_settings settings_t;

static const settings_t defaults = PCCD_NEAR_SETTINGS_INIT;

static struct test_daemon daemon_;
static struct pccd_client *client;
static struct test_grid grid;

static void start_with(const char *const *options, uint32_t side)
{
    assert_true(test_daemon_start(&daemon_, options));
    client = test_client(&(struct pccd_options){
        .url = daemon_.url, .timeout_ms = 60000, .result_bytes = 32u << 20});
    assert_ok(test_grid_make(client, side, &grid));
}

static int teardown(void **state)
{
    (void)state;
    pccd_close(client);
    client = NULL;
    test_grid_free(&grid);
    grid.x = NULL;
    return test_daemon_finish(&daemon_) ? 0 : -1;
}

/* Return the motion of the grid's whole way to height z. */
static struct pccd_motion motion_to(float z)
{
    test_grid_positions(&grid, z);
    return (struct pccd_motion){.object = grid.object,
                                .count = grid.vertex_count,
                                .format = PCCD_FORMAT_F32,
                                .x1 = grid.x};
}

static void expect_nothing(uint64_t step, enum pccd_incomplete why)
{
    struct pccd_answer answer = PCCD_ANSWER_INIT;

    assert_ok(pccd_wait(client, step, -1, &answer));
    assert_true(answer.is_near);
    assert_int_equal(answer.incomplete, why);
    assert_int_equal(answer.total, 0);
    assert_int_equal(answer.verdict, PCCD_VERDICT_NONE);
    assert_true(answer.distance_min == 2e18 && answer.distance_max == 0);
}

/* ---- ends -------------------------------------------------------------------------- */

/* If it failed, who shares the daemon with long steps would be answered when it is of no
 * use any more; or what was to move with the question would be lost. */
CASE_WITH(near__is_answered_at_its_deadline_and_cancel, NULL, teardown)
{
    settings_t settings = defaults;
    uint64_t before[2];
    uint64_t asked[2];
    uint64_t after = 0;

    start_with(NULL, SIDE);
    for (uint32_t moves = 0; moves < 2; moves++) {
        for (uint32_t cancels = 0; cancels < 2; cancels++) {
            const float from = grid.z;
            settings.deadline_ns = cancels ? 0 : MS;
            assert_ok(test_grid_submit(&grid, NULL, &before[0]));
            assert_ok(test_grid_submit(&grid, NULL, &before[1]));
            /* The way of one turn, so that the next one is as the others. */
            const struct pccd_motion motion = motion_to(-grid.z);
            assert_ok(pccd_submit_near(client, grid.scene, &motion, moves, &settings,
                                       &asked[0]));
            assert_ok(
                pccd_submit_near(client, grid.scene, NULL, 0, &settings, &asked[1]));
            for (uint32_t i = 0; i < 2; i++) {
                if (cancels) {
                    assert_ok(pccd_cancel(client, asked[i]));
                }
                expect_nothing(asked[i], cancels ? PCCD_INCOMPLETE_CANCELLED
                                                 : PCCD_INCOMPLETE_DEADLINE);
            }
            struct pccd_answer answer = PCCD_ANSWER_INIT;
            assert_int_equal(pccd_wait(client, before[1], 0, &answer), PCCD_E_AGAIN);
            assert_true(grid.z == from);
            grid.z = moves ? -grid.z : grid.z;
            assert_ok(test_grid_submit(&grid, NULL, &after));
            test_grid_expect(&grid, before[0]);
            test_grid_expect(&grid, before[1]);
            test_grid_expect(&grid, after);
        }
    }
    assert_int_equal(test_stat(client, "slots_stale"), 0);
    assert_int_equal(test_stat(client, "nears"), 8);
    assert_int_equal(test_stat(client, "nears_incomplete"), 8);
}

/* If it failed, a question that nobody can wait for would go on computing. */
CASE_WITH(near__ends_while_it_computes, NULL, teardown)
{
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    settings_t settings = defaults;
    uint64_t step = 0;
    uint64_t begin_ms;

    start_with(NULL, SIDE);
    settings.distance = FAR; /* 10^10 pairs */
    settings.deadline_ns = 50 * MS;
    begin_ms = test_now_ms();
    assert_ok(pccd_ask_near(client, grid.scene, NULL, 0, &settings, &answer));
    assert_true(test_now_ms() - begin_ms < GENEROUS_MS);
    assert_true(answer.incomplete == PCCD_INCOMPLETE_DEADLINE ||
                answer.incomplete == PCCD_INCOMPLETE_CONTACT_LIMIT);
    pccd_answer_release(client, &answer);
    settings.what = PCCD_NEAR_VERTICES; /* none of which is proved then */
    assert_ok(pccd_ask_near(client, grid.scene, NULL, 0, &settings, &answer));
    assert_int_equal(answer.incomplete, PCCD_INCOMPLETE_DEADLINE);
    assert_int_equal(answer.total, 0);
    settings.deadline_ns = 0;
    assert_ok(pccd_submit_near(client, grid.scene, NULL, 0, &settings, &step));
    test_sleep_ms(50);
    begin_ms = test_now_ms();
    assert_ok(pccd_cancel(client, step));
    assert_ok(pccd_wait(client, step, -1, &answer));
    assert_true(test_now_ms() - begin_ms < GENEROUS_MS);
    assert_int_equal(answer.incomplete, PCCD_INCOMPLETE_CANCELLED);
    /* What the daemon lets anybody compute. */
    assert_ok(pccd_config_set(client, "step-max-ms", "50"));
    begin_ms = test_now_ms();
    assert_ok(pccd_ask_near(client, grid.scene, NULL, 0, &settings, &answer));
    assert_true(test_now_ms() - begin_ms < GENEROUS_MS);
    assert_int_equal(answer.incomplete, PCCD_INCOMPLETE_DEADLINE);
    assert_int_equal(test_stat(client, "nears_incomplete"), 4);
}

/* A closed ring of RING x RING vertices, of that thickness. */
static uint32_t add_ring(uint32_t scene, double thickness)
{
    double(*x)[3] = malloc(RING * RING * sizeof *x);
    uint32_t(*faces)[3] = malloc(2 * RING * RING * sizeof *faces);

    assert_true(x != NULL && faces != NULL);
    for (uint32_t i = 0; i < RING * RING; i++) {
        uint32_t a = i / RING;
        uint32_t b = i % RING;
        double along = 2 * PI * a / RING;
        double around = 2 * PI * b / RING;
        double radius = 1 + thickness * cos(around);
        uint32_t corner[4] = {i, (a + 1) % RING * RING + b,
                              (a + 1) % RING * RING + (b + 1) % RING,
                              a * RING + (b + 1) % RING};
        memcpy(
            x[i],
            (double[]){radius * cos(along), radius * sin(along), thickness * sin(around)},
            sizeof x[i]);
        memcpy(faces[2 * i], (uint32_t[]){corner[0], corner[1], corner[2]},
               sizeof *faces);
        memcpy(faces[2 * i + 1], (uint32_t[]){corner[0], corner[2], corner[3]},
               sizeof *faces);
    }
    uint32_t mesh =
        test_mesh(client, x, PCCD_FORMAT_F64, RING * RING, faces, 2 * RING * RING);
    uint32_t object = test_object(client, scene, mesh);
    free(x);
    free(faces);
    return object;
}

/* If it failed, a question about two bodies that are everywhere as near could hold a
 * daemon up for seconds, and so all who share it. */
CASE_WITH(near__of_objects_ends_while_it_computes, NULL, teardown)
{
    static const enum pccd_near_what whats[2] = {PCCD_NEAR_NEAREST, PCCD_NEAR_DEPTH};
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    settings_t settings = defaults;
    uint64_t step = 0;
    uint64_t begin_ms;

    start_with(NULL, SIDE_SMALL);
    uint32_t scene = test_scene(client);
    (void)add_ring(scene, .5);
    (void)add_ring(scene, .25); /* in the first, with the same middle */
    settings.distance = INFINITY;
    for (uint32_t i = 0; i < 4; i++) {
        settings.what = whats[i / 2];
        settings.threads = 1 + i % 2;
        settings.deadline_ns = 10 * MS;
        begin_ms = test_now_ms();
        assert_ok(pccd_ask_near(client, scene, NULL, 0, &settings, &answer));
        assert_true(test_now_ms() - begin_ms < GENEROUS_MS);
        assert_int_equal(answer.incomplete, PCCD_INCOMPLETE_DEADLINE);
        assert_true(answer.total < RING * RING); /* of DEPTH there would be so many */
        pccd_answer_release(client, &answer);
        settings.deadline_ns = 0;
        assert_ok(pccd_submit_near(client, scene, NULL, 0, &settings, &step));
        test_sleep_ms(10);
        begin_ms = test_now_ms();
        assert_ok(pccd_cancel(client, step));
        assert_ok(pccd_wait(client, step, -1, &answer));
        assert_true(test_now_ms() - begin_ms < GENEROUS_MS);
        assert_int_equal(answer.incomplete, PCCD_INCOMPLETE_CANCELLED);
        pccd_answer_release(client, &answer);
    }
    assert_int_equal(test_stat(client, "nears_incomplete"), 8);
    /* And whole they are long, or nothing was ended here. */
    begin_ms = test_now_ms();
    assert_ok(pccd_ask_near(client, scene, NULL, 0, &settings, &answer));
    print_message("# depth in %u ms\n", (unsigned)(test_now_ms() - begin_ms));
    assert_int_equal(answer.incomplete, PCCD_COMPLETE);
    assert_int_equal(answer.total, RING * RING);
    pccd_answer_release(client, &answer);
}

/* If it failed, what is kept of too many records would be left to chance. */
CASE_WITH(near__keeps_the_first_records_at_the_limit, NULL, teardown)
{
    struct pccd_answer whole = PCCD_ANSWER_INIT;
    struct pccd_answer cut = PCCD_ANSWER_INIT;
    settings_t settings = defaults;

    start_with(NULL, SIDE_SMALL);
    settings.distance = 0.08;
    assert_ok(pccd_ask_near(client, grid.scene, NULL, 0, &settings, &whole));
    assert_int_equal(whole.incomplete, PCCD_COMPLETE);
    assert_true(whole.total > 4000);
    assert_ok(pccd_config_set(client, "contacts-max", "2000"));
    for (uint32_t threads = 1; threads < 3; threads++) {
        settings.threads = threads;
        assert_ok(pccd_ask_near(client, grid.scene, NULL, 0, &settings, &cut));
        assert_int_equal(cut.incomplete, PCCD_INCOMPLETE_CONTACT_LIMIT);
        assert_int_equal(cut.total, 2000);
        assert_int_equal(cut.count, 2000);
        assert_memory_equal(cut.near, whole.near, 2000 * sizeof *cut.near);
        pccd_answer_release(client, &cut);
    }
    pccd_answer_release(client, &whole);
}

/* If it failed, records of questions would be memory that nobody is charged for. */
CASE_WITH(near__is_bounded_by_the_users_memory, NULL, teardown)
{
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    settings_t settings = defaults;
    uint64_t least;
    int status;

    start_with((const char *const[]){"--memory-max-mib", "24", NULL}, SIDE_SMALL);
    least = test_stat(client, "engine_bytes_now");
    settings.distance = FAR;
    for (int i = 0; i < 4; i++) {
        status = pccd_ask_near(client, grid.scene, NULL, 0, &settings, &answer);
        if (status == 0) {
            assert_int_equal(answer.incomplete, PCCD_INCOMPLETE_CONTACT_LIMIT);
            pccd_answer_release(client, &answer);
        } else {
            assert_int_equal(status, PCCD_E_QUOTA);
        }
        assert_true(test_stat(client, "engine_bytes_now") <= least + (24u << 20));
    }
    settings.distance = 0.02; /* and what fits is whole */
    assert_ok(pccd_ask_near(client, grid.scene, NULL, 0, &settings, &answer));
    assert_int_equal(answer.incomplete, PCCD_COMPLETE);
    assert_true(answer.total > 1000);
    pccd_answer_release(client, &answer);
}

/* ---- a daemon that ends ------------------------------------------------------------ */

static const char *const supervised[] = {"--supervise", "--crashes-max", "1000", NULL};

static void kill_worker(void)
{
    assert_int_equal(kill((pid_t)pccd_daemon_pid(client), SIGKILL), 0);
}

/* A page of many, with what it says. */
static void ask_whole(const struct pccd_motion *motion, const settings_t *settings,
                      struct pccd_answer *answer)
{
    assert_ok(
        pccd_ask_near(client, grid.scene, motion, motion != NULL, settings, answer));
    assert_int_equal(answer->incomplete, PCCD_COMPLETE);
    assert_int_equal(answer->count, answer->total);
    assert_true(answer->total > 1000);
}

/* If it failed, a crash would cost a client its question, or change the answer. */
CASE_WITH(near__has_the_same_bytes_after_a_crash, NULL, teardown)
{
    struct pccd_answer before = PCCD_ANSWER_INIT;
    struct pccd_answer after = PCCD_ANSWER_INIT;
    struct pccd_link_info info;
    settings_t settings = defaults;
    uint64_t step = 0;

    start_with(supervised, SIDE_CRASH);
    settings.distance = 0.0085; /* of a grid whose vertices are 0.01 apart */
    for (uint32_t moves = 0; moves < 2; moves++) {
        struct pccd_motion motion = motion_to(0.02f);
        ask_whole(&motion, &settings, &before);
        if (moves) { /* back, and the same way once more */
            motion = motion_to(0.4f);
            ask_whole(&motion, &settings, &after);
            pccd_answer_release(client, &after);
            motion = motion_to(0.02f);
        }
        assert_ok(pccd_submit_near(client, grid.scene, &motion, moves, &settings, &step));
        test_sleep_ms(2); /* it computes, most likely */
        kill_worker();
        assert_ok(pccd_wait(client, step, -1, &after));
        assert_int_equal(after.total, before.total);
        assert_memory_equal(after.near, before.near, before.count * sizeof *before.near);
        assert_memory_equal(after.hash, before.hash, sizeof before.hash);
        pccd_answer_release(client, &before);
        pccd_answer_release(client, &after);
    }
    assert_ok(pccd_link(client, &info));
    assert_true(info.reconnects >= 2);
}

/* If it failed, another daemon, which was not told where a step began, would answer about
 * its end in the place of its beginning. */
CASE_WITH(near__knows_no_beginning_after_a_crash, NULL, teardown)
{
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    settings_t settings = defaults;
    uint64_t step = 0;

    start_with(supervised, SIDE_SMALL);
    settings.at_begin = true;
    settings.distance = 0.05;
    kill_worker();
    ask_whole(NULL, &settings, &answer); /* nothing has moved: as registered */
    pccd_answer_release(client, &answer);
    struct pccd_motion motion = motion_to(0.1f);
    assert_ok(pccd_step(client, grid.scene, &motion, 1, NULL, &answer));
    pccd_answer_release(client, &answer);
    kill_worker();
    assert_int_equal(pccd_ask_near(client, grid.scene, NULL, 0, &settings, &answer),
                     PCCD_E_STATE);
    assert_non_null(strstr(pccd_error_text(client), "is not known"));
    settings.at_begin = false;
    ask_whole(NULL, &settings, &answer);
    pccd_answer_release(client, &answer);
    settings.at_begin = true;
    for (uint32_t asks = 0; asks < 2; asks++) { /* from the next step on it is */
        motion = motion_to(asks ? 0.1f : 0.2f);
        if (asks) {
            ask_whole(&motion, &settings, &answer);
        } else {
            assert_ok(pccd_step(client, grid.scene, &motion, 1, NULL, &answer));
        }
        pccd_answer_release(client, &answer);
        ask_whole(NULL, &settings, &answer);
        pccd_answer_release(client, &answer);
        kill_worker();
        assert_ok(pccd_submit_still(client, grid.scene, NULL, &step));
        assert_ok(pccd_wait(client, step, -1, &answer));
        pccd_answer_release(client, &answer);
        ask_whole(NULL, &settings, &answer);
        pccd_answer_release(client, &answer);
    }
}

/* ---- seen from the wire ------------------------------------------------------------ */

static struct test_raw raw;

/* If it failed, a question whose answer was lost would be answered about another moment,
 * or move the scene twice. */
CASE_WITH(near__is_answered_once_over_a_connection_that_is_lost, NULL, teardown)
{
    struct proto_HELLO_result session;
    struct proto_HELLO_result again;
    struct proto_SCENE_NEAR_request asked[2] = {
        {.what = PCCD_NEAR_PAIRS, .end = 1, .distance = 1, .step = 1},
        {.what = PCCD_NEAR_PAIRS, .distance = 1, .step = 2, .segments = 1}};
    struct proto_SCENE_NEAR_result answers[2];
    struct proto_SCENE_NEAR_result repeated;
    struct test_raw_crossing scene;
    uint32_t ids[2];

    start_with((const char *const[]){"--linger", "5", NULL}, 2);
    assert_true(test_raw_open(&raw, daemon_.socket));
    assert_int_equal(test_raw_hello_again(&raw, NULL, &session), 0);
    assert_ok(test_raw_attach(&raw, 2, 4096));
    assert_ok(test_raw_build(&raw, "", test_triangle_x, &scene));
    asked[0].scene = asked[1].scene = scene.scene;
    /* Its beginning is within 1, its end is not. */
    asked[1].seq = test_raw_turn(&raw, 0, &scene, 3).seq;
    for (uint32_t i = 0; i < 2; i++) {
        ids[i] = test_raw_request(&raw, PROTO_METHOD_SCENE_NEAR, &asked[i]);
    }
    assert_ok(test_raw_answer(&raw, ids[0], PROTO_METHOD_SCENE_NEAR, &answers[0]));
    assert_int_equal(answers[0].total, 3);
    for (int turn = 0; turn < 2; turn++) {
        (void)close(raw.socket);
        assert_true(test_raw_reopen(&raw, daemon_.socket));
        assert_int_equal(test_raw_hello_again(&raw, &session, &again), 0);
        assert_true(again.resumed);
        for (uint32_t i = 0; i < 2; i++) {
            assert_ok(proto_encode_request(&raw.encoder, ids[i], PROTO_METHOD_SCENE_NEAR,
                                           &asked[i]));
            assert_true(test_raw_send(&raw, raw.encoder.data, raw.encoder.bytes, 0));
            assert_ok(test_raw_answer(&raw, ids[i], PROTO_METHOD_SCENE_NEAR, &repeated));
            assert_int_equal(repeated.total, 3);
            if (i == 0 || turn == 1) {
                assert_memory_equal(&repeated, &answers[i], sizeof repeated);
            }
            answers[i] = repeated;
        }
    }
    assert_true(answers[1].release > answers[0].release);
    assert_int_equal(test_stat(client, "nears"), 2);
    test_raw_close(&raw);
}

/* If it failed, a client could have more in flight than the daemon has promised to
 * take. */
CASE_WITH(near__counts_among_the_steps_in_flight, NULL, teardown)
{
    struct test_raw_crossing scene;
    uint64_t long_step = 0;
    uint32_t ids[3];

    start_with(NULL, SIDE);
    assert_ok(test_raw_session(&raw, daemon_.socket, 2, 4096));
    assert_ok(test_raw_build(&raw, "", test_triangle_x, &scene));
    assert_int_equal(raw.ring.inflight_max, 2);
    assert_ok(test_grid_submit(&grid, NULL, &long_step)); /* before which they wait */
    for (uint32_t i = 0; i < 3; i++) {
        ids[i] = RAW_SEND(&raw, SCENE_NEAR, .scene = scene.scene, .what = PCCD_NEAR_PAIRS,
                          .end = 1);
    }
    assert_int_equal(test_raw_answer(&raw, ids[2], PROTO_METHOD_SCENE_NEAR, NULL),
                     PCCD_E_BUSY);
    assert_non_null(strstr(raw.error.text, "2 steps are in flight"));
    test_grid_expect(&grid, long_step);
    test_raw_close(&raw);
}
