/* test_int_loss.c - what the library promises while its daemon is late, lost or lying. */
#include "cases.h"

#include <poll.h>
#include <signal.h>
#include <sys/time.h>
#include <unistd.h>

#include "daemon.h"
#include "false_daemon.h"
#include "messages.h"
#include "must.h"
#include "pccd.h"
#include "seqpacket.h"

#define PATIENT_MS 10000 /* to look for a daemon */

static struct pccd_client *connect_for(int timeout_ms)
{
    return test_client(&(struct pccd_options){
        .url = false_daemon.url, .timeout_ms = timeout_ms, .reconnect_ms = PATIENT_MS});
}

static void say_nothing(void)
{
    for (;;) {
        (void)pause();
    }
}

/* ---- signals ----------------------------------------------------------------------- */

#define TICK_US      50000
#define WAIT_MS      1400 /* longer than the library sleeps at a time */
#define TICKS_AT_END (4 * WAIT_MS * 1000 / TICK_US)

static volatile sig_atomic_t ticks;

/* Ends the wait that would never end otherwise. */
static void tick(int signal)
{
    (void)signal;
    if (++ticks == TICKS_AT_END) {
        (void)kill(false_daemon.child, SIGKILL);
    }
}

static void beat(suseconds_t every_us)
{
    const struct itimerval timer = {.it_interval = {0, every_us},
                                    .it_value = {0, every_us}};
    struct sigaction action = {.sa_handler = tick};

    assert_int_equal(sigaction(SIGALRM, &action, NULL), 0);
    assert_int_equal(setitimer(ITIMER_REAL, &timer, NULL), 0);
}

static void answer_hello_alone(void)
{
    false_hello(PROTO_VERSION_MAX);
    say_nothing();
}

/* If it failed, a program with a profiler's timer, or a game's, would wait for ever for a
 * daemon that hangs. */
CASE_WITH(loss__signals_do_not_put_off_the_deadline, NULL, false_stop)
{
    struct pccd_client *client;
    uint64_t begin_ms;

    false_start(answer_hello_alone);
    client = connect_for(WAIT_MS);
    begin_ms = test_now_ms();
    beat(TICK_US);
    assert_int_equal(pccd_ping(client, NULL), PCCD_E_TIMEOUT);
    beat(0);
    assert_true(test_now_ms() - begin_ms >= WAIT_MS);
    assert_true(test_now_ms() - begin_ms < 3 * WAIT_MS);
    pccd_close(client);
}

/* ---- the descriptor ---------------------------------------------------------------- */

static bool is_readable(const struct pccd_client *client)
{
    struct pollfd watched = {.fd = pccd_fd(client), .events = POLLIN};

    return poll(&watched, 1, 0) == 1;
}

/* End over a ping; the next ones hang before they answer hello. */
static void come_back_and_hang(void)
{
    false_hello(PROTO_VERSION_MAX);
    (void)false_next();
    false_take_client();
    say_nothing();
}

/* If it failed, a loop that watches the descriptor would sleep for ever: nothing would
 * have it look for a daemon again. */
CASE_WITH(loss__the_descriptor_is_ready_until_it_is_over, NULL, false_stop)
{
    struct pccd_client *client;
    struct pccd_answer answer = PCCD_ANSWER_INIT;

    false_start(come_back_and_hang);
    client = connect_for(300);
    assert_int_equal(pccd_ping(client, NULL), PCCD_E_TIMEOUT);
    assert_true(is_readable(client));
    assert_int_equal(pccd_poll(client, &answer), PCCD_E_AGAIN);
    assert_true(is_readable(client));
    pccd_close(client);
}

/* Say what nobody understands; there is no other daemon then. */
static void talk_nonsense_and_stay(void)
{
    false_hello(PROTO_VERSION_MAX);
    (void)unlink(false_daemon.socket_path);
    (void)close(false_daemon.listener);
    (void)false_next();
    (void)proto_send(false_daemon.socket, "\xdd\xff\xff\xff\xff", 5, NULL, 0);
    say_nothing();
}

