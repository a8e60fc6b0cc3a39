/* shown.c - names that others chose, in what our programs print. */
#include "shown.h"

#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include "printable.h"

#define PLACES      8u
#define PLACE_BYTES 4096u /* the longest path */

static char *place(void)
{
    static char places[PLACES][PLACE_BYTES];
    static uint32_t next;
    return places[next++ % PLACES];
}

const char *tool_shown_field(const char *text, size_t bytes)
{
    char *shown = place();
    proto_printable(text, strnlen(text, bytes), shown, PLACE_BYTES);
    return shown;
}

const char *tool_shown(const char *text)
{
    return tool_shown_field(text, strlen(text));
}

/* Bytes that go on with a character of UTF-8 take no column of their own. */
static bool is_inside(char byte)
{
    return ((unsigned char)byte & 0xc0) == 0x80;
}

/* Cut after so many columns; `used` gets how many there are. */
static char *cut(const char *text, uint32_t columns, uint32_t *used)
{
    char *shown = place();
    size_t last = 0, bytes = 0; /* of the last column, and behind it */
    *used = 0;
    proto_printable(text, strlen(text), shown, PLACE_BYTES);
    while (shown[bytes] != '\0' && (*used < columns || is_inside(shown[bytes]))) {
        last = is_inside(shown[bytes]) ? last : bytes;
        *used += !is_inside(shown[bytes]);
        bytes++;
    }
    if (shown[bytes] != '\0' && columns > 0) {
        shown[last] = '+';
        bytes = last + 1;
    }
    shown[bytes] = '\0';
    return shown;
}

const char *tool_shown_cut(const char *text, uint32_t columns)
{
    uint32_t used;
    return cut(text, columns, &used);
}

const char *tool_shown_column(const char *text, uint32_t columns)
{
    uint32_t used;
    char *shown = cut(text, columns, &used);
    for (size_t bytes = strlen(shown); used < columns && bytes + 1 < PLACE_BYTES;
         used++) {
        shown[bytes++] = ' ';
        shown[bytes] = '\0';
    }
    return shown;
}

const char *tool_shown_number(double number)
{
    char *shown = place();
    int digits = 4;
    do {
        (void)snprintf(shown, PLACE_BYTES, "%.*g", digits++, number);
    } while (number < 1 && strcmp(shown, "1") == 0);
    return shown;
}

const char *tool_shown_interval(double low, double high)
{
    const char *from = tool_shown_number(low), *to = tool_shown_number(high);
    char *shown = place();
    (void)snprintf(shown, PLACE_BYTES, strcmp(from, to) == 0 ? "%s" : "%s to %s", from,
                   to);
    return shown;
}
