/* number.c - numbers by pairs of doubles or by integers. */
#include "number.h"

#include <assert.h>
#include <limits.h>
#include <math.h>
#include <string.h>

#include "memory.h"
#include "pccd_types.h"
#include "two.h"

/* More than what a product, or an error, loses below the normal range. */
#define LOST 0x1p-1040

/* Products from here on are exact as a pair. */
#define PRODUCT_MIN 0x1p-960

/* Makes up for the rounding of the errors themselves. */
#define SLOP (1 + 0x1p-40)

/* Rounding of one operation, with room for the terms that are left out. */
#define ROUNDED 0x1.01p-53

#define FIXED_BITS  32
#define LENGTH_BITS 33
#define TRIES       4

static size_t limbs_of_all(void)
{
    return ENG_NUMBER_COUNT * (ENG_NUMBER_BITS / GMP_NUMB_BITS + 9);
}

size_t eng_numbers_bytes(void)
{
    return limbs_of_all() * sizeof(mp_limb_t);
}

int eng_numbers_init(struct eng_numbers *numbers)
{
    mp_limb_t *block = eng_alloc(limbs_of_all(), sizeof *block);
    if (block == NULL) {
        return PCCD_E_NOMEM;
    }
    memset(numbers, 0, sizeof *numbers);
    numbers->block = block;
    return PCCD_OK;
}

void eng_numbers_deinit(struct eng_numbers *numbers)
{
    eng_free(numbers->block);
    numbers->block = NULL;
}

/* Room for one more integer below 2^bits. */
static mpz_ptr some_integer(struct eng_numbers *numbers, size_t bits)
{
    assert(numbers->used < ENG_NUMBER_COUNT && bits <= ENG_NUMBER_BITS);
    mpz_ptr z = &numbers->z[numbers->used++];
    eng_limbs_give(&numbers->limbs, z, bits);
    return z;
}

static size_t bits_of(mpz_srcptr z)
{
    return mpz_size(z) * GMP_NUMB_BITS;
}

static void load_integers(struct eng_numbers *numbers, int point_count)
{
    int low = INT_MAX;
    for (int i = 0; i < 3 * point_count; i++) {
        low = eng_lower_exponent(numbers->x[i / 3][i % 3], low);
    }
    numbers->unit = low == INT_MAX ? 0 : low;
    for (int i = 0; i < 3 * point_count; i++) {
        double value = numbers->x[i / 3][i % 3];
        int exponent;
        frexp(value, &exponent);
        mpz_ptr z =
            some_integer(numbers, value == 0 ? 1 : (size_t)(exponent - numbers->unit));
        eng_set_scaled(z, value, numbers->unit);
        numbers->points[i / 3][i % 3] = z;
    }
}

/* A power of two that makes the largest difference at least 1/2, if it is less. */
static int unit_of(const double (*x)[3], int point_count)
{
    double size = 0;
    for (int i = 3; i < 3 * point_count; i++) {
        size = fmax(size, fabs(x[i / 3][i % 3] - x[0][i % 3]));
    }
    int exponent;
    frexp(size, &exponent);
    return exponent < 0 ? exponent : 0;
}

void eng_numbers_load(struct eng_numbers *numbers, bool is_exact, const double (*x)[3],
                      int point_count)
{
    assert(point_count <= ENG_NUMBER_POINTS);
    numbers->is_exact = is_exact;
    numbers->is_unsure = false;
    numbers->x = x;
    numbers->used = 0;
    numbers->limbs = (struct eng_limbs){numbers->block, 0};
    if (is_exact) {
        load_integers(numbers, point_count);
    } else {
        numbers->unit = unit_of(x, point_count);
    }
}

struct eng_vector eng_number_between(struct eng_numbers *numbers, int i, int j)
{
    struct eng_vector out;
    memset(&out, 0, sizeof out);
    for (int k = 0; k < 3; k++) {
        if (numbers->is_exact) {
            mpz_srcptr a = numbers->points[i][k];
            mpz_srcptr b = numbers->points[j][k];
            size_t bits = bits_of(mpz_size(a) > mpz_size(b) ? a : b) + 1;
            out.c[k].z = some_integer(numbers, bits);
            mpz_sub(out.c[k].z, a, b);
        } else {
            out.c[k].hi = eng_two_sum(numbers->x[i][k], -numbers->x[j][k], &out.c[k].lo);
            if (numbers->unit < 0) {
                out.c[k].hi = ldexp(out.c[k].hi, -numbers->unit);
                out.c[k].lo = ldexp(out.c[k].lo, -numbers->unit);
            }
        }
    }
    return out;
}

