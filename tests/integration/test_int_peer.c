/* test_int_peer.c - the library and a daemon that misbehaves. */
#include "cases.h"

#include <signal.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include "codec.h"
#include "daemon.h"
#include "false_daemon.h"
#include "messages.h"
#include "must.h"
#include "pccd.h"
#include "seqpacket.h"

#define OTHER_USER 65534

/* ---- connecting -------------------------------------------------------------------- */

static void choose_another_version(void)
{
    false_hello(PROTO_VERSION_MAX + 1);
    (void)false_next();
}

/* If it failed, the library would speak a protocol that it does not know. */
CASE_WITH(peer__that_chooses_an_unknown_version_is_left, NULL, false_stop)
{
    struct pccd_client *client = NULL;

    false_start(choose_another_version);
    assert_int_equal(false_connect(&client), PCCD_E_VERSION);
    assert_null(client);
}

static void say_nothing(void)
{
    for (;;) {
        (void)pause();
    }
}

/* If it failed, a daemon that hangs would hang a program that starts. */
CASE_WITH(peer__that_says_nothing_is_a_timeout, NULL, false_stop)
{
    struct pccd_client *client = NULL;
    uint64_t begin_ms = test_now_ms();

    false_start(say_nothing);
    assert_int_equal(false_connect(&client), PCCD_E_TIMEOUT);
    assert_true(test_now_ms() - begin_ms >= FALSE_TIMEOUT_MS);
    assert_true(test_now_ms() - begin_ms < 10 * FALSE_TIMEOUT_MS);
    assert_true(pccd_error_text(NULL)[0] != '\0');
}

static void go_away(void)
{
    struct proto_GOAWAY_request note = {.code = -PCCD_E_SHUTDOWN, .text = "lunch"};

    (void)false_next();
    if (proto_encode_notification(&false_daemon.encoder, PROTO_NOTE_GOAWAY, &note) == 0) {
        (void)proto_send(false_daemon.socket, false_daemon.encoder.data,
                         false_daemon.encoder.bytes, NULL, 0);
    }
}

/* If it failed, the user would not learn why the daemon closed. */
CASE_WITH(peer__that_says_goodbye_is_quoted, NULL, false_stop)
{
    struct pccd_client *client = NULL;

    false_start(go_away);
    assert_int_equal(false_connect(&client), PCCD_E_SHUTDOWN);
    assert_non_null(strstr(pccd_error_text(NULL), "lunch"));
}

static void talk_nonsense(void)
{
    false_hello(PROTO_VERSION_MAX);
    (void)false_next();
    (void)proto_send(false_daemon.socket, "\xdd\xff\xff\xff\xff", 5, NULL, 0);
    (void)false_next();
}

/* If it failed, a malformed answer would crash the program or be waited for. */
CASE_WITH(peer__that_talks_nonsense_is_disconnected, NULL, false_stop)
{
    struct pccd_client *client;

    false_start(talk_nonsense);
    client = false_connect_good();
    assert_int_equal(pccd_ping(client, NULL), PCCD_E_DISCONNECTED);
    assert_int_equal(pccd_ping(client, NULL), PCCD_E_DISCONNECTED);
    pccd_close(client);
}

/* ---- memories ---------------------------------------------------------------------- */

static unsigned lie; /* which of the scripts below */

static void lie_about_memory(void)
{
    struct proto_SHM_ATTACH_result ring = false_good_ring;

    false_hello(PROTO_VERSION_MAX);
    switch (lie) {
    case 0:
        false_attach(ring, 0);
        break;
    case 1:
        false_attach(ring, 1);
        break;
    case 2:
        ring.upload_bytes *= 2;
        false_attach(ring, 2);
        break;
    case 3:
        ring.result_bytes = 1;
        false_attach(ring, 2);
        break;
    case 4:
        ring.slot_count = 17;
        false_attach(ring, 2);
        break;
    case 5:
        ring.slot_count = 0;
        false_attach(ring, 2);
        break;
    case 6:
        ring.slot_stride = UINT64_MAX - 7;
        false_attach(ring, 2);
        break;
    case 7: /* less than was asked for */
        ring.slot_stride = 4096;
        false_attach(ring, 2);
        break;
    case 8:
        ring.slot_stride = 0;
        false_attach(ring, 2);
        break;
    default:
        ring.slot_stride += 8;
        false_attach(ring, 2);
        break;
    }
    (void)false_next();
}

