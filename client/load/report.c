/* report.c - what a run has shown, a line for each figure or as one JSON object. */
#include "report.h"

#include <inttypes.h>
#include <stdarg.h>

#include "printable.h"
#include "shown.h"

/* The lines that one process may print of its clients: after that it only counts. */
#define LINES_MAX 20u

static const struct {
    const char *name;
    double share;
} quantiles[] = {
    {"p50", 0.5}, {"p90", 0.9}, {"p99", 0.99}, {"p99.9", 0.999}, {"p99.99", 0.9999}};
#define QUANTILES (sizeof quantiles / sizeof quantiles[0])

static double quantile_us(const struct load_hist *hist, size_t i)
{
    return 1e-3 * (double)load_hist_quantile(hist, quantiles[i].share);
}

static double rate_of(const struct load_findings *f)
{
    return f->measured_s > 0 ? (double)f->crowd.measured / f->measured_s : 0;
}

void load_say(const char *format, ...)
{
    static unsigned said; /* of this process */
    char line[1024];
    if (++said > LINES_MAX) {
        return;
    }
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(line, sizeof line, format, arguments);
    va_end(arguments);
    fprintf(stderr, "pccd-load: %s%s\n", tool_shown(line),
            said == LINES_MAX ? " (and so on)" : "");
}

/* ---- text -------------------------------------------------------------------------- */

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
    for (size_t i = 0; i < QUANTILES; i++) {
        printf("%-20s %12.1f  %s%s\n", i == 0 ? name : "", quantile_us(hist, i),
               quantiles[i].name, i == 0 ? ", us" : "");
    }
    printf("%-20s %12.1f  longest\n", "", 1e-3 * (double)hist->longest_ns);
}

/* A process has many clients: an answer may wait in its socket while the process waits
 * for something else, so that the latency is that of the crowd, too. */
static void print_times(const struct load_findings *f)
{
    const struct load_settings *settings = &f->load->settings;
    printf("%-20s %12.0f  answers a second\n", "rate", rate_of(f));
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

/* ---- JSON -------------------------------------------------------------------------- */

static const char *truth(bool value)
{
    return value ? "true" : "false";
}

static void write_settings(const struct load_settings *settings)
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

static void write_tally(const char *name, const struct load_tally *tally)
{
    const char *comma = "";
    printf("\"%s\":{", name);
#define WRITE_COUNT(name, text)                                                          \
    printf("%s\"" #name "\":%" PRIu64, comma, tally->name);                              \
    comma = ",";
    LOAD_COUNTS(WRITE_COUNT)
#undef WRITE_COUNT
    printf(",\"records\":%" PRIu64 "},", tally->records);
}

static void write_histogram(const char *name, const struct load_hist *hist)
{
    printf("\"%s\":{\"count\":%" PRIu64, name, hist->count);
    for (size_t i = 0; i < QUANTILES; i++) {
        printf(",\"%s\":%.3f", quantiles[i].name, quantile_us(hist, i));
    }
    printf(",\"max\":%.3f},", 1e-3 * (double)hist->longest_ns);
}

void load_report_json(const struct load_findings *f)
{
    printf("{");
    write_settings(&f->load->settings);
    printf("\"seconds\":%.3f,\"measured_s\":%.3f,\"killed_clients\":%" PRIu64
           ",\"killed_workers\":%" PRIu64 ",",
           f->outcome->seconds, f->measured_s, f->assault->kills, f->assault->crashes);
    write_tally("clients", &f->crowd);
    write_tally("victims", &f->victims);
    printf("\"rate\":%.3f,", rate_of(f));
    write_histogram("latency_us", &f->crowd.latency);
    write_histogram("inside_us", &f->crowd.inside);
    printf("\"checksum\":\"%016" PRIx64 "\",\"idle_before_kib\":%" PRId64
           ",\"idle_after_kib\":%" PRId64 ",",
           f->checksum, f->outcome->idle_before_kib, f->outcome->idle_after_kib);
    printf("\"adds_up\":%s,\"is_right\":%s,\"is_back\":%s,\"is_flat\":%s,\"is_quick\":%s,"
           "\"ok\":%s}\n",
           truth(f->adds_up), truth(f->is_right), truth(f->is_back), truth(f->is_flat),
           truth(f->is_quick), truth(f->is_good));
}
