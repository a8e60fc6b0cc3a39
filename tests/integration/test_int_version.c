/* test_int_version.c - clients and daemons of different ages. */
#include "cases.h"

#include <signal.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include "crossing.h"
#include "daemon.h"
#include "raw.h"

static struct test_daemon daemon_;

static int set_up(void **state)
{
    (void)state;
    return test_daemon_start(&daemon_, NULL) ? 0 : -1;
}

static int tear_down(void **state)
{
    (void)state;
    return test_daemon_finish(&daemon_) ? 0 : -1;
}

/* ---- other clients, this daemon ---------------------------------------------------- */

static int greet(uint32_t least, uint32_t most, struct proto_HELLO_result *result,
                 struct proto_error *error)
{
    const struct proto_HELLO_request hello = {
        .version_min = least, .version_max = most, .client = "another"};
    struct test_raw raw;
    int status;

    assert_true(test_raw_open(&raw, daemon_.socket));
    status = test_raw_call(&raw, PROTO_METHOD_HELLO, &hello, result);
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

    assert_ok(test_raw_session(&raw, daemon_.socket, 0, 0));
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

/* A daemon in a child, which says hello so and answers pings. */
struct script {
    struct sockaddr_un address;
    int listener;
    pid_t pid;
    char url[128];
};

static void serve(int listener, const struct proto_HELLO_result *hello)
{
    static struct proto_encoder encoder;
    static uint8_t message[PROTO_MESSAGE_BYTES_MAX];
    struct proto_decoder *decoder = proto_decoder_new();
    int peer = accept(listener, NULL, NULL);
    struct proto_envelope envelope;
    struct proto_error error;
    ssize_t bytes;

    while ((bytes = recv(peer, message, sizeof message, 0)) > 0 &&
           proto_decode(decoder, message, (size_t)bytes, &envelope, &error) == 0) {
        if (envelope.method == PROTO_METHOD_HELLO) {
            (void)proto_encode_result(&encoder, envelope.id, PROTO_METHOD_HELLO, hello);
        } else if (envelope.method == PROTO_METHOD_PING) {
            struct proto_PING_request ping;
            struct proto_PING_result pong = {.token = 0};

            (void)proto_decode_body(&envelope, &proto_messages[PROTO_METHOD_PING].request,
                                    &ping, &error);
            pong.token = ping.token;
            (void)proto_encode_result(&encoder, envelope.id, PROTO_METHOD_PING, &pong);
        } else {
            (void)proto_error_set(&error, PCCD_E_NOMETHOD, "was never heard of");
            (void)proto_encode_error(&encoder, envelope.id, &error);
        }
        (void)send(peer, encoder.data, encoder.bytes, MSG_NOSIGNAL);
    }
    _exit(0);
}

static void begin_script(struct script *script, const struct proto_HELLO_result *hello)
{
    script->address = (struct sockaddr_un){.sun_family = AF_UNIX};
    (void)snprintf(script->address.sun_path, sizeof script->address.sun_path, "%s/other",
                   daemon_.directory);
    (void)snprintf(script->url, sizeof script->url, "unix:%s", script->address.sun_path);
    (void)unlink(script->address.sun_path); /* of a case that failed */
    script->listener = socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0);
    assert_int_equal(bind(script->listener, (const struct sockaddr *)&script->address,
                          sizeof script->address),
                     0);
    assert_int_equal(listen(script->listener, 1), 0);
    script->pid = fork();
    assert_true(script->pid >= 0);
    if (script->pid == 0) {
        test_end_with_parent();
        serve(script->listener, hello);
    }
}

static void end_script(struct script *script)
{
    (void)kill(script->pid, SIGKILL);
    (void)waitpid(script->pid, NULL, 0);
    (void)close(script->listener);
    (void)unlink(script->address.sun_path);
}

static int connect_to(const char *url, struct pccd_client **client)
{
    struct pccd_options options;

    pccd_options_init(&options);
    options.url = url;
    options.timeout_ms = 5000;
    options.reconnect_ms = -1;
    return pccd_connect(&options, client);
}

/* If it failed, the library would take for an answer what it cannot read. */
CASE(daemon__of_another_version_is_refused)
{
    static const uint32_t versions[] = {PROTO_VERSION_MIN - 1, PROTO_VERSION_MAX + 1};

    for (size_t i = 0; i < 2; i++) {
        const struct proto_HELLO_result hello = {.version = versions[i],
                                                 .daemon = "pccdd 9"};
        struct pccd_client *client = NULL;
        struct script script;

        begin_script(&script, &hello);
        assert_int_equal(connect_to(script.url, &client), PCCD_E_VERSION);
        assert_null(client);
        assert_non_null(strstr(pccd_error_text(NULL), "version"));
        end_script(&script);
    }
}

/* If it failed, features that a later daemon has would confuse this client. */
CASE(daemon__with_unknown_features_is_used)
{
    const struct proto_HELLO_result hello = {.version = PROTO_VERSION_MAX,
                                             .features = UINT64_MAX};
    struct pccd_client *client = NULL;
    struct script script;
    uint64_t ns;

    begin_script(&script, &hello);
    assert_int_equal(connect_to(script.url, &client), 0);
    assert_ok(pccd_ping(client, &ns));
    /* Its methods are not ours: what it does not know it says. */
    assert_int_equal(pccd_scene_destroy(client, 1), PCCD_E_NOMETHOD);
    assert_non_null(strstr(pccd_error_text(client), "scene.destroy"));
    pccd_close(client);
    end_script(&script);
}

static void ignore_scene(void *context, const struct pccd_scene_info *info)
{
    (void)context;
    (void)info;
}

static void assert_too_old(struct pccd_client *client, int status, const char *text)
{
    assert_int_equal(status, PCCD_E_VERSION);
    assert_non_null(strstr(pccd_error_text(client), text));
    assert_non_null(strstr(pccd_error_text(client), "old"));
}

/* If it failed, a client of an older daemon would be told of a method that it never heard
 * of, or wait for what never comes; or get an answer that leaves out what it asked. */
CASE(daemon__that_lacks_features_is_named)
{
    const struct proto_HELLO_result hello = {.version = PROTO_VERSION_MAX};
    const struct pccd_scene_settings shared = {.name = "both", .share = PCCD_SHARE_OPEN};
    const struct pccd_object_settings filter = {.what = PCCD_OBJECT_SELF};
    struct pccd_client *client = NULL;
    struct script script;
    uint32_t scene = 0;
    uint64_t ns;

    begin_script(&script, &hello);
    assert_int_equal(connect_to(script.url, &client), 0);
    assert_too_old(client, pccd_scene_create(client, &shared, &scene), "share");
    assert_int_equal(scene, 0);
    assert_too_old(client, pccd_object_set(client, 1, 1, &filter), "object.set");
    assert_too_old(client, pccd_pair_ignore(client, 1, 1, 2, true), "scene.ignore");
    assert_too_old(client, pccd_list_scenes(client, 0, ignore_scene, NULL), "list.scene");
    assert_too_old(client, pccd_watch_start(client, 0, 0), "watch");
    assert_too_old(client, pccd_wait_held(client, 1, -1), "holds");
    assert_ok(pccd_ping(client, &ns)); /* the rest goes on */
    pccd_close(client);
    end_script(&script);
}

CASES_WITH(set_up, tear_down);
