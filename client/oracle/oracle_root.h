/* oracle_root.h - exact polynomials in t, and their roots in [0, 1].
 *
 * Threads: one thread for one root.
 * Source: Descartes' rule of signs on Bernstein coefficients, with bisection.
 */
#ifndef ORACLE_ORACLE_ROOT_H
#define ORACLE_ORACLE_ROOT_H

#include <gmp.h>
#include <stdbool.h>

#include "oracle.h"

/* ---- Exact polynomials in t, with integer coefficients. */

#define POLY_DEGREE_MAX 6

/* c[0] + c[1] t + ...; c[degree] is not zero; degree -1 is the zero polynomial. */
struct poly {
    int degree;
    mpz_t c[POLY_DEGREE_MAX + 1];
};

/* Initialise it to zero. */
void poly_init(struct poly *p);
void poly_clear(struct poly *p);
void poly_set(struct poly *p, const struct poly *q);

/* Compute the degree anew after the coefficients up to `degree` were written directly. */
void poly_trim(struct poly *p, int degree);

/* Set r to a + b, a - b or a b; it may be a or b. The degree of a product must not exceed
 * POLY_DEGREE_MAX. */
void poly_add(struct poly *r, const struct poly *a, const struct poly *b);
void poly_sub(struct poly *r, const struct poly *a, const struct poly *b);
void poly_mul(struct poly *r, const struct poly *a, const struct poly *b);

/* Set g to the greatest common divisor over the rationals, with coprime integer
 * coefficients; the gcd of two zero polynomials is zero. g may be a or b. */
void poly_gcd(struct poly *g, const struct poly *a, const struct poly *b);

/* Set g to the product of the distinct irreducible factors of `f`, which is not zero. */
void poly_square_free(struct poly *g, const struct poly *f);

/* Return the sign of p at a / 2^n. */
int poly_sign_at(const struct poly *p, const mpz_t a, unsigned n);

/* Count the sign variations of the Bernstein coefficients of p on [a / 2^n, (a + 1) /
 * 2^n]: at least the number of roots strictly inside and of the same parity (Descartes).
 * *sign: the sign of p strictly inside if there are no variations; 0 for the zero
 * polynomial. */
int poly_variations(const struct poly *p, const mpz_t a, unsigned n, int *sign);

/* ---- Exact vectors of three polynomials in t, and doubles as integers. */

struct vec {
    struct poly c[3];
};

void vec_init(struct vec *v);
void vec_clear(struct vec *v);
void vec_sub(struct vec *r, const struct vec *a, const struct vec *b);
/* Set r to the cross product; it is neither a nor b. */
void vec_cross(struct vec *r, const struct vec *a, const struct vec *b);
void vec_dot(struct poly *r, const struct vec *a, const struct vec *b);

/* Return an e with all of x[count] a multiple of 2^e: the exponent of the last bit of the
 * smallest magnitude that is not 0; 0 if all are 0. */
int vec_common_exponent(const double *x, int count);

/* Set z to value / 2^low, an integer. */
void vec_set_scaled(mpz_t z, double value, int low);

/* Exact: the number a / 2^n. Else the only root of the square-free g strictly between
 * a / 2^n and (a + 1) / 2^n. */
struct root {
    struct poly g;
    mpz_t a;
    unsigned n;
    bool is_exact;
};

/* Initialise it to exactly 0. */
void root_init(struct root *root);
void root_clear(struct root *root);
void root_set(struct root *root, const struct root *other);

/* Set it to the integer 0 or 1. */
void root_set_end(struct root *root, int t);

/* Find the distinct real roots of f (not zero) in [0, 1], in ascending order, into
 * roots[] that are initialised. Returns how many. */
int root_isolate(const struct poly *f, struct root roots[POLY_DEGREE_MAX]);

/* Halve the interval, or find that the root is its middle. Exact roots stay as they
 * are. */
void root_narrow(struct root *root);

/* Return the sign of s at the root. Narrows the root as far as it has to. */
int root_sign(struct root *root, const struct poly *s);

/* Return the sign of root - t for a finite t. */
int root_compare(struct root *root, double t);

/* ---- The first of several times, each an exact root. */

#define FIRST_MAX 9 /* features of four points have as many pairs of parts, at most */

/* The first contact time is the least of these. */
struct oracle_first {
    struct root roots[FIRST_MAX];
    int count;
};

/* Initialise it with no root; all that it has room for are exactly 0. */
void first_init(struct oracle_first *first);
void first_clear(struct oracle_first *first);

/* Make one on the heap, initialised. Ends the process where there is no memory: no answer
 * is better than a wrong one. */
struct oracle_first *first_new(void);
/* Return `first`, or NULL, and free it, if it has no roots. */
struct oracle_first *first_or_null(struct oracle_first *first);

#endif
