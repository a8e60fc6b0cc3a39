/* test_int_orphan.c - what a test program that dies leaves behind: nothing. */
#include "cases.h"

#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "daemon.h"
#include "raw.h"

#define END_MS 10000

/* Numbers that the child tells before it is killed. */
struct told {
    struct test_daemon daemon;
    pid_t worker;
};

/* In the child: a daemon whose worker is stopped. */
static void start_and_stop(int fd)
{
    static const char *const options[] = {"--supervise", "--threads", "1", NULL};
    static struct test_raw raw;
    static struct told told;
    const struct proto_HELLO_request hello = {.version_min = 1, .version_max = 1};
    struct proto_HELLO_result result;

    if (!test_daemon_start(&told.daemon, options) ||
        !test_raw_open(&raw, told.daemon.socket) ||
        test_raw_call(&raw, PROTO_METHOD_HELLO, &hello, &result) != 0) {
        _exit(1);
    }
    told.worker = (pid_t)result.pid;
    if (kill(told.worker, SIGSTOP) != 0 ||
        write(fd, &told, sizeof told) != (ssize_t)sizeof told) {
        _exit(1);
    }
    (void)pause();
    _exit(1);
}

/* Wait for the end of a child, or of an orphan, which is ours once its parent is gone. */
static int await_end(pid_t pid)
{
    uint64_t until_ms = test_now_ms() + END_MS;
    int status = -1;

    while (waitpid(pid, &status, WNOHANG) != pid && test_now_ms() < until_ms) {
        test_sleep_ms(1);
    }
    return status;
}

/* If it failed, a test that dies while a worker is stopped would leave that worker for
 * ever, and whoever reads what the test says would wait for its end as long. */
CASE(orphan__workers_end_with_their_test)
{
    struct told told = {.worker = 0};
    int fds[2];

    assert_int_equal(prctl(PR_SET_CHILD_SUBREAPER, 1), 0);
    assert_int_equal(pipe(fds), 0);
    pid_t test = fork();
    assert_true(test >= 0);
    if (test == 0) {
        start_and_stop(fds[1]);
    }
    (void)close(fds[1]);
    ssize_t got = read(fds[0], &told, sizeof told);
    (void)close(fds[0]);
    (void)kill(test, SIGKILL);
    (void)await_end(test);
    assert_int_equal(got, sizeof told);
    int status = await_end(told.worker);
    told.daemon.pid = 0; /* not ours to end; its folder is */
    told.daemon.guard = 0;
    (void)test_daemon_finish(&told.daemon);
    assert_true(WIFSIGNALED(status));
}
