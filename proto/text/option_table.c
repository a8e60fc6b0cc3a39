/* option_table.c - options from tables. */
#include "option_table.h"

#include <ctype.h>
#include <errno.h>
#include <inttypes.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include "printable.h"

#define KEY_BASE      0x100 /* of options without a letter */
#define MESSAGE_BYTES 4096u

void option_misused(const struct argp_state *state, const char *format, ...)
{
    char text[MESSAGE_BYTES], shown[MESSAGE_BYTES];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    proto_printable(text, strlen(text), shown, sizeof shown);
    argp_error(state, "%s", shown);
}

/* ---- values ------------------------------------------------------------------------ */

uint64_t option_number(const struct argp_state *state, const struct option_row *row,
                       const char *text)
{
    uint64_t min = (uint64_t)row->min, max = (uint64_t)row->max;
    char *stop;
    errno = 0;
    /* strtoull takes a minus sign; only digits are meant here. */
    unsigned long long value = strtoull(text, &stop, 10);
    if (text[0] < '0' || text[0] > '9' || *stop != '\0' || errno != 0 || value < min ||
        value > max) {
        option_misused(state,
                       "--%s: \"%s\" is not a whole number from %" PRIu64 " to %" PRIu64,
                       row->name, text, min, max);
    }
    return value;
}

double option_real(const struct argp_state *state, const struct option_row *row,
                   const char *text)
{
    char *stop;
    double value = strtod(text, &stop);
    if (stop == text || *stop != '\0' || !(value >= row->min && value <= row->max)) {
        option_misused(state, "--%s: \"%s\" is not a number from %Lg to %Lg", row->name,
                       text, row->min, row->max);
    }
    return value;
}

size_t option_words(const char *arg, const char **words)
{
    if (arg == NULL || strchr(arg, '|') == NULL) {
        return 0;
    }
    *words = arg + (arg[0] == '[');
    return strcspn(*words, "] ");
}

uint32_t option_word(const struct argp_state *state, const char *name, const char *text,
                     size_t bytes, const char *words)
{
    char list[256] = "";
    size_t used = 0;
    uint32_t place = 0;
    for (const char *word = words; *word != '\0'; place++) {
        size_t length = strcspn(word, "|");
        if (length == bytes && strncmp(word, text, bytes) == 0) {
            return place;
        }
        used += (size_t)snprintf(list + used, used < sizeof list ? sizeof list - used : 0,
                                 "%s%.*s", place > 0 ? ", " : "", (int)length, word);
        word += length + (word[length] == '|');
    }
    option_misused(state, "%s%s%s\"%.*s\" is none of %s", name != NULL ? "--" : "",
                   name != NULL ? name : "", name != NULL ? ": " : "", (int)bytes, text,
                   list);
    return 0;
}

static void take(struct argp_state *state, const struct option_row *row, const char *text,
                 void *to)
{
    void *at = (char *)to + row->at;
    uint64_t unit = row->unit != 0 ? row->unit : 1;
    switch (row->type) {
    case OPTION_FLAG:
        *(bool *)at = true;
        return;
    case OPTION_U32:
        *(uint32_t *)at = (uint32_t)(option_number(state, row, text) * unit);
        return;
    case OPTION_U64:
        *(uint64_t *)at = option_number(state, row, text) * unit;
        return;
    case OPTION_REAL:
        *(double *)at = option_real(state, row, text);
        return;
    case OPTION_TEXT:
        *(const char **)at = text;
        return;
    case OPTION_WORD:
        *(uint32_t *)at = (uint32_t)row->min +
                          option_word(state, row->name, text, strlen(text), row->arg);
        return;
    default:
        row->take(state, row, text, to);
        return;
    }
}

/* ---- tables as one list ------------------------------------------------------------ */

static bool is_last(const struct option_row *row)
{
    return row->name == NULL && row->help == NULL && row->type != OPTION_ARGUMENTS;
}

/* A row, its table's struct, and the heading that it stands under. */
struct place {
    const struct option_row *row;
    void *to;
    int group;
};

struct parsing {
    const struct option_table *table;
    void *to;
    struct place *places;
    struct argp_option *options;
    size_t count;
};