/* If it failed, the library would write or read outside its mappings. */
CASE_WITH(peer__that_lies_about_memory_is_not_believed, NULL, false_stop)
{
    for (lie = 0; lie < 10; lie++) {
        struct pccd_client *client;
        uint64_t step = 0;
        int status;

        false_start(lie_about_memory);
        client = false_connect_good();
        status = pccd_submit_still(client, 1, NULL, &step);
        if (status != PCCD_E_BADMSG) {
            fail_msg("lie %u: status %d \"%s\"", lie, status, pccd_error_text(client));
        }
        pccd_close(client);
        (void)false_stop(NULL);
    }
}

/* ---- answers ----------------------------------------------------------------------- */

static void lie_about_pages(void)
{
    static const struct {
        uint64_t offset;
        uint64_t count;
        uint32_t bytes;
    } pages[] = {
        {0, 1, 64},
        {4088, 1, 64},
        {4100, 1, 64},
        {FALSE_RESULT_BYTES, 1, 64},
        {FALSE_RESULT_BYTES - 56, 1, 64},
        {4096, 1025, 64},
        {4096, UINT64_MAX, 64},
        {UINT64_MAX - 7, 1, 64},
        {4096, 1, 20},
        {4096, 1, 0},
    };

    false_hello(PROTO_VERSION_MAX);
    false_attach(false_good_ring, 2);
    for (size_t i = 0; i < sizeof pages / sizeof pages[0]; i++) {
        (void)false_next();
        false_step(false_daemon.envelope.id, pages[i].offset, pages[i].count,
                   pages[i].bytes);
    }
    (void)false_next();
    false_step(false_daemon.envelope.id, 4096, 1024, 64);
    (void)false_next();
}

/* If it failed, the user would be handed records that lie outside the mapping. */
CASE_WITH(peer__that_lies_about_pages_is_not_believed, NULL, false_stop)
{
    struct pccd_client *client;
    struct pccd_answer answered = PCCD_ANSWER_INIT;
    uint64_t step = 0;

    false_start(lie_about_pages);
    client = false_connect_good();
    for (int i = 0; i < 10; i++) {
        assert_ok(pccd_submit_still(client, 1, NULL, &step));
        assert_int_equal(pccd_wait(client, step, -1, &answered), PCCD_E_BADMSG);
        assert_null(answered.contacts);
        pccd_answer_release(client, &answered);
    }
    test_still(client, 1, NULL, &answered);
    assert_int_equal(answered.count, 1024);
    assert_int_equal(answered.contacts[1023].reserved, 0); /* readable to the end */
    pccd_answer_release(client, &answered);
    pccd_close(client);
}

/* ---- handles ----------------------------------------------------------------------- */

static void give_nothing(void)
{
    const struct proto_SCENE_CREATE_result scene = {.scene = 0}, good = {.scene = 7};
    const struct proto_SCENE_ADD_result object = {.object = 0};
    const struct proto_MESH_CREATE_result mesh = {.mesh = 0};
    const struct proto_SCENE_NEAR_result near = {.what = PCCD_NEAR_PAIRS};

    false_hello(PROTO_VERSION_MAX);
    for (;;) {
        switch (false_next()) {
        case PROTO_METHOD_SHM_ATTACH:
            false_attached(false_good_ring, 2);
            break;
        case PROTO_METHOD_SCENE_CREATE:
            false_answer(false_daemon.envelope.id, PROTO_METHOD_SCENE_CREATE,
                         false_daemon.scenes++ == 0 ? &scene : &good, NULL, 0);
            break;
        case PROTO_METHOD_SCENE_ADD:
            false_answer(false_daemon.envelope.id, PROTO_METHOD_SCENE_ADD, &object, NULL,
                         0);
            break;
        case PROTO_METHOD_MESH_CREATE:
            false_answer(false_daemon.envelope.id, PROTO_METHOD_MESH_CREATE, &mesh, NULL,
                         0);
            break;
        case PROTO_METHOD_SCENE_NEAR:
            false_answer(false_daemon.envelope.id, PROTO_METHOD_SCENE_NEAR, &near, NULL,
                         0);
            break;
        default:
            break;
        }
    }
}

