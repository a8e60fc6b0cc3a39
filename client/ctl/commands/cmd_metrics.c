/* cmd_metrics.c - pccdctl metrics. */
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "counters.h"
#include "ctl.h"
#include "http.h"
#include "link.h"
#include "printable.h"

struct metrics_options {
    struct ctl_link link;
    const char *path; /* NULL: print once */
};

static const struct option_row rows[] = {
    CTL_OUTPUT,
    {"listen", 0, "PATH",
     "Answer GET /metrics and GET /health over HTTP on a Unix socket at PATH, until "
     "interrupted",
     OPTION_TEXT, .at = offsetof(struct metrics_options, path)},
    {0}};

const struct option_table ctl_table_metrics = {
    .rows = rows,
    .parts =
        (const struct option_part[]){
            {&ctl_link_table, offsetof(struct metrics_options, link)}, {0}},
    .text = "Print all counters, settings and latency histograms of a daemon, and what "
            "each user has there, as metrics for Prometheus, in its text format 0.0.4.",
    .more = "Prometheus takes them from its node exporter's textfile collector:\n"
            "  pccdctl metrics >pccd.prom.new && mv pccd.prom.new pccd.prom",
    .examples = "  pccdctl metrics\n"
                "  pccdctl metrics --listen /run/pccd/metrics.sock\n",
};

#define NAME_BYTES 96

/* A counter's metric: times are in seconds. */
struct metric {
    char name[NAME_BYTES];
    bool is_gauge, is_time;
};

static struct metric metric_of(const char *counter)
{
    struct metric metric = {.is_gauge = counters_is_gauge(counter)};
    const char *total = metric.is_gauge ? "" : "_total";
    size_t length = strlen(counter);
    if (strncmp(counter, "ns_", 3) == 0) {
        metric.is_time = true;
        snprintf(metric.name, NAME_BYTES, "pccd_%s_seconds%s", counter + 3, total);
    } else if (length > 3 && strcmp(counter + length - 3, "_ns") == 0) {
        metric.is_time = true;
        snprintf(metric.name, NAME_BYTES, "pccd_%.*s_seconds%s", (int)length - 3, counter,
                 total);
    } else if (length > 6 && strcmp(counter + length - 6, "_total") == 0) {
        snprintf(metric.name, NAME_BYTES, "pccd_%s", counter);
    } else {
        snprintf(metric.name, NAME_BYTES, "pccd_%s%s", counter, total);
    }
    return metric;
}

/* Escape backslash and newline, and in labels the quote, too. */
static void print_escaped(FILE *to, const char *text, bool is_label)
{
    for (; *text != '\0'; text++) {
        if (*text == '\\' || (is_label && *text == '"')) {
            putc('\\', to);
        }
        putc(*text == '\n' ? ' ' : *text, to);
    }
}

/* Print the value of a label, safe for a terminal, too. */
static void print_label(FILE *to, const char *text)
{
    char shown[1024];
    proto_printable(text, strlen(text), shown, sizeof shown);
    print_escaped(to, shown, true);
}

/* Help texts are part of the interface: of two files with one metric and different texts
 * the node exporter loses the second. */
static void print_head(FILE *to, const char *metric, const char *type, const char *text)
{
    fprintf(to, "# HELP %s ", metric);
    print_escaped(to, text, false);
    fprintf(to, "\n# TYPE %s %s\n", metric, type);
}

static void print_counters(FILE *to, const struct counters *counters)
{
    for (uint32_t i = 0; i < counters->count; i++) {
        struct metric metric = metric_of(counters->name[i]);
        print_head(to, metric.name, metric.is_gauge ? "gauge" : "counter",
                   counters->text[i]);
        if (metric.is_time) {
            fprintf(to, "%s %" PRIu64 ".%09" PRIu64 "\n", metric.name,
                    counters->value[i] / 1000000000u, counters->value[i] % 1000000000u);
        } else {
            fprintf(to, "%s %" PRIu64 "\n", metric.name, counters->value[i]);
        }
    }
}

/* Units as Prometheus has them: bytes for MiB, seconds for milliseconds. Settings that
 * are words are left out: a metric is a number. */
