/* root_sign.h - tells whether a quadratic is positive, negative or zero at a root of
 * another polynomial, exactly.
 *
 * Take the root as an interval around it, and give the sign of a polynomial of degree 2
 * or less there, in a fixed number of operations, even where the roots of the two nearly
 * or exactly coincide. Where they only nearly do, a shorter interval may tell sooner.
 *
 * Threads: one thread for one scratch.
 * Source: van der Hoeven: Ball arithmetic, 2009; Johansson: Arb, 2017.
 */
#ifndef ENG_ROOT_SIGN_H
#define ENG_ROOT_SIGN_H

#include "poly.h"

/* A number that differs from `value` 2^e by less than 2^error. */
struct eng_ball {
    mpz_t value;
    long e;
    long error; /* LONG_MIN: it is the number itself */
};

/* A root, alone in the open interval (num, num + 1) / 2^k and simple. */
struct eng_root {
    const struct eng_poly *poly; /* of degree 1 to 3 */
    mpz_t *num;
    unsigned long k;
    int before; /* sign of `poly` between the left end and the root */
};

struct eng_root_sign {
    struct eng_poly zoomed;
    struct eng_poly g;
    struct eng_ball quadratic[3]; /* g */
    struct eng_ball rest[4];
    struct eng_ball at, product;
    mpz_t x, y, power, value, scratch; /* y > 0: a time is x / y */
};

/* Reserve the numbers. The root's polynomial has coefficients of up to 3 bits + 32 bits,
 * the others of 2 bits + 24; k is at most `depth`. */
void eng_root_sign_allocate(struct eng_root_sign *sign, struct eng_limbs *limbs,
                            size_t bits, size_t depth);

/* Set *sign to that of `poly` (of degree 2 or less) at the root: -1, 0 or 1. False: with
 * few bits it is not sure; it is not 0, and in a short enough interval around the root
 * `poly` has one sign. With `by_all_bits` the sign is always found. */
bool eng_root_sign_of(struct eng_root_sign *scratch, const struct eng_poly *poly,
                      const struct eng_root *root, bool by_all_bits, int *sign);

#endif
