/* test_int_resume.c - sessions that outlive their connections, seen from the wire. */
#include "cases.h"

#include <signal.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "crossing.h"
#include "daemon.h"
#include "must.h"
#include "raw.h"

/* A raw client with a scene: a floor, and a triangle that passes through it. */
struct fixture {
    struct test_daemon daemon;
    struct test_raw raw;
    struct proto_HELLO_result session;
    struct test_raw_crossing scene;
};

static struct fixture fixture;

static int start(const char *const *options)
{
    return test_daemon_start(&fixture.daemon, options) ? 0 : -1;
}

static int setup(void **state)
{
    (void)state;
    return start((const char *const[]){"--threads", "1", "--linger", "2", NULL});
}

static int setup_alone(void **state)
{
    (void)state;
    return start((const char *const[]){"--threads", "1", "--clients-max", "1", NULL});
}

static int teardown(void **state)
{
    (void)state;
    return test_daemon_finish(&fixture.daemon) ? 0 : -1;
}

/* Another connection, and hello with the secret over it. The mappings stay. Returns
 * whether the session goes on. */
static bool come_back(struct fixture *f)
{
    struct proto_HELLO_result result;
    assert_true(test_raw_reopen(&f->raw, f->daemon.socket));
    assert_ok(test_raw_hello_again(&f->raw, &f->session, &result));
    assert_int_equal(result.epoch, f->session.epoch);
    return result.resumed && result.session == f->session.session;
}

static void lose(struct fixture *f)
{
    (void)close(f->raw.socket);
    f->raw.socket = -1;
}

/* A name: it is shared; "": not. */
static void open_named(struct fixture *f, const char *name)
{
    assert_true(test_raw_open(&f->raw, f->daemon.socket));
    assert_ok(test_raw_hello_again(&f->raw, NULL, &f->session));
    assert_false(f->session.resumed);
    assert_true((f->session.token_hi | f->session.token_lo) != 0);
    assert_true(f->session.linger_ms > 0);
    assert_ok(test_raw_attach(&f->raw, 2, 4096));
    assert_ok(test_raw_build(&f->raw, name, test_triangle_x, &f->scene));
}

static void open_scene(struct fixture *f)
{
    open_named(f, "");
}

/* Write a turn of the triangle to height z into a slot. */
static struct proto_FRAME_SUBMIT_request turn(struct fixture *f, uint32_t slot, float z)
{
    return test_raw_turn(&f->raw, slot, &f->scene, z);
}

/* Send a request under an id that was used before. */
static void say_again(struct fixture *f, uint32_t id, int method, const void *request)
{
    assert_ok(proto_encode_request(&f->raw.encoder, id, method, request));
    assert_true(test_raw_send(&f->raw, f->raw.encoder.data, f->raw.encoder.bytes, 0));
}

/* A counter of the daemon, over a connection of its own. */
static uint64_t counter(const char *name)
{
    struct pccd_client *client = test_client_at(fixture.daemon.url);
    uint64_t value;
    value = test_stat(client, name);
    pccd_close(client);
    return value;
}

static uint64_t await_counter(const char *name, uint64_t value)
{
    uint64_t until_ms = test_now_ms() + 10000;
    uint64_t seen = counter(name);
    while (seen != value && test_now_ms() < until_ms) {
        test_sleep_ms(20);
        seen = counter(name);
    }
    return seen;
}

/* If it failed, a connection that is cut would cost a client its meshes. */
CASE_WITH(resume__goes_on_with_everything, setup, teardown)
{
    struct fixture *f = &fixture;
    struct proto_FRAME_SUBMIT_result answer;
    open_scene(f);
    for (int i = 0; i < 4; i++) {
        struct proto_FRAME_SUBMIT_request request = turn(f, 0, i % 2 == 0 ? -1.0f : 1.0f);
        assert_ok(test_raw_call(&f->raw, PROTO_METHOD_FRAME_SUBMIT, &request, &answer));
        assert_int_equal(answer.total, 3);
        test_raw_release(&f->raw, answer.release);
        lose(f);
        assert_true(come_back(f));
    }
    assert_int_equal(counter("sessions_resumed"), 4);
    test_raw_close(&f->raw);
}

