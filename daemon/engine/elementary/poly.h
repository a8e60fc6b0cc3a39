/* daemon/engine/elementary/poly.h - polynomials with integer coefficients, exactly.
 *
 * Room:     engine. May include: GMP.
 * Does:     arithmetic up to degree 4, greatest common divisors, and counting roots in
 *           dyadic intervals by Descartes' rule of signs.
 * Threads:  [any]; a polynomial belongs to one thread. Memory is kept from use to use.
 * Source:   Collins and Akritas 1976 (real roots by bisection and sign variations).
 */
#ifndef ENG_POLY_H
#define ENG_POLY_H

#include <gmp.h>
#include <stdbool.h>

#define ENG_POLY_TERMS 5 /* degree <= 4 */

/* sum of c[i] t^i; degree -1 is the zero polynomial, else c[degree] != 0. */
struct eng_poly {
    int degree;
    mpz_t c[ENG_POLY_TERMS];
    mpz_t scratch[ENG_POLY_TERMS]; /* of the operations, so that they allocate nothing */
};

void eng_poly_init(struct eng_poly *poly);
void eng_poly_deinit(struct eng_poly *poly);

/* Outputs may not be the same object as inputs, except for `out` = `a` in add and sub. */
void eng_poly_copy(struct eng_poly *out, const struct eng_poly *a);
void eng_poly_set_linear(struct eng_poly *out, const mpz_t at0, const mpz_t at1);
void eng_poly_add(struct eng_poly *out, const struct eng_poly *a,
                  const struct eng_poly *b);
void eng_poly_sub(struct eng_poly *out, const struct eng_poly *a,
                  const struct eng_poly *b);
void eng_poly_mul(struct eng_poly *out, const struct eng_poly *a,
                  const struct eng_poly *b);
void eng_poly_negate(struct eng_poly *poly);

/* Greatest common divisor up to a factor, which is a number. `a` and `b` are used up;
 * `out` is neither. gcd(0, b) = b. */
void eng_poly_gcd(struct eng_poly *out, struct eng_poly *a, struct eng_poly *b);

/* The polynomial with the same roots, each simple, up to a constant factor. `a` is not
 * zero; s, d and common are scratch. */
void eng_poly_square_free(struct eng_poly *out, const struct eng_poly *a,
                          struct eng_poly *s, struct eng_poly *d,
                          struct eng_poly *common);

/* out(y) = 2^(k degree) a((num + y) / 2^k): the interval [num, num + 1] / 2^k becomes
 * [0, 1]; signs are kept. */
void eng_poly_zoom(struct eng_poly *out, const struct eng_poly *a, const mpz_t num,
                   unsigned long k);

/* Divide by the largest power of two that divides all coefficients. */
void eng_poly_shorten(struct eng_poly *poly);

int eng_poly_sign_at_0(const struct eng_poly *poly);
int eng_poly_sign_at_1(struct eng_poly *poly);

/* Sign variations of the Bernstein coefficients on (0, 1): at least the number of roots
 * there, counted with multiplicity, and of the same parity. With none, *sign is the sign
 * throughout (0, 1) (0 only for the zero polynomial); else it is meaningless. */
int eng_poly_variations(struct eng_poly *poly, int *sign);

#endif
