/* counters.c - the daemon's counters, to be looked up by name. */
#include "counters.h"

#include <math.h>
#include <string.h>

void counters_take(void *context, const char *name, uint64_t value, const char *text)
{
    struct counters *counters = context;
    if (counters->count < COUNTERS_MAX) {
        counters->name[counters->count] = name;
        counters->text[counters->count] = text;
        counters->value[counters->count++] = value;
    }
}

int counters_read(struct pccd_client *client, struct counters *counters)
{
    counters->count = 0;
    return pccd_stats(client, counters_take, counters);
}

uint64_t counters_get(const struct counters *counters, const char *name)
{
    for (uint32_t i = 0; i < counters->count; i++) {
        if (strcmp(counters->name[i], name) == 0) {
            return counters->value[i];
        }
    }
    return 0;
}

void counters_add(json_t *object, const struct counters *counters)
{
    for (uint32_t i = 0; i < counters->count; i++) {
        json_object_set_new(object, counters->name[i],
                            json_integer((json_int_t)counters->value[i]));
    }
}

static bool ends_in(const char *name, const char *end)
{
    size_t length = strlen(name), tail = strlen(end);
    return length >= tail && strcmp(name + length - tail, end) == 0;
}

bool counters_is_gauge(const char *name)
{
    static const char *const gauges[] = {"uptime_ns", "pid", "threads_bound",
                                         "processors", "processors_allowed"};
    for (size_t i = 0; i < sizeof gauges / sizeof gauges[0]; i++) {
        if (strcmp(name, gauges[i]) == 0) {
            return true;
        }
    }
    return ends_in(name, "_now") || ends_in(name, "_last") || ends_in(name, "_max");
}

double histogram_bound_s(uint32_t bucket)
{
    return bucket + 1 < PCCD_HISTOGRAM_BUCKETS ? ldexp(1e-9, (int)bucket + 10) : INFINITY;
}

double histogram_quantile_s(const struct pccd_histogram_info *histogram, double q)
{
    double below = 0;
    for (uint32_t i = 0; i < PCCD_HISTOGRAM_BUCKETS; i++) {
        below += (double)histogram->bucket[i];
        if (histogram->count > 0 && below >= q * (double)histogram->count) {
            return histogram_bound_s(i);
        }
    }
    return 0;
}
