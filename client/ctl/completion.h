/* completion.h - completes the commands and options of a program in a shell.
 *
 * Threads: one.
 */
#ifndef CTL_COMPLETION_H
#define CTL_COMPLETION_H

#include <argp.h>
#include <stddef.h>
#include <stdio.h>

/* A command: its name, what it does, and its options. */
struct completion_row {
    const char *name;
    const char *text;
    const struct argp *argp;
};

struct completion {
    const char *program;
    const struct completion_row *rows;
    size_t row_count;
};

/* The command "completion" of a program, whose table of options has this parser, and
 * "bash|zsh|fish" as its argument. Returns an exit status. */
error_t completion_parse(int key, char *text, struct argp_state *state);
int completion_command(const struct completion *of, const struct argp *argp, int argc,
                       char **argv);

#endif
