/* dispatch.h - finds the command of a program and runs it.
 *
 * Do for pccdctl and pccd-mpi what comes before the command: help, version, and a name
 * that there is not; and see that all that was printed has gone out.
 */
#ifndef CTL_DISPATCH_H
#define CTL_DISPATCH_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

#include "option_table.h"
#include "pccd.h" /* the version */

struct ctl_command {
    const char *name;
    const char *text;
    const char *group; /* that it begins, in the help; NULL: none */
    /* argv[0] is "pccdctl NAME", for messages; returns an exit status. */
    int (*run)(int argc, char **argv);
    const struct option_table *table;
};

struct ctl_program {
    const char *name;
    const char *usage;  /* what --help begins with, up to the list of commands */
    const char *ending; /* what comes behind the list */
    const struct ctl_command *commands;
    size_t command_count;
    bool is_mute; /* of its own it prints nothing: another rank of an MPI program does */
};

/* The library's version, which is the program's: "NAME 1.2.3". */
#define CTL_STRING_OF(number) #number
#define CTL_STRING(number)    CTL_STRING_OF(number)
#define CTL_PROGRAM_VERSION(name)                                                        \
    name " " CTL_STRING(PCCD_VERSION_MAJOR) "." CTL_STRING(                              \
        PCCD_VERSION_MINOR) "." CTL_STRING(PCCD_VERSION_PATCH)

/* Run what the command line names. `version` is CTL_PROGRAM_VERSION. Returns the exit
 * status, one of enum ctl_exit. */
int ctl_dispatch(const struct ctl_program *program, const char *version, int argc,
                 char **argv);

/* ---- Completes the commands and options of a program in a shell. */

/* The shell, or "synopsis" for that of a manual page: a struct option_arguments. */
extern const struct option_table completion_table;
/* The table of the command "completion" of a program. */
#define CTL_COMPLETION_TABLE(program)                                                    \
    {                                                                                    \
        .parts = (const struct option_part[]){{&completion_table, 0}, {0}},              \
        .arguments = "bash|zsh|fish",                                                    \
        .text =                                                                          \
            "Print what a shell needs to complete the commands and options of " program  \
            ".",                                                                         \
        .more = "make install puts it where the shells look. In a shell by hand:\n"      \
                "  source <(" program " completion bash)",                               \
        .examples =                                                                      \
            "  " program " completion bash >/etc/bash_completion.d/" program "\n"        \
            "  " program " completion zsh >~/.zfunc/_" program "\n"                      \
    }
/* Run the command "completion": print what the shell that the arguments name needs.
 * Returns an exit status. */
int completion_command(const struct ctl_program *program,
                       const struct option_table *table, int argc, char **argv);

#endif
