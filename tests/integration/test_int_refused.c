/* test_int_refused.c - clients beyond the quota, more than have places. */
#include "cases.h"

#include <grp.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "crossing.h"
#include "daemon.h"
#include "fixture.h"
#include "must.h"
#include "pccd.h"
#include "raw.h"

#define BEYOND 200u

/* If it failed, a client that comes when many are refused already would be cut off and
 * not told why; or those that are would take the places of others. */
CASE_DAEMON(refused__every_client_beyond_the_quota_hears_so, "--clients-max", "8",
            "--connections-max", "64")
{
    static struct test_raw raws[BEYOND];
    static struct test_raw late;
    struct proto_HELLO_request hello = {.version_min = 1, .version_max = 1};
    unsigned heard = 0;
    unsigned told = 0;

    struct pccd_client *client = test_client_at(test_own.url);
    for (unsigned i = 0; i < BEYOND; i++) { /* the first seven have a place */
        assert_true(test_raw_open(&raws[i], test_own.socket));
        if (i % 2 == 1 || i < 7) { /* the others wait, silent */
            int status = test_raw_call(&raws[i], PROTO_METHOD_HELLO, &hello, NULL);

            assert_int_equal(status, i < 7 ? 0 : PCCD_E_QUOTA);
            heard += status == PCCD_E_QUOTA;
        }
    }
    assert_ok(pccd_ping(client, NULL));
    for (unsigned i = 8; i < BEYOND; i += 2) {
        uint32_t id = test_raw_request(&raws[i], PROTO_METHOD_HELLO, &hello);
        int status = id != 0 ? test_raw_answer(&raws[i], id, PROTO_METHOD_HELLO, NULL)
                             : test_raw_receive(&raws[i]); /* told before it had spoken */

        if (id == 0 && status == 0) {
            status = raws[i].envelope.error.code;
            told++;
        }
        assert_int_equal(status, PCCD_E_QUOTA);
        heard++;
    }
    assert_int_equal(heard, BEYOND - 7);
    assert_true(told > 0);
    assert_true(test_raw_open(&late, test_own.socket));
    assert_int_equal(test_raw_hello(&late), PCCD_E_QUOTA);
    test_raw_close(&late);
    for (unsigned i = 0; i < BEYOND; i++) {
        test_raw_close(&raws[i]);
    }
    assert_ok(pccd_ping(client, NULL));
    pccd_close(client);
}

/* As somebody who may not be a client: connect BEYOND times without a word, and stay. */
static void crowd(const struct test_daemon *daemon, int told)
{
    static struct test_raw raws[BEYOND];
    bool is_there = setgroups(0, NULL) == 0 && setgid(7) == 0 && setuid(65534) == 0;

    test_end_with_parent();
    for (unsigned i = 0; i < BEYOND && is_there; i++) {
        is_there = test_raw_open(&raws[i], daemon->socket);
    }
    if (is_there && write(told, "1", 1) == 1) {
        (void)pause();
    }
    _exit(1);
}

/* If it failed, those who are refused could use up the descriptors of others. */
CASE(refused__give_way_when_descriptors_are_short)
{
    const char *const options[] = {"--allow-gid", "54321", NULL};
    static struct test_raw clients[40];
    struct rlimit before;
    struct rlimit few;
    struct test_daemon daemon;
    int status = 0;
    int told[2];
    char byte;

    if (geteuid() != 0) {
        test_skip(TEST_ONLY_ROOT);
    }
    assert_int_equal(pipe(told), 0);
    assert_int_equal(getrlimit(RLIMIT_NOFILE, &before), 0);
    few = before;
    few.rlim_cur = 120;
    assert_int_equal(setrlimit(RLIMIT_NOFILE, &few), 0); /* the daemon's */
    bool started = test_daemon_start(&daemon, options);
    assert_int_equal(setrlimit(RLIMIT_NOFILE, &before), 0);
    assert_true(started);
    assert_int_equal(chmod(daemon.directory, 0755), 0);
    pid_t child = fork();
    if (child == 0) {
        crowd(&daemon, told[1]);
    }
    assert_int_equal(read(told[0], &byte, 1), 1);
    for (unsigned i = 0; i < 40; i++) {
        assert_ok(test_raw_session(&clients[i], daemon.socket, 0, 0));
    }
    assert_int_equal(kill(child, SIGKILL), 0);
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFSIGNALED(status)); /* it was there all the time */
    for (unsigned i = 0; i < 40; i++) {
        test_raw_close(&clients[i]);
    }
    (void)close(told[0]);
    (void)close(told[1]);
    assert_true(test_daemon_finish(&daemon));
}

