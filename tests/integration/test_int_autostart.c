/* test_int_autostart.c - clients that start the user's daemon. */
#include "cases.h"

#include <errno.h>
#include <fcntl.h>
#include <sched.h>
#include <signal.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "crossing.h"
#include "daemon.h"
#include "must.h"
#include "pccd.h"

/* Connect to the user's own daemon; the exit status says whether a step was right. */
static int run_autostart_child(int pid_fd)
{
    struct pccd_client *client = NULL;
    struct test_crossing crossing;
    uint32_t pid;

    if (pccd_connect(NULL, &client) != 0) {
        fprintf(stderr, "# child: %s\n", pccd_error_text(NULL));
        return 1;
    }
    pid = pccd_daemon_pid(client);
    if (test_crossing_make(client, &crossing) != 0 || !test_crossing_turn(&crossing))
        return 2;
    pccd_close(client);
    return write(pid_fd, &pid, sizeof pid) == (ssize_t)sizeof pid ? 0 : 3;
}

/* End a daemon that a client has started, and remove its folder. */
static void end_autostarted(uint32_t pid, const char *runtime)
{
    char path[64];

    assert_int_equal(kill((pid_t)pid, SIGTERM), 0);
    for (int i = 0; i < 2000 && kill((pid_t)pid, 0) == 0; i++)
        test_sleep_ms(5);
    (void)snprintf(path, sizeof path, "%s/pccd/pccd.sock", runtime);
    assert_int_not_equal(access(path, F_OK), 0);
    (void)snprintf(path, sizeof path, "%s/pccd/pccd.sock.log", runtime);
    assert_int_not_equal(access(path, F_OK), 0); /* nobody has to know its last words */
    (void)snprintf(path, sizeof path, "rm -rf %s", runtime);
    assert_int_equal(system(path), 0);
}

/* If it failed, programs that start together would not find the same daemon, or none. */
CASE(autostart__clients_that_start_together_share_one_daemon)
{
    enum { CHILDREN = 6 };
    char runtime[] = "/tmp/pccd-test-XXXXXX";
    pid_t children[CHILDREN];
    uint32_t pids[CHILDREN];
    int fds[2];

    assert_non_null(mkdtemp(runtime));
    assert_int_equal(setenv("XDG_RUNTIME_DIR", runtime, 1), 0);
    assert_int_equal(setenv("PCCD_DAEMON", getenv("PCCDD"), 1), 0);
    assert_int_equal(unsetenv("PCCD_URL"), 0);
    assert_int_equal(pipe(fds), 0);
    for (int i = 0; i < CHILDREN; i++) {
        children[i] = fork();
        assert_true(children[i] >= 0);
        if (children[i] == 0)
            _exit(run_autostart_child(fds[1]));
    }
    for (int i = 0; i < CHILDREN; i++) {
        int status = 0;

        assert_int_equal(waitpid(children[i], &status, 0), children[i]);
        assert_true(WIFEXITED(status));
        assert_int_equal(WEXITSTATUS(status), 0);
        assert_int_equal(read(fds[0], &pids[i], sizeof pids[i]), sizeof pids[i]);
    }
    for (int i = 1; i < CHILDREN; i++)
        assert_int_equal(pids[i], pids[0]);
    (void)close(fds[0]);
    (void)close(fds[1]);
    /* It is nobody's child: this process must not be able to wait for it. */
    assert_int_equal(waitpid((pid_t)pids[0], NULL, WNOHANG), -1);
    assert_int_equal(errno, ECHILD);
    end_autostarted(pids[0], runtime);
}

/* Each client starts a daemon; that of one gets the lock. If it failed, the others would
 * say that theirs ended at once where that one takes seconds to listen, on a machine that
 * is busy, or because it is about to end. */
