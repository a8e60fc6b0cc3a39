/* test_int_reconnect.c - clients that outlive their daemon. */
#include "cases.h"

#include <signal.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "crossing.h"
#include "daemon.h"
#include "grid.h"
#include "must.h"

#define SIDE  40u
#define DEPTH 3u /* steps in flight */

static const char *const supervised[] = {"--supervise",   "--threads", "1",
                                         "--crashes-max", "1000",      NULL};

/* Two clients that do the same: the daemon of one is killed, that of the other is not. */
struct fixture {
    struct test_daemon daemon;
    struct test_daemon calm;
    struct pccd_client *client;
    struct pccd_client *other;
};

static struct fixture fixture;

static int setup(void **state)
{
    (void)state;
    memset(&fixture, 0, sizeof fixture);
    if (!test_daemon_start(&fixture.daemon, supervised) ||
        !test_daemon_start(&fixture.calm, supervised + 1)) {
        return -1;
    }
    fixture.client = test_connect(fixture.daemon.url);
    fixture.other = test_connect(fixture.calm.url);
    return fixture.client != NULL && fixture.other != NULL ? 0 : -1;
}

static int teardown(void **state)
{
    (void)state;
    pccd_close(fixture.client);
    pccd_close(fixture.other);
    (void)test_daemon_end(&fixture.daemon, SIGTERM, 10000);
    (void)test_daemon_finish(&fixture.daemon);
    return test_daemon_finish(&fixture.calm) ? 0 : -1;
}

static void kill_worker(struct pccd_client *client)
{
    assert_int_equal(kill((pid_t)pccd_daemon_pid(client), SIGKILL), 0);
}

/* From another process, `ms` from now; to be waited for. */
static pid_t kill_worker_later(struct pccd_client *client, unsigned ms)
{
    pid_t victim = (pid_t)pccd_daemon_pid(client);
    pid_t killer = fork();

    assert_true(killer >= 0);
    if (killer == 0) {
        test_sleep_ms(ms);
        _exit(kill(victim, SIGKILL) == 0 ? 0 : 1);
    }
    return killer;
}

/* Wait for a step of each client; both answers must have the same bytes. */
static void expect_same(struct pccd_client *a, uint64_t step_a, struct pccd_client *b,
                        uint64_t step_b)
{
    struct pccd_answer of_a = PCCD_ANSWER_INIT;
    struct pccd_answer of_b = PCCD_ANSWER_INIT;
    int status = pccd_wait(a, step_a, -1, &of_a);

    if (status != 0) {
        fail_msg("step %llu: %s", (unsigned long long)step_a, pccd_error_text(a));
    }
    assert_ok(pccd_wait(b, step_b, -1, &of_b));
    assert_int_equal(of_a.status, 0);
    assert_int_equal(of_a.step, step_a);
    assert_int_equal(of_a.incomplete, PCCD_COMPLETE);
    assert_true(of_a.total > 0);
    assert_int_equal(of_a.total, of_b.total);
    assert_int_equal(of_a.count, of_b.count);
    assert_int_equal(of_a.hash[0], of_b.hash[0]);
    assert_int_equal(of_a.hash[1], of_b.hash[1]);
    assert_memory_equal(of_a.contacts, of_b.contacts, of_a.count * sizeof *of_a.contacts);
    pccd_answer_release(a, &of_a);
    pccd_answer_release(b, &of_b);
}

/* A turn of both grids, waited for. */
static void turn_both(struct test_grid *a, struct test_grid *b)
{
    uint64_t step_a = 0;
    uint64_t step_b = 0;

    assert_ok(test_grid_submit(a, NULL, &step_a));
    assert_ok(test_grid_submit(b, NULL, &step_b));
    expect_same(a->client, step_a, b->client, step_b);
}

static void make_both(struct test_grid *a, struct test_grid *b, uint32_t side)
{
    assert_ok(test_grid_make(fixture.client, side, a));
    assert_ok(test_grid_make(fixture.other, side, b));
    assert_int_equal(a->object, b->object);
}

/* If it failed, an idle client would have lost all it registered when the daemon dies. */
CASE_WITH(reconnect__goes_on_after_a_kill_while_idle, setup, teardown)
{
    struct test_grid a;
    struct test_grid b;

    make_both(&a, &b, SIDE);
    kill_worker(fixture.client); /* registered, and nothing has moved yet */
    for (int i = 0; i < 6; i++) {
        turn_both(&a, &b);
        turn_both(&a, &b); /* x1 begins where the last step ended */
        kill_worker(fixture.client);
    }
    assert_ok(pccd_ping(fixture.client, NULL));
    assert_int_equal(test_link(fixture.client).reconnects, 7);
    assert_int_equal(test_link(fixture.client).resumed, 0);
    assert_int_equal(test_link(fixture.other).reconnects, 0);
    test_grid_free(&a);
    test_grid_free(&b);
}

