/* option_table.h - options as rows of tables, for argp, shells and manual pages. */
#ifndef PROTO_OPTION_TABLE_H
#define PROTO_OPTION_TABLE_H

#include <argp.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

/* The type of an option, and of what lies where its value goes. */
enum option_type {
    OPTION_HEADING,   /* no option: `help` stands above those that follow; headings are
                       * sorted by `at`, and one that comes again goes on */
    OPTION_ARGUMENTS, /* no option: struct option_arguments */
    OPTION_FLAG,      /* bool, which becomes true */
    OPTION_U32,       /* uint32_t, or an int that is not negative */
    OPTION_U64,       /* uint64_t */
    OPTION_REAL,      /* double */
    OPTION_TEXT,      /* const char * */
    OPTION_TEXTS,     /* struct option_arguments, whose list is ours to free: each text */
    OPTION_WORD,      /* uint32_t or an enum: `min` and the place of the word in `arg` */
    OPTION_OWN        /* what `take` does with it */
};

struct option_row;
/* Take the value of an option to `to`, the struct of its table. */
typedef void (*option_take)(struct argp_state *state, const struct option_row *row,
                            const char *text, void *to);

struct option_row {
    const char *name; /* after "--" */
    char letter;      /* after "-"; 0: none */
    /* Its value in the help text, "a|b|c" if it is one of these words; NULL: it has
     * none. */
    const char *arg;
    const char *help; /* what is asked for by it, with the default */
    enum option_type type;
    size_t at;            /* in the struct of the table */
    long double min, max; /* of numbers: exact for 64 bits */
    uint64_t unit;        /* what is stored for 1, of numbers; 0: 1 */
    option_take take;
    const char *needed; /* what is said if a text, or every argument, is missing */
};

/* The arguments of a command: what is left of argv; or the texts of an option. */
struct option_arguments {
    char **list;
    uint32_t count;
};

struct option_table;
/* A table that is part of another one, and where its struct lies in the other's. */
struct option_part {
    const struct option_table *table;
    size_t at;
};

struct option_table {
    const struct option_row *rows;   /* up to one that is all zeros */
    const struct option_part *parts; /* up to one that is all zeros; NULL: none */
    /* Once all is parsed, parts first: end the program if options contradict each other.
     * NULL: they cannot. */
    void (*check)(struct argp_state *state, void *to);
    /* Of a part, in a synopsis: [_NAME OPTION_...]; NULL: each option is named. */
    const char *name;

    /* Of a command: */
    const char *arguments; /* such as "FILE..."; NULL: none */
    bool ends_options;    /* the first argument does: what follows is another program's */
    const char *text;     /* what it does */
    const char *more;     /* behind the options; NULL: nothing */
    const char *examples; /* command lines, each with a newline; NULL: none */
};

/* Read a command line into `to`, which has the defaults. Wrong usage and --help end the
 * program. Returns 0, or an errno: there was no memory. */
int option_parse(const struct option_table *table, int argc, char **argv, void *to);

/* ---- For `take` and `check`: each ends the program if the text is wrong. */

/* Say what is wrong with an option or argument; what could control a terminal is written
 * as \xNN. */
void option_misused(const struct argp_state *state, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
/* Say of what follows where it stands, such as "pccdd.conf:3"; NULL: on the command line.
 * The text is the caller's. */
void option_set_place(const char *place);
/* Return a number in the row's range. */
uint64_t option_number(const struct argp_state *state, const struct option_row *row,
                       const char *text);
double option_real(const struct argp_state *state, const struct option_row *row,
                   const char *text);
/* Add a text, as OPTION_TEXTS does. */
void option_add_text(const struct argp_state *state, struct option_arguments *texts,
                     const char *text);
/* Return the place of the text, of so many bytes, among words "a|b|c". `name` is the
 * option's; NULL: it is an argument. */
uint32_t option_word(const struct argp_state *state, const char *name, const char *text,
                     size_t bytes, const char *words);

/* ---- For those who say what may have been meant. */

/* Return how many letters have to be changed, added or taken away to make one word the
 * other (Levenshtein); words of more than 64 bytes have nothing in common: 64. */
unsigned option_edits(const char *a, const char *b);
/* Return whether a word with so many mistakes may be meant. */
bool option_is_near(const char *word, unsigned edits);

/* ---- For those who tell of options. */

/* Call it for each option, those of the parts last. */
typedef void (*option_visit)(void *context, const struct option_row *row);
void option_each(const struct option_table *table, option_visit visit, void *context);
/* Return how many bytes of "[a|b|c] NAME" are the words that may stand there, and where
 * they begin; 0: there are none. */
size_t option_words(const char *arg, const char **words);
/* Write the line of a command in the synopsis of a manual page, as scdoc takes it. */
void option_synopsis(FILE *to, const char *command, const struct option_table *table);

#endif
