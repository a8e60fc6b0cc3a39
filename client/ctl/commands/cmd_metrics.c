/* cmd_metrics.c - pccdctl metrics. */
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "counters.h"
#include "ctl.h"
#include "link.h"
#include "shown.h"

const struct option_table ctl_table_metrics = {
    .parts = (const struct option_part[]){{&ctl_link_table, 0}, {0}},
    .text = "Print all counters, settings and latency histograms of a daemon as metrics "
            "for Prometheus, in its text format 0.0.4.",
    .more = "Prometheus takes them from its node exporter's textfile collector:\n"
            "  pccdctl metrics >pccd.prom.new && mv pccd.prom.new pccd.prom",
    .examples = "  pccdctl metrics\n"
                "  pccdctl metrics --socket /run/pccd/pccd.sock\n",
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
static void print_escaped(const char *text, bool is_label)
{
    for (; *text != '\0'; text++) {
        if (*text == '\\' || (is_label && *text == '"')) {
            putchar('\\');
        }
        putchar(*text == '\n' ? ' ' : *text);
    }
}

/* Help texts are part of the interface: of two files with one metric and different texts
 * the node exporter loses the second. */
static void print_head(const char *metric, const char *type, const char *text)
{
    printf("# HELP %s ", metric);
    print_escaped(text, false);
    printf("\n# TYPE %s %s\n", metric, type);
}

static void print_counters(const struct counters *counters)
{
    for (uint32_t i = 0; i < counters->count; i++) {
        struct metric metric = metric_of(counters->name[i]);
        print_head(metric.name, metric.is_gauge ? "gauge" : "counter", counters->text[i]);
        if (metric.is_time) {
            printf("%s %" PRIu64 ".%09" PRIu64 "\n", metric.name,
                   counters->value[i] / 1000000000u, counters->value[i] % 1000000000u);
        } else {
            printf("%s %" PRIu64 "\n", metric.name, counters->value[i]);
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
    char *end;
    double value = strtod(setting->value, &end);
    uint32_t i = 0;
    (void)context;
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
    print_head(name, "gauge", text);
    printf("%s %.15g\n", name, value * units[i].factor);
}

static void print_histogram(const char *metric, const char *text,
                            const struct pccd_histogram_info *histogram)
{
    uint64_t sum = 0;
    print_head(metric, "histogram", text);
    for (uint32_t i = 0; i < PCCD_HISTOGRAM_BUCKETS; i++) {
        double bound = histogram_bound_s(i);
        sum += histogram->bucket[i];
        if (isinf(bound)) {
            printf("%s_bucket{le=\"+Inf\"} %" PRIu64 "\n", metric, sum);
        } else {
            printf("%s_bucket{le=\"%.9g\"} %" PRIu64 "\n", metric, bound, sum);
        }
    }
    printf("%s_sum %" PRIu64 ".%09" PRIu64 "\n%s_count %" PRIu64 "\n", metric,
           histogram->ns_sum / 1000000000u, histogram->ns_sum % 1000000000u, metric,
           histogram->count);
}

static int print_all(struct pccd_client *client)
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
        return ctl_complain("metrics: %s", pccd_error_text(client));
    }
    print_head("pccd_daemon_info", "gauge", "what runs; always 1");
    printf("pccd_daemon_info{name=\"");
    print_escaped(tool_shown(daemon.name), true);
    printf("\",cpu=\"");
    print_escaped(tool_shown(daemon.cpu), true);
    printf("\"} 1\n");
    print_counters(&counters);
    if (pccd_config_get(client, NULL, print_setting, NULL) != PCCD_OK) {
        return ctl_complain("metrics: %s", pccd_error_text(client));
    }
    print_histogram("pccd_step_duration_seconds", "of steps, as computed", &steps);
    print_histogram("pccd_request_duration_seconds",
                    "of requests, from arrival to answer", &requests);
    return CTL_DONE;
}

int ctl_cmd_metrics(int argc, char **argv)
{
    struct ctl_link link = {.policy = CTL_LINK_EXISTING, .observes = true};
    struct pccd_client *client = NULL;
    if (option_parse(&ctl_table_metrics, argc, argv, &link) != 0) {
        return CTL_USAGE;
    }
    int status = ctl_link_open(&link, &client);
    if (status == CTL_DONE) {
        status = print_all(client);
    }
    pccd_close(client);
    ctl_link_deinit(&link);
    return status;
}
