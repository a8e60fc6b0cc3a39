/* launch.c - daemons that the library starts. */
#include <dirent.h>
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <sched.h>
#include <signal.h>
#include <spawn.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "last_words.h"
#include "launch.h"
#include "openmp.h"

#define READY_FD       3  /* in the daemon */
#define FD_FLOOR       10 /* our ends lie above what dup2 overwrites in the daemon */
#define ARGUMENTS_MAX  12
#define PROGRAM_BYTES  4096
#define SOCKET_NAME    "/pccd.sock"
#define STOP_NS        2000000000ull /* from SIGTERM to SIGKILL */
#define REAP_PAUSE_NS  2000000 /* where the kernel has no descriptors of processes */
#define LOG_PATH_BYTES 4096
#define STOP_ENTRIES   64 /* files of a private folder: socket, lock, log */

extern char **environ;

/* `name` as an absolute path of a program that can be run. A name without a slash is
 * looked up in $PATH. Returns 0 or PCCD_E_NODAEMON. */
static int find_program(const char *name, char *program)
{
    const char *entry = getenv("PATH");
    char candidate[PROGRAM_BYTES];

    if (strchr(name, '/') != NULL) {
        if (access(name, X_OK) != 0 || realpath(name, program) == NULL) {
            return PCCD_E_NODAEMON;
        }
        return 0;
    }
    while (entry != NULL && *entry != '\0') {
        size_t bytes = strcspn(entry, ":");
        int length =
            snprintf(candidate, sizeof candidate, "%.*s/%s", (int)bytes, entry, name);

        if (bytes > 0 && length > 0 && (size_t)length < sizeof candidate &&
            access(candidate, X_OK) == 0 && realpath(candidate, program) != NULL) {
            return 0;
        }
        entry += bytes;
        if (*entry == ':') {
            entry++;
        }
    }
    return PCCD_E_NODAEMON;
}

/* pccdd in a folder, or in the one above a folder in which libtool keeps libraries.
 * Returns 0 or PCCD_E_NODAEMON. */
static int find_in(char folder[CLI_FOLDER_BYTES], char *program)
{
    static const char built[] = "/.libs";
    size_t bytes = strlen(folder);

    if (bytes > strlen(built) && strcmp(folder + bytes - strlen(built), built) == 0) {
        bytes -= strlen(built);
    }
    if (bytes == 0 || bytes + sizeof "/pccdd" > CLI_FOLDER_BYTES) {
        return PCCD_E_NODAEMON;
    }
    memcpy(folder + bytes, "/pccdd", sizeof "/pccdd");
    return find_program(folder, program);
}

/* pccdd beside the running program or this library: how a build folder has it, an
 * installation, and a product that brings its own. */
static int find_beside(char *program)
{
    char folder[CLI_FOLDER_BYTES];

    cli_folder_of_program(folder);
    if (find_in(folder, program) == 0) {
        return 0;
    }
    cli_folder_of_library(folder);
    return find_in(folder, program);
}

static int choose_program(struct pccd_client *client, const char *asked, char *program)
{
    const char *name = asked != NULL ? asked : getenv("PCCD_DAEMON");

    if (name != NULL && name[0] != '\0') {
        if (find_program(name, program) == 0) {
            return 0;
        }
        return cli_fail(client, PCCD_E_NODAEMON, "cannot run \"%.200s\": %s", name,
                        strerror(errno));
    }
    if (find_beside(program) == 0 || find_program(CLI_DAEMON_PATH, program) == 0 ||
        find_program("pccdd", program) == 0) {
        return 0;
    }
    return cli_fail(
        client, PCCD_E_NODAEMON,
        "no daemon to start: no pccdd beside this program or libpccd, at %s or in "
        "$PATH; PCCD_DAEMON=PROGRAM names one",
        CLI_DAEMON_PATH);
}

/* Move a descriptor out of the way of 0 .. READY_FD. */
static int raise_fd(int fd)
{
    int raised;

    if (fd < 0 || fd >= FD_FLOOR) {
        return fd;
    }
    raised = fcntl(fd, F_DUPFD_CLOEXEC, FD_FLOOR);
    (void)close(fd);
    return raised;
}

