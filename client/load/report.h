/* report.h - what a run has shown.
 *
 * Room:     client/load. May include: assault.h, target.h, watch.h.
 * Does:     print the figures, a line each, and say whether all is as it must be.
 * Threads:  one.
 */
#ifndef LOAD_REPORT_H
#define LOAD_REPORT_H

#include "assault.h"
#include "target.h"
#include "watch.h"

struct load_outcome {
    double seconds;         /* from the start of the load to its end */
    uint64_t truth_records; /* of a round of every client, alone */
    uint32_t bad_processes; /* of the crowd, that did not end in order */
    bool ended;             /* the daemon ended in order, if it was ours */
    struct load_holdings before, after;
    int64_t
        idle_before_kib;    /* anonymous memory, when every client of the truth is gone */
    int64_t idle_after_kib; /* and of the last worker at the end */
};

/* Returns whether nothing was lost, doubled, crossed or wrong, all adds up, and the
 * daemon holds what it held before. */
bool load_report(const struct load *load, const struct load_outcome *outcome,
                 const struct load_assault *assault, const struct load_watch *watch);

bool load_holdings_equal(const struct load_holdings *a, const struct load_holdings *b);

#endif
