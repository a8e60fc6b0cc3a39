/* client/ctl/mesh/text.c - lines and words of a file that lies in memory.
 *
 * Room:     client/ctl.
 * Does:     reads a whole file, splits it into lines and words, turns words into numbers.
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
/* Longest piece of a word that a message quotes. */
#define QUOTE_CHARS_MAX 40

/* Read fd to its end into file->data, which has `capacity` bytes and grows by doubling.
 */
static int read_all(int fd, size_t capacity, struct ctl_file *file,
                    struct ctl_error *error)
{
    for (;;) {
        if (file->bytes + 1 >= capacity) {
            size_t wanted = capacity * 2;
            char *grown = wanted > capacity ? realloc(file->data, wanted) : NULL;
            if (grown == NULL) {
                return ctl_error_set(error, PCCD_E_NOMEM, "%s: no memory for %zu bytes",
                                     file->path, wanted);
            }
            file->data = grown;
            capacity = wanted;
        }
        ssize_t got = read(fd, file->data + file->bytes, capacity - file->bytes - 1);
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
    }
    file->data[file->bytes] = '\0';
    return PCCD_OK;
}

int ctl_file_read(const char *path, struct ctl_file *file, struct ctl_error *error)
{
    struct ctl_file loaded = {.path = path, .data = NULL, .bytes = 0};
    struct stat info;
    int status;
    int fd = open(path, O_RDONLY | O_CLOEXEC);
    if (fd < 0) {
        return ctl_error_set(error, PCCD_E_SYSTEM, "%s: cannot open: %s", path,
                             strerror(errno));
    }
    if (fstat(fd, &info) != 0) {
        status = ctl_error_set(error, PCCD_E_SYSTEM, "%s: cannot stat: %s", path,
                               strerror(errno));
        goto done;
    }
    /* Two more bytes: one for the NUL, one so that the end is seen without growing. */
    size_t capacity = S_ISREG(info.st_mode) ? (size_t)info.st_size + 2 : 0;
    if (capacity < READ_BYTES_MIN) {
        capacity = READ_BYTES_MIN;
    }
    loaded.data = malloc(capacity);
    if (loaded.data == NULL) {
        status = ctl_error_set(error, PCCD_E_NOMEM, "%s: no memory for %zu bytes", path,
                               capacity);
        goto done;
    }
    status = read_all(fd, capacity, &loaded, error);
done:
    close(fd);
    if (status != PCCD_OK) {
        free(loaded.data);
    } else {
        *file = loaded;
    }
    return status;
}

void ctl_file_deinit(struct ctl_file *file)
{
    free(file->data);
    file->data = NULL;
    file->bytes = 0;
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
