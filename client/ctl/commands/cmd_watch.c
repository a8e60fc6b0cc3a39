/* cmd_watch.c - pccdctl watch. */
#include <inttypes.h>
#include <jansson.h>
#include <stdio.h>

#include "ctl.h"
#include "link.h"
#include "printable.h"
#include "terminal.h"

#define COUNT_MAX 1000000000000u
#define SLICE_MS  200 /* between two looks for an interrupt */

struct watch_options {
    struct ctl_link link;
    uint64_t session; /* 0: all */
    uint32_t scene;   /* 0: all */
    uint64_t count;   /* 0: for ever */
    double seconds;   /* 0: for ever */
    bool is_json;
};

static void check(struct argp_state *state, void *to)
{
    const struct watch_options *options = to;
    if (options->scene != 0 && options->session == 0) {
        option_misused(state, "--scene needs --session: handles are a session's own");
    }
}

#define AT(member) offsetof(struct watch_options, member)
static const struct option_row rows[] = {
    CTL_QUESTION,
    {"session", 0, "N",
     "Only steps of this session (default: of all, for the daemon's own user and root)",
     OPTION_U64, .at = AT(session), .min = 1, .max = INT64_MAX},
    {"scene", 0, "HANDLE", "Only steps of this scene of the session", OPTION_OWN,
     .at = AT(scene), .take = ctl_take_handle},
    {"count", 0, "N", "End after N steps", OPTION_U64, .at = AT(count), .min = 1,
     .max = COUNT_MAX},
    {"seconds", 0, "S", "End after S seconds", OPTION_REAL, .at = AT(seconds),
     .min = 0.001, .max = 1e9},
    CTL_OUTPUT,
    {"json", 0, NULL, "A JSON object a line", OPTION_FLAG, .at = AT(is_json)},
    {0}};

const struct option_table ctl_table_watch = {
    .rows = rows,
    .parts = (const struct option_part[]){{&ctl_link_table, AT(link)}, {0}},
    .check = check,
    .text = "Print a line for each step that the daemon answers: number, session, "
            "scene, contacts, milliseconds, threads, hash.",
    .more = "Nothing waits for the lines to be read: steps that were missed are "
            "counted in the next line. An interrupt (Ctrl-C) ends it.",
    .examples = "  pccdctl watch --count 100\n"
                "  pccdctl watch --session 3 --json\n",
};

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
        printf("%6s s%-6" PRIu64 " %#10" PRIx32 " %s%s%s\n", "failed", event->session,
               event->scene, terminal_begin(TERMINAL_RED),
               pccd_status_text(event->status), terminal_end());
        return;
    }
    char hash[PROTO_HASH_BYTES];
    printf("%6" PRIu64 " s%-6" PRIu64 " %#10" PRIx32 " %8" PRIu64 " %7.3f %2" PRIu32
           " %s%s\n",
           event->number, event->session, event->scene, event->total,
           (double)event->ns_step / 1e6, event->threads,
           proto_hash_text(PCCD_HASH_VERSION, event->hash, hash),
           event->incomplete != 0 ? " incomplete" : "");
}

static void print_head(void)
{
    printf("%s%6s %-7s %10s %8s %7s %2s %s%s\n", terminal_begin(TERMINAL_BOLD), "STEP",
           "SESSION", "SCENE", "CONTACTS", "MS", "TH", "HASH", terminal_end());
}

static int watch(struct pccd_client *client, void *to)
{
    const struct watch_options *options = to;
    struct pccd_step_event event;
    double begin_s = terminal_now_s();
    uint64_t told = 0;
    terminal_catch_interrupts();
    int status = pccd_watch_start(client, options->session, options->scene);
    if (status == PCCD_OK && !options->is_json) {
        print_head();
    }
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
    return ctl_link_command(&ctl_table_watch, argc, argv, &options.link, watch);
}
