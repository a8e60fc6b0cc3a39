/* poly.h - exact arithmetic with polynomials whose coefficients are integers of any size.
 *
 * Threads: [any]; a polynomial belongs to one thread.
 * Source: Collins and Akritas 1976 (real roots by bisection and sign variations).
 */
#ifndef ENG_POLY_H
#define ENG_POLY_H

#include <gmp.h>
#include <stdbool.h>
#include <stdint.h>

#include "limbs.h"

#define ENG_POLY_TERMS 7 /* degree <= 6 */

/* sum of c[i] t^i; degree -1 is the zero polynomial, else c[degree] != 0. */
struct eng_poly {
    int degree;
    mpz_t c[ENG_POLY_TERMS];
    mpz_t scratch[ENG_POLY_TERMS]; /* of the operations, so that they allocate nothing */
};

/* The largest size that a polynomial may have. The rest of its numbers have no room at
 * all. */
struct eng_poly_size {
    int terms;           /* coefficients */
    size_t bits;         /* of each */
    int scratch_count;   /* numbers of its scratch: whether an operation has it as its */
    size_t scratch_bits; /* output, or counts its variations, says how many */
};

void eng_poly_allocate(struct eng_poly *poly, struct eng_limbs *limbs,
                       const struct eng_poly_size *size);

/* Copy a polynomial. Here and below, outputs may not be the same object as inputs, except
 * for `out` = `a` in add and sub. */
void eng_poly_copy(struct eng_poly *out, const struct eng_poly *a);
void eng_poly_set_linear(struct eng_poly *out, const mpz_t at0, const mpz_t at1);
void eng_poly_add(struct eng_poly *out, const struct eng_poly *a,
                  const struct eng_poly *b);
void eng_poly_sub(struct eng_poly *out, const struct eng_poly *a,
                  const struct eng_poly *b);
void eng_poly_mul(struct eng_poly *out, const struct eng_poly *a,
                  const struct eng_poly *b);
void eng_poly_negate(struct eng_poly *poly);

/* Find the greatest common divisor up to a factor, which is a number. `a` and `b` are
 * used up; `out` is neither. gcd(0, b) = b. */
void eng_poly_gcd(struct eng_poly *out, struct eng_poly *a, struct eng_poly *b);

/* Do one step of pseudo-division: a = lead(b) a - lead(a) t^shift b, of lower degree;
 * that of `a` is at least that of b. */
void eng_poly_eliminate(struct eng_poly *a, const struct eng_poly *b);

/* Divide by the greatest common divisor of the coefficients, which may not all be 0. */
void eng_poly_make_primitive(struct eng_poly *poly);

/* Divide: out = a / b, for a `b` that divides `a`; both are primitive, so the quotient is
 * of integers (Gauss). `a` is used up. */
void eng_poly_divide(struct eng_poly *out, struct eng_poly *a, const struct eng_poly *b);

/* Set `out` to the polynomial with the same roots, each simple, up to a constant factor.
 * `a` is of degree 1 to 3. */
void eng_poly_square_free(struct eng_poly *out, const struct eng_poly *a);

/* Set out(y) to 2^(k degree) a((num + y) / 2^k): the interval [num, num + 1] / 2^k
 * becomes [0, 1]; signs are kept. */
void eng_poly_zoom(struct eng_poly *out, const struct eng_poly *a, const mpz_t num,
                   unsigned long k);

/* Set out(y) to 2^(k degree) a((num + width y) / 2^k): the span from num / 2^k on becomes
 * [0, 1]; signs are kept. */
void eng_poly_narrow(struct eng_poly *out, const struct eng_poly *a, const mpz_t num,
                     const mpz_t width, unsigned long k);

/* Return the bits of the longest coefficient. */
size_t eng_poly_bits(const struct eng_poly *poly);

/* Divide by the largest power of two that divides all coefficients. */
void eng_poly_shorten(struct eng_poly *poly);

int eng_poly_sign_at_0(const struct eng_poly *poly);
/* Return the sign on (0, e] for some e > 0; 0: of the zero polynomial. */
int eng_poly_sign_after_0(const struct eng_poly *poly);
int eng_poly_sign_at_1(struct eng_poly *poly);

/* Return the sign variations of the Bernstein coefficients on (0, 1): at least the number
 * of roots there, counted with multiplicity, and of the same parity. With none, *sign is
 * the sign throughout (0, 1) (0 only for the zero polynomial); else it is meaningless. */
int eng_poly_variations(struct eng_poly *poly, int *sign);

/* Set `part` to the part of [0, 1], cut into 2^stride parts, in which the roots seem to
 * be, of 1 or more variations: where one would be if the polynomial were linear; the
 * middle of two, if its slope were; of three, where the slope of that is 0, and so on.
 * False: nowhere. */
bool eng_poly_guess(mpz_t part, struct eng_poly *poly, int variations,
                    unsigned long stride);

/* Return whether there are no variations of `a`, of degree 4 or less, over [num, num + 1]
 * / 2^k, which is within [0, 1]. Then *sign is as above. Long numbers are rounded as long
 * as their signs are sure. */
bool eng_poly_is_plain(struct eng_poly *scratch, const struct eng_poly *a, mpz_t num,
                       unsigned long k, int *sign);

/* ---- modulo a prime of 61 bits (residue.c) --------------------------------------- */

/* Show that there is no common root, or no double one, a hundred times as fast as a
 * greatest common divisor.
 *
 * A common divisor of integer polynomials a and b divides them modulo the prime, too. If
 * the prime does not divide the leading coefficient of a, it does not divide that of the
 * divisor either, so the divisor keeps its degree. So where the greatest common divisor
 * modulo the prime is a number, that of a and b is one. */

/* Return whether the polynomial, of degree 1 or more, certainly has no root twice. */
bool eng_residue_is_square_free(const struct eng_poly *poly);

/* Return false if they certainly have no root in common. */
bool eng_residue_may_share_root(const struct eng_poly *a, const struct eng_poly *b);

/* Points at both ends of a span, [end][point][axis], modulo the prime. */
struct eng_residue_points {
    uint64_t x[2][4][3];
};

void eng_residue_load(struct eng_residue_points *points, mpz_t x[2][4][3]);

/* Return whether point i is certainly at no time on the line through points j and k.
 * `scratch`: two numbers. */
bool eng_residue_misses_line(const struct eng_residue_points *points, mpz_t x[2][4][3],
                             mpz_t *scratch, int i, int j, int k);

/* ---- divisors of polynomials with long coefficients (divisor.c) ------------------ */

/* Computed modulo a prime that is longer than they are, and proved by dividing both. No
 * number becomes longer than twice that prime, where remainders of integers would be up
 * to 25 times as long.
 *
 * Threads: one thread for one struct eng_divisor. Nothing is allocated.
 * Source: Collins 1971; Knuth, The Art of Computer Programming 2, 4.6.1. */

/* Bits of the longest coefficient of what it is asked about. */
#define ENG_DIVISOR_BITS 14400ul

struct eng_divisor {
    struct eng_poly common; /* what was found, primitive */
    struct eng_poly a, b;   /* both modulo the prime, and what division leaves */
    mpz_t prime, factor, product;
};

void eng_divisor_allocate(struct eng_divisor *divisor, struct eng_limbs *limbs);

/* Set divisor->common to the greatest common divisor of a and b. Their degrees are 1 to 6
 * and add up to 11 at most. */
void eng_divisor_find(struct eng_divisor *divisor, const struct eng_poly *a,
                      const struct eng_poly *b);

#endif
