/* client/ctl/completion.h - completes the commands and options of a program in a shell.
 *
 * Room:     client/ctl. May include: the C library.
 * Does:     walk the table of commands and their tables of options, which also make
 *           --help, and write them as a script for a shell.
 * Does not: name a command or an option itself.
 * Threads:  one.
 * Source:   an option's argument "a|b|c" is one of those words; FILE, PATH, PROGRAM and
 *           MESH are names of files; others are the user's own. So it is for arguments.
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
