/* columns.h - prints tables that fit the width of a terminal.
 *
 * Threads: one.
 */
#ifndef CTL_COLUMNS_H
#define CTL_COLUMNS_H

#include <stdbool.h>
#include <stdint.h>

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
