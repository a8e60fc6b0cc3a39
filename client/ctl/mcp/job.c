/* job.c - a command in a child, its output, and its end. */
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "ctl.h"
#include "mcp.h"
#include "output.h"
#include "pccd_types.h"
#include "terminal.h"

#define OUT_BYTES_MAX ((size_t)64 << 20) /* of the standard output */
#define ERR_BYTES_MAX READ_BYTES
#define RECORD_BYTES  ((size_t)8 << 10) /* of a line of CSV; a longer one is left out */
#define COLUMNS_MAX   32u
#define READ_BYTES    65536u
#define PROGRESS_S    5 /* between two words about how long it takes */

/* ---- words ------------------------------------------------------------------------- */

void mcp_job_add(struct mcp_job *job, const char *format, ...)
{
    char *word = NULL;
    va_list arguments;
    va_start(arguments, format);
    int length = vasprintf(&word, format, arguments);
    va_end(arguments);
    if (length < 0 || job->word_count == (int)MCP_WORDS_MAX) {
        free(length < 0 ? NULL : word);
        job->is_full = true;
        return;
    }
    job->words[job->word_count++] = word;
}

void mcp_job_deinit(struct mcp_job *job)
{
    for (int i = 0; i < job->word_count; i++) {
        free(job->words[i]);
    }
    free(job->out);
    free(job->err);
    json_decref(job->rows);
    *job = (struct mcp_job){.word_count = 0};
}

/* ---- CSV --------------------------------------------------------------------------- */

/* Lines of CSV while they come. */
struct records {
    char text[RECORD_BYTES];
    size_t bytes;
    bool is_quoted, is_long;
    char *names[COLUMNS_MAX]; /* of the first line; ours */
    size_t column_count;
};

/* Cut a line at its commas, in place; returns how many values it has. */
static size_t cut_values(char *line, char *values[COLUMNS_MAX])
{
    size_t count = 0;
    char *to = line;
    bool is_quoted = false;
    values[count++] = line;
    for (const char *from = line; *from != '\0'; from++) {
        if (*from == '"' && is_quoted && from[1] == '"') {
            *to++ = *from++;
        } else if (*from == '"') {
            is_quoted = !is_quoted;
        } else if (*from == ',' && !is_quoted && count < COLUMNS_MAX) {
            *to++ = '\0';
            values[count++] = to;
        } else {
            *to++ = *from;
        }
    }
    *to = '\0';
    return count;
}

/* A number if all of it is one, else a text. */
static json_t *value_of(const char *name, const char *text)
{
    char *stop = NULL;
    if (strncmp(name, "object_", 7) == 0) {
        return json_text(text);
    }
    errno = 0;
    long long whole = strtoll(text, &stop, 10);
    if (*stop == '\0' && errno == 0) {
        return json_integer(whole);
    }
    double real = strtod(text, &stop);
    return *stop == '\0' ? json_real(real) : json_text(text);
}

static bool end_line(struct records *records, struct mcp_job *job)
{
    char *values[COLUMNS_MAX];
    bool ok = true;
    records->text[records->bytes] = '\0';
    size_t count = cut_values(records->text, values);
    if (records->column_count == 0) {
        for (size_t i = 0; i < count && ok; i++) {
            records->names[i] = strdup(values[i]);
            ok = records->names[i] != NULL;
        }
        records->column_count = ok ? count : 0;
        return ok;
    }
    job->row_count++;
    if (json_array_size(job->rows) < MCP_ROWS_MAX && !records->is_long) {
        json_t *row = json_object();
        for (size_t i = 0; i < count && i < records->column_count; i++) {
            if (values[i][0] != '\0') {
                json_set(row, records->names[i], value_of(records->names[i], values[i]),
                         &ok);
            }
        }
        json_append(job->rows, row, &ok);
    }
    return ok;
}

