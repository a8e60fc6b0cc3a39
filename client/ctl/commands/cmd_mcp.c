/* cmd_mcp.c - pccdctl mcp. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "confined.h"
#include "ctl.h"
#include "link.h"
#include "mcp.h"

#define SECONDS_MAX 86400u

struct mcp_command {
    struct ctl_link link;
    bool may_write;
    uint32_t seconds;
    struct option_arguments folders;
};

static void check(struct argp_state *state, void *to)
{
    const struct mcp_command *command = to;
    if (command->folders.count > 1) {
        option_misused(state, "one folder at a time");
    }
}

#define AT(member) offsetof(struct mcp_command, member)
static const struct option_row rows[] = {
    {.type = OPTION_ARGUMENTS, .at = AT(folders), .needed = "which folder may be read?"},
    CTL_QUESTION,
    {"seconds", 0, "S", "End what takes longer than S seconds (default: 600)", OPTION_U32,
     .at = AT(seconds), .min = 1, .max = SECONDS_MAX},
    CTL_OUTPUT,
    {"write", 0, NULL,
     "Let tools write new files in the folder: scene files, recordings, pictures",
     OPTION_FLAG, .at = AT(may_write)},
    {0}};

const struct option_table ctl_table_mcp = {
    .rows = rows,
    .parts = (const struct option_part[]){{&ctl_link_table, AT(link)}, {0}},
    .check = check,
    .arguments = "FOLDER",
    .text = "Answer an agent: speak the Model Context Protocol on the standard input and "
            "output, with the tools scene, check, near, crossings, sweep, explain, more, "
            "record and verify. What they read is in that folder.",
    .more = "It answers until the input ends. Names of files count from the folder; what "
            "leaves it, also by a link, a scene file or a robot, is refused. Without "
            "--url, --socket and $PCCD_URL each call has a private daemon.",
    .examples = "  pccdctl mcp .\n"
                "  pccdctl mcp --write --url direct: .\n",
};

/* The tools are commands, which look for the daemon in the environment. */
static int set_daemon(const struct ctl_link *link)
{
    char runtime[64];
    struct stat info;
    const char *given = link->daemon != NULL ? link->daemon : getenv("PCCD_DAEMON");
    char *daemon =
        given != NULL && strchr(given, '/') != NULL ? realpath(given, NULL) : NULL;
    bool ok = link->url == NULL || setenv("PCCD_URL", link->url, 1) == 0;
    ok = ok && (given == NULL ||
                setenv("PCCD_DAEMON", daemon != NULL ? daemon : given, 1) == 0);
    free(daemon);
    if (link->is_private) {
        (void)unsetenv("PCCD_URL");
    }
    /* Who starts us may have passed on nearly nothing. */
    snprintf(runtime, sizeof runtime, "/run/user/%u", (unsigned)getuid());
    if (getenv("XDG_RUNTIME_DIR") == NULL && stat(runtime, &info) == 0 &&
        info.st_uid == getuid()) {
        ok = ok && setenv("XDG_RUNTIME_DIR", runtime, 1) == 0;
    }
    return ok ? CTL_DONE : ctl_complain("out of memory");
}

int ctl_cmd_mcp(int argc, char **argv)
{
    struct mcp_command command = {.seconds = 600};
    if (option_parse(&ctl_table_mcp, argc, argv, &command) != 0) {
        return CTL_USAGE;
    }
    const char *folder = command.folders.list[0];
    int status = set_daemon(&command.link);
    ctl_link_deinit(&command.link);
    if (status == CTL_DONE) {
        int why = tool_confine(folder);
        status = why != 0 ? ctl_complain("%s: %s", folder, tool_why(why)) : CTL_DONE;
    }
    if (status == CTL_DONE) {
        struct mcp *mcp = calloc(1, sizeof *mcp);
        if (mcp == NULL) {
            return ctl_complain("out of memory");
        }
        mcp->may_write = command.may_write;
        mcp->seconds = command.seconds;
        mcp->timeout_ms = command.link.timeout_ms;
        status = mcp_serve(mcp);
        free(mcp);
    }
    return status;
}
