/* fuzz_truth.h - checks an answer to an elementary test against the truth.
 *
 * Check a claim, a miss or a contact with its bracket of time, beyond doubt: by intervals
 * that are rounded outward where they suffice, else by exact arithmetic.
 */
#ifndef FUZZ_TRUTH_H
#define FUZZ_TRUTH_H

#include "solve.h"

enum fuzz_judgement {
    FUZZ_RIGHT,
    FUZZ_MISSED,   /* a contact exists */
    FUZZ_INVENTED, /* none exists */
    FUZZ_LATE,     /* the first contact is before toi */
    FUZZ_EARLY,    /* the first contact is after toi_hi */
    FUZZ_MISFORMED /* flags, times, parameters or normal are none that an answer has */
};

const char *fuzz_judgement_text(enum fuzz_judgement judgement);

/* Counts of how claims were decided. */
struct fuzz_tally {
    uint64_t ranges;
    uint64_t exact;
    /* Distance of the two places that a contact's parameters name, at most, as a share of
     * the query's extent and beyond what moves within the bracket. */
    double place_max;
    double line_place_max; /* the same of features that lie nearly in a line then */
};

/* `hit` NULL: the claim is that there is no contact. For a contact *early is how long
 * toi certainly is not before it: the first contact is within [toi, toi + *early]; -1:
 * nobody has found out. */
enum fuzz_judgement fuzz_judge(const struct eng_query *query, const struct eng_hit *hit,
                               double tolerance, struct fuzz_tally *tally, double *early);

#endif
