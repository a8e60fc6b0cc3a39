/* oracle_vec.h - exact vectors of three polynomials in t, and doubles as integers.
 *
 * Threads: one thread for one vector.
 */
#ifndef ORACLE_ORACLE_VEC_H
#define ORACLE_ORACLE_VEC_H

#include "oracle_poly.h"

struct vec {
    struct poly c[3];
};

void vec_init(struct vec *v);
void vec_clear(struct vec *v);
void vec_sub(struct vec *r, const struct vec *a, const struct vec *b);
/* r is neither a nor b. */
void vec_cross(struct vec *r, const struct vec *a, const struct vec *b);
void vec_dot(struct poly *r, const struct vec *a, const struct vec *b);

/* The smallest e with all of x[count] a multiple of 2^e; 0 if all are 0. */
int vec_common_exponent(const double *x, int count);

/* z = value / 2^low, an integer. */
void vec_set_scaled(mpz_t z, double value, int low);

#endif
