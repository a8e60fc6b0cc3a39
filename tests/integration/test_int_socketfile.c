/* test_int_socketfile.c - a daemon whose socket's file is removed or replaced. */
#include "cases.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include "daemon.h"
#include "raw.h"

#ifdef PCCD_SANITIZED /* ten times as slow */
#define SOON_MS 10000u
#else
#define SOON_MS 1000u
#endif
#define END_MS 10000

static const char *const alone[] = {"--threads", "1", NULL};
static const char *const supervised[] = {"--supervise", "--threads", "1", NULL};

struct fixture {
    struct test_daemon daemon;
    struct test_raw first;
    struct test_raw second;
};

static int start(void **state, const char *const *options)
{
    struct fixture *f = calloc(1, sizeof *f);
    *state = f;
    return f != NULL && test_daemon_start(&f->daemon, options) ? 0 : -1;
}

static int setup(void **state)
{
    return start(state, alone);
}

static int setup_supervised(void **state)
{
    return start(state, supervised);
}

static int teardown(void **state)
{
    struct fixture *f = *state;
    bool in_order = test_daemon_finish(&f->daemon);
    free(f);
    return in_order ? 0 : -1;
}

static pid_t say_hello(struct test_raw *raw)
{
    struct proto_HELLO_request hello = {.version_min = 1, .version_max = 1};
    struct proto_HELLO_result result;
    assert_ok(test_raw_call(raw, PROTO_METHOD_HELLO, &hello, &result));
    return (pid_t)result.pid;
}

static pid_t meet(const struct fixture *f, struct test_raw *raw)
{
    assert_true(test_raw_open(raw, f->daemon.socket));
    return say_hello(raw);
}

/* As soon as somebody listens there, which must be within a second. */
static pid_t meet_soon(const struct fixture *f, struct test_raw *raw)
{
    uint64_t until_ms = test_now_ms() + SOON_MS;
    while (!test_raw_open(raw, f->daemon.socket)) {
        assert_true(test_now_ms() < until_ms);
        test_sleep_ms(10);
    }
    return say_hello(raw);
}

static void assert_serves(struct test_raw *raw)
{
    struct proto_PING_request request = {0};
    struct proto_PING_result result;
    assert_ok(test_raw_call(raw, PROTO_METHOD_PING, &request, &result));
}

static void assert_logs_soon(const struct fixture *f, const char *text)
{
    for (unsigned i = 0; i < SOON_MS / 10 && !test_daemon_logged(&f->daemon, text); i++) {
        test_sleep_ms(10);
    }
    assert_true(test_daemon_logged(&f->daemon, text));
}

/* Times that a process's first thread was put to sleep. */
static unsigned long switches_of(pid_t pid)
{
    char path[64];
    char line[256];
    unsigned long count = 0;
    (void)snprintf(path, sizeof path, "/proc/%ld/status", (long)pid);
    FILE *file = fopen(path, "r");
    assert_non_null(file);
    while (fgets(line, sizeof line, file) != NULL) {
        (void)sscanf(line, "voluntary_ctxt_switches: %lu", &count);
    }
    (void)fclose(file);
    return count;
}

/* If it failed, a daemon whose file somebody deletes would hold its lock and serve nobody
 * for ever. */
CASE_WITH(socketfile__removed_is_served_again, setup, teardown)
{
    struct fixture *f = *state;
    pid_t pid = meet(f, &f->first);
    for (int i = 0; i < 5; i++) {
        assert_int_equal(unlink(f->daemon.socket), 0);
        assert_int_equal(meet_soon(f, &f->second), pid);
        assert_serves(&f->first);
        test_raw_close(&f->second);
    }
    assert_true(test_daemon_logged(&f->daemon, "listening there again"));
    test_raw_close(&f->first);
}

/* If it failed, whoever connected just before would be turned away, though the daemon
 * went on. */
