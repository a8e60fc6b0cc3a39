/* supervise.c - a small parent that starts the daemon again when it crashes.
 *
 * Fork, exec and wait; all signals are taken one by one. A spare worker stands by, loaded
 * and linked, and is told to go on when the other crashes: clients wait some milliseconds
 * less. It is made a while after a start, when clients are served again. What happens to
 * a worker:
 *
 *     SERVING -- says that it ends --> reaped: its status is that of the program
 *      |  `-- reaped --> started again, or all is over (on_end)
 *      `-- end of its lifeline --> REPLACED: the next one serves --> reaped: told of
 *
 * Which of a lifeline's end and SIGCHLD is seen first does not matter. Where it is the
 * last crash that we bear, the status is waited for.
 */
#include "supervise.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/signalfd.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "lifeline.h"
#include "listener.h"
#include "log.h"
#include "notify.h"
#include "now.h"
#include "pccd_types.h"
#include "printable.h"
#include "socketfile.h"

#define FORK_TRIES     50
#define FORK_PAUSE_MS  100
#define SPARE_PAUSE_MS 100 /* without an event, after a start */

struct worker {
    pid_t pid;    /* 0: none */
    int lifeline; /* ends when it dies; -1: none, or it has been read to its end */
};

struct crash {
    uint64_t ns;
    pid_t pid; /* of a worker that was replaced and is not reaped yet; 0: none */
};

struct supervisor {
    const struct srv_options *options;
    struct srv_lockfile *lockfile;
    struct srv_socketfile file;
    int listen_fd;
    int signal_fd;
    int ready_fd; /* ours to write to; -1: none, or it has been told */
    char **argv;
    struct worker worker;
    struct worker spare;
    int kept_fd;  /* what workers keep for each other (kept.c); -1: nothing */
    int spare_fd; /* a byte to it and it begins; -1: none */
    bool wants_spare;
    bool stopping;
    uint32_t crashes_max;                    /* 1 .. SRV_CRASHES_LIMIT */
    struct crash crashes[SRV_CRASHES_LIMIT]; /* a ring of crashes_max: the last ones */
    uint32_t crash_count;
};

static void close_if_open(int *fd)
{
    if (*fd >= 0) {
        close(*fd);
    }
    *fd = -1;
}

/* ---- starting ---------------------------------------------------------------------- */

