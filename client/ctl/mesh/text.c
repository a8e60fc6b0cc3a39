/* client/ctl/mesh/text.c - lines and words of a file.
 *
 * The program never calls setlocale, so numbers are read as in the C locale.
 */
#include "text.h"

#include <errno.h>
#include <float.h>
#include <inttypes.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

#include "confined.h"
#include "pccd_types.h"

/* The window of a larger file. Of a small one only as much is touched as it has. */
#define WINDOW_BYTES ((size_t)1 << 20)
/* Read at a time, so that a hole in a text is found soon. */
#define READ_BYTES_MAX ((size_t)1 << 22)
/* Bytes of a line that are looked at at a time. */
#define PIECE_BYTES ((size_t)512)
/* Longest piece of a word that a message quotes. */
#define QUOTE_CHARS_MAX 40

int ctl_file_fail(struct ctl_file *file, int status, const char *format, ...)
{
    char where[96], what[256];
    va_list arguments;
    if (file->status != PCCD_OK) {
        return file->status;
    }
    va_start(arguments, format);
    vsnprintf(what, sizeof what, format, arguments);
    va_end(arguments);
    uint64_t byte = file->offset + (uint64_t)(file->at - file->data);
    int length =
        snprintf(where, sizeof where, file->line > 0 ? "%" PRIu64 : " byte %" PRIu64,
                 file->line > 0 ? file->line : byte);
    if (file->item != NULL) {
        snprintf(where + length, sizeof where - (size_t)length, ": %s %" PRIu64,
                 file->item, file->item_number);
    }
    file->status =
        ctl_error_set(file->error, status, "%s:%s: %s", file->path, where, what);
    return status;
}

/* ---- reading ----------------------------------------------------------------------- */

static void grow(struct ctl_file *file, size_t capacity)
{
    char *grown = capacity > file->capacity ? realloc(file->data, capacity) : NULL;
    if (grown == NULL) {
        file->status = ctl_error_set(file->error, PCCD_E_NOMEM,
                                     "%s: no memory for %zu bytes", file->path, capacity);
        return;
    }
    file->data = grown;
    file->capacity = capacity;
}

/* A text has no byte 0 from `first` on, as a sparse file has. */
static void look_for_hole(struct ctl_file *file, size_t first)
{
    const char *hole =
        file->is_text ? memchr(file->data + first, 0, file->bytes - first) : NULL;
    if (hole != NULL && file->status == PCCD_OK) {
        file->status = ctl_error_set(
            file->error, PCCD_E_FORMAT, "%s: byte %" PRIu64 " is zero, which no text has",
            file->path, file->offset + (uint64_t)(hole - file->data));
    }
}

/* Read on until `bytes` are in memory, or all. */
static void read_up_to(struct ctl_file *file, size_t bytes)
{
    while (file->status == PCCD_OK && file->bytes < bytes && file->has_more) {
        if (file->bytes + 1 >= file->capacity) {
            grow(file, file->capacity * 2);
            continue;
        }
        size_t room = file->capacity - file->bytes - 1;
        size_t wanted = bytes - file->bytes < room ? bytes - file->bytes : room;
        ssize_t got = read(file->fd, file->data + file->bytes,
                           wanted < READ_BYTES_MAX ? wanted : READ_BYTES_MAX);
        if (got >= 0) {
            file->has_more = got > 0;
            file->bytes += (size_t)got;
            look_for_hole(file, file->bytes - (size_t)got);
            progress_update(&file->progress, (file->offset + file->bytes) >> 20);
        } else if (errno != EINTR) {
            file->status =
                ctl_error_set(file->error, PCCD_E_SYSTEM, "%s: cannot read: %s",
                              file->path, strerror(errno));
        }
    }
    uint64_t read = file->offset + file->bytes;
    file->has_more = file->has_more && file->status == PCCD_OK;
    file->rest_bytes = file->has_more && file->size > read ? file->size - read : 0;
    if (file->status != PCCD_OK) {
        file->bytes = 0;
    }
    if (file->data != NULL) {
        file->data[file->bytes] = '\0';
    }
}

