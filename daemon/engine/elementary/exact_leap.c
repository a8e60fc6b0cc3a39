/* daemon/engine/elementary/exact_leap.c - from an interval to a much shorter one.
 *
 * Room:     engine.
 * Does:     guess where in an interval all its roots are, and prove it by counting sign
 *           variations.
 * Threads:  one thread for one scratch.
 * Source:   Abbott: Quadratic interval refinement for real roots, 2006.
 *
 * Bisection takes a step a bit, and roots that are 2^-1000 from each other or from 0 take
 * a thousand. A leap goes down `stride` bits at a time: to the interval below the present
 * one in which the roots seem to be. It is right if that has as many sign variations as
 * the present one: variations of the parts of an interval, and roots where they meet, add
 * up to no more than its own, so all other parts have none. Bisection would come to the
 * same interval. (Abbott: Quadratic interval refinement for real roots, 2006.)
 */
#include "exact_roots.h"

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

/* Where one root would be if the polynomial were linear over the interval at hand; the
 * middle of two, if its slope were; the middle of three, where the slope of that is 0. */
static bool guess(struct eng_exact_span *span, int variations, unsigned long stride)
{
    struct eng_poly *f = &span->zoomed;
    mpz_ptr at_0 = f->scratch[0];
    mpz_ptr at_1 = f->scratch[1];
    mpz_set(at_0, f->c[variations - 1]);
    mpz_set_ui(at_1, 0);
    for (int i = variations - 1; i <= f->degree; i++) {
        unsigned long factor = variations == 1   ? 1
                               : variations == 2 ? (unsigned long)i
                                                 : (unsigned long)(i * (i - 1) / 2);
        mpz_addmul_ui(at_1, f->c[i], factor);
    }
    return divide_between(span->end, at_0, at_1, f->scratch[2], stride);
}

/* Is part number span->end of 2^stride that which has all the variations? Then it becomes
 * the interval at hand, and span->zoomed is of it. */
static bool leap_to(struct eng_exact_span *span, int variations, unsigned long stride)
{
    int sign;
    eng_poly_zoom(&span->zoomed, &span->base, span->end, stride);
    /* A root at its left end has been looked at if the interval at hand begins there. */
    if ((mpz_sgn(span->end) != 0 && eng_poly_sign_at_0(&span->zoomed) == 0) ||
        eng_poly_variations(&span->zoomed, &sign) != variations) {
        return false;
    }
    mpz_mul_2exp(span->num, span->num, stride);
    mpz_add(span->num, span->num, span->end);
    return true;
}

bool eng_roots_leap(struct eng_exact_span *span, int variations, unsigned long stride)
{
    if (guess(span, variations, stride)) {
        if (leap_to(span, variations, stride)) {
            return true;
        }
        mpz_sub_ui(span->end, span->end, 1);
        if (mpz_sgn(span->end) >= 0 && leap_to(span, variations, stride)) {
            return true;
        }
    }
    mpz_set_ui(span->end, 0);
    if (leap_to(span, variations, stride)) {
        return true;
    }
    mpz_set_ui(span->end, 1);
    mpz_mul_2exp(span->end, span->end, stride);
    mpz_sub_ui(span->end, span->end, 1);
    return leap_to(span, variations, stride);
}
