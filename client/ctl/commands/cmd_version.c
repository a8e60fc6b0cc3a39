/* cmd_version.c - pccdctl version. */
#include <jansson.h>
#include <stdio.h>

#include "ctl.h"
#include "link.h"
#include "output.h"

const struct option_table ctl_table_version = {
    .parts = (const struct option_part[]){{&ctl_query_table, 0}, {0}},
    .text = "Tell the versions of this tool and of the library, and whether a daemon "
            "answers.",
    .more = "The exit status is 0 without a daemon, too, unless an option asks for "
            "one: --private, --url or --socket. Then it is 3.",
    .examples = "  pccdctl version\n"
                "  pccdctl version --json --private\n",
};

static void print(struct pccd_client *client)
{
    printf("tool     %s\n", argp_program_version);
    printf("library  libpccd %s\n", pccd_version());
    if (client != NULL) {
        printf("daemon   answers, process %u, %s\n", pccd_daemon_pid(client),
               tool_shown(pccd_daemon_cpu(client)));
    } else {
        printf("daemon   does not answer\n");
    }
}

static void print_json(struct pccd_client *client)
{
    struct pccd_daemon_info daemon;
    json_t *object = json_pack("{s:s, s:s, s:n}", "tool", argp_program_version, "library",
                               pccd_version(), "daemon");
    if (client != NULL && pccd_daemon(client, &daemon) == PCCD_OK) {
        json_object_set_new(object, "daemon",
                            json_pack("{s:s, s:I, s:s, s:I}", "name", daemon.name, "pid",
                                      (json_int_t)daemon.pid, "cpu", daemon.cpu,
                                      "protocol", (json_int_t)daemon.version));
    }
    (void)output_json(object, true, stdout);
}

int ctl_cmd_version(int argc, char **argv)
{
    struct ctl_query query = {.link = {.policy = CTL_LINK_EXISTING, .observes = true}};
    struct pccd_client *client = NULL;
    if (option_parse(&ctl_table_version, argc, argv, &query) != 0) {
        return CTL_USAGE;
    }
    bool is_wanted = query.link.is_private || query.link.url != NULL;
    int status = ctl_link_open(&query.link, &client); /* says itself why there is none */
    if (query.is_json) {
        print_json(client);
    } else {
        print(client);
    }
    pccd_close(client);
    ctl_link_deinit(&query.link);
    return is_wanted ? status : CTL_DONE;
}
