/* client/ctl/mesh/text.h - reads a file from its beginning to its end, and splits text
 * into lines, words and numbers.
 *
 * Of a large file a window of a mebibyte is in memory, which goes along with the reader;
 * of others, and where a format needs it, all.
 *
 * Room:     client/ctl. May include: error.h, pccd_types.h.
 * Does:     reads files, splits them into lines and words, turns words into numbers.
 * Does not: know any file format.
 * Threads:  [any]; nothing is shared.
 * Source:   used by ply.c and obj.c.
 */
#ifndef CTL_TEXT_H
#define CTL_TEXT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "error.h"

/* A file in memory, or a window of one. data[bytes] is a NUL, so that the C number
 * parsers stop there. */
struct ctl_file {
    const char *path; /* the caller's; for messages */
    char *data;
    size_t bytes;
    uint64_t rest_bytes; /* of the file, after these; 0 for all of it */
    uint64_t offset;     /* of data[0] in the file */
    /* The rest is for text.c; all zero in a file that is in memory as a whole. */
    uint64_t size;   /* when it was opened; 0: a pipe */
    size_t capacity; /* of data */
    int fd;
    bool is_open, has_more; /* fd; behind the window */
    bool is_text;           /* and so has no byte 0 */
    int status;             /* of reading on: PCCD_OK, or an error and its text */
    struct ctl_error failure;
};

/* What is thought of a file's first bytes, before the others are read, which may take
 * minutes, or for ever; `is_text`: there is no byte 0 in it. What it refuses of a small
 * file its reader refuses, too, and says why. */
typedef int (*ctl_file_judge)(const struct ctl_file *begin, bool *is_text,
                              struct ctl_error *error);

/* A place in the file, at the start of a line. */
struct ctl_text {
    const char *at;
    const char *end;
    uint64_t line; /* number of the line read last, from 1; 0 before the first */
    /* What is read on when `end` is reached, by ctl_text_line and ctl_text_more, which
     * then move everything in memory. NULL: nothing. */
    struct ctl_file *file;
    const char
        *keep; /* NULL, or from where on what was read is needed yet; it moves, too */
};

/* A run of characters in the file, not terminated. */
struct ctl_word {
    const char *at;
    const char *end;
};

/* Open `path` (a file, or a pipe, which is read to its end), and read the beginning of a
 * large file, all of another. Errors: E_SYSTEM, E_NOMEM, E_FORMAT for a device, or a
 * text with a byte 0, and those of `judge`. */
int ctl_file_open(const char *path, ctl_file_judge judge, struct ctl_file *file,
                  struct ctl_error *error);
/* Read all of it, before any text of it has moved. The same errors. */
int ctl_file_load(struct ctl_file *file, struct ctl_error *error);
/* What went wrong when a text was read on, which then seems to end there. */
int ctl_file_status(const struct ctl_file *file, struct ctl_error *error);
void ctl_file_deinit(struct ctl_file *file);
/* Where its text begins: behind a byte order mark. */
const char *ctl_file_start(const struct ctl_file *file);
/* Four bytes of a file that is not text, the lowest first. */
uint32_t ctl_file_word(const char *at);

/* The beginning of a file, whatever was read of it. */
struct ctl_text ctl_text_begin(struct ctl_file *file);
/* Whether so many bytes follow; all of them are in memory then. */
bool ctl_text_more(struct ctl_text *text, size_t bytes);
/* The next line without its line end (LF, CR LF or CR); false at the end of the file. */
bool ctl_text_line(struct ctl_text *text, struct ctl_word *line);
/* The next word of the line, which shrinks; false when only blanks are left. */
bool ctl_word_next(struct ctl_word *line, struct ctl_word *word);

bool ctl_word_is(const struct ctl_word *word, const char *text);
/* The same in capitals, too. */
bool ctl_word_is_any_case(const struct ctl_word *word, const char *text);
/* The word's length, cut for "%.*s". */
int ctl_word_length(const struct ctl_word *word);

/* The word as a number; false when it is not one from its first to its last character.
 * Beyond the range: infinity (real), false (integer). */
bool ctl_word_float(const struct ctl_word *word,
                    double *value); /* rounded once, to float */
bool ctl_word_double(const struct ctl_word *word, double *value);
bool ctl_word_integer(const struct ctl_word *word, int64_t *value);

#endif
