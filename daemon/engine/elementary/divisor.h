/* divisor.h - the greatest common divisor of two polynomials whose coefficients are long.
 *
 * Compute it modulo a prime that is longer than they are, and prove the result by
 * dividing both. No number becomes longer than twice that prime, where remainders of
 * integers would be up to 25 times as long.
 *
 * Threads: one thread for one struct eng_divisor. Nothing is allocated.
 * Source: Collins 1971; Knuth, The Art of Computer Programming 2, 4.6.1.
 */
#ifndef ENG_DIVISOR_H
#define ENG_DIVISOR_H

#include "poly.h"

/* Bits of the longest coefficient of what it is asked about. */
#define ENG_DIVISOR_BITS 14400ul

struct eng_divisor {
    struct eng_poly common; /* what was found, primitive */
    struct eng_poly a, b;   /* both modulo the prime, and what division leaves */
    mpz_t prime, factor, product;
};

void eng_divisor_place(struct eng_divisor *divisor, struct eng_limbs *limbs);

/* common = the greatest common divisor of a and b. Their degrees are 1 to 6 and add up to
 * 11 at most. */
void eng_divisor_find(struct eng_divisor *divisor, const struct eng_poly *a,
                      const struct eng_poly *b);

#endif
