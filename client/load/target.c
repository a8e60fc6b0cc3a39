/* target.c - the daemon under load. */
#include "target.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "pccd.h"
#include "shown.h"

#define OPTIONS_MAX 64
#define STOP_MS     20000u

/* ---- start and stop ---------------------------------------------------------------- */

/* In the child. Limits of one user are out of the way: all clients are one user's. */
static void become_daemon(const struct load_target *target, const struct load *load,
                          int ready_fd, pid_t parent)
{
    char ready[16];
    const char *options[OPTIONS_MAX] = {
        load->settings.daemon, "--supervise", "--socket",        target->socket,
        "--crashes-max",       "1024",        "--clients-max",   "65536",
        "--connections-max",   "65536",       "--shm-max-mib",   "65536",
        "--meshes-max",        "1048576",     "--triangles-max", "4000000000",
        "--queue-max",         "262144",      "--log-level",     "error",
        "--ready-fd",          ready};
    int count = 0;
    while (options[count]) {
        count++;
    }
    for (char *const *more = load->settings.daemon_options;
         more && *more && count < OPTIONS_MAX - 1; more++) {
        options[count++] = *more;
    }
    snprintf(ready, sizeof ready, "%d", ready_fd);
    int log = open(target->log, O_WRONLY | O_CREAT | O_APPEND, 0600);
    if (log >= 0 && dup2(log, 2) == 2 && prctl(PR_SET_PDEATHSIG, SIGTERM) == 0 &&
        getppid() == parent) {
        execvp(load->settings.daemon, (char *const *)(uintptr_t)options);
        dprintf(2, "%s: %s\n", load->settings.daemon, strerror(errno));
    }
    _exit(127);
}

/* The log's end, for who reads our output. */
static void show_log(const struct load_target *target)
{
    char line[512];
    FILE *log = fopen(target->log, "r");
    for (int i = 0; log && i < 40 && fgets(line, sizeof line, log); i++) {
        fprintf(stderr, "daemon: %s\n", tool_shown_field(line, strcspn(line, "\n")));
    }
    if (log) {
        fclose(log);
    }
}

bool load_target_start(struct load_target *target, struct load *load)
{
    int pipe_fds[2];
    char byte;
    const char *base = getenv("TMPDIR");
    *target = (struct load_target){0};
    snprintf(target->folder, sizeof target->folder, "%.40s/pccd-load-XXXXXX",
             base && strlen(base) <= 40 ? base : "/tmp");
    if (!mkdtemp(target->folder) || pipe(pipe_fds) != 0) {
        load_say("%s: %s", target->folder, strerror(errno));
        return false;
    }
    snprintf(target->socket, sizeof target->socket, "%s/pccd.sock", target->folder);
    snprintf(target->log, sizeof target->log, "%s/log", target->folder);
    snprintf(load->url, sizeof load->url, "unix:%s", target->socket);
    pid_t parent = getpid();
    target->supervisor = fork();
    if (target->supervisor == 0) {
        close(pipe_fds[0]);
        become_daemon(target, load, pipe_fds[1], parent);
    }
    close(pipe_fds[1]);
    bool is_ready = target->supervisor > 0 && read(pipe_fds[0], &byte, 1) == 1;
    close(pipe_fds[0]);
    if (!is_ready) {
        load_say("%s did not start", load->settings.daemon);
        (void)load_target_stop(target);
    }
    return is_ready;
}

bool load_target_stop(struct load_target *target)
{
    int status = -1;
    bool ended = false;
    if (target->supervisor > 0) {
        kill(target->supervisor, SIGTERM);
    }
    for (uint32_t ms = 0; target->supervisor > 0 && ms < STOP_MS && !ended; ms += 10) {
        ended = waitpid(target->supervisor, &status, WNOHANG) == target->supervisor;
        load_sleep_ms(ended ? 0 : 10);
    }
    if (target->supervisor > 0 && !ended) {
        kill(target->supervisor, SIGKILL);
        waitpid(target->supervisor, &status, 0);
    }
    if (status != 0) {
        if (status != -1 && WIFSIGNALED(status)) {
            load_say("the daemon was ended by signal %d", WTERMSIG(status));
        } else {
            load_say("the daemon ended with status %d",
                     status != -1 ? WEXITSTATUS(status) : -1);
        }
        show_log(target);
    }
    unlink(target->log);
    unlink(target->socket);
    char lock[128];
    snprintf(lock, sizeof lock, "%s.lock", target->socket);
    unlink(lock);
    rmdir(target->folder);
    target->supervisor = 0;
    return status == 0;
}

/* ---- what it is and holds ---------------------------------------------------------- */

static struct pccd_client *ask(const struct load *load)
{
    struct pccd_options options;
    struct pccd_client *client = NULL;
    pccd_options_init(&options);
    options.url = load->url;
    options.name = "pccd-load";
    options.no_autostart = true;
    if (pccd_connect(&options, &client) != 0) {
        load_say("%s: %s", load->url, pccd_error_text(NULL));
    }
    return client;
}

pid_t load_target_pid(const struct load *load)
{
    struct pccd_client *client = ask(load);
    pid_t pid = client ? (pid_t)pccd_daemon_pid(client) : 0;
    pccd_close(client);
    return pid;
}

static void hold(struct load_holdings *holdings, const char *name, uint64_t value)
{
    if (holdings->count < LOAD_HOLDINGS_MAX) {
        snprintf(holdings->name[holdings->count], sizeof holdings->name[0], "%s", name);
        holdings->value[holdings->count++] = value;
    }
}

static void note(void *context, const char *name, uint64_t value, const char *text)
{
    size_t length = strlen(name);
    (void)text;
    if (length > 4 && strcmp(name + length - 4, "_now") == 0) {
        hold(context, name, value);
    }
}

bool load_target_holdings(const struct load *load, struct load_holdings *holdings)
{
    struct pccd_client *client = ask(load);
    *holdings = (struct load_holdings){0};
    int status = client ? pccd_stats(client, note, holdings) : PCCD_E_DISCONNECTED;
    if (status == 0) {
        int64_t fds = load_target_descriptors((pid_t)pccd_daemon_pid(client));
        hold(holdings, "descriptors", fds < 0 ? 0 : (uint64_t)fds);
    }
    pccd_close(client);
    return status == 0;
}

int64_t load_target_descriptors(pid_t pid)
{
    char path[64];
    int64_t count = 0;
    snprintf(path, sizeof path, "/proc/%ld/fd", (long)pid);
    DIR *folder = opendir(path);
    if (!folder) {
        return -1;
    }
    while (readdir(folder)) {
        count++;
    }
    closedir(folder);
    return count - 2; /* . and .. */
}

static FILE *open_proc(pid_t pid, const char *name)
{
    char path[64];
    snprintf(path, sizeof path, "/proc/%ld/%s", (long)pid, name);
    return fopen(path, "r");
}

int64_t load_target_mappings(pid_t pid)
{
    FILE *file = open_proc(pid, "maps");
    int64_t count = 0;
    int c;
    if (!file) {
        return -1;
    }
    while ((c = fgetc(file)) != EOF) {
        count += c == '\n';
    }
    fclose(file);
    return count;
}

int64_t load_target_memory(pid_t pid)
{
    FILE *file = open_proc(pid, "smaps_rollup");
    char line[256];
    long long kib = -1;
    while (file && fgets(line, sizeof line, file)) {
        if (sscanf(line, "Anonymous: %lld", &kib) == 1) {
            break;
        }
    }
    if (file) {
        fclose(file);
    }
    return kib;
}
