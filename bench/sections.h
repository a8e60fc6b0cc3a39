/* sections.h - what pccd-bench measures beside steps, a function for each part. */
#ifndef BENCH_SECTIONS_H
#define BENCH_SECTIONS_H

#include "report.h"

/* With the numbers that some parts take, 0 where they are not given. */
struct section_options {
    struct bench_options bench;
    uint32_t clients, kills, meshes;
};

/* Each prints its rows, and returns 0, or 77 where what it needs is not installed. */

/* kernel */
int section_roofline(const struct section_options *options);

/* pair */
int section_exact(const struct section_options *options);
int section_distances(const struct section_options *options);

/* client */
int section_batch(const struct section_options *options);
int section_connect(const struct section_options *options);
int section_death(const struct section_options *options);
extern const struct option_row section_death_rows[];
int section_ipc(const struct section_options *options);
int section_late(const struct section_options *options);

#endif
