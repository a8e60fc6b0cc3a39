/* statistics.h - medians and quantiles of measured values. */
#ifndef CTL_STATISTICS_H
#define CTL_STATISTICS_H

#include <stddef.h>

/* Ascending. The values must not be NaN. */
void statistics_sort(double *values, size_t count);
/* Of sorted values, count >= 1. Even counts: the mean of the two in the middle. */
double statistics_median(const double *sorted, size_t count);
/* The smallest value that at least the share `quantile` (0 .. 1) of all is not above. */
double statistics_quantile(const double *sorted, size_t count, double quantile);

#endif
