/* daemon/engine/exact.h - exact answers about one moment, for what rounding hides.
 *
 * Room:     engine. May include: query.h, GMP.
 * Does:     decide on the binary inputs whether two features touch at t = 0 or t = 1, and
 *           which side of each other they are on.
 * Threads:  one thread for one scratch.
 */
#ifndef ENG_EXACT_H
#define ENG_EXACT_H

#include <gmp.h>

#include "query.h"

#define ENG_EXACT_WORDS 40

/* Integers that keep their memory from query to query. */
struct eng_exact {
    mpz_t z[ENG_EXACT_WORDS];
    uint64_t queries; /* answered so far */
};

void eng_exact_init(struct eng_exact *exact);
void eng_exact_deinit(struct eng_exact *exact);

struct eng_moment {
    bool touching; /* the closed features share a point */
    int side;      /* sign of det[p, b, c]: -1, 0, 1 */
};

/* The configuration at t = `end` (0 or 1), by the definition: degenerate triangles are the
 * segments they collapse to, degenerate edges are points. */
struct eng_moment eng_exact_moment(struct eng_exact *exact, const struct eng_query *query,
                                   int end);

#endif