/* The file that the messages of the daemon at that socket go to; it has a log of its own
 * unless PCCD_LOG names one. */
static bool name_log(const char *socket_path, char name[LOG_PATH_BYTES])
{
    const char *chosen = getenv("PCCD_LOG");
    bool is_own = chosen == NULL || chosen[0] == '\0';

    (void)snprintf(name, LOG_PATH_BYTES, "%s%s", is_own ? socket_path : chosen,
                   is_own ? COMMON_OWN_LOG_ENDING : "");
    return is_own;
}

/* Open it. Of its own log nobody else may have a hand in the folder, which the daemon
 * would make itself. Anything else: its messages go nowhere. */
static int open_log(const char *socket_path)
{
    char name[LOG_PATH_BYTES], folder[LOG_PATH_BYTES];
    struct stat found;
    int fd = -1;

    if (!name_log(socket_path, name)) {
        fd = open(name, O_WRONLY | O_APPEND | O_CREAT | O_CLOEXEC, 0600);
    } else if (strchr(name, '/') != NULL) {
        (void)snprintf(folder, sizeof folder, "%.*s", (int)(strrchr(name, '/') - name),
                       name);
        (void)mkdir(folder, 0700);
        if (lstat(folder, &found) == 0 && S_ISDIR(found.st_mode) &&
            found.st_uid == geteuid() && (found.st_mode & 022) == 0) {
            fd = open(name,
                      O_RDWR | O_APPEND | O_CREAT | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK,
                      0600);
        }
    }
    return raise_fd(fd >= 0 ? fd : open("/dev/null", O_WRONLY | O_CLOEXEC));
}

void cli_launch_words(const struct pccd_client *client, const char *socket_path,
                      char words[CLI_WORDS_BYTES])
{
    char name[LOG_PATH_BYTES], line[COMMON_LAST_WORDS_BYTES], ended[64] = "";
    siginfo_t info = {.si_pid = 0};

    if (client->child.pid > 0 && client->owner == getpid() &&
        waitid(P_PID, (id_t)client->child.pid, &info, WEXITED | WNOHANG | WNOWAIT) == 0 &&
        info.si_pid != 0 && info.si_code != CLD_EXITED) {
        (void)snprintf(ended, sizeof ended, ", by signal %d (%s)", info.si_status,
                       sigdescr_np(info.si_status));
    }
    (void)name_log(socket_path, name);
    common_last_words(name, line);
    (void)snprintf(words, CLI_WORDS_BYTES, "%s%s%s", ended,
                   line[0] != '\0' ? "; it said: " : "", line);
}

/* Return whether an entry of an environment is of that variable. */
static bool is_variable(const char *entry, const char *name)
{
    size_t length = strlen(name);

    return strncmp(entry, name, length) == 0 && entry[length] == '=';
}

/* This process's environment with what the daemon's OpenMP needs, and whose its log is: a
 * daemon that has to set the former itself starts twice. The entries are this process's
 * own; the caller frees the array. NULL: no memory. */
static char **make_environment(bool has_own_log)
{
    static char spin[] = COMMON_OPENMP_SPIN_NAME "=" COMMON_OPENMP_SPIN_VALUE;
    static char own_log[] = COMMON_OWN_LOG_NAME "=1";
    bool has_spin = false;
    size_t count = 0;
    size_t kept = 0;
    char **made;

    while (environ[count] != NULL) {
        count++;
    }
    made = calloc(count + 3, sizeof *made); /* two more variables, and the end */
    for (size_t i = 0; made != NULL && i < count; i++) {
        bool is_unwanted = is_variable(environ[i], COMMON_OWN_LOG_NAME);

        for (size_t k = 0; k < COMMON_OPENMP_UNWANTED; k++) {
            is_unwanted =
                is_unwanted || is_variable(environ[i], common_openmp_unwanted[k]);
        }
        has_spin = has_spin || is_variable(environ[i], COMMON_OPENMP_SPIN_NAME);
        if (!is_unwanted) {
            made[kept++] = environ[i];
        }
    }
    if (made != NULL && !has_spin) {
        made[kept++] = spin;
    }
    if (made != NULL && has_own_log) {
        made[kept] = own_log;
    }
    return made;
}