/* If it failed, a step whose answer was lost would move the objects twice, or never be
 * answered. */
CASE_WITH(resume__runs_what_is_said_twice_once, setup, teardown)
{
    struct fixture *f = &fixture;
    struct proto_FRAME_SUBMIT_request first;
    struct proto_FRAME_SUBMIT_request second;
    struct proto_FRAME_SUBMIT_result answers[2];
    struct proto_FRAME_SUBMIT_result again;
    uint64_t steps = counter("steps");
    uint32_t ids[2];
    open_scene(f);
    first = turn(f, 0, -1.0f);
    second = turn(f, 1, 1.0f);
    ids[0] = test_raw_request(&f->raw, PROTO_METHOD_FRAME_SUBMIT, &first);
    assert_ok(test_raw_answer(&f->raw, ids[0], PROTO_METHOD_FRAME_SUBMIT, &answers[0]));
    ids[1] = test_raw_request(&f->raw, PROTO_METHOD_FRAME_SUBMIT, &second);
    lose(f); /* while the second is in flight, most likely; its answer is not read */
    assert_true(come_back(f));
    for (int i = 0; i < 2; i++) { /* also what was answered: as if that had been lost */
        say_again(f, ids[0], PROTO_METHOD_FRAME_SUBMIT, &first);
        say_again(f, ids[1], PROTO_METHOD_FRAME_SUBMIT, &second);
        assert_ok(test_raw_answer(&f->raw, ids[0], PROTO_METHOD_FRAME_SUBMIT, &again));
        assert_memory_equal(&again, &answers[0], sizeof again);
        assert_ok(
            test_raw_answer(&f->raw, ids[1], PROTO_METHOD_FRAME_SUBMIT, &answers[1]));
        assert_int_equal(answers[1].total, 3);
    }
    assert_true(answers[1].release > answers[0].release);
    assert_int_equal(counter("steps"), steps + 2);
    test_raw_close(&f->raw);
}

/* If it failed, an answer that was sent over a connection that is lost would count as
 * had. */
CASE_WITH(resume__tells_again_what_nobody_has_read, setup, teardown)
{
    struct fixture *f = &fixture;
    struct proto_FRAME_SUBMIT_result answer;
    open_scene(f);
    for (int i = 0; i < 100; i++) {
        struct proto_FRAME_SUBMIT_request request = turn(f, 0, i % 2 == 0 ? -1.0f : 1.0f);
        request.method = PCCD_METHOD_PAPER; /* not the loop's */
        uint32_t id = test_raw_request(&f->raw, PROTO_METHOD_FRAME_SUBMIT, &request);
        for (int spin = 0; spin < i * 20000; spin++) { /* until it is answered */
            __asm__ volatile("");
        }
        lose(f);
        assert_true(come_back(f));
        say_again(f, id, PROTO_METHOD_FRAME_SUBMIT, &request);
        assert_ok(test_raw_answer(&f->raw, id, PROTO_METHOD_FRAME_SUBMIT, &answer));
        assert_int_equal(answer.total, 3);
        test_raw_release(&f->raw, answer.release);
    }
    test_raw_close(&f->raw);
}

/* If it failed, the answer to a later step could come before that to an earlier one, and
 * pages would be released in another order than they were written. */
CASE_WITH(resume__answers_only_what_is_asked_again, setup, teardown)
{
    struct fixture *f = &fixture;
    struct proto_FRAME_SUBMIT_request requests[2];
    struct proto_FRAME_SUBMIT_result answers[2];
    uint32_t ids[2];
    char byte;
    open_scene(f);
    for (int round = 0; round < 10; round++) {
        for (uint32_t i = 0; i < 2; i++) {
            requests[i] = turn(f, i, i == 0 ? -1.0f : 1.0f);
            ids[i] = test_raw_request(&f->raw, PROTO_METHOD_FRAME_SUBMIT, &requests[i]);
        }
        lose(f);
        assert_true(come_back(f));
        test_sleep_ms(20); /* whatever is in flight is computed */
        assert_true(recv(f->raw.socket, &byte, 1, MSG_DONTWAIT | MSG_PEEK) < 0);
        for (uint32_t i = 0; i < 2; i++) {
            say_again(f, ids[i], PROTO_METHOD_FRAME_SUBMIT, &requests[i]);
        }
        for (uint32_t i = 0; i < 2; i++) {
            assert_ok(test_raw_receive(&f->raw));
            assert_int_equal(f->raw.envelope.id, ids[i]);
            assert_ok(proto_decode_body(&f->raw.envelope,
                                        &proto_messages[PROTO_METHOD_FRAME_SUBMIT].result,
                                        &answers[i], &f->raw.error));
            assert_int_equal(answers[i].total, 3);
        }
        assert_true(answers[1].release > answers[0].release);
        test_raw_release(&f->raw, answers[1].release);
    }
    test_raw_close(&f->raw);
}

