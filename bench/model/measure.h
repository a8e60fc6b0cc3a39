/* measure.h - measures real steps, and what it costs here that threads meet.
 *
 * Threads: the engine's team.
 */
#ifndef MODEL_MEASURE_H
#define MODEL_MEASURE_H

#include <stdio.h>

#include "affinity.h"
#include "resident.h"

#define MODEL_WAYS_MAX 3

/* One way to run the step. */
struct model_way {
    uint32_t threads;
    enum eng_scheduler scheduler;
    enum pccd_method method;
};

/* Nanoseconds. The parts are minima: other work on the machine only adds to them. */
struct model_measured {
    double step;   /* median */
    double ratio;  /* median over the turns: this step to the first way's of the turn */
    double serial; /* copying the positions, and what is none of the others */
    double refit;
    double detection; /* traversal and tests */
    double merge;
};

/* Run the same step `turns` times in each way, by turns, so that other work on the
 * machine hits all of them; ways[0] is by one thread. Returns whether all answers have
 * the same hash. */
bool model_measure(const struct bench_frames *frames, struct bench_world *world,
                   const struct eng_affinity *affinity, const struct model_way *ways,
                   uint32_t way_count, uint32_t turns, struct model_measured *measured);

/* ---- Measures what it costs on this machine that threads meet.
 *
 * Medians, in nanoseconds. With one processor the costs between two are those of one. */

struct model_costs {
    double clock;     /* a reading of the clock, taken off each task's time */
    double take;      /* push a task to one's own deque, and pop it */
    double barrier;   /* of two threads that arrive together */
    double wake;      /* from the start of a region until the second thread runs */
    double wake_each; /* the starter's time for each thread that it wakes */
};

/* Measure all, on the first two processors of `affinity`. Takes about a second. */
void model_costs_measure(struct model_costs *costs, const struct eng_affinity *affinity);

/* One line a cost, in CSV: name, nanoseconds. */
void model_costs_print(const struct model_costs *costs, FILE *out);

#endif
