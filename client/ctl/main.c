/* main.c - pccdctl: ask a pccd daemon from the command line. */
#include "ctl.h"
#include "dispatch.h"
#include "rounding.h"

static const struct ctl_command commands[] = {
#define COMMAND(name, text, group)                                                       \
    {#name, text, group, ctl_cmd_##name, &ctl_table_##name},
    CTL_COMMANDS(COMMAND)
#undef COMMAND
};

static const struct ctl_program program = {
    .name = "pccdctl",
    .usage = "Usage: pccdctl COMMAND [OPTION...]\n"
             "Continuous collision detection of triangle meshes, by the daemon "
             "pccdd.\n\n",
    .ending =
        "\n\"pccdctl COMMAND --help\" explains a command. What a command writes takes "
        "the\nplace of a file of its name.\n"
        "Exit status: 0 when done; 1 when what was looked for is wrong; 2 after "
        "wrong\n"
        "usage; 3 without a daemon; 4 after any other error.\n",
    .commands = commands,
    .command_count = sizeof commands / sizeof commands[0]};

const struct option_table ctl_table_completion = CTL_COMPLETION_TABLE("pccdctl");

int ctl_cmd_completion(int argc, char **argv)
{
    return completion_command(&program, &ctl_table_completion, argc, argv);
}

int main(int argc, char **argv)
{
    COMMON_ROUNDING_HERE;
    return ctl_dispatch(&program, CTL_PROGRAM_VERSION("pccdctl"), argc, argv);
}
