/* oracle_poly.h - exact polynomials in t, with integer coefficients.
 *
 * Threads: one thread for one polynomial.
 */
#ifndef ORACLE_ORACLE_POLY_H
#define ORACLE_ORACLE_POLY_H

#include <gmp.h>

#define POLY_DEGREE_MAX 6

/* c[0] + c[1] t + ...; c[degree] is not zero; degree -1 is the zero polynomial. */
struct poly {
    int degree;
    mpz_t c[POLY_DEGREE_MAX + 1];
};

void poly_init(struct poly *p); /* zero */
void poly_clear(struct poly *p);
void poly_set(struct poly *p, const struct poly *q);

/* Recompute the degree after the coefficients up to `degree` were written directly. */
void poly_trim(struct poly *p, int degree);

/* r may be a or b. The degree of a product must not exceed POLY_DEGREE_MAX. */
void poly_add(struct poly *r, const struct poly *a, const struct poly *b);
void poly_sub(struct poly *r, const struct poly *a, const struct poly *b);
void poly_mul(struct poly *r, const struct poly *a, const struct poly *b);

/* Greatest common divisor over the rationals, with coprime integer coefficients; the gcd
 * of two zero polynomials is zero. g may be a or b. */
void poly_gcd(struct poly *g, const struct poly *a, const struct poly *b);

/* The product of the distinct irreducible factors of `f`, which is not zero. */
void poly_square_free(struct poly *g, const struct poly *f);

/* Sign of p at a / 2^n. */
int poly_sign_at(const struct poly *p, const mpz_t a, unsigned n);

/* Sign variations of the Bernstein coefficients of p on [a / 2^n, (a + 1) / 2^n]: at
 * least the number of roots strictly inside and of the same parity (Descartes). *sign:
 * the sign of p strictly inside if there are no variations; 0 for the zero polynomial. */
int poly_variations(const struct poly *p, const mpz_t a, unsigned n, int *sign);

#endif