int ctl_file_open(const char *path, struct ctl_file *file, struct ctl_error *error)
{
    struct stat info;
    *file = (struct ctl_file){.path = path, .error = error, .fd = tool_open(path)};
    file->is_open = file->has_more = file->fd >= 0;
    if (!file->is_open || fstat(file->fd, &info) != 0) {
        file->status = ctl_error_set(error, PCCD_E_SYSTEM, "%s: cannot %s: %s", path,
                                     file->is_open ? "stat" : "open", tool_why(errno));
    } else if (S_ISCHR(info.st_mode) || S_ISBLK(info.st_mode)) {
        file->status = ctl_error_set(error, PCCD_E_FORMAT,
                                     "%s: a device, neither file nor pipe", path);
    } else {
        file->size = S_ISREG(info.st_mode) ? (uint64_t)info.st_size : 0;
        grow(file, WINDOW_BYTES);
        read_up_to(file, WINDOW_BYTES - 1);
        ctl_file_begin(file);
    }
    int status = file->status;
    if (status != PCCD_OK) {
        ctl_file_deinit(file);
    }
    return status;
}

int ctl_file_load(struct ctl_file *file, struct ctl_error *error)
{
    file->error = error;
    if (file->has_more && file->size + 2 > file->capacity) {
        grow(file, (size_t)file->size + 2);
    }
    read_up_to(file, SIZE_MAX);
    ctl_file_begin(file);
    return file->status;
}

bool ctl_file_is_loaded(const struct ctl_file *file)
{
    return file->offset == 0 && file->rest_bytes == 0;
}

int ctl_file_read_at(struct ctl_file *file, uint64_t first, size_t bytes, char *to)
{
    size_t done = 0;
    if (first + bytes <= file->bytes && file->offset == 0) {
        memcpy(to, file->data + first, bytes);
        done = bytes;
    }
    while (done < bytes && file->status == PCCD_OK) {
        ssize_t got = pread(file->fd, to + done, bytes - done, (off_t)(first + done));
        if (got > 0) {
            done += (size_t)got;
        } else if (got == 0) {
            file->status = ctl_error_set(file->error, PCCD_E_FORMAT,
                                         "%s: it changed while it was read", file->path);
        } else if (errno != EINTR) {
            file->status =
                ctl_error_set(file->error, PCCD_E_SYSTEM, "%s: cannot read: %s",
                              file->path, strerror(errno));
        }
    }
    return file->status;
}

void ctl_file_deinit(struct ctl_file *file)
{
    if (file->is_open) {
        (void)close(file->fd);
    }
    free(file->data);
    progress_clear(&file->progress);
    *file = (struct ctl_file){.path = file->path};
}

/* ---- the window -------------------------------------------------------------------- */

uint64_t ctl_file_left(const struct ctl_file *file)
{
    return (uint64_t)(file->data + file->bytes - file->at) + file->rest_bytes;
}

uint64_t ctl_file_size(const struct ctl_file *file)
{
    return file->offset + file->bytes + file->rest_bytes;
}

const char *ctl_file_start(const struct ctl_file *file)
{
    bool has_mark = file->offset == 0 && file->bytes >= 3 &&
                    memcmp(file->data, "\xef\xbb\xbf", 3) == 0;
    return has_mark ? file->data + 3 : file->data; /* NULL: nothing was read */
}

void ctl_file_begin(struct ctl_file *file)
{
    if (file->offset > 0 && file->status == PCCD_OK) {
        file->bytes = 0;
        file->offset = 0;
        file->has_more = lseek(file->fd, 0, SEEK_SET) == 0;
        read_up_to(file, file->capacity - 1);
    }
    file->at = ctl_file_start(file);
    file->keep = file->item = NULL;
    file->line = file->line_last = 0;
}

void ctl_file_expect_text(struct ctl_file *file)
{
    file->is_text = true;
    look_for_hole(file, 0);
}

bool ctl_file_more(struct ctl_file *file, size_t bytes)
{
    const char *from = file->keep != NULL ? file->keep : file->at;
    size_t there = (size_t)(file->data + file->bytes - file->at);
    if (file->status != PCCD_OK || there >= bytes || !file->has_more) {
        return file->status == PCCD_OK && there >= bytes;
    }
    size_t before = (size_t)(file->at - from), capacity = file->capacity;
    file->offset += (size_t)(from - file->data);
    file->bytes -= (size_t)(from - file->data);
    memmove(file->data, from, file->bytes);
    /* A line that is longer than half of it: twice as much, so that few moves do. */
    while (capacity / 2 < before + bytes && capacity < SIZE_MAX / 2) {
        capacity *= 2;
    }
    if (capacity > file->capacity) {
        grow(file, capacity);
    }
    read_up_to(file, file->capacity - 1);
    file->at = file->data + (before < file->bytes ? before : file->bytes);
    file->keep = file->keep != NULL ? file->data : NULL;
    return (size_t)(file->data + file->bytes - file->at) >= bytes;
}

