/* pairs.c - what is measured by turns, and the table of it. */
#include "rows.h"

#include <stdio.h>

static bool is_json;
static unsigned missed;

void pairs_add(struct pairs *pairs, double ours, double anchor)
{
    bench_add(&pairs->ours, ours);
    bench_add(&pairs->anchor, anchor);
    bench_add(&pairs->ratio, ours / anchor);
}

double pairs_take_median(struct bench_samples *samples)
{
    double median = bench_summarise(samples).p50;
    bench_clear(samples);
    return median;
}

void pairs_heading(bool json)
{
    is_json = json;
    if (!json) {
        printf("%-4s%-42s %10s %-22s %10s %-4s %6s  %-8s %s\n", "row", "ours", "",
               "anchor", "", "", "ratio", "target", "");
    }
}

void pairs_print(const struct pairs_row *row, struct pairs *pairs)
{
    double ours = bench_summarise(&pairs->ours).p50;
    double anchor = bench_summarise(&pairs->anchor).p50;
    double ratio = bench_summarise(&pairs->ratio).p50;
    bool is_met =
        row->want == PAIRS_AT_MOST ? ratio <= row->target : ratio >= row->target;
    const char *verdict = row->want == PAIRS_TOLD ? "" : is_met ? "met" : "missed";
    missed += row->want != PAIRS_TOLD && !is_met;
    if (is_json) {
        printf("{\"row\":\"%s\",\"what\":\"%s\",\"anchor\":\"%s\",\"unit\":\"%s\","
               "\"ours_p50\":%.3f,\"anchor_p50\":%.3f,\"ratio\":%.4f,\"target\":%.2f,"
               "\"verdict\":\"%s\",\"turns\":%zu}\n",
               row->number, row->what, row->anchor, row->unit, ours, anchor, ratio,
               row->target, verdict, pairs->ratio.count);
    } else {
        char target[16] = "";
        if (row->want != PAIRS_TOLD) {
            snprintf(target, sizeof target, "%s %.2f",
                     row->want == PAIRS_AT_MOST ? "<=" : ">=", row->target);
        }
        printf("%-4s%-42s %10.1f %-22s %10.1f %-4s %6.2f  %-8s %s\n", row->number,
               row->what, ours, row->anchor, anchor, row->unit, ratio, target, verdict);
        fflush(stdout);
    }
    bench_free(&pairs->ours);
    bench_free(&pairs->anchor);
    bench_free(&pairs->ratio);
}

unsigned pairs_missed(void)
{
    return missed;
}
