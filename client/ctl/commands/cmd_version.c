/* client/ctl/commands/cmd_version.c - pccdctl version.
 *
 * Room:     client/ctl.
 * Does:     tells the versions of this tool and of the library, the daemon's process and
 *           its instruction set.
 * Does not: start a daemon, or fail when none runs.
 * Threads:  one.
 * Source:   pccd.h.
 */
#include <stdio.h>

#include "ctl.h"
#include "link.h"

static error_t parse(int key, char *text, struct argp_state *state)
{
    (void)text;
    if (key != ARGP_KEY_INIT) {
        return ARGP_ERR_UNKNOWN;
    }
    state->child_inputs[0] = state->input;
    return 0;
}

static const struct argp_child children[] = {{&ctl_link_argp, 0, "Daemon:", 10}, {0}};
const struct argp ctl_argp_version = {.parser = parse,
                                      .doc = "Tell the versions of this tool and of the "
                                             "library, and whether a daemon answers.",
                                      .children = children};

int ctl_cmd_version(int argc, char **argv)
{
    struct ctl_link link = {.policy = CTL_LINK_EXISTING};
    struct pccd_client *client = NULL;
    if (argp_parse(&ctl_argp_version, argc, argv, 0, NULL, &link) != 0) {
        return CTL_USAGE;
    }
    printf("tool     %s\n", argp_program_version);
    printf("library  libpccd %s\n", pccd_version());
    fflush(stdout);
    int status = ctl_link_open(&link, &client);
    if (status == CTL_DONE) {
        printf("daemon   answers, process %u, %s\n", pccd_daemon_pid(client),
               pccd_daemon_cpu(client));
    } else {
        printf("daemon   does not answer\n");
    }
    pccd_close(client);
    ctl_link_deinit(&link);
    return CTL_DONE;
}
