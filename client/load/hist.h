/* hist.h - a histogram of times, for percentiles.
 *
 * Threads: one writer, any readers.
 */
#ifndef LOAD_HIST_H
#define LOAD_HIST_H

#include <stdint.h>

#define LOAD_HIST_SUB  128u /* bins of an octave; below so many ns, a bin each */
#define LOAD_HIST_BINS ((40u - 7u + 1u) * LOAD_HIST_SUB)

struct load_hist {
    uint64_t count;
    uint64_t longest_ns; /* exact */
    uint64_t bins[LOAD_HIST_BINS];
};

void load_hist_add(struct load_hist *hist, uint64_t ns);

/* *sum += *hist, which somebody may be writing to; its count is that of its bins. */
void load_hist_merge(struct load_hist *sum, const struct load_hist *hist);

/* What came after `earlier`, a former state of `now`. Its longest time is the end of its
 * last bin. */
void load_hist_since(const struct load_hist *now, const struct load_hist *earlier,
                     struct load_hist *since);

/* How many are in bins that begin after so long. */
uint64_t load_hist_above(const struct load_hist *hist, uint64_t ns);

/* The upper end of the bin below which the share lies, nanoseconds; 0 without any. */
uint64_t load_hist_quantile(const struct load_hist *hist, double share);

#endif