static bool take_records(struct records *records, struct mcp_job *job, const char *bytes,
                         size_t count)
{
    bool ok = true;
    for (size_t i = 0; i < count && ok; i++) {
        records->is_quoted ^= bytes[i] == '"';
        if (bytes[i] == '\n' && !records->is_quoted) {
            ok = end_line(records, job);
            records->bytes = 0;
            records->is_long = false;
        } else if (records->bytes + 1 < RECORD_BYTES) {
            records->text[records->bytes++] = bytes[i];
        } else {
            records->is_long = true;
        }
    }
    return ok;
}

/* ---- the child --------------------------------------------------------------------- */

enum { OUT, ERR, RECORDS, PIPES };

struct child {
    pid_t pid;
    int pipes[PIPES]; /* -1: closed */
    struct records *records;
};

/* In the child. What it opens is closed at its end; what it prints goes through pipes. */
static _Noreturn void be_child(struct mcp_job *job, int ends[PIPES][2], pid_t parent)
{
    int nothing = open("/dev/null", O_RDONLY);
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent || nothing < 0 || dup2(nothing, STDIN_FILENO) < 0 ||
        dup2(ends[OUT][1], STDOUT_FILENO) < 0 || dup2(ends[ERR][1], STDERR_FILENO) < 0) {
        _exit(CTL_FAILED);
    }
    if (job->has_records && dup3(ends[RECORDS][1], MCP_RECORDS_FD, O_CLOEXEC) < 0) {
        _exit(CTL_FAILED);
    }
    signal(SIGPIPE, SIG_DFL);
    terminal_forbid_colours();
    job->words[job->word_count] = NULL;
    int status = job->run(job->word_count, job->words);
    (void)fflush(NULL);
    _exit(status);
}

static int start(struct mcp_job *job, struct child *child, struct ctl_error *error)
{
    int ends[PIPES][2] = {{-1, -1}, {-1, -1}, {-1, -1}};
    pid_t parent = getpid();
    bool is_open = !job->is_full;
    for (int i = 0; i < PIPES && is_open; i++) {
        is_open = pipe2(ends[i], O_CLOEXEC) == 0;
    }
    child->pid = is_open ? fork() : -1;
    if (child->pid == 0) {
        be_child(job, ends, parent);
    }
    int why = errno;
    for (int i = 0; i < PIPES; i++) {
        (void)close(ends[i][1]);
        child->pipes[i] = ends[i][0];
    }
    if (child->pid < 0) {
        for (int i = 0; i < PIPES; i++) {
            (void)close(ends[i][0]);
        }
        return ctl_error_set(error, PCCD_E_SYSTEM, "cannot begin: %s",
                             job->is_full ? "there are too many words" : strerror(why));
    }
    return PCCD_OK;
}

/* Append to a text that ends with a NUL; what is more than `max` is dropped. */
static bool append(char **text, size_t *used, const char *bytes, size_t count, size_t max)
{
    count = *used + count > max ? max - *used : count;
    char *grown = realloc(*text, *used + count + 1);
    if (grown == NULL) {
        return false;
    }
    memcpy(grown + *used, bytes, count);
    *used += count;
    grown[*used] = '\0';
    *text = grown;
    return true;
}

/* Take what is there of a pipe. False: there is no memory. */
static bool take_some(struct mcp_job *job, struct child *child, int pipe_idx)
{
    static char bytes[READ_BYTES];
    ssize_t got = read(child->pipes[pipe_idx], bytes, sizeof bytes);
    if (got <= 0) {
        if (got == 0 || errno != EINTR) {
            (void)close(child->pipes[pipe_idx]);
            child->pipes[pipe_idx] = -1;
        }
        return true;
    }
    size_t count = (size_t)got;
    if (pipe_idx == ERR && job->err_bytes + count > ERR_BYTES_MAX) {
        job->err_bytes = 0; /* what is wrong stands at the end */
    }
    return pipe_idx == OUT
               ? append(&job->out, &job->out_bytes, bytes, count, OUT_BYTES_MAX + 1)
           : pipe_idx == ERR
               ? append(&job->err, &job->err_bytes, bytes, count, ERR_BYTES_MAX)
               : take_records(child->records, job, bytes, count);
}

