/* test_int_peer.c - the library and a daemon that misbehaves.
 *
 * Room:     tests/integration. May include: pccd.h, proto, tests/support.
 * Does:     a false daemon in a child process, played from a script: wrong versions,
 *           answers out of order, to nobody, with pages and memories that are not there,
 *           silence and sudden ends. Whatever it does, the library returns in time with
 *           an error.
 * Threads:  one in each process.
 */
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmocka.h>

#include "codec.h"
#include "daemon.h"
#include "memfd.h"
#include "messages.h"
#include "pccd.h"
#include "seqpacket.h"
#include "shm.h"

#define RING_BYTES   (4096u + 4u * 262144u) /* of what the library asks for first */
#define RESULT_BYTES (4096u + 65536u)
#define TIMEOUT_MS   400
#define OTHER_USER   65534

/* The false daemon's side of the connection. */
struct false_daemon {
    int listener;
    int socket;
    struct proto_decoder *decoder;
    struct proto_envelope envelope; /* of the last request */
    struct proto_encoder encoder;
    uint8_t message[PROTO_MESSAGE_BYTES_MAX];
};

static struct false_daemon peer;
static char directory[64];
static char socket_path[80];
static char url[96];
static pid_t child;

/* ---- in the child ------------------------------------------------------------------ */

/* The next one, in place of the last. */
static void take_client(void)
{
    if (peer.socket > 0) {
        (void)close(peer.socket);
    }
    peer.socket = accept(peer.listener, NULL, NULL);
}

/* Take the next request; ends the process when there is none. */
static int next_request(void)
{
    struct proto_error error;
    size_t bytes = 0;
    int fd_count = 0;

    if (proto_await(peer.socket, peer.message, sizeof(peer.message), &bytes, NULL,
                    &fd_count) != 0 ||
        proto_decode(peer.decoder, peer.message, bytes, &peer.envelope, &error) != 0) {
        _exit(0);
    }
    return peer.envelope.method;
}

static void answer(uint32_t id, int method, const void *result, const int *fds, int count)
{
    if (proto_encode_result(&peer.encoder, id, method, result) != 0 ||
        proto_send(peer.socket, peer.encoder.data, peer.encoder.bytes, fds, count) != 0) {
        _exit(0);
    }
}

static void answer_hello(uint32_t version)
{
    struct proto_HELLO_result result = {
        .version = version, .features = PROTO_FEATURE_RESUME, .pid = 4711};

    if (next_request() == PROTO_METHOD_HELLO) {
        answer(peer.envelope.id, PROTO_METHOD_HELLO, &result, NULL, 0);
    }
}

/* Answer shm.attach with true memories, of which the message says what it likes. */
static void answer_attach(struct proto_SHM_ATTACH_result result, int fd_count)
{
    struct proto_memory upload = PROTO_MEMORY_NONE;
    struct proto_memory records = PROTO_MEMORY_NONE;
    int fds[2];

    if (next_request() != PROTO_METHOD_SHM_ATTACH ||
        proto_memory_create(&upload, "upload", RING_BYTES, false) != 0 ||
        proto_memory_create(&records, "results", RESULT_BYTES, true) != 0) {
        _exit(0);
    }
    fds[0] = upload.fd;
    fds[1] = records.fd;
    answer(peer.envelope.id, PROTO_METHOD_SHM_ATTACH, &result, fds, fd_count);
}

static const struct proto_SHM_ATTACH_result good_ring = {.upload_bytes = RING_BYTES,
                                                         .result_bytes = RESULT_BYTES,
                                                         .slot_count = 4,
                                                         .slot_stride = 262144,
                                                         .inflight_max = 4};

/* Answer a submit with a page of `count` contacts at `offset`. */
static void answer_step(uint32_t id, uint64_t offset, uint64_t count, uint32_t bytes)
{
    struct proto_FRAME_SUBMIT_result result = {.offset = offset,
                                               .count = count,
                                               .total = count,
                                               .cursor = count,
                                               .record_bytes = bytes,
                                               .release = count * bytes};

    answer(id, PROTO_METHOD_FRAME_SUBMIT, &result, NULL, 0);
}

