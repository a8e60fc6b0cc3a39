/* test_int_supervise.c - a daemon that is started again, and one that is given a
 * socket. */
#include "cases.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/ptrace.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include "daemon.h"
#include "messages.h"
#include "raw.h"

#define END_MS 10000

static const char *const supervised[] = {"--supervise", "--threads", "1", NULL};

struct fixture {
    struct test_daemon daemon;
    struct test_raw raw;
};

/* Say hello on a new connection; the process that answers. */
static pid_t meet(struct fixture *f)
{
    struct proto_HELLO_request hello = {.version_min = 1, .version_max = 1};
    struct proto_HELLO_result result;
    assert_true(test_raw_open(&f->raw, f->daemon.socket));
    assert_ok(test_raw_call(&f->raw, PROTO_METHOD_HELLO, &hello, &result));
    return (pid_t)result.pid;
}

/* Wait until the peer of the connection is gone, and close our end. */
static void see_it_end(struct fixture *f)
{
    uint64_t until_ms = test_now_ms() + END_MS;
    while (test_raw_receive(&f->raw) > 0 && test_now_ms() < until_ms) {
    }
    assert_true(test_now_ms() < until_ms);
    test_raw_close(&f->raw);
}

static int setup(void **state)
{
    struct fixture *f = calloc(1, sizeof *f);
    *state = f;
    return f != NULL && test_daemon_start(&f->daemon, supervised) ? 0 : -1;
}

static int teardown(void **state)
{
    struct fixture *f = *state;
    (void)test_daemon_finish(&f->daemon);
    free(f);
    return 0;
}

static bool is_logged_soon(const struct fixture *f, const char *text)
{
    for (int i = 0; i < END_MS / 10 && !test_daemon_logged(&f->daemon, text); i++) {
        test_sleep_ms(10);
    }
    return test_daemon_logged(&f->daemon, text);
}

static bool tells_the_end_of(const struct fixture *f, pid_t worker)
{
    char text[64];
    (void)snprintf(text, sizeof text, "worker %ld was ended by signal 9", (long)worker);
    return is_logged_soon(f, text);
}

/* If the socket went with the worker, a client that comes while the next one starts would
 * be refused. */
CASE_WITH(supervise__clients_reach_the_next_worker, setup, teardown)
{
    struct fixture *f = *state;
    pid_t first = meet(f);
    assert_int_not_equal(first, f->daemon.pid);
    assert_int_equal(kill(first, SIGKILL), 0);
    see_it_end(f);
    pid_t second = meet(f);
    assert_int_not_equal(second, first);
    assert_int_equal(kill(f->daemon.pid, 0), 0);
    test_raw_close(&f->raw);
    assert_int_equal(test_daemon_end(&f->daemon, SIGTERM, END_MS), 0);
}

/* If it failed, clients would wait for a program to be loaded whenever one crashes. */
CASE_WITH(supervise__has_a_spare_worker, setup, teardown)
{
    struct fixture *f = *state;
    char text[64];
    pid_t first;
    pid_t second;
    (void)test_daemon_end(&f->daemon, SIGTERM, END_MS);
    assert_true(test_daemon_restart(&f->daemon,
                                    (const char *const[]){"--supervise", "--threads", "1",
                                                          "--log-level", "debug", NULL}));
    for (int round = 0; round < 3; round++) {
        first = meet(f);
        assert_true(is_logged_soon(f, " stands by"));
        test_sleep_ms(300); /* the next one is made a tenth of a second after a start */
        assert_int_equal(kill(first, SIGKILL), 0);
        see_it_end(f);
        second = meet(f);
        (void)snprintf(text, sizeof text, "process %ld stands by", (long)second);
        assert_true(test_daemon_logged(&f->daemon, text));
        test_raw_close(&f->raw);
    }
    assert_int_equal(test_daemon_end(&f->daemon, SIGTERM, END_MS), 0);
    assert_int_equal(kill(second, 0), -1);
}

/* If nothing were said, nobody could find out why a daemon came back. */
CASE_WITH(supervise__tells_what_a_worker_died_of, setup, teardown)
{
    struct fixture *f = *state;
    pid_t first = meet(f);
    assert_int_equal(kill(first, SIGABRT), 0);
    see_it_end(f);
    assert_int_not_equal(meet(f), first);
    test_raw_close(&f->raw);
    assert_true(test_daemon_logged(&f->daemon, "SIGABRT in process "));
    assert_true(test_daemon_logged(&f->daemon, "(loop), request none"));
    assert_true(is_logged_soon(f, " was ended by signal 6 "));
}

