/* divisor.c - greatest common divisors modulo Mersenne primes.
 *
 * A common divisor modulo the prime has at least the degree of the greatest common
 * divisor, since the prime, being longer than the leading coefficients, divides none of
 * them; so if it divides both, it is that. The primes modulo which it has more are
 * divisors of a resultant, which is not long enough for all of them (BOUNDS.md).
 */
#include "poly.h"

#include <assert.h>

/* 2^n - 1 is a prime. */
static const unsigned long exponents[] = {521,   1279,  2281,  4423,  9689,
                                          19937, 21701, 23209, 44497, 86243};

#define EXPONENTS    (sizeof exponents / sizeof exponents[0])
#define LONGEST      86243ul
#define BOUND_BITS   8ul /* of a coefficient of a divisor, more than of what it divides */
#define PRODUCT_BITS (2 * LONGEST + 8)

void eng_divisor_allocate(struct eng_divisor *divisor, struct eng_limbs *limbs)
{
    const struct eng_poly_size common = {7, PRODUCT_BITS, 1, PRODUCT_BITS};
    const struct eng_poly_size residue = {7, PRODUCT_BITS, 2, LONGEST};
    eng_poly_allocate(&divisor->common, limbs, &common);
    eng_poly_allocate(&divisor->a, limbs, &residue);
    eng_poly_allocate(&divisor->b, limbs, &residue);
    eng_limbs_give(limbs, divisor->prime, LONGEST + 1);
    eng_limbs_give(limbs, divisor->factor, PRODUCT_BITS);
    eng_limbs_give(limbs, divisor->product, PRODUCT_BITS);
}

/* number = number modulo 2^n - 1, from 0 on. */
static void reduce_number(mpz_ptr number, unsigned long n, mpz_ptr above)
{
    while (mpz_sgn(number) < 0 || mpz_sizeinbase(number, 2) > n) {
        mpz_fdiv_q_2exp(above, number, n);
        mpz_fdiv_r_2exp(number, number, n);
        mpz_add(number, number, above);
    }
    if (mpz_scan0(number, 0) == n) {
        mpz_set_ui(number, 0);
    }
}

static void reduce(struct eng_poly *poly, unsigned long n, mpz_ptr above)
{
    for (int i = 0; i <= poly->degree; i++) {
        reduce_number(poly->c[i], n, above);
    }
    while (poly->degree >= 0 && mpz_sgn(poly->c[poly->degree]) == 0) {
        poly->degree--;
    }
}

/* The greatest common divisor modulo 2^n - 1, up to a factor; NULL: a number. */
static struct eng_poly *find_modulo(struct eng_divisor *divisor, unsigned long n)
{
    struct eng_poly *high = &divisor->a;
    struct eng_poly *low = &divisor->b;
    reduce(high, n, divisor->product);
    reduce(low, n, divisor->product);
    while (low->degree > 0) {
        while (high->degree >= low->degree) {
            eng_poly_eliminate(high, low);
            reduce(high, n, divisor->product);
        }
        struct eng_poly *next = high;
        high = low;
        low = next;
    }
    return low->degree < 0 ? high : NULL;
}

/* common = `residue` times what gives it the leading coefficient `factor`, by numbers
 * around 0, and primitive. */
static void set_common(struct eng_divisor *divisor, const struct eng_poly *residue,
                       unsigned long n)
{
    struct eng_poly *common = &divisor->common;
    mpz_invert(divisor->product, residue->c[residue->degree], divisor->prime);
    mpz_mul(common->scratch[0], divisor->product, divisor->factor);
    mpz_swap(common->scratch[0], divisor->factor);
    reduce_number(divisor->factor, n, divisor->product);
    common->degree = residue->degree;
    for (int i = 0; i <= common->degree; i++) {
        mpz_mul(common->c[i], residue->c[i], divisor->factor);
        reduce_number(common->c[i], n, divisor->product);
        if (mpz_sizeinbase(common->c[i], 2) == n) {
            mpz_sub(common->c[i], common->c[i], divisor->prime);
        }
    }
    eng_poly_make_primitive(common);
}

/* Return whether common divides `poly`. `rest`: room for what division leaves. */
static bool divides(struct eng_divisor *divisor, const struct eng_poly *poly,
                    struct eng_poly *rest)
{
    const struct eng_poly *common = &divisor->common;
    mpz_srcptr lead = common->c[common->degree];
    eng_poly_copy(rest, poly);
    for (int i = rest->degree; i >= common->degree; i--) {
        if (!mpz_divisible_p(rest->c[i], lead)) {
            return false;
        }
        mpz_divexact(divisor->product, rest->c[i], lead);
        for (int j = 0; j < common->degree; j++) {
            mpz_submul(rest->c[i - common->degree + j], divisor->product, common->c[j]);
        }
    }
    for (int i = 0; i < common->degree; i++) {
        if (mpz_sgn(rest->c[i]) != 0) {
            return false;
        }
    }
    return true;
}

/* bits: that no coefficient of a divisor exceeds. */
static bool try_modulo(struct eng_divisor *divisor, const struct eng_poly *a,
                       const struct eng_poly *b, size_t bits, unsigned long n)
{
    eng_poly_copy(&divisor->a, a);
    eng_poly_copy(&divisor->b, b);
    const struct eng_poly *residue = find_modulo(divisor, n);
    if (residue == NULL) {
        mpz_set_ui(divisor->common.c[0], 1);
        divisor->common.degree = 0;
        return true;
    }
    mpz_set_ui(divisor->prime, 1);
    mpz_mul_2exp(divisor->prime, divisor->prime, n);
    mpz_sub_ui(divisor->prime, divisor->prime, 1);
    mpz_gcd(divisor->factor, a->c[a->degree], b->c[b->degree]);
    set_common(divisor, residue, n);
    return eng_poly_bits(&divisor->common) <= bits && divides(divisor, a, &divisor->a) &&
           divides(divisor, b, &divisor->b);
}

void eng_divisor_find(struct eng_divisor *divisor, const struct eng_poly *a,
                      const struct eng_poly *b)
{
    size_t bits_a = eng_poly_bits(a);
    size_t bits_b = eng_poly_bits(b);
    size_t bits = (bits_a > bits_b ? bits_a : bits_b) + BOUND_BITS;
    bool is_found = false;
    assert(a->degree > 0 && b->degree > 0 && bits <= ENG_DIVISOR_BITS + BOUND_BITS);
    for (size_t i = 0; i < EXPONENTS && !is_found; i++) {
        is_found = exponents[i] > bits && try_modulo(divisor, a, b, bits, exponents[i]);
    }
    assert(is_found);
}
