/* elementary.c - the elementary tests against exact arithmetic, for as long as wanted.
 *
 * Make queries from a seed, or read them (--replay, "-" is the standard input; the lines
 * that a failure prints), and judge every answer. Ends with 1 after a failure.
 */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "fuzz_jobs.h"
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

static void print(const struct fuzz_run *run, uint64_t seed)
{
    double count = (double)(run->queries ? run->queries : 1);
    printf("seed %" PRIu64 ": %" PRIu64 " queries at %" PRIu64
           " instruction sets, %" PRIu64 " contacts, %" PRIu64 " failures\n",
           seed, run->queries, run->sets, run->hits, run->failures);
    printf("  left by the filter %.2f %%, by the sieve %.2f %% of %" PRIu64
           "; answers of exact arithmetic a query %.4f\n",
           100 * (double)run->survivors / (double)(run->filtered ? run->filtered : 1),
           100 * (double)run->sieve_kept / (double)(run->sieved ? run->sieved : 1),
           run->sieved, (double)run->exact_queries / count);
    printf("  judged by ranges %.2f %%, by the exact oracle %.2f %%; %.1f us a query\n",
           100 * (double)run->tally.ranges / count,
           100 * (double)run->tally.exact / count, 1e6 * run->cpu_s / count);
    printf("  toi early by: median %.1e, p99 %.1e, p99.9 %.1e; brackets at most %.1e\n",
           fuzz_run_early(run, 0.5), fuzz_run_early(run, 0.99),
           fuzz_run_early(run, 0.999), run->bracket_max);
    printf(
        "  parameters off by at most %.1e of the extent, %.1e where all is in a line\n",
        run->tally.place_max, run->tally.line_place_max);
    fflush(stdout);
}

static int replay(const char *path)
{
    static struct fuzz_run run;
    struct eng_query query;
    double tolerance;
    double t_end;
    FILE *file = strcmp(path, "-") == 0 ? stdin : fopen(path, "r");
    if (!file) {
        perror(path);
        return 2;
    }
    fuzz_run_init(&run, 1, stdout);
    while (fuzz_query_read(file, &query, &tolerance, &t_end)) {
        fuzz_run_query(&run, &query, tolerance, t_end);
    }
    fuzz_run_deinit(&run);
    if (file != stdin) {
        fclose(file);
    }
    return run.failures > 0;
}

/* The first job tells of the families. */
static int work(uint64_t seed, uint64_t count, long job)
{
    static struct fuzz_run run;
    fuzz_run_init(&run, seed, stdout);
    while (run.queries < count && run.failures == 0) {
        uint64_t left = count - run.queries;
        fuzz_run_more(&run, left < ROUND ? left : ROUND);
        run.cpu_s = (double)clock() / CLOCKS_PER_SEC;
        print(&run, seed);
    }
    if (job == 0) {
        print_families(&run);
    }
    fflush(stdout);
    fuzz_run_deinit(&run);
    return run.failures > 0;
}

int main(int argc, char **argv)
{
    struct fuzz_jobs jobs = fuzz_jobs_begin();
    bool is_right = true;
    const char *path = NULL;
    for (int i = 1; i < argc; i++) {
        if (i + 1 < argc && strcmp(argv[i], "--replay") == 0) {
            path = argv[++i];
        } else {
            is_right &= fuzz_jobs_take(&jobs, argc, argv, &i);
        }
    }
    if (!is_right || !fuzz_jobs_are_right(&jobs)) {
        fprintf(stderr,
                "usage: %s [--queries N] [--seed N] [--jobs 1..%d] [--replay FILE]\n",
                argv[0], FUZZ_JOBS_MAX);
        return 2;
    }
    return path ? replay(path) : fuzz_jobs_run(work, &jobs);
}
