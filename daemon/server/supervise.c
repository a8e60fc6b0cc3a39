/* supervise.c - a small parent that starts the daemon again when it crashes.
 *
 * Room:     server. See supervise.h.
 * Does:     fork, exec and wait; all signals are taken one by one. A spare worker stands
 *           by, loaded and linked, and is told to go on when the other crashes: clients
 *           wait some milliseconds less. It is made a while after a start, when clients
 *           are served again.
 * Threads:  one: no OpenMP region ever runs here, so it may fork.
 */
#include "supervise.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "activate.h"
#include "listener.h"
#include "log.h"
#include "now.h"
#include "pccd_types.h"

#define FORK_TRIES     50
#define FORK_PAUSE_MS  100
#define SPARE_PAUSE_MS 100 /* without a signal, after a start */

struct supervisor {
    int listen_fd;
    int ready_fd; /* ours to write to; -1: none, or it has been told */
    char **argv;
    pid_t worker; /* 0: none */
    pid_t spare;  /* 0: none */
    int spare_fd; /* a byte to it and it begins; -1: none */
    bool wants_spare;
    bool stopping;
    uint32_t crashes_max;                 /* 1 .. SRV_CRASHES_LIMIT */
    uint64_t crash_ns[SRV_CRASHES_LIMIT]; /* a ring of crashes_max: the last ones */
    uint32_t crash_count;
};

/* In the child: become the worker, at once or, with wait_fd, when a byte comes. */
static void become_worker(const struct supervisor *supervisor, pid_t parent, int wait_fd)
{
    sigset_t none;
    sigemptyset(&none);
    if (supervisor->ready_fd >= 0) {
        close(supervisor->ready_fd); /* who waits for its end must not wait for ours */
    }
    /* Without its supervisor nobody would start it again: it ends in order. */
    if (prctl(PR_SET_PDEATHSIG, SIGTERM) == 0 && getppid() == parent &&
        srv_standby_give(wait_fd) == 0 && srv_activate_give(supervisor->listen_fd) == 0 &&
        sigprocmask(SIG_SETMASK, &none, NULL) == 0) {
        execv("/proc/self/exe", supervisor->argv);
    }
    srv_log(SRV_LOG_ERROR, 0, "a worker cannot be started: %s", strerror(errno));
    _exit(1);
}

/* Wait before another try. Returns whether we were told to stop meanwhile. */
static bool pause_before_fork(struct supervisor *supervisor)
{
    const struct timespec pause = {.tv_nsec = FORK_PAUSE_MS * 1000000l};
    sigset_t stops;
    sigemptyset(&stops);
    sigaddset(&stops, SIGTERM);
    sigaddset(&stops, SIGINT);
    supervisor->stopping = sigtimedwait(&stops, NULL, &pause) > 0;
    return supervisor->stopping;
}

/* Have a worker stand by. Without one the next start takes longer, no more. */
static void start_spare(struct supervisor *supervisor)
{
    int fds[2];
    supervisor->wants_spare = false;
    if (pipe2(fds, O_CLOEXEC) != 0) {
        return;
    }
    pid_t parent = getpid();
    pid_t child = fork();
    if (child == 0) {
        become_worker(supervisor, parent, fds[0]);
    }
    close(fds[0]);
    if (child < 0) {
        close(fds[1]);
        return;
    }
    supervisor->spare = child;
    supervisor->spare_fd = fds[1];
    srv_log(SRV_LOG_DEBUG, 0, "process %ld stands by", (long)child);
}

static void forget_spare(struct supervisor *supervisor)
{
    if (supervisor->spare_fd >= 0) {
        close(supervisor->spare_fd);
    }
    supervisor->spare = 0;
    supervisor->spare_fd = -1;
}

static void end_spare(struct supervisor *supervisor)
{
    if (supervisor->spare > 0) {
        kill(supervisor->spare, SIGKILL); /* it has not begun */
        waitpid(supervisor->spare, NULL, 0);
    }
    forget_spare(supervisor);
}

/* A system that has no memory or no process number left may have one soon. */
static int start_worker(struct supervisor *supervisor)
{
    supervisor->wants_spare = true;
    if (supervisor->spare > 0 && write(supervisor->spare_fd, "1", 1) == 1) {
        supervisor->worker = supervisor->spare;
        forget_spare(supervisor);
        return 0;
    }
    end_spare(supervisor);
    pid_t parent = getpid();
    pid_t child = fork();
    for (int tries = 1; child < 0 && tries < FORK_TRIES; tries++) {
        srv_log(SRV_LOG_WARN, 0, "fork: %s; trying again", strerror(errno));
        if (pause_before_fork(supervisor)) {
            return PCCD_E_SYSTEM;
        }
        child = fork();
    }
    if (child == 0) {
        become_worker(supervisor, parent, -1);
    }
    if (child < 0) {
        srv_log(SRV_LOG_ERROR, 0, "fork: %s", strerror(errno));
        return PCCD_E_SYSTEM;
    }
    supervisor->worker = child;
    return 0;
}