struct eng_number eng_number_one(struct eng_numbers *numbers)
{
    struct eng_number out = {1, 0, 0, NULL};
    if (numbers->is_exact) {
        out.z = some_integer(numbers, 1);
        mpz_set_ui(out.z, 1);
    }
    return out;
}

static struct eng_number add_pairs(struct eng_number a, struct eng_number b)
{
    struct eng_number out = {0, 0, a.error + b.error, NULL};
    double rest;
    double sum = eng_two_sum(a.hi, b.hi, &rest);
    if (a.lo != 0 || b.lo != 0) {
        double low = a.lo + b.lo;
        double tail = rest + low;
        out.error += ROUNDED * (fabs(low) + fabs(tail)) + LOST;
        rest = tail;
    }
    out.hi = eng_two_sum(sum, rest, &out.lo);
    out.error *= SLOP;
    return out;
}

struct eng_number eng_number_add(struct eng_numbers *numbers, struct eng_number a,
                                 struct eng_number b)
{
    if (!numbers->is_exact) {
        return add_pairs(a, b);
    }
    struct eng_number out = {0};
    out.z = some_integer(numbers, bits_of(mpz_size(a.z) > mpz_size(b.z) ? a.z : b.z) + 1);
    mpz_add(out.z, a.z, b.z);
    return out;
}

struct eng_number eng_number_sub(struct eng_numbers *numbers, struct eng_number a,
                                 struct eng_number b)
{
    if (!numbers->is_exact) {
        b.hi = -b.hi;
        b.lo = -b.lo;
        return add_pairs(a, b);
    }
    struct eng_number out = {0};
    out.z = some_integer(numbers, bits_of(mpz_size(a.z) > mpz_size(b.z) ? a.z : b.z) + 1);
    mpz_sub(out.z, a.z, b.z);
    return out;
}

static struct eng_number mul_pairs(struct eng_number a, struct eng_number b)
{
    struct eng_number out = {0};
    if ((a.hi == 0 && a.error == 0) || (b.hi == 0 && b.error == 0)) {
        return out; /* hi is 0 only where lo is */
    }
    double rest;
    double product = eng_two_product(a.hi, b.hi, &rest);
    out.error = fabs(a.hi) * b.error + fabs(b.hi) * a.error + a.error * b.error;
    if (fabs(product) < PRODUCT_MIN || a.error != 0 || b.error != 0) {
        out.error += LOST; /* an error is 0 or at least that: it never becomes 0 */
    }
    if (a.lo != 0 || b.lo != 0) {
        double one = a.hi * b.lo;
        double other = a.lo * b.hi;
        double low = one + other;
        double tail = rest + low;
        out.error += ROUNDED * (fabs(one) + fabs(other) + fabs(low) + fabs(tail)) +
                     fabs(a.lo * b.lo) + LOST;
        rest = tail;
    }
    out.hi = eng_two_sum(product, rest, &out.lo);
    out.error *= SLOP;
    return out;
}

struct eng_number eng_number_mul(struct eng_numbers *numbers, struct eng_number a,
                                 struct eng_number b)
{
    if (!numbers->is_exact) {
        return mul_pairs(a, b);
    }
    struct eng_number out = {0};
    out.z = some_integer(numbers, bits_of(a.z) + bits_of(b.z));
    mpz_mul(out.z, a.z, b.z);
    return out;
}

struct eng_number eng_number_dot(struct eng_numbers *numbers, const struct eng_vector *a,
                                 const struct eng_vector *b)
{
    struct eng_number sum = eng_number_mul(numbers, a->c[0], b->c[0]);
    for (int k = 1; k < 3; k++) {
        struct eng_number part = eng_number_mul(numbers, a->c[k], b->c[k]);
        sum = eng_number_add(numbers, sum, part);
    }
    return sum;
}

struct eng_vector eng_number_cross(struct eng_numbers *numbers,
                                   const struct eng_vector *a, const struct eng_vector *b)
{
    struct eng_vector out;
    for (int k = 0; k < 3; k++) {
        int i = (k + 1) % 3;
        int j = (k + 2) % 3;
        struct eng_number left = eng_number_mul(numbers, a->c[i], b->c[j]);
        struct eng_number right = eng_number_mul(numbers, a->c[j], b->c[i]);
        out.c[k] = eng_number_sub(numbers, left, right);
    }
    return out;
}

enum eng_sign eng_number_sign(const struct eng_numbers *numbers, struct eng_number a)
{
    if (numbers->is_exact) {
        return (enum eng_sign)mpz_sgn(a.z);
    }
    if (a.hi == 0 && a.error == 0) {
        return ENG_ZERO;
    }
    return fabs(a.hi) > a.error * SLOP ? (a.hi > 0 ? ENG_PLUS : ENG_MINUS) : ENG_UNSURE;
}

