/* bench/quiet.c - was anybody else on the core?
 *
 * Room:     bench.
 * Does:     see quiet.h.
 * Threads:  quiet.h.
 */
#include "quiet.h"

#include <stdlib.h>
#include <string.h>

#define ROUNDS     30000u
#define QUIET_PACE 0.95
#define LEAST      5u

/* Eight additions that do not wait for each other: more than a core does at a time. */
static double pace_here(void)
{
    uint64_t a = 1, b = 2, c = 3, d = 4, e = 5, f = 6, g = 7, h = 8;
    uint64_t begin_ns = bench_now_ns();
    for (uint32_t i = 0; i < ROUNDS; i++) {
        a += i;
        b += i;
        c += i;
        d += i;
        e += i;
        f += i;
        g += i;
        h += i;
        __asm__ volatile(""
                         : "+r"(a), "+r"(b), "+r"(c), "+r"(d), "+r"(e), "+r"(f), "+r"(g),
                           "+r"(h));
    }
    return 8.0 * ROUNDS / (double)(bench_now_ns() - begin_ns);
}

double bench_pace(uint32_t threads)
{
    double slowest = 1e9;
    if (threads <= 1) {
        return pace_here();
    }
#pragma omp parallel num_threads((int)threads) reduction(min : slowest)
    {
        double pace = pace_here();
        slowest = pace < slowest ? pace : slowest;
    }
    return slowest;
}

static int compare_down(const void *a, const void *b)
{
    double x = *(const double *)a;
    double y = *(const double *)b;
    return (x < y) - (x > y);
}

/* The LEAST-th largest, or the smallest if there are fewer. */
static double largest_but(const struct bench_samples *pace)
{
    double *sorted = bench_alloc(pace->count, sizeof *sorted);
    memcpy(sorted, pace->values, pace->count * sizeof *sorted);
    qsort(sorted, pace->count, sizeof *sorted, compare_down);
    double found = sorted[pace->count < LEAST ? pace->count - 1 : LEAST - 1];
    free(sorted);
    return found;
}

double bench_quiet_median(const struct bench_samples *values,
                          const struct bench_samples *pace, double best)
{
    struct bench_samples quiet = {0};
    if (values->count == 0) {
        return 0;
    }
    double least = largest_but(pace);
    least = least < QUIET_PACE * best ? least : QUIET_PACE * best;
    for (size_t i = 0; i < values->count; i++) {
        if (pace->values[i] >= least) {
            bench_add(&quiet, values->values[i]);
        }
    }
    double median = bench_summarise(&quiet).p50;
    bench_free(&quiet);
    return median;
}
