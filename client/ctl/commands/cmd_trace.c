/* cmd_trace.c - pccdctl trace. */
#include <string.h>

#include "ctl.h"
#include "link.h"
#include "terminal.h"
#include "trace_file.h"

#define SECONDS_MAX     86400.0
#define SECONDS_DEFAULT 1.0
#define STEPS_MAX       1000000000u
#define PATH_DEFAULT    "pccd-trace.json"
#define LOOK_S          0.02 /* between two looks at the clock or at the counters */

struct trace_command {
    struct ctl_query query;
    struct trace_options trace;
    double seconds; /* 0: until so many steps */
    uint64_t steps; /* 0: until so many seconds */
};

static void check(struct argp_state *state, void *to)
{
    const struct trace_command *command = to;
    if (command->seconds > 0 && command->steps > 0) {
        option_misused(state, "--seconds and --steps exclude each other");
    }
}

#define AT(member) offsetof(struct trace_command, member)
static const struct option_row rows[] = {
    CTL_QUESTION,
    {"seconds", 0, "S", "Trace for S seconds (default: 1)", OPTION_REAL,
     .at = AT(seconds), .min = 0.001, .max = SECONDS_MAX},
    {"steps", 0, "N", "Trace until N steps have been answered", OPTION_U64,
     .at = AT(steps), .min = 1, .max = STEPS_MAX},
    CTL_OUTPUT,
    {"output", 'o', "FILE",
     "Where the trace goes; - is the standard output. It opens in Perfetto "
     "(ui.perfetto.dev) and in chrome://tracing (default: " PATH_DEFAULT ")",
     OPTION_TEXT, .at = AT(trace.path)},
    {"min-us", 0, "U", "Leave out tasks that took less than U microseconds (default: 0)",
     OPTION_U64, .at = AT(trace.min_us), .min = 0, .max = TRACE_MIN_US_MAX},
    {"events", 0, "N",
     "Keep the newest N events of each thread (default: 65536, or what fits)", OPTION_U32,
     .at = AT(trace.events), .min = 1, .max = TRACE_EVENTS_MAX},
    {0}};

const struct option_table ctl_table_trace = {
    .rows = rows,
    .parts = (const struct option_part[]){{&ctl_query_table, AT(query)}, {0}},
    .check = check,
    .text = "Write a trace: what the daemon's threads do, and every request of every "
            "client.",
    .more = "An interrupt (Ctrl-C) ends the trace early and writes what there is.",
    .examples = "  pccdctl trace -o step.json --steps 1\n"
                "  pccdctl trace -o slow.json --seconds 10 --min-us 20\n",
};

/* ---- waiting ----------------------------------------------------------------------- */

static void wait_seconds(double seconds)
{
    struct progress progress;
    double begin = terminal_now_s(), passed = 0;
    progress_begin(&progress, "recording (ms)", (uint64_t)(seconds * 1000));
    while (passed < seconds && !terminal_was_interrupted()) {
        progress_update(&progress, (uint64_t)(passed * 1000));
        terminal_sleep(LOOK_S);
        passed = terminal_now_s() - begin;
    }
    progress_clear(&progress);
}

static void find_steps(void *context, const char *name, uint64_t value, const char *text)
{
    uint64_t *steps = context;
    (void)text;
    if (strcmp(name, "steps") == 0) {
        *steps = value;
    }
}

static int wait_steps(struct pccd_client *client, uint64_t wanted)
{
    struct progress progress;
    uint64_t begin = 0, now = 0;
    int status = pccd_stats(client, find_steps, &begin);
    now = begin;
    progress_begin(&progress, "steps", wanted);
    while (status == PCCD_OK && now - begin < wanted && !terminal_was_interrupted()) {
        progress_update(&progress, now - begin);
        terminal_sleep(LOOK_S);
        status = pccd_stats(client, find_steps, &now);
    }
    progress_clear(&progress);
    return status;
}

/* ---- the command ------------------------------------------------------------------- */

static int record(struct pccd_client *client, void *to)
{
    const struct trace_command *command = to;
    struct ctl_error error = {.text = ""};
    struct trace_file trace;
    bool to_stdout = strcmp(command->trace.path, "-") == 0;
    terminal_catch_interrupts();
    int status = trace_file_begin(&trace, &command->trace, client, &error);
    if (status == PCCD_OK && command->steps > 0) {
        status = wait_steps(client, command->steps);
        if (status != PCCD_OK) {
            ctl_error_set(&error, status, "stats: %s", pccd_error_text(client));
        }
    } else if (status == PCCD_OK) {
        wait_seconds(command->seconds > 0 ? command->seconds : SECONDS_DEFAULT);
    }
    if (status == PCCD_OK) {
        status = trace_file_end(&trace, client, &error);
    }
    if (status == PCCD_OK) {
        trace_file_report(&trace, to_stdout ? stderr : stdout, command->query.is_json);
    }
    trace_file_deinit(&trace);
    return status == PCCD_OK ? CTL_DONE : ctl_complain("%s", error.text);
}

int ctl_cmd_trace(int argc, char **argv)
{
    struct trace_command command = {.query = {.link = {.policy = CTL_LINK_EXISTING}},
                                    .trace.path = PATH_DEFAULT};
    return ctl_link_command(&ctl_table_trace, argc, argv, &command.query.link, record);
}
