/* series.c - a run, second by second. */
#include "series.h"

#include <stdlib.h>
#include <unistd.h>

#define SECOND_NS 1000000000u

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
    series->csv = load->csv.to;
    if (series->csv) {
        fprintf(series->csv, "second,answers_per_s,missed,p50_ms,p90_ms,p99_ms,p99.9_ms,"
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

static struct load_second second_of(const struct load_hist *since, double deadline_ms)
{
    struct load_second second = {.measured = since->count,
                                 .p50_ms = quantile_ms(since, 0.5),
                                 .p90_ms = quantile_ms(since, 0.9),
                                 .p99_ms = quantile_ms(since, 0.99),
                                 .p999_ms = quantile_ms(since, 0.999),
                                 .longest_ms = 1e-6 * (double)since->longest_ns};
    if (deadline_ms > 0) {
        second.missed = load_hist_above(since, (uint64_t)(1e6 * deadline_ms));
    }
    return second;
}

static void show(const struct load_series *series, const struct load_second *s)
{
    if (series->csv) {
        fprintf(series->csv, "%.3f,%.1f,%llu,", s->at_s, (double)s->answers / s->length_s,
                (unsigned long long)s->missed);
        if (s->measured > 0) {
            fprintf(series->csv, "%.4f,%.4f,%.4f,%.4f,%.4f\n", s->p50_ms, s->p90_ms,
                    s->p99_ms, s->p999_ms, s->longest_ms);
        } else {
            fputs(",,,,\n", series->csv); /* no latency is not one of 0 */
        }
    }
    if (series->is_live) {
        fprintf(stderr,
                "\r%6.0f s %9.0f answers a second   p50 %.2f   p99 %.2f   longest %.2f ms"
                "   missed %llu \033[K",
                s->at_s, (double)s->answers / s->length_s, s->p50_ms, s->p99_ms,
                s->longest_ms, (unsigned long long)s->missed);
    }
}

static void keep(struct load_series *series, const struct load_second *second)
{
    if (series->count == series->capacity) {
        size_t capacity = 2 * series->capacity + 64;
        struct load_second *seconds =
            realloc(series->seconds, capacity * sizeof *series->seconds);
        if (!seconds) {
            return; /* the plot has less of it */
        }
        series->seconds = seconds;
        series->capacity = capacity;
    }
    series->seconds[series->count++] = *second;
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
    struct load_second second = second_of(series->since, load->settings.deadline_ms);
    uint64_t answers = count_answers(load);
    second.answers = answers - series->answers;
    series->answers = answers;
    second.at_s = 1e-9 * (double)(now_ns - series->begin_ns);
    second.length_s = length_s;
    struct load_hist *spare = series->last;
    series->last = series->sum;
    series->sum = spare;
    series->last_ns = now_ns;
    show(series, &second);
    keep(series, &second);
}

void load_series_end(struct load_series *series)
{
    if (series->is_live) {
        fputs("\r\033[K", stderr);
    }
    free(series->sum);
    free(series->last);
    free(series->since);
    free(series->seconds);
    *series = (struct load_series){0};
}
