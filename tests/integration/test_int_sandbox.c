/* test_int_sandbox.c - what a serving daemon may still do. */
#include "cases.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/ptrace.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <linux/filter.h>
#include <linux/seccomp.h>

#include "daemon.h"
#include "grid.h"
#include "must.h"

#if defined HAVE_SECCOMP && !defined PCCD_SANITIZED
#define HAS_SANDBOX true
#else
#define HAS_SANDBOX false
#endif

static const char *const boxed[] = {"--sandbox", "on", "--threads", "4", NULL};

static int setup(void **state)
{
    struct test_daemon *daemon = calloc(1, sizeof *daemon);
    *state = daemon;
    if (daemon == NULL) {
        return -1;
    }
    return !HAS_SANDBOX || test_daemon_start(daemon, boxed) ? 0 : -1;
}

static int teardown(void **state)
{
    struct test_daemon *daemon = *state;
    bool in_order = !HAS_SANDBOX || test_daemon_finish(daemon);
    free(daemon);
    return in_order ? 0 : -1;
}

static void need_sandbox(void)
{
    if (!HAS_SANDBOX) {
        test_skip("no sandbox in this build");
    }
}

/* The number after `name` in the status of a thread; -1: there is none. */
static int status_of(pid_t process, const char *thread, const char *name)
{
    char path[320];
    char line[256];
    int value = -1;
    snprintf(path, sizeof path, "/proc/%ld/task/%s/status", (long)process, thread);
    FILE *file = fopen(path, "r");
    while (file != NULL && fgets(line, sizeof line, file) != NULL) {
        if (strncmp(line, name, strlen(name)) == 0) {
            value = atoi(line + strlen(name));
        }
    }
    if (file != NULL) {
        fclose(file);
    }
    return value;
}

/* If one thread were left out, whoever takes it over could open any file. */
CASE(sandbox__holds_every_thread)
{
    need_sandbox();
    const struct test_daemon *daemon = *state;
    char path[64];
    int count = 0;
    snprintf(path, sizeof path, "/proc/%ld/task", (long)daemon->pid);
    DIR *threads = opendir(path);
    assert_non_null(threads);
    for (const struct dirent *entry = readdir(threads); entry != NULL;
         entry = readdir(threads)) {
        if (entry->d_name[0] != '.') {
            assert_int_equal(status_of(daemon->pid, entry->d_name, "Seccomp:"), 2);
            assert_int_equal(status_of(daemon->pid, entry->d_name, "NoNewPrivs:"), 1);
            count++;
        }
    }
    closedir(threads);
    assert_in_range(count, 2, 16); /* the loop, the compute thread, its team */
}

/* ---- files ------------------------------------------------------------------------- */

#define CREATE_RULESET   444 /* of Landlock */
#define HAS_VERSION_ONLY 1

static bool kernel_has_landlock(void)
{
    return syscall(CREATE_RULESET, NULL, 0, HAS_VERSION_ONLY) > 0;
}

#if defined __x86_64__
#include <sys/user.h>

static void put_string(pid_t thread, unsigned long long at, const char *text)
{
    size_t bytes = strlen(text) + 1;
    for (size_t i = 0; i < bytes; i += sizeof(long)) {
        long word = 0;
        memcpy(&word, text + i, bytes - i < sizeof word ? bytes - i : sizeof word);
        assert_int_equal(ptrace(PTRACE_POKEDATA, thread, at + i, word), 0);
    }
}

/* Have a thread, which sleeps in a system call, make another one: of a path alone
 * (unlink), or openat's to read it. Returns what that did. */
