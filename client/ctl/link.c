/* link.c - which daemon a command talks to. */
#include "link.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ctl.h"
#include "shown.h"

enum {
    OPTION_URL = 256,
    OPTION_SOCKET,
    OPTION_PRIVATE,
    OPTION_DAEMON,
    OPTION_TIMEOUT,
    OPTION_JSON
};

static const struct argp_option options[] = {
    {"url", OPTION_URL, "URL", 0,
     "Talk to the daemon at URL, which is unix:PATH; direct: computes in this process, "
     "without a daemon",
     0},
    {"socket", OPTION_SOCKET, "PATH", 0, "The same as --url unix:PATH", 0},
    {"private", OPTION_PRIVATE, NULL, 0,
     "Start a daemon for this command alone; it goes away with it", 0},
    {"daemon", OPTION_DAEMON, "PROGRAM", 0,
     "The daemon to start (default: $PCCD_DAEMON, else the installed pccdd)", 0},
    {"timeout", OPTION_TIMEOUT, "MS", 0,
     "Give up waiting after MS milliseconds (default: 30000)", 0},
    {0},
};

static void set_url(struct argp_state *state, const char *prefix, const char *rest)
{
    struct ctl_link *link = state->input;
    char *url = NULL;
    if (asprintf(&url, "%s%s", prefix, rest) < 0) {
        argp_failure(state, CTL_FAILED, 0, "out of memory");
    }
    free(link->url);
    link->url = url;
}

static error_t parse(int key, char *text, struct argp_state *state)
{
    struct ctl_link *link = state->input;
    switch (key) {
    case OPTION_URL:
        set_url(state, "", text);
        return 0;
    case OPTION_SOCKET:
        set_url(state, "unix:", text);
        return 0;
    case OPTION_PRIVATE:
        link->is_private = true;
        return 0;
    case OPTION_DAEMON:
        link->daemon = text;
        return 0;
    case OPTION_TIMEOUT:
        link->timeout_ms = (int)ctl_option_count(state, "timeout", text, 1, 3600000);
        return 0;
    case ARGP_KEY_END:
        if (link->is_private && link->url != NULL) {
            tool_misused(state, "--private excludes --url and --socket");
        }
        if (link->url != NULL && strcmp(link->url, "direct:") != 0 &&
            (strncmp(link->url, "unix:", 5) != 0 || link->url[5] == '\0')) {
            tool_misused(state,
                         "--url: \"%s\" is neither unix:PATH nor direct:", link->url);
        }
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static const struct argp_child children[] = {{&ctl_common_argp, 0, NULL, 0}, {0}};
const struct argp ctl_link_argp = {
    .options = options, .parser = parse, .children = children};

static const struct argp_option query_options[] = {
    {"json", OPTION_JSON, NULL, 0, "JSON instead of text", 0},
    {0},
};

static error_t parse_query(int key, char *text, struct argp_state *state)
{
    struct ctl_query *query = state->input;
    (void)text;
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &query->link;
        return 0;
    case OPTION_JSON:
        query->is_json = true;
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static const struct argp_child query_children[] = {{&ctl_link_argp, 0, "Daemon:", 10},
                                                   {0}};
const struct argp ctl_query_argp = {
    .options = query_options, .parser = parse_query, .children = query_children};

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

int ctl_link_open(const struct ctl_link *link, struct pccd_client **client)
{
    struct pccd_options asked;
    ctl_link_options(link, &asked);
    int status = pccd_connect(&asked, client);
    if (status == PCCD_OK) {
        return CTL_DONE;
    }
    const char *text = pccd_error_text(NULL);
    (void)ctl_complain(
        "no connection: %s%s", text[0] != '\0' ? text : pccd_status_text(status),
        asked.private_daemon ? "" : "; pccdctl doctor tells what is wrong");
    return CTL_NO_DAEMON;
}

void ctl_link_deinit(struct ctl_link *link)
{
    free(link->url);
    link->url = NULL;
}