/* Kill a worker so that its parent cannot see it end: a process that is traced is reaped
 * by its tracer first. */
static void kill_unseen(struct fixture *f, pid_t worker)
{
    if (ptrace(PTRACE_SEIZE, worker, NULL, NULL) != 0) {
        print_message("ptrace: %s\n", strerror(errno));
        test_skip("this process may not trace another");
    }
    assert_int_equal(kill(worker, SIGKILL), 0);
    see_it_end(f);
}

static void let_it_be_seen(pid_t worker)
{
    int status = 0;
    assert_int_equal(waitpid(worker, &status, __WALL), worker);
    assert_true(WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL);
}

/* If the next worker began only when the last one is reaped, clients would wait until all
 * sockets of a thousand others are closed; and if only one could be unreaped, a daemon
 * that crashes twice in a row would stay away. */
CASE_WITH(supervise__replaces_a_worker_before_it_is_gone, setup, teardown)
{
    struct fixture *f = *state;
    pid_t first = meet(f);
    kill_unseen(f, first);
    pid_t second = meet(f);
    assert_int_not_equal(second, first);
    kill_unseen(f, second);
    pid_t third = meet(f);
    assert_true(third != first && third != second);
    assert_false(test_daemon_logged(&f->daemon, "was ended by signal"));
    let_it_be_seen(second);
    assert_true(tells_the_end_of(f, second));
    let_it_be_seen(first);
    assert_true(tells_the_end_of(f, first));
    test_raw_close(&f->raw);
    assert_int_equal(meet(f), third); /* neither was taken for it */
    assert_int_equal(test_daemon_end(&f->daemon, SIGTERM, END_MS), 0);
    see_it_end(f);
}

/* If crashes that are not reaped were not counted, it would start workers without end. */
CASE_WITH(supervise__counts_workers_that_are_not_gone, setup, teardown)
{
    struct fixture *f = *state;
    pid_t workers[5];
    for (int i = 0; i < 5; i++) {
        workers[i] = meet(f);
        kill_unseen(f, workers[i]);
    }
    test_sleep_ms(300);
    assert_int_equal(kill(f->daemon.pid, 0), 0); /* it waits to say what the fifth was */
    for (int i = 4; i >= 0; i--) {
        let_it_be_seen(workers[i]);
    }
    int status = test_daemon_end(&f->daemon, 0, END_MS);
    assert_true(WIFEXITED(status) && WEXITSTATUS(status) == 1);
    assert_true(tells_the_end_of(f, workers[4]));
    assert_true(test_daemon_logged(&f->daemon, "giving up: 5 crashes within 10 seconds"));
}

static const char *const talkative[] = {"--supervise", "--threads", "1",
                                        "--log-level", "debug",     NULL};

/* Start anew with a log that tells all, and wait for a spare worker: the first number
 * before " stands by". */
static pid_t start_with_spare(struct fixture *f, pid_t *worker)
{
    static char log[65536];
    (void)test_daemon_end(&f->daemon, SIGTERM, END_MS);
    assert_true(test_daemon_restart(&f->daemon, talkative));
    *worker = meet(f);
    assert_true(is_logged_soon(f, " stands by"));
    FILE *file = fopen(f->daemon.log, "r");
    assert_non_null(file);
    log[fread(log, 1, sizeof log - 1, file)] = '\0';
    (void)fclose(file);
    const char *at = strstr(log, " stands by");
    while (at[-1] != ' ') {
        at--;
    }
    return (pid_t)strtol(at, NULL, 10);
}

/* The same, of a worker that this test can trace: a sanitizer that looked for leaks at
 * its end would trace it itself. */
static pid_t start_to_be_traced(struct fixture *f, pid_t *worker)
{
    const char *set = getenv("LSAN_OPTIONS");
    char before[1024];
    (void)snprintf(before, sizeof before, "%s", set != NULL ? set : "");
    (void)setenv("LSAN_OPTIONS", "detect_leaks=0", 1);
    pid_t spare = start_with_spare(f, worker);
    (void)setenv("LSAN_OPTIONS", before, 1);
    return spare;
}

