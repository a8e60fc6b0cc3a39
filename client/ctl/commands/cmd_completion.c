/* cmd_completion.c - pccdctl completion. */
#include "ctl.h"
#include "dispatch.h"

static const struct completion_row rows[] = {
#define ROW(name, text) {#name, text, &ctl_argp_##name},
    CTL_COMMANDS(ROW)
#undef ROW
};

static const struct argp_child children[] = {{&ctl_common_argp, 0, NULL, 0}, {0}};
const struct argp ctl_argp_completion = {
    .parser = completion_parse,
    .args_doc = "bash|zsh|fish",
    .doc = "Print what a shell needs to complete the commands and options of pccdctl.\v"
           "make install puts it where the shells look. In a shell by hand:\n"
           "  source <(pccdctl completion bash)",
    .children = children};

int ctl_cmd_completion(int argc, char **argv)
{
    const struct completion all = {
        .program = "pccdctl", .rows = rows, .row_count = sizeof rows / sizeof rows[0]};
    return completion_command(&all, &ctl_argp_completion, argc, argv);
}
