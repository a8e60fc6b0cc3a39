/* columns.c - figures for people, and tables that fit a terminal. */
#include "columns.h"

#include <inttypes.h>
#include <pwd.h>
#include <stdio.h>
#include <string.h>

/* ---- Numbers as people read them. */

#define PLACES      8u
#define PLACE_BYTES 48u

static char *place(void)
{
    static char places[PLACES][PLACE_BYTES];
    static uint32_t next;
    return places[next++ % PLACES];
}

static const char *scaled(double value, double step, const char *const *units,
                          uint32_t unit_count)
{
    char *text = place();
    uint32_t unit = 0;
    while (value >= 999.5 && unit + 1 < unit_count) {
        value /= step;
        unit++;
    }
    snprintf(text, PLACE_BYTES, unit == 0 ? "%.0f%s" : "%.3g%s", value, units[unit]);
    return text;
}

const char *format_count(double count)
{
    static const char *const units[] = {"", " k", " M", " G", " T"};
    return scaled(count, 1000, units, 5);
}

const char *format_bytes(double bytes)
{
    static const char *const units[] = {" B", " KiB", " MiB", " GiB", " TiB"};
    return scaled(bytes, 1024, units, 5);
}

const char *format_span(uint64_t nanoseconds)
{
    char *text = place();
    uint64_t s = nanoseconds / 1000000000u;
    if (s < 60) {
        snprintf(text, PLACE_BYTES, "%.1f s", (double)nanoseconds / 1e9);
    } else if (s < 3600) {
        snprintf(text, PLACE_BYTES, "%" PRIu64 " min %02" PRIu64 " s", s / 60, s % 60);
    } else if (s < 86400) {
        snprintf(text, PLACE_BYTES, "%" PRIu64 " h %02" PRIu64 " min", s / 3600,
                 s / 60 % 60);
    } else {
        snprintf(text, PLACE_BYTES, "%" PRIu64 " d %" PRIu64 " h", s / 86400,
                 s / 3600 % 24);
    }
    return text;
}

const char *format_ms(double milliseconds)
{
    char *text = place();
    snprintf(text, PLACE_BYTES, milliseconds < 10 ? "%.3f ms" : "%.1f ms", milliseconds);
    return text;
}

const char *format_user(uint32_t uid)
{
    char *text = place();
    const struct passwd *user = getpwuid(uid);
    if (user != NULL) {
        snprintf(text, PLACE_BYTES, "%s", user->pw_name);
    } else {
        snprintf(text, PLACE_BYTES, "%" PRIu32, uid);
    }
    return text;
}

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
