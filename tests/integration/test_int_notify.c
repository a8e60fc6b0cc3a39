/* test_int_notify.c - what a service manager is told. */
#include "cases.h"

#include <dirent.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/ptrace.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include "daemon.h"
#include "hog.h"
#include "raw.h"

#define END_MS      20000
#define SILENCE_MS  600
#define WATCHDOG_US "200000"

static struct {
    int fd; /* the manager's */
    char folder[64];
    char socket[80];
    pid_t daemon;
    char lines[512]; /* the last datagram */
    pid_t sender;
} f;

/* ---- the manager ------------------------------------------------------------------- */

/* Listen at a path, or at an abstract name, and tell those we start. */
static void manage(bool is_abstract)
{
    struct sockaddr_un address = {.sun_family = AF_UNIX};
    int yes = 1;
    char name[96];
    (void)snprintf(name, sizeof name, "%s%s/notify", is_abstract ? "@" : "", f.folder);
    size_t length = strlen(name);
    memcpy(address.sun_path, name, length);
    if (is_abstract) {
        address.sun_path[0] = '\0';
    }
    f.fd = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    assert_true(f.fd >= 0);
    assert_int_equal(setsockopt(f.fd, SOL_SOCKET, SO_PASSCRED, &yes, sizeof yes), 0);
    assert_ok(bind(f.fd, (const struct sockaddr *)&address,
                   (socklen_t)(offsetof(struct sockaddr_un, sun_path) + length)));
    assert_int_equal(setenv("NOTIFY_SOCKET", name, 1), 0);
}

/* Start a daemon with two options at most, and wait for nothing. */
static void start(const char *option, const char *value)
{
    f.daemon = fork();
    if (f.daemon == 0) {
        int log = open("/dev/null", O_WRONLY);
        test_end_with_parent();
        (void)dup2(log, 2);
        execl(getenv("PCCDD"), "pccdd", "--socket", f.socket, "--threads", "1", option,
              value, NULL);
        _exit(127);
    }
    assert_true(f.daemon > 0);
}

/* The next datagram; false: none came in time. */
static bool hear(int timeout_ms)
{
    struct pollfd watched = {.fd = f.fd, .events = POLLIN};
    union {
        struct cmsghdr align;
        char bytes[CMSG_SPACE(sizeof(struct ucred))];
    } control;
    struct iovec part = {.iov_base = f.lines, .iov_len = sizeof f.lines - 1};
    struct msghdr message = {.msg_iov = &part,
                             .msg_iovlen = 1,
                             .msg_control = &control,
                             .msg_controllen = sizeof control};
    if (poll(&watched, 1, timeout_ms) <= 0) {
        return false;
    }
    ssize_t got = recvmsg(f.fd, &message, MSG_DONTWAIT);
    assert_true(got > 0);
    f.lines[got] = '\0';
    struct cmsghdr *credentials = CMSG_FIRSTHDR(&message);
    assert_non_null(credentials);
    struct ucred sender;
    memcpy(&sender, CMSG_DATA(credentials), sizeof sender);
    f.sender = sender.pid;
    return true;
}

/* Wait for a datagram with `line`; false: it did not come. */
static bool hear_of(const char *line, int timeout_ms)
{
    uint64_t until_ms = test_now_ms() + (uint64_t)timeout_ms;
    for (uint64_t now_ms; (now_ms = test_now_ms()) < until_ms;) {
        if (hear((int)(until_ms - now_ms)) && strstr(f.lines, line) != NULL) {
            return true;
        }
    }
    return false;
}

static void forget_what_was_said(void)
{
    while (hear(0)) {
    }
}

static void expect_end(void)
{
    int status = -1;
    assert_int_equal(kill(f.daemon, SIGTERM), 0);
    assert_int_equal(waitpid(f.daemon, &status, 0), f.daemon);
    f.daemon = 0;
    assert_true(WIFEXITED(status));
    assert_int_equal(WEXITSTATUS(status), 0);
}

/* ---- one daemon -------------------------------------------------------------------- */

/* If it failed, systemd would start what comes after the daemon too early, or take it for
 * one that does not get ready and kill it. */
static void says_ready(bool is_abstract)
{
    static struct test_raw raw;
    char main_pid[32];
    manage(is_abstract);
    start(NULL, NULL);
    assert_true(hear_of("READY=1", END_MS));
    assert_true(test_raw_open(&raw, f.socket)); /* at once */
    (void)snprintf(main_pid, sizeof main_pid, "\nMAINPID=%ld", (long)f.daemon);
    assert_non_null(strstr(f.lines, main_pid));
    assert_ok(test_raw_hello(&raw));
    test_raw_close(&raw);
    expect_end();
}

