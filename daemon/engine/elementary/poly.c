/* daemon/engine/elementary/poly.c - polynomials with integer coefficients, exactly.
 *
 * Room:     engine.
 * Does:     integers of any length, divided by what is known to divide them.
 * Threads:  [any]; a polynomial belongs to one thread.
 * Source:   Collins and Akritas 1976; Knuth, The Art of Computer Programming 2, 4.6.1.
 */
#include "poly.h"

#include <assert.h>

void eng_poly_init(struct eng_poly *poly)
{
    poly->degree = -1;
    for (int i = 0; i < ENG_POLY_TERMS; i++) {
        mpz_init2(poly->c[i], 1024);
        mpz_init2(poly->scratch[i], 1024);
    }
}

void eng_poly_deinit(struct eng_poly *poly)
{
    for (int i = 0; i < ENG_POLY_TERMS; i++) {
        mpz_clear(poly->c[i]);
        mpz_clear(poly->scratch[i]);
    }
}

/* Drop leading zeros. */
static void trim(struct eng_poly *poly)
{
    while (poly->degree >= 0 && mpz_sgn(poly->c[poly->degree]) == 0) {
        poly->degree--;
    }
}

void eng_poly_copy(struct eng_poly *out, const struct eng_poly *a)
{
    out->degree = a->degree;
    for (int i = 0; i <= a->degree; i++) {
        mpz_set(out->c[i], a->c[i]);
    }
}

void eng_poly_set_linear(struct eng_poly *out, const mpz_t at0, const mpz_t at1)
{
    mpz_set(out->c[0], at0);
    mpz_sub(out->c[1], at1, at0);
    out->degree = 1;
    trim(out);
}

static void combine(struct eng_poly *out, const struct eng_poly *a,
                    const struct eng_poly *b, void (*op)(mpz_ptr, mpz_srcptr, mpz_srcptr))
{
    int degree = a->degree > b->degree ? a->degree : b->degree;
    for (int i = 0; i <= degree; i++) {
        if (i > a->degree) {
            mpz_set_ui(out->c[i], 0);
            op(out->c[i], out->c[i], b->c[i]);
        } else if (i > b->degree) {
            mpz_set(out->c[i], a->c[i]);
        } else {
            op(out->c[i], a->c[i], b->c[i]);
        }
    }
    out->degree = degree;
    trim(out);
}

void eng_poly_add(struct eng_poly *out, const struct eng_poly *a,
                  const struct eng_poly *b)
{
    combine(out, a, b, mpz_add);
}

void eng_poly_sub(struct eng_poly *out, const struct eng_poly *a,
                  const struct eng_poly *b)
{
    combine(out, a, b, mpz_sub);
}

void eng_poly_mul(struct eng_poly *out, const struct eng_poly *a,
                  const struct eng_poly *b)
{
    if (a->degree < 0 || b->degree < 0) {
        out->degree = -1;
        return;
    }
    assert(a->degree + b->degree < ENG_POLY_TERMS);
    out->degree = a->degree + b->degree;
    for (int i = 0; i <= out->degree; i++) {
        mpz_set_ui(out->c[i], 0);
    }
    for (int i = 0; i <= a->degree; i++) {
        for (int j = 0; j <= b->degree; j++) {
            mpz_addmul(out->c[i + j], a->c[i], b->c[j]);
        }
    }
}

void eng_poly_negate(struct eng_poly *poly)
{
    for (int i = 0; i <= poly->degree; i++) {
        mpz_neg(poly->c[i], poly->c[i]);
    }
}

void eng_poly_shorten(struct eng_poly *poly)
{
    mp_bitcnt_t zeros = ~(mp_bitcnt_t)0;
    for (int i = 0; i <= poly->degree; i++) {
        if (mpz_sgn(poly->c[i]) != 0) {
            mp_bitcnt_t own = mpz_scan1(poly->c[i], 0);
            zeros = own < zeros ? own : zeros;
        }
    }
    for (int i = 0; i <= poly->degree && zeros > 0; i++) {
        mpz_tdiv_q_2exp(poly->c[i], poly->c[i], zeros);
    }
}

/* One step of pseudo-division: a = lead(b) a - lead(a) t^shift b, of lower degree.
 * Returns the old lead(a), in the scratch of a. */
static mpz_srcptr eliminate(struct eng_poly *a, const struct eng_poly *b)
{
    int shift = a->degree - b->degree;
    mpz_ptr lead = a->scratch[1];
    mpz_set(lead, a->c[a->degree]);
    for (int i = 0; i <= a->degree; i++) {
        mpz_mul(a->c[i], a->c[i], b->c[b->degree]);
    }
    for (int i = 0; i <= b->degree; i++) {
        mpz_submul(a->c[i + shift], lead, b->c[i]);
    }
    trim(a);
    return lead;
}

/* a = lead(b)^(difference of degrees, and 1) a modulo b: what pseudo-division leaves. */
static void leave_remainder(struct eng_poly *a, const struct eng_poly *b)
{
    int left = a->degree - b->degree + 1;
    for (; a->degree >= b->degree; left--) {
        eliminate(a, b);
    }
    for (; left > 0; left--) {
        for (int i = 0; i <= a->degree; i++) {
            mpz_mul(a->c[i], a->c[i], b->c[b->degree]);
        }
    }
}