/* If it failed, steps in flight at a crash would be lost, answered twice or in another
 * order, or begin from the wrong place. */
CASE_WITH(reconnect__answers_steps_in_flight_once, setup, teardown)
{
    struct test_grid a;
    struct test_grid b;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    uint64_t steps_a[DEPTH];
    uint64_t steps_b[DEPTH];

    make_both(&a, &b, SIDE);
    for (unsigned round = 0; round < 12; round++) {
        pid_t killer = kill_worker_later(fixture.client, round % 6);

        for (unsigned i = 0; i < DEPTH; i++) {
            assert_ok(test_grid_submit(&a, NULL, &steps_a[i]));
            assert_ok(test_grid_submit(&b, NULL, &steps_b[i]));
        }
        for (unsigned i = 0; i < DEPTH; i++) {
            expect_same(fixture.client, steps_a[i], fixture.other, steps_b[i]);
        }
        assert_int_equal(pccd_poll(fixture.client, &answer), PCCD_E_AGAIN);
        assert_int_equal(waitpid(killer, NULL, 0), killer);
    }
    turn_both(&a, &b);
    assert_true(test_link(fixture.client).reconnects >= 1);
    assert_true(test_link(fixture.client).resent >= 1);
    print_message("# %llu reconnects, %llu requests sent again, the last gap %llu us\n",
                  (unsigned long long)test_link(fixture.client).reconnects,
                  (unsigned long long)test_link(fixture.client).resent,
                  (unsigned long long)test_link(fixture.client).gap_ns / 1000);
    test_grid_free(&a);
    test_grid_free(&b);
}

/* To as many as two steps need, beside the one that keeps the last positions: a daemon
 * that is stopped gives none. */
static void give_slots_memory(struct test_grid *grid)
{
    uint64_t steps[3];

    for (int i = 0; i < 3; i++) {
        assert_ok(test_grid_submit(grid, NULL, &steps[i]));
    }
    for (int i = 0; i < 3; i++) {
        assert_ok(test_grid_await(grid, steps[i]));
    }
}

/* Submit two steps, and kill the four daemons that they are given to. False: the first
 * was done before a kill, as on a busy machine, and is answered. */
static bool give_to_four_daemons(struct test_grid *grid, uint64_t steps[2])
{
    uint64_t before;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    int status = PCCD_E_AGAIN;
    int refused;

    give_slots_memory(grid);
    before = test_link(fixture.client).reconnects;
    assert_int_equal(kill((pid_t)pccd_daemon_pid(fixture.client), SIGSTOP), 0);
    refused = test_grid_submit(grid, NULL, &steps[0]);
    refused += test_grid_submit(grid, NULL, &steps[1]);
    for (uint64_t daemons = 1; daemons <= 3 && status != 0; daemons++) {
        kill_worker(fixture.client);
        while (test_link(fixture.client).reconnects < before + daemons && status != 0) {
            status = pccd_poll(fixture.client, &answer);
            assert_true(status == PCCD_E_AGAIN || (status == 0 && daemons > 1));
        }
    }
    assert_int_equal(refused, 0);
    if (status != 0) {
        kill_worker(fixture.client);
        status = pccd_wait(fixture.client, steps[0], -1, &answer);
    }
    if (status == 0) {
        pccd_answer_release(fixture.client, &answer);
        return false;
    }
    assert_int_equal(status, PCCD_E_DISCONNECTED);
    assert_non_null(strstr(pccd_error_text(fixture.client), "daemon after daemon"));
    return true;
}

/* If it failed, a step over which the daemon crashes would be given to one daemon after
 * the other, until the supervisor gives up and all other clients are without. */
CASE_WITH(reconnect__gives_up_a_step_that_ends_every_daemon, setup, teardown)
{
    struct test_grid grid;
    uint64_t steps[2];
    int attempts = 0;

    /* Large: a step must not be done between its submission and the kill. */
    assert_ok(test_grid_make(fixture.client, 300, &grid));
    for (bool is_over = false; !is_over; attempts++) {
        assert_true(attempts < 20);
        is_over = give_to_four_daemons(&grid, steps);
        assert_ok(test_grid_await(&grid, steps[1])); /* the one behind it */
    }
    assert_ok(test_grid_submit(&grid, NULL, &steps[1]));
    assert_ok(test_grid_await(&grid, steps[1]));
    test_grid_free(&grid);
}

