/* link.c - which daemon a command talks to. */
#include "link.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ctl.h"
#include "proto_limits.h"

static void set_url(const struct argp_state *state, struct ctl_link *link,
                    const char *prefix, const char *rest)
{
    char *url = NULL;
    if (asprintf(&url, "%s%s", prefix, rest) < 0) {
        argp_failure(state, CTL_FAILED, 0, "out of memory");
    }
    free(link->url);
    link->url = url;
}

static void take_url(struct argp_state *state, const struct option_row *row,
                     const char *text, void *to)
{
    (void)row;
    set_url(state, to, "", text);
}

static void take_socket(struct argp_state *state, const struct option_row *row,
                        const char *text, void *to)
{
    (void)row;
    set_url(state, to, "unix:", text);
}

static void check(struct argp_state *state, void *to)
{
    const struct ctl_link *link = to;
    if (link->is_private && link->url != NULL) {
        option_misused(state, "--private excludes --url and --socket");
    }
    if (link->url != NULL && strcmp(link->url, "direct:") != 0 &&
        (strncmp(link->url, "unix:", 5) != 0 || link->url[5] == '\0')) {
        option_misused(state,
                       "--url: \"%s\" is neither unix:PATH nor direct:", link->url);
    }
}

#define AT(member) offsetof(struct ctl_link, member)
const struct option_table ctl_link_table = {
    .name = "DAEMON",
    .rows =
        (const struct option_row[]){
            CTL_DAEMON,
            {"url", 0, "URL",
             "Talk to the daemon at URL, which is unix:PATH; direct: computes in this "
             "process, without a daemon",
             OPTION_OWN, .take = take_url},
            {"socket", 0, "PATH", "The same as --url unix:PATH", OPTION_OWN,
             .take = take_socket},
            {"private", 0, NULL,
             "Start a daemon for this command alone; it goes away with it", OPTION_FLAG,
             .at = AT(is_private)},
            {"daemon", 0, "PROGRAM",
             "The daemon to start (default: $PCCD_DAEMON, else the installed pccdd)",
             OPTION_TEXT, .at = AT(daemon)},
            {"timeout", 0, "MS", "Give up waiting after MS milliseconds (default: 30000)",
             OPTION_U32, .at = AT(timeout_ms), .min = 1, .max = 3600000},
            {0}},
    .parts = (const struct option_part[]){{&ctl_common_table, 0}, {0}},
    .check = check};

const struct option_table ctl_query_table = {
    .rows =
        (const struct option_row[]){CTL_OUTPUT,
                                    {"json", 0, NULL, "JSON instead of text", OPTION_FLAG,
                                     .at = offsetof(struct ctl_query, is_json)},
                                    {0}},
    .parts = (const struct option_part[]){
        {&ctl_link_table, offsetof(struct ctl_query, link)}, {0}}};

void ctl_link_options(const struct ctl_link *link, struct pccd_options *asked)
{
    const char *told = getenv("PCCD_URL");
    bool has_told = told != NULL && told[0] != '\0';
    pccd_options_init(asked);
    asked->url = link->url;
    asked->daemon = link->daemon;
    asked->timeout_ms = link->timeout_ms;
    asked->result_bytes = link->result_bytes;
    asked->observes = link->observes;
    asked->no_autostart = link->policy == CTL_LINK_EXISTING;
    if (link->is_private) {
        unsetenv("PCCD_URL"); /* or the library would take its direct: for private */
    }
    asked->private_daemon =
        link->is_private ||
        (link->url == NULL &&
         (link->policy == CTL_LINK_PRIVATE ||
          (link->policy == CTL_LINK_PRIVATE_UNLESS_ENV && !has_told)));
    if (asked->private_daemon) {
        asked->no_autostart = false;
    }
}

bool ctl_link_is_direct(const struct ctl_link *link)
{
    const char *url = link->url != NULL ? link->url : getenv("PCCD_URL");
    return !link->is_private && url != NULL && strcmp(url, "direct:") == 0;
}

int ctl_link_open(const struct ctl_link *link, struct pccd_client **client)
{
    struct pccd_options asked;
    ctl_link_options(link, &asked);
    int status = pccd_connect(&asked, client);
    if (status == PCCD_OK) {
        return CTL_DONE;
    }
    const char *text = pccd_error_text(NULL), *told = getenv("PCCD_URL");
    const char *missing = strstr(text, ": No such file"); /* which sounds broken */
    if (status == PCCD_E_NODAEMON && asked.no_autostart && link->url == NULL &&
        (told == NULL || told[0] == '\0')) {
        (void)ctl_complain("no daemon runs; a program that needs one starts it: %.*s; "
                           "pccdctl doctor tells more",
                           (int)(missing != NULL ? missing - text : (long)strlen(text)),
                           text);
        return CTL_NO_DAEMON;
    }
    (void)ctl_complain(
        "no connection: %s%s", text[0] != '\0' ? text : pccd_status_text(status),
        asked.private_daemon ? "" : "; pccdctl doctor tells what is wrong");
    return CTL_NO_DAEMON;
}

int ctl_link_command(const struct option_table *table, int argc, char **argv,
                     struct ctl_link *link,
                     int (*run)(struct pccd_client *client, void *options))
{
    struct pccd_client *client = NULL;
    if (option_parse(table, argc, argv, link) != 0) {
        return CTL_USAGE;
    }
    int status = ctl_link_open(link, &client);
    if (status == CTL_DONE) {
        status = run(client, link);
    }
    pccd_close(client);
    ctl_link_deinit(link);
    return status;
}

void ctl_link_deinit(struct ctl_link *link)
{
    free(link->url);
    link->url = NULL;
}

int ctl_name_object(struct pccd_client *client, uint32_t scene, uint32_t object,
                    const char *name)
{
    char text[PROTO_STR_MAX + 1];
    (void)snprintf(text, sizeof text, "%s", name);
    return pccd_object_name(client, scene, object, text);
}