/* If it failed, a daemon could end its user's program by giving the handle 0, or the
 * program would go on with the handle of nothing. */
CASE_WITH(peer__that_gives_no_handle_is_refused, NULL, false_stop)
{
    static const float x[3][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    static const uint32_t triangle[1][3] = {{0, 1, 2}};
    const struct pccd_near_settings settings = PCCD_NEAR_SETTINGS_INIT;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    struct pccd_client *client;
    uint32_t scene = 99, object = 99, mesh = 99;

    false_start(give_nothing);
    client = false_connect_good();
    assert_int_equal(pccd_scene_create(client, NULL, &scene), PCCD_E_BADMSG);
    assert_non_null(strstr(pccd_error_text(client), "gives 0, which is no handle"));
    assert_int_equal(
        pccd_mesh_create(client, x, PCCD_FORMAT_F32, 3, triangle, 1, &mesh, NULL),
        PCCD_E_BADMSG);
    scene = test_scene(client);
    assert_int_equal(scene, 7);
    assert_int_equal(pccd_scene_add(client, scene, 1, &object), PCCD_E_BADMSG);
    assert_int_equal(mesh, 99);
    assert_int_equal(object, 99);
    assert_ok(pccd_ask_near(client, 0, NULL, 0, &settings, &answer));
    pccd_answer_release(client, &answer);
    pccd_close(client);
}

static void answer_backwards(void)
{
    uint32_t ids[4];

    false_hello(PROTO_VERSION_MAX);
    false_attach(false_good_ring, 2);
    for (int i = 0; i < 4; i++) {
        (void)false_next();
        ids[i] = false_daemon.envelope.id;
    }
    for (int i = 3; i >= 0; i--) {
        false_step(ids[i] + 1000, 4096, 1, 64); /* to nobody */
        false_step(ids[i], 4096, (uint64_t)i + 1, 64);
        false_step(ids[i], 4096, 9, 64); /* the same again */
    }
    (void)false_next();
}

/* If it failed, an answer would be taken for another one, or taken twice. */
CASE_WITH(peer__that_answers_in_any_order_is_understood, NULL, false_stop)
{
    struct pccd_client *client;
    struct pccd_answer answered = PCCD_ANSWER_INIT;
    uint64_t steps[4];

    false_start(answer_backwards);
    client = false_connect_good();
    for (int i = 0; i < 4; i++) {
        assert_ok(pccd_submit_still(client, 1, NULL, &steps[i]));
    }
    for (uint64_t i = 0; i < 4; i++) {
        assert_ok(pccd_wait(client, steps[i], -1, &answered));
        assert_int_equal(answered.count, i + 1);
        pccd_answer_release(client, &answered);
    }
    assert_int_equal(pccd_poll(client, &answered), PCCD_E_AGAIN);
    pccd_close(client);
}

static void stop_answering(void)
{
    false_hello(PROTO_VERSION_MAX);
    false_attach(false_good_ring, 2);
    say_nothing();
}

/* If it failed, a client of a daemon that hangs would hang, or take more and more. */
CASE_WITH(peer__that_stops_answering_bounds_what_is_begun, NULL, false_stop)
{
    struct pccd_client *client;
    struct pccd_answer answered = PCCD_ANSWER_INIT;
    uint64_t steps[5];
    uint64_t begin_ms;

    false_start(stop_answering);
    client = false_connect_good();
    for (int i = 0; i < 4; i++) {
        assert_ok(pccd_submit_still(client, 1, NULL, &steps[i]));
    }
    begin_ms = test_now_ms();
    assert_int_equal(pccd_submit_still(client, 1, NULL, &steps[4]), PCCD_E_TIMEOUT);
    assert_int_equal(pccd_wait(client, steps[0], 50, &answered), PCCD_E_TIMEOUT);
    assert_int_equal(pccd_poll(client, &answered), PCCD_E_AGAIN);
    for (int i = 0; i < 3; i++) {
        assert_int_equal(pccd_ping(client, NULL), PCCD_E_TIMEOUT);
    }
    assert_true(test_now_ms() - begin_ms < 20 * FALSE_TIMEOUT_MS);
    assert_int_equal(kill(false_daemon.child, SIGKILL), 0);
    assert_int_equal(pccd_wait(client, steps[3], -1, &answered), PCCD_E_DISCONNECTED);
    pccd_close(client);
}

/* Without a look at who listens, a user who puts a socket where another's daemon will be
 * would be sent that user's meshes. */
CASE(peer__of_another_user_is_not_spoken_to)
{
    struct sockaddr_un address = {.sun_family = AF_UNIX};
    struct pccd_options options;
    struct pccd_client *client = NULL;
    char folder[80];
    char byte;
    int listener;
    int accepted;

    if (geteuid() != 0) {
        test_skip(TEST_ONLY_ROOT);
    }
    (void)snprintf(false_daemon.directory, sizeof false_daemon.directory,
                   "/tmp/pccd-test-XXXXXX");
    assert_non_null(mkdtemp(false_daemon.directory));
    (void)snprintf(folder, sizeof folder, "%s/pccd", false_daemon.directory);
    assert_int_equal(mkdir(folder, 0700), 0);
    (void)snprintf(false_daemon.socket_path, sizeof false_daemon.socket_path,
                   "%s/pccd/pccd.sock", false_daemon.directory);
    (void)snprintf(address.sun_path, sizeof address.sun_path, "%s",
                   false_daemon.socket_path);
    listener = socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0);
    assert_true(listener >= 0);
    assert_ok(bind(listener, (const struct sockaddr *)&address, sizeof address));
    assert_int_equal(seteuid(OTHER_USER), 0);
    assert_int_equal(listen(listener, 4), 0);
    assert_int_equal(seteuid(0), 0);

    assert_int_equal(setenv("XDG_RUNTIME_DIR", false_daemon.directory, 1), 0);
    assert_int_equal(unsetenv("PCCD_URL"), 0);
    pccd_options_init(&options);
    options.timeout_ms = FALSE_TIMEOUT_MS;
    options.no_autostart = true;
    assert_int_equal(pccd_connect(&options, &client), PCCD_E_SYSTEM);
    assert_non_null(strstr(pccd_error_text(NULL), "user 65534"));
    accepted = accept(listener, NULL, NULL);
    assert_true(accepted >= 0);
    assert_int_equal(recv(accepted, &byte, 1, 0), 0); /* closed without a word */
    (void)close(accepted);
    (void)close(listener);
    (void)unlink(false_daemon.socket_path);
    (void)rmdir(folder);
    (void)rmdir(false_daemon.directory);
}

