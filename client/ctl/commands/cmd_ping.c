/* cmd_ping.c - pccdctl ping. */
#include <inttypes.h>
#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>

#include "ctl.h"
#include "link.h"
#include "output.h"
#include "statistics.h"
#include "terminal.h"

#define PINGS_MAX          100000000u
#define PINGS_DEFAULT      10u
#define INTERVAL_DEFAULT_S 0.1

struct ping_options {
    struct ctl_link link;
    uint32_t count;
    double interval_s;
    bool is_quiet;
    bool is_json;
};

static void check(struct argp_state *state, void *to)
{
    struct ping_options *options = to;
    (void)state;
    options->is_quiet = options->is_quiet || options->is_json;
}

static const struct option_row rows[] = {
    CTL_QUESTION,
    {"count", 'c', "N", "Round trips (default: 10)", OPTION_U32,
     .at = offsetof(struct ping_options, count), .min = 1, .max = PINGS_MAX},
    {"interval", 'i', "SECONDS", "Time between two round trips (default: 0.1; 0: none)",
     OPTION_REAL, .at = offsetof(struct ping_options, interval_s), .min = 0, .max = 3600},
    CTL_OUTPUT,
    {"quiet", 'q', NULL, "Print only the summary", OPTION_FLAG,
     .at = offsetof(struct ping_options, is_quiet)},
    {"json", 0, NULL, "Print only the summary, as one JSON object", OPTION_FLAG,
     .at = offsetof(struct ping_options, is_json)},
    {0}};

const struct option_table ctl_table_ping = {
    .rows = rows,
    .parts =
        (const struct option_part[]){
            {&ctl_link_table, offsetof(struct ping_options, link)}, {0}},
    .check = check,
    .text = "Measure round trips through the daemon's loop, in microseconds.",
    .examples = "  pccdctl ping\n"
                "  pccdctl ping -c 1000 -i 0 --json\n",
};

static int ping_all(struct pccd_client *client, const struct ping_options *options,
                    double *times_us)
{
    struct progress progress;
    /* Lines are progress enough. */
    progress_begin(&progress, "round trips", options->is_quiet ? options->count : 0);
    for (uint32_t i = 0; i < options->count; i++) {
        uint64_t round_trip_ns;
        if (i > 0 && options->interval_s > 0.0) {
            terminal_sleep(options->interval_s);
        }
        if (pccd_ping(client, &round_trip_ns) != PCCD_OK) {
            progress_clear(&progress);
            return ctl_complain("ping %" PRIu32 " of %" PRIu32 ": %s", i + 1,
                                options->count, pccd_error_text(client));
        }
        times_us[i] = (double)round_trip_ns / 1e3;
        progress_update(&progress, i + 1);
        if (!options->is_quiet) {
            printf("daemon %" PRIu32 ": seq %" PRIu32 ", %.1f us\n",
                   pccd_daemon_pid(client), i + 1, times_us[i]);
            if (options->interval_s > 0.0) {
                fflush(stdout); /* who reads a pipe waits for it, too */
            }
        }
    }
    progress_clear(&progress);
    statistics_sort(times_us, options->count);
    if (options->is_json) {
        json_t *object = json_pack(
            "{s:I, s:I, s:f, s:f, s:f, s:f}", "pid", (json_int_t)pccd_daemon_pid(client),
            "count", (json_int_t)options->count, "min_us", times_us[0], "p50_us",
            statistics_median(times_us, options->count), "p99_us",
            statistics_quantile(times_us, options->count, 0.99), "max_us",
            times_us[options->count - 1]);
        (void)output_json(object, true, stdout);
        return CTL_DONE;
    }
    printf("%" PRIu32
           " round trips: min %.1f us, median %.1f us, p99 %.1f us, max %.1f us\n",
           options->count, times_us[0], statistics_median(times_us, options->count),
           statistics_quantile(times_us, options->count, 0.99),
           times_us[options->count - 1]);
    return CTL_DONE;
}

static int run(struct pccd_client *client, void *to)
{
    const struct ping_options *options = to;
    double *times_us = malloc(options->count * sizeof *times_us);
    int status = times_us != NULL ? ping_all(client, options, times_us)
                                  : ctl_complain("out of memory");
    free(times_us);
    return status;
}

int ctl_cmd_ping(int argc, char **argv)
{
    struct ping_options options = {
        .link = {.policy = CTL_LINK_EXISTING, .observes = true},
        .count = PINGS_DEFAULT,
        .interval_s = INTERVAL_DEFAULT_S};
    return ctl_link_command(&ctl_table_ping, argc, argv, &options.link, run);
}
