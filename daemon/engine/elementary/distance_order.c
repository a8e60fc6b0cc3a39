/* distance_order.c - which surfaces are less far apart.
 *
 * See distance_order.h. The squares are quotients, which are compared by their products
 * across: num(a) den(b) with num(b) den(a); with radii, these are squared once more
 * (BOUNDS.md).
 */
#include "distance_order.h"

#include <assert.h>
#include <limits.h>
#include <math.h>

#include "box_frame.h"
#include "distance_rule.h"
#include "memory.h"

/* Quotients, then products of two, then one of these shifted to the length of the other:
 * nothing is longer than twice the longest number. With radii: quotients, their
 * difference and its square, two products of four numbers, one of three, the radii and
 * their square. */
#define LENGTHS (4 + 2 + 4 + 4 + 4 + 3 + 1 + 1)

static size_t limbs_of(size_t numbers)
{
    return numbers * (ENG_NUMBER_BITS / GMP_NUMB_BITS + 8);
}

size_t eng_distance_order_bytes(void)
{
    return limbs_of(LENGTHS) * sizeof(mp_limb_t);
}

int eng_distance_order_init(struct eng_distance_order *order)
{
    order->block = eng_alloc(limbs_of(LENGTHS), sizeof *order->block);
    return order->block ? PCCD_OK : PCCD_E_NOMEM;
}

void eng_distance_order_deinit(struct eng_distance_order *order)
{
    eng_free(order->block);
    order->block = NULL;
}

/* The square of a distance is num / den 4^unit. */
struct square {
    struct eng_number num;
    struct eng_number den;
    int unit;
};

/* False: the stage does not know. */
static bool set_square(struct eng_numbers *numbers, bool is_exact,
                       const struct eng_features *features, struct square *square)
{
    static const uint8_t any_rank[4] = {0, 1, 2, 3};
    struct eng_distance_exact way;
    eng_numbers_load(numbers, is_exact, features->x, 4);
    eng_distance_rule(numbers, features->kind, any_rank, &way);
    *square = (struct square){way.num, way.den, numbers->unit};
    return !numbers->is_unsure;
}

/* Times 2^shift, shift >= 0. False: that is too large. */
static bool scale(struct eng_number *number, int shift)
{
    number->hi = ldexp(number->hi, shift);
    number->lo = ldexp(number->lo, shift);
    number->error = ldexp(number->error, shift);
    return isfinite(number->hi) && isfinite(number->lo) && isfinite(number->error);
}

static enum eng_sign by_pairs(struct eng_numbers *numbers, const struct eng_features *a,
                              const struct eng_features *b)
{
    struct square of_a;
    struct square of_b;
    if (!set_square(numbers, false, a, &of_a) || !set_square(numbers, false, b, &of_b)) {
        return ENG_UNSURE;
    }
    struct eng_number left = eng_number_mul(numbers, of_a.num, of_b.den);
    struct eng_number right = eng_number_mul(numbers, of_b.num, of_a.den);
    int shift = 2 * (of_a.unit - of_b.unit);
    bool is_finite = shift >= 0 ? scale(&left, shift) : scale(&right, -shift);
    return is_finite ? eng_number_sign(numbers, eng_number_sub(numbers, left, right))
                     : ENG_UNSURE;
}

static void keep(struct eng_limbs *limbs, mpz_ptr kept, mpz_srcptr number)
{
    eng_limbs_give(limbs, kept, ENG_NUMBER_BITS);
    mpz_set(kept, number);
}

/* Sign of left - right 2^shift, shift >= 0; neither is negative, *room is for either. */
static int compare_shifted(mpz_srcptr left, mpz_srcptr right, size_t shift, mpz_ptr room)
{
    if (mpz_sgn(left) == 0 || mpz_sgn(right) == 0) {
        return mpz_sgn(left) - mpz_sgn(right);
    }
    size_t left_bits = mpz_sizeinbase(left, 2);
    size_t right_bits = mpz_sizeinbase(right, 2) + shift;
    if (left_bits != right_bits) {
        return left_bits > right_bits ? 1 : -1;
    }
    mpz_mul_2exp(room, right, shift);
    return mpz_cmp(left, room);
}

