/* output.c - what a measurement is written as: order statistics, text, CSV. */
#include "output.h"

#include <inttypes.h>

struct bench_summary run_summarise_time(const struct run_play *play, uint32_t side,
                                        enum run_time time)
{
    struct bench_samples samples = {NULL, 0, 0};
    for (uint32_t i = 0; i < play->count; i++) {
        bench_add(&samples, 1e-6 * (double)play->sides[side].frames[i].ns[time]);
    }
    struct bench_summary summary = bench_summarise(&samples);
    bench_free(&samples);
    return summary;
}

bool run_summarise_count(const struct run_play *play, uint32_t side, enum run_count count,
                         struct bench_summary *summary, uint64_t *total)
{
    struct bench_samples samples = {NULL, 0, 0};
    bool is_known = true;
    *total = 0;
    for (uint32_t i = 0; i < play->count; i++) {
        uint64_t value = play->sides[side].frames[i].counts[count];
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
    double step_ms = run_summarise_time(play, 0, RUN_STEP).p50;
    fprintf(to, "\n%-23s %11s %11s %11s %11s %11s %7s\n", "ms a step", "p50", "p95",
            "p99", "max", "min", "% step");
    for (enum run_time time = 0; time < RUN_TIMES; time++) {
        struct bench_summary s = run_summarise_time(play, 0, time);
        fprintf(to, "%-23s %11.4g %11.4g %11.4g %11.4g %11.4g %7.1f\n",
                run_times[time].name, s.p50, s.p95, s.p99, s.max, s.min,
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
        if (run_summarise_count(play, 0, count, &s, &total)) {
            fprintf(to, "%-23s %11.0f %11.0f %11.0f %11.0f %11.0f",
                    run_counts[count].name, s.p50, s.p95, s.p99, s.max, s.min);
            if (count < RUN_SCENE_BYTES) {
                fprintf(to, " %15" PRIu64, total);
            }
            fputc('\n', to);
        }
    }
}

/* The sides, a line each: medians, and medians of how many times as fast as the first. */
static void text_sides(FILE *to, const struct run_play *play)
{
    static const enum run_time columns[] = {RUN_STEP,  RUN_REFIT, RUN_TRAVERSAL,
                                            RUN_TESTS, RUN_MERGE, RUN_WALL};
    static const enum run_count counts[] = {RUN_BOX_TESTS, RUN_CANDIDATES, RUN_CONTACTS,
                                            RUN_THICK_SURVIVORS, RUN_THICK_EXACT};
    const size_t count = sizeof columns / sizeof columns[0];
    const size_t count_columns = sizeof counts / sizeof counts[0];
    fprintf(to, "\n%-40s", "ms a step (p50)");
    for (size_t c = 0; c < count; c++) {
        fprintf(to, " %9s", run_times[columns[c]].name);
    }
    fprintf(to, " %9s", "wall p99");
    for (size_t c = 0; c < count_columns; c++) {
        fprintf(to, " %15s", run_counts[counts[c]].name);
    }
    fprintf(to, " | %8s %8s  times as fast as the first\n", "step", "wall");
    for (uint32_t i = 0; i < play->settings->side_count; i++) {
        const struct run_sequence *side = &play->sides[i];
        const char *label = play->settings->sides[i].label;
        fprintf(to, "%-40s", i == 0 ? "the first" : label[0] ? label : "the same again");
        for (size_t c = 0; c < count; c++) {
            fprintf(to, " %9.4g", run_summarise_time(play, i, columns[c]).p50);
        }
        fprintf(to, " %9.4g", run_summarise_time(play, i, RUN_WALL).p99);
        for (size_t c = 0; c < count_columns; c++) {
            struct bench_summary number;
            uint64_t total;
            (void)run_summarise_count(play, i, counts[c], &number, &total);
            fprintf(to, " %15.0f", number.p50);
        }
        if (i > 0) {
            fprintf(to, " | %8.3f %8.3f", bench_summarise(&side->speed[RUN_STEP]).p50,
                    bench_summarise(&side->speed[RUN_WALL]).p50);
        }
        fputc('\n', to);
    }
}

bool run_write_text(FILE *to, const struct run_play *play)
{
    run_setup_each(play, text_item, to);
    text_times(to, play);
    text_counts(to, play);
    if (play->settings->side_count > 1) {
        text_sides(to, play);
    }
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

static void csv_heading(FILE *to, bool has_sides)
{
    fprintf(to, "frame,%sthreads", has_sides ? "side," : "");
    for (int t = 0; t < RUN_TIMES; t++) {
        fprintf(to, ",%s_ms", run_times[t].name);
    }
    for (int c = 0; c < RUN_COUNTS; c++) {
        fprintf(to, ",%s", run_counts[c].name);
    }
    fputs(",hash\n", to);
}

/* `side` NULL: there is one. */
static void csv_frame(FILE *to, const char *side, const struct run_frame *frame)
{
    fprintf(to, "%" PRIu32 ",%s%s%" PRIu32, frame->number, side ? side : "",
            side ? "," : "", frame->threads);
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
    char hash[PROTO_HASH_BYTES];
    fprintf(to, ",%s\n", proto_hash_text(PCCD_HASH_VERSION, frame->hash, hash));
}

bool run_write_csv(FILE *to, const struct run_play *play)
{
    run_setup_each(play, csv_item, to);
    uint32_t sides = play->settings->side_count;
    csv_heading(to, sides > 1);
    for (uint32_t i = 0; i < play->count; i++) {
        for (uint32_t s = 0; s < sides; s++) {
            csv_frame(to, sides > 1 ? play->settings->sides[s].label : NULL,
                      &play->sides[s].frames[i]);
        }
    }
    return !ferror(to);
}
