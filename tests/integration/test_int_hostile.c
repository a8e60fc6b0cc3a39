/* test_int_hostile.c - peers that send nonsense to a real daemon. */
#include "cases.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <sys/socket.h>
#include <unistd.h>

#include "lingering.h"
#include "witness.h"

#define SCENES_TRIED 1000
#define SCENES_MAX   64 /* witness.c asks for no more of a client */
#define LINGER_S     20

static struct test_raw raw;

/* ---- messages ---------------------------------------------------------------------- */

/* MessagePack by hand: \x94 an array of 4, \x80 an empty map, \xa4 a string of 4, \xc0
 * nil. */
struct malformed {
    const char *what;
    const char *bytes;
    size_t count;
};

#define BYTES(text) text, sizeof text - 1
#define TEN(text)   text text text text text text text text text text

/* One of each sentence of the decoder: test_proto_malformed.c has the others. */
static const struct malformed malformed[] = {
    {"an empty array", BYTES("\x90")},
    {"no array", BYTES("\xc0")},
    {"the unused type", BYTES("\xc1")},
    {"too few items", BYTES("\x93\x00\x01\xa4ping")},
    {"an unknown kind", BYTES("\x94\x03\x01\xa4ping\x80")},
    {"a negative id", BYTES("\x94\x00\xff\xa4ping\x80")},
    {"a method that is a number", BYTES("\x94\x00\x01\x05\x80")},
    {"params that are an array", BYTES("\x94\x00\x01\xa4ping\x90")},
    {"bytes behind the message", BYTES("\x94\x00\x01\xa4ping\x80\xc0")},
    {"a response to nothing", BYTES("\x94\x01\x01\xc0\x80")},
    {"an array of 2^32-1", BYTES("\xdd\xff\xff\xff\xff")},
    {"params of 2^31 fields", BYTES("\x94\x00\x01\xa4ping\xdf\x80\x00\x00\x00")},
    {"an ext", BYTES("\x94\x00\x01\xa4ping\x81\xa5token\xc7\x01\x05\x00")},
    {"a deep nest", BYTES(TEN("\x91") TEN("\x91") TEN("\x91") "\xc0")},
    {"text", BYTES("GET / HTTP/1.1\r\n\r\n")},
};

/* The daemon answers with a fatal E_BADMSG and closes. */
static void expect_refusal(const char *what, int code)
{
    int status = test_raw_receive(&raw);

    if (status != 0 || raw.envelope.kind != PROTO_RESPONSE || !raw.envelope.failed ||
        raw.envelope.error.code != code || !raw.envelope.error.fatal ||
        raw.envelope.error.text[0] == '\0') {
        fail_msg("%s: status %d, error %d \"%s\"", what, status, raw.envelope.error.code,
                 raw.envelope.error.text);
    }
    status = test_raw_receive(&raw);
    if (status != PCCD_E_DISCONNECTED) {
        fail_msg("%s: not closed but %d", what, status);
    }
}

/* If it failed, a malformed message would be misread, crash the daemon or go
 * unanswered. */
CASE(message__malformed_is_refused_one_by_one)
{
    uint64_t dropped = test_stat(test_witness.crossing.client, "sessions_dropped");
    size_t count = sizeof malformed / sizeof malformed[0];

    for (size_t i = 0; i < 2 * count; i++) {
        const struct malformed *message = &malformed[i / 2];

        assert_true(test_raw_open(&raw, test_witness.daemon.socket));
        if (i % 2 == 1) { /* before and after hello */
            assert_ok(test_raw_hello(&raw));
        }
        assert_true(test_raw_send(&raw, message->bytes, message->count, 0));
        expect_refusal(message->what, PCCD_E_BADMSG);
        test_raw_close(&raw);
        test_witness_turn();
    }
    assert_int_equal(test_stat(test_witness.crossing.client, "sessions_dropped"),
                     dropped + 2 * count);
}