/* h without rounding; h = *mantissa 2^(what is returned). */
static long take_apart(struct eng_numbers *numbers, double h, mpz_ptr *mantissa)
{
    int exponent;
    double fraction = frexp(h, &exponent);
    *mantissa = some_integer(numbers, 54);
    mpz_set_d(*mantissa, ldexp(fraction, 53));
    return exponent - 53;
}

/* Sign of left - right 2^shift; neither is negative. */
static enum eng_sign compare_shifted(struct eng_numbers *numbers, mpz_srcptr left,
                                     mpz_srcptr right, long shift)
{
    if (mpz_sgn(left) == 0 || mpz_sgn(right) == 0) {
        return (enum eng_sign)(mpz_sgn(left) - mpz_sgn(right));
    }
    long more = (long)mpz_sizeinbase(left, 2) - (long)mpz_sizeinbase(right, 2) - shift;
    if (more != 0) {
        return more > 0 ? ENG_PLUS : ENG_MINUS;
    }
    /* Both are equally long, so the shorter is shifted to no more than the longer. */
    mpz_srcptr shifted = shift < 0 ? left : right;
    unsigned long by = (unsigned long)(shift < 0 ? -shift : shift);
    mpz_ptr out = some_integer(numbers, bits_of(shifted) + by);
    mpz_mul_2exp(out, shifted, by);
    int sign = shift < 0 ? mpz_cmp(out, right) : mpz_cmp(left, out);
    return sign < 0 ? ENG_MINUS : sign > 0 ? ENG_PLUS : ENG_ZERO;
}

/* Sign of num - h^2 den 4^-unit. */
static enum eng_sign compare_square(struct eng_numbers *numbers, struct eng_number num,
                                    struct eng_number den, double h, int unit)
{
    enum eng_sign sign;
    struct eng_number_mark mark = eng_numbers_mark(numbers);
    if (numbers->is_exact) {
        mpz_ptr mantissa;
        long exponent = take_apart(numbers, h, &mantissa);
        struct eng_number one = {0, 0, 0, mantissa};
        struct eng_number square = eng_number_mul(numbers, one, one);
        struct eng_number right = eng_number_mul(numbers, square, den);
        sign = compare_shifted(numbers, num.z, right.z, 2 * (exponent - unit));
    } else {
        struct eng_number one = {unit == 0 ? h : ldexp(h, -unit), 0, 0, NULL};
        struct eng_number right = mul_pairs(mul_pairs(one, one), den);
        sign = eng_number_sign(numbers, eng_number_sub(numbers, num, right));
    }
    eng_numbers_forget(numbers, mark);
    return sign;
}

enum eng_sign eng_number_compare(struct eng_numbers *numbers, struct eng_number num,
                                 struct eng_number den, double h)
{
    return compare_square(numbers, num, den, h, numbers->unit);
}

/* Sign of num - h den. */
static enum eng_sign compare_ratio(struct eng_numbers *numbers, struct eng_number num,
                                   struct eng_number den, double h)
{
    if (!numbers->is_exact) {
        struct eng_number one = {h, 0, 0, NULL};
        return eng_number_sign(numbers,
                               eng_number_sub(numbers, num, mul_pairs(one, den)));
    }
    struct eng_number_mark mark = eng_numbers_mark(numbers);
    int side = (h > 0) - (h < 0);
    enum eng_sign sign = (enum eng_sign)mpz_sgn(num.z);
    if (sign == side && side != 0) {
        mpz_ptr mantissa;
        long exponent = take_apart(numbers, fabs(h), &mantissa);
        struct eng_number one = {0, 0, 0, mantissa};
        mpz_ptr left = some_integer(numbers, bits_of(num.z));
        mpz_abs(left, num.z);
        struct eng_number right = eng_number_mul(numbers, one, den);
        sign = (enum eng_sign)(side *
                               (int)compare_shifted(numbers, left, right.z, exponent));
    } else if (side != 0) {
        sign = (enum eng_sign) - side;
    }
    eng_numbers_forget(numbers, mark);
    return sign;
}

/* About a = *fraction 2^(what is returned). */
static long leading(const struct eng_numbers *numbers, struct eng_number a,
                    double *fraction)
{
    long exponent = 0;
    int small = 0;
    if (numbers->is_exact) {
        *fraction = mpz_get_d_2exp(&exponent, a.z);
        return exponent;
    }
    *fraction = frexp(a.hi, &small);
    return small;
}