static enum eng_sign by_integers(struct eng_distance_order *order,
                                 struct eng_numbers *numbers,
                                 const struct eng_features *a,
                                 const struct eng_features *b)
{
    struct eng_limbs limbs = {order->block, 0};
    struct square square;
    mpz_t num[2];
    mpz_t den[2];
    mpz_t product[2];
    mpz_t room;
    int unit[2];
    for (int i = 0; i < 2; i++) {
        bool is_sure = set_square(numbers, true, i == 0 ? a : b, &square);
        assert(is_sure);
        (void)is_sure;
        keep(&limbs, num[i], square.num.z);
        keep(&limbs, den[i], square.den.z);
        unit[i] = square.unit;
    }
    for (int i = 0; i < 2; i++) {
        eng_limbs_give(&limbs, product[i], 2 * ENG_NUMBER_BITS);
        mpz_mul(product[i], num[i], den[1 - i]);
    }
    eng_limbs_give(&limbs, room, 2 * ENG_NUMBER_BITS);
    assert(limbs.count <= limbs_of(LENGTHS));
    int shift = 2 * (unit[1] - unit[0]);
    int sign = shift >= 0
                   ? compare_shifted(product[0], product[1], (size_t)shift, room)
                   : -compare_shifted(product[1], product[0], (size_t)-shift, room);
    return sign < 0 ? ENG_MINUS : sign > 0 ? ENG_PLUS : ENG_ZERO;
}

/* ---- radii ------------------------------------------------------------------------- */

enum eng_sign eng_radii_order(const double a[2], const double b[2])
{
    /* Rounding keeps the order: where the sums are equal their rests tell. */
    double of_a = a[0] + a[1];
    double of_b = b[0] + b[1];
    if (of_a == of_b) {
        of_a = eng_rest_of_difference(a[0], -a[1]);
        of_b = eng_rest_of_difference(b[0], -b[1]);
    }
    return of_a < of_b ? ENG_MINUS : of_a > of_b ? ENG_PLUS : ENG_ZERO;
}

/* num / den 4^unit, or 0, in a unit that is not larger. */
struct kept {
    mpz_t num;
    mpz_t den;
    int unit;
};

static void keep_square(struct eng_limbs *limbs, struct eng_numbers *numbers,
                        const struct eng_features *features, struct kept *kept)
{
    struct square square;
    eng_limbs_give(limbs, kept->num, ENG_NUMBER_BITS);
    eng_limbs_give(limbs, kept->den, ENG_NUMBER_BITS);
    mpz_set_ui(kept->den, 1);
    kept->unit = INT_MAX;
    if (features) {
        bool is_sure = set_square(numbers, true, features, &square);
        assert(is_sure);
        (void)is_sure;
        mpz_set(kept->num, square.num.z);
        mpz_set(kept->den, square.den.z);
        kept->unit = square.unit;
    }
}

