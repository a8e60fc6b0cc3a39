/* sandbox.c - give up what a daemon that serves has no use for. */
#include "sandbox.h"

#include <errno.h>
#include <string.h>

#include "log.h"
#include "pccd_types.h"
#include "sandbox_calls.h"

static int landlock_version; /* 0: not in use */
static int begin_status;     /* 0, or why there is to be no sandbox: a negative errno */

#ifdef HAVE_SECCOMP

#include <fcntl.h>
#include <sched.h>
#include <seccomp.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>

static const int allowed[] = {
#define ALLOWED(call) SCMP_SYS(call),
    SRV_SANDBOX_CALLS(ALLOWED)
#undef ALLOWED
};

/* Calls that only some arguments make harmless. */
static int allow_some(scmp_filter_ctx filter)
{
    int status = 0;
    /* Threads, not processes. Arguments of clone3 cannot be looked at: as on an older
     * kernel, the C library takes clone then. */
    status |= seccomp_rule_add(filter, SCMP_ACT_ERRNO(ENOSYS), SCMP_SYS(clone3), 0);
    status |= seccomp_rule_add(filter, SCMP_ACT_ALLOW, SCMP_SYS(clone), 1,
                               SCMP_A0(SCMP_CMP_MASKED_EQ, CLONE_THREAD, CLONE_THREAD));
    status |= seccomp_rule_add(filter, SCMP_ACT_ALLOW, SCMP_SYS(mmap), 1,
                               SCMP_A2(SCMP_CMP_MASKED_EQ, PROT_EXEC, 0));
    status |= seccomp_rule_add(filter, SCMP_ACT_ALLOW, SCMP_SYS(mprotect), 1,
                               SCMP_A2(SCMP_CMP_MASKED_EQ, PROT_EXEC, 0));
    status |= seccomp_rule_add(filter, SCMP_ACT_ALLOW, SCMP_SYS(ioctl), 1,
                               SCMP_A1(SCMP_CMP_EQ, FIONBIO, 0));
    status |= seccomp_rule_add(filter, SCMP_ACT_ALLOW, SCMP_SYS(kill), 1,
                               SCMP_A1(SCMP_CMP_EQ, 0, 0)); /* no signal: does it live? */
    status |= seccomp_rule_add(filter, SCMP_ACT_ALLOW, SCMP_SYS(setpriority), 2,
                               SCMP_A0(SCMP_CMP_EQ, PRIO_PROCESS, 0),
                               SCMP_A1(SCMP_CMP_EQ, 0, 0)); /* the thread's own */
    status |= seccomp_rule_add(filter, SCMP_ACT_ALLOW, SCMP_SYS(prctl), 1,
                               SCMP_A0(SCMP_CMP_EQ, PR_SET_NAME, 0));
    return status;
}

/* A memory of which the client gets a descriptor that can only be read from is opened
 * anew, by its name in /proc. Paths cannot be looked at here: only where Landlock keeps
 * the process from reading any file. Elsewhere the memory is sealed (memfd.c). */
static int allow_reopening(scmp_filter_ctx filter)
{
    int status = seccomp_rule_add(filter, SCMP_ACT_ALLOW, SCMP_SYS(fchmod), 1,
                                  SCMP_A1(SCMP_CMP_EQ, S_IRUSR, 0));
    status |= seccomp_rule_add(filter, SCMP_ACT_ALLOW, SCMP_SYS(openat), 1,
                               SCMP_A2(SCMP_CMP_EQ, O_RDONLY | O_CLOEXEC, 0));
    return status;
}

/* Allow opening what SIGHUP has opened again. Where Landlock is, it allows these files'
 * folders alone. */
static int allow_own_files(scmp_filter_ctx filter, const struct srv_options *options)
{
    const uint64_t flags[] = {O_RDONLY | O_CLOEXEC, /* fopen's "re" and "ae" */
                              O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC};
    const bool wanted[] = {options->config != NULL && landlock_version == 0,
                           options->log_path[0] != '\0'};
    int status = 0;
    for (size_t i = 0; i < sizeof flags / sizeof flags[0]; i++) {
        if (wanted[i]) {
            status |= seccomp_rule_add(filter, SCMP_ACT_ALLOW, SCMP_SYS(openat), 1,
                                       SCMP_A2(SCMP_CMP_EQ, flags[i], 0));
        }
    }
    return status;
}