/* ---- in the test ------------------------------------------------------------------- */

typedef void (*script_fn)(void);

/* Start the false daemon with a script; it accepts one client before. */
static void start_peer(script_fn script)
{
    struct sockaddr_un address = {.sun_family = AF_UNIX};
    int listener = socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0);

    (void)snprintf(directory, sizeof(directory), "/tmp/pccd-test-XXXXXX");
    assert_non_null(mkdtemp(directory));
    (void)snprintf(socket_path, sizeof(socket_path), "%s/s", directory);
    (void)snprintf(url, sizeof(url), "unix:%s", socket_path);
    (void)snprintf(address.sun_path, sizeof(address.sun_path), "%s", socket_path);
    assert_true(listener >= 0);
    assert_int_equal(bind(listener, (const struct sockaddr *)&address, sizeof(address)),
                     0);
    assert_int_equal(listen(listener, 4), 0);
    child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        test_end_with_parent();
        peer.listener = listener;
        peer.decoder = proto_decoder_new();
        if (peer.decoder == NULL) {
            _exit(1);
        }
        take_client();
        script();
        _exit(0);
    }
    (void)close(listener);
}

static int stop_peer(void **state)
{
    (void)state;
    if (child > 0) {
        (void)kill(child, SIGKILL);
        (void)waitpid(child, NULL, 0);
    }
    child = 0;
    (void)unlink(socket_path);
    (void)rmdir(directory);
    return 0;
}

static int connect_peer(struct pccd_client **client)
{
    struct pccd_options options;

    pccd_options_init(&options);
    options.url = url;
    options.timeout_ms = TIMEOUT_MS;
    options.reconnect_ms = -1;
    return pccd_connect(&options, client);
}

/* A client of a script that begins with hello and attach; a still step attaches. */
static struct pccd_client *connect_good(void)
{
    struct pccd_client *client = NULL;

    assert_int_equal(connect_peer(&client), 0);
    assert_int_equal(pccd_daemon_pid(client), 4711);
    return client;
}

/* ---- connecting -------------------------------------------------------------------- */

static void choose_another_version(void)
{
    answer_hello(PROTO_VERSION_MAX + 1);
    (void)next_request();
}

/* If it failed, the library would speak a protocol that it does not know. */
static void peer__that_chooses_an_unknown_version_is_left(void **state)
{
    struct pccd_client *client = NULL;

    (void)state;
    start_peer(choose_another_version);
    assert_int_equal(connect_peer(&client), PCCD_E_VERSION);
    assert_null(client);
}

static void say_nothing(void)
{
    for (;;) {
        (void)pause();
    }
}

/* If it failed, a daemon that hangs would hang a program that starts. */
static void peer__that_says_nothing_is_a_timeout(void **state)
{
    struct pccd_client *client = NULL;
    uint64_t begin_ms = test_now_ms();

    (void)state;
    start_peer(say_nothing);
    assert_int_equal(connect_peer(&client), PCCD_E_TIMEOUT);
    assert_true(test_now_ms() - begin_ms >= TIMEOUT_MS);
    assert_true(test_now_ms() - begin_ms < 10 * TIMEOUT_MS);
    assert_true(pccd_error_text(NULL)[0] != '\0');
}

static void go_away(void)
{
    struct proto_GOAWAY_request note = {.code = -PCCD_E_SHUTDOWN, .text = "lunch"};

    (void)next_request();
    if (proto_encode_notification(&peer.encoder, PROTO_NOTE_GOAWAY, &note) == 0) {
        (void)proto_send(peer.socket, peer.encoder.data, peer.encoder.bytes, NULL, 0);
    }
}

/* If it failed, the user would not learn why the daemon closed. */
static void peer__that_says_goodbye_is_quoted(void **state)
{
    struct pccd_client *client = NULL;

    (void)state;
    start_peer(go_away);
    assert_int_equal(connect_peer(&client), PCCD_E_SHUTDOWN);
    assert_non_null(strstr(pccd_error_text(NULL), "lunch"));
}

