/* columns.c - figures for people, tables that fit a terminal, and JSON. */
#include "columns.h"

#include <inttypes.h>
#include <math.h>
#include <pwd.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "output.h"
#include "shown.h"
#include "terminal.h"

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

/* ---- for people -------------------------------------------------------------------- */

#define CELL_BYTES 512u

static uint64_t number_at(const struct column *column, const void *row)
{
    const char *at = (const char *)row + column->at;
    uint64_t wide = 0;
    uint32_t middle = 0;
    uint8_t narrow = 0;
    switch (column->bytes) {
    case sizeof wide:
        memcpy(&wide, at, sizeof wide);
        return wide;
    case sizeof middle:
        memcpy(&middle, at, sizeof middle);
        return middle;
    default:
        memcpy(&narrow, at, sizeof narrow);
        return narrow;
    }
}

static double real_at(const struct column *column, const void *row)
{
    double value;
    memcpy(&value, (const char *)row + column->at, sizeof value);
    return value;
}

static const char *text_at(const struct column *column, const void *row)
{
    const char *at = (const char *)row + column->at;
    return column->type == COLUMN_CHARS ? at : *(const char *const *)(const void *)at;
}

/* A row's, or the head. */
static void fill(char cell[CELL_BYTES], const struct column *column, const void *row)
{
    uint32_t most = column->cut > 0 ? column->cut : UINT32_MAX;
    if (row == NULL) {
        snprintf(cell, CELL_BYTES, "%s", column->head);
        return;
    }
    switch (column->type) {
    case COLUMN_NUMBER:
        snprintf(cell, CELL_BYTES, "%" PRIu64, number_at(column, row));
        return;
    case COLUMN_HANDLE:
        snprintf(cell, CELL_BYTES, "%#" PRIx64, number_at(column, row));
        return;
    case COLUMN_COUNT:
        snprintf(cell, CELL_BYTES, "%s", format_count((double)number_at(column, row)));
        return;
    case COLUMN_BYTES:
        snprintf(cell, CELL_BYTES, "%s", format_bytes((double)number_at(column, row)));
        return;
    case COLUMN_SPAN:
        snprintf(cell, CELL_BYTES, "%s", format_span(number_at(column, row)));
        return;
    case COLUMN_USER:
        snprintf(cell, CELL_BYTES, "%s",
                 tool_shown_cut(format_user((uint32_t)number_at(column, row)), most));
        return;
    case COLUMN_NS:
        snprintf(cell, CELL_BYTES, "%s", format_ms((double)number_at(column, row) / 1e6));
        return;
    case COLUMN_REAL:
    case COLUMN_EXACT:
        snprintf(cell, CELL_BYTES, "%g", real_at(column, row));
        return;
    case COLUMN_REAL_1:
        snprintf(cell, CELL_BYTES, "%.1f", real_at(column, row));
        return;
    case COLUMN_REAL_3:
        snprintf(cell, CELL_BYTES, "%.3f", real_at(column, row));
        return;
    case COLUMN_RATE:
        snprintf(cell, CELL_BYTES, "%s", format_bytes(real_at(column, row)));
        return;
    case COLUMN_TEXT:
    case COLUMN_CHARS:
        snprintf(cell, CELL_BYTES, "%s", tool_shown_cut(text_at(column, row), most));
        return;
    default:
        cell[0] = '\0';
        return;
    }
}