static double about(const struct eng_numbers *numbers, struct eng_number num,
                    struct eng_number den, bool wants_root, int unit)
{
    double above;
    double below;
    long exponent = leading(numbers, num, &above);
    exponent -= leading(numbers, den, &below);
    double value = above / below;
    if (wants_root) {
        if (exponent % 2 != 0) {
            value *= 2;
            exponent--;
        }
        exponent /= 2;
        value = value > 0 ? sqrt(value) : 0;
    }
    exponent += unit;
    if (!isfinite(value) || exponent > 1000) {
        return 0; /* of pairs that know nothing: the comparison will say so */
    }
    return ldexp(value, exponent < -5000 ? -5000 : (int)exponent);
}

typedef enum eng_sign (*compare_fn)(struct eng_numbers *numbers, struct eng_number num,
                                    struct eng_number den, double h);

/* The whole number nearest to value 2^FIXED_BITS, times 2^-FIXED_BITS, beginning with a
 * guess. `compare` tells the sign of the value less a number. */
static double nearest(struct eng_numbers *numbers, struct eng_number num,
                      struct eng_number den, double guess, compare_fn compare)
{
    double q = rint(ldexp(guess, FIXED_BITS));
    for (int i = 0; i < TRIES; i++) {
        enum eng_sign below =
            compare(numbers, num, den, ldexp(2 * q - 1, -FIXED_BITS - 1));
        enum eng_sign above =
            compare(numbers, num, den, ldexp(2 * q + 1, -FIXED_BITS - 1));
        if (below == ENG_UNSURE || above == ENG_UNSURE) {
            break;
        }
        bool is_odd = fmod(q, 2) != 0;
        if (below == ENG_MINUS || (below == ENG_ZERO && is_odd)) {
            q--;
        } else if (above == ENG_PLUS || (above == ENG_ZERO && is_odd)) {
            q++;
        } else {
            return ldexp(q, -FIXED_BITS) + 0.0; /* no zero has a sign */
        }
    }
    assert(!numbers->is_exact);
    numbers->is_unsure = true;
    return 0;
}

double eng_number_ratio(struct eng_numbers *numbers, struct eng_number num,
                        struct eng_number den)
{
    return nearest(numbers, num, den, about(numbers, num, den, false, 0), compare_ratio);
}

static enum eng_sign compare_cosine(struct eng_numbers *numbers, struct eng_number square,
                                    struct eng_number gg, double h)
{
    return h < 0 ? ENG_PLUS : compare_square(numbers, square, gg, h, 0);
}

double eng_number_cosine(struct eng_numbers *numbers, struct eng_number g,
                         struct eng_number gg)
{
    struct eng_number_mark mark = eng_numbers_mark(numbers);
    struct eng_number square = eng_number_mul(numbers, g, g);
    double value =
        nearest(numbers, square, gg, about(numbers, square, gg, true, 0), compare_cosine);
    enum eng_sign sign = eng_number_sign(numbers, g);
    if (value != 0 && sign == ENG_UNSURE) {
        numbers->is_unsure = true;
    }
    eng_numbers_forget(numbers, mark);
    return sign == ENG_MINUS && value != 0 ? -value : value;
}

/* The distance of doubles of LENGTH_BITS bits from x up to the next power of two. */
static double step_at(double x)
{
    int exponent;
    frexp(x, &exponent);
    return ldexp(1, x == 0 || exponent - LENGTH_BITS < -1074 ? -1074
                                                             : exponent - LENGTH_BITS);
}

static double cut_off(double x)
{
    double step = step_at(x);
    return floor(x / step) * step;
}

void eng_number_length(struct eng_numbers *numbers, struct eng_number num,
                       struct eng_number den, double *lo, double *hi)
{
    double low = cut_off(about(numbers, num, den, true, numbers->unit));
    for (int i = 0; i < TRIES; i++) {
        double high = low + step_at(low);
        enum eng_sign at_low = eng_number_compare(numbers, num, den, low);
        if (at_low == ENG_ZERO) {
            *lo = *hi = low;
            return;
        }
        enum eng_sign at_high = eng_number_compare(numbers, num, den, high);
        if (at_low == ENG_UNSURE || at_high == ENG_UNSURE) {
            break;
        }
        if (at_low == ENG_PLUS && at_high == ENG_MINUS) {
            *lo = low;
            *hi = high;
            return;
        }
        low = at_low == ENG_MINUS ? cut_off(nextafter(low, 0)) : high;
    }
    assert(!numbers->is_exact);
    numbers->is_unsure = true;
    *lo = *hi = 0;
}