CASE_WITH(socketfile__removed_loses_nobody_who_waits, setup, teardown)
{
    struct fixture *f = *state;
    pid_t pid = f->daemon.pid;
    assert_true(test_stop(pid));
    assert_true(test_raw_open(&f->first, f->daemon.socket));
    assert_int_equal(unlink(f->daemon.socket), 0);
    assert_int_equal(kill(pid, SIGCONT), 0);
    assert_int_equal(meet_soon(f, &f->second), pid);
    assert_int_equal(say_hello(&f->first), pid);
    test_raw_close(&f->first);
    test_raw_close(&f->second);
}

/* If it failed, a supervisor would keep a worker that nobody can reach, or the next
 * worker would listen where nobody comes. */
CASE_WITH(socketfile__removed_is_served_again_by_a_worker, setup_supervised, teardown)
{
    struct fixture *f = *state;
    pid_t worker = meet(f, &f->first);
    for (int i = 0; i < 3; i++) {
        assert_int_equal(unlink(f->daemon.socket), 0);
        assert_int_equal(meet_soon(f, &f->second), worker);
        assert_serves(&f->first);
        test_raw_close(&f->second);
    }
    test_raw_close(&f->first);
    assert_int_equal(kill(worker, SIGKILL), 0);
    test_sleep_ms(300); /* there is a spare one again */
    pid_t next = meet_soon(f, &f->first);
    assert_int_not_equal(next, worker);
    test_raw_close(&f->first);
    assert_int_equal(kill(next, SIGKILL), 0);
    assert_int_not_equal(meet_soon(f, &f->first), next);
    test_raw_close(&f->first);
}

/* Remove socket and lock; the daemon lets go, another one takes the path, and the first
 * ends when its client leaves, without touching what is the other's. */
static void let_go_and_take_over(struct fixture *f, const char *const *options)
{
    char lock[96];
    struct test_daemon other = f->daemon;
    (void)snprintf(lock, sizeof lock, "%s.lock", f->daemon.socket);
    pid_t pid = meet(f, &f->first);
    assert_int_equal(unlink(lock), 0);
    assert_int_equal(unlink(f->daemon.socket), 0);
    assert_logs_soon(f, "giving up this path");
    assert_serves(&f->first);
    other.pid = 0;
    other.group = other.guard = 0;
    assert_true(test_daemon_restart(&other, options));
    assert_int_not_equal(meet_soon(f, &f->second), pid);
    assert_serves(&f->first);
    test_raw_close(&f->first);
    assert_int_equal(test_daemon_end(&f->daemon, 0, END_MS), 0);
    test_raw_close(&f->second);
    (void)meet(f, &f->second);
    test_raw_close(&f->second);
    assert_int_equal(test_daemon_start_second(&other), 1); /* its lock is there, too */
    assert_int_equal(test_daemon_end(&other, SIGTERM, END_MS), 0);
}

/* If it failed, two daemons would fight for a path, or one remove the other's socket. */
CASE_WITH(socketfile__without_its_lock_is_let_go, setup, teardown)
{
    let_go_and_take_over(*state, alone);
}

/* If it failed, daemons that have supervisors would fight for a path, or remove a socket
 * of others. */
CASE_WITH(socketfile__without_its_lock_is_let_go_by_a_supervisor, setup_supervised,
          teardown)
{
    let_go_and_take_over(*state, supervised);
}

/* If it failed, a daemon without clients would stay for ever where nobody finds it. */
CASE_WITH(socketfile__in_a_folder_that_was_renamed_is_let_go, setup, teardown)
{
    struct fixture *f = *state;
    char moved[96];
    (void)snprintf(moved, sizeof moved, "%s-moved", f->daemon.directory);
    assert_int_equal(rename(f->daemon.directory, moved), 0);
    int status = test_daemon_end(&f->daemon, 0, END_MS);
    assert_int_equal(rename(moved, f->daemon.directory), 0);
    assert_int_equal(status, 0);
    assert_true(test_daemon_logged(&f->daemon, "giving up this path"));
}

