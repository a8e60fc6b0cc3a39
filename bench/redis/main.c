/* main.c - what it costs to ask pccdd, beside what it costs to ask Redis. */
#include <stdio.h>

#include "asker.h"
#include "rows.h"

static void measure(const struct rows *rows, const struct bench_options *options)
{
    pairs_heading(options->json);
    if (bench_is_wanted(options, "trips")) {
        rows_trips(rows);
    }
    if (bench_is_wanted(options, "crowd")) {
        rows_crowd(rows);
    }
    if (bench_is_wanted(options, "updates")) {
        rows_updates(rows);
    }
    if (bench_is_wanted(options, "busy")) {
        rows_busy(rows);
    }
    if (!options->json) {
        printf("%u missed\n", pairs_missed());
    }
}

int main(int argc, char **argv)
{
    struct bench_options options;
    struct redis redis;
    struct least least;
    int exit_status;
    if (!bench_begin("beside_redis", argc, argv, &options, &exit_status)) {
        return exit_status;
    }
    if (!redis_start(&redis)) {
        bench_skip("all", "it needs redis-server (Debian: apt install redis-server)");
        return 77;
    }
    least_start(&least, 3 * sizeof(float) * (size_t)ROWS_VERTICES_MAX);
    struct rows rows = {.redis = &redis, .least = &least, .smoke = options.smoke};
    rows.blocking = bench_connect(0, NULL);
    rows.spinning = bench_connect(50, pccd_url(rows.blocking));
    measure(&rows, &options);
    pccd_close(rows.spinning);
    pccd_close(rows.blocking);
    least_stop(&least);
    redis_stop(&redis);
    return bench_end();
}
