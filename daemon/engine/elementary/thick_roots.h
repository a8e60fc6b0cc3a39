/* thick_roots.h - finds, exactly, the first time at which a polynomial is zero while
 * others are positive: when two thick features come within reach of each other by one
 * pair of their parts.
 *
 * Threads: one thread for one struct eng_thick_roots. Nothing is allocated.
 * Source: Collins and Akritas 1976; BOUNDS.md, "Thick features".
 */
#ifndef ENG_THICK_ROOTS_H
#define ENG_THICK_ROOTS_H

#include <stdint.h>

#include "divisor.h"

/* Bits of what is asked about: of a polynomial, of a side. */
#define ENG_THICK_POLY_BITS 14336ul
#define ENG_THICK_SIDE_BITS 4832ul

#define ENG_THICK_SIDES 4

/* Time is cut into cells whose lower ends are (number + 1365 / 4096) / 2^depth, a third
 * into what plain halves would be: times such as 1/2, which clients make, lie well inside
 * of a cell. Number -1 begins at 0, the last one ends at 1. */
#define ENG_THICK_CELL_BITS   12
#define ENG_THICK_CELL_OFFSET 1365

/* An interval [num, num + 1] / 2^k with roots, or the root num / 2^k. */
struct eng_thick_pending {
    mpz_t num;
    unsigned long k;
    int variations; /* 0: it is a root itself */
    unsigned alone; /* halvings since the last that had roots in both halves */
    unsigned long stride;
};

/* Together they have no more variations than the degree. */
#define ENG_THICK_PENDING 13

struct eng_thick_roots {
    struct eng_poly root;  /* the polynomial, each root once */
    struct eng_poly slope; /* of the polynomial */
    struct eng_poly zoomed, base, sign;
    struct eng_divisor divisor;
    struct eng_thick_pending pending[ENG_THICK_PENDING]; /* the earliest is on top */
    int pending_count;
    mpz_t num, at, part, cell;
};

/* poly: of a degree of at most 6, and not zero; is used up. side[side_count]: of a degree
 * of at most 4. Is there a first t, 0 < t <= 1, with poly(t) = 0 and side[i](t) > 0 for
 * all i, in a cell not after *cell? Sets *cell to the number of its cell. */
bool eng_thick_first_root(struct eng_thick_roots *roots, struct eng_poly *poly,
                          const struct eng_poly *side, int side_count, int depth,
                          int64_t *cell);

void eng_thick_roots_place(struct eng_thick_roots *roots, struct eng_limbs *limbs);

/* The number of the cell of time t, 0 <= t <= 1, and where a cell begins, cut to
 * [0, 1]. `depth` is at most 40, so all of this is exact. */
int64_t eng_thick_cell_of(double t, int depth);
double eng_thick_cell_begin(int64_t cell, int depth);

#endif