/* Rows of a table and its parts. They nest as they are written, a few deep. */
static size_t count_rows(const struct option_table *table)
{
    size_t count = 0;
    for (const struct option_row *row = table->rows; row && !is_last(row); row++) {
        count++;
    }
    for (const struct option_part *part = table->parts; part && part->table; part++) {
        count += count_rows(part->table);
    }
    return count;
}

/* Each table begins without a heading. */
static void add_rows(struct parsing *parsing, const struct option_table *table, void *to)
{
    int group = 0;
    for (const struct option_row *row = table->rows; row && !is_last(row); row++) {
        group = row->type == OPTION_HEADING ? (int)row->at : group;
        parsing->places[parsing->count++] = (struct place){row, to, group};
    }
    for (const struct option_part *part = table->parts; part && part->table; part++) {
        add_rows(parsing, part->table, (char *)to + part->at);
    }
}

static int key_of(const struct parsing *parsing, size_t index)
{
    const struct option_row *row = parsing->places[index].row;
    return row->letter != 0 ? row->letter : KEY_BASE + (int)index;
}

static bool has_heading(const struct parsing *parsing, size_t before, int group)
{
    for (size_t i = 0; i < before; i++) {
        const struct place *place = &parsing->places[i];
        if (place->row->type == OPTION_HEADING && place->group == group) {
            return true;
        }
    }
    return false;
}

/* As argp wants them; a heading that is there already leaves nothing. */
static void list_options(struct parsing *parsing)
{
    size_t used = 0;
    for (size_t i = 0; i < parsing->count; i++) {
        const struct place *place = &parsing->places[i];
        const struct option_row *row = place->row;
        bool is_again = has_heading(parsing, i, place->group);
        if (row->name != NULL || (row->type == OPTION_HEADING && !is_again)) {
            parsing->options[used++] =
                (struct argp_option){.name = row->name,
                                     .key = row->name != NULL ? key_of(parsing, i) : 0,
                                     .arg = row->arg,
                                     .doc = row->help,
                                     .group = place->group};
        }
    }
    parsing->options[used] =
        (struct argp_option){.key = 'h', .flags = OPTION_HIDDEN, .group = -1};
}

/* ---- the walk of argp -------------------------------------------------------------- */

static void take_arguments(const struct parsing *parsing, const struct argp_state *state)
{
    for (size_t i = 0; i < parsing->count; i++) {
        const struct place *place = &parsing->places[i];
        if (place->row->type == OPTION_ARGUMENTS) {
            struct option_arguments *arguments =
                (void *)((char *)place->to + place->row->at);
            arguments->list = state->argv + state->next;
            arguments->count = (uint32_t)(state->argc - state->next);
            return;
        }
    }
    option_misused(state, "there are no arguments, only options: \"%s\"",
                   state->argv[state->next]);
}

static void check_needed(const struct parsing *parsing, const struct argp_state *state)
{
    for (size_t i = 0; i < parsing->count; i++) {
        const struct option_row *row = parsing->places[i].row;
        const void *at = (const char *)parsing->places[i].to + row->at;
        if (row->needed != NULL &&
            (row->type == OPTION_ARGUMENTS
                 ? ((const struct option_arguments *)at)->count == 0
                 : *(const char *const *)at == NULL)) {
            option_misused(state, "%s", row->needed);
        }
    }
}

static void check_tables(const struct option_table *table, struct argp_state *state,
                         void *to)
{
    for (const struct option_part *part = table->parts; part && part->table; part++) {
        check_tables(part->table, state, (char *)to + part->at);
    }
    if (table->check != NULL) {
        table->check(state, to);
    }
}

static error_t parse(int key, char *text, struct argp_state *state)
{
    const struct parsing *parsing = state->input;
    switch (key) {
    case ARGP_KEY_ARGS:
        take_arguments(parsing, state);
        return 0;
    case ARGP_KEY_END:
        check_needed(parsing, state);
        check_tables(parsing->table, state, parsing->to);
        return 0;
    default:
        break;
    }
    for (size_t i = 0; i < parsing->count; i++) {
        const struct place *place = &parsing->places[i];
        if (place->row->name != NULL && key == key_of(parsing, i)) {
            take(state, place->row, text, place->to);
            return 0;
        }
    }
    if (key == 'h') {
        argp_state_help(state, stdout, ARGP_HELP_STD_HELP);
        return 0;
    }
    return ARGP_ERR_UNKNOWN;
}

