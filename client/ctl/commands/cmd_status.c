/* cmd_status.c - pccdctl status. */
#include <inttypes.h>
#include <jansson.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "columns.h"
#include "counters.h"
#include "ctl.h"
#include "link.h"
#include "output.h"
#include "printable.h"
#include "shown.h"
#include "terminal.h"

const struct option_table ctl_table_status = {
    .parts = (const struct option_part[]){{&ctl_query_table, 0}, {0}},
    .text = "Tell on one screen how a daemon is: its clients, its memory, its last "
            "step.",
    .examples = "  pccdctl status\n"
                "  pccdctl status --json --socket /run/pccd/pccd.sock\n",
};

/* Everything that is told. */
struct status {
    struct pccd_daemon_info daemon;
    const char *url;
    struct counters counters;
    bool has_step; /* somebody's last step could be seen, and there was one */
    struct counters step;
    bool has_histograms;
    struct pccd_histogram_info steps, requests;
    uint64_t resident_bytes; /* 0: not known */
    struct health health;
};

/* Return the memory of the daemon's process, if it runs on this machine and may be looked
 * at; else 0. */
static uint64_t resident_bytes(uint32_t pid)
{
    char path[64];
    unsigned long long pages = 0;
    snprintf(path, sizeof path, "/proc/%" PRIu32 "/statm", pid);
    FILE *file = fopen(path, "r");
    if (file == NULL) {
        return 0;
    }
    if (fscanf(file, "%*u %llu", &pages) != 1) {
        pages = 0;
    }
    fclose(file);
    return (uint64_t)pages * (uint64_t)sysconf(_SC_PAGESIZE);
}

static int look(struct pccd_client *client, struct status *status)
{
    int outcome = pccd_daemon(client, &status->daemon);
    status->url = pccd_url(client);
    if (outcome == PCCD_OK) {
        outcome = counters_read(client, &status->counters);
    }
    if (outcome != PCCD_OK) {
        return outcome;
    }
    /* What this user may not see, or an older daemon does not tell, is left out. */
    status->has_step = pccd_stats_thread(client, true, 0, counters_take, &status->step,
                                         NULL) == PCCD_OK &&
                       counters_get(&status->step, "threads") > 0;
    status->has_histograms =
        pccd_histogram(client, PCCD_HISTOGRAM_STEPS, &status->steps) == PCCD_OK &&
        pccd_histogram(client, PCCD_HISTOGRAM_REQUESTS, &status->requests) == PCCD_OK;
    status->resident_bytes = resident_bytes(status->daemon.pid);
    health_judge(&status->counters, &status->health);
    return PCCD_OK;
}

/* ---- for people -------------------------------------------------------------------- */

#define HEAD_COLUMNS 11

