/* elementary.c - the elementary tests against exact arithmetic, for as long as wanted.
 *
 * Make queries from a seed, or read them (--replay, "-" is the standard input; the lines
 * that a failure prints), and judge every answer. Ends with 1 after a failure.
 */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "fuzz_jobs.h"
#include "fuzz_run.h"

#define ROUND    100000u
#define JOBS_MAX 64
#define REPORT_S 60

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

static void work(struct fuzz_run *run, uint64_t count)
{
    while (run->queries < count && run->failures == 0) {
        uint64_t left = count - run->queries;
        fuzz_run_more(run, left < ROUND ? left : ROUND);
        run->cpu_s = (double)clock() / CLOCKS_PER_SEC;
    }
    fflush(run->log);
}

/* What all processes have done by now; numbers of the round at hand may be torn. */
static void print_all(const struct fuzz_run *runs, int job_count, bool with_families)
{
    static struct fuzz_run total;
    memset(&total, 0, sizeof total);
    for (int i = 0; i < job_count; i++) {
        fuzz_run_add(&total, &runs[i]);
    }
    print(&total);
    if (with_families) {
        print_families(&total);
    }
}

static time_t now_s(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return now.tv_sec;
}

/* One process a job, each with a seed of its own and counters that all see. */
static int work_in_processes(uint64_t seed, uint64_t count, int job_count)
{
    struct fuzz_run *runs =
        mmap(NULL, sizeof *runs * (size_t)job_count, PROT_READ | PROT_WRITE,
             MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (runs == MAP_FAILED) {
        perror("mmap");
        return 2;
    }
    printf("seeds %" PRIu64 " .. %" PRIu64 "\n", seed, seed + (uint64_t)job_count - 1);
    fflush(stdout);
    int started = 0;
    for (; started < job_count; started++) {
        pid_t pid = fork();
        if (pid < 0) {
            perror("fork");
            break;
        }
        if (pid == 0) {
            fuzz_run_init(&runs[started], seed + (uint64_t)started, stdout);
            work(&runs[started], (count + (uint64_t)job_count - 1) / (uint64_t)job_count);
            fuzz_run_deinit(&runs[started]);
            _exit(runs[started].failures > 0);
        }
    }
    int failed = started < job_count;
    time_t told = now_s();
    for (int running = started; running > 0;) {
        int status;
        pid_t pid = waitpid(-1, &status, WNOHANG);
        if (pid > 0) {
            running--;
            failed |= fuzz_jobs_failed(status);
        } else if (now_s() - told >= REPORT_S) {
            told = now_s();
            print_all(runs, started, false);
        } else {
            usleep(100000);
        }
    }
    print_all(runs, started, true);
    munmap(runs, sizeof *runs * (size_t)job_count);
    return failed;
}

int main(int argc, char **argv)
{
    uint64_t seed = prng_seed();
    uint64_t count = 100000;
    long job_count = 1;
    const char *path = NULL;
    for (int i = 1; i < argc; i++) {
        if (i + 1 < argc && strcmp(argv[i], "--queries") == 0) {
            count = (uint64_t)strtod(argv[++i], NULL);
        } else if (i + 1 < argc && strcmp(argv[i], "--seed") == 0) {
            seed = strtoull(argv[++i], NULL, 0);
        } else if (i + 1 < argc && strcmp(argv[i], "--jobs") == 0) {
            job_count = strtol(argv[++i], NULL, 10);
        } else if (i + 1 < argc && strcmp(argv[i], "--replay") == 0) {
            path = argv[++i];
        } else {
            job_count = 0;
        }
    }
    if (job_count < 1 || job_count > JOBS_MAX) {
        fprintf(stderr,
                "usage: %s [--queries N] [--seed N] [--jobs 1..%d] [--replay FILE]\n",
                argv[0], JOBS_MAX);
        return 2;
    }
    return path ? replay(path) : work_in_processes(seed, count, (int)job_count);
}