/* Sign of sqrt(a) - sqrt(b) - r 2^unit, r > 0; no unit is less than that. */
static enum eng_sign by_squares(struct eng_limbs *limbs, struct kept *a, struct kept *b,
                                mpz_srcptr r, int unit)
{
    mpz_t r2, difference, square, left, right, third;
    eng_limbs_give(limbs, r2, ENG_NUMBER_BITS);
    eng_limbs_give(limbs, difference, 2 * ENG_NUMBER_BITS);
    eng_limbs_give(limbs, square, 4 * ENG_NUMBER_BITS);
    eng_limbs_give(limbs, left, 4 * ENG_NUMBER_BITS);
    eng_limbs_give(limbs, right, 4 * ENG_NUMBER_BITS);
    eng_limbs_give(limbs, third, 3 * ENG_NUMBER_BITS);
    for (int i = 0; i < 2; i++) {
        struct kept *of = i == 0 ? a : b;
        if (mpz_sgn(of->num) != 0) {
            mpz_mul_2exp(of->num, of->num, 2 * (mp_bitcnt_t)(of->unit - unit));
        }
    }
    mpz_mul(r2, r, r);
    /* The difference of sqrt(a) and sqrt(b) + r is of the sign of a - b - r^2 less
     * 2 r sqrt(b). All times den(a) den(b): */
    mpz_mul(left, a->num, b->den);
    mpz_mul(right, b->num, a->den);
    mpz_sub(difference, left, right);
    mpz_mul(left, a->den, b->den);
    mpz_mul(right, left, r2);
    mpz_sub(difference, difference, right);
    if (mpz_sgn(difference) < 0) {
        return ENG_MINUS;
    }
    mpz_mul(square, difference, difference);
    /* .. and squared: 4 r^2 num(b) den(b) den(a)^2. */
    mpz_mul(third, left, a->den);
    mpz_mul(difference, b->num, r2);
    mpz_mul_2exp(difference, difference, 2);
    mpz_mul(right, difference, third);
    int sign = mpz_cmp(square, right);
    return sign < 0 ? ENG_MINUS : sign > 0 ? ENG_PLUS : ENG_ZERO;
}

/* Sign of the distance of a, less that of b unless that is NULL, less the sum of
 * `terms`. */
static enum eng_sign by_radii(struct eng_distance_order *order,
                              struct eng_distances *distances,
                              const struct eng_features *a, const struct eng_features *b,
                              const double terms[4])
{
    struct eng_limbs limbs = {order->block, 0};
    struct kept of_a;
    struct kept of_b;
    mpz_t r;
    mpz_t term;
    keep_square(&limbs, &distances->numbers, a, &of_a);
    keep_square(&limbs, &distances->numbers, b, &of_b);
    int unit = of_a.unit < of_b.unit ? of_a.unit : of_b.unit;
    for (int i = 0; i < 4; i++) {
        unit = eng_lower_exponent(terms[i], unit);
    }
    eng_limbs_give(&limbs, r, ENG_NUMBER_BITS / 2);
    eng_limbs_give(&limbs, term, ENG_NUMBER_BITS / 2);
    for (int i = 0; i < 4; i++) {
        eng_set_scaled(term, terms[i], unit);
        mpz_add(r, r, term);
    }
    int sign = mpz_sgn(r);
    assert(sign != 0);
    mpz_abs(r, r);
    enum eng_sign of = sign > 0 ? by_squares(&limbs, &of_a, &of_b, r, unit)
                                : by_squares(&limbs, &of_b, &of_a, r, unit);
    assert(limbs.count <= limbs_of(LENGTHS));
    return (enum eng_sign)(sign * (int)of);
}

/* ---- all of it --------------------------------------------------------------------- */

enum eng_sign eng_distance_order(struct eng_distance_order *order,
                                 struct eng_distances *distances,
                                 const struct eng_features *a,
                                 const struct eng_features *b)
{
    if (eng_radii_order(a->radius, b->radius) != ENG_ZERO) {
        const double terms[4] = {a->radius[0], a->radius[1], -b->radius[0],
                                 -b->radius[1]};
        return by_radii(order, distances, a, b, terms);
    }
    if (distances->first != ENG_DISTANCE_BY_INTEGERS) {
        enum eng_sign sign = by_pairs(&distances->numbers, a, b);
        if (sign != ENG_UNSURE) {
            return sign;
        }
    }
    return by_integers(order, &distances->numbers, a, b);
}

bool eng_distance_order_within(struct eng_distance_order *order,
                               struct eng_distances *distances,
                               const struct eng_features *features, double d)
{
    const double terms[4] = {features->radius[0], features->radius[1], d, 0};
    return terms[0] == 0 && terms[1] == 0
               ? eng_distance_within(distances, features->kind, features->x, d)
               : by_radii(order, distances, features, NULL, terms) != ENG_PLUS;
}
