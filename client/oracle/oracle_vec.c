/* oracle_vec.c - exact vectors of three polynomials in t, and doubles as integers. */
#include "oracle_root.h"

#include <limits.h>
#include <math.h>

void vec_init(struct vec *v)
{
    for (int k = 0; k < 3; k++) {
        poly_init(&v->c[k]);
    }
}

void vec_clear(struct vec *v)
{
    for (int k = 0; k < 3; k++) {
        poly_clear(&v->c[k]);
    }
}

void vec_sub(struct vec *r, const struct vec *a, const struct vec *b)
{
    for (int k = 0; k < 3; k++) {
        poly_sub(&r->c[k], &a->c[k], &b->c[k]);
    }
}

void vec_cross(struct vec *r, const struct vec *a, const struct vec *b)
{
    struct poly product;
    poly_init(&product);
    for (int k = 0; k < 3; k++) {
        int i = (k + 1) % 3;
        int j = (k + 2) % 3;
        poly_mul(&r->c[k], &a->c[i], &b->c[j]);
        poly_mul(&product, &a->c[j], &b->c[i]);
        poly_sub(&r->c[k], &r->c[k], &product);
    }
    poly_clear(&product);
}

void vec_dot(struct poly *r, const struct vec *a, const struct vec *b)
{
    struct poly product;
    poly_init(&product);
    poly_mul(r, &a->c[0], &b->c[0]);
    for (int k = 1; k < 3; k++) {
        poly_mul(&product, &a->c[k], &b->c[k]);
        poly_add(r, r, &product);
    }
    poly_clear(&product);
}

int vec_common_exponent(const double *x, int count)
{
    int low = INT_MAX;
    for (int i = 0; i < count; i++) {
        int exponent;
        double value = x[i];
        frexp(value, &exponent);
        if (value != 0 && exponent - 53 < low) {
            low = exponent - 53;
        }
    }
    return low == INT_MAX ? 0 : low;
}

void vec_set_scaled(mpz_t z, double value, int low)
{
    int exponent;
    double mantissa = ldexp(frexp(value, &exponent), 53);
    mpz_set_d(z, mantissa);
    if (value != 0) {
        mpz_mul_2exp(z, z, (mp_bitcnt_t)(exponent - 53 - low));
    }
}