/* Read until the child has closed its pipes, or must end. */
static int attend(struct mcp_job *job, struct child *child, struct mcp *mcp,
                  struct ctl_error *error)
{
    double begin_s = terminal_now_s(), told_s = 0;
    bool is_open = true, ok = true;
    mcp_listen(mcp, false);
    while (is_open && ok) {
        struct pollfd fds[PIPES + 1];
        for (int i = 0; i < PIPES; i++) {
            fds[i] = (struct pollfd){.fd = child->pipes[i], .events = POLLIN};
        }
        fds[PIPES] = (struct pollfd){.fd = mcp->reader.is_at_end ? -1 : STDIN_FILENO,
                                     .events = POLLIN};
        double passed_s = terminal_now_s() - begin_s;
        if (passed_s >= mcp->seconds) {
            return ctl_error_set(error, PCCD_E_TIMEOUT,
                                 "it took more than %u seconds, and was ended; ask for "
                                 "less, such as fewer frames",
                                 mcp->seconds);
        }
        if (passed_s >= told_s + PROGRESS_S) {
            told_s = passed_s;
            mcp_tell_progress(mcp, (uint32_t)passed_s);
        }
        (void)poll(fds, PIPES + 1, 500);
        for (int i = 0; i < PIPES && ok; i++) {
            ok = fds[i].revents == 0 || take_some(job, child, i);
        }
        if (job->out_bytes > OUT_BYTES_MAX) {
            return ctl_error_set(error, PCCD_E_LIMIT,
                                 "it has written more than %zu MiB, and was ended; ask "
                                 "for less, such as fewer frames",
                                 OUT_BYTES_MAX >> 20);
        }
        if (fds[PIPES].revents != 0) {
            mcp_listen(mcp, true);
        }
        if (mcp->is_cancelled || mcp->is_gone) {
            return ctl_error_set(error, PCCD_E_CANCELLED, "cancelled");
        }
        is_open = child->pipes[OUT] >= 0 || child->pipes[ERR] >= 0 ||
                  child->pipes[RECORDS] >= 0;
    }
    return ok ? PCCD_OK : ctl_error_set(error, PCCD_E_NOMEM, "no memory for the answer");
}

int mcp_job_run(struct mcp_job *job, struct mcp *mcp, struct ctl_error *error)
{
    struct child child = {.records = calloc(1, sizeof *child.records)};
    int state = 0;
    job->rows = json_array();
    if (child.records == NULL || job->rows == NULL ||
        !append(&job->out, &job->out_bytes, "", 0, 0) ||
        !append(&job->err, &job->err_bytes, "", 0, 0)) {
        free(child.records);
        return ctl_error_set(error, PCCD_E_NOMEM, "no memory for the answer");
    }
    int status = start(job, &child, error);
    if (status == PCCD_OK) {
        status = attend(job, &child, mcp, error);
        if (status != PCCD_OK) {
            (void)kill(child.pid, SIGKILL);
        }
        for (int i = 0; i < PIPES; i++) {
            if (child.pipes[i] >= 0) {
                (void)close(child.pipes[i]);
            }
        }
        while (waitpid(child.pid, &state, 0) < 0 && errno == EINTR) {
            ;
        }
        job->status = WIFSIGNALED(state) ? 128 + WTERMSIG(state) : WEXITSTATUS(state);
    }
    for (size_t i = 0; i < child.records->column_count; i++) {
        free(child.records->names[i]);
    }
    free(child.records);
    return status;
}

const char *mcp_job_complaint(struct mcp_job *job)
{
    static const char before[] = "pccdctl: ";
    char *found = NULL, *rest = job->err;
    for (char *line; (line = strsep(&rest, "\n")) != NULL;) {
        if (line[0] != '\0' && strncmp(line, "Try ", 4) != 0) {
            found = line; /* warnings come before */
        }
    }
    bool has_name = found != NULL && strncmp(found, before, sizeof before - 1) == 0;
    return has_name ? found + sizeof before - 1 : found;
}
