/* ipc.c - what it costs to ask pccdd, beside Redis, the least server and memcpy. */
#include <stdio.h>

#include "asker.h"
#include "rows.h"
#include "sections.h"

/* ---- two by turns ------------------------------------------------------------------ */

static bool is_json;
static unsigned missed;

void pairs_add(struct pairs *pairs, double ours, double anchor)
{
    bench_add(&pairs->ours, ours);
    bench_add(&pairs->anchor, anchor);
    bench_add(&pairs->ratio, ours / anchor);
}

static void print_heading(void)
{
    printf("%-4s%-42s %10s %-22s %10s %-4s %6s  %-8s %s\n", "row", "ours", "", "anchor",
           "", "", "ratio", "target", "");
}

void pairs_print(const struct pairs_row *row, struct pairs *pairs)
{
    if (pairs->ratio.count == 0) {
        return;
    }
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

/* ---- all of it --------------------------------------------------------------------- */

int section_ipc(const struct section_options *section)
{
    const struct bench_options *options = &section->bench;
    static const struct {
        const char *name;
        void (*measure)(const struct rows *rows);
    } parts[] = {{"trips", rows_trips},
                 {"crowd", rows_crowd},
                 {"updates", rows_updates},
                 {"busy", rows_busy}};
    struct redis redis;
    struct least least;
    bool has_redis = redis_start(&redis);
    if (!has_redis) {
        bench_skip("Redis", "it needs redis-server (Debian: apt install redis-server)");
    }
    is_json = options->json;
    least_start(&least, 3 * sizeof(float) * (size_t)ROWS_VERTICES_MAX);
    struct rows rows = {
        .redis = has_redis ? &redis : NULL, .least = &least, .smoke = options->smoke};
    rows.blocking = bench_connect(0, NULL);
    rows.spinning = bench_connect(50, pccd_url(rows.blocking));
    if (!is_json) {
        print_heading();
    }
    for (size_t i = 0; i < sizeof parts / sizeof parts[0]; i++) {
        if (bench_is_wanted(options, parts[i].name)) {
            parts[i].measure(&rows);
        }
    }
    if (!is_json) {
        printf("%u missed\n", missed);
    }
    pccd_close(rows.spinning);
    pccd_close(rows.blocking);
    least_stop(&least);
    redis_stop(&redis);
    return 0;
}
