/* turning_truth.h - what the oracle says of a pair that was drawn. */
#ifndef TESTS_TURNING_TRUTH_H
#define TESTS_TURNING_TRUTH_H

#include <stdbool.h>

#include "turning_draw.h"

/* As struct oracle_turning_answer. */
struct turning_truth {
    double free_until;
    double met_by; /* above 1: it is not known to meet */
    bool is_free;
    uint32_t spans;
};

/* Ask of times from .. to, and of r + more; fine: how many spans of longer numbers. */
struct turning_truth turning_truth(const struct turning_drawn *drawn, double from,
                                   double to, double more, double width, uint32_t fine);

#endif
