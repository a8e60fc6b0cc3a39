/* test_fault_start.c - a daemon that cannot start says why. */
#include "cases.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "daemon.h"
#include "keeper.h"

#define START_MS   20000u
#define CALLS_MAX  1000u
#define ERRORS_MAX 6

static const struct {
    enum fault_call call;
    int errors[ERRORS_MAX]; /* ends with 0 */
} all[] = {
    {FAULT_bind, {EADDRINUSE, EACCES, ENOMEM}},
    {FAULT_close, {EINTR}},
    {FAULT_epoll_create1, {EMFILE, ENOMEM}},
    {FAULT_eventfd, {EMFILE, ENOMEM}},
    {FAULT_fcntl, {EMFILE}},
    {FAULT_flock, {EINTR, ENOLCK}},
    {FAULT_getrandom, {EAGAIN}},
    {FAULT_inotify_add_watch, {ENOSPC, EACCES}},
    {FAULT_inotify_init1, {EMFILE, ENOSYS}},
    {FAULT_listen, {EADDRINUSE}},
    {FAULT_lstat, {EACCES, ENOMEM}},
    {FAULT_memory, {ENOMEM}},
    {FAULT_mkdir, {EACCES, ENOSPC, EROFS}},
    {FAULT_open, {EMFILE, EACCES, ENOSPC}},
    {FAULT_pipe2, {EMFILE, ENFILE}},
    {FAULT_pthread_create, {EAGAIN}},
    {FAULT_sendto, {ENOBUFS, EPERM}},
    {FAULT_socket, {EMFILE, ENOBUFS}},
    {FAULT_unlink, {EACCES}},
    {FAULT_write, {EINTR}},
};

static struct test_daemon place; /* its folder, socket and log; started by hand */

static pid_t spawn(void)
{
    pid_t pid = fork();
    if (pid == 0) {
        int log = open(place.log, O_WRONLY | O_CREAT | O_TRUNC, 0600);
        (void)prctl(PR_SET_PDEATHSIG, SIGKILL);
        (void)dup2(log, 2);
        execl(getenv("PCCDD"), "pccdd", "--socket", place.socket, "--threads", "1", NULL);
        _exit(127);
    }
    return pid;
}

static bool log_has_text(void)
{
    struct stat info;
    return stat(place.log, &info) == 0 && info.st_size > 0;
}

/* Status 1; or libuv, which cannot set up its loop and aborts, with our report. */
static bool is_in_order(int status)
{
    return (WIFEXITED(status) && WEXITSTATUS(status) == 1) ||
           (WIFSIGNALED(status) && WTERMSIG(status) == SIGABRT &&
            test_daemon_logged(&place, "SIGABRT in process"));
}

/* Return whether the daemon has ended, as it may while it starts. It listens before its
 * loop stands. */
static bool has_given_up(pid_t pid)
{
    uint64_t until_ms = test_now_ms() + 2000;
    int status = 0;
    while (waitpid(pid, &status, WNOHANG) == 0) {
        if (test_now_ms() > until_ms) {
            return false;
        }
        test_sleep_ms(1);
    }
    return is_in_order(status) && log_has_text();
}

/* It serves: a client's whole life, then the end. */
static void expect_service(pid_t pid, bool hit, const char *what)
{
    struct life life;
    int status = 0;
    life_run(&life, place.socket, LIFE_ONCE);
    if (hit && life.is_lost && has_given_up(pid)) {
        return;
    }
    if (life.wrong[0] != '\0' || life.is_lost) {
        fail_msg("%s: it started, and then: %s%s", what, life.wrong,
                 life.is_lost ? "connection lost" : "");
    }
    (void)kill(pid, SIGTERM);
    assert_int_equal(waitpid(pid, &status, 0), pid);
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
        fail_msg("%s: it started, served and ended with %#x", what, (unsigned)status);
    }
}

