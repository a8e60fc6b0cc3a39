/* exact_leap.c - from an interval to a much shorter one.
 *
 * Source: Abbott: Quadratic interval refinement for real roots, 2006.
 *
 * Bisection takes a step a bit, and roots that are 2^-1000 from each other or from 0 take
 * a thousand. A leap goes down `stride` bits at a time: to the interval below the present
 * one in which the roots seem to be. It is right if that has as many sign variations as
 * the present one: variations of the parts of an interval, and roots where they meet, add
 * up to no more than its own, so all other parts have none. Bisection would come to the
 * same interval. (Abbott: Quadratic interval refinement for real roots, 2006.)
 */
#include "exact_roots.h"

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
    if (eng_poly_guess(span->end, &span->zoomed, variations, stride)) {
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