static bool is_last(const struct column *column)
{
    return column->head == NULL && column->json == NULL;
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

/* Return how many columns the terminal has; UINT32_MAX: it is none. */
static uint32_t room_of(FILE *to)
{
    uint32_t columns = UINT32_MAX, rows;
    if (isatty(fileno(to)) == 1) {
        terminal_size(fileno(to), &columns, &rows);
    }
    return columns;
}

void columns_text(FILE *to, uint32_t indent, const char *text)
{
    uint32_t room = room_of(to), used = indent;
    for (size_t blanks = 0; *text != '\0';) {
        size_t length = strcspn(text, " ");
        uint32_t width = 0;
        for (size_t i = 0; i < length; i++) {
            width += ((unsigned char)text[i] & 0xc0) != 0x80;
        }
        if (used > indent && used + blanks + width > room) {
            fprintf(to, "\n%*s", (int)indent, "");
            used = indent;
            blanks = 0;
        }
        fprintf(to, "%*s%.*s", (int)blanks, "", (int)length, text);
        used += (uint32_t)blanks + width;
        text += length;
        blanks = strspn(text, " ");
        text += blanks;
    }
}

/* ---- Lines that fit. */

#define LINE_BYTES  2048u
#define INDENT_MAX  24u
#define INDENT_LESS 2u /* below a line without one, or with a longer one */

struct fitted {
    FILE *to;
    char line[LINE_BYTES]; /* what has come of the last one */
    size_t length;
};

/* Print a line, without its end: what stands behind the first two blanks, its head, goes
 * on below. */
static void print_fitted(struct fitted *fitted)
{
    char *line = fitted->line;
    line[fitted->length] = '\0';
    size_t head = strspn(line, " ");
    if (width_of(line) > room_of(fitted->to)) {
        char *gap = strstr(line + head, "  ");
        head = gap != NULL ? (size_t)(gap - line) : head;
        head += strspn(line + head, " ");
        head = head <= INDENT_MAX ? head : 0;
        fprintf(fitted->to, "%.*s", (int)head, line);
        columns_text(fitted->to, head > 0 ? (uint32_t)head : INDENT_LESS, line + head);
    } else {
        fputs(line, fitted->to);
    }
    fitted->length = 0;
}

static ssize_t write_fitted(void *cookie, const char *bytes, size_t count)
{
    struct fitted *fitted = cookie;
    for (size_t i = 0; i < count; i++) {
        if (bytes[i] != '\n' && fitted->length + 1 < LINE_BYTES) {
            fitted->line[fitted->length++] = bytes[i];
            continue;
        }
        print_fitted(fitted);
        putc(bytes[i], fitted->to);
    }
    return ferror(fitted->to) != 0 ? 0 : (ssize_t)count;
}

FILE *columns_fitted(FILE *to)
{
    static struct fitted fitted;
    static FILE *stream;
    const cookie_io_functions_t functions = {.write = write_fitted};
    if (!terminal_has_size(fileno(to))) {
        return to;
    }
    if (stream == NULL) {
        fitted.to = to;
        stream = fopencookie(&fitted, "w", functions);
        if (stream != NULL) {
            (void)setvbuf(stream, NULL, _IOLBF, 0);
        }
    }
    return stream != NULL ? stream : to;
}

void columns_fit(struct column *columns, const void *rows, size_t row_bytes,
                 uint32_t count, uint32_t room)
{
    char cell[CELL_BYTES];
    uint32_t used = 0, column_count = 0;
    for (struct column *column = columns; !is_last(column); column++, column_count++) {
        column->is_hidden = true;
        for (uint32_t i = 0; i <= count && column->head != NULL; i++) {
            fill(cell, column, i < count ? (const char *)rows + i * row_bytes : NULL);
            uint32_t width = width_of(cell);
            column->width = width > column->width ? width : column->width;
        }
    }
    /* A column that has nothing to say takes no room, not even a blank. */
    for (uint32_t rank = 1; rank <= column_count; rank++) {
        for (struct column *column = columns; !is_last(column); column++) {
            uint32_t needed = column->width + (used > 0 ? 1 : 0);
            if (column->rank == rank && column->width > 0) {
                if (used > 0 && used + needed > room) {
                    return; /* nor what matters less, though it may be narrower */
                }
                column->is_hidden = false;
                used += needed;
            }
        }
    }
}

/* Print what is shown of a row, or for NULL the heads. */
static void print_row(const struct column *columns, const void *row)
{
    char cell[CELL_BYTES];
    uint32_t blanks = 0; /* due before the next column: a line ends without any */
    fputs(row == NULL ? terminal_begin(TERMINAL_BOLD) : "", stdout);
    for (const struct column *column = columns; !is_last(column); column++) {
        if (column->is_hidden || column->head == NULL) {
            continue;
        }
        fill(cell, column, row);
        uint32_t width = width_of(cell);
        uint32_t filled = column->width > width ? column->width - width : 0;
        blanks += column->is_left ? 0 : filled;
        if (cell[0] != '\0') {
            printf("%*s%s", (int)blanks, "", cell);
            blanks = 0;
        }
        blanks += (column->is_left ? filled : 0) + 1;
    }
    printf("%s\n", row == NULL ? terminal_end() : "");
}

/* Take what has been shown out of a table, but for the column of rank 1. Returns whether
 * there was such a column, and another one is left. */
static bool drop_shown(struct column *columns)
{
    bool was_shown = false, is_left = false;
    for (struct column *column = columns; !is_last(column); column++) {
        if (column->rank > 1) {
            was_shown = was_shown || !column->is_hidden;
            is_left = is_left || (column->is_hidden && column->width > 0);
            column->rank = column->is_hidden ? column->rank : 0;
        }
    }
    return was_shown && is_left;
}

void columns_table(const struct column *columns, const void *rows, size_t row_bytes,
                   uint32_t count, bool continues)
{
    struct column shown[COLUMNS_MAX];
    uint32_t column_count = 0;
    while (!is_last(&columns[column_count++])) {
    }
    memcpy(shown, columns, column_count * sizeof *shown);
    do {
        columns_fit(shown, rows, row_bytes, count, room_of(stdout));
        print_row(shown, NULL);
        for (uint32_t i = 0; i < count; i++) {
            print_row(shown, (const char *)rows + i * row_bytes);
        }
    } while (continues && drop_shown(shown) && putchar('\n') != EOF);
}

/* ---- for programs ------------------------------------------------------------------ */

static json_t *value_of(const struct column *column, const void *row)
{
    char exact[40];
    switch (column->type) {
    case COLUMN_NS:
        return json_real((double)number_at(column, row) / 1e6);
    case COLUMN_REAL:
    case COLUMN_REAL_1:
    case COLUMN_REAL_3:
    case COLUMN_RATE:
        return isfinite(real_at(column, row)) ? json_real(real_at(column, row))
                                              : json_null();
    case COLUMN_EXACT:
        snprintf(exact, sizeof exact, "%a", real_at(column, row));
        return json_string(exact);
    case COLUMN_FLAG:
        return json_boolean(*(const bool *)((const char *)row + column->at));
    case COLUMN_TEXT:
    case COLUMN_CHARS:
        return text_at(column, row) != NULL ? json_text(text_at(column, row))
                                            : json_null();
    case COLUMN_JSON:
        return *(json_t *const *)(const void *)((const char *)row + column->at);
    default:
        return json_integer((json_int_t)number_at(column, row));
    }
}

bool columns_add(json_t *object, const struct column *columns, const void *row)
{
    bool ok = true;
    for (const struct column *column = columns; !is_last(column); column++) {
        if (column->json != NULL) {
            ok = json_object_set_new(object, column->json, value_of(column, row)) == 0 &&
                 ok; /* each value is given back, also behind a failure */
        }
    }
    return ok;
}

json_t *columns_json(const struct column *columns, const void *row)
{
    json_t *object = json_object();
    if (!columns_add(object, columns, row)) {
        json_decref(object);
        return NULL;
    }
    return object;
}

static bool read_number(const struct column *column, const json_t *value, void *at)
{
    uint64_t wide = (uint64_t)json_integer_value(value);
    uint32_t middle = (uint32_t)wide;
    uint8_t narrow = (uint8_t)wide;
    switch (column->bytes) {
    case sizeof wide:
        memcpy(at, &wide, sizeof wide);
        return json_is_integer(value);
    case sizeof middle:
        memcpy(at, &middle, sizeof middle);
        return json_is_integer(value) && middle == wide;
    default:
        memcpy(at, &narrow, sizeof narrow);
        return json_is_integer(value) && narrow <= 1 && narrow == wide;
    }
}

static bool read_exact(const json_t *value, double *to)
{
    const char *text = json_string_value(value);
    char *end = NULL;
    *to = text != NULL ? strtod(text, &end) : 0;
    return text != NULL && end != text && *end == '\0';
}

bool columns_read(const json_t *object, const struct column *columns, void *row)
{
    bool ok = true;
    for (const struct column *column = columns; !is_last(column) && ok; column++) {
        const json_t *value = json_object_get(object, column->json);
        void *at = (char *)row + column->at;
        if (column->type == COLUMN_EXACT) {
            ok = read_exact(value, at);
        } else if (column->type == COLUMN_FLAG) {
            *(bool *)at = json_is_true(value);
            ok = json_is_boolean(value);
        } else if (column->type == COLUMN_REAL) {
            *(double *)at = json_real_value(value);
            ok = json_is_real(value);
        } else if (column->type == COLUMN_CHARS) {
            const char *text = json_string_value(value);
            snprintf(at, column->bytes, "%s", text != NULL ? text : "");
            ok = text != NULL;
        } else {
            ok = read_number(column, value, at);
        }
    }
    return ok;
}