/* Allow binding: who has bound the socket binds it anew when somebody removes its
 * file. */
static int allow_binding(scmp_filter_ctx filter)
{
    static const int calls[] = {SCMP_SYS(bind), SCMP_SYS(listen), SCMP_SYS(umask),
                                SCMP_SYS(inotify_add_watch)};
    const uint64_t type = SOCK_SEQPACKET | SOCK_CLOEXEC | SOCK_NONBLOCK;
    int status = seccomp_rule_add(
        filter, SCMP_ACT_ALLOW, SCMP_SYS(socket), 3, SCMP_A0(SCMP_CMP_EQ, AF_UNIX, 0),
        SCMP_A1(SCMP_CMP_EQ, type, 0), SCMP_A2(SCMP_CMP_EQ, 0, 0));
    for (size_t i = 0; i < sizeof calls / sizeof calls[0]; i++) {
        status |= seccomp_rule_add(filter, SCMP_ACT_ALLOW, calls[i], 0);
    }
    return status;
}

/* From 1.45 on, libuv makes an io_uring with each loop, and ends the process when a call
 * on that is forbidden. Where none can be made it takes epoll. 0 or a negative errno. */
static int forbid_rings(void)
{
    scmp_filter_ctx filter = seccomp_init(SCMP_ACT_ALLOW);
    if (filter == NULL) {
        return -ENOMEM;
    }
    int status =
        seccomp_rule_add(filter, SCMP_ACT_ERRNO(ENOSYS), SCMP_SYS(io_uring_setup), 0);
    if (status == 0) {
        status = seccomp_load(filter);
    }
    seccomp_release(filter);
    return status;
}

/* 0 or a negative errno. */
static int enter(const struct srv_options *options)
{
    scmp_filter_ctx filter = seccomp_init(SCMP_ACT_ERRNO(EPERM));
    if (filter == NULL) {
        return -ENOMEM;
    }
    int status = seccomp_attr_set(filter, SCMP_FLTATR_CTL_TSYNC, 1);
    for (size_t i = 0; i < sizeof allowed / sizeof allowed[0] && status == 0; i++) {
        status = seccomp_rule_add(filter, SCMP_ACT_ALLOW, allowed[i], 0);
    }
    if (status == 0 && (allow_some(filter) != 0 ||
                        (landlock_version > 0 && allow_reopening(filter) != 0) ||
                        allow_own_files(filter, options) != 0 ||
                        (options->listen_fd < 0 && allow_binding(filter) != 0))) {
        status = -EINVAL;
    }
    if (status == 0) {
        status = seccomp_load(filter); /* sets no_new_privs, too */
    }
    seccomp_release(filter);
    return status;
}

bool srv_sandbox_is_default(void)
{
#ifdef PCCD_SANITIZED
    return false; /* sanitizers open files when they have something to say */
#else
    return true;
#endif
}

#else

static int forbid_rings(void)
{
    return -ENOSYS; /* built without libseccomp */
}

static int enter(const struct srv_options *options)
{
    (void)options;
    return -ENOSYS;
}

bool srv_sandbox_is_default(void)
{
    return false;
}

#endif

static bool is_filtered;

static bool is_wanted(const struct srv_options *options)
{
    return options->sandbox == SRV_SANDBOX_ON ||
           (options->sandbox == SRV_SANDBOX_AUTO && srv_sandbox_is_default());
}

void srv_sandbox_begin(const struct srv_options *options)
{
    if (is_wanted(options)) {
        landlock_version = srv_landlock_enter(options);
        begin_status = forbid_rings();
    }
}

const char *srv_sandbox_text(void)
{
    return !is_filtered            ? ""
           : landlock_version == 0 ? ", sandbox: seccomp (no Landlock here)"
                                   : ", sandbox: seccomp, Landlock";
}

int srv_sandbox_enter(const struct srv_options *options)
{
    if (!is_wanted(options)) {
        return 0;
    }
    int status = begin_status == 0 ? enter(options) : begin_status;
    if (status == 0) {
        is_filtered = true;
        srv_log(SRV_LOG_DEBUG, 0, "in the sandbox");
        return 0;
    }
    bool wanted = options->sandbox == SRV_SANDBOX_ON;
    srv_log(wanted ? SRV_LOG_ERROR : SRV_LOG_WARN, 0, "no sandbox: %s",
            strerror(-status));
    return wanted ? PCCD_E_SYSTEM : 0;
}