CASE(autostart__a_daemon_that_has_the_lock_is_waited_for)
{
    char runtime[] = "/tmp/pccd-test-XXXXXX";
    char path[64];
    uint32_t pid = 0;
    int status = 0;
    int fds[2];
    int lock;
    pid_t waiting;

    assert_non_null(mkdtemp(runtime));
    assert_int_equal(setenv("XDG_RUNTIME_DIR", runtime, 1), 0);
    (void)snprintf(path, sizeof path, "%s/pccd", runtime);
    assert_int_equal(mkdir(path, 0700), 0);
    (void)snprintf(path, sizeof path, "%s/pccd/pccd.sock.lock", runtime);
    lock = open(path, O_RDWR | O_CREAT | O_CLOEXEC, 0600);
    assert_true(lock >= 0);
    assert_int_equal(flock(lock, LOCK_EX), 0);
    assert_int_equal(pipe(fds), 0);
    waiting = fork();
    assert_true(waiting >= 0);
    if (waiting == 0) {
        (void)close(lock);
        _exit(run_autostart_child(fds[1]));
    }
    test_sleep_ms(3000); /* longer than a client waits for one that listens */
    (void)close(lock);
    assert_int_equal(waitpid(waiting, &status, 0), waiting);
    assert_true(WIFEXITED(status));
    assert_int_equal(WEXITSTATUS(status), 0);
    assert_int_equal(read(fds[0], &pid, sizeof pid), sizeof pid);
    (void)close(fds[0]);
    (void)close(fds[1]);
    end_autostarted(pid, runtime);
}

/* If it failed, a program whose daemon dies would not learn of what. */
CASE(autostart__error_has_the_last_words_of_a_private_daemon)
{
    static const struct {
        int signal;
        const char *text;
    } cases[] = {{SIGSEGV, "it said: pccdd "}, {SIGKILL, "by signal 9 (Killed)"}};

    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        siginfo_t info;

        struct pccd_client *client = test_client(
            &(struct pccd_options){.private_daemon = true, .reconnect_ms = -1});
        assert_int_equal(kill((pid_t)pccd_daemon_pid(client), cases[i].signal), 0);
        assert_ok(waitid(P_PID, pccd_daemon_pid(client), &info, WEXITED | WNOWAIT));
        assert_int_equal(pccd_ping(client, NULL), PCCD_E_DISCONNECTED);
        if (strstr(pccd_error_text(client), cases[i].text) == NULL) {
            fail_msg("signal %d: %s", cases[i].signal, pccd_error_text(client));
        }
        pccd_close(client);
    }
}

/* If it failed, a program that is bound to one processor, as mpirun binds ranks, would
 * start a daemon that computes with one thread for everybody. */
CASE(autostart__daemon_of_a_bound_program_has_all_processors)
{
    char runtime[] = "/tmp/pccd-test-XXXXXX";
    struct pccd_client *client = NULL;
    struct pccd_daemon_info info;
    cpu_set_t all, one, after;

    assert_int_equal(sched_getaffinity(0, sizeof all, &all), 0);
    if (CPU_COUNT(&all) < 2) {
        test_skip("it takes two processors");
    }
    CPU_ZERO(&one);
    for (size_t cpu = 0; CPU_COUNT(&one) == 0; cpu++) {
        if (CPU_ISSET(cpu, &all)) {
            CPU_SET(cpu, &one);
        }
    }
    assert_non_null(mkdtemp(runtime));
    assert_int_equal(setenv("XDG_RUNTIME_DIR", runtime, 1), 0);
    assert_int_equal(sched_setaffinity(0, sizeof one, &one), 0);
    assert_ok(pccd_connect(NULL, &client));
    assert_int_equal(sched_getaffinity(0, sizeof after, &after), 0);
    assert_int_equal(sched_setaffinity(0, sizeof all, &all), 0);
    assert_true(CPU_EQUAL(&after, &one));
    assert_ok(pccd_daemon(client, &info));
    assert_true(info.threads_max >= (uint32_t)CPU_COUNT(&all));
    pccd_close(client);
    end_autostarted(info.pid, runtime);
}
