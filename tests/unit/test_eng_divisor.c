/* test_eng_divisor.c - greatest common divisors by primes. */
#include "eng_kit.h"
#include "poly.h"

static void set_numbers(struct eng_poly *poly, int degree, const long *numbers,
                        unsigned long shift)
{
    poly->degree = degree;
    for (int i = 0; i <= degree; i++) {
        mpz_set_si(poly->c[i], numbers[i]);
        mpz_mul_2exp(poly->c[i], poly->c[i], shift * (unsigned long)(degree - i));
    }
}

static struct eng_divisor *divisor_scratch(void)
{
    static struct eng_divisor divisor;
    struct eng_limbs limbs = {NULL, 0};
    eng_divisor_allocate(&divisor, &limbs);
    limbs = (struct eng_limbs){calloc(limbs.count, sizeof(mp_limb_t)), 0};
    assert_non_null(limbs.next);
    eng_divisor_allocate(&divisor, &limbs);
    return &divisor;
}

/* Products of short and of long polynomials; and t - 2^260 and 2 t^2 - 1, which have a
 * common root modulo 2^521 - 1. If it failed: a side would be said to be 0 at a root
 * where it is not, or a root to be there twice. */
CASE(divisor__is_that_of_remainders)
{
    static const long unlucky[2][3] = {{-1, 1}, {-1, 0, 2}};
    struct prng random = {3};
    struct eng_divisor *divisor = divisor_scratch();
    mp_limb_t *block = divisor->common.c[0]->_mp_d;
    struct eng_poly p[6];
    int degrees[6] = {0}; /* 3 + 2 at most */
    for (int i = 0; i < 6; i++) {
        kit_poly_init(&p[i]);
    }
    for (int n = 0; n < 2000; n++) {
        unsigned long shift = prng_u32(&random, 3) ? prng_u32(&random, 40) : 700;
        for (int i = 0; i < 3; i++) {
            long numbers[4];
            int degree = (int)prng_u32(&random, i == 0 ? 4 : 3);
            for (int k = 0; k <= degree; k++) {
                numbers[k] = (long)prng_u32(&random, 9) - 4;
            }
            numbers[degree] = 1 + (long)prng_u32(&random, 3);
            set_numbers(&p[i], degree, numbers, shift);
        }
        eng_poly_mul(&p[3], &p[0], &p[1]);
        eng_poly_mul(&p[4], &p[0], &p[2]);
        if (p[3].degree < 1 || p[4].degree < 1) {
            continue;
        }
        eng_divisor_find(divisor, &p[3], &p[4]);
        eng_poly_gcd(&p[5], &p[3], &p[4]);
        eng_poly_make_primitive(&p[5]);
        assert_int_equal(divisor->common.degree, p[5].degree);
        for (int i = 0; i <= p[5].degree && p[5].degree > 0; i++) {
            int same = mpz_sgn(p[5].c[p[5].degree]) > 0
                           ? mpz_cmp(divisor->common.c[i], p[5].c[i])
                           : mpz_cmpabs(divisor->common.c[i], p[5].c[i]);
            assert_int_equal(same, 0);
        }
        degrees[p[5].degree]++;
    }
    assert_true(degrees[0] > 50 && degrees[1] > 50 && degrees[2] > 50 && degrees[3] > 50);
    set_numbers(&p[3], 1, unlucky[0], 260);
    set_numbers(&p[4], 2, unlucky[1], 0);
    eng_divisor_find(divisor, &p[3], &p[4]);
    assert_int_equal(divisor->common.degree, 0);
    for (int i = 0; i < 6; i++) {
        kit_poly_deinit(&p[i]);
    }
    free(block);
}
