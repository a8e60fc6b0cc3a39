/* measure.h - measures real steps, to compare the model's predictions with.
 *
 * Run the same step, or question about what is near, by one thread and by each scheduler
 * with more threads, in turns, so that other work on the machine hits all of them; give
 * medians. The serial parts of a step are taken from here.
 *
 * Threads: the engine's team.
 */
#ifndef MODEL_MEASURE_H
#define MODEL_MEASURE_H

#include "affinity.h"
#include "resident.h"

#define MODEL_MEASURED_MAX 16

/* One way to run the step. */
struct model_way {
    uint32_t threads;
    enum eng_scheduler scheduler;
    enum eng_high_level high_level;
    enum eng_refit_scheme refit;
    enum pccd_method method; /* wide: by stealing */
};

/* What is asked, by every way. */
struct model_question {
    const struct eng_affinity *affinity;
    double distance; /* >= 0: pairs that near, where the step begins; < 0: contacts */
};

/* Nanoseconds. The parts are minima: other work on the machine only adds to them. */
struct model_measured {
    struct model_way way;
    double step;  /* median */
    double least; /* step */
    double ratio; /* median over the turns: this step to the first way's of the turn */
    double hand_overs; /* median: nodes received, tasks taken from others */
    double ingest;
    double refit;
    double detection; /* traversal and tests */
    double merge;
    double rest; /* of the step: none of the four */
};

/* `ways[0]` is by one thread. The same question again and again. The answers'
 * hashes must agree: returns whether they do. */
bool model_measure(struct bench_world *world, const struct bench_frames *frames,
                   const struct model_question *question, const struct model_way *ways,
                   uint32_t way_count, uint32_t turns, struct model_measured *measured);

#endif