/* If the end of a worker that ends in order were taken for a crash, another one would be
 * started, and serve on nobody's order. */
CASE_WITH(supervise__ends_when_its_worker_ends_in_order, setup, teardown)
{
    struct fixture *f = *state;
    char text[64];
    pid_t worker;
    pid_t spare = start_to_be_traced(f, &worker);
    int status = -1;
    if (ptrace(PTRACE_SEIZE, worker, NULL, NULL) != 0) {
        test_skip("this process may not trace another");
    }
    assert_int_equal(kill(worker, SIGTERM), 0);
    for (int i = 0; i < 20; i++) { /* a thread that is traced stops at a signal */
        siginfo_t info = {.si_pid = 0};
        if (waitid(P_PID, (id_t)worker, &info, WSTOPPED | WNOHANG) == 0 &&
            info.si_pid == worker) {
            assert_int_equal(ptrace(PTRACE_CONT, worker, NULL, SIGTERM), 0);
        }
        test_sleep_ms(10);
    }
    see_it_end(f);
    test_sleep_ms(300); /* all that is closed has been seen; what it died of has not */
    (void)snprintf(text, sizeof text, "process %ld listens on ", (long)spare);
    assert_false(test_daemon_logged(&f->daemon, text));
    assert_int_equal(waitpid(worker, &status, __WALL), worker);
    assert_int_equal(status, 0);
    assert_int_equal(test_daemon_end(&f->daemon, 0, END_MS), 0);
    assert_false(test_daemon_logged(&f->daemon, text));
    assert_false(test_daemon_logged(&f->daemon, "worker "));
}

/* If a worker that is stopped were taken for one that is gone, two would serve. */
CASE_WITH(supervise__waits_for_a_worker_that_is_stopped, setup, teardown)
{
    struct fixture *f = *state;
    pid_t worker = meet(f);
    test_raw_close(&f->raw);
    assert_int_equal(kill(worker, SIGSTOP), 0);
    test_sleep_ms(300);
    assert_int_equal(kill(worker, SIGCONT), 0);
    assert_int_equal(meet(f), worker);
    test_raw_close(&f->raw);
}

/* If a spare that has died were told to go on, nobody would serve. */
CASE_WITH(supervise__does_without_a_spare_that_has_died, setup, teardown)
{
    struct fixture *f = *state;
    pid_t worker;
    pid_t spare = start_with_spare(f, &worker);
    assert_int_equal(kill(spare, SIGKILL), 0);
    assert_int_equal(kill(worker, SIGKILL), 0);
    see_it_end(f);
    pid_t next = meet(f);
    assert_true(next != worker && next != spare);
    test_raw_close(&f->raw);
    assert_true(tells_the_end_of(f, worker));
}

/* If it went on for ever, a daemon that cannot start would burn a processor. */
CASE_WITH(supervise__gives_up_after_five_crashes, setup, teardown)
{
    struct fixture *f = *state;
    for (int i = 0; i < 5; i++) {
        pid_t worker = meet(f);
        assert_int_equal(kill(worker, SIGKILL), 0);
        see_it_end(f);
    }
    int status = test_daemon_end(&f->daemon, 0, END_MS);
    assert_true(WIFEXITED(status) && WEXITSTATUS(status) == 1);
    assert_true(test_daemon_logged(&f->daemon, "giving up: 5 crashes within 10 seconds"));
    assert_int_equal(access(f->daemon.socket, F_OK), -1);
}

/* If the number could not be chosen, nobody could put a daemon to the test by killing it
 * again and again; if it were not kept, a larger one would never give up. */
CASE_WITH(supervise__bears_as_many_crashes_as_it_is_told, setup, teardown)
{
    static const char *const hardy[] = {
        "--supervise", "--crashes-max", "7", "--threads", "1", NULL};
    struct fixture *f = *state;
    assert_int_equal(test_daemon_end(&f->daemon, SIGTERM, END_MS), 0);
    assert_true(test_daemon_restart(&f->daemon, hardy));
    for (int i = 0; i < 7; i++) {
        pid_t worker = meet(f);
        assert_int_equal(kill(worker, SIGKILL), 0);
        see_it_end(f);
    }
    int status = test_daemon_end(&f->daemon, 0, END_MS);
    assert_true(WIFEXITED(status) && WEXITSTATUS(status) == 1);
    assert_true(test_daemon_logged(&f->daemon, "giving up: 7 crashes within 10 seconds"));
}