/* Write what a command does, and behind the options the rest and the examples; NULL:
 * there is no memory. */
static char *describe(const struct option_table *table)
{
    const char *more = table->more != NULL ? table->more : "";
    const char *examples = table->examples != NULL ? table->examples : "";
    char *doc = NULL;
    int bytes = asprintf(&doc, "%s%s%s%s%s", table->text,
                         more[0] != '\0' || examples[0] != '\0' ? "\v" : "", more,
                         examples[0] == '\0' ? ""
                         : more[0] != '\0'   ? "\n\nExamples:\n"
                                             : "Examples:\n",
                         examples);
    return bytes < 0 ? NULL : doc;
}

int option_parse(const struct option_table *table, int argc, char **argv, void *to)
{
    struct parsing parsing = {.table = table, .to = to};
    size_t rows = count_rows(table);
    char *doc = describe(table);
    int status = ENOMEM;
    parsing.places = calloc(rows + 1, sizeof *parsing.places);
    parsing.options = calloc(rows + 2, sizeof *parsing.options);
    if (doc != NULL && parsing.places != NULL && parsing.options != NULL) {
        add_rows(&parsing, table, to);
        list_options(&parsing);
        const struct argp argp = {.options = parsing.options,
                                  .parser = parse,
                                  .args_doc = table->arguments,
                                  .doc = doc};
        status = argp_parse(&argp, argc, argv, table->ends_options ? ARGP_IN_ORDER : 0,
                            NULL, &parsing);
    }
    free(parsing.options);
    free(parsing.places);
    free(doc);
    return status;
}

/* ---- for those who tell of options ------------------------------------------------- */

void option_each(const struct option_table *table, option_visit visit, void *context)
{
    for (const struct option_row *row = table->rows; row && !is_last(row); row++) {
        if (row->name != NULL) {
            visit(context, row);
        }
    }
    for (const struct option_part *part = table->parts; part && part->table; part++) {
        option_each(part->table, visit, context);
    }
}

/* "a|b|[c] FILE\nFRAME": names in italics, words in bold, and what stands on lines of its
 * own with a bar between. */
static void print_arguments(FILE *to, const char *arguments)
{
    for (const char *at = arguments; *at != '\0';) {
        size_t bytes = strcspn(at, "[]|. \n");
        const char *mark = isupper((unsigned char)at[0]) ? "_" : "*";
        if (bytes > 0) {
            fprintf(to, "%s%.*s%s", mark, (int)bytes, at, mark);
        } else {
            fputs(*at == '\n' ? " | " : (char[]){*at, '\0'}, to);
        }
        at += bytes > 0 ? bytes : 1;
    }
}

static void print_option(void *context, const struct option_row *row)
{
    FILE *to = context;
    fputs(row->needed != NULL ? " " : " [", to);
    if (row->letter != 0) {
        fprintf(to, "*-%c*", row->letter);
    } else {
        fprintf(to, "*--%s*", row->name);
    }
    if (row->arg != NULL) {
        putc(' ', to);
        print_arguments(to, row->arg);
    }
    fputs(row->needed != NULL ? "" : "]", to);
}

static void print_table(FILE *to, const struct option_table *table)
{
    const struct option_table own = {.rows = table->rows};
    option_each(&own, print_option, to);
    for (const struct option_part *part = table->parts; part && part->table; part++) {
        if (part->table->name == NULL) {
            print_table(to, part->table);
        } else if (part->table->name[0] != '\0') {
            fprintf(to, " [_%s OPTION_...]", part->table->name);
        }
    }
}

void option_synopsis(FILE *to, const char *command, const struct option_table *table)
{
    fprintf(to, "*%s*", command);
    print_table(to, table);
    if (table->arguments != NULL) {
        putc(' ', to);
        print_arguments(to, table->arguments);
    }
}
