/* columns.h - prints figures for people, and structs as tables and as JSON. */
#ifndef CTL_COLUMNS_H
#define CTL_COLUMNS_H

#include <jansson.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

/* ---- Formats counts, bytes and times for people: "1.5 MiB". */

/* Return a figure as text: "1.2 M", "3.4 MiB", "1 h 02 min", "1.25 ms". Each text lives
 * until seven more have been made. */
const char *format_count(double count);
const char *format_bytes(double bytes);
const char *format_span(uint64_t nanoseconds);
const char *format_ms(double milliseconds);
/* Return the name of a user, or the number; it lives as long. */
const char *format_user(uint32_t uid);

/* Print text that begins behind `indent` columns of a line. What a terminal has no room
 * for goes on below, as far to the right; elsewhere it is one line. No end of line
 * follows. */
void columns_text(FILE *to, uint32_t indent, const char *text);
/* Return a stream that prints whole lines to `to` as columns_text does; `to` itself, if
 * that is no terminal. A program has one, for the first `to`; nobody closes it. */
FILE *columns_fitted(FILE *to);

/* ---- Columns: members of a struct, as a table for people and as JSON for programs. */

/* Type of the member that a column shows, and how people and programs see it. */
enum column_type {
    COLUMN_NUMBER, /* a whole number of 4 or 8 `bytes`, or a bool */
    COLUMN_HANDLE, /* the same, for people hexadecimal */
    COLUMN_COUNT,  /* the same, for people "1.2 M" */
    COLUMN_BYTES,  /* the same, for people "3.4 MiB" */
    COLUMN_SPAN,   /* the same: nanoseconds, for people "1 h 02 min" */
    COLUMN_USER,   /* the same: for people the name */
    COLUMN_NS,     /* the same: nanoseconds, for programs a real number of milliseconds */
    COLUMN_REAL,   /* double, null unless it is finite */
    COLUMN_REAL_1, /* the same, with so many digits behind the point for people */
    COLUMN_REAL_3,
    COLUMN_RATE,  /* the same: bytes, for people "3.4 MiB" */
    COLUMN_EXACT, /* double, "%a" for programs */
    COLUMN_FLAG,  /* bool */
    COLUMN_TEXT,  /* const char *, null if NULL */
    COLUMN_CHARS, /* char[bytes] with a NUL */
    COLUMN_JSON   /* json_t *, which goes to the object */
};

struct column {
    const char *json; /* its key; NULL: not for programs */
    const char *head; /* above the table; NULL: not for people */
    enum column_type type;
    size_t at, bytes;
    bool is_left;   /* aligned; numbers are on the right */
    uint32_t width; /* at least; columns_fit sets it */
    uint32_t cut;   /* of texts, at most; 0: as they are */
    uint32_t rank;  /* 1: left out last; 0 in tables that columns_fit never sees */
    bool is_hidden; /* by columns_fit */
};

/* Say where a member of a struct lies, for a row of a table. */
#define COLUMN_OF(type, member)                                                          \
    .at = offsetof(type, member), .bytes = sizeof((type *)0)->member

/* Tables end with a column that is all zeros. */

/* Choose widths, and which columns are shown, for `count` rows of so many bytes. A blank
 * stands between two columns. The most important one is always shown. */
void columns_fit(struct column *columns, const void *rows, size_t row_bytes,
                 uint32_t count, uint32_t room);
/* Print a table of `count` rows of so many bytes on the standard output. A terminal that
 * has no room for all columns is shown the most important ones; if it `continues`, the
 * others follow in tables below, each of which begins with the column of rank 1. */
#define COLUMNS_MAX 160u
void columns_table(const struct column *columns, const void *rows, size_t row_bytes,
                   uint32_t count, bool continues);
/* Set those members of an object that programs see. False: no memory. */
bool columns_add(json_t *object, const struct column *columns, const void *row);
/* Return an object with those members. NULL: no memory. */
json_t *columns_json(const struct column *columns, const void *row);
/* Fill a row from such an object: numbers, flags, real and exact numbers, chars. False:
 * it is none, and the row may be filled in part. */
bool columns_read(const json_t *object, const struct column *columns, void *row);

#endif