/* If a signal ended the parent alone, a worker without a socket path would stay. */
CASE_WITH(supervise__ends_with_its_worker, setup, teardown)
{
    struct fixture *f = *state;
    (void)meet(f);
    assert_int_equal(test_daemon_end(&f->daemon, SIGTERM, END_MS), 0);
    see_it_end(f);
    assert_int_equal(access(f->daemon.socket, F_OK), -1);
}

/* If a worker outlived its parent, two daemons could serve one path. */
CASE_WITH(supervise__worker_goes_when_its_parent_dies, setup, teardown)
{
    struct fixture *f = *state;
    assert_int_equal(prctl(PR_SET_CHILD_SUBREAPER, 1), 0); /* its orphan is ours */
    pid_t worker = meet(f);
    (void)test_daemon_end(&f->daemon, SIGKILL, END_MS);
    see_it_end(f);
    int status = -1;
    assert_int_equal(waitpid(worker, &status, 0), worker);
    assert_int_equal(status, 0);
    assert_true(test_daemon_restart(&f->daemon, supervised));
    assert_int_not_equal(meet(f), worker);
    test_raw_close(&f->raw);
}

/* ---- a socket from outside --------------------------------------------------------- */

static int listen_at(const char *path, int type)
{
    struct sockaddr_un address = {.sun_family = AF_UNIX};
    int fd = socket(AF_UNIX, type | SOCK_CLOEXEC, 0);
    snprintf(address.sun_path, sizeof address.sun_path, "%s", path);
    assert_true(fd >= 0);
    assert_int_equal(bind(fd, (const struct sockaddr *)&address, sizeof address), 0);
    assert_int_equal(listen(fd, 8), 0);
    return fd;
}

/* A daemon with that socket as descriptor 3, as systemd starts one. */
static pid_t start_with(const struct fixture *f, int fd)
{
    pid_t pid = fork();
    if (pid == 0) {
        char text[32];
        int log = open(f->daemon.log, O_WRONLY | O_CREAT | O_APPEND, 0600);
        snprintf(text, sizeof text, "%ld", (long)getpid());
        if (dup2(log, 2) == 2 && dup2(fd, 3) == 3 &&
            fcntl(3, F_SETFD, 0) == 0 /* if fd was 3 */ &&
            setenv("LISTEN_PID", text, 1) == 0 && setenv("LISTEN_FDS", "1", 1) == 0) {
            execl(getenv("PCCDD"), "pccdd", "--threads", "1", (char *)NULL);
        }
        _exit(127);
    }
    return pid;
}

/* If it opened a socket of its own, or removed the one it was given, clients of the next
 * start would find nobody. */
CASE_WITH(activate__serves_on_the_socket_it_is_given, setup, teardown)
{
    struct fixture *f = *state;
    char path[96];
    char kept[sizeof f->daemon.socket];
    snprintf(path, sizeof path, "%s/a", f->daemon.directory);
    int fd = listen_at(path, SOCK_SEQPACKET);
    memcpy(kept, f->daemon.socket, sizeof kept);
    snprintf(f->daemon.socket, sizeof f->daemon.socket, "%.79s", path);
    for (int i = 0; i < 2; i++) {
        int status = -1;
        pid_t pid = start_with(f, fd);
        assert_int_equal(meet(f), pid);
        assert_int_equal(kill(pid, SIGTERM), 0);
        see_it_end(f);
        assert_int_equal(waitpid(pid, &status, 0), pid);
        assert_int_equal(status, 0);
        assert_int_equal(access(path, F_OK), 0);
    }
    memcpy(f->daemon.socket, kept, sizeof kept);
    close(fd);
}

/* If any socket were taken, a wrong unit file would show as clients that hang. */
CASE_WITH(activate__refuses_a_socket_of_another_kind, setup, teardown)
{
    struct fixture *f = *state;
    char path[96];
    int status = -1;
    snprintf(path, sizeof path, "%s/b", f->daemon.directory);
    int fd = listen_at(path, SOCK_STREAM);
    pid_t pid = start_with(f, fd);
    assert_int_equal(waitpid(pid, &status, 0), pid);
    assert_true(WIFEXITED(status) && WEXITSTATUS(status) == 1);
    assert_true(test_daemon_logged(&f->daemon, "not a listening SOCK_SEQPACKET socket"));
    close(fd);
}