/* The step that the daemon tells of as held. */
static uint64_t await_held(struct fixture *f)
{
    struct proto_SCENE_HELD_request note = {.step = 0};
    struct proto_error error;
    do {
        assert_ok(test_raw_receive(&f->raw));
    } while (f->raw.envelope.method != PROTO_NOTE_SCENE_HELD);
    assert_ok(proto_decode_body(
        &f->raw.envelope, &proto_messages[PROTO_NOTE_SCENE_HELD].request, &note, &error));
    assert_int_equal(note.scene, f->scene.scene);
    return note.step;
}

/* If it failed, who waits for a frame to be held would wait for ever when that was told
 * over a connection that was lost. */
CASE_WITH(resume__tells_again_what_is_held, setup, teardown)
{
    struct fixture *f = &fixture;
    struct proto_FRAME_SUBMIT_request submit;
    struct proto_FRAME_SUBMIT_result answer;
    open_named(f, "held");
    submit = turn(f, 0, -1);
    submit.hold = true;
    submit.step = 7;
    assert_int_not_equal(test_raw_request(&f->raw, PROTO_METHOD_FRAME_SUBMIT, &submit),
                         0);
    assert_int_equal(await_held(f), 7);
    for (int i = 0; i < 2; i++) {
        lose(f);
        assert_int_equal(await_counter("sessions_waiting_now", 1), 1);
        assert_true(come_back(f));
        assert_int_equal(await_held(f), 7);
    }
    assert_ok(
        RAW_CALL(&f->raw, FRAME_SUBMIT, &answer, .scene = f->scene.scene, .step = 8));
    assert_true(answer.total > 0); /* it went along, and is not told any more */
    lose(f);
    assert_int_equal(await_counter("sessions_waiting_now", 1), 1);
    assert_true(come_back(f));
    test_raw_wait_ms = 200;
    assert_int_equal(test_raw_receive(&f->raw), PCCD_E_TIMEOUT);
    test_raw_wait_ms = 10000;
    test_raw_close(&f->raw);
}

/* If it failed, requests that are answered at once would be done twice. */
CASE_WITH(resume__creates_once, setup, teardown)
{
    struct fixture *f = &fixture;
    struct proto_MESH_CREATE_request create = {.vertex_count = 3, .triangle_count = 1};
    struct proto_MESH_CREATE_result made;
    struct proto_MESH_CREATE_result again;
    uint64_t meshes = counter("meshes_now");
    uint32_t id;
    open_scene(f);
    id = test_raw_request(&f->raw, PROTO_METHOD_MESH_CREATE, &create);
    assert_ok(test_raw_answer(&f->raw, id, PROTO_METHOD_MESH_CREATE, &made));
    lose(f);
    assert_true(come_back(f));
    say_again(f, id, PROTO_METHOD_MESH_CREATE, &create);
    assert_ok(test_raw_answer(&f->raw, id, PROTO_METHOD_MESH_CREATE, &again));
    assert_int_equal(again.mesh, made.mesh);
    assert_int_equal(counter("meshes_now"), meshes + 3);
    test_raw_close(&f->raw);
}

