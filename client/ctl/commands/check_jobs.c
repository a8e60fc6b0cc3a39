/* check_jobs.c - the steps of a check in several processes, and their lines in order. */
#include "check_walk.h"

#include <errno.h>
#include <inttypes.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "ctl.h"
#include "judge.h"
#include "terminal.h"

#define LOOK_S 0.01 /* between looks for another line */

char *check_part_path(const char *base, uint32_t part, uint32_t parts)
{
    char *path = NULL;
    return asprintf(&path, "%s.%" PRIu32 "-of-%" PRIu32, base, part, parts) < 0 ? NULL
                                                                                : path;
}

/* ---- processes --------------------------------------------------------------------- */

/* Threads for each of so many processes, where nobody has said how many. */
static uint32_t share_of_threads(uint32_t jobs)
{
    long online = sysconf(_SC_NPROCESSORS_ONLN);
    return online > (long)jobs ? (uint32_t)online / jobs : 1;
}

/* In the child: it ends with the parent. */
static void run_part(const struct check_jobs *jobs, uint32_t part, pid_t parent)
{
    struct check_command command = *jobs->command;
    (void)prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent || dup2(fileno(jobs->errors[part - 1]), STDERR_FILENO) < 0) {
        _exit(CTL_FAILED);
    }
    command.results = (struct results_options){
        .path = jobs->base, .part = part, .parts = jobs->count, .is_job = true};
    if (command.check.ask.threads == 0) {
        command.check.ask.threads = share_of_threads(jobs->count);
    }
    _exit(check_walk(&command));
}

static int make_base(struct check_jobs *jobs, struct ctl_error *error)
{
    const char *path = jobs->command->results.path;
    const char *temporary = getenv("TMPDIR");
    int length = 0;
    if (path != NULL && strcmp(path, "-") != 0) {
        jobs->base = strdup(path);
    } else {
        length = asprintf(&jobs->folder, "%s/pccd-check-XXXXXX",
                          temporary != NULL && temporary[0] != '\0' ? temporary : "/tmp");
        if (length < 0 || mkdtemp(jobs->folder) == NULL) {
            int cause = errno;
            const char *name = length < 0 ? "" : jobs->folder;
            int status =
                ctl_error_set(error, PCCD_E_SYSTEM, "%s: cannot make a folder: %s", name,
                              strerror(cause));
            free(length < 0 ? NULL : jobs->folder);
            jobs->folder = NULL;
            return status;
        }
        if (asprintf(&jobs->base, "%s/results", jobs->folder) < 0) {
            jobs->base = NULL;
        }
    }
    return jobs->base != NULL ? PCCD_OK
                              : ctl_error_set(error, PCCD_E_NOMEM, "no memory for jobs");
}

int check_jobs_start(struct check_jobs *jobs, const struct check_command *command,
                     const json_t *head, struct ctl_error *error)
{
    jobs->command = command;
    jobs->head = head;
    jobs->count = command->results.jobs;
    jobs->processes = calloc(jobs->count, sizeof *jobs->processes);
    jobs->endings = calloc(jobs->count, sizeof *jobs->endings);
    jobs->errors = calloc(jobs->count, sizeof *jobs->errors);
    int status = jobs->processes != NULL && jobs->endings != NULL && jobs->errors != NULL
                     ? make_base(jobs, error)
                     : ctl_error_set(error, PCCD_E_NOMEM, "no memory for jobs");
    pid_t parent = getpid();
    for (uint32_t i = 0; i < jobs->count && status == PCCD_OK; i++) {
        jobs->errors[i] = tmpfile();
        (void)fflush(NULL);
        pid_t process = jobs->errors[i] != NULL ? fork() : -1;
        if (process == 0) {
            run_part(jobs, i + 1, parent);
        }
        if (process < 0) {
            return ctl_error_set(error, PCCD_E_SYSTEM,
                                 "no process for job %" PRIu32 ": %s", i + 1,
                                 strerror(errno));
        }
        jobs->processes[i] = process;
    }
    return status;
}

/* Return whether a process has ended; it is waited for then. */
static bool has_ended(struct check_jobs *jobs, uint32_t job)
{
    if (jobs->processes[job] != 0 && waitpid(jobs->processes[job], &jobs->endings[job],
                                             WNOHANG) == jobs->processes[job]) {
        jobs->processes[job] = 0;
    }
    return jobs->processes[job] == 0;
}

