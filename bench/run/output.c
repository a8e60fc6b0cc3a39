/* bench/run/output.c - what a measurement is written as: order statistics, text, CSV.
 *
 * Room:     bench/run.
 * Does:     see output.h; JSON is in output_json.c.
 * Does not: average times: a mean hides what a busy machine did to a few steps.
 * Threads:  one.
 */
#include "output.h"

#include <inttypes.h>
#include <string.h>

#include "setup.h"

struct bench_summary run_summarise_time(const struct run_play *play, enum run_time time)
{
    struct bench_samples samples = {NULL, 0, 0};
    for (uint32_t i = 0; i < play->count; i++) {
        bench_add(&samples, 1e-6 * (double)play->frames[i].ns[time]);
    }
    struct bench_summary summary = bench_summarise(&samples);
    bench_free(&samples);
    return summary;
}

bool run_summarise_count(const struct run_play *play, enum run_count count,
                         struct bench_summary *summary, uint64_t *total)
{
    struct bench_samples samples = {NULL, 0, 0};
    bool is_known = true;
    *total = 0;
    for (uint32_t i = 0; i < play->count; i++) {
        uint64_t value = play->frames[i].counts[count];
        is_known = is_known && value != RUN_UNKNOWN;
        *total += value;
        bench_add(&samples, (double)value);
    }
    *summary = bench_summarise(&samples);
    bench_free(&samples);
    return is_known;
}

/* ---- text -------------------------------------------------------------------------- */

static void text_item(void *context, const char *name, const char *text, uint64_t number)
{
    FILE *to = context;
    if (text) {
        fprintf(to, "%-15s %s\n", name, text);
    } else {
        fprintf(to, "%-15s %" PRIu64 "\n", name, number);
    }
}

static void text_times(FILE *to, const struct run_play *play)
{
    double step_ms = run_summarise_time(play, RUN_STEP).p50;
    fprintf(to, "\n%-23s %11s %11s %11s %11s %11s %7s\n", "ms a step", "p50", "p95",
            "p99", "max", "min", "% step");
    for (enum run_time time = 0; time < RUN_TIMES; time++) {
        struct bench_summary s = run_summarise_time(play, time);
        fprintf(to, "%-23s %11.4g %11.4g %11.4g %11.4g %11.4g %7.1f\n",
                run_time_names[time], s.p50, s.p95, s.p99, s.max, s.min,
                step_ms > 0 ? 100 * s.p50 / step_ms : 0);
    }
}

static void text_counts(FILE *to, const struct run_play *play)
{
    fprintf(to, "\n%-23s %11s %11s %11s %11s %11s %15s\n", "a step", "p50", "p95", "p99",
            "max", "min", "all");
    for (enum run_count count = 0; count < RUN_COUNTS; count++) {
        struct bench_summary s;
        uint64_t total;
        if (run_summarise_count(play, count, &s, &total)) {
            fprintf(to, "%-23s %11.0f %11.0f %11.0f %11.0f %11.0f",
                    run_count_names[count], s.p50, s.p95, s.p99, s.max, s.min);
            if (count < RUN_SCENE_BYTES) {
                fprintf(to, " %15" PRIu64, total);
            }
            fputc('\n', to);
        }
    }
}

bool run_write_text(FILE *to, const struct run_play *play)
{
    run_setup_each(play, text_item, to);
    text_times(to, play);
    text_counts(to, play);
    return !ferror(to);
}

/* ---- CSV --------------------------------------------------------------------------- */

static void csv_item(void *context, const char *name, const char *text, uint64_t number)
{
    FILE *to = context;
    if (text) {
        fprintf(to, "# %s: %s\n", name, text);
    } else {
        fprintf(to, "# %s: %" PRIu64 "\n", name, number);
    }
}

static void csv_heading(FILE *to)
{
    fputs("frame,threads", to);
    for (int t = 0; t < RUN_TIMES; t++) {
        fprintf(to, ",%s_ms", run_time_names[t]);
    }
    for (int c = 0; c < RUN_COUNTS; c++) {
        fprintf(to, ",%s", run_count_names[c]);
    }
    fputs(",hash\n", to);
}

static void csv_frame(FILE *to, const struct run_frame *frame)
{
    fprintf(to, "%" PRIu32 ",%" PRIu32, frame->number, frame->threads);
    for (int t = 0; t < RUN_TIMES; t++) {
        fprintf(to, ",%.6f", 1e-6 * (double)frame->ns[t]);
    }
    for (int c = 0; c < RUN_COUNTS; c++) {
        if (frame->counts[c] == RUN_UNKNOWN) {
            fputc(',', to);
        } else {
            fprintf(to, ",%" PRIu64, frame->counts[c]);
        }
    }
    fprintf(to, ",%016" PRIx64 "%016" PRIx64 "\n", frame->hash[0], frame->hash[1]);
}

bool run_write_csv(FILE *to, const struct run_play *play)
{
    run_setup_each(play, csv_item, to);
    csv_heading(to);
    for (uint32_t i = 0; i < play->count; i++) {
        csv_frame(to, &play->frames[i]);
    }
    return !ferror(to);
}
