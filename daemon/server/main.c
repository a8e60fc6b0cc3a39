/* main.c - program pccdd. */
#include <errno.h>
#include <malloc.h>
#include <signal.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "commandline.h"
#include "crash.h"
#include "engine.h"
#include "last_words.h"
#include "lifeline.h"
#include "listener.h"
#include "log.h"
#include "notify.h"
#include "openmp.h"
#include "reactor.h"
#include "rounding.h"
#include "socketfile.h"
#include "supervise.h"
#include "threads.h"

/* libgomp reads its environment in a constructor, so setting it here is too late for this
 * image. libpccd starts daemons with the right one. Both changes leave nothing to change
 * for the next image, so that there is at most one. */
static void prepare_environment(char **argv)
{
    struct eng_affinity all;
    bool changed = false;
    if (getenv(COMMON_OPENMP_SPIN_NAME) == NULL) {
        changed = setenv(COMMON_OPENMP_SPIN_NAME, COMMON_OPENMP_SPIN_VALUE, 0) == 0;
    }
    for (size_t i = 0; i < COMMON_OPENMP_UNWANTED; i++) {
        const char *name = common_openmp_unwanted[i];
        changed = (getenv(name) != NULL && unsetenv(name) == 0) || changed;
    }
    if (changed) {
        /* The next image begins where this thread is bound by now. */
        eng_affinity_init(&all);
        (void)eng_affinity_unbind_thread(&all);
        execv("/proc/self/exe", argv);
        srv_log(SRV_LOG_WARN, 0, "cannot restart with OpenMP's environment: %s",
                strerror(errno));
    }
}

/* PCCD_CPU chooses among the instruction sets that this processor has; with one that it
 * lacks the engine would take another, and whoever measures would not know. */
static bool has_instruction_set(void)
{
    const char *name = getenv("PCCD_CPU");
    char sets[128] = "";
    if (eng_kernels_named(name) != NULL) {
        return true;
    }
    for (int isa = 0; isa < ENG_ISA_COUNT; isa++) {
        const struct eng_kernels *kernels = eng_kernels_of((enum eng_isa)isa);
        if (kernels != NULL) {
            strcat(strcat(sets, " "), eng_kernels_name(kernels));
        }
    }
    srv_log(SRV_LOG_ERROR, 0, "PCCD_CPU=%s: there is no such instruction set here, but%s",
            name, sets);
    return false;
}

/* Large blocks go back to the system when they are freed: left to itself the C library
 * keeps up to 64 MiB of them for each thread, and who has had them is long gone. Small
 * ones are all in one heap: what one thread has freed another can use, so that memory
 * does not grow with the chances of who frees what when. Steps allocate nothing. */
static void prepare_memory(void)
{
    (void)mallopt(M_ARENA_MAX, 1);
    (void)mallopt(M_MMAP_THRESHOLD, 256 << 10);
    (void)mallopt(M_TRIM_THRESHOLD, 256 << 10);
}

static void ignore_signals(void)
{
    struct sigaction ignore = {.sa_handler = SIG_IGN};
    sigemptyset(&ignore.sa_mask);
    sigaction(SIGPIPE, &ignore, NULL); /* a dead peer is an error of its socket */
    sigaction(SIGHUP, &ignore, NULL);  /* a closed terminal is no reason to go */
    /* From before the files are read one waits for who takes it (reactor.c). */
    sigset_t waits;
    sigemptyset(&waits);
    sigaddset(&waits, SIGHUP);
    sigprocmask(SIG_BLOCK, &waits, NULL);
}

/* Its messages go to the file beside the socket (last_words.h). */
static bool has_own_log(void)
{
    return getenv(COMMON_OWN_LOG_NAME) != NULL;
}

/* It has ended as it should: nobody has to know its last words. */
static void remove_own_log(const struct srv_options *options)
{
    char path[SRV_SOCKET_PATH_BYTES + sizeof COMMON_OWN_LOG_ENDING];
    (void)stpcpy(stpcpy(path, options->socket_path), COMMON_OWN_LOG_ENDING);
    if (has_own_log()) {
        (void)unlink(path);
    }
}

/* The folder of a private daemon's socket was made for it alone, by a client that may be
 * dead by now. One that holds anything else stays: rmdir fails then. */
static void remove_private_folder(const struct srv_options *options)
{
    char folder[SRV_SOCKET_PATH_BYTES];
    strcpy(folder, options->socket_path);
    char *slash = strrchr(folder, '/');
    if (options->private_daemon && slash != NULL && slash != folder) {
        *slash = '\0';
        (void)rmdir(folder);
    }
}

/* Hold the lock of the socket path while serving. Returns the exit status. */
static int run_locked(const struct srv_options *options, char **argv)
{
    struct srv_lockfile lockfile;
    pid_t holder = 0;
    int status = srv_lockfile_acquire(&lockfile, options->socket_path, &holder);
    if (status == PCCD_E_BUSY) {
        if (!has_own_log()) { /* which is the other one's, too */
            srv_log(SRV_LOG_ERROR, 0, "%s is served by process %ld already",
                    options->socket_path, (long)holder);
        }
        srv_listener_tell_held(options->ready_fd);
        return 1;
    }
    if (status != 0) {
        srv_log(SRV_LOG_ERROR, 0, "%s: %s", lockfile.path, strerror(errno));
        return 1;
    }
    int exit_status = options->supervise ? srv_supervise(options, argv, &lockfile)
                                         : srv_reactor_run(options, &lockfile);
    if (exit_status == 0) {
        remove_own_log(options); /* before another one has it */
    }
    srv_lockfile_release(&lockfile);
    remove_private_folder(options);
    return exit_status;
}

int main(int argc, char **argv)
{
    prepare_environment(argv);
    COMMON_ROUNDING_HERE; /* of all threads: each begins as the one that makes it */
    (void)prctl(PR_SET_NAME, "pccdd", 0, 0, 0); /* started anew, it would be "exe" */
    struct srv_options options;
    ignore_signals();
    umask(0077); /* of the log, too, now as when it is opened anew */
    srv_options_parse(&options, argc, argv);
    srv_log_set_level(options.log_level);
    srv_log_set_format(options.log_format);
    int failed = options.log_path[0] != '\0' ? srv_log_open(options.log_path) : 0;
    if (failed != 0) {
        srv_log(SRV_LOG_ERROR, 0, "%s: %s", options.log_path, strerror(failed));
        return 1;
    }
    srv_log_own_file(has_own_log() ? COMMON_OWN_LOG_BYTES : 0);
    if (!has_instruction_set()) {
        return 1;
    }
    prepare_memory();
    srv_crash_install();
    srv_lifeline_take();
    if (srv_activate(&options) != 0) {
        return 1;
    }
    if (!options.private_daemon) {
        srv_notify_open();
    }
    if (options.listen_fd >= 0 || !options.supervise) { /* we serve */
        srv_listener_make_room(&options);
        options.threads_max = srv_threads_granted(options.threads_max, SRV_OWN_THREADS);
    }
    if (options.listen_fd >= 0) {
        int exit_status = srv_reactor_run(&options, NULL);
        if (exit_status == 0) {
            srv_lifeline_say_end();
        }
        return exit_status; /* who gave us the socket answers for its path */
    }
    if (srv_socketfile_prepare_folder(&options) != 0) {
        return 1;
    }
    return run_locked(&options, argv);
}
