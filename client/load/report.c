/* report.c - what a run has shown, a line for each figure. */
#include "report.h"

#include <inttypes.h>
#include <stdio.h>

#include "printable.h"

static void print_counts(const struct load_findings *f)
{
    printf("%-20s %12s %12s\n", "", "clients", "victims");
#define PRINT_COUNT(name, text)                                                          \
    printf("%-20s %12" PRIu64 " %12" PRIu64 "  %s\n", #name, f->crowd.name,              \
           f->victims.name, text);
    LOAD_COUNTS(PRINT_COUNT)
#undef PRINT_COUNT
    printf("%-20s %12s\n", "adds up", f->adds_up ? "yes" : "NO");
}

static void print_histogram(const char *name, const struct load_hist *hist)
{
    static const struct {
        const char *name;
        double share;
    } shares[] = {{"p50, us", 0.5},
                  {"p90", 0.9},
                  {"p99", 0.99},
                  {"p99.9", 0.999},
                  {"p99.99", 0.9999}};
    for (size_t i = 0; i < sizeof shares / sizeof shares[0]; i++) {
        printf("%-20s %12.1f  %s\n", i == 0 ? name : "",
               1e-3 * (double)load_hist_quantile(hist, shares[i].share), shares[i].name);
    }
    printf("%-20s %12.1f  longest\n", "", 1e-3 * (double)hist->longest_ns);
}

/* A process has many clients: an answer may wait in its socket while the process waits
 * for something else, so that the latency is that of the crowd, too. */
static void print_times(const struct load_findings *f)
{
    const struct load_settings *settings = &f->load->settings;
    printf("%-20s %12.0f  answers a second\n", "rate",
           f->measured_s > 0 ? (double)f->crowd.measured / f->measured_s : 0);
    if (settings->hz > 0) {
        printf("%-20s %12.0f  due a second, %.3f ms the deadline\n", "",
               settings->hz * settings->clients, settings->deadline_ms);
    }
    print_histogram("latency", &f->crowd.latency);
    print_histogram("in the daemon", &f->crowd.inside);
    if (settings->p99_ms > 0) {
        printf("%-20s %12s  at most %.3f ms\n", "p99 as asked",
               f->is_quick ? "yes" : "NO", settings->p99_ms);
    }
}

static void print_holdings(const struct load_holdings *before,
                           const struct load_holdings *after)
{
    for (uint32_t i = 0; i < before->count; i++) {
        uint64_t now = i < after->count ? after->value[i] : 0;
        printf("%-20s %12" PRIu64 " %12" PRIu64 "  before and after%s\n", before->name[i],
               before->value[i], now, now == before->value[i] ? "" : " DIFFER");
    }
}

static void print_memory(const struct load_findings *f)
{
    static const char *const names[] = {"memory KiB", "descriptors", "mappings"};
    for (enum load_gauge gauge = 0; gauge < LOAD_GAUGES; gauge++) {
        const struct load_slope *slope = &f->slopes[gauge];
        printf("%-20s %12.0f  floor; %+.3f +- %.3f a minute (%zu %s)%s\n", names[gauge],
               slope->mean, slope->per_min, slope->error, slope->count,
               proto_plural(slope->count, "minute", "minutes"),
               f->grows[gauge]                         ? " GROWS"
               : slope->count >= LOAD_WATCH_FLOORS_MIN ? ""
                                                       : " too short");
    }
    printf("%-20s %12" PRId64 " %12" PRId64 "  before and after, %" PRId64 " at most%s\n",
           "idle memory KiB", f->outcome->idle_before_kib, f->outcome->idle_after_kib,
           f->idle_limit_kib, f->is_little ? "" : " GROWS");
}

void load_report_text(const struct load_findings *f)
{
    const struct load_settings *settings = &f->load->settings;
    printf("%-20s %12u  in %u %s, %.1f s\n", "clients", settings->clients,
           settings->processes, proto_plural(settings->processes, "process", "processes"),
           f->outcome->seconds);
    printf("%-20s %12" PRIu64 "  %s, and %" PRIu64 " %s of the daemon\n", "killed",
           f->assault->kills, proto_plural(f->assault->kills, "client", "clients"),
           f->assault->crashes, proto_plural(f->assault->crashes, "worker", "workers"));
    print_counts(f);
    print_times(f);
    printf("%-20s %016" PRIx64 "\n", "checksum", f->checksum);
    if (!load_is_direct(f->load)) {
        print_holdings(&f->outcome->before, &f->outcome->after);
        print_memory(f);
    }
    printf("%-20s %12s\n", "all as it must be", f->is_good ? "yes" : "NO");
}
