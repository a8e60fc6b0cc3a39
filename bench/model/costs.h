/* costs.h - measures what it costs on this machine that threads meet.
 *
 * Threads: an OpenMP team.
 *
 * Medians, in nanoseconds. With one processor the costs between two are those of one.
 */
#ifndef MODEL_COSTS_H
#define MODEL_COSTS_H

#include <stdio.h>

#include "affinity.h"

struct model_costs {
    double clock;     /* a reading of the clock, taken off each task's time */
    double take;      /* push a task to one's own deque, and pop it */
    double barrier;   /* of two threads that arrive together */
    double wake;      /* from the start of a region until the second thread runs */
    double wake_each; /* the starter's time for each thread that it wakes */
    double spin;      /* how long a thread waits before it sleeps */
};

/* Measure all, on the first two processors of `affinity`. Takes about a second. */
void model_costs_measure(struct model_costs *costs, const struct eng_affinity *affinity);

/* One line a cost, in CSV: name, nanoseconds. */
void model_costs_print(const struct model_costs *costs, FILE *out);

#endif