/* Note a crash. Returns whether there were too many of late. */
static bool crashes_too_often(struct supervisor *supervisor)
{
    uint64_t now_ns = srv_now_ns();
    uint32_t max = supervisor->crashes_max;
    supervisor->crash_ns[supervisor->crash_count++ % max] = now_ns;
    /* The next place of the ring holds the first of the last `max`. */
    uint64_t first_ns = supervisor->crash_ns[supervisor->crash_count % max];
    return supervisor->crash_count >= max &&
           now_ns - first_ns <= (uint64_t)SRV_CRASHES_WINDOW_MS * 1000000u;
}

/* The worker has ended. Returns -1 to go on, or the exit status. */
static int on_end(struct supervisor *supervisor, int wait_status)
{
    long pid = (long)supervisor->worker;
    bool exited = WIFEXITED(wait_status);
    supervisor->worker = 0;
    if (exited && WEXITSTATUS(wait_status) == 0) {
        return 0;
    }
    if (supervisor->stopping && !exited &&
        (WTERMSIG(wait_status) == SIGTERM || WTERMSIG(wait_status) == SIGINT)) {
        return 0; /* the signal came before it could take it in order */
    }
    if (exited) {
        srv_log(SRV_LOG_ERROR, 0, "worker %ld ended with status %d", pid,
                WEXITSTATUS(wait_status));
    } else {
        srv_log(SRV_LOG_ERROR, 0, "worker %ld was ended by signal %d (%s)", pid,
                WTERMSIG(wait_status), strsignal(WTERMSIG(wait_status)));
    }
    if (supervisor->stopping) {
        return 1;
    }
    if (crashes_too_often(supervisor)) {
        srv_log(SRV_LOG_ERROR, 0, "giving up: %u crashes within %u seconds",
                supervisor->crashes_max, SRV_CRASHES_WINDOW_MS / 1000);
        return 1;
    }
    return start_worker(supervisor) == 0 ? -1 : 1;
}

/* Returns -1 to go on, or the exit status. */
static int on_signal(struct supervisor *supervisor, int signal)
{
    int wait_status;
    if (signal != SIGCHLD) {
        supervisor->stopping = true;
        kill(supervisor->worker, signal);
        return -1;
    }
    if (supervisor->spare > 0 &&
        waitpid(supervisor->spare, NULL, WNOHANG) == supervisor->spare) {
        forget_spare(supervisor); /* until the next start */
    }
    if (waitpid(supervisor->worker, &wait_status, WNOHANG) != supervisor->worker) {
        return -1; /* it was stopped, or goes on */
    }
    return on_end(supervisor, wait_status);
}

static int run(struct supervisor *supervisor, const sigset_t *signals)
{
    int exit_status = start_worker(supervisor) == 0 ? -1 : 1;
    /* The socket listens: whoever connects now waits for the worker. */
    srv_listener_tell_ready(supervisor->ready_fd);
    supervisor->ready_fd = -1;
    while (exit_status < 0) {
        const struct timespec pause = {.tv_nsec = SPARE_PAUSE_MS * 1000000};
        siginfo_t info;
        int signal = supervisor->wants_spare && !supervisor->stopping
                         ? sigtimedwait(signals, &info, &pause)
                         : sigwaitinfo(signals, &info);
        if (signal < 0 && errno == EAGAIN) {
            start_spare(supervisor);
        } else if (signal > 0) {
            exit_status = on_signal(supervisor, signal);
        }
    }
    return exit_status;
}

int srv_supervise(const struct srv_options *options, char **argv)
{
    struct supervisor supervisor = {.listen_fd = -1,
                                    .spare_fd = -1,
                                    .ready_fd = options->ready_fd,
                                    .argv = argv,
                                    .crashes_max = options->crashes_max};
    sigset_t signals;
    sigemptyset(&signals);
    sigaddset(&signals, SIGCHLD);
    sigaddset(&signals, SIGTERM);
    sigaddset(&signals, SIGINT);
    if (sigprocmask(SIG_BLOCK, &signals, NULL) != 0 ||
        srv_listener_bind(options, &supervisor.listen_fd) != 0) {
        srv_log(SRV_LOG_ERROR, 0, "%s: %s", options->socket_path, strerror(errno));
        return 1;
    }
    srv_log(SRV_LOG_INFO, 0, "process %ld supervises %s", (long)getpid(),
            options->socket_path);
    int exit_status = run(&supervisor, &signals);
    end_spare(&supervisor);
    unlink(options->socket_path);
    close(supervisor.listen_fd);
    return exit_status;
}
