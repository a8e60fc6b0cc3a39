/* ball.h - fast arithmetic with long integers: leading bits only, with a bound of the
 * error (ball arithmetic).
 *
 * Threads: [any]; a ball belongs to one thread.
 * Source: van der Hoeven: Ball arithmetic, 2009; Johansson: Arb, 2017.
 */
#ifndef ENG_BALL_H
#define ENG_BALL_H

#include <gmp.h>
#include <limits.h>
#include <stdbool.h>

#include "limbs.h"

#define ENG_BALL_ALL LONG_MAX /* bits: nothing is rounded */

/* A number that differs from `value` 2^e by less than 2^error. */
struct eng_ball {
    mpz_t value;
    long e;
    long error; /* LONG_MIN: it is the number itself */
};

/* `bits`: of the longest value that is ever in it. */
void eng_ball_place(struct eng_ball *ball, struct eng_limbs *limbs, size_t bits);

/* Of a result's value at most `bits` are kept. */
void eng_ball_set(struct eng_ball *out, const mpz_t a, long bits);
/* out = out + a, out - a. `a` is rounded, too, where it has more bits than matter. */
void eng_ball_add(struct eng_ball *out, struct eng_ball *a, long bits);
void eng_ball_sub(struct eng_ball *out, struct eng_ball *a, long bits);
/* out may be a or b. */
void eng_ball_mul(struct eng_ball *out, const struct eng_ball *a,
                  const struct eng_ball *b, long bits);

/* Is the sign sure? Then *sign is it. */
bool eng_ball_sign(const struct eng_ball *ball, int *sign);

#endif