/* If it failed, a message cut short would be taken for a whole one. */
CASE(message__cut_at_every_byte_is_refused)
{
    struct proto_FRAME_SUBMIT_request request = {
        .scene = 1, .slot = 1, .seq = 2, .segments = 1, .tolerance = 0.5, .step = 77};
    static struct proto_encoder encoder;

    assert_ok(proto_encode_request(&encoder, 9, PROTO_METHOD_FRAME_SUBMIT, &request));
    assert_true(encoder.bytes > 40);
    for (size_t count = 1; count < encoder.bytes; count++) {
        test_witness_open_raw(&raw, 0);
        assert_true(test_raw_send(&raw, encoder.data, count, 0));
        expect_refusal("a cut message", PCCD_E_BADMSG);
        test_raw_close(&raw);
        if (count % 16 == 0) {
            test_witness_turn();
        }
    }
    test_witness_turn();
}

/* If it failed, an oversized message would be read in part. */
CASE(message__longer_than_the_limit_is_refused)
{
    static uint8_t bytes[PROTO_MESSAGE_BYTES_MAX + 1];
    static const size_t counts[] = {PROTO_MESSAGE_BYTES_MAX, PROTO_MESSAGE_BYTES_MAX + 1};

    memset(bytes, 0xc0, sizeof bytes); /* nil, many times */
    for (size_t i = 0; i < 2; i++) {
        test_witness_open_raw(&raw, 0);
        assert_true(test_raw_send(&raw, bytes, counts[i], 0));
        expect_refusal("a long message", PCCD_E_BADMSG);
        test_raw_close(&raw);
        test_witness_turn();
    }
    /* More elements than are allowed, but well-formed otherwise. */
    memcpy(bytes, "\x94\x00\x01\xa4ping\x81\xa1x\xdc\x13\x88", 14); /* 5000 nils */
    test_witness_open_raw(&raw, 0);
    assert_true(test_raw_send(&raw, bytes, 14 + 5000, 0));
    expect_refusal("too many elements", PCCD_E_BADMSG);
    test_raw_close(&raw);
    test_witness_turn();
}

/* If it failed, an empty datagram would be taken for a message, or stop the daemon. */
CASE(message__empty_ends_the_session)
{
    test_witness_open_raw(&raw, 0);
    assert_true(test_raw_send(&raw, "", 0, 0));
    assert_int_equal(test_raw_receive(&raw), PCCD_E_DISCONNECTED);
    test_raw_close(&raw);
    test_witness_turn();
}

/* A request that is a message but not one that can be served. */
static const struct {
    const char *what;
    const char *bytes;
    size_t count;
    int code;
} unserved[] = {
    {"an unknown method", BYTES("\x94\x00\x05\xa4pong\x80"), PCCD_E_NOMETHOD},
    {"an empty method", BYTES("\x94\x00\x05\xa0\x80"), PCCD_E_NOMETHOD},
    {"the daemon's notification", BYTES("\x94\x00\x05\xa6goaway\x80"), PCCD_E_NOMETHOD},
    {"a missing field", BYTES("\x94\x00\x05\xadscene.destroy\x80"), PCCD_E_BADMSG},
    {"text for a number", BYTES("\x94\x00\x05\xadscene.destroy\x81\xa5scene\xa1x"),
     PCCD_E_BADMSG},
    {"a negative number", BYTES("\x94\x00\x05\xadscene.destroy\x81\xa5scene\xff"),
     PCCD_E_BADMSG},
    {"a fraction",
     BYTES("\x94\x00\x05\xadscene.destroy\x81\xa5scene\xcb\x3f\xe0\0\0\0\0\0\0"),
     PCCD_E_BADMSG},
    {"a number beyond 32 bits",
     BYTES("\x94\x00\x05\xadscene.destroy\x81\xa5scene\xcf\0\0\0\x01\0\0\0\0"),
     PCCD_E_BADMSG},
    {"a field twice",
     BYTES("\x94\x00\x05\xadscene.destroy\x82\xa5scene\x01\xa5scene\x01"), PCCD_E_BADMSG},
    {"nil for a number", BYTES("\x94\x00\x05\xa4ping\x81\xa5token\xc0"), PCCD_E_BADMSG},
    {"a number for a tuning",
     BYTES("\x94\x00\x05\xac"
           "frame.submit\x83\xa5scene\x01\xa8segments\x00\xa6"
           "tuning\x02"),
     PCCD_E_BADMSG},
    {"text for rights",
     BYTES("\x94\x00\x05\xac"
           "scene.create\x81\xa6rights\xa5never"),
     PCCD_E_BADMSG},
    {"no such handle", BYTES("\x94\x00\x05\xadscene.destroy\x81\xa5scene\x07"),
     PCCD_E_HANDLE},
    {"a name that is too long",
     BYTES("\x94\x00\x05\xa5hello\x83\xabversion_min\x01\xabversion_max\x01\xa6"
           "client\xda\x01\x04" TEN(TEN("ab")) TEN("abcdef")),
     PCCD_E_BADMSG},
};

