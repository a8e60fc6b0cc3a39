/* client/ctl/commands/cmd_completion.c - pccdctl completion.
 *
 * Room:     client/ctl.
 * Does:     prints what a shell needs to complete our commands and options.
 * Does not: install it: make install does.
 * Threads:  one.
 * Source:   completion.h.
 */
#include <stdio.h>
#include <string.h>

#include "completion.h"
#include "ctl.h"
#include "link.h"
#include "shown.h"

static const char *const shell_names[] = {"bash", "zsh", "fish"};

static error_t parse(int key, char *text, struct argp_state *state)
{
    int *shell = state->input;
    switch (key) {
    case ARGP_KEY_ARG:
        if (state->arg_num > 0) {
            tool_misused(state, "one shell at a time");
        }
        *shell = ctl_argument_name(state, text, shell_names, 3);
        return 0;
    case ARGP_KEY_NO_ARGS:
        tool_misused(state, "for which shell: bash, zsh or fish?");
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static const struct argp_child children[] = {{&ctl_common_argp, 0, NULL, 0}, {0}};
const struct argp ctl_argp_completion = {
    .parser = parse,
    .args_doc = "bash|zsh|fish",
    .doc = "Print what a shell needs to complete the commands and options of pccdctl.\v"
           "make install puts it where the shells look. In a shell by hand:\n"
           "  source <(pccdctl completion bash)",
    .children = children};

int ctl_cmd_completion(int argc, char **argv)
{
    int shell = 0;
    if (argp_parse(&ctl_argp_completion, argc, argv, 0, NULL, &shell) != 0) {
        return CTL_USAGE;
    }
    if (shell == 0) {
        completion_print_bash(stdout);
    } else if (shell == 1) {
        completion_print_zsh(stdout);
    } else {
        completion_print_fish(stdout);
    }
    return CTL_DONE;
}