/* Start with the fault. Returns whether the fault was met. */
static bool try_start(enum fault_call call, uint64_t first, int error)
{
    char what[96];
    struct life life;
    int status = 0;
    (void)snprintf(what, sizeof what, "start, %s %llu, errno %d", fault_name(call),
                   (unsigned long long)first, error);
    fault_order(keeper_page, call, first, 1, error);
    pid_t pid = spawn();
    uint64_t until_ms = test_now_ms() + START_MS;
    bool is_up = false;
    while (!is_up && waitpid(pid, &status, WNOHANG) == 0) {
        if (test_now_ms() > until_ms) {
            (void)kill(pid, SIGKILL);
            fail_msg("%s: it neither serves nor ends", what);
        }
        is_up = test_raw_open(&life.raw, place.socket);
        test_sleep_ms(1);
    }
    bool hit = fault_recall(keeper_page) > 0;
    if (is_up) {
        test_raw_close(&life.raw);
        expect_service(pid, hit, what);
    } else if (!hit || !is_in_order(status) || !log_has_text()) {
        fail_msg("%s: it ended with %#x%s", what, (unsigned)status,
                 log_has_text() ? "" : " and said nothing");
    }
    return hit;
}

/* If this failed, a daemon that cannot start would hang, crash or be silent, and nobody
 * would know what is missing. */
CASE(start__serves_or_says_why_not)
{
    uint64_t stride = keeper_stride(3);
    uint64_t tried = 0;
    for (size_t i = 0; i < sizeof all / sizeof all[0]; i++) {
        for (size_t e = 0; e < ERRORS_MAX && all[i].errors[e] != 0; e++) {
            uint64_t first = 1;
            while (first < CALLS_MAX && try_start(all[i].call, first, all[i].errors[e])) {
                first += stride;
                tried++;
            }
        }
    }
    print_message("# %llu faulty starts\n", (unsigned long long)tried);
}

/* The process that serves, as it says itself. */
static pid_t worker_pid(void)
{
    static struct test_raw raw;
    const struct proto_STATS_request request = {0};
    struct proto_STATS_result stats;
    assert_ok(test_raw_session(&raw, place.socket, 0, 0));
    assert_ok(test_raw_call(&raw, PROTO_METHOD_STATS, &request, &stats));
    test_raw_close(&raw);
    return (pid_t)stats.pid;
}

/* If this failed, a moment without memory after a crash would be the end of the service,
 * though its socket could have been held until it is over. */
CASE(start__of_a_worker_is_tried_again)
{
    static struct life life;
    static const int errors[] = {EAGAIN, ENOMEM};
    assert_true(test_daemon_restart(
        &place, (const char *const[]){"--supervise", "--crashes-max", "64", NULL}));
    for (size_t i = 0; i < 2; i++) {
        fault_order(keeper_page, FAULT_fork, 1, 3, errors[i]);
        /* The next worker may stand by already: no fork then, before the one after it. */
        for (int tries = 0; tries < 20 && atomic_load(&keeper_page->hits) < 3; tries++) {
            pid_t worker = worker_pid();
            assert_int_not_equal(worker, place.pid);
            assert_int_equal(kill(worker, SIGKILL), 0);
            test_sleep_ms(50);
            life_run(&life, place.socket, LIFE_ONCE);
            assert_string_equal(life.wrong, "");
            assert_false(life.is_lost);
        }
        assert_int_equal(fault_recall(keeper_page), 3);
    }
    assert_int_equal(test_daemon_end(&place, SIGTERM, 10000), 0);
}

static int set_up(void **state)
{
    (void)state;
    /* A manager that is not there: it is told, in vain. */
    (void)setenv("NOTIFY_SOCKET", "@pccd-test-nobody", 1);
    if (!keeper_make_page() || !test_daemon_start(&place, NULL)) {
        return -1;
    }
    return test_daemon_end(&place, SIGTERM, 10000) == 0 ? 0 : -1;
}

static int tear_down(void **state)
{
    (void)state;
    keeper_drop_page();
    return test_daemon_finish(&place) ? 0 : -1;
}

CASES_WITH(set_up, tear_down);
