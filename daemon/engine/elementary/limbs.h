/* limbs.h - gives integers of GMP room of a fixed size in one block of memory, so that
 * computing with them never allocates.
 *
 * Hand out one part of the block after the other; without a block, add up how long it has
 * to be; turn doubles into such integers. GMP ends the process when an allocation fails,
 * so whoever computes with such integers proves that no result is longer than its room
 * (BOUNDS.md).
 *
 * Threads: one thread for one block.
 */
#ifndef ENG_LIMBS_H
#define ENG_LIMBS_H

#include <assert.h>
#include <gmp.h>
#include <math.h>
#include <stddef.h>

struct eng_limbs {
    mp_limb_t *next; /* NULL: they are only counted */
    size_t count;    /* handed out so far */
};

/* Set `number` to 0, with room for any result below 2^bits. It is never cleared. Without
 * a block, only count its limbs. */
static inline void eng_limbs_give(struct eng_limbs *limbs, mpz_ptr number, size_t bits)
{
    /* GMP asks for some limbs more than a result may have, at most 5, in powers. */
    size_t count = bits / GMP_NUMB_BITS + 8;
    if (limbs->next != NULL) {
        number->_mp_alloc = (int)count;
        number->_mp_size = 0;
        number->_mp_d = limbs->next;
        limbs->next += count;
    }
    limbs->count += count;
}

/* Return the lesser of `low` and the exponent of the lowest bit that `value` may have. */
static inline int eng_lower_exponent(double value, int low)
{
    int exponent;
    if (value == 0) {
        return low;
    }
    frexp(value, &exponent);
    return exponent - 53 < low ? exponent - 53 : low;
}

/* Set `out` to value * 2^-low, exactly; low is at most eng_lower_exponent. */
static inline void eng_set_scaled(mpz_ptr out, double value, int low)
{
    int exponent;
    double mantissa = frexp(value, &exponent);
    mpz_set_d(out, ldexp(mantissa, 53));
    if (mantissa != 0) {
        assert(exponent - 53 >= low);
        mpz_mul_2exp(out, out, (unsigned long)(exponent - 53 - low));
    }
}

#endif
