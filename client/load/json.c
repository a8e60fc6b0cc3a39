/* json.c - what a run has shown, as one JSON object. */
#include <inttypes.h>
#include <stdio.h>

#include "report.h"

static const char *truth(bool value)
{
    return value ? "true" : "false";
}

static void print_settings(const struct load_settings *settings)
{
    printf("\"settings\":{\"clients\":%u,\"processes\":%u,\"depth\":%u,\"seed\":%" PRIu64
           ",\"loop\":\"%s\",\"hz\":%g,\"arrivals\":\"%s\",\"think_ms\":%u,"
           "\"ramp_s\":%g,\"warm_up_s\":%g,\"deadline_ms\":%g,\"stall_share\":%g,"
           "\"stall_ms\":%u,\"triangles_max\":%u},",
           settings->clients, settings->processes, settings->depth, settings->seed,
           settings->hz > 0 ? "open" : "closed", settings->hz,
           settings->poisson ? "poisson" : "fixed", settings->think_ms, settings->ramp_s,
           settings->warm_up_s, settings->deadline_ms, settings->stall_share,
           settings->stall_ms, load_sizes_largest(&settings->sizes));
}

static void print_tally(const char *name, const struct load_tally *tally)
{
    const char *comma = "";
    printf("\"%s\":{", name);
#define PRINT_COUNT(name, text)                                                          \
    printf("%s\"" #name "\":%" PRIu64, comma, tally->name);                              \
    comma = ",";
    LOAD_COUNTS(PRINT_COUNT)
#undef PRINT_COUNT
    printf(",\"records\":%" PRIu64 "},", tally->records);
}

static void print_histogram(const char *name, const struct load_hist *hist)
{
    static const struct {
        const char *name;
        double share;
    } shares[] = {
        {"p50", 0.5}, {"p90", 0.9}, {"p99", 0.99}, {"p99.9", 0.999}, {"p99.99", 0.9999}};
    printf("\"%s\":{\"count\":%" PRIu64, name, hist->count);
    for (size_t i = 0; i < sizeof shares / sizeof shares[0]; i++) {
        printf(",\"%s\":%.3f", shares[i].name,
               1e-3 * (double)load_hist_quantile(hist, shares[i].share));
    }
    printf(",\"max\":%.3f},", 1e-3 * (double)hist->longest_ns);
}

void load_report_json(const struct load_findings *f)
{
    printf("{");
    print_settings(&f->load->settings);
    printf("\"seconds\":%.3f,\"measured_s\":%.3f,\"killed_clients\":%" PRIu64
           ",\"killed_workers\":%" PRIu64 ",",
           f->outcome->seconds, f->measured_s, f->assault->kills, f->assault->crashes);
    print_tally("clients", &f->crowd);
    print_tally("victims", &f->victims);
    printf("\"rate\":%.3f,",
           f->measured_s > 0 ? (double)f->crowd.measured / f->measured_s : 0);
    print_histogram("latency_us", &f->crowd.latency);
    print_histogram("inside_us", &f->crowd.inside);
    printf("\"checksum\":\"%016" PRIx64 "\",\"idle_before_kib\":%" PRId64
           ",\"idle_after_kib\":%" PRId64 ",",
           f->checksum, f->outcome->idle_before_kib, f->outcome->idle_after_kib);
    printf("\"adds_up\":%s,\"is_right\":%s,\"is_back\":%s,\"is_flat\":%s,\"is_quick\":%s,"
           "\"ok\":%s}\n",
           truth(f->adds_up), truth(f->is_right), truth(f->is_back), truth(f->is_flat),
           truth(f->is_quick), truth(f->is_good));
}