/* If it failed, any process of the user could take a session over by counting. */
CASE_WITH(resume__needs_the_secret, setup, teardown)
{
    struct fixture *f = &fixture;
    struct proto_HELLO_result wrong;
    struct proto_HELLO_result other;
    struct test_raw thief;
    open_scene(f);
    lose(f);
    for (int bit = 0; bit < 4; bit++) {
        wrong = f->session;
        wrong.token_hi ^= bit == 0;
        wrong.token_lo ^= bit == 1 ? 1ull << 63 : 0;
        wrong.session += bit == 2;
        wrong.epoch ^= bit == 3;
        assert_true(test_raw_open(&thief, f->daemon.socket));
        assert_ok(test_raw_hello_again(&thief, &wrong, &other));
        assert_false(other.resumed);
        assert_int_not_equal(other.session, f->session.session);
        assert_true(other.token_hi != f->session.token_hi ||
                    other.token_lo != f->session.token_lo);
        test_raw_close(&thief);
    }
    assert_true(come_back(f)); /* and is not disturbed */
    test_raw_close(&f->raw);
}

/* If it failed, a client that finds its connection dead would have to wait until the
 * daemon finds out, too. */
CASE_WITH(resume__takes_the_session_from_a_connection_that_stands, setup, teardown)
{
    struct fixture *f = &fixture;
    struct proto_FRAME_SUBMIT_request request;
    struct proto_FRAME_SUBMIT_result answer;
    struct test_raw old;
    open_scene(f);
    old = f->raw;
    f->raw.socket = -1; /* and `old` stands */
    assert_true(come_back(f));
    old.decoder = proto_decoder_new();
    assert_int_equal(test_raw_receive(&old), PCCD_E_DISCONNECTED);
    proto_decoder_free(old.decoder);
    (void)close(old.socket);
    request = turn(f, 0, -1.0f);
    assert_ok(test_raw_call(&f->raw, PROTO_METHOD_FRAME_SUBMIT, &request, &answer));
    assert_int_equal(answer.total, 3);
    test_raw_close(&f->raw);
}

/* If it failed, what clients left behind would be kept for ever. */
CASE_WITH(resume__comes_too_late_after_the_linger, setup, teardown)
{
    struct fixture *f = &fixture;
    open_scene(f);
    lose(f);
    assert_int_equal(await_counter("sessions_waiting_now", 1), 1);
    assert_int_equal(await_counter("sessions_waiting_now", 0), 0);
    assert_int_equal(await_counter("meshes_now", 0), 0);
    assert_int_equal(await_counter("shm_bytes_now", 0), 0);
    assert_false(come_back(f));
    test_raw_close(&f->raw);
}

/* If it failed, a client that closes would block its user's quotas for seconds. */
CASE_WITH(resume__is_over_after_bye, setup, teardown)
{
    struct fixture *f = &fixture;
    open_scene(f);
    assert_ok(RAW_CALL(&f->raw, BYE, NULL, .reserved = 0));
    lose(f);
    assert_false(come_back(f));
    test_raw_close(&f->raw);
}

/* If it failed, what a killed client had would be charged until the time is up, and ten
 * thousand kills would exhaust the quotas. */
CASE_WITH(resume__does_not_wait_for_the_dead, setup, teardown)
{
    uint64_t begin_ms;
    pid_t child;
    assert_int_equal(await_counter("sessions_waiting_now", 0), 0);
    child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        open_scene(&fixture);
        (void)kill(getpid(), SIGKILL);
    }
    assert_int_equal(waitpid(child, NULL, 0), child);
    begin_ms = test_now_ms();
    assert_int_equal(await_counter("meshes_now", 0), 0);
    assert_true(test_now_ms() - begin_ms < 1500); /* of 2000 */
}

/* If it failed, a user with as many clients as may be would be locked out by one that is
 * gone, or come back in vain. */
CASE_WITH(resume__gives_way_to_a_new_client_at_the_quota, setup_alone, teardown)
{
    struct fixture *f = &fixture;
    struct proto_HELLO_result other;
    struct test_raw raw;
    open_scene(f);
    lose(f);
    assert_true(come_back(f)); /* beyond the quota until it has its own session back */
    assert_true(test_raw_open(&raw, f->daemon.socket));
    assert_int_equal(test_raw_hello_again(&raw, NULL, &other), PCCD_E_QUOTA);
    test_raw_close(&raw);
    lose(f);
    test_sleep_ms(50);
    assert_true(test_raw_open(&raw, f->daemon.socket));
    assert_ok(test_raw_hello_again(&raw, NULL, &other));
    assert_true(test_raw_reopen(&f->raw, f->daemon.socket));
    assert_int_equal(test_raw_hello_again(&f->raw, &f->session, &other), PCCD_E_QUOTA);
    test_raw_close(&raw);
    test_raw_close(&f->raw);
}

