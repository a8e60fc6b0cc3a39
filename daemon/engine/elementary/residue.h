/* residue.h - shows quickly that two polynomials have no common root, by computing modulo
 * a prime.
 *
 * Tell that two polynomials have no common root, or that one has no double root, with
 * numbers of 61 bits. This is a hundred times as fast as a greatest common divisor.
 *
 * A common divisor of integer polynomials a and b divides them modulo the prime, too. If
 * the prime does not divide the leading coefficient of a, it does not divide that of the
 * divisor either, so the divisor keeps its degree. So where the greatest common divisor
 * modulo the prime is a number, that of a and b is one.
 */
#ifndef ENG_RESIDUE_H
#define ENG_RESIDUE_H

#include <stdint.h>

#include "poly.h"

/* Has the polynomial, of degree 1 or more, certainly no root twice? */
bool eng_residue_is_square_free(const struct eng_poly *poly);

/* Is it not certain that they have no root in common? */
bool eng_residue_may_share_root(const struct eng_poly *a, const struct eng_poly *b);

/* Points at both ends of a span, [end][point][axis], modulo the prime. */
struct eng_residue_points {
    uint64_t x[2][4][3];
};

void eng_residue_load(struct eng_residue_points *points, mpz_t x[2][4][3]);

/* Is point i certainly at no time on the line through points j and k? `scratch`: two
 * numbers. */
bool eng_residue_misses_line(const struct eng_residue_points *points, mpz_t x[2][4][3],
                             mpz_t *scratch, int i, int j, int k);

#endif
