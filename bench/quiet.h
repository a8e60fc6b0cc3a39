/* bench/quiet.h - was anybody else on the core?
 *
 * Room:     bench. May include: report.h.
 * Does:     measure the pace at which a thread gets its work done, and take the median
 *           of the samples at whose begin and end it was undisturbed. On a rented machine
 *           a neighbour's thread on the other half of a core takes up to half of its
 *           ports for milliseconds at a time; neither the clock nor the time of the
 *           processor shows it.
 * Threads:  functions say.
 */
#ifndef BENCH_QUIET_H
#define BENCH_QUIET_H

#include <stdint.h>

#include "report.h"

/* Independent additions a nanosecond, by the slowest of `threads` threads: some 20 us.
 * [compute]; opens a parallel region for more than one. */
double bench_pace(uint32_t threads);

/* The median of those values whose pace was within 5 % of the best, or among the five
 * best when these are fewer. pace[i] is that of values[i]. */
double bench_quiet_median(const struct bench_samples *values,
                          const struct bench_samples *pace, double best);

#endif
