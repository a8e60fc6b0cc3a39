/* fuzz_query.h - makes random elementary tests that are hard to decide. */
#ifndef FUZZ_QUERY_H
#define FUZZ_QUERY_H

#include <stdbool.h>
#include <stdio.h>

#include "prng.h"
#include "query.h"

enum fuzz_family {
    FUZZ_RANDOM,   /* all 53 bits, motion large or small */
    FUZZ_SNAPPED,  /* small integers: degenerate, coplanar and touching as a rule */
    FUZZ_COPLANAR, /* in one plane, exactly or up to rounding, at both ends */
    FUZZ_SLIVER,   /* faces nearly lines, edges nearly parallel or nearly points */
    FUZZ_PLANTED,  /* meets at a time m/8, without rounding; 0 and 1 included */
    FUZZ_NEAR,     /* the same, one coordinate off by a few units in its last place */
    FUZZ_CROSSING, /* meets in the middle of things, rounded */
    FUZZ_RIM,      /* meets on a rim or at a corner, up to rounding */
    FUZZ_GRAZING,  /* two roots that are one, nearly */
    FUZZ_RESTING,  /* nothing moves, or all of it together, up to rounding */
    FUZZ_SPREAD,   /* small integers times powers of two that are far apart */
    FUZZ_FAMILIES
};

const char *fuzz_family_name(enum fuzz_family family);

/* One of them; those that take milliseconds of exact arithmetic come seldom. */
enum fuzz_family fuzz_family_some(struct prng *prng);

/* A query of the family, then by chance moved far away, scaled by a power of two, turned,
 * in another order, backwards. Every coordinate is finite and at most 1e18. */
void fuzz_query_make(struct prng *prng, enum fuzz_family family, enum pccd_kind kind,
                     struct eng_query *query);

/* Whether there is a contact stays the same for all three. */

/* Times 2^k, so that no bit is lost; k by chance. */
void fuzz_query_scale(struct prng *prng, struct eng_query *query);
/* Corners, ends of edges, or edges in another order. */
void fuzz_query_reorder(struct prng *prng, struct eng_query *query);
void fuzz_query_reverse(struct eng_query *query);

/* One line: kind, tolerance, t_end, then 24 numbers in hexadecimal, point by point, those
 * at t = 0 first. False: there is none. */
void fuzz_query_write(FILE *file, const struct eng_query *query, double tolerance,
                      double t_end);
bool fuzz_query_read(FILE *file, struct eng_query *query, double *tolerance,
                     double *t_end);

#endif