/* If it failed, one wrong request would cost the client its session, or be served. */
CASE(message__wrong_requests_are_answered_and_survived)
{

    test_witness_open_raw(&raw, 0);
    for (size_t i = 0; i < sizeof unserved / sizeof unserved[0]; i++) {
        assert_true(test_raw_send(&raw, unserved[i].bytes, unserved[i].count, 0));
        assert_ok(test_raw_receive(&raw));
        if (!raw.envelope.failed || raw.envelope.id != 5 ||
            raw.envelope.error.code != unserved[i].code || raw.envelope.error.fatal) {
            fail_msg("%s: id %u, error %d \"%s\"", unserved[i].what, raw.envelope.id,
                     raw.envelope.error.code, raw.envelope.error.text);
        }
        assert_ok(RAW_CALL(&raw, PING, NULL, .token = 1));
        test_witness_turn();
    }
    /* Unknown fields and notifications are for newer peers: no error. */
    assert_true(test_raw_send(&raw, BYTES("\x93\x02\xa5other\x80"), 0));
    assert_true(
        test_raw_send(&raw, BYTES("\x94\x00\x06\xa4ping\x81\xa3new\x92\x01\x02"), 0));
    assert_ok(test_raw_receive(&raw));
    assert_int_equal(raw.envelope.id, 6);
    assert_false(raw.envelope.failed);
    test_raw_close(&raw);
}

/* ---- descriptors ------------------------------------------------------------------- */

/* Where the kernel can refuse them (seqpacket.h) none comes any more when the daemon has
 * taken the connection: what is to come must be there before. */
static pid_t stop_daemon(void)
{
    pid_t pid = (pid_t)pccd_daemon_pid(test_witness.crossing.client);
    assert_true(test_stop(pid));
    return pid;
}

/* Connect, and pass `count` copies of a descriptor before the daemon looks. */
static void open_with_fds(int count)
{
    pid_t pid = stop_daemon();

    assert_true(test_raw_open(&raw, test_witness.daemon.socket));
    assert_true(test_raw_send(&raw, BYTES("\x94\x00\x01\xa4ping\x80"), count));
    assert_int_equal(kill(pid, SIGCONT), 0);
}

/* If it failed, a client could fill the daemon's table of descriptors. */
CASE(descriptors__from_clients_are_closed_and_refused)
{
    static const int counts[] = {1, 2, 3, 30, 1, 64};
    int before = test_witness_fd_count();

    for (int i = 0; i < 36; i++) {
        open_with_fds(counts[i % 6]);
        expect_refusal("descriptors", PCCD_E_BADMSG);
        test_raw_close(&raw);
    }
    test_witness_turn();
    for (int i = 0; i < 500 && test_witness_fd_count() > before; i++) {
        test_sleep_ms(2);
    }
    assert_true(test_witness_fd_count() <= before);
}

/* If it failed, descriptors could come unseen to a daemon that does not look for them, or
 * a client that tried would be dropped for nothing. */