static void print_setting(void *context, const struct pccd_setting *setting)
{
    static const struct {
        const char *ending, *unit, *said;
        double factor;
    } units[] = {{"-mib", "_bytes", " (here: bytes)", 1048576},
                 {"-ms", "_seconds", " (here: seconds)", 1e-3},
                 {"", "", "", 1}};
    char name[NAME_BYTES], text[2 * NAME_BYTES];
    FILE *to = context;
    char *end;
    double value = strtod(setting->value, &end);
    uint32_t i = 0;
    if (end == setting->value || *end != '\0') {
        return;
    }
    size_t length = strlen(setting->name), ending = strlen(units[0].ending);
    while (ending > length || strcmp(setting->name + length - ending, units[i].ending)) {
        ending = strlen(units[++i].ending);
    }
    snprintf(name, sizeof name, "pccd_setting_%.*s%s", (int)(length - ending),
             setting->name, units[i].unit);
    for (char *dash = strchr(name, '-'); dash != NULL; dash = strchr(dash, '-')) {
        *dash = '_';
    }
    snprintf(text, sizeof text, "%s%s", setting->text, units[i].said);
    print_head(to, name, "gauge", text);
    fprintf(to, "%s %.15g\n", name, value * units[i].factor);
}

static void print_histogram(FILE *to, const char *metric, const char *text,
                            const struct pccd_histogram_info *histogram)
{
    uint64_t sum = 0;
    print_head(to, metric, "histogram", text);
    for (uint32_t i = 0; i < PCCD_HISTOGRAM_BUCKETS; i++) {
        double bound = histogram_bound_s(i);
        sum += histogram->bucket[i];
        if (isinf(bound)) {
            fprintf(to, "%s_bucket{le=\"+Inf\"} %" PRIu64 "\n", metric, sum);
        } else {
            fprintf(to, "%s_bucket{le=\"%.9g\"} %" PRIu64 "\n", metric, bound, sum);
        }
    }
    fprintf(to, "%s_sum %" PRIu64 ".%09" PRIu64 "\n%s_count %" PRIu64 "\n", metric,
            histogram->ns_sum / 1000000000u, histogram->ns_sum % 1000000000u, metric,
            histogram->count);
}

/* ---- by user ----------------------------------------------------------------------- */

#define USERS_MAX 256u /* those beyond are counted together, as user "others" */

struct user {
    uint32_t uid;
    uint64_t value[8]; /* in the order of user_metrics */
};

struct users {
    struct user list[USERS_MAX + 1];
    uint32_t count;
};

/* Name what is told of a user's open sessions: what one has done goes with it, so none is
 * a counter. */
static const struct {
    const char *name, *text;
} user_metrics[] = {{"pccd_user_sessions", "sessions of a user"},
                    {"pccd_user_requests", "requests in flight of a user"},
                    {"pccd_user_scenes", "scenes of a user"},
                    {"pccd_user_triangles", "triangles of the objects of a user"},
                    {"pccd_user_shared_bytes", "shared memory of a user"},
                    {"pccd_user_steps", "steps of a user's open sessions"},
                    {"pccd_user_step_seconds", "time of steps of a user's open sessions"},
                    {"pccd_user_errors", "error answers to a user's open sessions"}};

static void add_session(void *context, const struct pccd_session_info *info)
{
    struct users *users = context;
    const uint64_t values[] = {
        1,           info->requests, info->scenes, info->triangles, info->shm_bytes,
        info->steps, info->ns_step,  info->errors};
    uint32_t i = 0;
    while (i < users->count && users->list[i].uid != info->uid) {
        i++;
    }
    if (i == users->count && i < USERS_MAX) {
        users->list[users->count++].uid = info->uid;
    }
    for (uint32_t k = 0; k < sizeof values / sizeof values[0]; k++) {
        users->list[i].value[k] += values[k];
    }
}

static void print_user_value(FILE *to, uint32_t metric, const char *user, uint64_t value)
{
    if (strstr(user_metrics[metric].name, "_seconds") != NULL) {
        fprintf(to, "%s{user=\"%s\"} %" PRIu64 ".%09" PRIu64 "\n",
                user_metrics[metric].name, user, value / 1000000000u,
                value % 1000000000u);
    } else {
        fprintf(to, "%s{user=\"%s\"} %" PRIu64 "\n", user_metrics[metric].name, user,
                value);
    }
}

