/* client/ctl/mesh/text.c - lines and words of a file.
 *
 * Room:     client/ctl.
 * Does:     reads a file, if its beginning is that of one, as far as its reader has come;
 *           splits it into lines and words, turns words into numbers.
 * Does not: know any file format.
 * Threads:  [any]; nothing is shared.
 * Source:   text.h. The program never calls setlocale, so numbers are read as in the C
 * locale.
 */
#include "text.h"

#include <errno.h>
#include <fcntl.h>
#include <float.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

#include "pccd_types.h"

/* First allocation for something whose size is not known, such as a pipe. */
#define READ_BYTES_MIN ((size_t)1 << 16)
/* The window of a larger file, of which it is judged before the rest is read. */
#define WINDOW_BYTES ((size_t)1 << 20)
/* Read at a time, so that a hole in a text is found soon. */
#define READ_BYTES_MAX ((size_t)1 << 22)
/* Of a line, looked at at a time. */
#define PIECE_BYTES ((size_t)512)
/* Longest piece of a word that a message quotes. */
#define QUOTE_CHARS_MAX 40

static int no_memory(const struct ctl_file *file, size_t bytes, struct ctl_error *error)
{
    return ctl_error_set(error, PCCD_E_NOMEM, "%s: no memory for %zu bytes", file->path,
                         bytes);
}

static int grow(struct ctl_file *file, size_t capacity, struct ctl_error *error)
{
    char *grown = capacity > file->capacity ? realloc(file->data, capacity) : NULL;
    if (grown == NULL) {
        return no_memory(file, capacity, error);
    }
    file->data = grown;
    file->capacity = capacity;
    return PCCD_OK;
}

/* Whether a text has a byte 0 from `first` on, as a sparse file has. */
static int look_for_hole(const struct ctl_file *file, size_t first,
                         struct ctl_error *error)
{
    const char *hole = memchr(file->data + first, 0, file->bytes - first);
    return hole == NULL
               ? PCCD_OK
               : ctl_error_set(error, PCCD_E_FORMAT,
                               "%s: byte %" PRIu64 " is zero, which no text has",
                               file->path, file->offset + (uint64_t)(hole - file->data));
}

/* Read on until `bytes` are in memory, or all. */
static int read_up_to(struct ctl_file *file, size_t bytes, struct ctl_error *error)
{
    while (file->bytes < bytes && file->has_more) {
        if (file->bytes + 1 >= file->capacity &&
            grow(file, file->capacity * 2, error) != PCCD_OK) {
            return PCCD_E_NOMEM;
        }
        size_t room = file->capacity - file->bytes - 1;
        size_t wanted = bytes - file->bytes < room ? bytes - file->bytes : room;
        char *to = file->data + file->bytes;
        ssize_t got =
            read(file->fd, to, wanted < READ_BYTES_MAX ? wanted : READ_BYTES_MAX);
        if (got < 0 && errno == EINTR) {
            continue;
        }
        if (got < 0) {
            return ctl_error_set(error, PCCD_E_SYSTEM, "%s: cannot read: %s", file->path,
                                 strerror(errno));
        }
        file->has_more = got > 0;
        file->bytes += (size_t)got;
        if (file->is_text && look_for_hole(file, file->bytes - (size_t)got, error)) {
            return PCCD_E_FORMAT;
        }
    }
    uint64_t read = file->offset + file->bytes;
    file->data[file->bytes] = '\0';
    file->rest_bytes = file->has_more && file->size > read ? file->size - read : 0;
    return PCCD_OK;
}

/* The first bytes of a large file, or all. A pipe that goes on is judged, too, before all
 * of it is read. */
static int begin(struct ctl_file *file, ctl_file_judge judge, struct ctl_error *error)
{
    bool is_large = file->size > WINDOW_BYTES;
    bool is_pipe = file->size == 0;
    size_t capacity = is_large                      ? WINDOW_BYTES
                      : file->size > READ_BYTES_MIN ? (size_t)file->size
                                                    : READ_BYTES_MIN;
    /* Two more bytes: one for the NUL, one so that the end is seen without growing. */
    int status = grow(file, capacity + 2, error);
    if (status == PCCD_OK) {
        status = read_up_to(file, is_large || is_pipe ? WINDOW_BYTES : SIZE_MAX, error);
    }
    if (status == PCCD_OK && (is_large || (is_pipe && file->has_more))) {
        status = judge(file, &file->is_text, error);
    }
    if (status == PCCD_OK && is_pipe) {
        status = read_up_to(file, SIZE_MAX, error);
    }
    if (status == PCCD_OK && !is_large) {
        struct ctl_error ignored;
        file->is_text = judge(file, &file->is_text, &ignored) == PCCD_OK && file->is_text;
    }
    return status == PCCD_OK && file->is_text ? look_for_hole(file, 0, error) : status;
}

int ctl_file_open(const char *path, ctl_file_judge judge, struct ctl_file *file,
                  struct ctl_error *error)
{
    struct stat info;
    *file = (struct ctl_file){.path = path, .fd = open(path, O_RDONLY | O_CLOEXEC)};
    if (file->fd < 0) {
        return ctl_error_set(error, PCCD_E_SYSTEM, "%s: cannot open: %s", path,
                             strerror(errno));
    }
    file->is_open = file->has_more = true;
    int status = PCCD_OK;
    if (fstat(file->fd, &info) != 0) {
        status = ctl_error_set(error, PCCD_E_SYSTEM, "%s: cannot stat: %s", path,
                               strerror(errno));
    } else if (S_ISCHR(info.st_mode) || S_ISBLK(info.st_mode)) {
        status = ctl_error_set(error, PCCD_E_FORMAT,
                               "%s: a device, neither file nor pipe", path);
    } else {
        file->size = S_ISREG(info.st_mode) ? (uint64_t)info.st_size : 0;
        status = begin(file, judge, error);
    }
    if (status != PCCD_OK) {
        ctl_file_deinit(file);
    }
    return status;
}

