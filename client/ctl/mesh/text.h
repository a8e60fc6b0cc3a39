/* client/ctl/mesh/text.h - reads a file from its beginning to its end, and splits text
 * into lines, words and numbers.
 *
 * Of a large file a window of a mebibyte is in memory, which goes along with the reader;
 * of others, and where a format needs it, all. Where something is wrong, in the format or
 * in reading on, the file has its status, and ends there; readers may go on for a while.
 */
#ifndef CTL_TEXT_H
#define CTL_TEXT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "error.h"
#include "terminal.h"

/* A run of characters in the file, not terminated. */
struct ctl_word {
    const char *at;
    const char *end;
};

/* A file in memory, or a window of one. data[bytes] is a NUL, so that the C number
 * parsers stop there. */
struct ctl_file {
    const char *path;        /* the caller's, as is what comes next */
    struct ctl_error *error; /* gets what is wrong with the file */
    char *data;
    size_t bytes;
    uint64_t rest_bytes; /* of the file, after these; 0 for all of it */
    uint64_t offset;     /* of data[0] in the file */

    /* Where its reader is; what reads on moves everything in memory. */
    const char *at;
    const char *keep; /* NULL, or from where on what was read is needed yet; it moves */
    uint64_t line;    /* of the line read last, or where `keep` was set; 0: of bytes */
    const char *item; /* NULL, or of what kind that is that is read, for messages */
    uint64_t item_number;

    int status; /* PCCD_OK, or the first error, of which `error` has the text */

    /* The rest is for text.c; all zero in a file that is in memory as a whole. */
    uint64_t line_last; /* read, counted from 1 */
    uint64_t size;      /* when it was opened; 0: a pipe */
    size_t capacity;    /* of data */
    struct progress progress; /* on while a mesh is read of it; mebibytes */
    int fd;
    bool is_open, has_more; /* fd; behind the window */
    bool is_text;
};

/* Open `path` (a file or a pipe), and read its beginning, of a small one all. Errors:
 * E_SYSTEM, E_NOMEM, E_FORMAT for a device. */
int ctl_file_open(const char *path, struct ctl_file *file, struct ctl_error *error);
/* Read all of it, before any of it has moved. The same errors. */
int ctl_file_load(struct ctl_file *file, struct ctl_error *error);
/* Copy `bytes` from byte `first` of a file on, which is no pipe or was loaded; what is in
 * memory stays. The same errors, and E_FORMAT: it has become shorter. */
int ctl_file_read_at(struct ctl_file *file, uint64_t first, size_t bytes, char *to);
/* Return whether all of the file is in memory. */
bool ctl_file_is_loaded(const struct ctl_file *file);
void ctl_file_deinit(struct ctl_file *file);

/* Tell what is wrong where the reader is: path, line or byte, and item come before it.
 * Only the first that is wrong is told; the status is that one's. */
int ctl_file_fail(struct ctl_file *file, int status, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
/* Tell that a file is not as its format says. */
#define ctl_file_refuse(file, ...) ctl_file_fail(file, PCCD_E_FORMAT, __VA_ARGS__)

/* Go to the beginning, behind a byte order mark, whatever was read. */
void ctl_file_begin(struct ctl_file *file);
/* Return where its text begins. */
const char *ctl_file_start(const struct ctl_file *file);
/* Expect text, which has no byte 0: where there is one is told as soon as it is read. */
void ctl_file_expect_text(struct ctl_file *file);
/* Return whether so many bytes follow; all of them are in memory then. */
bool ctl_file_more(struct ctl_file *file, size_t bytes);
/* Take the next line without its line end (LF, CR LF or CR); false at the end of the
 * file. */
bool ctl_file_line(struct ctl_file *file, struct ctl_word *line);
/* Return how many bytes the file has: in all, and behind the reader. */
uint64_t ctl_file_size(const struct ctl_file *file);
uint64_t ctl_file_left(const struct ctl_file *file);

/* Return an unsigned integer of 1, 2 or 4 bytes of a file that is not text, the lowest
 * first. */
static inline uint32_t ctl_file_integer(const char *at, size_t bytes)
{
    const unsigned char *low = (const unsigned char *)at;
    uint32_t value = bytes > 1 ? (uint32_t)low[0] | (uint32_t)low[1] << 8 : low[0];
    return bytes < 4 ? value : value | (uint32_t)low[2] << 16 | (uint32_t)low[3] << 24;
}
#define ctl_file_word(at) ctl_file_integer(at, 4)

/* Take the next word of the line, which shrinks; false when only blanks are left. */
bool ctl_word_next(struct ctl_word *line, struct ctl_word *word);
bool ctl_word_is(const struct ctl_word *word, const char *text);
/* Return whether a word is the text, in small letters or capitals. */
bool ctl_word_is_any_case(const struct ctl_word *word, const char *text);
/* Return the word's length, cut for messages: what "%.*s" takes. */
int ctl_word_length(const struct ctl_word *word);
#define CTL_QUOTE(word) ctl_word_length(&(word)), (word).at

/* Read the word as a number; false, and any value, when it is not one from its first to
 * its last character. Beyond the range: infinity (real), false (integer). A float is
 * rounded once. */
bool ctl_word_float(const struct ctl_word *word, double *value);
bool ctl_word_double(const struct ctl_word *word, double *value);
bool ctl_word_integer(const struct ctl_word *word, int64_t *value);

#endif