static int print_users(FILE *to, struct pccd_client *client)
{
    struct users users = {.count = 0};
    char user[16];
    int status = pccd_list_sessions(client, add_session, &users);
    if (status != PCCD_OK) {
        return status;
    }
    for (uint32_t k = 0; k < sizeof user_metrics / sizeof user_metrics[0]; k++) {
        print_head(to, user_metrics[k].name, "gauge", user_metrics[k].text);
        for (uint32_t i = 0; i < users.count; i++) {
            snprintf(user, sizeof user, "%" PRIu32, users.list[i].uid);
            print_user_value(to, k, user, users.list[i].value[k]);
        }
        if (users.list[USERS_MAX].value[0] > 0) {
            print_user_value(to, k, "others", users.list[USERS_MAX].value[k]);
        }
    }
    return PCCD_OK;
}

/* ---- all --------------------------------------------------------------------------- */

/* Returns a status; the client's error text says why. */
static int print_all(FILE *to, struct pccd_client *client)
{
    struct counters counters;
    struct pccd_histogram_info steps, requests;
    struct pccd_daemon_info daemon;
    int status = counters_read(client, &counters);
    if (status == PCCD_OK) {
        status = pccd_histogram(client, PCCD_HISTOGRAM_STEPS, &steps);
    }
    if (status == PCCD_OK) {
        status = pccd_histogram(client, PCCD_HISTOGRAM_REQUESTS, &requests);
    }
    if (status == PCCD_OK) {
        status = pccd_daemon(client, &daemon);
    }
    if (status != PCCD_OK) {
        return status;
    }
    print_head(to, "pccd_daemon_info", "gauge", "what runs; always 1");
    fprintf(to, "pccd_daemon_info{name=\"");
    print_label(to, daemon.name);
    fprintf(to, "\",cpu=\"");
    print_label(to, daemon.cpu);
    fprintf(to, "\"} 1\n");
    print_counters(to, &counters);
    status = pccd_config_get(client, NULL, print_setting, to);
    if (status == PCCD_OK) {
        status = print_users(to, client);
    }
    print_histogram(to, "pccd_step_duration_seconds", "time of a step, computed", &steps);
    print_histogram(to, "pccd_request_duration_seconds",
                    "time of a request, from arrival to answer", &requests);
    return status;
}

/* ---- over HTTP --------------------------------------------------------------------- */

/* Answer a request: the daemon is asked anew each time, so that one that was started
 * again is found. */
static unsigned answer(void *context, const char *url, FILE *to)
{
    const struct pccd_options *asked = context;
    struct pccd_client *client = NULL;
    uint64_t round_trip_ns;
    bool is_health = strcmp(url, "/health") == 0;
    if (!is_health && strcmp(url, "/metrics") != 0) {
        fputs("there are /metrics and /health\n", to);
        return HTTP_NOT_FOUND;
    }
    int status = pccd_connect(asked, &client);
    if (status == PCCD_OK) {
        status = is_health ? pccd_ping(client, &round_trip_ns) : print_all(to, client);
    }
    if (status != PCCD_OK) {
        fprintf(to, "no answer of the daemon: %s\n", pccd_error_text(client));
    } else if (is_health) {
        fputs("ok\n", to);
    }
    pccd_close(client);
    return status == PCCD_OK ? HTTP_OK : HTTP_UNAVAILABLE;
}

/* ---- the command ------------------------------------------------------------------- */

int ctl_cmd_metrics(int argc, char **argv)
{
    struct metrics_options options = {
        .link = {.policy = CTL_LINK_EXISTING, .observes = true}};
    struct pccd_client *client = NULL;
    if (option_parse(&ctl_table_metrics, argc, argv, &options) != 0) {
        return CTL_USAGE;
    }
    if (options.path != NULL) {
        struct pccd_options asked;
        ctl_link_options(&options.link, &asked);
        int status = http_serve(options.path, answer, &asked);
        ctl_link_deinit(&options.link);
        return status;
    }
    int status = ctl_link_open(&options.link, &client);
    if (status == CTL_DONE && print_all(stdout, client) != PCCD_OK) {
        status = ctl_complain("metrics: %s", pccd_error_text(client));
    }
    pccd_close(client);
    ctl_link_deinit(&options.link);
    return status;
}