static void talk_nonsense(void)
{
    answer_hello(PROTO_VERSION_MAX);
    (void)next_request();
    (void)proto_send(peer.socket, "\xdd\xff\xff\xff\xff", 5, NULL, 0);
    (void)next_request();
}

/* If it failed, a malformed answer would crash the program or be waited for. */
static void peer__that_talks_nonsense_is_disconnected(void **state)
{
    struct pccd_client *client;

    (void)state;
    start_peer(talk_nonsense);
    client = connect_good();
    assert_int_equal(pccd_ping(client, NULL), PCCD_E_DISCONNECTED);
    assert_int_equal(pccd_ping(client, NULL), PCCD_E_DISCONNECTED);
    pccd_close(client);
}

/* ---- memories ---------------------------------------------------------------------- */

static unsigned lie; /* which of the scripts below */

static void lie_about_memory(void)
{
    struct proto_SHM_ATTACH_result ring = good_ring;

    answer_hello(PROTO_VERSION_MAX);
    switch (lie) {
    case 0:
        answer_attach(ring, 0);
        break;
    case 1:
        answer_attach(ring, 1);
        break;
    case 2:
        ring.upload_bytes *= 2;
        answer_attach(ring, 2);
        break;
    case 3:
        ring.result_bytes = 1;
        answer_attach(ring, 2);
        break;
    case 4:
        ring.slot_count = 17;
        answer_attach(ring, 2);
        break;
    case 5:
        ring.slot_count = 0;
        answer_attach(ring, 2);
        break;
    case 6:
        ring.slot_stride = UINT64_MAX - 7;
        answer_attach(ring, 2);
        break;
    default:
        ring.slot_stride += 8;
        answer_attach(ring, 2);
        break;
    }
    (void)next_request();
}

/* If it failed, the library would write or read outside its mappings. */
static void peer__that_lies_about_memory_is_not_believed(void **state)
{
    (void)state;
    for (lie = 0; lie < 8; lie++) {
        struct pccd_client *client;
        uint64_t step = 0;
        int rc;

        start_peer(lie_about_memory);
        client = connect_good();
        rc = pccd_submit_still(client, 1, NULL, &step);
        if (rc != PCCD_E_BADMSG) {
            fail_msg("lie %u: status %d \"%s\"", lie, rc, pccd_error_text(client));
        }
        pccd_close(client);
        (void)stop_peer(NULL);
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
        {RESULT_BYTES, 1, 64},
        {RESULT_BYTES - 56, 1, 64},
        {4096, 1025, 64},
        {4096, UINT64_MAX, 64},
        {UINT64_MAX - 7, 1, 64},
        {4096, 1, 20},
        {4096, 1, 0},
    };

    answer_hello(PROTO_VERSION_MAX);
    answer_attach(good_ring, 2);
    for (size_t i = 0; i < sizeof(pages) / sizeof(pages[0]); i++) {
        (void)next_request();
        answer_step(peer.envelope.id, pages[i].offset, pages[i].count, pages[i].bytes);
    }
    (void)next_request();
    answer_step(peer.envelope.id, 4096, 1024, 64);
    (void)next_request();
}

/* If it failed, the user would be handed records that lie outside the mapping. */
static void peer__that_lies_about_pages_is_not_believed(void **state)
{
    struct pccd_client *client;
    struct pccd_answer answered;
    uint64_t step = 0;

    (void)state;
    start_peer(lie_about_pages);
    client = connect_good();
    for (int i = 0; i < 10; i++) {
        assert_int_equal(pccd_submit_still(client, 1, NULL, &step), 0);
        assert_int_equal(pccd_wait(client, step, -1, &answered), PCCD_E_BADMSG);
        assert_null(answered.contacts);
        pccd_answer_release(client, &answered);
    }
    assert_int_equal(pccd_submit_still(client, 1, NULL, &step), 0);
    assert_int_equal(pccd_wait(client, step, -1, &answered), 0);
    assert_int_equal(answered.count, 1024);
    assert_int_equal(answered.contacts[1023].reserved, 0); /* readable to the end */
    pccd_answer_release(client, &answered);
    pccd_close(client);
}

