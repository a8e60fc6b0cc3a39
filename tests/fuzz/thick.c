/* thick.c - the engine's test of thick features against the oracle, as long as wanted.
 *
 * Make cases from a seed, in several processes with seeds of their own, and compare every
 * verdict and time; --short: of VE and VV alone. Prints what is wrong, and ends with 1
 * then. --times: how long integers take for a case of each family, and nothing is
 * compared.
 */
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "fuzz_jobs.h"
#include "fuzz_thick_lanes.h"
#include "kinds.h"

#define ROUND 1000000u

static void print_counts(const char *name, const struct fuzz_thick_counts *counts)
{
    double percent = 100.0 / (double)(counts->cases ? counts->cases : 1);
    printf("  %-10s %10" PRIu64
           " cases, hits %5.1f %%, initial %4.1f %%, inside %5.1f %%,"
           " inseparable %5.1f %%, by integers %5.1f %%\n",
           name, counts->cases, percent * (double)counts->hits,
           percent * (double)counts->initial, percent * (double)counts->inside,
           percent * (double)counts->inseparable, percent * (double)counts->by_integers);
}

static void print(const struct fuzz_thick_run *run, uint64_t seed)
{
    struct fuzz_thick_counts total = fuzz_thick_total(run);
    printf("seed %" PRIu64 ": %" PRIu64 " failures, %" PRIu64 " judged by the oracle;",
           seed, run->failures, run->judged);
    for (int i = 0; i < 4; i++) {
        printf(" %s %" PRIu64, common_kinds[i].name, run->kinds[i]);
    }
    printf("; distances fall %" PRIu64 ", stay %" PRIu64 ", rise %" PRIu64
           ", are 0 %" PRIu64 "\n",
           run->trends[0], run->trends[1], run->trends[2], run->touching);
    print_counts("all", &total);
    fflush(stdout);
}

/* As many cases again, in chunks, for every instruction set. */
static int work_in_lanes(uint64_t seed, uint64_t count)
{
    static struct fuzz_thick_lanes run;
    fuzz_thick_lanes_init(&run, seed, stdout);
    while (run.cases < count && run.failures == 0) {
        fuzz_thick_lanes_more(&run, 200);
    }
    printf("seed %" PRIu64 ", in lanes: %" PRIu64 " cases by %" PRIu64
           " instruction sets, %" PRIu64 " failures; %" PRIu64 " not rejected, %" PRIu64
           " hits\n",
           seed, run.cases, run.sets, run.failures, run.survivors, run.hits);
    fflush(stdout);
    fuzz_thick_lanes_deinit(&run);
    return run.failures > 0;
}

/* The oracle takes as long as both stages of so many cases. */
static uint64_t oracle_each = 32;
static uint32_t least_kind;

/* The first job tells of the families. */
static int work(uint64_t seed, uint64_t count, long job)
{
    static struct fuzz_thick_run run;
    fuzz_thick_init(&run, seed, stdout);
    run.oracle_each = oracle_each;
    run.least_kind = least_kind;
    uint64_t left = count;
    while (left > 0 && run.failures == 0) {
        uint64_t round = left < ROUND ? left : ROUND;
        fuzz_thick_more(&run, round);
        left -= round;
        print(&run, seed);
    }
    for (int i = 0; i < FUZZ_THICK_FAMILIES && job == 0; i++) {
        print_counts(fuzz_thick_name((enum fuzz_thick_family)i), &run.counts[i]);
    }
    fflush(stdout);
    fuzz_thick_deinit(&run);
    return run.failures > 0 || work_in_lanes(seed, count);
}

/* ---- times ------------------------------------------------------------------------- */

#define SLOW_US    50.0 /* then it is decided again, and the least time counts */
#define SLOW_TRIES 5

/* Return the time of this thread: what others do meanwhile does not count. */
static double thread_us(void)
{
    struct timespec now;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return (double)now.tv_sec * 1e6 + (double)now.tv_nsec * 1e-3;
}

static double decide_us(struct fuzz_thick_run *run, const struct fuzz_thick_case *made)
{
    double least = INFINITY;
    for (int i = 0; i < SLOW_TRIES && (i == 0 || least > SLOW_US); i++) {
        struct eng_hit hit;
        double begin_us = thread_us();
        (void)eng_thick_solve(&run->thick, &run->contacts, &made->query, made->tolerance,
                              1, &hit);
        least = fmin(least, thread_us() - begin_us);
    }
    return least;
}

static int compare_doubles(const void *a, const void *b)
{
    double left = *(const double *)a;
    double right = *(const double *)b;
    return left < right ? -1 : left > right;
}

/* By integers alone, whatever doubles know. */
static int tell_times(uint64_t seed, uint64_t each)
{
    static struct fuzz_thick_run run;
    double *us = malloc((each + 1) * sizeof *us);
    fuzz_thick_init(&run, seed, stdout);
    run.thick.first = ENG_THICK_BY_INTEGERS;
    for (int family = 0; us && each > 0 && family < FUZZ_THICK_FAMILIES; family++) {
        uint64_t count = 0;
        while (count < each) {
            struct fuzz_thick_case made;
            fuzz_thick_make(&run.prng, least_kind, &made);
            if ((int)made.family == family) {
                us[count++] = decide_us(&run, &made);
            }
        }
        qsort(us, each, sizeof *us, compare_doubles);
        printf("  %-10s median %7.2f us, 99 %% %7.1f us, longest %7.1f us\n",
               fuzz_thick_name((enum fuzz_thick_family)family), us[each / 2],
               us[each - 1 - each / 100], us[each - 1]);
        fflush(stdout);
    }
    free(us);
    fuzz_thick_deinit(&run);
    return 0;
}

int main(int argc, char **argv)
{
    struct fuzz_jobs jobs = fuzz_jobs_begin();
    bool is_right = true;
    bool times = false;
    for (int i = 1; i < argc; i++) {
        if (i + 1 < argc && strcmp(argv[i], "--oracle") == 0) {
            oracle_each = strtoull(argv[++i], NULL, 0);
        } else if (strcmp(argv[i], "--times") == 0) {
            times = true;
        } else if (strcmp(argv[i], "--short") == 0) {
            least_kind = PCCD_VE;
        } else {
            is_right &= fuzz_jobs_take(&jobs, argc, argv, &i);
        }
    }
    if (!is_right || !fuzz_jobs_are_right(&jobs) || oracle_each < 1) {
        fprintf(
            stderr,
            "usage: %s [--cases N] [--seed N] [--jobs 1..%d] [--oracle EACH] [--short] "
            "[--times]\n",
            argv[0], FUZZ_JOBS_MAX);
        return 2;
    }
    return times ? tell_times(jobs.seed, jobs.count / FUZZ_THICK_FAMILIES)
                 : fuzz_jobs_run(work, &jobs);
}
