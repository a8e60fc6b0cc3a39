/* daemon/engine/elementary/distance_order.c - which of two distances is less.
 *
 * Room:     engine.
 * Does:     see distance_order.h. The squares are quotients, which are compared by their
 *           products across: num(a) den(b) with num(b) den(a).
 * Threads:  one thread for one struct eng_distance_order.
 */
#include "distance_order.h"

#include <assert.h>
#include <math.h>

#include "distance_rule.h"
#include "memory.h"

/* Quotients, then products of two, then one of these shifted to the length of the other:
 * nothing is longer than twice the longest number. */
#define LENGTHS (4 + 2 * 2 + 2)

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
    struct eng_way way;
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

enum eng_sign eng_distance_order(struct eng_distance_order *order,
                                 struct eng_distances *distances,
                                 const struct eng_features *a,
                                 const struct eng_features *b)
{
    if (distances->first != ENG_DISTANCE_BY_INTEGERS) {
        enum eng_sign sign = by_pairs(&distances->numbers, a, b);
        if (sign != ENG_UNSURE) {
            return sign;
        }
    }
    return by_integers(order, &distances->numbers, a, b);
}