static void answer_backwards(void)
{
    uint32_t ids[4];

    answer_hello(PROTO_VERSION_MAX);
    answer_attach(good_ring, 2);
    for (int i = 0; i < 4; i++) {
        (void)next_request();
        ids[i] = peer.envelope.id;
    }
    for (int i = 3; i >= 0; i--) {
        answer_step(ids[i] + 1000, 4096, 1, 64); /* to nobody */
        answer_step(ids[i], 4096, (uint64_t)i + 1, 64);
        answer_step(ids[i], 4096, 9, 64); /* the same again */
    }
    (void)next_request();
}

/* If it failed, an answer would be taken for another one, or taken twice. */
static void peer__that_answers_in_any_order_is_understood(void **state)
{
    struct pccd_client *client;
    struct pccd_answer answered;
    uint64_t steps[4];

    (void)state;
    start_peer(answer_backwards);
    client = connect_good();
    for (int i = 0; i < 4; i++) {
        assert_int_equal(pccd_submit_still(client, 1, NULL, &steps[i]), 0);
    }
    for (uint64_t i = 0; i < 4; i++) {
        assert_int_equal(pccd_wait(client, steps[i], -1, &answered), 0);
        assert_int_equal(answered.count, i + 1);
        pccd_answer_release(client, &answered);
    }
    assert_int_equal(pccd_poll(client, &answered), PCCD_E_AGAIN);
    pccd_close(client);
}

static void stop_answering(void)
{
    answer_hello(PROTO_VERSION_MAX);
    answer_attach(good_ring, 2);
    say_nothing();
}

/* If it failed, a client of a daemon that hangs would hang, or take more and more. */
static void peer__that_stops_answering_bounds_what_is_begun(void **state)
{
    struct pccd_client *client;
    struct pccd_answer answered;
    uint64_t steps[5];
    uint64_t begin_ms;

    (void)state;
    start_peer(stop_answering);
    client = connect_good();
    for (int i = 0; i < 4; i++) {
        assert_int_equal(pccd_submit_still(client, 1, NULL, &steps[i]), 0);
    }
    begin_ms = test_now_ms();
    assert_int_equal(pccd_submit_still(client, 1, NULL, &steps[4]), PCCD_E_TIMEOUT);
    assert_int_equal(pccd_wait(client, steps[0], 50, &answered), PCCD_E_TIMEOUT);
    assert_int_equal(pccd_poll(client, &answered), PCCD_E_AGAIN);
    for (int i = 0; i < 3; i++) {
        assert_int_equal(pccd_ping(client, NULL), PCCD_E_TIMEOUT);
    }
    assert_true(test_now_ms() - begin_ms < 20 * TIMEOUT_MS);
    assert_int_equal(kill(child, SIGKILL), 0);
    assert_int_equal(pccd_wait(client, steps[3], -1, &answered), PCCD_E_DISCONNECTED);
    pccd_close(client);
}

/* Without a look at who listens, a user who puts a socket where another's daemon will be
 * would be sent that user's meshes. */