/* In the child: become the worker, at once or, with wait_fd, when a byte comes. */
static void become_worker(const struct supervisor *supervisor, pid_t parent, int wait_fd,
                          int lifeline)
{
    sigset_t none;
    sigemptyset(&none);
    if (supervisor->ready_fd >= 0) {
        close(supervisor->ready_fd); /* who waits for its end must not wait for ours */
    }
    /* Without its supervisor nobody would start it again: it ends in order. */
    if (prctl(PR_SET_PDEATHSIG, SIGTERM) == 0 && getppid() == parent &&
        srv_standby_give(wait_fd) == 0 && srv_lifeline_give(lifeline) == 0 &&
        srv_kept_give(supervisor->kept_fd) == 0 &&
        srv_activate_give(supervisor->listen_fd) == 0 && srv_notify_give() == 0 &&
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

/* A child that becomes a worker. Without a lifeline, for want of descriptors, its death
 * is seen when it is reaped. Returns false when there is no child. */
static bool fork_worker(const struct supervisor *supervisor, int wait_fd,
                        struct worker *made)
{
    int ends[2] = {-1, -1};
    pid_t parent = getpid();
    if (srv_lifeline_make(ends) != 0) {
        ends[0] = ends[1] = -1;
    }
    pid_t child = fork();
    if (child == 0) {
        become_worker(supervisor, parent, wait_fd, ends[1]);
    }
    int saved = errno;
    close_if_open(&ends[1]); /* the worker alone holds it */
    if (child < 0) {
        close_if_open(&ends[0]);
        errno = saved;
        return false;
    }
    *made = (struct worker){.pid = child, .lifeline = ends[0]};
    return true;
}

/* Have a worker stand by. Without one the next start takes longer, no more. */
static void start_spare(struct supervisor *supervisor)
{
    int fds[2];
    supervisor->wants_spare = false;
    if (pipe2(fds, O_CLOEXEC) != 0) {
        return;
    }
    bool made = fork_worker(supervisor, fds[0], &supervisor->spare);
    close(fds[0]);
    if (!made) {
        close(fds[1]);
        return;
    }
    supervisor->spare_fd = fds[1];
    srv_log(SRV_LOG_DEBUG, 0, "process %ld stands by", (long)supervisor->spare.pid);
}

static void forget_spare(struct supervisor *supervisor)
{
    close_if_open(&supervisor->spare_fd);
    close_if_open(&supervisor->spare.lifeline);
    supervisor->spare.pid = 0;
}

static void end_spare(struct supervisor *supervisor)
{
    if (supervisor->spare.pid > 0) {
        kill(supervisor->spare.pid, SIGKILL); /* it has not begun */
        waitpid(supervisor->spare.pid, NULL, 0);
    }
    forget_spare(supervisor);
}

/* A system that has no memory or no process number left may have one soon. */
static int start_worker(struct supervisor *supervisor)
{
    supervisor->wants_spare = true;
    if (supervisor->spare.pid > 0 && write(supervisor->spare_fd, "1", 1) == 1) {
        supervisor->worker = supervisor->spare;
        supervisor->spare.lifeline = -1;
        forget_spare(supervisor);
        return 0;
    }
    end_spare(supervisor);
    bool made = fork_worker(supervisor, -1, &supervisor->worker);
    for (int tries = 1; !made && tries < FORK_TRIES; tries++) {
        srv_log(SRV_LOG_WARN, 0, "fork: %s; trying again", strerror(errno));
        if (pause_before_fork(supervisor)) {
            return PCCD_E_SYSTEM;
        }
        made = fork_worker(supervisor, -1, &supervisor->worker);
    }
    if (!made) {
        srv_log(SRV_LOG_ERROR, 0, "fork: %s", strerror(errno));
        return PCCD_E_SYSTEM;
    }
    return 0;
}

/* ---- ends -------------------------------------------------------------------------- */

/* Return whether a crash now is one more than we bear. */
static bool is_one_too_many(const struct supervisor *supervisor)
{
    uint32_t max = supervisor->crashes_max;
    uint32_t count = supervisor->crash_count + 1;
    /* With the present one, the next place of the ring is that of the first of `max`. */
    uint64_t first_ns = supervisor->crashes[count % max].ns;
    return max == 1 || (count >= max && common_now_ns() - first_ns <=
                                            (uint64_t)SRV_CRASHES_WINDOW_MS * 1000000u);
}

/* Have another worker in place of the one that has crashed. Returns -1 to go on, or the
 * exit status. */
static int replace(struct supervisor *supervisor, pid_t unreaped)
{
    supervisor->crashes[supervisor->crash_count++ % supervisor->crashes_max] =
        (struct crash){.ns = common_now_ns(), .pid = unreaped};
    close_if_open(&supervisor->worker.lifeline);
    supervisor->worker.pid = 0;
    return start_worker(supervisor) == 0 ? -1 : 1;
}

static void tell_end(pid_t pid, int wait_status)
{
    if (WIFEXITED(wait_status)) {
        srv_log(SRV_LOG_ERROR, 0, "worker %ld ended with status %d", (long)pid,
                WEXITSTATUS(wait_status));
    } else {
        srv_log(SRV_LOG_ERROR, 0, "worker %ld was ended by signal %d (%s)", (long)pid,
                WTERMSIG(wait_status), strsignal(WTERMSIG(wait_status)));
    }
}

/* The worker has ended, and is not replaced. Returns -1 to go on, or the exit status. */
static int on_end(struct supervisor *supervisor, int wait_status)
{
    bool exited = WIFEXITED(wait_status);
    pid_t pid = supervisor->worker.pid;
    if (exited && WEXITSTATUS(wait_status) == 0) {
        return 0;
    }
    if (supervisor->stopping && !exited &&
        (WTERMSIG(wait_status) == SIGTERM || WTERMSIG(wait_status) == SIGINT)) {
        return 0; /* the signal came before it could take it in order */
    }
    tell_end(pid, wait_status);
    if (supervisor->stopping) {
        return 1;
    }
    if (is_one_too_many(supervisor)) {
        srv_log(SRV_LOG_ERROR, 0, "giving up: %u %s within %u seconds",
                supervisor->crashes_max,
                proto_plural(supervisor->crashes_max, "crash", "crashes"),
                SRV_CRASHES_WINDOW_MS / 1000);
        return 1;
    }
    return replace(supervisor, 0);
}

/* Something can be read of the worker's lifeline. Returns -1 to go on, or the exit
 * status. */
static int on_lifeline(struct supervisor *supervisor)
{
    char byte;
    ssize_t got = read(supervisor->worker.lifeline, &byte, 1);
    if (got < 0 && errno == EINTR) {
        return -1;
    }
    if (got != 0 || supervisor->stopping || is_one_too_many(supervisor)) {
        close_if_open(&supervisor->worker.lifeline); /* its status says the rest */
        return -1;
    }
    return replace(supervisor, supervisor->worker.pid);
}

/* A child has ended. Returns -1 to go on, or the exit status. */
static int on_reaped(struct supervisor *supervisor, pid_t pid, int wait_status)
{
    if (pid == supervisor->spare.pid) {
        forget_spare(supervisor); /* until the next start */
    } else if (pid == supervisor->worker.pid) {
        return on_end(supervisor, wait_status);
    }
    for (uint32_t i = 0; i < supervisor->crashes_max; i++) {
        if (supervisor->crashes[i].pid == pid) {
            supervisor->crashes[i].pid = 0;
            tell_end(pid, wait_status);
        }
    }
    return -1;
}

/* ---- the file of the socket -------------------------------------------------------- */

/* Nobody finds the socket any more: the worker serves who is here, and is the last. */
static void let_go(struct supervisor *supervisor, const char *why)
{
    srv_log(SRV_LOG_ERROR, 0, "%s: %s; giving up this path", supervisor->file.path, why);
    srv_socketfile_leave(&supervisor->file);
    srv_lockfile_release(supervisor->lockfile);
    end_spare(supervisor);
    supervisor->stopping = true;
    if (srv_lifeline_tell(supervisor->worker.lifeline, -1) != 0) {
        kill(supervisor->worker.pid, SIGTERM);
    }
}

/* Another socket, for this worker and those to come. */
static void bind_anew(struct supervisor *supervisor)
{
    int fd = -1;
    if (srv_socketfile_bind(&supervisor->file, supervisor->options, &fd) != 0) {
        let_go(supervisor, strerror(errno));
        return;
    }
    srv_log(SRV_LOG_WARN, 0, "%s was removed; listening there again",
            supervisor->file.path);
    close(supervisor->listen_fd);
    supervisor->listen_fd = fd;
    end_spare(supervisor); /* it has the former one */
    supervisor->wants_spare = true;
    if (srv_lifeline_tell(supervisor->worker.lifeline, fd) != 0) {
        kill(supervisor->worker.pid, SIGKILL); /* the next one is given it */
    }
}

/* There is news of the file. */
static void on_file(struct supervisor *supervisor)
{
    const struct timespec pause = {.tv_nsec = SRV_SOCKETFILE_SETTLE_MS * 1000000l};
    if (srv_socketfile_look(&supervisor->file) == SRV_SOCKETFILE_OURS) {
        return;
    }
    nanosleep(&pause, NULL);
    enum srv_socketfile_state state = srv_socketfile_look(&supervisor->file);
    if (state == SRV_SOCKETFILE_TAKEN) {
        let_go(supervisor, "something else is there now");
    } else if (state == SRV_SOCKETFILE_GONE &&
               !srv_lockfile_is_held(supervisor->lockfile)) {
        let_go(supervisor, "it was removed, and its lock file too");
    } else if (state == SRV_SOCKETFILE_GONE) {
        bind_anew(supervisor);
    }
}

/* ---- running ----------------------------------------------------------------------- */

/* Returns -1 to go on, or the exit status. */
static int on_signal(struct supervisor *supervisor)
{
    struct signalfd_siginfo info;
    if (read(supervisor->signal_fd, &info, sizeof info) != (ssize_t)sizeof info) {
        return -1;
    }
    if (info.ssi_signo == SIGHUP) {
        srv_log_reopen();
        kill(supervisor->worker.pid, SIGHUP);
        end_spare(supervisor); /* it has read the file as it was */
        supervisor->wants_spare = true;
        return -1;
    }
    if (info.ssi_signo != SIGCHLD) {
        supervisor->stopping = true;
        srv_notify_announce("STOPPING=1");
        kill(supervisor->worker.pid, (int)info.ssi_signo);
        return -1;
    }
    int exit_status = -1; /* one signal may stand for several */
    int wait_status;
    for (pid_t pid; exit_status < 0 && (pid = waitpid(-1, &wait_status, WNOHANG)) > 0;) {
        exit_status = on_reaped(supervisor, pid, wait_status);
    }
    return exit_status;
}

static int run(struct supervisor *supervisor)
{
    int exit_status = start_worker(supervisor) == 0 ? -1 : 1;
    /* The socket listens: whoever connects now waits for the worker. */
    srv_listener_tell_ready(supervisor->ready_fd);
    supervisor->ready_fd = -1;
    if (exit_status < 0) {
        srv_notify_ready();
    }
    while (exit_status < 0) {
        bool waits = supervisor->wants_spare && !supervisor->stopping;
        struct pollfd watched[] = {
            {.fd = supervisor->signal_fd, .events = POLLIN},
            {.fd = supervisor->worker.lifeline, .events = POLLIN}, /* -1: left out */
            {.fd = supervisor->stopping ? -1 : supervisor->file.notify_fd,
             .events = POLLIN}};
        int count = poll(watched, 3, waits ? SPARE_PAUSE_MS : -1);
        if (count == 0) {
            start_spare(supervisor);
        } else if (count > 0 && watched[0].revents != 0) {
            exit_status = on_signal(supervisor); /* before a start that it forbids */
        } else if (count > 0 && watched[1].revents != 0) {
            exit_status = on_lifeline(supervisor);
        } else if (count > 0) {
            on_file(supervisor);
        }
    }
    return exit_status;
}

int srv_supervise(const struct srv_options *options, char **argv,
                  struct srv_lockfile *lockfile)
{
    struct supervisor supervisor = {.options = options,
                                    .lockfile = lockfile,
                                    .listen_fd = -1,
                                    .signal_fd = -1,
                                    .worker = {.lifeline = -1},
                                    .spare = {.lifeline = -1},
                                    .spare_fd = -1,
                                    .kept_fd = srv_kept_make(options->config),
                                    .ready_fd = options->ready_fd,
                                    .argv = argv,
                                    .crashes_max = options->crashes_max};
    sigset_t signals;
    sigemptyset(&signals);
    sigaddset(&signals, SIGCHLD);
    sigaddset(&signals, SIGTERM);
    sigaddset(&signals, SIGINT);
    sigaddset(&signals, SIGHUP);
    if (sigprocmask(SIG_BLOCK, &signals, NULL) != 0 ||
        (supervisor.signal_fd = signalfd(-1, &signals, SFD_CLOEXEC)) < 0 ||
        srv_socketfile_bind(&supervisor.file, options, &supervisor.listen_fd) != 0) {
        srv_log(SRV_LOG_ERROR, 0, "%s: %s", options->socket_path, strerror(errno));
        close_if_open(&supervisor.signal_fd);
        close_if_open(&supervisor.kept_fd);
        return 1;
    }
    srv_log(SRV_LOG_INFO, 0, "process %ld supervises %s", (long)getpid(),
            options->socket_path);
    int exit_status = run(&supervisor);
    end_spare(&supervisor);
    srv_socketfile_remove(&supervisor.file);
    close(supervisor.listen_fd);
    close_if_open(&supervisor.worker.lifeline);
    close_if_open(&supervisor.signal_fd);
    close_if_open(&supervisor.kept_fd);
    return exit_status;
}
