/* daemon.c - a real pccdd for a test. */
#include "daemon.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#define START_MS    20000
#define SECOND_MS   10000
#define FINISH_MS   20000
#define OPTIONS_MAX 16
#define READY_FD    3
#define ENTRIES_MAX 64
#define LOG_BYTES   65536

uint64_t test_now_us(void)
{
    struct timespec now;

    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    return (uint64_t)now.tv_sec * 1000000u + (uint64_t)now.tv_nsec / 1000u;
}

uint64_t test_now_ms(void)
{
    return test_now_us() / 1000u;
}

void test_sleep_ms(unsigned ms)
{
    const struct timespec pause = {ms / 1000, (long)(ms % 1000) * 1000000};

    (void)nanosleep(&pause, NULL);
}

void test_end_with_parent(void)
{
    (void)prctl(PR_SET_PDEATHSIG, SIGKILL);
}

/* In the child: become the daemon. */
static void become_daemon(const struct test_daemon *daemon, const char *const *options,
                          int ready_fd)
{
    const char *program = getenv("PCCDD");
    const char *arguments[OPTIONS_MAX + 6] = {program, "--socket", daemon->socket, NULL};
    size_t count = 3;
    int log_fd = open(daemon->log, O_WRONLY | O_CREAT | O_APPEND, 0600);

    (void)setpgid(0, 0);
    test_end_with_parent();
    if (ready_fd >= 0) {
        arguments[count++] = "--ready-fd";
        arguments[count++] = "3";
        (void)dup2(ready_fd, READY_FD);
        if (ready_fd == READY_FD) {
            (void)fcntl(READY_FD, F_SETFD, 0);
        }
    }
    for (size_t i = 0; options != NULL && options[i] != NULL && i < OPTIONS_MAX; i++) {
        arguments[count++] = options[i];
    }
    arguments[count] = NULL;
    if (log_fd >= 0) {
        (void)dup2(log_fd, 1); /* who reads what the test says shall see its end */
        (void)dup2(log_fd, 2);
    }
    execv(program, (char *const *)(uintptr_t)arguments);
    _exit(127);
}

/* In a child: when the test program ends, kill what is left of the daemon's group. The
 * daemon alone would be killed by PDEATHSIG; not its workers. */
static void guard_group(pid_t test, pid_t group)
{
    sigset_t end;
    int number = 0;

    sigemptyset(&end);
    sigaddset(&end, SIGUSR1);
    (void)sigprocmask(SIG_BLOCK, &end, NULL);
    (void)prctl(PR_SET_PDEATHSIG, SIGUSR1);
    (void)close_range(3, ~0u, 0); /* what the test closes shall be closed */
    if (getppid() == test) {
        (void)sigwait(&end, &number);
    }
    (void)kill(-group, SIGKILL);
    _exit(0);
}

static void dismiss_guard(struct test_daemon *daemon)
{
    if (daemon->guard > 0) {
        (void)kill(daemon->guard, SIGKILL);
        (void)waitpid(daemon->guard, NULL, 0);
    }
    daemon->guard = 0;
}

/* Nothing of the daemon shall be left, stopped workers neither. */
static void end_group(struct test_daemon *daemon)
{
    if (daemon->group > 0) {
        (void)kill(-daemon->group, SIGKILL);
    }
    daemon->group = 0;
    dismiss_guard(daemon);
}

static bool await_ready(int fd)
{
    uint64_t until_ms = test_now_ms() + START_MS;
    char byte;

    while (test_now_ms() < until_ms) {
        struct pollfd watched = {.fd = fd, .events = POLLIN};

        if (poll(&watched, 1, 100) > 0) {
            return read(fd, &byte, 1) == 1;
        }
    }
    return false;
}

static bool make_directory(struct test_daemon *daemon)
{
    (void)snprintf(daemon->directory, sizeof daemon->directory, "/tmp/pccd-test-XXXXXX");
    if (mkdtemp(daemon->directory) == NULL) {
        return false;
    }
    (void)snprintf(daemon->socket, sizeof daemon->socket, "%s/s", daemon->directory);
    (void)snprintf(daemon->url, sizeof daemon->url, "unix:%s", daemon->socket);
    (void)snprintf(daemon->log, sizeof daemon->log, "%s/log", daemon->directory);
    return true;
}

bool test_daemon_restart(struct test_daemon *daemon, const char *const *options)
{
    int ready_fds[2];
    bool ready;

    if (getenv("PCCDD") == NULL || pipe2(ready_fds, O_CLOEXEC) != 0) {
        fprintf(stderr, "# PCCDD is not set, or there is no pipe\n");
        return false;
    }
    pid_t test = getpid();
    end_group(daemon);
    daemon->pid = fork();
    if (daemon->pid == 0) {
        become_daemon(daemon, options, ready_fds[1]);
    }
    daemon->group = daemon->pid;
    (void)setpgid(daemon->pid, daemon->pid); /* before the guard, whoever runs first */
    (void)close(ready_fds[1]);
    daemon->guard = daemon->pid > 0 ? fork() : -1;
    if (daemon->guard == 0) {
        guard_group(test, daemon->group);
    }
    ready = daemon->pid > 0 && await_ready(ready_fds[0]);
    (void)close(ready_fds[0]);
    if (!ready) {
        fprintf(stderr, "# the daemon does not get ready\n");
        (void)test_daemon_end(daemon, SIGKILL, 1000);
    }
    return ready;
}

