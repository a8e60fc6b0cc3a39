/* root_sign.c - the sign of a quadratic at a root.
 *
 * See root_sign.h. Let f be the polynomial with the root a, and g the quadratic, with a
 * positive leading coefficient. Where g has roots in the interval, it is enough to know
 * on which side of a root c of g the root a is: f(c) has the sign that f has before a, or
 * the other one, or is 0. f(c) is a positive multiple of r(c), where r is what is left of
 * f after division by g: a linear polynomial, whose root is a fraction. g at that
 * fraction tells where it is, seen from c.
 */
#include "root_sign.h"

#include <assert.h>
#include <limits.h>

/* ---- long integers by their leading bits (ball arithmetic) ----------------------- */

#define ALL_BITS LONG_MAX /* nothing is rounded */

/* `bits`: of the longest value that is ever in it. */
static void ball_allocate(struct eng_ball *ball, struct eng_limbs *limbs, size_t bits)
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

/* Set a result, of whose value at most `bits` are kept. */
static void ball_set(struct eng_ball *out, const mpz_t a, long bits)
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

/* out = out + a, out - a. `a` is rounded, too, where it has more bits than matter. */
static void ball_add(struct eng_ball *out, struct eng_ball *a, long bits)
{
    combine(out, a, bits, mpz_add);
}

static void ball_sub(struct eng_ball *out, struct eng_ball *a, long bits)
{
    combine(out, a, bits, mpz_sub);
}

