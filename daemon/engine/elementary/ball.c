/* ball.c - sums and products of rounded integers. */
#include "ball.h"

void eng_ball_place(struct eng_ball *ball, struct eng_limbs *limbs, size_t bits)
{
    eng_limbs_give(limbs, ball->value, bits);
}

/* The larger error, times 2^more. */
static long worse(long a, long b, long more)
{
    long most = a > b ? a : b;
    return most == LONG_MIN ? LONG_MIN : most + more;
}

/* An error times a number below 2^size. */
static long times(long error, long size)
{
    return error == LONG_MIN ? LONG_MIN : error + size;
}

/* The rounded number is below 2^size. */
static long size_of(const struct eng_ball *ball)
{
    return (long)mpz_sizeinbase(ball->value, 2) + ball->e;
}

/* Make it a multiple of 2^e: cut off what is below. */
static void set_exponent(struct eng_ball *ball, long e)
{
    if (e > ball->e) {
        mpz_tdiv_q_2exp(ball->value, ball->value, (unsigned long)(e - ball->e));
        ball->error = worse(ball->error, e, 1);
    } else {
        mpz_mul_2exp(ball->value, ball->value, (unsigned long)(ball->e - e));
    }
    ball->e = e;
}

static void keep(struct eng_ball *ball, long bits)
{
    long own = (long)mpz_sizeinbase(ball->value, 2);
    if (own > bits) {
        set_exponent(ball, ball->e + (own - bits));
    }
}

void eng_ball_set(struct eng_ball *out, const mpz_t a, long bits)
{
    long own = (long)mpz_sizeinbase(a, 2);
    out->e = own > bits ? own - bits : 0;
    out->error = own > bits ? out->e : LONG_MIN;
    mpz_tdiv_q_2exp(out->value, a, (unsigned long)out->e);
}

/* One exponent for both: what is below the `bits` of the larger one does not count. */
static void align(struct eng_ball *a, struct eng_ball *b, long bits)
{
    long most = size_of(a) > size_of(b) ? size_of(a) : size_of(b);
    long high = a->e > b->e ? a->e : b->e;
    long low = a->e > b->e ? b->e : a->e;
    if (bits < most - low) {
        low = most - bits < high ? most - bits : high;
    }
    set_exponent(a, low);
    set_exponent(b, low);
}

static void combine(struct eng_ball *out, struct eng_ball *a, long bits,
                    void (*op)(mpz_ptr, mpz_srcptr, mpz_srcptr))
{
    align(out, a, bits);
    op(out->value, out->value, a->value);
    out->error = worse(out->error, a->error, 1);
    keep(out, bits);
}

void eng_ball_add(struct eng_ball *out, struct eng_ball *a, long bits)
{
    combine(out, a, bits, mpz_add);
}

void eng_ball_sub(struct eng_ball *out, struct eng_ball *a, long bits)
{
    combine(out, a, bits, mpz_sub);
}

void eng_ball_mul(struct eng_ball *out, const struct eng_ball *a,
                  const struct eng_ball *b, long bits)
{
    long by_a = times(a->error, size_of(b));
    long by_b = times(b->error, size_of(a));
    long by_both = a->error == LONG_MIN ? LONG_MIN : times(b->error, a->error);
    mpz_mul(out->value, a->value, b->value);
    out->e = a->e + b->e;
    out->error = worse(worse(by_a, by_b, 0), by_both, 2);
    keep(out, bits);
}

bool eng_ball_sign(const struct eng_ball *ball, int *sign)
{
    *sign = mpz_sgn(ball->value);
    return ball->error == LONG_MIN || (*sign != 0 && size_of(ball) - 1 >= ball->error);
}