bool test_is_direct(void)
{
    const char *url = getenv("PCCD_TEST_URL");

    return url != NULL && strcmp(url, TEST_DIRECT_URL) == 0;
}

void test_daemon_direct(struct test_daemon *daemon, const char *const *options)
{
    memset(daemon, 0, sizeof *daemon);
    memcpy(daemon->url, TEST_DIRECT_URL, sizeof(TEST_DIRECT_URL));
    memcpy(daemon->socket, TEST_DIRECT_URL, sizeof(TEST_DIRECT_URL));
    daemon->pid = getpid();
    for (size_t i = 0; options != NULL && options[i] != NULL; i++) {
        if (strcmp(options[i], "--threads") == 0) {
            (void)setenv("OMP_NUM_THREADS", options[i + 1], 1);
        }
    }
}

bool test_daemon_start(struct test_daemon *daemon, const char *const *options)
{
    memset(daemon, 0, sizeof *daemon);
    if (!make_directory(daemon)) {
        return false;
    }
    if (test_daemon_restart(daemon, options)) {
        return true;
    }
    (void)test_daemon_finish(daemon);
    return false;
}

/* Wait for the end of `pid`; -1: it has not come. */
static int await_end(pid_t pid, int timeout_ms)
{
    uint64_t until_ms = test_now_ms() + (uint64_t)timeout_ms;
    int status = 0;

    for (;;) {
        pid_t got = waitpid(pid, &status, WNOHANG);

        if (got == pid) {
            return status;
        }
        if (got < 0 && errno != EINTR) {
            return -1;
        }
        if (test_now_ms() >= until_ms) {
            return -1;
        }
        test_sleep_ms(1);
    }
}

int test_daemon_start_second(const struct test_daemon *daemon)
{
    pid_t pid = fork();
    int status;

    if (pid < 0) {
        return -1;
    }
    if (pid == 0) {
        become_daemon(daemon, NULL, -1);
    }
    status = await_end(pid, SECOND_MS);
    if (status < 0) {
        (void)kill(pid, SIGKILL);
        (void)waitpid(pid, NULL, 0);
        return -1;
    }
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

int test_daemon_end(struct test_daemon *daemon, int signal, int timeout_ms)
{
    int status;

    if (daemon->pid <= 0) {
        return -1;
    }
    if (signal != 0) {
        (void)kill(daemon->pid, signal);
    }
    status = await_end(daemon->pid, timeout_ms);
    if (status < 0) {
        fprintf(stderr, "# the daemon does not end: killed\n");
        (void)kill(-daemon->pid, SIGKILL);
        (void)waitpid(daemon->pid, NULL, 0);
    }
    daemon->pid = 0;
    return status;
}

static void remove_directory(const char *path)
{
    DIR *entries = opendir(path);

    if (entries == NULL) {
        return;
    }
    for (int i = 0; i < ENTRIES_MAX; i++) {
        const struct dirent *entry = readdir(entries);

        if (entry == NULL) {
            break;
        }
        (void)unlinkat(dirfd(entries), entry->d_name, 0); /* fails on . and .. */
    }
    (void)closedir(entries);
    (void)rmdir(path);
}

/* Show what the daemon complained about: warnings and errors, and sanitizers. */
static void show_log(const struct test_daemon *daemon)
{
    char line[512];
    FILE *file = fopen(daemon->log, "r");

    if (file == NULL) {
        return;
    }
    while (fgets(line, sizeof line, file) != NULL) {
        fprintf(stderr, "# daemon: %s", line);
    }
    (void)fclose(file);
}

bool test_daemon_finish(struct test_daemon *daemon)
{
    bool clean = true;

    if (daemon->pid > 0) {
        int status = test_daemon_end(daemon, SIGTERM, FINISH_MS);

        clean = status >= 0 && WIFEXITED(status) && WEXITSTATUS(status) == 0;
        if (!clean) {
            fprintf(stderr, "# the daemon ended with status %#x\n", (unsigned)status);
            show_log(daemon);
        }
    }
    end_group(daemon);
    if (daemon->directory[0] != '\0') {
        remove_directory(daemon->directory);
    }
    return clean;
}

bool test_daemon_logged(const struct test_daemon *daemon, const char *text)
{
    static char log[LOG_BYTES];
    FILE *file = fopen(daemon->log, "r");
    size_t bytes;

    if (file == NULL) {
        return false;
    }
    bytes = fread(log, 1, sizeof log - 1, file);
    log[bytes] = '\0';
    (void)fclose(file);
    return strstr(log, text) != NULL;
}

bool test_stop(pid_t pid)
{
    char path[64];
    char state = 'R';

    (void)snprintf(path, sizeof path, "/proc/%d/stat", (int)pid);
    if (kill(pid, SIGSTOP) != 0) {
        return false;
    }
    for (int i = 0; i < 10000 && state != 'T'; i++) {
        FILE *file = fopen(path, "r");

        if (file == NULL || fscanf(file, "%*d (%*[^)]) %c", &state) != 1) {
            state = 0;
        }
        if (file != NULL) {
            (void)fclose(file);
        }
        test_sleep_ms(1);
    }
    return state == 'T';
}
