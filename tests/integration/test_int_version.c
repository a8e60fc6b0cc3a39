/* test_int_version.c - clients and daemons of different ages. */
#include "cases.h"

#include "false_daemon.h"
#include "fixture.h"
#include "must.h"
#include "raw.h"

/* ---- other clients, this daemon ---------------------------------------------------- */

static int greet(uint32_t least, uint32_t most, struct proto_HELLO_result *result,
                 struct proto_error *error)
{
    struct test_raw raw;
    int status;

    assert_true(test_raw_open(&raw, test_shared.socket));
    status = RAW_CALL(&raw, HELLO, result, .version_min = least, .version_max = most,
                      .client = "another");
    *error = raw.error;
    test_raw_close(&raw);
    return status;
}

/* If it failed, a newer client would not be served by what both know, or an older one
 * would not be told why it is not. */
CASE(hello__finds_the_version_that_both_speak)
{
    struct proto_HELLO_result result;
    struct proto_error error;

    assert_int_equal(greet(PROTO_VERSION_MIN, PROTO_VERSION_MAX, &result, &error), 0);
    assert_int_equal(result.version, PROTO_VERSION_MAX);
    assert_int_equal(greet(0, PROTO_VERSION_MAX + 7, &result, &error), 0);
    assert_int_equal(result.version, PROTO_VERSION_MAX);
    assert_int_equal(greet(0, PROTO_VERSION_MIN, &result, &error), 0);
    assert_int_equal(result.version, PROTO_VERSION_MIN);
    assert_int_equal(greet(0, PROTO_VERSION_MIN - 1, &result, &error), PCCD_E_VERSION);
    assert_true(error.fatal);
    assert_non_null(strstr(error.text, "0 to 0"));
    assert_int_equal(greet(PROTO_VERSION_MAX + 1, PROTO_VERSION_MAX + 1, &result, &error),
                     PCCD_E_VERSION);
    assert_true(error.fatal);
    assert_non_null(strstr(error.text, "2 to 2"));
}

/* A request with a parameter that a later release may have:
 * {"token": 7, "later": true}. */
static const uint8_t ping_of_later[] = {0x94, 0x00, 0x09, 0xa4, 'p', 'i', 'n', 'g',
                                        0x82, 0xa5, 't',  'o',  'k', 'e', 'n', 0x07,
                                        0xa5, 'l',  'a',  't',  'e', 'r', 0xc3};
/* And a method of one. */
static const uint8_t method_of_later[] = {0x94, 0x00, 0x0a, 0xa9, 's', 'c', 'e',
                                          'n',  'e',  '.',  'f',  'l', 'y', 0x80};

/* If it failed, a newer client could ask an older daemon for nothing any more. */
CASE(requests__of_later_releases_are_answered)
{
    struct proto_PING_result result;
    struct test_raw raw;

    assert_ok(test_raw_session(&raw, test_shared.socket, 0, 0));
    assert_true(test_raw_send(&raw, ping_of_later, sizeof ping_of_later, 0));
    assert_ok(test_raw_answer(&raw, 9, PROTO_METHOD_PING, &result));
    assert_int_equal(result.token, 7);
    assert_true(test_raw_send(&raw, method_of_later, sizeof method_of_later, 0));
    assert_int_equal(test_raw_answer(&raw, 10, PROTO_METHOD_PING, NULL), PCCD_E_NOMETHOD);
    assert_false(raw.error.fatal);
    assert_non_null(strstr(raw.error.text, "scene.fly"));
    test_raw_close(&raw);
}

/* ---- this client, other daemons ---------------------------------------------------- */

/* The version of the false daemon, which has all features, answers pings, and knows no
 * other method. */
static uint32_t version;

static void serve(void)
{
    false_hello(version);
    for (;;) {
        if (false_next() == PROTO_METHOD_PING) {
            struct proto_PING_request ping = {.token = 0};
            struct proto_error error;

            (void)proto_decode_body(&false_daemon.envelope,
                                    &proto_messages[PROTO_METHOD_PING].request, &ping,
                                    &error);
            const struct proto_PING_result pong = {.token = ping.token};
            false_answer(false_daemon.envelope.id, PROTO_METHOD_PING, &pong, NULL, 0);
        } else {
            false_refuse(PCCD_E_NOMETHOD, "was never heard of");
        }
    }
}

/* Start it. */
static void begin(uint32_t its_version)
{
    version = its_version;
    false_start(serve);
}

/* If it failed, the library would take for an answer what it cannot read. */
CASE_WITH(daemon__of_another_version_is_refused, NULL, false_stop)
{
    static const uint32_t versions[] = {PROTO_VERSION_MIN - 1, PROTO_VERSION_MAX + 1};

    for (size_t i = 0; i < 2; i++) {
        struct pccd_client *client = NULL;

        begin(versions[i]);
        assert_int_equal(false_connect(&client), PCCD_E_VERSION);
        assert_null(client);
        assert_non_null(strstr(pccd_error_text(NULL), "version"));
        false_stop(state);
    }
}

/* If it failed, features that a later daemon has would confuse this client. */
CASE_WITH(daemon__with_unknown_features_is_used, NULL, false_stop)
{
    uint64_t ns;

    begin(PROTO_VERSION_MAX);
    struct pccd_client *client = false_connect_good();
    assert_ok(pccd_ping(client, &ns));
    /* Its methods are not ours: what it does not know it says. */
    assert_int_equal(pccd_scene_destroy(client, 1), PCCD_E_NOMETHOD);
    assert_non_null(strstr(pccd_error_text(client), "scene.destroy"));
    pccd_close(client);
}

CASES_WITH(test_shared_start, test_shared_stop);