/* ---- lines and words --------------------------------------------------------------- */

/* The first line end of a piece of text; NULL: there is none. */
static const char *find_end(const char *at, size_t bytes)
{
    const char *feed = memchr(at, '\n', bytes);
    const char *carriage = memchr(at, '\r', feed != NULL ? (size_t)(feed - at) : bytes);
    return carriage != NULL ? carriage : feed;
}

bool ctl_file_line(struct ctl_file *file, struct ctl_word *line)
{
    const char *stop = NULL;
    size_t length = 0; /* without a line end */
    /* In pieces, so that one kind of line end is not sought beyond the other. */
    while (stop == NULL && ctl_file_more(file, length + 1)) {
        size_t left = (size_t)(file->data + file->bytes - file->at) - length;
        size_t piece = left < PIECE_BYTES ? left : PIECE_BYTES;
        stop = find_end(file->at + length, piece);
        length = stop != NULL ? (size_t)(stop - file->at) : length + piece;
    }
    if (stop == NULL && length == 0) {
        return false;
    }
    bool is_pair = stop != NULL && *stop == '\r' && ctl_file_more(file, length + 2) &&
                   file->at[length + 1] == '\n';
    *line = (struct ctl_word){file->at, file->at + length};
    file->at += length + (stop != NULL) + is_pair;
    file->line_last++;
    file->line = file->keep == NULL ? file->line_last : file->line;
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

bool ctl_word_is_any_case(const struct ctl_word *word, const char *text)
{
    size_t length = strlen(text);
    return (size_t)(word->end - word->at) == length &&
           strncasecmp(word->at, text, length) == 0;
}

int ctl_word_length(const struct ctl_word *word)
{
    ptrdiff_t length = word->end - word->at;
    return length < QUOTE_CHARS_MAX ? (int)length : QUOTE_CHARS_MAX;
}

/* Most numbers of files have few digits and a small exponent: then one division or
 * multiplication of exact doubles rounds once, as strtod does. False: not so. */
static bool read_quickly(const struct ctl_word *word, double *value)
{
    static const double tens[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                  1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                  1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
    const char *at = word->at, *point = NULL;
    bool is_negative = at < word->end && *at == '-';
    uint64_t digits = 0;
    at += is_negative;
    const char *first = at;
    for (; at < word->end && at - first < 17; at++) {
        unsigned digit = (unsigned)(*at - '0');
        if (digit <= 9) {
            digits = digits * 10 + digit;
        } else if (*at == '.' && point == NULL) {
            point = at;
        } else {
            break;
        }
    }
    ptrdiff_t after = point != NULL ? at - point - 1 : 0;
    bool has_digits = at - first > (point != NULL);
    if (at != word->end || !has_digits || digits > (uint64_t)1 << 53) {
        return false;
    }
    *value = (double)digits / tens[after];
    *value = is_negative ? -*value : *value;
    return true;
}

/* A double that is no middle of two floats is on the same side of it as the number. */
static bool rounds_to_float(double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    return (bits & 0x1fffffff) != 0x10000000 &&
           (value == 0 ||
            (fabs(value) >= (double)FLT_MIN && fabs(value) < (double)FLT_MAX));
}

/* Return whether all of a word was read. Numbers of files are decimal: what C reads as a
 * hexadecimal one has an x, and is none. */
static bool is_number(const struct ctl_word *word, const char *stop)
{
    size_t length = (size_t)(word->end - word->at);
    return stop == NULL || (stop == word->end && memchr(word->at, 'x', length) == NULL &&
                            memchr(word->at, 'X', length) == NULL);
}

bool ctl_word_float(const struct ctl_word *word, double *value)
{
    char *stop = NULL;
    if (!read_quickly(word, value) || !rounds_to_float(*value)) {
        *value = (double)strtof(word->at, &stop);
    }
    *value = (double)(float)*value;
    return is_number(word, stop);
}

bool ctl_word_double(const struct ctl_word *word, double *value)
{
    char *stop = NULL;
    if (!read_quickly(word, value)) {
        *value = strtod(word->at, &stop);
    }
    return is_number(word, stop);
}

bool ctl_word_integer(const struct ctl_word *word, int64_t *value)
{
    char *stop;
    errno = 0;
    *value = strtoll(word->at, &stop, 10);
    return stop == word->end && errno != ERANGE;
}