/* Nothing of this process is left in the new one but the environment, and the four
 * descriptors. Returns 0 or an errno. */
static int spawn_clean(char *const *arguments, int log_fd, bool has_own_log, int ready_fd,
                       pid_t *pid)
{
    char **environment = NULL;
    posix_spawn_file_actions_t actions;
    posix_spawnattr_t attributes;
    sigset_t none;
    sigset_t all;
    int status = posix_spawn_file_actions_init(&actions);

    if (status != 0) {
        return status;
    }
    status = posix_spawnattr_init(&attributes);
    if (status != 0) {
        goto out;
    }
    (void)sigemptyset(&none);
    (void)sigfillset(&all);
    (void)posix_spawnattr_setsigmask(&attributes, &none);
    (void)posix_spawnattr_setsigdefault(&attributes, &all);
    (void)posix_spawnattr_setflags(
        &attributes,
        (short)(POSIX_SPAWN_SETSID | POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF));
    if ((status = posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY,
                                                   0)) == 0 &&
        (status = posix_spawn_file_actions_adddup2(&actions, log_fd, 1)) == 0 &&
        (status = posix_spawn_file_actions_adddup2(&actions, log_fd, 2)) == 0 &&
        (status = posix_spawn_file_actions_adddup2(&actions, ready_fd, READY_FD)) == 0 &&
        (status = posix_spawn_file_actions_addclosefrom_np(&actions, READY_FD + 1)) ==
            0 &&
        (status = posix_spawn_file_actions_addchdir_np(&actions, "/")) == 0) {
        environment = make_environment(has_own_log);
        status = environment == NULL ? ENOMEM
                                     : posix_spawn(pid, arguments[0], &actions,
                                                   &attributes, arguments, environment);
        free(environment);
    }
    (void)posix_spawnattr_destroy(&attributes);
out:
    (void)posix_spawn_file_actions_destroy(&actions);
    return status;
}

/* Wait for the byte that says "listening". PCCD_E_BUSY: or that another one holds the
 * path; PCCD_E_AGAIN: the daemon ended without either. */
static int await_ready(struct pccd_client *client, int fd, uint64_t deadline_ns)
{
    for (;;) {
        uint64_t now_ns = common_now_ns();
        uint64_t left_ns = deadline_ns > now_ns ? deadline_ns - now_ns : 0;
        struct timespec left = {(time_t)(left_ns / 1000000000u),
                                (long)(left_ns % 1000000000u)};
        struct pollfd watched = {.fd = fd, .events = POLLIN};
        int ready = ppoll(&watched, 1, &left, NULL);
        char byte;
        ssize_t got;

        if (ready < 0 && errno == EINTR) {
            continue;
        }
        if (ready <= 0) {
            return cli_fail(client, ready == 0 ? PCCD_E_TIMEOUT : PCCD_E_SYSTEM,
                            "the daemon that was started does not get ready");
        }
        got = read(fd, &byte, 1);
        if (got < 0 && (errno == EINTR || errno == EAGAIN)) {
            continue;
        }
        return got != 1 ? PCCD_E_AGAIN : byte == '0' ? PCCD_E_BUSY : 0;
    }
}

/* Run `arguments`, a daemon at that socket, with --ready-fd READY_FD and wait until it
 * listens. *pid is set as soon as the process exists. */
static int start(struct pccd_client *client, char *const *arguments,
                 const char *socket_path, uint64_t deadline_ns, pid_t *pid)
{
    char log_name[LOG_PATH_BYTES];
    int pipe_fds[2];
    int log_fd;
    int status;

    if (pipe2(pipe_fds, O_CLOEXEC) != 0) {
        return cli_fail(client, PCCD_E_SYSTEM, "pipe: %s", strerror(errno));
    }
    pipe_fds[1] = raise_fd(pipe_fds[1]);
    log_fd = open_log(socket_path);
    if (pipe_fds[1] < 0 || log_fd < 0) {
        status = cli_fail(client, PCCD_E_SYSTEM,
                          "no descriptor for the daemon's messages: %s", strerror(errno));
        goto out;
    }
    status =
        spawn_clean(arguments, log_fd, name_log(socket_path, log_name), pipe_fds[1], pid);
    if (status != 0) {
        status = cli_fail(client, PCCD_E_SYSTEM, "start of %s: %s", arguments[0],
                          strerror(status));
        goto out;
    }
    (void)close(pipe_fds[1]); /* ours; so that the daemon's end is the last one */
    pipe_fds[1] = -1;
    status = await_ready(client, pipe_fds[0], deadline_ns);
out:
    if (log_fd >= 0) {
        (void)close(log_fd);
    }
    if (pipe_fds[1] >= 0) {
        (void)close(pipe_fds[1]);
    }
    (void)close(pipe_fds[0]);
    return status;
}

