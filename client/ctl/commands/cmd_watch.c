/* cmd_watch.c - pccdctl watch. */
#include <inttypes.h>
#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>

#include "ctl.h"
#include "link.h"
#include "printable.h"
#include "shown.h"
#include "terminal.h"

#define COUNT_MAX 1000000000000u
#define SLICE_MS  200 /* between two looks for an interrupt */

enum {
    OPTION_SESSION = 256 + 64,
    OPTION_SCENE,
    OPTION_COUNT,
    OPTION_SECONDS,
    OPTION_JSON
};

struct watch_options {
    struct ctl_link link;
    uint64_t session; /* 0: all */
    uint32_t scene;   /* 0: all */
    uint64_t count;   /* 0: for ever */
    double seconds;   /* likewise */
    bool is_json;
};

static const struct argp_option option_list[] = {
    {"session", OPTION_SESSION, "N", 0,
     "Only steps of this session (default: of all, for the daemon's own user and root)",
     0},
    {"scene", OPTION_SCENE, "HANDLE", 0, "Only steps of this scene of the session", 0},
    {"count", OPTION_COUNT, "N", 0, "End after N steps", 0},
    {"seconds", OPTION_SECONDS, "S", 0, "End after S seconds", 0},
    {"json", OPTION_JSON, NULL, 0, "A JSON object a line", 0},
    {0},
};

static error_t parse(int key, char *text, struct argp_state *state)
{
    struct watch_options *options = state->input;
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &options->link;
        return 0;
    case OPTION_SESSION:
        options->session = ctl_option_count(state, "session", text, 1, INT64_MAX);
        return 0;
    case OPTION_SCENE:
        options->scene = ctl_option_handle(state, "scene", text);
        return 0;
    case OPTION_COUNT:
        options->count = ctl_option_count(state, "count", text, 1, COUNT_MAX);
        return 0;
    case OPTION_SECONDS:
        options->seconds = ctl_option_real(state, "seconds", text, 0.001, 1e9);
        return 0;
    case OPTION_JSON:
        options->is_json = true;
        return 0;
    case ARGP_KEY_END:
        if (options->scene != 0 && options->session == 0) {
            tool_misused(state, "--scene needs --session: handles are a session's own");
        }
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static const struct argp_child children[] = {{&ctl_link_argp, 0, "Daemon:", 10}, {0}};
const struct argp ctl_argp_watch = {
    .options = option_list,
    .parser = parse,
    .doc =
        "Print a line for each step that the daemon answers: number, session, scene, "
        "hash, contacts, milliseconds, threads.\v"
        "Nothing waits for the lines to be read: steps that were missed are counted in "
        "the next line. An interrupt (Ctrl-C) ends it.",
    .children = children};

static void print_json(const struct pccd_step_event *event)
{
    char hash[PROTO_HASH_BYTES];
    proto_hash_text(PCCD_HASH_VERSION, event->hash, hash);
    json_t *object = json_pack(
        "{s:I, s:I, s:I, s:I, s:s, s:s, s:I, s:f, s:f, s:I, s:i, s:I}", "number",
        (json_int_t)event->number, "session", (json_int_t)event->session, "scene",
        (json_int_t)event->scene, "step", (json_int_t)event->step, "status",
        pccd_status_name(event->status), "hash", hash, "total", (json_int_t)event->total,
        "ms", (double)event->ns_step / 1e6, "ms_queue", (double)event->ns_queue / 1e6,
        "threads", (json_int_t)event->threads, "incomplete", (int)event->incomplete,
        "lost", (json_int_t)event->lost);
    json_dumpf(object, stdout, JSON_COMPACT);
    putchar('\n');
    json_decref(object);
}

static void print_line(const struct pccd_step_event *event)
{
    if (event->lost > 0) {
        printf("# %" PRIu64 " %s not shown\n", event->lost,
               proto_plural(event->lost, "step is", "steps are"));
    }
    if (event->status != PCCD_OK) {
        printf("%10s s%" PRIu64 " %#" PRIx32 " %s%s%s\n", "failed", event->session,
               event->scene, terminal_begin(TERMINAL_RED),
               pccd_status_text(event->status), terminal_end());
        return;
    }
    char hash[PROTO_HASH_BYTES];
    printf("%10" PRIu64 " s%" PRIu64 " %#" PRIx32 " %s %8" PRIu64 " %9.3f ms %" PRIu32
           "%s\n",
           event->number, event->session, event->scene,
           proto_hash_text(PCCD_HASH_VERSION, event->hash, hash), event->total,
           (double)event->ns_step / 1e6, event->threads,
           event->incomplete != 0 ? " incomplete" : "");
}

static int watch(struct pccd_client *client, const struct watch_options *options)
{
    struct pccd_step_event event;
    double begin_s = terminal_now_s();
    uint64_t told = 0;
    int status = pccd_watch_start(client, options->session, options->scene);
    while (status == PCCD_OK && !terminal_was_interrupted() &&
           (options->count == 0 || told < options->count) &&
           (options->seconds <= 0 || terminal_now_s() - begin_s < options->seconds)) {
        status = pccd_watch_next(client, SLICE_MS, &event);
        if (status == PCCD_E_TIMEOUT) {
            status = fflush(stdout) == 0 ? PCCD_OK : PCCD_E_SYSTEM;
            continue;
        }
        if (status != PCCD_OK) {
            break;
        }
        if (options->is_json) {
            print_json(&event);
        } else {
            print_line(&event);
        }
        told++;
        if (terminal_is_live() || ferror(stdout) != 0) {
            status = fflush(stdout) == 0 ? PCCD_OK : PCCD_E_SYSTEM;
        }
    }
    if (status == PCCD_E_SYSTEM && ferror(stdout) != 0) {
        return CTL_DONE; /* nobody reads any more */
    }
    if (status == PCCD_OK || terminal_was_interrupted()) {
        return CTL_DONE;
    }
    return ctl_complain("watch: %s%s", pccd_error_text(client),
                        status == PCCD_E_HANDLE ? "; pccdctl list shows them" : "");
}

int ctl_cmd_watch(int argc, char **argv)
{
    struct watch_options options = {
        .link = {.policy = CTL_LINK_EXISTING, .observes = true}};
    struct pccd_client *client = NULL;
    if (argp_parse(&ctl_argp_watch, argc, argv, 0, NULL, &options) != 0) {
        return CTL_USAGE;
    }
    int status = ctl_link_open(&options.link, &client);
    if (status == CTL_DONE) {
        terminal_catch_interrupts();
        status = watch(client, &options);
    }
    pccd_close(client);
    ctl_link_deinit(&options.link);
    return status;
}