/* ---- coming back ------------------------------------------------------------------- */

/* End over a ping. The next daemon has hello and the ping before it answers either, and
 * refuses both; the third one answers. */
static void refuse_once(void)
{
    struct proto_PING_request ping;
    struct proto_PING_result pong = {.token = 0};
    struct proto_error error = {.code = PCCD_E_BUSY};
    uint32_t ids[2];

    false_hello(PROTO_VERSION_MAX);
    (void)false_next();
    false_take_client();
    for (int i = 0; i < 2; i++) {
        (void)false_next();
        ids[i] = false_daemon.envelope.id;
    }
    for (int i = 0; i < 2; i++) {
        (void)proto_encode_error(&false_daemon.encoder, ids[i], &error);
        (void)proto_send(false_daemon.socket, false_daemon.encoder.data,
                         false_daemon.encoder.bytes, NULL, 0);
    }
    false_take_client();
    false_hello(PROTO_VERSION_MAX);
    (void)false_next();
    (void)proto_decode_body(&false_daemon.envelope,
                            &proto_messages[PROTO_METHOD_PING].request, &ping, &error);
    pong.token = ping.token;
    false_answer(false_daemon.envelope.id, PROTO_METHOD_PING, &pong, NULL, 0);
}

/* If it failed, a thousand clients of a daemon that has crashed would wait for one more
 * round trip of each other; or what was sent behind a hello that is refused would be
 * lost, or have the refusal for its answer. */