/* Subresultants: what each remainder can be divided by is known from the degrees and
 * leading coefficients before it, without a greatest common divisor of numbers. g and h
 * are as in Knuth's algorithm C. */
void eng_poly_gcd(struct eng_poly *out, struct eng_poly *a, struct eng_poly *b)
{
    struct eng_poly *high = a->degree >= b->degree ? a : b;
    struct eng_poly *low = a->degree >= b->degree ? b : a;
    mpz_ptr g = out->scratch[0];
    mpz_ptr h = out->scratch[1];
    mpz_ptr factor = out->scratch[2];
    eng_poly_shorten(high);
    eng_poly_shorten(low);
    mpz_set_ui(g, 1);
    mpz_set_ui(h, 1);
    while (low->degree > 0) {
        unsigned long apart = (unsigned long)(high->degree - low->degree);
        leave_remainder(high, low);
        mpz_pow_ui(factor, h, apart);
        mpz_mul(factor, factor, g);
        for (int i = 0; i <= high->degree; i++) {
            mpz_divexact(high->c[i], high->c[i], factor);
        }
        mpz_set(g, low->c[low->degree]);
        if (apart > 0) {
            mpz_pow_ui(factor, g, apart);
            mpz_pow_ui(h, h, apart - 1);
            mpz_divexact(h, factor, h);
        }
        struct eng_poly *next = high;
        high = low;
        low = next;
    }
    eng_poly_copy(out, low->degree < 0 ? high : low);
    eng_poly_shorten(out);
}

/* out = a / b up to a constant factor, where b divides a over the rationals. `a` is used
 * up. Each quotient coefficient is found at a larger common multiple, so the earlier ones
 * are scaled along. */
static void divide(struct eng_poly *out, struct eng_poly *a, const struct eng_poly *b)
{
    out->degree = a->degree - b->degree;
    for (int i = 0; i <= out->degree; i++) {
        mpz_set_ui(out->c[i], 0);
    }
    while (a->degree >= b->degree) {
        int shift = a->degree - b->degree;
        mpz_srcptr lead = eliminate(a, b);
        for (int i = 0; i <= out->degree; i++) {
            mpz_mul(out->c[i], out->c[i], b->c[b->degree]);
        }
        mpz_add(out->c[shift], out->c[shift], lead);
    }
    assert(a->degree < 0);
    eng_poly_shorten(out);
}

void eng_poly_square_free(struct eng_poly *out, const struct eng_poly *a,
                          struct eng_poly *s, struct eng_poly *d, struct eng_poly *common)
{
    d->degree = a->degree - 1;
    for (int i = 1; i <= a->degree; i++) {
        mpz_mul_ui(d->c[i - 1], a->c[i], (unsigned long)i);
    }
    eng_poly_copy(s, a);
    eng_poly_gcd(common, s, d);
    eng_poly_copy(s, a);
    if (common->degree > 0) {
        divide(out, s, common);
    } else {
        eng_poly_copy(out, s);
        eng_poly_shorten(out);
    }
}

/* poly(t + by), by Horner's scheme repeated. */
static void shift(struct eng_poly *poly, const mpz_t by)
{
    for (int i = 0; i < poly->degree; i++) {
        for (int j = poly->degree - 1; j >= i; j--) {
            mpz_addmul(poly->c[j], poly->c[j + 1], by);
        }
    }
}

void eng_poly_zoom(struct eng_poly *out, const struct eng_poly *a, const mpz_t num,
                   unsigned long k)
{
    eng_poly_copy(out, a);
    for (int i = 0; i < out->degree; i++) {
        mpz_mul_2exp(out->c[i], out->c[i], k * (unsigned long)(out->degree - i));
    }
    shift(out, num);
}

int eng_poly_sign_at_0(const struct eng_poly *poly)
{
    return poly->degree < 0 ? 0 : mpz_sgn(poly->c[0]);
}

int eng_poly_sign_at_1(struct eng_poly *poly)
{
    mpz_ptr sum = poly->scratch[0];
    mpz_set_ui(sum, 0);
    for (int i = 0; i <= poly->degree; i++) {
        mpz_add(sum, sum, poly->c[i]);
    }
    return mpz_sgn(sum);
}

int eng_poly_variations(struct eng_poly *poly, int *sign)
{
    /* (1 + y)^n poly(1 / (1 + y)) has the Bernstein coefficients, times binomials, as its
     * coefficients: reverse, then shift by one. */
    mpz_t *b = poly->scratch;
    int n = poly->degree;
    for (int i = 0; i <= n; i++) {
        mpz_set(b[n - i], poly->c[i]);
    }
    for (int i = 0; i < n; i++) {
        for (int j = n - 1; j >= i; j--) {
            mpz_add(b[j], b[j], b[j + 1]);
        }
    }
    int variations = 0;
    int last = 0;
    for (int i = 0; i <= n; i++) {
        int s = mpz_sgn(b[i]);
        if (s != 0) {
            variations += last != 0 && s != last;
            last = s;
        }
    }
    *sign = last;
    return variations;
}
