/* cmd_trace.c - pccdctl trace. */
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "clock.h"
#include "ctl.h"
#include "link.h"
#include "shown.h"
#include "terminal.h"
#include "trace_file.h"

#define SECONDS_MAX     86400.0
#define SECONDS_DEFAULT 1.0
#define STEPS_MAX       1000000000u
#define LOOK_NS         20000000 /* between two looks at the clock or at the counters */

enum {
    OPTION_SECONDS = 256 + 64,
    OPTION_STEPS,
    OPTION_MIN_US,
    OPTION_EVENTS,
    OPTION_OUTPUT = 'o'
};

struct trace_command {
    struct ctl_query query;
    struct trace_options trace;
    double seconds; /* 0: until so many steps */
    uint64_t steps; /* 0: until so many seconds */
};

static const struct argp_option option_list[] = {
    {"output", OPTION_OUTPUT, "FILE", 0,
     "Where the trace goes; - is the standard output. It opens in Perfetto "
     "(ui.perfetto.dev) and in chrome://tracing",
     0},
    {"seconds", OPTION_SECONDS, "S", 0, "Trace for S seconds (default: 1)", 0},
    {"steps", OPTION_STEPS, "N", 0, "Trace until N steps have been answered", 0},
    {"min-us", OPTION_MIN_US, "U", 0,
     "Leave out tasks that took less than U microseconds (default: 0)", 0},
    {"events", OPTION_EVENTS, "N", 0,
     "Keep the newest N events of each thread (default: 65536, or what fits)", 0},
    {0},
};

static error_t parse(int key, char *text, struct argp_state *state)
{
    struct trace_command *command = state->input;
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &command->query;
        return 0;
    case OPTION_OUTPUT:
        command->trace.path = text;
        return 0;
    case OPTION_SECONDS:
        command->seconds = ctl_option_real(state, "seconds", text, 0.001, SECONDS_MAX);
        return 0;
    case OPTION_STEPS:
        command->steps = ctl_option_count(state, "steps", text, 1, STEPS_MAX);
        return 0;
    case OPTION_MIN_US:
        command->trace.min_us =
            ctl_option_count(state, "min-us", text, 0, TRACE_MIN_US_MAX);
        return 0;
    case OPTION_EVENTS:
        command->trace.events =
            (uint32_t)ctl_option_count(state, "events", text, 1, TRACE_EVENTS_MAX);
        return 0;
    case ARGP_KEY_END:
        if (command->trace.path == NULL) {
            tool_misused(state, "-o FILE says where the trace goes");
        }
        if (command->seconds > 0 && command->steps > 0) {
            tool_misused(state, "--seconds and --steps exclude each other");
        }
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static const struct argp_child children[] = {{&ctl_query_argp, 0, NULL, 0}, {0}};
const struct argp ctl_argp_trace = {
    .options = option_list,
    .parser = parse,
    .doc = "Write a trace: what the daemon's threads do, and every request of every "
           "client.\v"
           "An interrupt (Ctrl-C) ends the trace early and writes what there is.",
    .children = children};

/* ---- waiting ----------------------------------------------------------------------- */

static volatile sig_atomic_t is_interrupted;

static void on_interrupt(int number)
{
    (void)number;
    is_interrupted = 1;
}

static double now_s(void)
{
    return (double)common_now_ns() / 1e9;
}

static void look_later(void)
{
    struct timespec pause = {.tv_nsec = LOOK_NS};
    nanosleep(&pause, NULL);
}

static void wait_seconds(double seconds)
{
    struct progress progress;
    double begin = now_s(), passed = 0;
    progress_begin(&progress, "recording (ms)", (uint64_t)(seconds * 1000));
    while (passed < seconds && !is_interrupted) {
        progress_update(&progress, (uint64_t)(passed * 1000));
        look_later();
        passed = now_s() - begin;
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
    while (status == PCCD_OK && now - begin < wanted && !is_interrupted) {
        progress_update(&progress, now - begin);
        look_later();
        status = pccd_stats(client, find_steps, &now);
    }
    progress_clear(&progress);
    return status;
}

/* ---- the command ------------------------------------------------------------------- */

static int record(const struct trace_command *command, struct pccd_client *client,
                  struct ctl_error *error)
{
    bool to_stdout = strcmp(command->trace.path, "-") == 0;
    struct trace_file trace;
    int status = trace_file_begin(&trace, &command->trace, client, error);
    if (status == PCCD_OK && command->steps > 0) {
        status = wait_steps(client, command->steps);
        if (status != PCCD_OK) {
            ctl_error_set(error, status, "stats: %s", pccd_error_text(client));
        }
    } else if (status == PCCD_OK) {
        wait_seconds(command->seconds > 0 ? command->seconds : SECONDS_DEFAULT);
    }
    if (status == PCCD_OK) {
        status = trace_file_end(&trace, client, error);
    }
    if (status == PCCD_OK) {
        trace_file_report(&trace, to_stdout ? stderr : stdout, command->query.is_json);
    }
    trace_file_deinit(&trace);
    return status;
}

int ctl_cmd_trace(int argc, char **argv)
{
    struct trace_command command = {.query = {.link = {.policy = CTL_LINK_EXISTING}}};
    struct ctl_error error = {.text = ""};
    struct pccd_client *client = NULL;
    struct sigaction action = {.sa_handler = on_interrupt};
    if (argp_parse(&ctl_argp_trace, argc, argv, 0, NULL, &command) != 0) {
        return CTL_USAGE;
    }
    int status = ctl_link_open(&command.query.link, &client);
    if (status == CTL_DONE) {
        sigemptyset(&action.sa_mask);
        sigaction(SIGINT, &action, NULL);
        if (record(&command, client, &error) != PCCD_OK) {
            status = ctl_complain("%s", error.text);
        }
    }
    pccd_close(client);
    ctl_link_deinit(&command.query.link);
    return status;
}
