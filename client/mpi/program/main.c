/* main.c - pccd-mpi: one scene, or the steps of many, over the ranks of an MPI program.
 *
 * Threads: one that calls MPI; those of OpenMP within a step, and the one in which the
 * root computes (deal.h), do not.
 */
#include <mpi.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ctl.h"
#include "dispatch.h"
#include "pccd.h"
#include "rounding.h"
#include "together.h"

static const struct ctl_command commands[] = {
#define COMMAND(name, text) {#name, text, NULL, program_##name, &program_table_##name},
    PROGRAM_COMMANDS(COMMAND)
#undef COMMAND
};

static struct ctl_program program = {
    .name = "pccd-mpi",
    .usage = "Usage: mpirun -n RANKS pccd-mpi COMMAND [OPTION...]\n"
             "Continuous collision detection by the ranks of an MPI program.\n\n",
    .ending = "\n\"pccd-mpi COMMAND --help\" explains a command.\n"
              "Exit status: 0 when done; 1 when something meets or is wrong; 2 "
              "after wrong\n"
              "usage; 4 after any other error.\n",
    .commands = commands,
    .command_count = sizeof commands / sizeof commands[0]};

const struct option_table program_table_completion = CTL_COMPLETION_TABLE("pccd-mpi");

int program_completion(int argc, char **argv)
{
    together_mute();
    return completion_command(&program, &program_table_completion, argc, argv);
}

/* Also where argp ends the program after wrong usage. mpirun may end all ranks when one
 * of them ends with another status than 0, so what was said has to be on its way. */
static void finish(void)
{
    fflush(NULL);
    MPI_Finalize();
}

/* make calls it without ranks, perhaps where MPI cannot start. Whatever else it says of
 * itself, one rank of several says. */
static bool is_completion_of_shell(int argc, char **argv)
{
    return argc == 3 && strcmp(argv[1], "completion") == 0 &&
           (strcmp(argv[2], "bash") == 0 || strcmp(argv[2], "zsh") == 0 ||
            strcmp(argv[2], "fish") == 0);
}

int main(int argc, char **argv)
{
    int given = 0;
    bool needs_mpi = !is_completion_of_shell(argc, argv);
    ctl_name_program("pccd-mpi");
    if (needs_mpi &&
        MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &given) != MPI_SUCCESS) {
        return ctl_complain("MPI does not start");
    }
    if (needs_mpi) {
        (void)atexit(finish);
    }
    COMMON_ROUNDING_HERE; /* after MPI, which loads libraries */
    program.is_mute = needs_mpi && !together_is_root();
    return ctl_dispatch(&program, CTL_PROGRAM_VERSION("pccd-mpi"), argc, argv);
}
