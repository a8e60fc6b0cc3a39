/* fuzz_run.h - runs many random elementary tests with every instruction set, and checks
 * each answer.
 */
#ifndef FUZZ_RUN_H
#define FUZZ_RUN_H

#include <stdio.h>

#include "fuzz_query.h"
#include "fuzz_truth.h"

#define FUZZ_BINS 400u /* 20 a decade, from 1e-20 */

struct fuzz_run {
    struct prng prng;
    FILE *log;               /* failures, with a line to repeat each */
    uint64_t failures;       /* the first 20 are told */
    struct eng_query failed; /* the last one */
    uint64_t queries;
    uint64_t hits;
    uint64_t filtered;      /* put to the filter */
    uint64_t survivors;     /* of these, left */
    uint64_t sieved;        /* queries on a grid for the sieve */
    uint64_t sieve_kept;    /* of these, not rejected */
    uint64_t exact_queries; /* put to exact arithmetic by the engine */
    uint64_t chunks;
    uint64_t sets; /* instruction sets that were compared */
    uint64_t family_queries[FUZZ_FAMILIES];
    uint64_t family_hits[FUZZ_FAMILIES];
    struct fuzz_tally tally;
    double cpu_s; /* set by the owner */
    /* Of contacts with the default tolerance: the longest bracket, and how early toi
     * was, of those where the judge has found out. */
    double bracket_max;
    uint64_t early_count;
    uint64_t early_bins[FUZZ_BINS];
    struct eng_exact exact;
};

void fuzz_run_init(struct fuzz_run *run, uint64_t seed, FILE *log);
void fuzz_run_deinit(struct fuzz_run *run);

/* At least `count` more queries; stops after 20 failures. */
void fuzz_run_more(struct fuzz_run *run, uint64_t count);

/* One query, as fuzz_query_read gave it. */
void fuzz_run_query(struct fuzz_run *run, const struct eng_query *query, double tolerance,
                    double t_end);

/* The time that `share` of the contacts are at most early by. */
double fuzz_run_early(const struct fuzz_run *run, double share);

#endif