#define OBSERVERS_MAX 8 /* that take no place of a client */

static int observe(const char *url, struct pccd_client **client)
{
    struct pccd_options options;

    pccd_options_init(&options);
    options.url = url;
    options.observes = true;
    return pccd_connect(&options, client);
}

/* If it failed, a user who has as many clients as may be could not see that, nor let more
 * in, as pccdctl doctor advises. */
CASE_DAEMON(refused__who_observes_takes_no_place, "--clients-max", "1")
{
    struct pccd_client *clients[OBSERVERS_MAX];
    struct pccd_client *client;
    struct pccd_client *other = NULL;
    uint32_t scene = 0;

    client = test_client_at(test_own.url);
    for (int i = 0; i < OBSERVERS_MAX; i++) {
        assert_int_equal(observe(test_own.url, &clients[i]), 0);
        assert_int_equal(test_stat(clients[i], "sessions_now"), i + 2);
    }
    assert_int_equal(observe(test_own.url, &other),
                     PCCD_E_QUOTA); /* these have a bound */
    assert_int_equal(pccd_scene_create(clients[0], NULL, &scene), PCCD_E_STATE);
    assert_ok(pccd_config_set(clients[0], "clients-max", "2"));
    other = test_client_at(test_own.url);
    scene = test_scene(other);
    pccd_close(clients[0]); /* its place is another observer's */
    for (int i = 0; i < 1000 && observe(test_own.url, &clients[0]) != 0; i++) {
        test_sleep_ms(10);
    }
    assert_ok(pccd_ping(clients[0], NULL));
    for (int i = 0; i < OBSERVERS_MAX; i++) {
        pccd_close(clients[i]);
    }
    pccd_close(other);
    pccd_close(client);
}

/* If it failed, nobody could see or change anything while all connections are taken: the
 * remedy that pccdctl doctor recommends waited behind them. */
CASE_DAEMON(refused__owner_is_heard_when_all_connections_are_taken, "--connections-max",
            "3")
{
    struct pccd_client *clients[3];
    struct pccd_client *owner = NULL;
    struct pccd_client *other = NULL;
    struct pccd_options wanted;

    for (int i = 0; i < 3; i++) {
        clients[i] = test_client_at(test_own.url);
    }
    pccd_options_init(&wanted);
    wanted.url = test_own.url;
    assert_int_equal(pccd_connect(&wanted, &other), PCCD_E_QUOTA);
    assert_non_null(strstr(pccd_error_text(NULL), "--connections-max"));
    assert_int_equal(observe(test_own.url, &owner), 0);
    assert_int_equal(test_stat(owner, "sessions_now"), 4);
    assert_ok(pccd_config_set(owner, "connections-max", "2"));
    assert_int_equal(pccd_connect(&wanted, &other), PCCD_E_QUOTA);
    pccd_close(clients[2]);
    pccd_close(owner);
    assert_int_equal(observe(test_own.url, &owner), 0); /* also below what there are */
    assert_ok(pccd_config_set(owner, "connections-max", "3"));
    pccd_close(owner);
    for (int i = 0; i < 1000 && pccd_connect(&wanted, &clients[2]) != 0; i++) {
        test_sleep_ms(10);
    }
    assert_ok(pccd_ping(clients[2], NULL));
    for (int i = 0; i < 3; i++) {
        pccd_close(clients[i]);
    }
}

/* As somebody else: what an observer hears when all connections are taken. */
static void observe_as_another(const struct test_daemon *daemon)
{
    struct pccd_client *client = NULL;
    bool is_other = setgroups(0, NULL) == 0 && setgid(7) == 0 && setuid(65534) == 0;
    test_end_with_parent();
    int status = is_other ? observe(daemon->url, &client) : 0;
    _exit(status == PCCD_E_QUOTA ? 7 : 1);
}

/* If it failed, others could take what is kept back for the daemon's owner. */
CASE(refused__others_have_no_connection_kept_back)
{
    const char *const options[] = {"--connections-max", "1", "--allow-uid", "65534",
                                   NULL};
    struct test_daemon daemon;
    int status = 0;

    if (geteuid() != 0) {
        test_skip(TEST_ONLY_ROOT);
    }
    assert_true(test_daemon_start(&daemon, options));
    assert_int_equal(chmod(daemon.directory, 0755), 0);
    struct pccd_client *client = test_client_at(daemon.url);
    pid_t child = fork();
    if (child == 0) {
        observe_as_another(&daemon);
    }
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFEXITED(status) && WEXITSTATUS(status) == 7);
    pccd_close(client);
    assert_true(test_daemon_finish(&daemon));
}