static long call_in(pid_t thread, long call, const char *path)
{
    struct user_regs_struct before;
    int status = 0;
    assert_int_equal(ptrace(PTRACE_SEIZE, thread, 0, 0), 0);
    assert_int_equal(ptrace(PTRACE_INTERRUPT, thread, 0, 0), 0);
    assert_int_equal(waitpid(thread, &status, __WALL), thread);
    assert_int_equal(ptrace(PTRACE_GETREGS, thread, 0, &before), 0);
    long code = ptrace(PTRACE_PEEKTEXT, thread, before.rip - 2, 0);
    assert_int_equal(code & 0xffff, 0x050f); /* syscall */
    struct user_regs_struct regs = before;
    regs.rsp = (before.rsp - 1024) & ~15ull;
    regs.rip = before.rip - 2;
    regs.rax = (unsigned long long)call;
    regs.orig_rax = ~0ull;
    regs.rdi = call == SYS_openat ? (unsigned long long)AT_FDCWD : regs.rsp;
    regs.rsi = regs.rsp;
    regs.rdx = O_RDONLY | O_CLOEXEC;
    put_string(thread, regs.rsp, path);
    assert_int_equal(ptrace(PTRACE_SETREGS, thread, 0, &regs), 0);
    assert_int_equal(ptrace(PTRACE_SINGLESTEP, thread, 0, 0), 0);
    assert_int_equal(waitpid(thread, &status, __WALL), thread);
    assert_int_equal(ptrace(PTRACE_GETREGS, thread, 0, &regs), 0);
    assert_int_equal(ptrace(PTRACE_SETREGS, thread, 0, &before), 0);
    assert_int_equal(ptrace(PTRACE_DETACH, thread, 0, 0), 0);
    return (long)regs.rax;
}

/* If it failed, whoever takes over a thread could remove, or read, any file of the
 * daemon's user, as root every one. */
CASE(sandbox__lets_no_file_be_removed_or_read)
{
    need_sandbox();
    const struct test_daemon *daemon = *state;
    char path[64];
    char precious[64] = "/tmp/pccd-precious-XXXXXX";
    int count = 0;
    if (!kernel_has_landlock()) {
        test_skip("this kernel has no Landlock");
    }
    int fd = mkstemp(precious);
    assert_true(fd >= 0);
    snprintf(path, sizeof path, "/proc/%ld/task", (long)daemon->pid);
    DIR *threads = opendir(path);
    assert_non_null(threads);
    for (const struct dirent *entry = readdir(threads); entry != NULL;
         entry = readdir(threads)) {
        if (entry->d_name[0] != '.') {
            pid_t thread = atoi(entry->d_name);
            assert_int_equal(call_in(thread, SYS_unlink, precious), -EACCES);
            assert_int_equal(call_in(thread, SYS_openat, precious), -EACCES);
            count++;
        }
    }
    closedir(threads);
    assert_true(count > 1);
    assert_int_equal(access(precious, F_OK), 0);
    close(fd);
    assert_int_equal(unlink(precious), 0);
    assert_true(test_daemon_logged(daemon, "sandbox: seccomp, Landlock"));
}
#else
/* Registers are those of another processor. */
CASE(sandbox__lets_no_file_be_removed_or_read)
{
    need_sandbox();
    (void)state;
    test_skip("registers are those of another processor");
}
#endif

/* From here on this process, and what it starts, has no Landlock. */
static bool forget_landlock(void)
{
    struct sock_filter code[] = {
        BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(struct seccomp_data, nr)),
        BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, CREATE_RULESET, 0, 1),
        BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ERRNO | ENOSYS),
        BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW),
    };
    struct sock_fprog program = {.len = sizeof code / sizeof code[0], .filter = code};
    return prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 &&
           prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program) == 0 &&
           !kernel_has_landlock();
}

/* If it failed, a daemon on an older kernel would not start, or be silent about what it
 * lacks. */
CASE(sandbox__does_without_landlock)
{
    need_sandbox();
    int status = 0;
    (void)state;
    pid_t child = fork();
    if (child == 0) {
        static struct test_daemon daemon;
        test_end_with_parent();
        bool is_right =
            forget_landlock() && test_daemon_start(&daemon, boxed) &&
            test_daemon_logged(&daemon, "sandbox: seccomp (no Landlock here)");
        _exit(test_daemon_finish(&daemon) && is_right ? 0 : 1);
    }
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_int_equal(status, 0);
}

/* If a call were missing in the list, a client would see a step or an attach fail. */
CASE(sandbox__leaves_all_that_clients_use)
{
    need_sandbox();
    const struct test_daemon *daemon = *state;
    struct test_grid grid;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    struct pccd_client *client = test_client(&(struct pccd_options){.url = daemon->url});
    assert_ok(test_grid_make(client, 60, &grid));
    for (int i = 0; i < 20; i++) {
        assert_ok(test_grid_turn(&grid, NULL, &answer));
        pccd_answer_release(client, &answer);
        assert_ok(test_grid_replace(&grid));
    }
    test_grid_close(&grid);
}

CASES_WITH(setup, teardown);