/* If it failed, who watches would hear of a step that was made while its connection was
 * lost only when another is made, perhaps never. */
CASE_WITH(resume__tells_of_steps_that_were_watched, setup, teardown)
{
    struct fixture *f = &fixture;
    struct proto_STATS_result stats = {0};
    struct proto_FRAME_SUBMIT_request step;
    struct test_raw watcher;
    struct proto_HELLO_result session, again;
    open_scene(f);
    assert_true(test_raw_open(&watcher, f->daemon.socket));
    assert_ok(test_raw_hello_again(&watcher, NULL, &session));
    assert_ok(RAW_CALL(&watcher, WATCH_START, NULL, .session = 0));
    (void)close(watcher.socket);
    watcher.socket = -1;
    while (stats.sessions_waiting_now == 0) { /* until it has been noticed */
        assert_ok(RAW_CALL(&f->raw, STATS, &stats, .reserved = 0));
    }
    step = turn(f, 0, -1.0f);
    assert_ok(test_raw_call(&f->raw, PROTO_METHOD_FRAME_SUBMIT, &step, NULL));
    assert_true(test_raw_reopen(&watcher, f->daemon.socket));
    assert_ok(test_raw_hello_again(&watcher, &session, &again));
    assert_true(again.resumed);
    assert_ok(test_raw_receive(&watcher));
    assert_int_equal(watcher.envelope.kind, PROTO_NOTIFICATION);
    assert_int_equal(watcher.envelope.method, PROTO_NOTE_STEP);
    test_raw_close(&watcher);
    test_raw_close(&f->raw);
}

/* If it failed, a client could not make anew, under its old handles, what a daemon that
 * died had; or could have tables of any size made for nothing. */
CASE_WITH(resume__handles_can_be_wanted, setup, teardown)
{
    struct fixture *f = &fixture;
    const uint32_t scene = 7u << 20 | 3, object = 5u << 20 | 2;
    const uint32_t meshes[2] = {9u << 20 | 1500, 9u << 20 | 300000}; /* far above */
    struct proto_SCENE_CREATE_result made;
    struct proto_MESH_CREATE_result mesh_made;
    struct proto_SCENE_ADD_result added;
    struct proto_STATS_result before, after;
    open_scene(f);
    assert_ok(RAW_CALL(&f->raw, SCENE_CREATE, &made, .want = scene));
    assert_int_equal(made.scene, scene);
    assert_int_equal(RAW_CALL(&f->raw, SCENE_CREATE, &made, .want = scene),
                     PCCD_E_HANDLE);
    /* No handle has generation 0. */
    assert_int_equal(RAW_CALL(&f->raw, SCENE_CREATE, &made, .want = 4), PCCD_E_HANDLE);
    /* A place that was left empty. */
    assert_ok(RAW_CALL(&f->raw, SCENE_CREATE, &made, .want = 0));
    assert_int_equal(made.scene & 0xfffff, 1);
    for (int i = 0; i < 2; i++) {
        assert_int_equal(RAW_CALL(&f->raw, SCENE_ADD, &added, .scene = scene,
                                  .mesh = f->scene.mesh, .want = object),
                         i == 0 ? 0 : PCCD_E_HANDLE);
        assert_int_equal(added.object, object);
    }
    for (int i = 0; i < 2; i++) {
        assert_ok(RAW_CALL(&f->raw, STATS, &before, .reserved = 0));
        assert_ok(RAW_CALL(&f->raw, MESH_CREATE, &mesh_made, .vertex_count = 3,
                           .triangle_count = 1, .want = meshes[i]));
        assert_int_equal(mesh_made.mesh, meshes[i]);
    }
    assert_ok(RAW_CALL(&f->raw, STATS, &after, .reserved = 0));
    assert_true(after.engine_bytes_now - before.engine_bytes_now >= 298500 * 24);
    test_raw_close(&f->raw);
}
