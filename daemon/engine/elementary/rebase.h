/* rebase.h - chooses from which corner a query is measured, so that its numbers are small
 * and error bounds are tight.
 *
 * Reorder the points of a query so that the vector p between the features starts and ends
 * at the points nearest to each other. Every error bound is proportional to the size of
 * p: a vertex one micrometre from a corner of a metre-wide face is decided a million
 * times more finely.
 */
#ifndef ENG_REBASE_H
#define ENG_REBASE_H

#include "query.h"

/* How the points were reordered. VF: the face's corners rotated by `first`. EE: bit 0:
 * the ends of edge a swapped, bit 1: those of edge b. */
typedef unsigned eng_base_t;

/* Copy `query` with its points reordered. Depends on the query alone. */
eng_base_t eng_query_rebase(const struct eng_query *query, struct eng_query *rebased);

/* (beta, gamma) of the reordered query to the parameters of the original: VF the weights
 * of corners 1 and 2, EE the positions along a and b. */
void eng_rebase_params(enum pccd_kind kind, eng_base_t base, double beta, double gamma,
                       float param[2]);

#endif
