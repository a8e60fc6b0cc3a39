/* sections.h - what pccd-bench measures beside steps, a function for each part. */
#ifndef BENCH_SECTIONS_H
#define BENCH_SECTIONS_H

#include "report.h"

/* Each prints its rows, and returns 0, or 77 where what it needs is not installed. */

/* kernel */
int section_kernels(const struct bench_options *options);
int section_roofline(const struct bench_options *options);

/* pair */
int section_exact(const struct bench_options *options);
int section_distances(const struct bench_options *options);
int section_slowest(const struct bench_options *options);

/* client */
int section_batch(const struct bench_options *options);
int section_connect(const struct bench_options *options);
int section_death(const struct bench_options *options);
int section_ipc(const struct bench_options *options);

#endif