static int set_up(void **state)
{
    (void)state;
    memset(&f, 0, sizeof f);
    f.fd = -1;
    (void)unsetenv("WATCHDOG_USEC");
    (void)unsetenv("WATCHDOG_PID");
    (void)snprintf(f.folder, sizeof f.folder, "/tmp/pccd-test-XXXXXX");
    if (mkdtemp(f.folder) == NULL) {
        return -1;
    }
    (void)snprintf(f.socket, sizeof f.socket, "%s/s", f.folder);
    return 0;
}

static int tear_down(void **state)
{
    char path[96];
    (void)state;
    if (f.daemon > 0) {
        pid_t ended;
        (void)kill(f.daemon, SIGKILL);
        do { /* of threads that were stopped we hear first */
            ended = waitpid(-1, NULL, __WALL);
        } while (ended > 0 && ended != f.daemon);
    }
    if (f.fd >= 0) {
        (void)close(f.fd);
    }
    for (size_t i = 0; i < 3; i++) {
        const char *const names[] = {"notify", "s", "s.lock"};
        (void)snprintf(path, sizeof path, "%s/%s", f.folder, names[i]);
        (void)unlink(path);
    }
    (void)rmdir(f.folder);
    return 0;
}

/* If it failed, no system service would ever be ready. */
CASE_WITH(notify__says_ready_when_it_listens, set_up, tear_down)
{
    says_ready(false);
}

/* If it failed, a manager whose socket has no path would hear nothing. */
CASE_WITH(notify__knows_abstract_names, set_up, tear_down)
{
    says_ready(true);
}

/* If it failed, systemd would not know an end that was asked for from another. */
CASE_WITH(notify__says_that_it_stops, set_up, tear_down)
{
    manage(false);
    start(NULL, NULL);
    assert_true(hear_of("READY=1", END_MS));
    expect_end();
    assert_true(hear_of("STOPPING=1", END_MS));
}

/* If it failed, systemctl status would not show whether anybody uses the service. */
CASE_WITH(notify__tells_how_many_clients_there_are, set_up, tear_down)
{
    static struct test_raw raw;
    manage(false);
    start(NULL, NULL);
    assert_true(hear_of("STATUS=0 clients, 0 steps", END_MS));
    assert_ok(test_raw_session(&raw, f.socket, 0, 0));
    assert_true(hear_of("STATUS=1 client, ", END_MS));
    test_raw_close(&raw);
    expect_end();
}

/* If the beats did not come, systemd would kill a daemon that is well; if they came while
 * the loop stands, it would let one live that serves nobody. */
CASE_WITH(notify__beats_while_the_loop_turns, set_up, tear_down)
{
    (void)setenv("WATCHDOG_USEC", WATCHDOG_US, 1);
    manage(false);
    start(NULL, NULL);
    assert_true(hear_of("READY=1", END_MS));
    for (int i = 0; i < 6; i++) {
        assert_true(hear_of("WATCHDOG=1", END_MS));
    }
    assert_int_equal(kill(f.daemon, SIGSTOP), 0);
    test_sleep_ms(50);
    forget_what_was_said();
    assert_false(hear(SILENCE_MS));
    assert_int_equal(kill(f.daemon, SIGCONT), 0);
    assert_true(hear_of("WATCHDOG=1", END_MS));
    expect_end();
}

/* If beats were that many more than are wanted, or that many fewer, an idle machine would
 * be woken for nothing, or a beat that is late would be the end. */
CASE_WITH(notify__beats_twice_in_the_watchdogs_time, set_up, tear_down)
{
    int beats = 0;
    (void)setenv("WATCHDOG_USEC", WATCHDOG_US, 1);
    manage(false);
    start(NULL, NULL);
    assert_true(hear_of("WATCHDOG=1", END_MS));
    uint64_t until_ms = test_now_ms() + 1000;
    for (uint64_t now_ms; (now_ms = test_now_ms()) < until_ms;) {
        beats += hear_of("WATCHDOG=1", (int)(until_ms - now_ms));
    }
    assert_in_range(beats, 4, 12); /* 10, and a machine that is busy with others */
    expect_end();
}

/* ---- a thread that stands ---------------------------------------------------------- */

#define PATIENT_US "1000000" /* of a watchdog whose looks a busy machine lets be true */
#define LOOK_MS    500