/* If it failed, rm -rf would not get rid of the folder, or the daemon would stay. */
CASE_WITH(socketfile__removed_with_its_folder_is_let_go, setup, teardown)
{
    struct fixture *f = *state;
    char command[160];
    (void)snprintf(command, sizeof command, "rm -rf %s", f->daemon.directory);
    assert_int_equal(system(command), 0);
    assert_int_equal(test_daemon_end(&f->daemon, 0, END_MS), 0);
    assert_int_equal(access(f->daemon.directory, F_OK), -1);
}

static int listen_at(const char *path)
{
    struct sockaddr_un address = {.sun_family = AF_UNIX};
    int fd = socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0);
    (void)snprintf(address.sun_path, sizeof address.sun_path, "%.107s", path);
    assert_true(fd >= 0);
    assert_int_equal(bind(fd, (const struct sockaddr *)&address, sizeof address), 0);
    assert_int_equal(listen(fd, 8), 0);
    return fd;
}

/* If it failed, the daemon would remove a socket that somebody else has put there. */
CASE_WITH(socketfile__replaced_is_left_to_whom_it_belongs, setup, teardown)
{
    struct fixture *f = *state;
    char path[96];
    struct stat info;
    (void)snprintf(path, sizeof path, "%s/other", f->daemon.directory);
    int fd = listen_at(path);
    (void)meet(f, &f->first);
    assert_int_equal(rename(path, f->daemon.socket), 0);
    assert_logs_soon(f, "giving up this path");
    assert_serves(&f->first);
    test_raw_close(&f->first);
    assert_int_equal(test_daemon_end(&f->daemon, 0, END_MS), 0);
    assert_int_equal(lstat(f->daemon.socket, &info), 0);
    assert_int_equal(unlink(f->daemon.socket), 0);
    (void)close(fd);
}

/* If it failed, nobody would hear why clients do not find a service of systemd's. */
CASE_WITH(socketfile__of_systemd_is_told_of, setup, teardown)
{
    struct fixture *f = *state;
    char path[96];
    int status = -1;
    (void)snprintf(path, sizeof path, "%s/given", f->daemon.directory);
    int fd = listen_at(path);
    pid_t pid = fork();
    if (pid == 0) {
        char text[32];
        int log = open(f->daemon.log, O_WRONLY | O_CREAT | O_APPEND, 0600);
        (void)snprintf(text, sizeof text, "%ld", (long)getpid());
        test_end_with_parent();
        if (dup2(log, 2) == 2 && dup2(fd, 3) == 3 && fcntl(3, F_SETFD, 0) == 0 &&
            setenv("LISTEN_PID", text, 1) == 0 && setenv("LISTEN_FDS", "1", 1) == 0) {
            execl(getenv("PCCDD"), "pccdd", "--threads", "1", (char *)NULL);
        }
        _exit(127);
    }
    assert_true(test_raw_open(&f->first, path));
    assert_int_equal(say_hello(&f->first), pid);
    assert_int_equal(unlink(path), 0);
    assert_logs_soon(f, "systemctl restart pccdd.socket");
    assert_serves(&f->first);
    test_raw_close(&f->first);
    assert_int_equal(kill(pid, SIGTERM), 0);
    assert_int_equal(waitpid(pid, &status, 0), pid);
    assert_int_equal(status, 0);
    (void)close(fd);
}

/* If it failed, to notice would cost an idle machine its rest: also where the folder is
 * busy. */
CASE_WITH(socketfile__is_watched_without_waking, setup, teardown)
{
    struct fixture *f = *state;
    char path[96];
    if (TEST_HAS_FOREIGN_THREAD) {
        test_skip("a sanitizer's thread wakes the daemon ten times a second");
    }
    pid_t pid = meet(f, &f->first);
    (void)snprintf(path, sizeof path, "%s/busy", f->daemon.directory);
    test_sleep_ms(300);
    unsigned long before = switches_of(pid);
    for (int i = 0; i < 50; i++) {
        int fd = open(path, O_WRONLY | O_CREAT, 0600);
        assert_int_equal(write(fd, "x", 1), 1);
        (void)close(fd);
        assert_int_equal(unlink(path), 0);
        test_sleep_ms(10);
    }
    assert_int_equal(switches_of(pid), before);
    test_raw_close(&f->first);
}
