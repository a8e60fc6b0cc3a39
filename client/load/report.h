/* report.h - prints the results of a run and judges them. */
#ifndef LOAD_REPORT_H
#define LOAD_REPORT_H

#include <stdio.h>

#include "target.h"
#include "watch.h"

struct load_outcome {
    double seconds;         /* from the start of the load to its end */
    uint32_t bad_processes; /* of the crowd, that did not end in order */
    bool ended;             /* the daemon ended in order, if it was ours */
    struct load_holdings before, after;
    int64_t
        idle_before_kib;    /* anonymous memory, when every client of the truth is gone */
    int64_t idle_after_kib; /* and of the last worker at the end */
};

/* The verdicts, and the sums that they are of. */
struct load_findings {
    const struct load *load;
    const struct load_outcome *outcome;
    const struct load_assault *assault;
    struct load_tally crowd, victims;
    struct load_slope slopes[LOAD_GAUGES];
    bool grows[LOAD_GAUGES];
    uint64_t checksum; /* everybody's answers: two runs with the same seed and the same
                          clients have the same */
    int64_t idle_limit_kib;
    double measured_s; /* that latencies were counted for */
    bool adds_up;      /* what was submitted is what has ended in one way or another */
    bool is_right;     /* and nothing of it was lost, doubled, crossed, wrong */
    bool is_back;      /* the daemon holds what it held before */
    bool is_flat;      /* its memory does not grow, or that was not asked */
    bool is_little;    /* without clients, too */
    bool is_quick;     /* p99 is what was asked */
    bool is_good;      /* all that, and the truth tells something */
};

/* Judge. The findings are some 140 KB. */
void load_find(struct load_findings *findings, const struct load *load,
               const struct load_outcome *outcome, const struct load_assault *assault,
               const struct load_watch *watch);

void load_report_text(const struct load_findings *findings);
void load_report_json(const struct load_findings *findings);

bool load_holdings_equal(const struct load_holdings *a, const struct load_holdings *b);

/* ---- Latencies, second by second and by percentile; the processes go on meanwhile. */

struct load_series {
    uint64_t begin_ns, last_ns;
    uint64_t answers; /* until last_ns */
    struct load_hist *sum, *last, *since;
    bool is_live;
};

/* Begin. False: there is no memory; that is said. */
bool load_series_begin(struct load_series *series, const struct load *load);
/* Write a second if it is over, or, at the end, what is left of it: to load->csv, and to
 * a terminal. */
void load_series_turn(struct load_series *series, const struct load *load, bool at_end);
void load_series_end(struct load_series *series);

/* Write them as CSV, as far as so many latencies tell. */
void load_write_percentiles(FILE *to, const struct load_hist *latency);

#endif
