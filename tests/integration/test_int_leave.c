/* test_int_leave.c - clients that leave, and what the daemon makes of it. */
#include "cases.h"

#include <signal.h>
#include <sys/socket.h>
#include <sys/wait.h>

#include "daemon.h"
#include "raw.h"

/* Requests that nobody waits for the answers to. */
static void ask(struct test_raw *raw)
{
    const struct proto_PING_request request = {.token = 0};

    assert_int_not_equal(test_raw_request(raw, PROTO_METHOD_PING, &request), 0);
}

static void say_goodbye(struct test_raw *raw)
{
    const struct proto_BYE_request request = {.reserved = 0};

    assert_int_not_equal(test_raw_request(raw, PROTO_METHOD_BYE, &request), 0);
}

/* If it failed, every program that ends in order would look like one that the daemon had
 * to give up, and its session wait for somebody who has said goodbye. */
CASE(leaving__with_an_answer_unsent_is_an_ordinary_end)
{
    const char *const options[] = {"--log-level", "debug", NULL};
    const struct proto_HELLO_request hello = {.version_min = PROTO_VERSION_MIN,
                                              .version_max = PROTO_VERSION_MAX,
                                              .resumable = true};
    struct proto_HELLO_result result;
    struct test_daemon daemon;
    struct test_raw raw;

    assert_true(test_daemon_start(&daemon, options));
    assert_true(test_raw_open(&raw, daemon.socket));
    assert_ok(test_raw_call(&raw, PROTO_METHOD_HELLO, &hello, &result));
    assert_int_equal(kill(daemon.pid, SIGSTOP), 0);
    ask(&raw);
    say_goodbye(&raw);
    test_raw_close(&raw);
    assert_int_equal(kill(daemon.pid, SIGCONT), 0);
    assert_true(test_raw_open(&raw, daemon.socket)); /* is served behind the other one */
    assert_ok(test_raw_hello(&raw));
    test_raw_close(&raw);
    assert_true(WIFEXITED(test_daemon_end(&daemon, SIGTERM, 10000)));
    assert_true(test_daemon_logged(&daemon, "disconnected"));
    assert_false(test_daemon_logged(&daemon, "closing"));
    assert_false(test_daemon_logged(&daemon, "waits for its client"));
    assert_true(test_daemon_finish(&daemon));
}

/* If it failed, nobody would learn that the daemon has given a client up that is there
 * and takes no answers. */
CASE(leaving__is_not_what_a_client_does_that_cannot_be_sent_to)
{
    struct test_daemon daemon;
    struct test_raw raw;

    assert_true(test_daemon_start(&daemon, NULL));
    assert_ok(test_raw_session(&raw, daemon.socket, 0, 0));
    assert_int_equal(shutdown(raw.socket, SHUT_RD), 0);
    ask(&raw);
    for (int i = 0; i < 1000 && !test_daemon_logged(&daemon, "cannot be sent to"); i++) {
        test_sleep_ms(10);
    }
    assert_true(test_daemon_logged(&daemon, "closing: the client cannot be sent to"));
    test_raw_close(&raw);
    assert_true(test_daemon_finish(&daemon));
}