static void peer__of_another_user_is_not_spoken_to(void **state)
{
    struct sockaddr_un address = {.sun_family = AF_UNIX};
    struct pccd_options options;
    struct pccd_client *client = NULL;
    char folder[80];
    char byte;
    int listener;
    int accepted;

    (void)state;
    if (geteuid() != 0) {
        skip(); /* nobody else may act as another user */
    }
    (void)snprintf(directory, sizeof(directory), "/tmp/pccd-test-XXXXXX");
    assert_non_null(mkdtemp(directory));
    (void)snprintf(folder, sizeof(folder), "%s/pccd", directory);
    assert_int_equal(mkdir(folder, 0700), 0);
    (void)snprintf(socket_path, sizeof(socket_path), "%s/pccd/pccd.sock", directory);
    (void)snprintf(address.sun_path, sizeof(address.sun_path), "%s", socket_path);
    listener = socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0);
    assert_true(listener >= 0);
    assert_int_equal(bind(listener, (const struct sockaddr *)&address, sizeof(address)),
                     0);
    assert_int_equal(seteuid(OTHER_USER), 0);
    assert_int_equal(listen(listener, 4), 0);
    assert_int_equal(seteuid(0), 0);

    assert_int_equal(setenv("XDG_RUNTIME_DIR", directory, 1), 0);
    assert_int_equal(unsetenv("PCCD_URL"), 0);
    pccd_options_init(&options);
    options.timeout_ms = TIMEOUT_MS;
    options.no_autostart = true;
    assert_int_equal(pccd_connect(&options, &client), PCCD_E_SYSTEM);
    assert_non_null(strstr(pccd_error_text(NULL), "user 65534"));
    accepted = accept(listener, NULL, NULL);
    assert_true(accepted >= 0);
    assert_int_equal(recv(accepted, &byte, 1, 0), 0); /* closed without a word */
    (void)close(accepted);
    (void)close(listener);
    (void)unlink(socket_path);
    (void)rmdir(folder);
    (void)rmdir(directory);
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

    answer_hello(PROTO_VERSION_MAX);
    (void)next_request();
    take_client();
    for (int i = 0; i < 2; i++) {
        (void)next_request();
        ids[i] = peer.envelope.id;
    }
    for (int i = 0; i < 2; i++) {
        (void)proto_encode_error(&peer.encoder, ids[i], &error);
        (void)proto_send(peer.socket, peer.encoder.data, peer.encoder.bytes, NULL, 0);
    }
    take_client();
    answer_hello(PROTO_VERSION_MAX);
    (void)next_request();
    (void)proto_decode_body(&peer.envelope, &proto_messages[PROTO_METHOD_PING].request,
                            &ping, &error);
    pong.token = ping.token;
    answer(peer.envelope.id, PROTO_METHOD_PING, &pong, NULL, 0);
}

/* If it failed, a thousand clients of a daemon that has crashed would wait for one more
 * round trip of each other; or what was sent behind a hello that is refused would be
 * lost, or have the refusal for its answer. */
static void peer__that_refuses_hello_has_not_answered_what_came_behind(void **state)
{
    struct pccd_options options;
    struct pccd_client *client = NULL;
    struct pccd_link_info info;

    (void)state;
    start_peer(refuse_once);
    pccd_options_init(&options);
    options.url = url;
    assert_int_equal(pccd_connect(&options, &client), 0);
    assert_int_equal(pccd_ping(client, NULL), 0);
    assert_int_equal(pccd_link(client, &info), 0);
    assert_int_equal(info.reconnects, 1);
    assert_int_equal(info.resent, 2);
    pccd_close(client);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_teardown(peer__that_chooses_an_unknown_version_is_left,
                                  stop_peer),
        cmocka_unit_test_teardown(peer__that_says_nothing_is_a_timeout, stop_peer),
        cmocka_unit_test_teardown(peer__that_says_goodbye_is_quoted, stop_peer),
        cmocka_unit_test_teardown(peer__that_talks_nonsense_is_disconnected, stop_peer),
        cmocka_unit_test_teardown(peer__that_lies_about_memory_is_not_believed,
                                  stop_peer),
        cmocka_unit_test_teardown(peer__that_lies_about_pages_is_not_believed, stop_peer),
        cmocka_unit_test_teardown(peer__that_answers_in_any_order_is_understood,
                                  stop_peer),
        cmocka_unit_test_teardown(peer__that_stops_answering_bounds_what_is_begun,
                                  stop_peer),
        cmocka_unit_test(peer__of_another_user_is_not_spoken_to),
        cmocka_unit_test_teardown(
            peer__that_refuses_hello_has_not_answered_what_came_behind, stop_peer),
    };

    return cmocka_run_group_tests_name("peer", tests, NULL, NULL);
}