CASE_WITH(peer__that_refuses_hello_has_not_answered_what_came_behind, NULL, false_stop)
{
    struct pccd_link_info info;

    false_start(refuse_once);
    struct pccd_client *client =
        test_client(&(struct pccd_options){.url = false_daemon.url});
    assert_ok(pccd_ping(client, NULL));
    assert_ok(pccd_link(client, &info));
    assert_int_equal(info.reconnects, 1);
    assert_int_equal(info.resent, 2);
    pccd_close(client);
}

static void tell_held(uint64_t step)
{
    struct proto_SCENE_HELD_request note = {.scene = 1, .step = step};

    if (proto_encode_notification(&false_daemon.encoder, PROTO_NOTE_SCENE_HELD, &note) !=
        0) {
        _exit(1);
    }
    (void)proto_send(false_daemon.socket, false_daemon.encoder.data,
                     false_daemon.encoder.bytes, NULL, 0);
}

static uint64_t next_step(void)
{
    struct proto_FRAME_SUBMIT_request submit = {.step = 0};
    struct proto_error error;

    if (false_next() != PROTO_METHOD_FRAME_SUBMIT ||
        proto_decode_body(&false_daemon.envelope,
                          &proto_messages[PROTO_METHOD_FRAME_SUBMIT].request, &submit,
                          &error) != 0) {
        _exit(1);
    }
    return submit.step;
}

static void answer_ping(void)
{
    struct proto_PING_request ping = {.token = 0};
    struct proto_PING_result pong;
    struct proto_error error;

    (void)proto_decode_body(&false_daemon.envelope,
                            &proto_messages[PROTO_METHOD_PING].request, &ping, &error);
    pong.token = ping.token;
    false_answer(false_daemon.envelope.id, PROTO_METHOD_PING, &pong, NULL, 0);
}

/* Tell that a frame is held, and end over a ping. The next daemon has another session,
 * and tells it before it answers the second ping. */
static void hold_once_more(void)
{
    uint64_t step;

    false_hello(PROTO_VERSION_MAX);
    false_attach(false_good_ring, 2);
    tell_held(next_step());
    (void)false_next();
    false_take_client();
    false_hello(PROTO_VERSION_MAX);
    false_attach(false_good_ring, 2);
    step = next_step();
    for (int pings = 0; pings < 2; pings++) {
        (void)false_next();
        if (pings == 1) {
            tell_held(step);
        }
        answer_ping();
    }
    (void)false_next();
}

/* If it failed, who waits until a frame is held would step before it is, in a daemon that
 * has taken over, and the frame be left behind. */
CASE_WITH(peer__that_takes_over_holds_what_it_says_itself, NULL, false_stop)
{
    const struct pccd_step_settings hold = {
        .struct_bytes = sizeof(struct pccd_step_settings), .hold = true};
    struct pccd_client *client = NULL;
    struct pccd_link_info info;
    uint64_t step = 0;

    false_start(hold_once_more);
    client = test_client(&(struct pccd_options){.url = false_daemon.url});
    assert_ok(pccd_submit_still(client, 1, &hold, &step));
    assert_ok(pccd_wait_held(client, step, -1));
    assert_ok(pccd_ping(client, NULL));
    assert_ok(pccd_link(client, &info));
    assert_int_equal(info.reconnects, 1);
    assert_int_equal(pccd_wait_held(client, step, 0), PCCD_E_AGAIN);
    assert_ok(pccd_ping(client, NULL));
    assert_ok(pccd_wait_held(client, step, 0));
    pccd_close(client);
}
