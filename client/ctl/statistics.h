/* statistics.h - medians and quantiles of measured values. */
#ifndef CTL_STATISTICS_H
#define CTL_STATISTICS_H

#include <math.h>
#include <stddef.h>
#include <stdlib.h>

static inline int statistics_compare(const void *a, const void *b)
{
    double x = *(const double *)a;
    double y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Sort, ascending. The values must not be NaN. */
static inline void statistics_sort(double *values, size_t count)
{
    qsort(values, count, sizeof *values, statistics_compare);
}

/* Return the median of sorted values, count >= 1; of an even count the mean of the two in
 * the middle. */
static inline double statistics_median(const double *sorted, size_t count)
{
    return (sorted[(count - 1) / 2] + sorted[count / 2]) / 2.0;
}

/* Return the smallest of sorted values such that at least the share `quantile` (0 .. 1)
 * of all is not above it; count >= 1. */
static inline double statistics_quantile(const double *sorted, size_t count,
                                         double quantile)
{
    double rank = ceil(quantile * (double)count);
    size_t index = rank < 1.0 ? 0 : (size_t)rank - 1;
    return sorted[index < count ? index : count - 1];
}

#endif
