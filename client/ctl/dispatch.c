/* dispatch.c - the first word of a command line. */
#include "dispatch.h"

#include <argp.h>
#include <limits.h>
#include <stdio.h>
#include <string.h>

#include "ctl.h"
#include "option_table.h"
#include "terminal.h"

static void print_help(const struct ctl_program *program, FILE *to)
{
    if (program->is_mute) {
        return;
    }
    fputs(program->usage, to);
    for (size_t i = 0; i < program->command_count; i++) {
        const struct ctl_command *command = &program->commands[i];
        if (command->group != NULL) {
            fprintf(to, "%s%s:\n", i > 0 ? "\n" : "", command->group);
        }
        fprintf(to, "  %-10s %s\n", command->name, command->text);
    }
    fputs(program->ending, to);
}

static const struct ctl_command *find_command(const struct ctl_program *program,
                                              const char *name)
{
    for (size_t i = 0; i < program->command_count; i++) {
        if (strcmp(name, program->commands[i].name) == 0) {
            return &program->commands[i];
        }
    }
    return NULL;
}

static int complain_of(const struct ctl_program *program, const char *name)
{
    const char *nearest = name;
    unsigned least = UINT_MAX;
    for (size_t i = 0; i < program->command_count; i++) {
        unsigned edits = option_edits(name, program->commands[i].name);
        if (edits < least) {
            least = edits;
            nearest = program->commands[i].name;
        }
    }
    if (program->is_mute) {
        return CTL_USAGE;
    }
    (void)(option_is_near(name, least)
               ? ctl_complain("no command \"%s\"; %s?", name, nearest)
               : ctl_complain("no command \"%s\"; see %s --help", name, program->name));
    return CTL_USAGE;
}

static bool is_any(const char *word, const char *a, const char *b, const char *c)
{
    return strcmp(word, a) == 0 || strcmp(word, b) == 0 || strcmp(word, c) == 0;
}

/* argp wants to change the name in argv[0], so it gets a copy. */
static int run_command(const struct ctl_program *program,
                       const struct ctl_command *command, int argc, char **argv)
{
    char title[64];
    snprintf(title, sizeof title, "%s %s", program->name, command->name);
    argv[0] = title;
    int status = command->run(argc, argv);
    bool has_failed = fflush(stdout) != 0 || ferror(stdout) != 0;
    if (has_failed && !program->is_mute &&
        !terminal_has_no_reader()) { /* as head, who has seen enough */
        status = ctl_complain("cannot write to the standard output");
    }
    return status;
}

int ctl_dispatch(const struct ctl_program *program, const char *version, int argc,
                 char **argv)
{
    char help_option[] = "--help";
    char *help_arguments[] = {NULL, help_option, NULL};
    const struct ctl_command *command;
    argp_err_exit_status = CTL_USAGE;
    /* Set, not defined: a definition of our own would be hidden from the C library. */
    argp_program_version = version;
    if (argc < 2) {
        print_help(program, stderr);
        return CTL_USAGE;
    }
    if (is_any(argv[1], "-V", "--version", "--version")) {
        if (!program->is_mute) {
            puts(version);
        }
        return CTL_DONE;
    }
    if (is_any(argv[1], "help", "--help", "-h") || strcmp(argv[1], "-?") == 0) {
        command = argc > 2 ? find_command(program, argv[2]) : NULL;
        if (command != NULL) {
            return run_command(program, command, 2, help_arguments);
        }
        if (argc > 2) {
            return complain_of(program, argv[2]);
        }
        print_help(program, stdout);
        return CTL_DONE;
    }
    command = find_command(program, argv[1]);
    if (command == NULL) {
        return complain_of(program, argv[1]);
    }
    return run_command(program, command, argc - 1, argv + 1);
}
