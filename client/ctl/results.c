/* results.c - lines on a disk. */
#include "results.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "pccd_types.h"

#define LINE_FLAGS (JSON_COMPACT | JSON_ENSURE_ASCII)
#define BYTES_MAX  ((off_t)1 << 32) /* of a file that is read */

static int failed(const struct results *results, const char *what,
                  struct ctl_error *error)
{
    return ctl_error_set(error, PCCD_E_SYSTEM, "%s: %s: %s", results->path, what,
                         strerror(errno));
}

char *results_text(const json_t *line, size_t *bytes)
{
    char *text = json_dumps(line, LINE_FLAGS);
    char *longer = NULL;
    if (text != NULL) {
        *bytes = strlen(text);
        longer = realloc(text, *bytes + 2);
        if (longer == NULL) {
            free(text);
            return NULL;
        }
        longer[(*bytes)++] = '\n';
        longer[*bytes] = '\0';
    }
    return longer;
}

static int write_all(int fd, const char *text, size_t bytes)
{
    while (bytes > 0) {
        ssize_t done = write(fd, text, bytes);
        if (done < 0 && errno == EINTR) {
            continue;
        }
        if (done < 0) {
            return -1;
        }
        text += done;
        bytes -= (size_t)done;
    }
    return 0;
}

int results_append(struct results *results, const json_t *line, struct ctl_error *error)
{
    size_t bytes = 0;
    if (results->fd < 0) {
        return PCCD_OK;
    }
    char *text = results_text(line, &bytes);
    if (text == NULL) {
        return ctl_error_set(error, PCCD_E_NOMEM, "no memory for a result");
    }
    bool is_written =
        write_all(results->fd, text, bytes) == 0 && fdatasync(results->fd) == 0;
    free(text);
    if (!is_written) {
        int status = failed(results, "cannot be written", error);
        (void)(ftruncate(results->fd, (off_t)results->bytes) +
               lseek(results->fd, (off_t)results->bytes, SEEK_SET));
        return status;
    }
    results->bytes += bytes;
    return PCCD_OK;
}

/* ---- what is there ----------------------------------------------------------------- */

/* All of the file, and a NUL; NULL: an error. */
static char *read_all(const struct results *results, size_t *bytes,
                      struct ctl_error *error)
{
    struct stat info;
    if (fstat(results->fd, &info) != 0 || !S_ISREG(info.st_mode)) {
        (void)ctl_error_set(error, PCCD_E_FORMAT, "%s: not a file", results->path);
        return NULL;
    }
    char *text = info.st_size < BYTES_MAX ? malloc((size_t)info.st_size + 1) : NULL;
    if (text == NULL) {
        (void)ctl_error_set(error, PCCD_E_NOMEM, "%s: no memory for %lld bytes",
                            results->path, (long long)info.st_size);
        return NULL;
    }
    *bytes = 0;
    for (ssize_t got = 1; got > 0 && *bytes < (size_t)info.st_size;) {
        got = pread(results->fd, text + *bytes, (size_t)info.st_size - *bytes,
                    (off_t)*bytes);
        if (got < 0) {
            (void)failed(results, "cannot be read", error);
            free(text);
            return NULL;
        }
        *bytes += (size_t)got;
    }
    text[*bytes] = '\0';
    return text;
}

static int tell_line(const struct results *results, const char *text, size_t bytes,
                     uint64_t number, struct ctl_error *error)
{
    struct ctl_error why = {.text = "it is not JSON"};
    json_t *line = json_loadb(text, bytes, 0, NULL);
    int status =
        line != NULL ? results->each(results->context, line, &why) : PCCD_E_FORMAT;
    json_decref(line);
    return status == PCCD_OK
               ? PCCD_OK
               : ctl_error_set(error, status, "%s: line %" PRIu64 ": %.900s",
                               results->path, number, why.text);
}

/* A file with something in it: its head must be the same, byte by byte. */
static int read_lines(struct results *results, const char *text, size_t bytes,
                      const char *head, size_t head_bytes, struct ctl_error *error)
{
    const char *end = memchr(text, '\n', bytes);
    size_t common = bytes < head_bytes ? bytes : head_bytes;
    if (memcmp(text, head, common) != 0 || (end == NULL && bytes >= head_bytes)) {
        size_t kind = (size_t)(strchr(head, ':') + 1 - head); /* {"pccd-mpi": */
        bool is_ours = bytes > kind && memcmp(text, head, kind) == 0;
        return ctl_error_set(error, PCCD_E_FORMAT, "%s: %s", results->path,
                             is_ours ? "it has results of other files, other "
                                       "recordings, options or another version"
                                     : "it is there, and is no file of results");
    }
    if (end == NULL) {
        return PCCD_OK; /* a part of the head */
    }
    results->bytes = head_bytes;
    uint64_t number = 2;
    int status = PCCD_OK;
    for (const char *line = text + head_bytes;
         status == PCCD_OK && (end = memchr(line, '\n', bytes - (size_t)(line - text)));
         line = end + 1) {
        status = tell_line(results, line, (size_t)(end - line), number++, error);
        results->bytes = (uint64_t)(end + 1 - text);
    }
    return status;
}

/* Read it, cut off what is not whole, and begin it if nothing is left. */
static int take_over(struct results *results, const char *head, size_t head_bytes,
                     struct ctl_error *error)
{
    size_t bytes = 0;
    if (flock(results->fd, LOCK_EX | LOCK_NB) != 0) {
        return errno == EWOULDBLOCK
                   ? ctl_error_set(error, PCCD_E_STATE, "%s: another run writes it",
                                   results->path)
                   : failed(results, "cannot be locked", error);
    }
    char *text = read_all(results, &bytes, error);
    if (text == NULL) {
        return PCCD_E_SYSTEM;
    }
    int status =
        bytes > 0 ? read_lines(results, text, bytes, head, head_bytes, error) : PCCD_OK;
    free(text);
    if (status != PCCD_OK) {
        return status;
    }
    if (ftruncate(results->fd, (off_t)results->bytes) != 0 ||
        lseek(results->fd, (off_t)results->bytes, SEEK_SET) < 0) {
        return failed(results, "cannot be cut", error);
    }
    if (results->bytes == 0) {
        if (write_all(results->fd, head, head_bytes) != 0 || fsync(results->fd) != 0) {
            return failed(results, "cannot be written", error);
        }
        results->bytes = head_bytes;
    }
    return PCCD_OK;
}

int results_open(struct results *results, const char *path, const json_t *head,
                 results_line_fn each, void *context, struct ctl_error *error)
{
    size_t bytes = 0;
    *results = (struct results){.path = path, .fd = -1, .each = each, .context = context};
    char *text = results_text(head, &bytes);
    if (text == NULL) {
        return ctl_error_set(error, PCCD_E_NOMEM, "no memory for a result");
    }
    results->fd = open(path, O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    int status = results->fd < 0 ? failed(results, "cannot be opened", error)
                                 : take_over(results, text, bytes, error);
    free(text);
    if (status != PCCD_OK) {
        results_close(results);
    }
    return status;
}

void results_close(struct results *results)
{
    if (results->fd >= 0) {
        (void)close(results->fd);
        results->fd = -1;
    }
}
