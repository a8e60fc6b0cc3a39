/* cmd_metrics.c - pccdctl metrics. */
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "counters.h"
#include "ctl.h"
#include "link.h"
#include "shown.h"

const struct option_table ctl_table_metrics = {
    .parts = (const struct option_part[]){{&ctl_link_table, 0}, {0}},
    .text = "Print all counters and latency histograms of a daemon as OpenMetrics "
            "text.",
    .more = "Prometheus takes it from its node exporter's textfile collector:\n"
            "  pccdctl metrics >pccd.prom.new && mv pccd.prom.new pccd.prom",
    .examples = "  pccdctl metrics\n"
                "  pccdctl metrics --socket /run/pccd/pccd.sock\n",
};

#define NAME_BYTES 96

/* A counter's family: times are in seconds, and said to be. */
struct family {
    char name[NAME_BYTES];
    bool is_gauge, is_time;
};

static struct family family_of(const char *counter)
{
    struct family family = {.is_gauge = counters_is_gauge(counter)};
    size_t length = strlen(counter);
    if (strncmp(counter, "ns_", 3) == 0) {
        family.is_time = true;
        snprintf(family.name, sizeof family.name, "pccd_%s_seconds", counter + 3);
    } else if (length > 3 && strcmp(counter + length - 3, "_ns") == 0) {
        family.is_time = true;
        snprintf(family.name, sizeof family.name, "pccd_%.*s_seconds", (int)length - 3,
                 counter);
    } else if (length > 6 && strcmp(counter + length - 6, "_total") == 0) {
        snprintf(family.name, sizeof family.name, "pccd_%.*s", (int)length - 6, counter);
    } else {
        snprintf(family.name, sizeof family.name, "pccd_%s", counter);
    }
    return family;
}

/* Backslash, quote and newline are escaped in HELP and in labels. */
static void print_escaped(const char *text)
{
    for (; *text != '\0'; text++) {
        if (*text == '\\' || *text == '"') {
            putchar('\\');
        }
        putchar(*text == '\n' ? ' ' : *text);
    }
}

static void print_head(const char *family, const char *type, const char *unit,
                       const char *text)
{
    printf("# TYPE %s %s\n", family, type);
    if (unit != NULL) {
        printf("# UNIT %s %s\n", family, unit);
    }
    printf("# HELP %s ", family);
    print_escaped(text);
    putchar('\n');
}

static void print_counters(const struct counters *counters)
{
    for (uint32_t i = 0; i < counters->count; i++) {
        struct family family = family_of(counters->name[i]);
        print_head(family.name, family.is_gauge ? "gauge" : "counter",
                   family.is_time ? "seconds" : NULL, counters->text[i]);
        printf("%s%s ", family.name, family.is_gauge ? "" : "_total");
        if (family.is_time) {
            printf("%" PRIu64 ".%09" PRIu64 "\n", counters->value[i] / 1000000000u,
                   counters->value[i] % 1000000000u);
        } else {
            printf("%" PRIu64 "\n", counters->value[i]);
        }
    }
}

static void print_histogram(const char *family, const char *text,
                            const struct pccd_histogram_info *histogram)
{
    uint64_t sum = 0;
    print_head(family, "histogram", "seconds", text);
    for (uint32_t i = 0; i < PCCD_HISTOGRAM_BUCKETS; i++) {
        double bound = histogram_bound_s(i);
        sum += histogram->bucket[i];
        if (isinf(bound)) {
            printf("%s_bucket{le=\"+Inf\"} %" PRIu64 "\n", family, sum);
        } else {
            printf("%s_bucket{le=\"%.9g\"} %" PRIu64 "\n", family, bound, sum);
        }
    }
    printf("%s_sum %" PRIu64 ".%09" PRIu64 "\n%s_count %" PRIu64 "\n", family,
           histogram->ns_sum / 1000000000u, histogram->ns_sum % 1000000000u, family,
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
    print_head("pccd_daemon", "info", NULL, "what runs");
    printf("pccd_daemon_info{name=\"");
    print_escaped(tool_shown(daemon.name));
    printf("\",cpu=\"");
    print_escaped(tool_shown(daemon.cpu));
    printf("\"} 1\n");
    print_counters(&counters);
    print_histogram("pccd_step_duration_seconds", "of steps, as computed", &steps);
    print_histogram("pccd_request_duration_seconds",
                    "of requests, from arrival to answer", &requests);
    puts("# EOF");
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
