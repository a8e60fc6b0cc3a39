/* report.c - what a run has shown.
 *
 * Room:     client/load.
 * Does:     see report.h.
 * Threads:  one.
 */
#include "report.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* A slope that is not noise, and that would add up to so much over the run, is growth. */
#define ERRORS_SURE   4.0
#define FLOORS_MIN    4u
#define GROWTH_KIB    512.0
#define GROWTH_PIECES 8.0

/* How much more a worker may hold at its end for each client, without any, than one that
 * has served them one by one. A full house of fifty leaves 0.7 to 0.9 MiB; with a leak of
 * 27 KiB a minute it is 2.2 after 20 minutes: what leaks keeps pages that are free else.
 */
#define IDLE_KIB 26

bool load_holdings_equal(const struct load_holdings *a, const struct load_holdings *b)
{
    bool equal = a->count == b->count;
    for (uint32_t i = 0; equal && i < a->count; i++) {
        equal = strcmp(a->name[i], b->name[i]) == 0 && a->value[i] == b->value[i];
    }
    return equal;
}

static bool print_counts(const struct load_tally *crowd, const struct load_tally *victims)
{
    printf("%-20s %12s %12s\n", "", "clients", "victims");
#define PRINT_COUNT(name, text)                                                          \
    printf("%-20s %12" PRIu64 " %12" PRIu64 "  %s\n", #name, crowd->name, victims->name, \
           text);
    LOAD_COUNTS(PRINT_COUNT)
#undef PRINT_COUNT
    bool adds_up = crowd->submitted == crowd->answered + crowd->refused +
                                           crowd->cancelled + crowd->failed + crowd->lost;
    bool is_right = crowd->failed + crowd->lost + crowd->doubled + crowd->crossed +
                            crowd->wrong + crowd->broken ==
                        0 &&
                    victims->doubled + victims->crossed + victims->wrong == 0;
    printf("%-20s %12s\n", "adds up", adds_up ? "yes" : "NO");
    return adds_up && is_right;
}

static void print_histogram(const char *name, const struct load_times *times)
{
    printf("%-20s %12.1f  p50, us\n", name,
           1e-3 * (double)load_times_quantile(times, 0.5));
    printf("%-20s %12.1f  p99\n", "", 1e-3 * (double)load_times_quantile(times, 0.99));
    printf("%-20s %12.1f  longest\n", "", 1e-3 * (double)times->longest_ns);
}

/* A process has many clients: an answer may wait in its socket while the process waits
 * for something else, so that the latency is that of the crowd, too. */
static void print_times(const struct load_tally *tally, double seconds)
{
    printf("%-20s %12.0f  answers a second\n", "rate",
           seconds > 0 ? (double)tally->answered / seconds : 0);
    print_histogram("latency", &tally->latency);
    print_histogram("in the daemon", &tally->inside);
}

/* Everybody's answers in one number: two runs with the same seed and the same clients
 * have the same. */
static void print_checksum(const struct load *load)
{
    uint64_t sum = 0;
    for (uint64_t i = 0; i < load->settings.clients * LOAD_ORDERS * LOAD_FRAMES; i++) {
        const struct load_truth *truth = &load->shared->truth[i];
        sum = load_mix(load_mix(sum ^ truth->hash[0], truth->hash[1]), truth->sum);
    }
    printf("%-20s %016" PRIx64 "\n", "checksum", sum);
}

static bool print_holdings(const struct load_holdings *before,
                           const struct load_holdings *after)
{
    for (uint32_t i = 0; i < before->count; i++) {
        uint64_t now = i < after->count ? after->value[i] : 0;
        printf("%-20s %12" PRIu64 " %12" PRIu64 "  before and after%s\n", before->name[i],
               before->value[i], now, now == before->value[i] ? "" : " DIFFER");
    }
    return load_holdings_equal(before, after);
}

/* What no client holds any more is free or leaked. Returns whether it is little. */
static bool print_idle(const struct load *load, const struct load_outcome *outcome)
{
    int64_t limit = outcome->idle_before_kib + (int64_t)IDLE_KIB * load->settings.clients;
    bool is_little = outcome->idle_before_kib > 0 && outcome->idle_after_kib > 0 &&
                     outcome->idle_after_kib <= limit;
    printf("%-20s %12" PRId64 " %12" PRId64 "  before and after, %" PRId64 " at most%s\n",
           "idle memory KiB", outcome->idle_before_kib, outcome->idle_after_kib, limit,
           is_little ? "" : " GROWS");
    return is_little || !load->settings.flat;
}

static bool print_slopes(const struct load *load, const struct load_watch *watch,
                         double seconds)
{
    static const char *const names[] = {"memory KiB", "descriptors", "mappings"};
    bool is_flat = true;
    for (enum load_gauge gauge = 0; gauge < LOAD_GAUGES; gauge++) {
        struct load_slope slope = load_watch_slope(watch, gauge);
        double growth = slope.per_min * seconds / 60;
        bool grows = slope.per_min > ERRORS_SURE * slope.error &&
                     growth > (gauge == LOAD_MEMORY ? GROWTH_KIB : GROWTH_PIECES);
        printf("%-20s %12.0f  floor; %+.3f +- %.3f a minute (%zu minutes)%s\n",
               names[gauge], slope.mean, slope.per_min, slope.error, slope.count,
               grows                       ? " GROWS"
               : slope.count >= FLOORS_MIN ? ""
                                           : " too short");
        is_flat = is_flat && !grows && slope.count >= FLOORS_MIN;
    }
    return is_flat || !load->settings.flat;
}

bool load_report(const struct load *load, const struct load_outcome *outcome,
                 const struct load_assault *assault, const struct load_watch *watch)
{
    struct load_tally crowd = {0};
    struct load_tally victims = {0};
    for (uint32_t i = 0; i < LOAD_PROCESS_MAX; i++) {
        load_tally_add(&crowd, &load->shared->crowd[i]);
    }
    for (uint32_t i = 0; i < LOAD_VICTIM_MAX; i++) {
        load_tally_add(&victims, &load->shared->victims[i]);
    }
    printf("%-20s %12u  in %u processes, %.1f s\n", "clients", load->settings.clients,
           load->settings.processes, outcome->seconds);
    printf("%-20s %12" PRIu64 "  clients, and %" PRIu64 " workers of the daemon\n",
           "killed", assault->kills, assault->crashes);
    bool is_right = print_counts(&crowd, &victims);
    print_times(&crowd, outcome->seconds);
    print_checksum(load);
    bool is_back = print_holdings(&outcome->before, &outcome->after);
    bool is_flat = print_slopes(load, watch, outcome->seconds);
    is_flat = print_idle(load, outcome) && is_flat;
    /* A round without contacts would prove little. */
    bool is_telling = outcome->truth_records > load->settings.clients;
    bool is_good = is_right && is_back && is_flat && is_telling && outcome->ended &&
                   outcome->bad_processes == 0 && assault->strays == 0 &&
                   !atomic_load(&load->shared->failed);
    printf("%-20s %12s\n", "all as it must be", is_good ? "yes" : "NO");
    return is_good;
}
