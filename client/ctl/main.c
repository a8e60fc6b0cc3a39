/* client/ctl/main.c - pccdctl: ask a pccd daemon from the command line.
 *
 * Room:     client/ctl; the program.
 * Does:     finds the command in the manifest and runs it.
 * Does not: talk to a daemon; see cmd_*.c.
 * Threads:  one.
 * Source:   ctl.h.
 */
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ctl.h"
#include "pccd.h"
#include "terminal.h"

#define STRING_OF(number) #number
#define STRING(number)    STRING_OF(number)

static const char program_version[] = "pccdctl " STRING(PCCD_VERSION_MAJOR) "." STRING(
    PCCD_VERSION_MINOR) "." STRING(PCCD_VERSION_PATCH);

struct command {
    const char *name;
    const char *title; /* for messages: "pccdctl NAME" */
    int (*run)(int argc, char **argv);
    const char *text;
};

static const struct command commands[] = {
#define COMMAND(name, text) {#name, "pccdctl " #name, ctl_cmd_##name, text},
    CTL_COMMANDS(COMMAND)
#undef COMMAND
};
#define COMMAND_COUNT (sizeof commands / sizeof commands[0])

static void print_help(FILE *to)
{
    fputs("Usage: pccdctl COMMAND [OPTION...]\n"
          "Continuous collision detection of triangle meshes, by the daemon pccdd.\n\n",
          to);
    for (size_t i = 0; i < COMMAND_COUNT; i++) {
        fprintf(to, "  %-10s %s\n", commands[i].name, commands[i].text);
    }
    fputs("\n\"pccdctl COMMAND --help\" explains a command.\n"
          "Exit status: 0 when done; 1 when what was looked for is wrong; 2 after wrong\n"
          "usage; 3 without a daemon; 4 after any other error.\n",
          to);
}

static const struct command *find_command(const char *name)
{
    for (size_t i = 0; i < COMMAND_COUNT; i++) {
        if (strcmp(name, commands[i].name) == 0) {
            return &commands[i];
        }
    }
    return NULL;
}

static int complain_of(const char *name)
{
    (void)ctl_complain("no command \"%s\"; see pccdctl --help", name);
    return CTL_USAGE;
}

static bool is_any(const char *word, const char *a, const char *b, const char *c)
{
    return strcmp(word, a) == 0 || strcmp(word, b) == 0 || strcmp(word, c) == 0;
}

/* argp wants to change the name in argv[0], so it gets a copy. */
static int run_command(const struct command *command, int argc, char **argv)
{
    char title[64];
    snprintf(title, sizeof title, "%s", command->title);
    argv[0] = title;
    int status = command->run(argc, argv);
    bool has_failed = fflush(stdout) != 0 || ferror(stdout) != 0;
    if (has_failed && !terminal_has_no_reader()) { /* as head, who has seen enough */
        status = ctl_complain("cannot write to the standard output");
    }
    return status;
}

int main(int argc, char **argv)
{
    char help_option[] = "--help";
    char *help_arguments[] = {NULL, help_option, NULL};
    const struct command *command;
    argp_err_exit_status = CTL_USAGE;
    /* Set, not defined: a definition of our own would be hidden from the C library. */
    argp_program_version = program_version;
    if (argc < 2) {
        print_help(stderr);
        return CTL_USAGE;
    }
    if (is_any(argv[1], "-V", "--version", "--version")) {
        puts(program_version);
        return CTL_DONE;
    }
    if (is_any(argv[1], "help", "--help", "-h") || strcmp(argv[1], "-?") == 0) {
        command = argc > 2 ? find_command(argv[2]) : NULL;
        if (command != NULL) {
            return run_command(command, 2, help_arguments);
        }
        if (argc > 2) {
            return complain_of(argv[2]);
        }
        print_help(stdout);
        return CTL_DONE;
    }
    command = find_command(argv[1]);
    if (command == NULL) {
        return complain_of(argv[1]);
    }
    return run_command(command, argc - 1, argv + 1);
}
