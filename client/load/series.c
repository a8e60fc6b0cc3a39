/* series.c - a run, second by second. */
#include "report.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <unistd.h>

#define SECOND_NS  1000000000u
#define NINE_PARTS 20 /* of the percentiles: 0.9 is one nine, 0.99 two .. */
#define NINES_MAX  5.0

bool load_series_begin(struct load_series *series, const struct load *load)
{
    *series = (struct load_series){.begin_ns = common_now_ns(),
                                   .sum = calloc(1, sizeof *series->sum),
                                   .last = calloc(1, sizeof *series->last),
                                   .since = calloc(1, sizeof *series->since),
                                   .is_live = isatty(STDERR_FILENO) == 1};
    series->last_ns = series->begin_ns;
    if (!series->sum || !series->last || !series->since) {
        load_say("no memory");
        return false;
    }
    if (load->csv.to) {
        fprintf(load->csv.to, "second,answers_per_s,missed,p50_ms,p90_ms,p99_ms,p99.9_ms,"
                              "longest_ms\n");
    }
    return true;
}

/* Add the latencies of all clients but victims to *sum. */
static void load_series_sum(const struct load *load, struct load_hist *sum)
{
    for (uint32_t i = 0; i < load->settings.processes; i++) {
        load_hist_merge(sum, &load->shared->crowd[i].latency);
    }
}

static uint64_t count_answers(const struct load *load)
{
    uint64_t count = 0;
    for (uint32_t i = 0; i < load->settings.processes; i++) {
        const struct load_tally *tally = &load->shared->crowd[i];
        count += tally->answered + tally->refused + tally->cancelled + tally->failed;
    }
    return count;
}

static double quantile_ms(const struct load_hist *hist, double share)
{
    return 1e-6 * (double)load_hist_quantile(hist, share);
}

/* The seconds since the last one, until at_s. */
static void show(const struct load_series *series, const struct load *load, double at_s,
                 double answers_per_s)
{
    const struct load_hist *since = series->since;
    double deadline_ms = load->settings.deadline_ms;
    uint64_t missed =
        deadline_ms > 0 ? load_hist_above(since, (uint64_t)(1e6 * deadline_ms)) : 0;
    double p50_ms = quantile_ms(since, 0.5), p99_ms = quantile_ms(since, 0.99);
    double longest_ms = 1e-6 * (double)since->longest_ns;
    if (load->csv.to) {
        fprintf(load->csv.to, "%.3f,%.1f,%" PRIu64 ",", at_s, answers_per_s, missed);
    }
    if (load->csv.to && since->count > 0) {
        fprintf(load->csv.to, "%.4f,%.4f,%.4f,%.4f,%.4f\n", p50_ms,
                quantile_ms(since, 0.9), p99_ms, quantile_ms(since, 0.999), longest_ms);
    } else if (load->csv.to) {
        fputs(",,,,\n", load->csv.to); /* no latency is not one of 0 */
    }
    if (series->is_live) {
        fprintf(stderr,
                "\r%6.0f s %9.0f answers a second   p50 %.2f   p99 %.2f   longest %.2f ms"
                "   missed %" PRIu64 " \033[K",
                at_s, answers_per_s, p50_ms, p99_ms, longest_ms, missed);
    }
}

void load_series_turn(struct load_series *series, const struct load *load, bool at_end)
{
    uint64_t now_ns = common_now_ns();
    double length_s = 1e-9 * (double)(now_ns - series->last_ns);
    if (now_ns - series->last_ns < SECOND_NS && !at_end) {
        return;
    }
    memset(series->sum, 0, sizeof *series->sum);
    load_series_sum(load, series->sum);
    load_hist_since(series->sum, series->last, series->since);
    uint64_t answers = count_answers(load);
    show(series, load, 1e-9 * (double)(now_ns - series->begin_ns),
         (double)(answers - series->answers) / length_s);
    series->answers = answers;
    struct load_hist *spare = series->last;
    series->last = series->sum;
    series->sum = spare;
    series->last_ns = now_ns;
}

void load_series_end(struct load_series *series)
{
    if (series->is_live) {
        fputs("\r\033[K", stderr);
    }
    free(series->sum);
    free(series->last);
    free(series->since);
    *series = (struct load_series){0};
}

void load_write_percentiles(FILE *to, const struct load_hist *latency)
{
    double most = fmin(ceil(log10((double)latency->count + 1)), NINES_MAX);
    fputs("nines,percentile,latency_ms\n", to);
    for (int i = 0; i <= most * NINE_PARTS; i++) {
        double nines = (double)i / NINE_PARTS;
        double share = 1 - pow(10, -nines);
        fprintf(to, "%.3f,%.5f,%.4f\n", nines, 100 * share, quantile_ms(latency, share));
    }
}