/* The same, where it is the library that has had enough. */
CASE_WITH(loss__a_connection_that_was_given_up_is_ready, NULL, false_stop)
{
    struct pccd_client *client;

    false_start(talk_nonsense_and_stay);
    client = connect_for(300);
    assert_int_equal(pccd_ping(client, NULL), PCCD_E_TIMEOUT);
    assert_true(is_readable(client));
    pccd_close(client);
}

/* ---- handles ----------------------------------------------------------------------- */

#define WANTED 77

static void attach_again(void)
{
    false_hello(PROTO_VERSION_MAX);
    false_attach(false_good_ring, 2);
    (void)false_next();
}

/* End over a mesh. The next daemon refuses it, and says by that what it was asked for. */
static void end_over_a_mesh(void)
{
    struct proto_MESH_CREATE_request create = {.want = 0};
    struct proto_error error;

    attach_again();
    false_take_client();
    attach_again();
    (void)proto_decode_body(&false_daemon.envelope,
                            &proto_messages[PROTO_METHOD_MESH_CREATE].request, &create,
                            &error);
    false_refuse(create.want == WANTED ? PCCD_E_BUSY : PCCD_E_HANDLE, "");
    (void)false_next();
}

/* If it failed, who repeats a session while daemons die would have its meshes under other
 * handles than it asked for, and know nothing of it. */
CASE_WITH(loss__a_handle_is_wanted_of_the_next_daemon_too, NULL, false_stop)
{
    static const float x[3][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    static const uint32_t triangle[1][3] = {{0, 1, 2}};
    struct pccd_client *client;
    uint32_t mesh = 0;

    false_start(end_over_a_mesh);
    client = connect_for(5000);
    assert_ok(pccd_request_handle(client, WANTED));
    assert_int_equal(
        pccd_mesh_create(client, x, PCCD_FORMAT_F32, 3, triangle, 1, &mesh, NULL),
        PCCD_E_BUSY);
    pccd_close(client);
}

/* ---- calls that do not wait -------------------------------------------------------- */

static void watch_and_end(void)
{
    const struct proto_WATCH_START_result result = {.room = 1};

    false_hello(PROTO_VERSION_MAX);
    (void)false_next();
    false_answer(false_daemon.envelope.id, PROTO_METHOD_WATCH_START, &result, NULL, 0);
}

/* If it failed, who looks for steps now and then would take a daemon that comes back for
 * one that does not answer. */
CASE_WITH(loss__a_watcher_that_does_not_wait_is_told_so, NULL, false_stop)
{
    struct pccd_client *client;
    struct pccd_step_event event;

    false_start(watch_and_end);
    client = connect_for(300);
    assert_ok(pccd_watch_start(client, 0, 0));
    while (!is_readable(client)) {
        test_sleep_ms(1);
    }
    for (int i = 0; i < 5; i++) {
        assert_int_equal(pccd_watch_next(client, 0, &event), PCCD_E_AGAIN);
        assert_non_null(strstr(pccd_error_text(client), "step"));
    }
    pccd_close(client);
}

static void end_after_hello(void)
{
    false_hello(PROTO_VERSION_MAX);
}

/* If it failed, who looks for news without waiting would look for ever after the daemon
 * is gone. */
CASE_WITH(loss__a_daemon_that_is_gone_has_no_news, NULL, false_stop)
{
    struct pccd_client *client;
    struct pccd_scene_news news;

    false_start(end_after_hello);
    client = false_connect_good();
    assert_int_equal(pccd_ping(client, NULL), PCCD_E_DISCONNECTED);
    assert_int_equal(pccd_scene_wait(client, 1, 0, &news), PCCD_E_DISCONNECTED);
    assert_int_equal(pccd_scene_wait(client, 1, -1, &news), PCCD_E_DISCONNECTED);
    assert_int_equal(pccd_wait_held(client, 1, 0), PCCD_E_DISCONNECTED);
    pccd_close(client);
}
