/* thick_exact.h - decides a query of thick features by exact integer arithmetic.
 *
 * Decide, from the binary inputs, whether two features are within a distance of each
 * other at t = 0, and in which cell of time they first are; without rounding, whatever
 * the inputs.
 *
 * Threads: one thread for one scratch. Decisions allocate nothing.
 * Source: BOUNDS.md, "Thick features".
 */
#ifndef ENG_THICK_EXACT_H
#define ENG_THICK_EXACT_H

#include "thick_query.h"
#include "thick_roots.h"

struct eng_thick_exact {
    mpz_t square[2];        /* numerator and denominator of r^2, in the unit of x */
    mpz_t best[2], product; /* of the square of the distance at t = 0, likewise */
    struct eng_poly x[4][3];
    struct eng_poly p[3], b[3], c[3], n[3], cross[3], term;
    /* Of one pair of parts: the square of the distance is num / den where all sides are
     * positive; poly is num - r^2 den, times the denominator of r^2. */
    struct eng_poly num, den, side[ENG_THICK_SIDES], poly;
    int side_count;
    struct eng_thick_roots roots;
    uint64_t queries; /* decided so far */
    mp_limb_t *block;
};

/* PCCD_E_NOMEM: there is nothing to deinit. What follows never fails for memory. */
int eng_thick_exact_init(struct eng_thick_exact *exact);
void eng_thick_exact_deinit(struct eng_thick_exact *exact);
size_t eng_thick_exact_bytes(void);

/* What is found, and what the pair is at t = 0. */
struct eng_thick_verdict {
    bool is_found;
    bool is_inside;  /* d(0) <= r */
    bool is_initial; /* it meets at t = 0: is_inside, and without approach, or d(0) = 0 */
    int64_t cell;    /* of the first time, if found and not initial */
};

void eng_thick_exact_decide(struct eng_thick_exact *exact,
                            const struct eng_thick_query *query, int depth,
                            struct eng_thick_verdict *verdict);

#endif