/* Threads of the daemon but the first, in the order in which they were made. */
static int other_threads(pid_t *threads, int most)
{
    char path[64];
    int count = 0;
    (void)snprintf(path, sizeof path, "/proc/%ld/task", (long)f.daemon);
    DIR *folder = opendir(path);
    assert_non_null(folder);
    for (struct dirent *entry; (entry = readdir(folder)) != NULL && count < most;) {
        pid_t thread = (pid_t)strtol(entry->d_name, NULL, 10);
        if (thread > 0 && thread != f.daemon) {
            threads[count++] = thread;
        }
    }
    (void)closedir(folder);
    return count;
}

/* Clock ticks that a thread of the daemon has computed for. */
static unsigned long ticks_of(pid_t thread)
{
    char path[64];
    unsigned long ticks = 0;
    (void)snprintf(path, sizeof path, "/proc/%ld/task/%ld/stat", (long)f.daemon,
                   (long)thread);
    FILE *file = fopen(path, "r");
    assert_non_null(file);
    assert_int_equal(fscanf(file,
                            "%*d (%*[^)]) %*c %*d %*d %*d %*d %*d %*u %*u %*u %*u %*u "
                            "%lu",
                            &ticks),
                     1);
    (void)fclose(file);
    return ticks;
}

/* The younger one of the two threads that compute a step together, once both do. */
static pid_t second_of_team(void)
{
    pid_t threads[16];
    unsigned long before[16];
    int count = other_threads(threads, 16);
    for (int i = 0; i < count; i++) {
        before[i] = ticks_of(threads[i]);
    }
    for (uint64_t until_ms = test_now_ms() + END_MS; test_now_ms() < until_ms;) {
        int busy = 0;
        pid_t youngest = 0;
        for (int i = 0; i < count; i++) {
            if (ticks_of(threads[i]) > before[i] + 2) {
                youngest = threads[i] > youngest ? threads[i] : youngest;
                busy++;
            }
        }
        if (busy == 2) {
            return youngest;
        }
        test_sleep_ms(5);
    }
    fail_msg("no two threads compute");
    return 0;
}

/* Stop one thread, and no other, as nothing but a debugger can. False: we may not. */
static bool freeze(pid_t thread)
{
    int status = 0;
    return ptrace(PTRACE_SEIZE, thread, 0, 0) == 0 &&
           ptrace(PTRACE_INTERRUPT, thread, 0, 0) == 0 &&
           waitpid(thread, &status, __WALL) == thread;
}

static void thaw(pid_t thread)
{
    assert_int_equal(ptrace(PTRACE_DETACH, thread, 0, 0), 0);
}

/* Beats come for as long as several looks take. */
static void expect_beats(void)
{
    forget_what_was_said();
    for (int i = 0; i < 4; i++) {
        assert_true(hear_of("WATCHDOG=1", 4 * LOOK_MS));
    }
}

/* Beats end, soon where the machine has nothing else to do. */
static void expect_no_beat(void)
{
    bool is_heard = true;

    for (int i = 0; i < 5 && is_heard; i++) {
        test_sleep_ms(4 * LOOK_MS);
        forget_what_was_said();
        is_heard = hear_of("WATCHDOG=1", 3 * LOOK_MS);
    }
    assert_false(is_heard);
}

/* The daemon computes a long step. */
static void let_compute(struct hog *hog, const char *threads, enum hog_kind kind)
{
    (void)setenv("WATCHDOG_USEC", PATIENT_US, 1);
    manage(false);
    start("--threads", threads);
    assert_true(hear_of("WATCHDOG=1", END_MS));
    assert_true(test_hog_open(hog, f.socket, kind, kind == HOG_FAN ? 50000 : 3000));
    assert_true(test_hog_begin(hog));
    test_sleep_ms(100);
}

/* If it failed, systemd would let a daemon live that answers what needs no computing and
 * nothing else; or end one that computes for long. */
CASE_WITH(notify__does_not_beat_while_a_thread_that_computes_stands, set_up, tear_down)
{
    static struct hog hog;
    pid_t threads[16];
    let_compute(&hog, "1", HOG_COINCIDENT);
    expect_beats();
    int count = other_threads(threads, 16);
    assert_true(count > 0);
    if (!freeze(threads[0])) {
        test_hog_close(&hog);
        expect_end();
        test_skip("this process may not stop a thread");
    }
    for (int i = 1; i < count; i++) {
        assert_true(freeze(threads[i]));
    }
    expect_no_beat();
    for (int i = 0; i < count; i++) {
        thaw(threads[i]);
    }
    expect_beats();
    test_hog_close(&hog);
    expect_end();
}

