/* columns.h - prints figures for people, and tables that fit a terminal.
 *
 * Threads: one.
 */
#ifndef CTL_COLUMNS_H
#define CTL_COLUMNS_H

#include <stdbool.h>
#include <stdint.h>

/* ---- Formats counts, bytes and times for people: "1.5 MiB". */

/* Each of these lives until seven more have been made. "1.2 M", "3.4 MiB", "1 h 02 min",
 * "1.25 ms". */
const char *format_count(double count);
const char *format_bytes(double bytes);
const char *format_span(uint64_t nanoseconds);
const char *format_ms(double milliseconds);
/* The name of a user, or the number. */
const char *format_user(uint32_t uid);

#define COLUMNS_CELL_BYTES 96u /* sixteen columns of \xNN, or of UTF-8 */

struct column {
    const char *head;
    uint32_t rank; /* 1: the most important, left out last; no two are the same */
    bool is_left;  /* aligned; numbers are on the right */
    /* Set by columns_fit. */
    uint32_t width;
    bool is_shown;
};

/* Choose among columns[count] for rows of cells[row * count + column]. A blank stands
 * between two columns. The most important one is always shown. */
void columns_fit(struct column *columns, uint32_t count,
                 const char (*cells)[COLUMNS_CELL_BYTES], uint32_t rows, uint32_t room);
/* One line of what is shown: `cells` of a row, or NULL for the heads; between `begin` and
 * `end`, which take no room. */
void columns_print(const struct column *columns, uint32_t count,
                   const char (*cells)[COLUMNS_CELL_BYTES], const char *begin,
                   const char *end);

#endif
