/* client/ctl/mesh/text.c - lines and words of a file that lies in memory.
 *
 * Room:     client/ctl.
 * Does:     reads a whole file if its beginning is that of one, splits it into lines and
 *           words, turns words into numbers.
 * Does not: know any file format.
 * Threads:  [any]; nothing is shared.
 * Source:   text.h. The program never calls setlocale, so numbers are read as in the C
 * locale.
 */
#include "text.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "pccd_types.h"

/* First allocation for something whose size is not known, such as a pipe. */
#define READ_BYTES_MIN ((size_t)1 << 16)
/* Of a larger file so much is judged before the rest is read. */
#define HEAD_BYTES ((size_t)1 << 20)
/* Read at a time, so that a hole in a text is found soon. */
#define READ_BYTES_MAX ((size_t)1 << 22)
/* Longest piece of a word that a message quotes. */
#define QUOTE_CHARS_MAX 40

/* A file that is being read. */
struct loading {
    int fd;
    size_t capacity; /* of file.data */
    bool is_text;
    struct ctl_file file;
};

static int no_memory(const struct loading *loading, size_t bytes, struct ctl_error *error)
{
    return ctl_error_set(error, PCCD_E_NOMEM, "%s: no memory for %zu bytes",
                         loading->file.path, bytes);
}

static int grow(struct loading *loading, size_t capacity, struct ctl_error *error)
{
    char *grown =
        capacity > loading->capacity ? realloc(loading->file.data, capacity) : NULL;
    if (grown == NULL) {
        return no_memory(loading, capacity, error);
    }
    loading->file.data = grown;
    loading->capacity = capacity;
    return PCCD_OK;
}

/* Whether a text has a byte 0 from `first` on, as a sparse file has. */
static int look_for_hole(const struct ctl_file *file, size_t first,
                         struct ctl_error *error)
{
    const char *hole = memchr(file->data + first, 0, file->bytes - first);
    return hole == NULL ? PCCD_OK
                        : ctl_error_set(error, PCCD_E_FORMAT,
                                        "%s: byte %zu is zero, which no text has",
                                        file->path, (size_t)(hole - file->data));
}

/* Read on until `bytes` are there, or all. */
static int read_up_to(struct loading *loading, size_t bytes, struct ctl_error *error)
{
    struct ctl_file *file = &loading->file;
    while (file->bytes < bytes) {
        if (file->bytes + 1 >= loading->capacity &&
            grow(loading, loading->capacity * 2, error) != PCCD_OK) {
            return PCCD_E_NOMEM;
        }
        size_t room = loading->capacity - file->bytes - 1;
        size_t wanted = bytes - file->bytes < room ? bytes - file->bytes : room;
        char *to = file->data + file->bytes;
        ssize_t got =
            read(loading->fd, to, wanted < READ_BYTES_MAX ? wanted : READ_BYTES_MAX);
        if (got < 0 && errno == EINTR) {
            continue;
        }
        if (got < 0) {
            return ctl_error_set(error, PCCD_E_SYSTEM, "%s: cannot read: %s", file->path,
                                 strerror(errno));
        }
        if (got == 0) {
            break;
        }
        file->bytes += (size_t)got;
        if (loading->is_text && look_for_hole(file, file->bytes - (size_t)got, error)) {
            return PCCD_E_FORMAT;
        }
    }
    file->data[file->bytes] = '\0';
    return PCCD_OK;
}

/* The first bytes of a large file, then, if they may be the beginning of one, all. */
static int read_all(struct loading *loading, uint64_t size, ctl_file_judge judge,
                    struct ctl_error *error)
{
    struct ctl_file *file = &loading->file;
    int status = PCCD_OK;
    if (size > HEAD_BYTES) {
        status = read_up_to(loading, HEAD_BYTES, error);
        file->rest_bytes = size > file->bytes ? size - file->bytes : 0;
        if (status == PCCD_OK) {
            status = judge(file, &loading->is_text, error);
        }
        if (status == PCCD_OK && loading->is_text) {
            status = look_for_hole(file, 0, error);
        }
        file->rest_bytes = 0;
    }
    /* Two more bytes: one for the NUL, one so that the end is seen without growing. */
    if (status == PCCD_OK && size >= SIZE_MAX - 2) {
        status = no_memory(loading, SIZE_MAX, error);
    } else if (status == PCCD_OK && size + 2 > loading->capacity) {
        status = grow(loading, (size_t)size + 2, error);
    }
    return status == PCCD_OK ? read_up_to(loading, SIZE_MAX, error) : status;
}