/* If it failed, a crash during registration would leave half a mesh, or an error. */
CASE_WITH(reconnect__registers_through_a_kill, setup, teardown)
{
    struct test_grid grid;

    for (unsigned round = 0; round < 6; round++) {
        pid_t killer = kill_worker_later(fixture.client, 2 * round);

        assert_ok(test_grid_make(fixture.client, 60, &grid));
        assert_int_equal(waitpid(killer, NULL, 0), killer);
        test_grid_pass(&grid);
        killer = kill_worker_later(fixture.client, round);
        assert_ok(test_grid_replace(&grid));
        assert_int_equal(waitpid(killer, NULL, 0), killer);
        test_grid_pass(&grid);
        assert_ok(pccd_scene_destroy(fixture.client, grid.scene));
        test_grid_free(&grid);
    }
    assert_int_equal(test_link(fixture.client).reconnects, 12);
    assert_int_equal(test_stat_await(fixture.client, "objects_now", 0), 0);
}

/* If it failed, positions of parts, of both formats or of rigid bodies would come back
 * wrong, and contacts with them. */
CASE_WITH(reconnect__brings_every_kind_of_position_back, setup, teardown)
{
    const double still[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    const double turned[12] = {0.8, -0.6, 0, 0.1, 0.6, 0.8, 0, -0.3, 0, 0, 1, -2.1};
    struct test_crossing scenes[2];
    struct pccd_client *clients[2] = {fixture.client, fixture.other};

    for (int i = 0; i < 2; i++) {
        assert_ok(test_crossing_make(clients[i], &scenes[i]));
    }
    for (unsigned round = 0; round < 16; round++) {
        uint64_t steps[2];

        for (int i = 0; i < 2; i++) {
            const double z = round % 2 == 0 ? -1.0 / 3 : 1.0 / 3;
            const double *from = round % 4 == 0 ? still : turned;
            const double *to = round % 4 == 0 ? turned : still;
            struct pccd_frame frame;
            double x64[3] = {0.1, 0.2, z};
            float x32[2][3] = {{1, 0, (float)z}, {0, 1, (float)z}};
            void *x1 = NULL;

            assert_ok(pccd_frame_begin(clients[i], scenes[i].scene, 2, 300, &frame));
            if (round % 4 < 2) { /* of the whole object; two rounds later in parts */
                assert_ok(pccd_frame_rigid(&frame, scenes[i].object, 0, 3, from, to));
            } else {
                assert_ok(
                    pccd_frame_x1(&frame, scenes[i].object, PCCD_FORMAT_F64, 0, 1, &x1));
                memcpy(x1, x64, sizeof x64);
                if (round % 8 == 2) {
                    assert_ok(
                        pccd_frame_rigid(&frame, scenes[i].object, 1, 2, still, turned));
                } else {
                    assert_ok(pccd_frame_x1(&frame, scenes[i].object, PCCD_FORMAT_F32, 1,
                                            2, &x1));
                    memcpy(x1, x32, sizeof x32);
                }
            }
            assert_ok(pccd_frame_commit(&frame, NULL, &steps[i]));
        }
        expect_same(clients[0], steps[0], clients[1], steps[1]);
        if (round % 3 != 1) {
            kill_worker(clients[0]);
        }
    }
    assert_true(test_link(fixture.client).reconnects >= 8);
}

/* If it failed, a frame being written or an answer being read would change, or be gone,
 * under its user. */
CASE_WITH(reconnect__keeps_what_the_user_holds, setup, teardown)
{
    struct test_grid a;
    struct test_grid b;
    struct pccd_answer held = PCCD_ANSWER_INIT;
    struct pccd_frame frame;
    struct pccd_contact *copy;
    uint64_t steps[2];
    void *x1 = NULL;

    make_both(&a, &b, SIDE);
    assert_ok(test_grid_submit(&a, NULL, &steps[0]));
    assert_ok(test_grid_submit(&b, NULL, &steps[1]));
    assert_ok(pccd_wait(fixture.client, steps[0], -1, &held));
    copy = test_copy(held.contacts, held.count * sizeof *copy);
    /* Half before, half after: the pointer must lead to the memory of the new daemon. */
    assert_ok(pccd_frame_begin(fixture.client, a.scene, 1, a.vertex_count * sizeof *a.x,
                               &frame));
    assert_ok(pccd_frame_x1(&frame, a.object, PCCD_FORMAT_F32, 0, a.vertex_count, &x1));
    test_grid_positions(&a, -a.z);
    memcpy(x1, a.x, a.vertex_count / 2 * sizeof *a.x);
    kill_worker(fixture.client);
    assert_ok(pccd_ping(fixture.client, NULL));
    assert_int_equal(test_link(fixture.client).reconnects, 1);
    memcpy((float(*)[3])x1 + a.vertex_count / 2, a.x + a.vertex_count / 2,
           (a.vertex_count - a.vertex_count / 2) * sizeof *a.x);
    assert_ok(pccd_frame_commit(&frame, NULL, &steps[0]));
    a.z = -a.z;
    assert_ok(pccd_wait(fixture.other, steps[1], -1, &(struct pccd_answer){0}));
    assert_ok(test_grid_submit(&b, NULL, &steps[1]));
    expect_same(fixture.client, steps[0], fixture.other, steps[1]);
    assert_memory_equal(held.contacts, copy, held.count * sizeof *copy);
    pccd_answer_release(fixture.client, &held);
    for (int i = 0; i < 20; i++) { /* and pages are given back to the right region */
        turn_both(&a, &b);
    }
    free(copy);
    test_grid_free(&a);
    test_grid_free(&b);
}

/* If it failed, objects of a mesh that was destroyed, or those left when others went,
 * would not come back, or under other handles. */
CASE_WITH(reconnect__brings_back_what_is_left, setup, teardown)
{
    struct test_crossing scenes[2];
    struct pccd_client *clients[2] = {fixture.client, fixture.other};
    uint32_t spare = 0;

    for (int i = 0; i < 2; i++) {

        uint32_t gone = test_scene(clients[i]);
        assert_ok(test_crossing_make(clients[i], &scenes[i]));
        assert_ok(pccd_scene_destroy(clients[i], gone));
        for (int j = 0; j < 5; j++) {
            spare = test_object(clients[i], scenes[i].scene, scenes[i].floor_mesh);
            assert_ok(pccd_scene_remove(clients[i], scenes[i].scene, scenes[i].floor));
            scenes[i].floor = spare;
        }
        assert_ok(pccd_mesh_destroy(clients[i], scenes[i].floor_mesh));
        assert_true(test_crossing_turn(&scenes[i]));
    }
    for (int round = 0; round < 3; round++) {
        kill_worker(fixture.client);
        assert_true(test_crossing_turn(&scenes[0]));
        assert_true(test_crossing_turn(&scenes[1]));
        assert_int_equal(pccd_mesh_destroy(fixture.client, scenes[0].floor_mesh),
                         PCCD_E_HANDLE);
    }
    assert_int_equal(test_stat(fixture.client, "objects_now"), 2);
    assert_int_equal(test_stat(fixture.client, "scenes_now"), 1);
}

/* If it failed, a connection that is cut would cost what a crash costs, or a step. */
CASE_WITH(reconnect__resumes_after_a_cut, setup, teardown)
{
    struct test_grid a;
    struct test_grid b;
    uint32_t pid = pccd_daemon_pid(fixture.client);
    uint64_t steps_a[DEPTH];
    uint64_t steps_b[DEPTH];

    make_both(&a, &b, SIDE);
    for (unsigned round = 0; round < 10; round++) {
        for (unsigned i = 0; i < DEPTH; i++) {
            assert_ok(test_grid_submit(&a, NULL, &steps_a[i]));
            assert_ok(test_grid_submit(&b, NULL, &steps_b[i]));
            if (i == round % (DEPTH + 1)) {
                test_sleep_ms(round % 3);
                assert_int_equal(shutdown(pccd_fd(fixture.client), SHUT_RDWR), 0);
            }
        }
        for (unsigned i = 0; i < DEPTH; i++) {
            expect_same(fixture.client, steps_a[i], fixture.other, steps_b[i]);
        }
    }
    assert_int_equal(pccd_daemon_pid(fixture.client), pid);
    assert_true(test_link(fixture.client).reconnects >= 7);
    assert_int_equal(test_link(fixture.client).resumed,
                     test_link(fixture.client).reconnects);
    assert_int_equal(test_stat(fixture.client, "steps"), 10 * DEPTH);
    assert_int_equal(test_stat(fixture.client, "sessions_now"), 1);
    test_grid_free(&a);
    test_grid_free(&b);
}

/* If it failed, a program with a loop of its own would wait in poll, or never be told. */
CASE_WITH(reconnect__works_by_polling, setup, teardown)
{
    struct test_grid a;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    uint64_t step = 0;
    uint64_t until_ms = test_now_ms() + 10000;
    int fd = pccd_fd(fixture.client);
    int status;

    assert_ok(test_grid_make(fixture.client, SIDE, &a));
    assert_ok(test_grid_submit(&a, NULL, &step));
    kill_worker(fixture.client);
    do {
        status = pccd_poll(fixture.client, &answer);
    } while (status == PCCD_E_AGAIN && test_now_ms() < until_ms);
    assert_int_equal(status, 0);
    assert_int_equal(answer.step, step);
    assert_true(test_grid_is_right(&a, &answer));
    assert_int_equal(pccd_fd(fixture.client), fd);
    pccd_answer_release(fixture.client, &answer);
    test_grid_free(&a);
}

/* If it failed, programs with a daemon of their own would end with it. */
CASE_WITH(reconnect__starts_a_private_daemon_again, setup, teardown)
{
    struct test_crossing crossing;
    uint32_t pid;

    struct pccd_client *client = test_client(&(struct pccd_options){
        .private_daemon = true, .daemon = getenv("PCCDD"), .result_bytes = 65536});
    assert_ok(test_crossing_make(client, &crossing));
    for (int i = 0; i < 3; i++) {
        assert_true(test_crossing_turn(&crossing));
        pid = pccd_daemon_pid(client);
        kill_worker(client);
        assert_true(test_crossing_turn(&crossing));
        assert_int_not_equal(pccd_daemon_pid(client), pid);
    }
    pid = pccd_daemon_pid(client);
    pccd_close(client);
    assert_int_equal(kill((pid_t)pid, 0), -1);
}

/* If it failed, a caller that wants to know of the loss would not hear of it, or one
 * whose daemon never comes back would wait for ever and not know why. */
CASE_WITH(reconnect__ends_with_the_patience, setup, teardown)
{
    struct pccd_client *client = NULL;
    struct test_daemon daemon;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    struct test_grid grid;
    uint64_t begin_ms;
    uint64_t step = 0;

    assert_true(test_daemon_start(&daemon, NULL));
    client = test_client(&(struct pccd_options){.url = daemon.url, .reconnect_ms = 300});
    struct pccd_client *once = test_connect_once(daemon.url);
    assert_non_null(once);
    assert_ok(test_grid_make(client, SIDE, &grid));
    assert_ok(test_grid_submit(&grid, NULL, &step));
    (void)test_daemon_end(&daemon, SIGKILL, 5000);
    assert_int_equal(pccd_ping(once, NULL), PCCD_E_DISCONNECTED);
    begin_ms = test_now_ms();
    /* The answer may have come before the end. */
    if (pccd_wait(client, step, 20, &answer) == PCCD_E_TIMEOUT) {
        assert_int_equal(pccd_wait(client, step, -1, &answer), PCCD_E_DISCONNECTED);
        assert_int_equal(answer.status, PCCD_E_DISCONNECTED);
    }
    assert_int_equal(pccd_ping(client, NULL), PCCD_E_DISCONNECTED);
    assert_true(test_now_ms() - begin_ms >= 250);
    assert_non_null(strstr(pccd_error_text(client), "tries"));
    assert_int_equal(pccd_ping(client, NULL), PCCD_E_DISCONNECTED);
    pccd_close(client);
    pccd_close(once);
    test_grid_free(&grid);
    (void)test_daemon_finish(&daemon);
}

/* If it failed, a client that keeps nothing would be told that all is well when what it
 * registered is gone; or it could not even go on with its session. */
CASE_WITH(reconnect__without_copies_resumes_only, setup, teardown)
{
    struct test_crossing crossing;

    struct pccd_client *client =
        test_client(&(struct pccd_options){.url = fixture.daemon.url, .no_keep = true});
    assert_ok(test_crossing_make(client, &crossing));
    assert_int_equal(shutdown(pccd_fd(client), SHUT_RDWR), 0);
    assert_true(test_crossing_turn(&crossing));
    assert_int_equal(test_link(client).resumed, 1);
    kill_worker(client);
    assert_int_equal(pccd_ping(client, NULL), PCCD_E_DISCONNECTED);
    assert_non_null(strstr(pccd_error_text(client), "nothing was kept"));
    pccd_close(client);
}
