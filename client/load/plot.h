/* plot.h - plots the latencies of a run.
 *
 * Threads: one.
 */
#ifndef LOAD_PLOT_H
#define LOAD_PLOT_H

#include "series.h"

/* Whether gnuplot is installed; if not, that is said. */
bool load_plot_can(void);

/* False: it did not work; gnuplot says why. */
bool load_plot(const struct load *load, const struct load_series *series,
               const struct load_hist *latency);

#endif
