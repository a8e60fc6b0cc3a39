/* columns.c - tables that fit a terminal. */
#include "columns.h"

#include <stdio.h>
#include <string.h>

/* Columns of a terminal: bytes that go on with a character take none. */
static uint32_t width_of(const char *text)
{
    uint32_t width = 0;
    for (; *text != '\0'; text++) {
        width += ((unsigned char)*text & 0xc0) != 0x80;
    }
    return width;
}

void columns_fit(struct column *columns, uint32_t count,
                 const char (*cells)[COLUMNS_CELL_BYTES], uint32_t rows, uint32_t room)
{
    uint32_t used = 0;
    for (uint32_t c = 0; c < count; c++) {
        columns[c].width = width_of(columns[c].head);
        columns[c].is_shown = false;
        for (uint32_t row = 0; row < rows; row++) {
            uint32_t width = width_of(cells[row * count + c]);
            columns[c].width = width > columns[c].width ? width : columns[c].width;
        }
    }
    /* A column that has nothing to say takes no room, not even a blank. */
    for (uint32_t rank = 1; rank <= count; rank++) {
        for (uint32_t c = 0; c < count; c++) {
            uint32_t needed = columns[c].width + (used > 0 ? 1 : 0);
            if (columns[c].rank == rank && columns[c].width > 0) {
                if (used > 0 && used + needed > room) {
                    return; /* nor what matters less, though it may be narrower */
                }
                columns[c].is_shown = true;
                used += needed;
            }
        }
    }
}

void columns_print(const struct column *columns, uint32_t count,
                   const char (*cells)[COLUMNS_CELL_BYTES], const char *begin,
                   const char *end)
{
    uint32_t blanks = 0; /* due before the next column: a line ends without any */
    fputs(begin, stdout);
    for (uint32_t c = 0; c < count; c++) {
        const char *text = cells != NULL ? cells[c] : columns[c].head;
        if (!columns[c].is_shown) {
            continue;
        }
        uint32_t fill = columns[c].width - width_of(text);
        blanks += columns[c].is_left ? 0 : fill;
        if (text[0] != '\0') {
            printf("%*s%s", (int)blanks, "", text);
            blanks = 0;
        }
        blanks += (columns[c].is_left ? fill : 0) + 1;
    }
    printf("%s\n", end);
}
