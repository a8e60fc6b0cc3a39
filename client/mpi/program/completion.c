/* completion.c - pccd-mpi completion. */
#include "completion.h"

#include "commands.h"
#include "ctl.h"
#include "together.h"

static const struct completion_row rows[] = {
#define ROW(name, text) {#name, text, &program_argp_##name},
    PROGRAM_COMMANDS(ROW)
#undef ROW
};

static const struct argp_child children[] = {{&ctl_common_argp, 0, NULL, 0}, {0}};
const struct argp program_argp_completion = {
    .parser = completion_parse,
    .args_doc = "bash|zsh|fish",
    .doc = "Print what a shell needs to complete the commands and options of pccd-mpi.\v"
           "make install puts it where the shells look. In a shell by hand:\n"
           "  source <(pccd-mpi completion bash)",
    .children = children};

int program_completion(int argc, char **argv)
{
    const struct completion all = {
        .program = "pccd-mpi", .rows = rows, .row_count = sizeof rows / sizeof rows[0]};
    together_mute();
    return completion_command(&all, &program_argp_completion, argc, argv);
}