/* A line that is longer than the terminal goes on below. */
static void line(const char *head, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
static void line(const char *head, const char *format, ...)
{
    char text[1024];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    printf("%-*s", HEAD_COLUMNS, head);
    columns_text(stdout, HEAD_COLUMNS, text);
    putchar('\n');
}

static void print_step(const struct status *status)
{
    const struct counters *step = &status->step;
    static const char *const phases[] = {"ingest", "refit", "low", "high", "merge"};
    uint64_t threads = counters_get(step, "threads");
    uint64_t batch = counters_get(step, "batch");
    char what[48] = "", parts[160] = "";
    size_t used = 0;
    if (batch > 0) {
        snprintf(what, sizeof what, "of %" PRIu64 " in ", batch);
    }
    for (size_t i = 0; i < sizeof phases / sizeof phases[0]; i++) {
        char name[32];
        snprintf(name, sizeof name, "ns_%s", phases[i]);
        used += (size_t)snprintf(parts + used, sizeof parts - used, "%s %s %s",
                                 i > 0 ? "," : "", phases[i],
                                 format_ms((double)counters_get(step, name) / 1e6));
    }
    line(batch > 0 ? "last batch" : "last step", "%s%s by %" PRIu64 " %s:%s", what,
         format_ms((double)counters_get(step, "ns_step") / 1e6), threads,
         proto_plural(threads, "thread", "threads"), parts);
}

/* "steps p50 < 1 ms, p99 < 2 ms", or nothing; until the next call. */
static const char *quantiles_text(const char *what,
                                  const struct pccd_histogram_info *histogram)
{
    static char texts[2][96];
    static uint32_t next;
    char *text = texts[next++ % 2];
    text[0] = '\0';
    if (histogram->count > 0) {
        snprintf(text, sizeof texts[0], "%s p50 < %s, p99 < %s", what,
                 format_ms(histogram_quantile_s(histogram, 0.5) * 1e3),
                 format_ms(histogram_quantile_s(histogram, 0.99) * 1e3));
    }
    return text;
}

static void print_health(const struct health *health)
{
    if (health->count == 0) {
        printf("health     %sok%s\n", terminal_begin(TERMINAL_GREEN), terminal_end());
    }
    for (uint32_t i = 0; i < health->count; i++) {
        printf("%-*s%s", HEAD_COLUMNS, i == 0 ? "health" : "",
               terminal_begin(TERMINAL_YELLOW));
        columns_text(stdout, HEAD_COLUMNS, tool_shown(health->text[i]));
        printf("%s\n", terminal_end());
    }
}

static void print_team(const struct status *status)
{
    const struct counters *c = &status->counters;
    uint64_t processors = counters_get(c, "processors");
    uint64_t allowed = counters_get(c, "processors_allowed");
    char few[96] = "";
    if (processors < allowed) {
        snprintf(few, sizeof few,
                 "; on %" PRIu64 " of %" PRIu64 " processors: pccdctl doctor tells why",
                 processors, allowed);
    }
    line("team", "%" PRIu32 " %s at most%s%s", status->daemon.threads_max,
         proto_plural(status->daemon.threads_max, "thread", "threads"),
         counters_get(c, "threads_bound") != 0 ? ", each bound to a processor" : "", few);
}

static void print(const struct status *status)
{
    const struct counters *c = &status->counters;
    bool has_resident = status->resident_bytes > 0;
#define COUNT(name)           format_count((double)counters_get(c, name))
#define WORD(name, one, many) proto_plural(counters_get(c, name), one, many)
    line("daemon", "%s, process %" PRIu32 ", protocol %" PRIu32 ", %s",
         tool_shown(status->daemon.name), status->daemon.pid, status->daemon.version,
         tool_shown(status->daemon.cpu));
    line("socket", "%s", tool_shown(status->url));
    line("up for", "%s", format_span(counters_get(c, "uptime_ns")));
    line("sessions", "%s open (%s %s for %s), %s since the start; %s refused, %s dropped",
         COUNT("sessions_now"), COUNT("sessions_waiting_now"),
         WORD("sessions_waiting_now", "waits", "wait"),
         WORD("sessions_waiting_now", "its client", "their clients"),
         COUNT("sessions_total"), COUNT("sessions_refused"), COUNT("sessions_dropped"));
    line("scenes", "%s with %s %s; %s %s; %s %s in all", COUNT("scenes_now"),
         COUNT("objects_now"), WORD("objects_now", "object", "objects"),
         COUNT("meshes_now"), WORD("meshes_now", "mesh", "meshes"),
         COUNT("triangles_now"), WORD("triangles_now", "triangle", "triangles"));
    line("memory", "engine %s, shared %s%s%s%s",
         format_bytes((double)counters_get(c, "engine_bytes_now")),
         format_bytes((double)counters_get(c, "shm_bytes_now")),
         has_resident ? ", process " : "",
         has_resident ? format_bytes((double)status->resident_bytes) : "",
         has_resident ? " resident" : "");
    line("steps", "%s answered, %s of them incomplete; %s %s; %s %s", COUNT("steps"),
         COUNT("steps_incomplete"), COUNT("contacts"),
         WORD("contacts", "contact", "contacts"), COUNT("jobs_queued_now"),
         WORD("jobs_queued_now", "request waits", "requests wait"));
#undef WORD
#undef COUNT
    if (status->has_step) {
        print_step(status);
    }
    if (status->has_histograms && status->requests.count > 0) {
        const char *steps = quantiles_text("steps", &status->steps);
        line("latency", "%s%s%s", steps, steps[0] != '\0' ? "; " : "",
             quantiles_text("requests", &status->requests));
    }
    print_team(status);
    print_health(&status->health);
}

/* ---- for programs ------------------------------------------------------------------ */

static json_t *all_of(const struct counters *counters)
{
    json_t *object = json_object();
    counters_add(object, counters);
    return object;
}

static json_t *quantiles(const struct pccd_histogram_info *histogram)
{
    return json_pack("{s:I, s:f, s:f, s:f}", "count", (json_int_t)histogram->count,
                     "p50_below_s", histogram_quantile_s(histogram, 0.5), "p99_below_s",
                     histogram_quantile_s(histogram, 0.99), "mean_s",
                     histogram->count > 0
                         ? (double)histogram->ns_sum / 1e9 / (double)histogram->count
                         : 0.0);
}

static void print_json(const struct status *status)
{
    json_t *object = json_pack(
        "{s:s, s:I, s:I, s:s, s:s, s:s, s:I, s:I, s:b}", "daemon", status->daemon.name,
        "pid", (json_int_t)status->daemon.pid, "protocol",
        (json_int_t)status->daemon.version, "cpu", status->daemon.cpu, "url", status->url,
        "library", pccd_version(), "threads_max", (json_int_t)status->daemon.threads_max,
        "resident_bytes", (json_int_t)status->resident_bytes, "healthy",
        status->health.count == 0);
    json_t *warnings = json_array();
    for (uint32_t i = 0; i < status->health.count; i++) {
        json_array_append_new(warnings, json_text(status->health.text[i]));
    }
    json_object_set_new(object, "warnings", warnings);
    json_object_set_new(object, "counters", all_of(&status->counters));
    json_object_set_new(object, "last_step",
                        status->has_step ? all_of(&status->step) : json_null());
    if (status->has_histograms) {
        json_object_set_new(object, "steps", quantiles(&status->steps));
        json_object_set_new(object, "requests", quantiles(&status->requests));
    }
    (void)output_json(object, true, stdout);
}

static int run(struct pccd_client *client, void *to)
{
    const struct ctl_query *query = to;
    struct status *status = calloc(1, sizeof *status);
    if (status == NULL) {
        return ctl_complain("out of memory");
    }
    bool is_known = look(client, status) == PCCD_OK;
    if (is_known && query->is_json) {
        print_json(status);
    } else if (is_known) {
        print(status);
    }
    free(status);
    return is_known ? CTL_DONE : ctl_complain("status: %s", pccd_error_text(client));
}

int ctl_cmd_status(int argc, char **argv)
{
    struct ctl_query query = {.link = {.policy = CTL_LINK_EXISTING, .observes = true}};
    return ctl_link_command(&ctl_table_status, argc, argv, &query.link, run);
}
