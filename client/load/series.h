/* series.h - the figures of a run, second by second, and their plot.
 *
 * Threads: one; the processes go on meanwhile.
 */
#ifndef LOAD_SERIES_H
#define LOAD_SERIES_H

#include <stddef.h>
#include <stdio.h>

#include "load.h"

struct load_second {
    double at_s; /* its end, from the start of the load */
    double length_s;
    uint64_t answers;  /* the warm-up's, too */
    uint64_t measured; /* of these, whose latency counts */
    uint64_t missed;   /* of these, after the deadline, as far as bins tell */
    double p50_ms, p90_ms, p99_ms, p999_ms, longest_ms;
};

struct load_series {
    uint64_t begin_ns, last_ns;
    uint64_t answers; /* until last_ns */
    struct load_hist *sum, *last, *since;
    struct load_second *seconds;
    size_t count, capacity;
    FILE *csv; /* of struct load; NULL: none */
    bool is_live;
};

/* False: the file cannot be written, or there is no memory; why is said. */
bool load_series_begin(struct load_series *series, const struct load *load);
/* A second if it is over, or, at the end, what is left of it. */
void load_series_turn(struct load_series *series, const struct load *load, bool at_end);
void load_series_end(struct load_series *series);

/* ---- Plots the latencies of a run. */

/* Whether gnuplot is installed; if not, that is said. */
bool load_plot_can(void);

/* False: it did not work; gnuplot says why. */
bool load_plot(const struct load *load, const struct load_series *series,
               const struct load_hist *latency);

#endif
