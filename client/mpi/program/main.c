/* main.c - pccd-mpi: one scene over the ranks of an MPI program.
 *
 * Room:     client/mpi/program; the program.
 * Does:     starts MPI, finds the command and runs it on all ranks.
 * Threads:  one; those of OpenMP within a step do not call MPI.
 * Source:   commands.h.
 */
#include <argp.h>
#include <mpi.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "commands.h"
#include "ctl.h"
#include "pccd.h"
#include "together.h"

#define STRING_OF(number) #number
#define STRING(number)    STRING_OF(number)

static const char program_version[] = "pccd-mpi " STRING(PCCD_VERSION_MAJOR) "." STRING(
    PCCD_VERSION_MINOR) "." STRING(PCCD_VERSION_PATCH);

struct command {
    const char *name;
    const char *title; /* for messages: "pccd-mpi NAME" */
    int (*run)(int argc, char **argv);
    const char *text;
};

static const struct command commands[] = {
#define COMMAND(name, text) {#name, "pccd-mpi " #name, program_##name, text},
    PROGRAM_COMMANDS(COMMAND)
#undef COMMAND
};
#define COMMAND_COUNT (sizeof commands / sizeof commands[0])

static void print_help(FILE *to)
{
    fputs(
        "Usage: mpirun -n RANKS pccd-mpi COMMAND [OPTION...]\n"
        "Continuous collision detection of one scene by the ranks of an MPI program.\n\n",
        to);
    for (size_t i = 0; i < COMMAND_COUNT; i++) {
        fprintf(to, "  %-10s %s\n", commands[i].name, commands[i].text);
    }
    fputs("\n\"pccd-mpi COMMAND --help\" explains a command.\n"
          "Exit status: 0 when done; 1 when what was looked for is wrong; 2 after wrong\n"
          "usage; 4 after any other error.\n",
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

static bool is_any(const char *word, const char *a, const char *b)
{
    return strcmp(word, a) == 0 || strcmp(word, b) == 0;
}

static int run(int argc, char **argv)
{
    FILE *to = together_is_root() ? stdout : NULL;
    const struct command *command = argc < 2 ? NULL : find_command(argv[1]);
    if (command != NULL) {
        char title[64];
        snprintf(title, sizeof title, "%s", command->title);
        argv[1] = title;
        return command->run(argc - 1, argv + 1);
    }
    if (argc > 1 && is_any(argv[1], "-V", "--version")) {
        if (to != NULL) {
            puts(program_version);
        }
        return CTL_DONE;
    }
    if (argc > 1 && (is_any(argv[1], "help", "--help") || strcmp(argv[1], "-h") == 0)) {
        if (to != NULL) {
            print_help(stdout);
        }
        return CTL_DONE;
    }
    if (to != NULL && argc > 1) {
        fprintf(stderr, "pccd-mpi: no such command; see pccd-mpi --help\n");
    } else if (to != NULL) {
        print_help(stderr);
    }
    return CTL_USAGE;
}

/* Also where argp ends the program after wrong usage. */
static void finish(void)
{
    MPI_Finalize();
}

int main(int argc, char **argv)
{
    int given = 0;
    if (MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &given) != MPI_SUCCESS) {
        fputs("pccd-mpi: MPI does not start\n", stderr);
        return CTL_FAILED;
    }
    (void)atexit(finish);
    argp_err_exit_status = CTL_USAGE;
    argp_program_version = program_version;
    int status = run(argc, argv);
    if (together_is_root() && (fflush(stdout) != 0 || ferror(stdout) != 0)) {
        fputs("pccd-mpi: cannot write to the standard output\n", stderr);
        status = status == CTL_DONE ? CTL_FAILED : status;
    }
    return status;
}