/* Others will use the daemon, too: it has all processors of the cpuset, though this
 * thread may be bound to one (by mpirun, by OMP_PROC_BIND). false: nothing is changed. */
static bool take_all_processors(cpu_set_t *mine)
{
    cpu_set_t all;

    memset(&all, 0xff, sizeof all); /* the system takes out what the cpuset has not */
    return sched_getaffinity(0, sizeof *mine, mine) == 0 &&
           sched_setaffinity(0, sizeof all, &all) == 0;
}

int cli_launch_user(struct pccd_client *client, const char *program, const char *path,
                    uint64_t deadline_ns)
{
    /* The shell starts the daemon in the background and ends: the daemon is nobody's
     * child then, and the caller's waits never see it. */
    static const char script[] = "\"$0\" \"$@\" &";
    char found[PROGRAM_BYTES];
    char *arguments[ARGUMENTS_MAX] = {(char *)"/bin/sh",
                                      (char *)"-c",
                                      (char *)script,
                                      found,
                                      (char *)"--socket",
                                      (char *)path,
                                      (char *)"--ready-fd",
                                      (char *)"3",
                                      (char *)"--idle-exit",
                                      (char *)"30",
                                      NULL};
    pid_t shell = 0;
    cpu_set_t mine;
    int status = choose_program(client, program, found);

    if (status != 0) {
        return status;
    }
    bool is_bound = take_all_processors(&mine);
    status = start(client, arguments, path, deadline_ns, &shell);
    if (is_bound) {
        (void)sched_setaffinity(0, sizeof mine, &mine);
    }
    while (shell > 0 && waitpid(shell, NULL, 0) < 0 && errno == EINTR) {
        ;
    }
    return status;
}

/* Make a folder that only this user can enter: the one that a socket was in before, whose
 * path others may know, or another one. */
static int make_directory(struct pccd_client *client, const char *before, char *directory)
{
    const char *runtime = getenv("XDG_RUNTIME_DIR");
    const char *const parents[2] = {runtime, "/tmp"};
    const char *slash = strrchr(before, '/');

    if (slash != NULL) {
        (void)snprintf(directory, CLI_SOCKET_BYTES, "%.*s", (int)(slash - before),
                       before);
        if (mkdir(directory, S_IRWXU) == 0) {
            return 0;
        }
    }
    for (size_t i = 0; i < 2; i++) {
        int length;

        if (parents[i] == NULL || parents[i][0] != '/') {
            continue;
        }
        length = snprintf(directory, CLI_SOCKET_BYTES, "%s/pccd-XXXXXX", parents[i]);
        if (length > 0 && (size_t)length + sizeof(SOCKET_NAME) <= CLI_SOCKET_BYTES &&
            mkdtemp(directory) != NULL) {
            return 0;
        }
    }
    directory[0] = '\0';
    return cli_fail(client, PCCD_E_SYSTEM, "no folder for a private daemon's socket: %s",
                    strerror(errno));
}

/* It has closed its descriptors, and ends; who reaps it has not changed. */
static void await_zombie(pid_t pid)
{
    siginfo_t info;

    while (waitid(P_PID, (id_t)pid, &info, WEXITED | WNOWAIT) != 0 && errno == EINTR) {
        ;
    }
}

