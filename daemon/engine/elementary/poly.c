/* poly.c - polynomials with integer coefficients, exactly.
 *
 * Source: Collins and Akritas 1976; Knuth, The Art of Computer Programming 2, 4.6.1.
 */
#include "poly.h"

#include <assert.h>
#include <limits.h>

void eng_poly_allocate(struct eng_poly *poly, struct eng_limbs *limbs,
                       const struct eng_poly_size *size)
{
    poly->degree = -1;
    for (int i = 0; i < size->terms; i++) {
        eng_limbs_give(limbs, poly->c[i], size->bits);
    }
    for (int i = 0; i < size->scratch_count; i++) {
        eng_limbs_give(limbs, poly->scratch[i], size->scratch_bits);
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

size_t eng_poly_bits(const struct eng_poly *poly)
{
    size_t most = 0;
    for (int i = 0; i <= poly->degree; i++) {
        size_t own = mpz_sizeinbase(poly->c[i], 2);
        most = own > most ? own : most;
    }
    return most;
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

void eng_poly_eliminate(struct eng_poly *a, const struct eng_poly *b)
{
    int shift = a->degree - b->degree;
    mpz_ptr lead = a->scratch[1];
    mpz_set(lead, a->c[a->degree]);
    a->degree--; /* what leads cancels */
    for (int i = 0; i <= a->degree; i++) {
        mpz_mul(a->c[i], a->c[i], b->c[b->degree]);
    }
    for (int i = 0; i < b->degree; i++) {
        mpz_submul(a->c[i + shift], lead, b->c[i]);
    }
    trim(a);
}

/* a = lead(b)^(difference of degrees, and 1) a modulo b: what pseudo-division leaves. */
static void leave_remainder(struct eng_poly *a, const struct eng_poly *b)
{
    int left = a->degree - b->degree + 1;
    for (; a->degree >= b->degree; left--) {
        eng_poly_eliminate(a, b);
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

void eng_poly_make_primitive(struct eng_poly *poly)
{
    mpz_ptr common = poly->scratch[0];
    mpz_set_ui(common, 0);
    for (int i = 0; i <= poly->degree; i++) {
        mpz_gcd(common, common, poly->c[i]);
    }
    for (int i = 0; i <= poly->degree; i++) {
        mpz_divexact(poly->c[i], poly->c[i], common);
    }
}

void eng_poly_divide(struct eng_poly *out, struct eng_poly *a, const struct eng_poly *b)
{
    assert(b->degree >= 0 && a->degree >= b->degree);
    out->degree = a->degree - b->degree;
    for (int i = out->degree; i >= 0; i--) {
        mpz_divexact(out->c[i], a->c[i + b->degree], b->c[b->degree]);
        for (int j = 0; j < b->degree; j++) {
            mpz_submul(a->c[i + j], out->c[i], b->c[j]);
        }
    }
}

/* a t^2 + b t + c with one root twice: the root is that of the slope. */
static void make_quadratic_free(struct eng_poly *poly)
{
    mpz_ptr left = poly->scratch[0];
    mpz_ptr right = poly->scratch[1];
    mpz_mul(left, poly->c[1], poly->c[1]);
    mpz_mul(right, poly->c[0], poly->c[2]);
    mpz_mul_2exp(right, right, 2);
    if (mpz_cmp(left, right) == 0) {
        mpz_set(poly->c[0], poly->c[1]);
        mpz_mul_2exp(poly->c[1], poly->c[2], 1);
        poly->degree = 1;
    }
}

/* poly = poly / (y t - x), which divides it and has no common factor in x and y, so that
 * the quotient is of integers. */
static void divide_by_linear(struct eng_poly *poly, mpz_srcptr x, mpz_srcptr y)
{
    for (int i = poly->degree; i > 0; i--) {
        mpz_divexact(poly->c[i], poly->c[i], y);
        mpz_addmul(poly->c[i - 1], poly->c[i], x);
    }
    for (int i = 0; i < poly->degree; i++) {
        mpz_swap(poly->c[i], poly->c[i + 1]);
    }
    poly->degree--;
}

/* a t^3 + b t^2 + c t + d has a root twice if q^2 = 4 p r, where p = b^2 - 3 a c,
 * q = b c - 9 a d and r = c^2 - 3 b d, and only then. That root is -q / (2 p), or, if it
 * is there thrice, -b / (3 a). */
static void make_cubic_free(struct eng_poly *poly)
{
    mpz_ptr p = poly->scratch[0];
    mpz_ptr q = poly->scratch[1];
    mpz_ptr r = poly->scratch[2];
    mpz_ptr product = poly->scratch[3];
    mpz_mul(p, poly->c[2], poly->c[2]);
    mpz_mul(product, poly->c[3], poly->c[1]);
    mpz_submul_ui(p, product, 3);
    mpz_mul(q, poly->c[2], poly->c[1]);
    mpz_mul(product, poly->c[3], poly->c[0]);
    mpz_submul_ui(q, product, 9);
    mpz_mul(r, poly->c[1], poly->c[1]);
    mpz_mul(product, poly->c[2], poly->c[0]);
    mpz_submul_ui(r, product, 3);
    mpz_mul(product, p, r);
    mpz_mul_2exp(product, product, 2);
    mpz_mul(r, q, q);
    if (mpz_cmp(r, product) != 0) {
        return;
    }
    if (mpz_sgn(p) == 0) {
        mpz_set(poly->c[0], poly->c[2]);
        mpz_mul_ui(poly->c[1], poly->c[3], 3);
        poly->degree = 1;
        return;
    }
    mpz_neg(q, q);
    mpz_mul_2exp(p, p, 1);
    mpz_gcd(r, p, q);
    mpz_divexact(p, p, r);
    mpz_divexact(q, q, r);
    divide_by_linear(poly, q, p);
}

void eng_poly_square_free(struct eng_poly *out, const struct eng_poly *a)
{
    assert(a->degree >= 1 && a->degree <= 3);
    eng_poly_copy(out, a);
    if (a->degree == 2) {
        make_quadratic_free(out);
    } else if (a->degree == 3) {
        make_cubic_free(out);
    }
    eng_poly_shorten(out);
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

static void zoom(struct eng_poly *poly, const mpz_t num, unsigned long k)
{
    for (int i = 0; i < poly->degree; i++) {
        mpz_mul_2exp(poly->c[i], poly->c[i], k * (unsigned long)(poly->degree - i));
    }
    shift(poly, num);
}

void eng_poly_zoom(struct eng_poly *out, const struct eng_poly *a, const mpz_t num,
                   unsigned long k)
{
    eng_poly_copy(out, a);
    zoom(out, num, k);
}

void eng_poly_narrow(struct eng_poly *out, const struct eng_poly *a, const mpz_t num,
                     const mpz_t width, unsigned long k)
{
    eng_poly_copy(out, a);
    zoom(out, num, k);
    mpz_ptr power = out->scratch[0];
    mpz_set(power, width);
    for (int i = 1; i <= out->degree; i++) {
        mpz_mul(out->scratch[1], out->c[i], power);
        mpz_set(out->c[i], out->scratch[1]);
        mpz_mul(out->scratch[1], power, width);
        mpz_set(power, out->scratch[1]);
    }
}

int eng_poly_sign_at_0(const struct eng_poly *poly)
{
    return poly->degree < 0 ? 0 : mpz_sgn(poly->c[0]);
}

int eng_poly_sign_after_0(const struct eng_poly *poly)
{
    int sign = 0;
    for (int i = 0; i <= poly->degree && sign == 0; i++) {
        sign = mpz_sgn(poly->c[i]);
    }
    return sign;
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

/* (1 + y)^n poly(1 / (1 + y)) has the Bernstein coefficients, times binomials and from
 * right to left, as its coefficients: reverse, then shift by one. They go to
 * poly->scratch. */
static void set_bernstein(struct eng_poly *poly)
{
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
}

static int count_variations(const struct eng_poly *poly, int *sign)
{
    int variations = 0;
    int last = 0;
    for (int i = 0; i <= poly->degree; i++) {
        int s = mpz_sgn(poly->scratch[i]);
        if (s != 0) {
            variations += last != 0 && s != last;
            last = s;
        }
    }
    *sign = last;
    return variations;
}

int eng_poly_variations(struct eng_poly *poly, int *sign)
{
    set_bernstein(poly);
    return count_variations(poly, sign);
}

/* num = floor(2^stride a / (a - b)), at most 2^stride - 1; false if a and b are not of
 * opposite signs. */
static bool divide_between(mpz_t num, mpz_srcptr a, mpz_srcptr b, mpz_t scratch,
                           unsigned long stride)
{
    if (mpz_sgn(a) * mpz_sgn(b) >= 0) {
        return false;
    }
    mpz_sub(scratch, a, b);
    mpz_mul_2exp(num, a, stride);
    mpz_fdiv_q(num, num, scratch);
    mpz_set_ui(scratch, 1);
    mpz_mul_2exp(scratch, scratch, stride);
    mpz_sub_ui(scratch, scratch, 1);
    if (mpz_cmp(num, scratch) > 0) {
        mpz_set(num, scratch);
    }
    return true;
}

bool eng_poly_guess(mpz_t part, struct eng_poly *poly, int variations,
                    unsigned long stride)
{
    mpz_ptr at_0 = poly->scratch[0];
    mpz_ptr at_1 = poly->scratch[1];
    mpz_set(at_0, poly->c[variations - 1]);
    mpz_set_ui(at_1, 0);
    unsigned long factor = 1; /* i over variations - 1 */
    for (int i = variations - 1; i <= poly->degree; i++) {
        mpz_addmul_ui(at_1, poly->c[i], factor);
        factor = factor * (unsigned long)(i + 1) / (unsigned long)(i + 2 - variations);
    }
    return divide_between(part, at_0, at_1, poly->scratch[2], stride);
}

/* ---- with rounded numbers ---------------------------------------------------------- */

/* Bits of the rounded coefficients, besides twice those of the interval's number. */
#define ROUND_BITS 128l

/* Bits of the longest coefficient after t = 2^-e s. */
static long longest(const struct eng_poly *a, long e)
{
    long most = LONG_MIN;
    for (int i = 0; i <= a->degree; i++) {
        if (mpz_sgn(a->c[i]) != 0) {
            long own = (long)mpz_sizeinbase(a->c[i], 2) - e * i;
            most = own > most ? own : most;
        }
    }
    return most;
}

/* out(s) = 2^by a(2^-e s), cut off at the point. */
static void round_off(struct eng_poly *out, const struct eng_poly *a, long e, long by)
{
    for (int i = 0; i <= a->degree; i++) {
        long shift = by - e * i;
        if (shift >= 0) {
            mpz_mul_2exp(out->c[i], a->c[i], (unsigned long)shift);
        } else {
            mpz_tdiv_q_2exp(out->c[i], a->c[i], (unsigned long)-shift);
        }
    }
    out->degree = a->degree;
}

/* Sign of `a` at num / 2^k. */
static int sign_at(struct eng_poly *scratch, const struct eng_poly *a, const mpz_t num,
                   unsigned long k)
{
    mpz_ptr value = scratch->c[0];
    mpz_ptr product = scratch->c[1];
    mpz_set(value, a->c[a->degree]);
    for (int i = a->degree - 1; i >= 0; i--) {
        mpz_mul(product, value, num);
        mpz_mul_2exp(value, a->c[i], k * (unsigned long)(a->degree - i));
        mpz_add(value, value, product);
    }
    return mpz_sgn(value);
}

static long length_of(const mpz_t num)
{
    return mpz_sgn(num) == 0 ? 0 : (long)mpz_sizeinbase(num, 2);
}

/* The signs of the Bernstein coefficients of `a` over [num, num + 1] / 2^k, from right
 * to left, 0 where they are not sure.
 *
 * With t = 2^(length - k) s the interval is [num, num + 1] / 2^length in s, within
 * [0, 1]. A rounded coefficient is off by less than 1. A Bernstein coefficient is a mean
 * of sums of c_i times up to i numbers in [0, 1], so it is off by less than 5; times a
 * binomial by less than 30, and after zooming by less than 2^5 times
 * 2^(length degree). */
static void look_roughly(struct eng_poly *out, const struct eng_poly *a, const mpz_t num,
                         unsigned long k, long bits, int signs[ENG_POLY_TERMS])
{
    assert(a->degree <= 4);
    long length = length_of(num);
    long e = (long)k - length;
    unsigned long error = 5 + (unsigned long)length * (unsigned long)a->degree;
    round_off(out, a, e, bits - longest(a, e));
    zoom(out, num, (unsigned long)length);
    set_bernstein(out);
    for (int i = 0; i <= a->degree; i++) {
        mpz_srcptr b = out->scratch[i];
        signs[i] = mpz_sizeinbase(b, 2) > error ? mpz_sgn(b) : 0;
    }
}

enum plain { PLAIN, MIXED, UNSURE };

/* Judge by the signs, and set *sign, where the first and the last may be really 0. */
static enum plain judge(const int *signs, int degree, int *sign)
{
    bool is_sure = true;
    *sign = 0;
    for (int i = 0; i <= degree; i++) {
        if (signs[i] * *sign < 0) {
            return MIXED;
        }
        *sign += *sign == 0 ? signs[i] : 0;
        is_sure &= signs[i] != 0 || i == 0 || i == degree;
    }
    return is_sure ? PLAIN : UNSURE;
}

bool eng_poly_is_plain(struct eng_poly *scratch, const struct eng_poly *a, mpz_t num,
                       unsigned long k, int *sign)
{
    int signs[ENG_POLY_TERMS];
    long length = length_of(num);
    long all = a->degree > 0 ? longest(a, 0) + a->degree * (long)k : 0;
    enum plain plain = UNSURE;
    assert((unsigned long)length <= k);
    for (long bits = ROUND_BITS + 2 * length; plain == UNSURE && 2 * bits < all;
         bits *= 4) {
        look_roughly(scratch, a, num, k, bits, signs);
        plain = judge(signs, a->degree, sign);
    }
    if (plain == PLAIN) {
        /* An end is soon looked at exactly. The right one comes first. */
        if (signs[a->degree] == 0) {
            signs[a->degree] = sign_at(scratch, a, num, k);
        }
        if (signs[0] == 0) {
            mpz_add_ui(num, num, 1);
            signs[0] = sign_at(scratch, a, num, k);
            mpz_sub_ui(num, num, 1);
        }
        plain = judge(signs, a->degree, sign);
    } else if (plain == UNSURE) {
        eng_poly_zoom(scratch, a, num, k);
        plain = eng_poly_variations(scratch, sign) == 0 ? PLAIN : MIXED;
    }
    return plain == PLAIN;
}
