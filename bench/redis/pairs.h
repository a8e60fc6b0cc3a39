/* pairs.h - compares two things that are measured in turn, and prints the table.
 *
 * Threads: one.
 */
#ifndef BENCH_PAIRS_H
#define BENCH_PAIRS_H

#include "report.h"

struct pairs {
    struct bench_samples ours, anchor, ratio; /* one of each a turn */
};

enum pairs_want {
    PAIRS_AT_MOST,  /* the ratio must not be more than the target */
    PAIRS_AT_LEAST, /* not less */
    PAIRS_TOLD      /* there is no target */
};

struct pairs_row {
    const char *number; /* of the list of targets; "" goes on with the last one */
    const char *what;
    const char *anchor;
    const char *unit;
    enum pairs_want want;
    double target;
};

void pairs_add(struct pairs *pairs, double ours, double anchor);

/* The middle of what the samples hold, which are emptied. */
double pairs_take_median(struct bench_samples *samples);

void pairs_heading(bool json);
/* Prints, and frees the pairs. */
void pairs_print(const struct pairs_row *row, struct pairs *pairs);
/* Rows whose target was missed. */
unsigned pairs_missed(void);

#endif
