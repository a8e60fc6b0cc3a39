/* elementary.c - the elementary tests against exact arithmetic, for as long as wanted.
 *
 * Room:     tests/fuzz.
 * Does:     make queries from a seed, or read them (--replay, "-" is the standard input;
 *           the lines that a failure prints), and judge every answer. Ends with 1 after a
 *           failure.
 * Threads:  one; start more with other seeds.
 */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fuzz_run.h"

#define ROUND 1000000u

static void print_families(const struct fuzz_run *run)
{
    for (int i = 0; i < FUZZ_FAMILIES; i++) {
        printf("  %-9s %12" PRIu64 " queries, %5.1f %% contacts\n",
               fuzz_family_name((enum fuzz_family)i), run->family_queries[i],
               100.0 * (double)run->family_hits[i] /
                   (double)(run->family_queries[i] ? run->family_queries[i] : 1));
    }
}

static void print(const struct fuzz_run *run)
{
    double count = (double)(run->queries ? run->queries : 1);
    printf("%" PRIu64 " queries at %" PRIu64 " instruction sets, %" PRIu64
           " contacts, %" PRIu64 " failures\n",
           run->queries, run->sets, run->hits, run->failures);
    printf("  left by the filter %.2f %%; answers of exact arithmetic a query %.4f\n",
           100 * (double)run->survivors / count, (double)run->exact_queries / count);
    printf("  judged by ranges %.2f %%, by the exact oracle %.2f %%\n",
           100 * (double)run->tally.ranges / count,
           100 * (double)run->tally.exact / count);
    printf("  toi early by: median %.1e, p99 %.1e, p99.9 %.1e, at most %.1e\n",
           fuzz_run_early(run, 0.5), fuzz_run_early(run, 0.99),
           fuzz_run_early(run, 0.999), run->early_max);
    printf("  parameters off by at most %.1e of the extent\n", run->tally.place_max);
    fflush(stdout);
}

static int replay(struct fuzz_run *run, const char *path)
{
    struct eng_query query;
    double tolerance;
    double t_end;
    FILE *file = strcmp(path, "-") == 0 ? stdin : fopen(path, "r");
    if (!file) {
        perror(path);
        return 2;
    }
    while (fuzz_query_read(file, &query, &tolerance, &t_end)) {
        fuzz_run_query(run, &query, tolerance, t_end);
    }
    if (file != stdin) {
        fclose(file);
    }
    return run->failures > 0;
}

int main(int argc, char **argv)
{
    static struct fuzz_run run;
    uint64_t seed = prng_seed();
    uint64_t count = 100000;
    const char *path = NULL;
    for (int i = 1; i < argc; i++) {
        if (i + 1 < argc && strcmp(argv[i], "--queries") == 0) {
            count = (uint64_t)strtod(argv[++i], NULL);
        } else if (i + 1 < argc && strcmp(argv[i], "--seed") == 0) {
            seed = strtoull(argv[++i], NULL, 0);
        } else if (i + 1 < argc && strcmp(argv[i], "--replay") == 0) {
            path = argv[++i];
        } else {
            fprintf(stderr, "usage: %s [--queries N] [--seed N] [--replay FILE]\n",
                    argv[0]);
            return 2;
        }
    }
    fuzz_run_init(&run, seed, stdout);
    int status = 0;
    if (path) {
        status = replay(&run, path);
    } else {
        printf("seed %" PRIu64 "\n", seed);
        while (run.queries < count && run.failures == 0) {
            uint64_t left = count - run.queries;
            fuzz_run_more(&run, left < ROUND ? left : ROUND);
            print(&run);
        }
        print_families(&run);
        status = run.failures > 0;
    }
    fuzz_run_deinit(&run);
    return status;
}
