/* oracle_root.h - exact roots of polynomials in [0, 1].
 *
 * Threads: one thread for one root.
 * Source: Descartes' rule of signs on Bernstein coefficients, with bisection.
 */
#ifndef ORACLE_ORACLE_ROOT_H
#define ORACLE_ORACLE_ROOT_H

#include <stdbool.h>

#include "oracle_poly.h"

/* Exact: the number a / 2^n. Else the only root of the square-free g strictly between
 * a / 2^n and (a + 1) / 2^n. */
struct root {
    struct poly g;
    mpz_t a;
    unsigned n;
    bool is_exact;
};

void root_init(struct root *root); /* exactly 0 */
void root_clear(struct root *root);
void root_set(struct root *root, const struct root *other);

/* The integer 0 or 1. */
void root_set_end(struct root *root, int t);

/* The distinct real roots of f (not zero) in [0, 1], in ascending order, into roots[]
 * that are initialised. Returns how many. */
int root_isolate(const struct poly *f, struct root roots[POLY_DEGREE_MAX]);

/* Halve the interval, or find that the root is its middle. Exact roots stay as they
 * are. */
void root_narrow(struct root *root);

/* Sign of s at the root. Narrows the root as far as it has to. */
int root_sign(struct root *root, const struct poly *s);

/* Sign of root - t for a finite t. */
int root_compare(struct root *root, double t);

#endif
