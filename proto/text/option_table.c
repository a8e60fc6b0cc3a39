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

static const char *place_now; /* NULL: the command line */

void option_set_place(const char *place)
{
    place_now = place;
}

void option_misused(const struct argp_state *state, const char *format, ...)
{
    char text[MESSAGE_BYTES], shown[MESSAGE_BYTES];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    proto_printable(text, strlen(text), shown, sizeof shown);
    if (place_now != NULL) { /* no word of the command line's help */
        fprintf(stderr, "%s: %s: %s\n", program_invocation_short_name, place_now, shown);
        exit(argp_err_exit_status);
    }
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
    return value + 0.0; /* -0 is 0 */
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

void option_add_text(const struct argp_state *state, struct option_arguments *texts,
                     const char *text)
{
    char **list = realloc(texts->list, (texts->count + (size_t)1) * sizeof *list);
    if (list == NULL) {
        option_misused(state, "out of memory");
        return;
    }
    texts->list = list;
    list[texts->count++] = (char *)(uintptr_t)text;
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
    case OPTION_TEXTS:
        option_add_text(state, at, text);
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
    parsing->options[used + 1] = (struct argp_option){
        .name = "help", .key = '?', .flags = OPTION_HIDDEN, .group = -1};
}

/* ---- the help text ----------------------------------------------------------------- */

/* argp's own lines lose their indentation, or get that of another one, where its buffer
 * of 200 bytes happens to be full (glibc 2.36 to 2.41). */

#define COLUMNS    79u
#define TEXT_BEGIN 29u /* the column of what is said of an option */

/* Write words from `column` on, further lines from `begin`. A line that begins with
 * blanks stays as it is. */
static void write_text(const char *text, size_t column, size_t begin)
{
    bool is_first = true;
    while (*text != '\0') {
        bool is_kept = is_first && *text == ' ';
        size_t length = strcspn(text, is_kept ? "\n" : " \n");
        if (!is_first && column + 1 + length > COLUMNS) {
            printf("\n%*s", (int)begin, "");
            column = begin;
        } else if (!is_first && length > 0) {
            putchar(' ');
            column++;
        }
        fwrite(text, 1, length, stdout);
        column += length;
        is_first = false;
        text += length;
        if (*text == '\n') {
            column = (size_t)printf("\n%*s", text[1] != '\0' ? (int)begin : 0, "") - 1;
            is_first = true;
            text++;
        } else if (*text == ' ') {
            text++;
        }
    }
}

static void write_option(char letter, const char *name, const char *arg, const char *help)
{
    char start[] = "      ";
    if (letter != 0) {
        snprintf(start, sizeof start, "  -%c,", letter);
    }
    int column = printf("%-6s--%s%s%s", start, name, arg != NULL ? "=" : "",
                        arg != NULL ? arg : "");
    if (column + 2 > (int)TEXT_BEGIN) {
        putchar('\n');
        column = 0;
    }
    printf("%*s", (int)TEXT_BEGIN - column, "");
    write_text(help, TEXT_BEGIN, TEXT_BEGIN);
    putchar('\n');
}

/* By heading, then by letter or name. */
static int compare_places(const void *a, const void *b)
{
    const struct place *const places[2] = {a, b};
    char first[2];
    if (places[0]->group != places[1]->group) {
        return places[0]->group - places[1]->group;
    }
    for (int i = 0; i < 2; i++) {
        const struct option_row *row = places[i]->row;
        if (row->name == NULL) {
            return i == 0 ? -1 : places[0]->row->name == NULL ? 0 : 1;
        }
        first[i] = (char)tolower((unsigned char)(row->letter ? row->letter : *row->name));
    }
    return first[0] != first[1] ? first[0] - first[1]
                                : strcmp(places[0]->row->name, places[1]->row->name);
}

static void write_usage(const char *program, const char *arguments)
{
    const char *at = arguments != NULL ? arguments : "";
    const char *begin = "Usage:";
    do {
        size_t length = strcspn(at, "\n");
        printf("%s %s [OPTION...]%s%.*s\n", begin, program, length > 0 ? " " : "",
               (int)length, at);
        at += length + (at[length] == '\n');
        begin = "  or: ";
    } while (*at != '\0');
}

/* Sorts the places: whoever parses is done. */
static void write_help(const struct parsing *parsing, const char *program)
{
    const struct option_table *table = parsing->table;
    int group = -1;
    write_usage(program, table->arguments);
    write_text(table->text, 0, 0);
    printf("%s", table->text[strlen(table->text) - 1] == '\n' ? "" : "\n");
    qsort(parsing->places, parsing->count, sizeof *parsing->places, compare_places);
    for (size_t i = 0; i < parsing->count; i++) {
        const struct option_row *row = parsing->places[i].row;
        if (row->type == OPTION_ARGUMENTS) {
            continue;
        }
        bool is_new = parsing->places[i].group != group;
        group = parsing->places[i].group;
        if (is_new) {
            putchar('\n');
        }
        if (row->type == OPTION_HEADING && is_new) {
            putchar(' ');
            write_text(row->help, 1, 1);
            putchar('\n');
        } else if (row->name != NULL) {
            write_option(row->letter, row->name, row->arg, row->help);
        }
    }
    putchar('\n');
    write_option('?', "help", NULL, "Give this help list");
    write_option(0, "usage", NULL, "Give a short usage message");
    if (argp_program_version != NULL) {
        write_option('V', "version", NULL, "Print program version");
    }
    for (int i = 0; i < 2; i++) {
        const char *text = i == 0 ? table->more : table->examples;
        if (text != NULL && text[0] != '\0') {
            printf("\n%s", i == 0 ? "" : "Examples:\n");
            write_text(text, 0, 0);
            printf("%s", text[strlen(text) - 1] == '\n' ? "" : "\n");
        }
    }
}

/* ---- what may have been meant ------------------------------------------------------ */

#define WORD_MAX 64u

unsigned option_edits(const char *a, const char *b)
{
    unsigned edits[WORD_MAX + 1]; /* from the beginning of a to that much of b */
    size_t lengths[2] = {strlen(a), strlen(b)};
    if (lengths[0] > WORD_MAX || lengths[1] > WORD_MAX) {
        return WORD_MAX;
    }
    for (unsigned k = 0; k <= lengths[1]; k++) {
        edits[k] = k;
    }
    for (size_t i = 0; i < lengths[0]; i++) {
        unsigned before = edits[0]++;
        for (size_t k = 0; k < lengths[1]; k++) {
            unsigned least = before + (a[i] != b[k]);
            least = least < edits[k] + 1 ? least : edits[k] + 1;
            before = edits[k + 1];
            edits[k + 1] = least < before + 1 ? least : before + 1;
        }
    }
    return edits[lengths[1]];
}

bool option_is_near(const char *word, unsigned edits)
{
    return edits <= 1 + strlen(word) / 4;
}

/* Say which option may be meant by "--NAME" or "--NAME=VALUE" if there is none that it is
 * the beginning of. */
static void suggest(const struct parsing *parsing, const struct argp_state *state,
                    const char *text)
{
    static const char *const own[] = {"usage", "version"}; /* argp's own */
    char name[WORD_MAX];
    size_t length = strcspn(text, "=");
    const char *nearest = NULL;
    unsigned least = WORD_MAX;
    if (length >= sizeof name) {
        return;
    }
    memcpy(name, text, length);
    name[length] = '\0';
    for (size_t i = 0; i < sizeof own / sizeof own[0]; i++) {
        if (strncmp(name, own[i], length) == 0) {
            return;
        }
    }
    for (const struct argp_option *option = parsing->options;
         option->name != NULL || option->key != 0 || option->doc != NULL; option++) {
        if (option->name == NULL) {
            continue;
        }
        unsigned edits = option_edits(name, option->name);
        if (strncmp(name, option->name, length) == 0) {
            return;
        }
        if (edits < least) {
            least = edits;
            nearest = option->name;
        }
    }
    if (option_is_near(name, least)) {
        option_misused(state, "--%s: no such option; --%s?", name, nearest);
    }
}

/* Return whether a word may be an option, or its beginning, whose value is the next
 * word. */
static bool takes_next(const struct parsing *parsing, const char *word)
{
    if (word[0] != '-' || word[1] == '\0') {
        return false;
    }
    for (const struct argp_option *option = parsing->options;
         option->name != NULL || option->key != 0 || option->doc != NULL; option++) {
        bool may_be = word[1] == '-'
                          ? option->name != NULL &&
                                strncmp(word + 2, option->name, strlen(word + 2)) == 0
                          : word[1] == option->key && word[2] == '\0';
        if (may_be && option->arg != NULL) {
            return true;
        }
    }
    return false;
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

/* Look at each word that is an option's name, before getopt does: it suggests nothing. */
static void look_at_names(const struct parsing *parsing, struct argp_state *state)
{
    char *slash = strrchr(state->argv[0], '/');
    state->name = slash != NULL ? slash + 1 : state->argv[0]; /* as argp will, later */
    for (int i = 1; i < state->argc && strcmp(state->argv[i], "--") != 0; i++) {
        const char *word = state->argv[i];
        if (strncmp(word, "--", 2) == 0 && !takes_next(parsing, state->argv[i - 1])) {
            suggest(parsing, state, word + 2);
        } else if (word[0] != '-' && parsing->table->ends_options &&
                   !takes_next(parsing, state->argv[i - 1])) {
            return;
        }
    }
}

static error_t parse(int key, char *text, struct argp_state *state)
{
    const struct parsing *parsing = state->input;
    switch (key) {
    case ARGP_KEY_INIT:
        look_at_names(parsing, state);
        return 0;
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
    if (key == 'h' || key == '?') {
        write_help(parsing, state->name);
        exit(fflush(stdout) != 0);
    }
    return ARGP_ERR_UNKNOWN;
}

int option_parse(const struct option_table *table, int argc, char **argv, void *to)
{
    struct parsing parsing = {.table = table, .to = to};
    size_t rows = count_rows(table);
    int status = ENOMEM;
    parsing.places = calloc(rows + 1, sizeof *parsing.places);
    parsing.options = calloc(rows + 3, sizeof *parsing.options);
    if (parsing.places != NULL && parsing.options != NULL) {
        add_rows(&parsing, table, to);
        list_options(&parsing);
        const struct argp argp = {
            .options = parsing.options, .parser = parse, .args_doc = table->arguments};
        status = argp_parse(&argp, argc, argv, table->ends_options ? ARGP_IN_ORDER : 0,
                            NULL, &parsing);
    }
    free(parsing.options);
    free(parsing.places);
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