/* out may be a or b. */
static void ball_mul(struct eng_ball *out, const struct eng_ball *a,
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

/* Return whether the sign is sure. Then *sign is it. */
static bool ball_sign(const struct eng_ball *ball, int *sign)
{
    *sign = mpz_sgn(ball->value);
    return ball->error == LONG_MIN || (*sign != 0 && size_of(ball) - 1 >= ball->error);
}

/* ---- signs ----------------------------------------------------------------------- */

/* BOUNDS.md, "How long numbers become". */
void eng_root_sign_allocate(struct eng_root_sign *sign, struct eng_limbs *limbs,
                            size_t bits, size_t depth)
{
    const size_t g_bits = 2 * bits + 24;
    const size_t zoomed_bits = 2 * bits + 3 * depth + 128;
    const size_t rest_bits = 16 * bits + depth + 256;
    eng_poly_allocate(&sign->g, limbs, &(struct eng_poly_size){3, g_bits, 0, 0});
    eng_poly_allocate(&sign->zoomed, limbs,
                      &(struct eng_poly_size){3, zoomed_bits, 3, zoomed_bits});
    for (int i = 0; i < 3; i++) {
        ball_allocate(&sign->quadratic[i], limbs, g_bits);
    }
    for (int i = 0; i < 4; i++) {
        ball_allocate(&sign->rest[i], limbs, rest_bits);
    }
    ball_allocate(&sign->at, limbs, rest_bits);
    ball_allocate(&sign->product, limbs, rest_bits);
    eng_limbs_give(limbs, sign->x, g_bits + 1);
    eng_limbs_give(limbs, sign->y, g_bits + 1);
    mpz_ptr swapped[] = {sign->power, sign->value, sign->scratch};
    for (int i = 0; i < 3; i++) { /* all of one size: they are exchanged */
        eng_limbs_give(limbs, swapped[i], 9 * bits + depth + 128);
    }
}

/* Sign of `poly` at x / y. */
static int sign_at_fraction(struct eng_root_sign *s, const struct eng_poly *poly)
{
    if (poly->degree < 0) {
        return 0;
    }
    mpz_set(s->value, poly->c[poly->degree]);
    mpz_set_ui(s->power, 1);
    for (int i = poly->degree - 1; i >= 0; i--) {
        mpz_mul(s->scratch, s->power, s->y);
        mpz_swap(s->power, s->scratch);
        mpz_mul(s->scratch, s->value, s->x);
        mpz_swap(s->value, s->scratch);
        mpz_addmul(s->value, poly->c[i], s->power);
    }
    return mpz_sgn(s->value);
}

/* x / y = the root of a linear polynomial. */
static void set_fraction(struct eng_root_sign *s, const struct eng_poly *linear)
{
    mpz_set(s->y, linear->c[1]);
    mpz_neg(s->x, linear->c[0]);
    if (mpz_sgn(s->y) < 0) {
        mpz_neg(s->y, s->y);
        mpz_neg(s->x, s->x);
    }
}

/* Sign of the discriminant of g, and x / y = where its slope is 0. */
static int look_at_slope(struct eng_root_sign *s)
{
    mpz_mul(s->value, s->g.c[1], s->g.c[1]);
    mpz_mul(s->scratch, s->g.c[0], s->g.c[2]);
    mpz_mul_2exp(s->scratch, s->scratch, 2);
    mpz_neg(s->x, s->g.c[1]);
    mpz_mul_2exp(s->y, s->g.c[2], 1);
    return mpz_cmp(s->value, s->scratch);
}

/* out = out b - c d. */
static void scale_and_sub(struct eng_root_sign *s, struct eng_ball *out,
                          const struct eng_ball *b, const struct eng_ball *c,
                          const struct eng_ball *d, long bits)
{
    ball_mul(out, out, b, bits);
    ball_mul(&s->product, c, d, bits);
    ball_sub(out, &s->product, bits);
}

/* rest[1] t + rest[0] = a positive multiple of what division by g leaves of f, and
 * quadratic[0 .. 2] = g. */
static void set_rest(struct eng_root_sign *s, const struct eng_poly *f, long bits)
{
    for (int i = 0; i <= 2; i++) {
        ball_set(&s->quadratic[i], s->g.c[i], bits);
    }
    mpz_set_ui(s->value, 0);
    for (int i = 0; i < 4; i++) {
        ball_set(&s->rest[i], i <= f->degree ? f->c[i] : s->value, bits);
    }
    for (int high = f->degree; high >= 2; high--) {
        const struct eng_ball *lead = &s->rest[high];
        scale_and_sub(s, &s->rest[high - 1], &s->quadratic[2], lead, &s->quadratic[1],
                      bits);
        scale_and_sub(s, &s->rest[high - 2], &s->quadratic[2], lead, &s->quadratic[0],
                      bits);
        if (high == 3) {
            ball_mul(&s->rest[0], &s->rest[0], &s->quadratic[2], bits);
        }
    }
}

/* Signs of the rest at both ends of the interval. False: they are not sure. */
static bool look_at_ends(struct eng_root_sign *s, const struct eng_root *root, long bits,
                         int ends[2])
{
    mpz_set_ui(s->value, 1);
    mpz_mul_2exp(s->value, s->value, root->k);
    ball_set(&s->at, s->value, bits);
    ball_mul(&s->at, &s->at, &s->rest[0], bits);
    ball_set(&s->product, *root->num, bits);
    ball_mul(&s->product, &s->product, &s->rest[1], bits);
    ball_add(&s->at, &s->product, bits);
    if (!ball_sign(&s->at, &ends[0])) {
        return false;
    }
    mpz_set_ui(s->value, 1);
    ball_set(&s->product, s->value, bits);
    ball_mul(&s->product, &s->product, &s->rest[1], bits);
    ball_add(&s->at, &s->product, bits);
    return ball_sign(&s->at, &ends[1]);
}

/* Signs of g, and of its slope, at x / y = -rest[0] / rest[1], for y > 0. `rising`: the
 * sign of rest[1]. */
static bool look_at_fraction(struct eng_root_sign *s, int rising, long bits, int *g,
                             int *slope)
{
    struct eng_ball *sum = &s->at;
    const struct eng_ball *r0 = &s->rest[0];
    const struct eng_ball *r1 = &s->rest[1];
    ball_mul(sum, &s->quadratic[1], r1, bits);
    ball_mul(&s->product, &s->quadratic[2], r0, bits);
    ball_sub(sum, &s->product, bits);
    ball_mul(&s->rest[2], sum, r0, bits); /* (g1 r1 - g2 r0) r0 */
    ball_sub(sum, &s->product, bits);
    if (!ball_sign(sum, slope)) {
        return false;
    }
    *slope *= rising;
    ball_mul(sum, &s->quadratic[0], r1, bits);
    ball_mul(sum, sum, r1, bits);
    ball_sub(sum, &s->rest[2], bits);
    return ball_sign(sum, g);
}

/* Sign of f at the first or second root of g, which has two. False: not sure. */
static bool look_at_root_of_g(struct eng_root_sign *s, const struct eng_root *root,
                              bool is_first, long bits, int *sign)
{
    int ends[2];
    int g;
    int slope;
    set_rest(s, root->poly, bits);
    if (!look_at_ends(s, root, bits, ends)) {
        return false;
    }
    if (ends[0] * ends[1] >= 0) {
        *sign = ends[0] != 0 ? ends[0] : ends[1];
        return true;
    }
    int rising = ends[1];
    if (!look_at_fraction(s, rising, bits, &g, &slope)) {
        return false;
    }
    if (is_first) { /* x / y is before it where g is positive and falls */
        *sign = g == 0 && slope < 0 ? 0 : g > 0 && slope < 0 ? rising : -rising;
    } else {
        *sign = g == 0 && slope > 0 ? 0 : g > 0 && slope > 0 ? -rising : rising;
    }
    return true;
}

/* With few bits and with more; with all if it is wanted so, or if the polynomials may
 * have a root in common, which no shorter interval would tell. */
static bool sign_at_root_of_g(struct eng_root_sign *s, const struct eng_root *root,
                              bool is_first, bool by_all_bits, int *sign)
{
    if (look_at_root_of_g(s, root, is_first, 128, sign) ||
        look_at_root_of_g(s, root, is_first, 1024, sign)) {
        return true;
    }
    if (!by_all_bits && !eng_residue_may_share_root(root->poly, &s->g)) {
        return false;
    }
    bool is_sure = look_at_root_of_g(s, root, is_first, ALL_BITS, sign);
    assert(is_sure);
    return is_sure;
}

/* g has the linear form c1 t + c0, c1 > 0. */
static int sign_of_linear(struct eng_root_sign *s, const struct eng_root *root)
{
    set_fraction(s, &s->g);
    int f = sign_at_fraction(s, root->poly);
    return f == 0 ? 0 : f == root->before ? 1 : -1;
}

/* Sign of `poly`, as it is over an interval, right of the left end. */
static int sign_at_left(const struct eng_poly *zoomed)
{
    int sign = 0;
    for (int i = 0; i <= zoomed->degree && sign == 0; i++) {
        sign = mpz_sgn(zoomed->c[i]);
    }
    return sign;
}

/* g has one or two roots in the interval, or is nearly 0 somewhere in it. */
static bool sign_of_quadratic(struct eng_root_sign *s, const struct eng_root *root,
                              bool by_all_bits, int *sign)
{
    int f;
    int throughout;
    eng_poly_zoom(&s->zoomed, &s->g, *root->num, root->k);
    bool is_first = sign_at_left(&s->zoomed) > 0;
    if (eng_poly_variations(&s->zoomed, &throughout) == 2) {
        int discriminant = look_at_slope(s);
        if (discriminant < 0) {
            *sign = 1;
            return true;
        }
        f = sign_at_fraction(s, root->poly);
        if (f == 0 || discriminant == 0) {
            *sign = f != 0 ? 1 : discriminant == 0 ? 0 : -1;
            return true;
        }
        is_first = f != root->before; /* the one on the side of a */
    }
    if (!sign_at_root_of_g(s, root, is_first, by_all_bits, &f)) {
        return false;
    }
    bool is_behind = f == root->before; /* a is behind the root of g */
    *sign = f == 0 ? 0 : is_behind == is_first ? -1 : 1;
    return true;
}

bool eng_root_sign_of(struct eng_root_sign *scratch, const struct eng_poly *poly,
                      const struct eng_root *root, bool by_all_bits, int *sign)
{
    assert(poly->degree <= 2);
    eng_poly_copy(&scratch->g, poly);
    eng_poly_shorten(&scratch->g);
    if (eng_poly_is_plain(&scratch->zoomed, &scratch->g, *root->num, root->k, sign)) {
        return true;
    }
    int turn = mpz_sgn(scratch->g.c[poly->degree]);
    if (turn < 0) {
        eng_poly_negate(&scratch->g);
    }
    if (poly->degree == 1) {
        *sign = turn * sign_of_linear(scratch, root);
        return true;
    }
    bool is_sure = sign_of_quadratic(scratch, root, by_all_bits, sign);
    *sign *= turn;
    return is_sure;
}