CASE(descriptors__are_refused_by_the_kernel_where_it_can)
{
    int before = test_witness_fd_count();

    test_witness_open_raw(&raw, 0);
    for (int i = 0; i < 40; i++) { /* so that it has seen, once, that there is no more */
        assert_ok(RAW_CALL(&raw, PING, NULL, .token = 1));
    }
    if (test_raw_send(&raw, BYTES("\x94\x00\x01\xa4ping\x80"), 3)) {
        expect_refusal("descriptors", PCCD_E_BADMSG); /* Linux before 6.16 */
    } else {
        assert_int_equal(errno, EPERM);
        assert_ok(RAW_CALL(&raw, PING, NULL, .token = 1));
        assert_true(test_witness_fd_count() <= before + 1); /* the connection's */
    }
    test_raw_close(&raw);
    test_witness_turn();
}

/* If it failed, one client could stop the daemon for as long as it likes: close(2) of
 * what it has sent blocks. Read by the daemon in the first round, unread in the second.
 */
CASE(descriptors__that_do_not_close_hold_up_nobody)
{
    for (int round = 0; round < 2; round++) {
        uint64_t begin_ms;
        int peer = -1;
        int fd = test_lingering_new(LINGER_S, &peer);
        pid_t pid = stop_daemon();

        assert_true(test_raw_open(&raw, test_witness.daemon.socket));
        for (int i = 0; round == 1 && i < 66; i++) { /* more than are read of the dead */
            assert_int_equal(
                send(raw.socket, "\x94\x00\x01\xa4ping\x80", 9, MSG_DONTWAIT), 9);
        }
        assert_true(test_raw_send_fd(&raw, "\x94\x00\x01\xa4ping\x80", 9, fd));
        (void)close(fd); /* the daemon, or its queue, has the last one */
        if (round == 1) {
            test_raw_close(&raw);
        }
        assert_int_equal(kill(pid, SIGCONT), 0);
        if (round == 0) {
            expect_refusal("a descriptor", PCCD_E_BADMSG);
            test_raw_close(&raw);
        }
        begin_ms = test_now_ms();
        for (int i = 0; i < 20; i++) {
            test_witness_turn();
            test_sleep_ms(5);
        }
        assert_true(test_now_ms() - begin_ms < LINGER_S * 1000 / 2);
        (void)close(peer); /* a reset: whoever waits in close goes on */
    }
}

/* ---- floods ------------------------------------------------------------------------ */

/* Send until the socket takes no more; returns how many messages went. */
static uint32_t flood(const char *bytes, size_t count, uint32_t max)
{
    uint32_t sent = 0;

    while (sent < max &&
           send(raw.socket, bytes, count, MSG_NOSIGNAL | MSG_DONTWAIT) > 0) {
        sent++;
    }
    return sent;
}

/* If it failed, a client that does not read its answers would fill the daemon's memory or
 * keep it from the others. */
CASE(flood__of_requests_without_reading_is_bounded)
{
    uint32_t sent = 0;

    test_witness_open_raw(&raw, 0);
    for (int round = 0; round < 200; round++) {
        sent += flood(BYTES("\x94\x00\x01\xa4ping\x80"), 10000);
        test_witness_turn();
    }
    assert_true(sent > 100);
    assert_true(sent < 200000); /* the daemon stopped reading */
    /* Every request that it took is answered once the client reads. */
    for (uint32_t i = 0; i < sent; i++) {
        assert_ok(test_raw_receive(&raw));
        assert_false(raw.envelope.failed);
    }
    test_raw_close(&raw);
    test_witness_turn();
}

/* If it failed, errors would cost more than answers, or be logged without bound. */
CASE(flood__of_errors_does_not_delay_others)
{
    test_witness_open_raw(&raw, 0);
    for (int round = 0; round < 50; round++) {
        uint32_t sent = flood(BYTES("\x94\x00\x01\xa4pong\x80"), 100);

        test_witness_turn();
        for (uint32_t i = 0; i < sent; i++) {
            assert_ok(test_raw_receive(&raw));
            assert_int_equal(raw.envelope.error.code, PCCD_E_NOMETHOD);
        }
    }
    test_raw_close(&raw);
}