void check_jobs_end(struct check_jobs *jobs, bool is_done)
{
    for (uint32_t i = 0; jobs->processes != NULL && i < jobs->count; i++) {
        if (jobs->errors != NULL && jobs->errors[i] != NULL) {
            (void)fclose(jobs->errors[i]);
        }
        if (jobs->processes[i] != 0) {
            if (!is_done) {
                (void)kill(jobs->processes[i], SIGTERM);
            }
            (void)waitpid(jobs->processes[i], NULL, 0);
        }
        char *path = jobs->base != NULL && (is_done || jobs->folder != NULL)
                         ? check_part_path(jobs->base, i + 1, jobs->count)
                         : NULL;
        if (path != NULL) {
            (void)unlink(path);
        }
        free(path);
    }
    if (jobs->folder != NULL) {
        (void)rmdir(jobs->folder);
    }
    free(jobs->processes);
    free(jobs->endings);
    free(jobs->errors);
    free(jobs->base);
    free(jobs->folder);
    *jobs = (struct check_jobs){.count = 0};
}

/* ---- lines ------------------------------------------------------------------------- */

/* A file that another process appends to. */
struct growing {
    const char *path;
    FILE *file; /* NULL: it is not there yet */
    long at;    /* where the next line begins */
    char *line;
    size_t room;
};

/* The next line; NULL: it is not there, or not whole, yet. */
static json_t *next_line(struct growing *growing)
{
    if (growing->file == NULL) {
        growing->file = fopen(growing->path, "re");
    }
    if (growing->file == NULL || fseek(growing->file, growing->at, SEEK_SET) != 0) {
        return NULL;
    }
    ssize_t length = getline(&growing->line, &growing->room, growing->file);
    if (length <= 0 || growing->line[length - 1] != '\n') {
        return NULL;
    }
    growing->at += length;
    return json_loadb(growing->line, (size_t)length, 0, NULL);
}

/* Return whether this is the head that a part of the results has. */
static bool is_head_of(const struct check_jobs *jobs, uint32_t job, const json_t *line)
{
    json_t *head = json_copy((json_t *)(uintptr_t)jobs->head);
    bool is_it = json_object_set_new(head, "part", json_integer(job + 1)) == 0 &&
                 json_object_set_new(head, "parts", json_integer(jobs->count)) == 0 &&
                 json_equal(head, line);
    json_decref(head);
    return is_it;
}

/* Why a process has ended: the last line that it has said. */
static int say_why(const struct check_jobs *jobs, uint32_t job, struct ctl_error *error)
{
    static const char before[] = "pccdctl: ";
    char line[CTL_ERROR_TEXT_BYTES] = "";
    const int ending = jobs->endings[job];
    rewind(jobs->errors[job]);
    while (fgets(line, sizeof line, jobs->errors[job]) != NULL) {
    }
    line[strcspn(line, "\n")] = '\0';
    bool is_ours = strncmp(line, before, sizeof before - 1) == 0;
    return ctl_error_set(
        error,
        WIFEXITED(ending) && WEXITSTATUS(ending) == CTL_NO_DAEMON ? PCCD_E_NODAEMON
                                                                  : PCCD_E_STATE,
        "job %" PRIu32 ": %.900s", job + 1,
        line[0] == '\0' ? "it was ended" : line + (is_ours ? sizeof before - 1 : 0));
}

/* All lines of one process up to its verdict, but for the head. A file that is there with
 * another one is refused by the process. */
static int follow(struct check_jobs *jobs, uint32_t job, struct growing *growing,
                  results_line_fn take, void *context, struct ctl_error *error)
{
    for (bool is_head = true;;) {
        bool is_last = has_ended(jobs, job);
        json_t *line = next_line(growing);
        if (is_head && line != NULL && !is_head_of(jobs, job, line)) {
            json_decref(line);
            line = NULL;
            growing->at = 0;
        }
        if (line == NULL && is_last) {
            return say_why(jobs, job, error);
        }
        if (line == NULL) {
            terminal_sleep(LOOK_S);
            continue;
        }
        bool is_verdict = judge_is_line(line);
        int status = is_head || is_verdict ? PCCD_OK : take(context, line, error);
        is_head = false;
        json_decref(line);
        if (is_verdict || status != PCCD_OK) {
            return status;
        }
    }
}

int check_jobs_follow(struct check_jobs *jobs, results_line_fn take, void *context,
                      struct ctl_error *error)
{
    int status = PCCD_OK;
    for (uint32_t i = 0; i < jobs->count && status == PCCD_OK; i++) {
        char *path = check_part_path(jobs->base, i + 1, jobs->count);
        struct growing growing = {.path = path};
        status = path != NULL ? follow(jobs, i, &growing, take, context, error)
                              : ctl_error_set(error, PCCD_E_NOMEM, "no memory for jobs");
        if (growing.file != NULL) {
            (void)fclose(growing.file);
        }
        free(growing.line);
        free(path);
    }
    return status;
}