/* If it failed, a step that does not end when it must would not be noticed where its
 * thread is busy: here it waits for another of its team, and looks at it all the time. */
CASE_WITH(notify__does_not_beat_while_a_step_does_not_end, set_up, tear_down)
{
    static struct hog hog;
    let_compute(&hog, "2", HOG_FAN);
    pid_t thread = second_of_team();
    if (!freeze(thread)) {
        test_hog_close(&hog);
        expect_end();
        test_skip("this process may not stop a thread");
    }
    const struct proto_CANCEL_request cancel = {.id = hog.id};
    assert_true(test_raw_request(&hog.raw, PROTO_METHOD_CANCEL, &cancel) != 0);
    expect_no_beat();
    thaw(thread);
    expect_beats();
    test_hog_close(&hog);
    expect_end();
}

/* If it failed, a process that systemd does not watch would speak for another. */
CASE_WITH(notify__does_not_beat_for_another_process, set_up, tear_down)
{
    (void)setenv("WATCHDOG_USEC", WATCHDOG_US, 1);
    (void)setenv("WATCHDOG_PID", "1", 1);
    manage(false);
    start(NULL, NULL);
    assert_true(hear_of("STATUS=", END_MS));
    assert_false(hear(SILENCE_MS));
    expect_end();
}

/* Return the context switches of all threads of a process together; -1: it is gone. */
static long context_switches(pid_t pid)
{
    char command[128];
    long sum = -1;
    (void)snprintf(command, sizeof command,
                   "awk '/ctxt_switches/ { n += $2 } END { print n }' "
                   "/proc/%ld/task/*/status",
                   (long)pid);
    FILE *pipe = popen(command, "r");
    assert_non_null(pipe);
    int got = fscanf(pipe, "%ld", &sum);
    assert_int_equal(pclose(pipe), 0);
    return got == 1 ? sum : -1;
}

/* If it failed, a daemon that nobody uses would wake the machine for its manager. */
CASE_WITH(notify__lets_an_idle_daemon_sleep, set_up, tear_down)
{
    if (TEST_HAS_FOREIGN_THREAD) {
        test_skip("a sanitizer's thread wakes the daemon ten times a second");
    }
    manage(false);
    start(NULL, NULL);
    assert_true(hear_of("STATUS=", END_MS));
    test_sleep_ms(300);
    long before = context_switches(f.daemon);
    test_sleep_ms(SILENCE_MS);
    assert_int_equal(context_switches(f.daemon), before);
    assert_true(before > 0);
    expect_end();
}

/* ---- others' daemons --------------------------------------------------------------- */

/* If it failed, systemd would watch a worker instead of the parent that replaces it, or
 * hear nothing of the one that took over. */
CASE_WITH(notify__supervisor_is_ready_and_its_workers_beat, set_up, tear_down)
{
    char main_pid[32];
    (void)setenv("WATCHDOG_USEC", WATCHDOG_US, 1);
    manage(false);
    start("--supervise", NULL);
    (void)snprintf(main_pid, sizeof main_pid, "READY=1\nMAINPID=%ld", (long)f.daemon);
    assert_true(hear_of(main_pid, END_MS));
    assert_int_equal(f.sender, f.daemon);
    assert_true(hear_of("WATCHDOG=1", END_MS));
    pid_t first = f.sender;
    assert_int_not_equal(first, f.daemon);
    assert_int_equal(kill(first, SIGKILL), 0);
    do {
        assert_true(hear_of("WATCHDOG=1", END_MS));
    } while (f.sender == first);
    assert_int_not_equal(f.sender, f.daemon);
    expect_end();
}

/* If it failed, a game that is a service itself would be ready, stop and live by the word
 * of the daemon that it has started for itself. */
CASE_WITH(notify__private_daemon_is_silent, set_up, tear_down)
{
    static struct test_raw raw;
    (void)setenv("WATCHDOG_USEC", WATCHDOG_US, 1);
    manage(false);
    start("--private", NULL);
    for (int i = 0; i < END_MS / 10 && !test_raw_open(&raw, f.socket); i++) {
        test_sleep_ms(10);
    }
    assert_ok(test_raw_hello(&raw));
    assert_false(hear(SILENCE_MS));
    test_raw_close(&raw);
    int status = -1;
    assert_int_equal(waitpid(f.daemon, &status, 0), f.daemon); /* with its last client */
    f.daemon = 0;
    assert_int_equal(status, 0);
    assert_false(hear(0));
}

/* ------------------------------------------------------------------------------------ */
