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

#include <stdint.h>

#include "isolate.h"
#include "query.h"

/* ---- roots (thick_roots.c) ------------------------------------------------------- */

/* Find, exactly, the first time at which a polynomial is zero while others are positive:
 * when two thick features come within reach of each other by one pair of their parts.
 * Source: Collins and Akritas 1976. */

/* Bits of what is asked about: of a polynomial, of a side. */
#define ENG_THICK_POLY_BITS 14336ul
#define ENG_THICK_SIDE_BITS 4832ul

#define ENG_THICK_SIDES 4

/* Time is cut into cells whose lower ends are (number + 1365 / 4096) / 2^depth, a third
 * into what plain halves would be: times such as 1/2, which clients make, lie well inside
 * of a cell. Number -1 begins at 0, the last one ends at 1. */
#define ENG_THICK_CELL_BITS   12
#define ENG_THICK_CELL_OFFSET 1365

struct eng_thick_roots {
    struct eng_isolator isolator; /* of the polynomial */
    struct eng_poly slope;        /* of the polynomial */
    struct eng_poly sign;         /* scratch */
    struct eng_divisor divisor;
    mpz_t cell;
};

/* Return whether there is a first t, 0 < t <= 1, with poly(t) = 0 and side[i](t) > 0 for
 * all i, in a cell not after *cell; then set *cell to the number of its cell. poly: of a
 * degree of at most 6, and not zero; is used up. side[side_count]: of a degree of at most
 * 4. */
bool eng_thick_first_root(struct eng_thick_roots *roots, struct eng_poly *poly,
                          const struct eng_poly *side, int side_count, int depth,
                          int64_t *cell);

void eng_thick_roots_allocate(struct eng_thick_roots *roots, struct eng_limbs *limbs);

/* Return the number of the cell of time t, 0 <= t <= 1, and where a cell begins, cut to
 * [0, 1]. `depth` is at most 40, so all of this is exact. */
int64_t eng_thick_cell_of(double t, int depth);
double eng_thick_cell_begin(int64_t cell, int depth);

/* ---- a query --------------------------------------------------------------------- */

struct eng_thick_exact {
    mpz_t square[2];        /* numerator and denominator of r^2, in the unit of x */
    mpz_t best[2], product; /* of that distance at t = 0, squared */
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

/* Allocate the block. PCCD_E_NOMEM: there is nothing to deinit. What follows never fails
 * for memory. */
int eng_thick_exact_init(struct eng_thick_exact *exact);
void eng_thick_exact_deinit(struct eng_thick_exact *exact);
size_t eng_thick_exact_bytes(void);

/* The time found, and the state of the pair at t = 0. */
struct eng_thick_verdict {
    bool is_found;
    bool is_inside;  /* d(0) <= r */
    bool is_initial; /* it meets at t = 0: is_inside, and without approach, or d(0) = 0 */
    int64_t cell;    /* of the first time, if found and not initial */
};

/* Return whether the distance falls (-1), stays (0) or rises (1) just after t = 0: on
 * (0, e] for some e > 0. *touches: it is 0 at t = 0, and cannot fall. The radii are not
 * looked at. */
int eng_thick_exact_trend(struct eng_thick_exact *exact,
                          const struct eng_thick_query *query, bool *touches);

void eng_thick_exact_decide(struct eng_thick_exact *exact,
                            const struct eng_thick_query *query, int depth,
                            struct eng_thick_verdict *verdict);

#endif