int cli_launch_private(struct pccd_client *client, const char *program, char *path,
                       uint64_t deadline_ns)
{
    char found[PROGRAM_BYTES];
    char *arguments[ARGUMENTS_MAX] = {
        found,       (char *)"--socket",  path, (char *)"--ready-fd",
        (char *)"3", (char *)"--private", NULL};
    int status = choose_program(client, program, found);

    if (status != 0) {
        return status;
    }
    status = make_directory(client, path, client->child.directory);
    if (status != 0) {
        return status;
    }
    (void)stpcpy(stpcpy(path, client->child.directory), SOCKET_NAME);
    status = start(client, arguments, path, deadline_ns, &client->child.pid);
    if (status == PCCD_E_AGAIN) {
        char words[CLI_WORDS_BYTES];

        await_zombie(client->child.pid);
        cli_launch_words(client, path, words);
        return cli_fail(client, PCCD_E_NODAEMON, "%.200s ended at once%s", found, words);
    }
    return status;
}

/* Reap the daemon if it has ended. A program that collects all its children, or ignores
 * SIGCHLD, may have done so already. */
static bool is_gone(pid_t pid)
{
    pid_t got = waitpid(pid, NULL, WNOHANG);

    return got == pid || (got < 0 && errno != EINTR);
}

static void remove_directory(const char *directory)
{
    DIR *entries = opendir(directory);

    if (entries == NULL) {
        return;
    }
    for (int i = 0; i < STOP_ENTRIES; i++) {
        const struct dirent *entry = readdir(entries);

        if (entry == NULL) {
            break;
        }
        if (strcmp(entry->d_name, ".") != 0 && strcmp(entry->d_name, "..") != 0) {
            (void)unlinkat(dirfd(entries), entry->d_name, 0);
        }
    }
    (void)closedir(entries);
    (void)rmdir(directory);
}

/* Wait until the daemon has ended, or until then; reap it. Returns whether it has. */
static bool await_end(pid_t pid, uint64_t until_ns)
{
    int fd = (int)syscall(SYS_pidfd_open, pid, 0); /* Linux 5.3 */
    bool gone;

    while (!(gone = is_gone(pid)) && common_now_ns() < until_ns) {
        uint64_t now_ns = common_now_ns();
        uint64_t left_ns = until_ns > now_ns ? until_ns - now_ns : 0;
        struct pollfd watched = {.fd = fd, .events = POLLIN};

        if (fd < 0 && left_ns > REAP_PAUSE_NS) {
            left_ns = REAP_PAUSE_NS;
        }
        (void)ppoll(&watched, fd >= 0,
                    &(struct timespec){(time_t)(left_ns / 1000000000u),
                                       (long)(left_ns % 1000000000u)},
                    NULL);
    }
    if (fd >= 0) {
        (void)close(fd);
    }
    return gone;
}

void cli_launch_ask_to_end(struct cli_child *child)
{
    if (child->pid > 0 && is_gone(child->pid)) {
        child->pid = 0; /* reaped: the number may be another process's */
    }
    if (child->pid > 0) {
        (void)kill(child->pid, SIGTERM);
    }
}

void cli_launch_stop(struct cli_child *child)
{
    if (child->pid > 0 && !is_gone(child->pid)) {
        (void)kill(child->pid, SIGTERM);
        if (!await_end(child->pid, common_now_ns() + STOP_NS)) {
            (void)kill(child->pid, SIGKILL);
            (void)await_end(child->pid, UINT64_MAX);
        }
    }
    child->pid = 0;
    if (child->directory[0] != '\0') {
        remove_directory(child->directory);
    }
    child->directory[0] = '\0';
}

/* ---- folders ----------------------------------------------------------------------- */

static void cut_name(char path[CLI_FOLDER_BYTES])
{
    char *slash = strrchr(path, '/');

    *(slash != NULL ? slash : path) = '\0';
}

void cli_folder_of_library(char folder[CLI_FOLDER_BYTES])
{
    Dl_info info;

    folder[0] = '\0';
    if (dladdr((const void *)(uintptr_t)&cli_folder_of_library, &info) != 0 &&
        info.dli_fname != NULL && strlen(info.dli_fname) < CLI_FOLDER_BYTES) {
        memcpy(folder, info.dli_fname, strlen(info.dli_fname) + 1);
    }
    cut_name(folder);
}

void cli_folder_of_program(char folder[CLI_FOLDER_BYTES])
{
    ssize_t bytes = readlink("/proc/self/exe", folder, CLI_FOLDER_BYTES - 1);

    folder[bytes > 0 ? bytes : 0] = '\0';
    cut_name(folder);
}