int ctl_file_load(struct ctl_file *file, struct ctl_error *error)
{
    int status = PCCD_OK;
    if (file->size >= SIZE_MAX - 2) {
        status = no_memory(file, SIZE_MAX, error);
    } else if (file->has_more && file->size + 2 > file->capacity) {
        status = grow(file, (size_t)file->size + 2, error);
    }
    return status == PCCD_OK ? read_up_to(file, SIZE_MAX, error) : status;
}

int ctl_file_status(const struct ctl_file *file, struct ctl_error *error)
{
    return file->status == PCCD_OK
               ? PCCD_OK
               : ctl_error_set(error, file->status, "%s", file->failure.text);
}

void ctl_file_deinit(struct ctl_file *file)
{
    if (file->is_open) {
        (void)close(file->fd);
    }
    free(file->data);
    *file = (struct ctl_file){.path = file->path};
}

/* ---- the window -------------------------------------------------------------------- */

/* What goes wrong is kept, and the file ends there. */
static void read_window(struct ctl_file *file, size_t bytes)
{
    file->status = read_up_to(file, bytes, &file->failure);
    if (file->status != PCCD_OK) {
        file->bytes = 0;
        file->data[0] = '\0';
        file->rest_bytes = 0;
        file->has_more = false;
    }
}

/* The window begins at `from` then, and has `bytes` if the file has so many. */
static void move_window(struct ctl_file *file, const char *from, size_t bytes)
{
    size_t passed = (size_t)(from - file->data), capacity = file->capacity;
    file->bytes -= passed;
    file->offset += passed;
    memmove(file->data, from, file->bytes);
    /* A line that is longer than half of it: twice as much, so that few moves do. */
    while (capacity / 2 < bytes && capacity < SIZE_MAX / 2) {
        capacity *= 2;
    }
    file->status =
        capacity > file->capacity ? grow(file, capacity, &file->failure) : PCCD_OK;
    if (file->status == PCCD_OK) {
        read_window(file, file->capacity - 1);
    } else {
        file->has_more = false;
    }
}

struct ctl_text ctl_text_begin(struct ctl_file *file)
{
    if (file->offset > 0 && file->status == PCCD_OK) {
        file->bytes = 0;
        file->offset = 0;
        file->has_more = lseek(file->fd, 0, SEEK_SET) == 0;
        read_window(file, file->capacity - 1);
    }
    return (struct ctl_text){.at = ctl_file_start(file),
                             .end = file->data + file->bytes,
                             .line = 0,
                             .file = file};
}

bool ctl_text_more(struct ctl_text *text, size_t bytes)
{
    struct ctl_file *file = text->file;
    const char *from = text->keep != NULL ? text->keep : text->at;
    if ((size_t)(text->end - text->at) >= bytes) {
        return true;
    }
    if (file == NULL || !file->has_more) {
        return false;
    }
    size_t before = (size_t)(text->at - from);
    move_window(file, from, before + bytes);
    text->end = file->data + file->bytes;
    text->at = file->data + (before < file->bytes ? before : file->bytes);
    text->keep = text->keep != NULL ? file->data : NULL;
    return (size_t)(text->end - text->at) >= bytes;
}

/* ---- lines and words --------------------------------------------------------------- */

const char *ctl_file_start(const struct ctl_file *file)
{
    bool has_mark = file->offset == 0 && file->bytes >= 3 &&
                    memcmp(file->data, "\xef\xbb\xbf", 3) == 0;
    return file->data + (has_mark ? 3 : 0);
}

uint32_t ctl_file_word(const char *at)
{
    const unsigned char *bytes = (const unsigned char *)at;
    return (uint32_t)bytes[0] | (uint32_t)bytes[1] << 8 | (uint32_t)bytes[2] << 16 |
           (uint32_t)bytes[3] << 24;
}

/* The first line end of a piece of text; NULL: there is none. */
static const char *find_end(const char *at, size_t bytes)
{
    const char *feed = memchr(at, '\n', bytes);
    const char *carriage = memchr(at, '\r', feed != NULL ? (size_t)(feed - at) : bytes);
    return carriage != NULL ? carriage : feed;
}

bool ctl_text_line(struct ctl_text *text, struct ctl_word *line)
{
    const char *stop = NULL;
    size_t looked = 0; /* bytes without a line end */
    do {
        /* In pieces, so that one kind of line end is not sought beyond the other. */
        while (stop == NULL && looked < (size_t)(text->end - text->at)) {
            size_t left = (size_t)(text->end - text->at) - looked;
            size_t piece = left < PIECE_BYTES ? left : PIECE_BYTES;
            stop = find_end(text->at + looked, piece);
            looked += stop != NULL ? 0 : piece;
        }
    } while (stop == NULL && ctl_text_more(text, looked + 1));
    if (text->at == text->end) {
        return false;
    }
    size_t length = (size_t)((stop != NULL ? stop : text->end) - text->at);
    size_t end_bytes = stop != NULL;
    if (stop != NULL && *stop == '\r' && ctl_text_more(text, length + 2)) {
        end_bytes += text->at[length + 1] == '\n';
    }
    line->at = text->at;
    line->end = text->at + length;
    text->at += length + end_bytes;
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

bool ctl_word_float(const struct ctl_word *word, double *value)
{
    char *stop;
    if (read_quickly(word, value) && rounds_to_float(*value)) {
        *value = (double)(float)*value;
        return true;
    }
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
    if (read_quickly(word, value)) {
        return true;
    }
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
