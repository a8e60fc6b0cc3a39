/* test_int_backlog.c - what waits before the daemon accepts it. */
#include "cases.h"

#include <signal.h>
#include <sys/resource.h>
#include <unistd.h>

#include "daemon.h"
#include "lingering.h"
#include "raw.h"
#include "seqpacket.h"

#define LINGER_S        20
#define CONNECTIONS     6u
#define SILENT          32u /* beyond what is accepted in two turns */
#define DESCRIPTORS_MAX 4096u

static struct test_daemon daemon_;
static struct test_raw honest;
static struct test_raw hostile[CONNECTIONS];
static struct test_raw silent[SILENT];

static const char ping[] = "\x94\x00\x01\xa4ping\x80";

/* A daemon that may have more descriptors than it watches: 752. */
static bool start_daemon(void)
{
    static const char *const options[] = {"--threads", "1", "--connections-max", "40",
                                          NULL};
    struct rlimit before;
    struct rlimit wide;
    assert_int_equal(getrlimit(RLIMIT_NOFILE, &before), 0);
    if (before.rlim_max < DESCRIPTORS_MAX) {
        return false;
    }
    wide = (struct rlimit){.rlim_cur = DESCRIPTORS_MAX, .rlim_max = before.rlim_max};
    assert_int_equal(setrlimit(RLIMIT_NOFILE, &wide), 0);
    assert_true(test_daemon_start(&daemon_, options));
    assert_int_equal(setrlimit(RLIMIT_NOFILE, &before), 0);
    return true;
}

/* A connection whose one message brings a socket that lingers. Returns its peer. */
static int leave_lingering(struct test_raw *raw)
{
    int peer = -1;
    int fd = test_lingering_new(LINGER_S, &peer);
    assert_true(test_raw_open(raw, daemon_.socket));
    assert_true(test_raw_send_fd(raw, ping, sizeof ping - 1, fd));
    (void)close(fd); /* the message has the last one */
    return peer;
}

/* If it failed, a client could hold up the daemon for as long as it likes: the connection
 * that waited gets a number beyond those that can be watched, is turned away, and with it
 * goes what it had brought. */
CASE(backlog__that_does_not_close_holds_up_nobody)
{
    const struct proto_PING_request request = {.token = 7};
    uint64_t begin_ms;
    int peers[2];
    if (!start_daemon()) {
        test_skip("the limit of descriptors is too low here");
    }
    assert_ok(test_raw_session(&honest, daemon_.socket, 0, 0));
    /* All is there before the daemon sees any of it. */
    assert_true(test_stop(daemon_.pid));
    peers[0] = leave_lingering(&hostile[0]);
    for (uint32_t i = 1; i < CONNECTIONS - 1; i++) {
        assert_true(test_raw_open(&hostile[i], daemon_.socket));
        assert_true(
            test_raw_send(&hostile[i], ping, sizeof ping - 1, PROTO_FDS_RECEIVED_MAX));
    }
    for (uint32_t i = 0; i < SILENT; i++) {
        assert_true(test_raw_open(&silent[i], daemon_.socket));
    }
    peers[1] = leave_lingering(&hostile[CONNECTIONS - 1]);
    assert_int_equal(kill(daemon_.pid, SIGCONT), 0);
    begin_ms = test_now_ms();
    test_raw_wait_ms = LINGER_S * 1000;
    while (!test_daemon_logged(&daemon_, "no descriptor for a new connection")) {
        assert_ok(test_raw_call(&honest, PROTO_METHOD_PING, &request, NULL));
        assert_true(test_now_ms() - begin_ms < LINGER_S * 1000 / 2);
        test_sleep_ms(5);
    }
    assert_ok(test_raw_call(&honest, PROTO_METHOD_PING, &request, NULL));
    assert_true(test_now_ms() - begin_ms < LINGER_S * 1000 / 2);
    (void)close(peers[0]);
    (void)close(peers[1]);
    for (uint32_t i = 0; i < CONNECTIONS; i++) {
        test_raw_close(&hostile[i]);
    }
    for (uint32_t i = 0; i < SILENT; i++) {
        test_raw_close(&silent[i]);
    }
    test_raw_close(&honest);
    assert_true(test_daemon_finish(&daemon_));
}