int ctl_file_read(const char *path, ctl_file_judge judge, struct ctl_file *file,
                  struct ctl_error *error)
{
    struct loading loading = {.fd = open(path, O_RDONLY | O_CLOEXEC), .file.path = path};
    struct stat info;
    int status;
    if (loading.fd < 0) {
        return ctl_error_set(error, PCCD_E_SYSTEM, "%s: cannot open: %s", path,
                             strerror(errno));
    }
    if (fstat(loading.fd, &info) != 0) {
        status = ctl_error_set(error, PCCD_E_SYSTEM, "%s: cannot stat: %s", path,
                               strerror(errno));
        goto done;
    }
    uint64_t size = S_ISREG(info.st_mode) ? (uint64_t)info.st_size : 0;
    status = grow(&loading, size > HEAD_BYTES ? HEAD_BYTES + 2 : READ_BYTES_MIN, error);
    if (status == PCCD_OK) {
        status = read_all(&loading, size, judge, error);
    }
done:
    close(loading.fd);
    if (status != PCCD_OK) {
        free(loading.file.data);
    } else {
        *file = loading.file;
    }
    return status;
}

void ctl_file_deinit(struct ctl_file *file)
{
    free(file->data);
    file->data = NULL;
    file->bytes = 0;
}

uint32_t ctl_file_word(const char *at)
{
    const unsigned char *bytes = (const unsigned char *)at;
    return (uint32_t)bytes[0] | (uint32_t)bytes[1] << 8 | (uint32_t)bytes[2] << 16 |
           (uint32_t)bytes[3] << 24;
}

bool ctl_text_line(struct ctl_text *text, struct ctl_word *line)
{
    if (text->at == text->end) {
        return false;
    }
    const char *stop = memchr(text->at, '\n', (size_t)(text->end - text->at));
    line->at = text->at;
    line->end = stop != NULL ? stop : text->end;
    text->at = stop != NULL ? stop + 1 : text->end;
    if (line->end > line->at && line->end[-1] == '\r') {
        line->end--;
    }
    text->line++;
    return true;
}

static bool is_blank(char c)
{
    return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f';
}

bool ctl_word_next(struct ctl_word *line, struct ctl_word *word)
{
    const char *at = line->at;
    while (at < line->end && is_blank(*at)) {
        at++;
    }
    word->at = at;
    while (at < line->end && !is_blank(*at)) {
        at++;
    }
    word->end = at;
    line->at = at;
    return word->end > word->at;
}

bool ctl_word_is(const struct ctl_word *word, const char *text)
{
    size_t length = strlen(text);
    return (size_t)(word->end - word->at) == length &&
           memcmp(word->at, text, length) == 0;
}

int ctl_word_length(const struct ctl_word *word)
{
    ptrdiff_t length = word->end - word->at;
    return length < QUOTE_CHARS_MAX ? (int)length : QUOTE_CHARS_MAX;
}

bool ctl_word_float(const struct ctl_word *word, double *value)
{
    char *stop;
    float number = strtof(word->at, &stop);
    if (stop != word->end) {
        return false;
    }
    *value = (double)number;
    return true;
}

bool ctl_word_double(const struct ctl_word *word, double *value)
{
    char *stop;
    double number = strtod(word->at, &stop);
    if (stop != word->end) {
        return false;
    }
    *value = number;
    return true;
}

bool ctl_word_integer(const struct ctl_word *word, int64_t *value)
{
    char *stop;
    errno = 0;
    long long number = strtoll(word->at, &stop, 10);
    if (stop != word->end || errno == ERANGE) {
        return false;
    }
    *value = number;
    return true;
}