/* If it failed, coming and going would leave something behind. */
CASE(flood__of_connections_leaves_nothing)
{
    struct pccd_client *client = test_witness.crossing.client;
    uint64_t sessions = test_stat(client, "sessions_now");
    int before = test_witness_fd_count();

    for (int i = 0; i < 400; i++) {
        assert_true(test_raw_open(&raw, test_witness.daemon.socket));
        if (i % 4 == 1) {
            assert_ok(test_raw_hello(&raw));
        }
        if (i % 4 == 2) {
            assert_true(test_raw_send(&raw, BYTES("\x94\x00\x01\xa4ping\x80"), 0));
        }
        if (i % 4 == 3) {
            assert_ok(test_raw_hello(&raw));
            assert_ok(test_raw_attach(&raw, 2, 65536));
        }
        test_raw_close(&raw);
        if (i % 20 == 0) {
            test_witness_turn();
        }
    }
    assert_int_equal(test_stat_await(client, "sessions_now", sessions), sessions);
    for (int i = 0; i < 500 && test_witness_fd_count() > before; i++) {
        test_sleep_ms(2);
    }
    assert_true(test_witness_fd_count() <= before);
}

/* Send `count` steps of a scene, and cancel a request unless that is 0. Of the `answers`
 * that come then, return how many are busy. */
static uint32_t flood_steps(uint32_t scene, uint32_t count, uint32_t cancelled,
                            uint32_t answers)
{
    uint32_t busy = 0;

    for (uint32_t i = 0; i < count; i++) {
        assert_int_not_equal(RAW_SEND(&raw, FRAME_SUBMIT, .scene = scene), 0);
    }
    if (cancelled != 0) {
        assert_int_not_equal(RAW_SEND(&raw, CANCEL, .id = cancelled), 0);
    }
    for (uint32_t i = 0; i < answers; i++) {
        assert_ok(test_raw_receive(&raw));
        if (raw.envelope.failed && raw.envelope.error.code == PCCD_E_BUSY) {
            busy++;
        } else if (raw.envelope.failed && raw.envelope.error.code != PCCD_E_CANCELLED) {
            fail_msg("error %d \"%s\"", raw.envelope.error.code, raw.envelope.error.text);
        }
    }
    return busy;
}

/* If it failed, a client could queue more work than the daemon promised to hold for
 * it. */
CASE(flood__of_steps_is_answered_busy)
{
    uint32_t scene, step;

    test_witness_open_raw(&raw, 65536);
    assert_ok(test_raw_scene(&raw, "", &scene));
    step = test_witness_long_step(&raw);
    /* Two slots: one step waits for the long one. */
    assert_int_equal(flood_steps(scene, 60, step, 62), 59);
    for (int round = 0; round < 20; round++) { /* as fast as they are answered */
        assert_in_range(flood_steps(scene, 60, 0, 60), 0, 58);
        test_witness_turn();
    }
    test_raw_close(&raw);
}

/* Without a bound on the scenes that wait to be freed, a client that creates and destroys
 * them behind a long step of its own would fill the daemon's memory. */
CASE(flood__of_scenes_behind_a_step_is_bounded)
{
    uint32_t scene, step;
    uint32_t count = 0;
    int status;

    test_witness_open_raw(&raw, 65536);
    step = test_witness_long_step(&raw);
    while ((status = test_raw_scene(&raw, "", &scene)) == 0 && count < SCENES_TRIED) {
        assert_ok(RAW_CALL(&raw, SCENE_DESTROY, NULL, .scene = scene));
        count++;
    }
    assert_int_equal(status, PCCD_E_BUSY);
    assert_true(count >= SCENES_MAX);
    assert_int_not_equal(RAW_SEND(&raw, CANCEL, .id = step), 0);
    /* What is left: the witness's scene, and the one of the long step. */
    assert_int_equal(test_stat_await(test_witness.crossing.client, "scenes_now", 2), 2);
    assert_ok(test_raw_scene(&raw, "", &scene));
    test_raw_close(&raw);
}

CASES_WITH(test_witness_start, test_witness_stop);
