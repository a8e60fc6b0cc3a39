/* sine.h - the sine and cosine of an angle, with a proved bound of their error.
 *
 * They are our own because those of C libraries differ from processor to processor: sums
 * and products of doubles alone, with the same bytes on every machine.
 *
 * Threads: [any], computing to nearest (rounding.h).
 * Source: daemon/engine/elementary/BOUNDS.md, "Sines and cosines".
 */
#ifndef COMMON_SINE_H
#define COMMON_SINE_H

#include <stdint.h>

/* 2^20 turns, rounded down: the largest angle of a joint. */
#define COMMON_ANGLE_MAX 0x1.921fb54442d18p+22

/* Each of the two is within this of the true one. */
#define COMMON_SINE_ERROR 0x1p-52

/* Half pi in three parts; multiples of the first two by numbers up to 2^23 are
 * doubles. */
#define COMMON_QUARTER_HIGH 0x1.921fb54p+0
#define COMMON_QUARTER_LOW  0x1.10b46118p-30
#define COMMON_QUARTER_REST 0x1.313198a2e037p-61

/* Terms of the sine and of the cosine: from the last to those behind r and
 * 1 - r^2 / 2. */
#define COMMON_SINE_TERMS 8
static const double common_sine_terms[COMMON_SINE_TERMS][2] = {
    {1 / 355687428096000.0, -1 / 6402373705728000.0},
    {-1 / 1307674368000.0, 1 / 20922789888000.0},
    {1 / 6227020800.0, -1 / 87178291200.0},
    {-1 / 39916800.0, 1 / 479001600.0},
    {1 / 362880.0, -1 / 3628800.0},
    {-1 / 5040.0, 1 / 40320.0},
    {1 / 120.0, -1 / 720.0},
    {-1 / 6.0, 1 / 24.0},
};

/* Set *sine, *cosine to those of hi + lo, of magnitude at most COMMON_ANGLE_MAX + 1,
 * where hi is the double nearest to that sum. */
static inline void common_sine(double hi, double lo, double *sine, double *cosine)
{
    /* Two sums in one vector: no compiler makes one operation of a product and a sum of
     * those (findings/gcc-fmaddsub.sh). */
    typedef double both __attribute__((vector_size(16)));
    const double whole = 0x1.8p52; /* rounds what is added to it and taken away again */
    double quarters = (hi * 0x1.45f306dc9c883p-1 + whole) - whole;

    /* The angle, less those quarter turns, is r + rest. */
    double rough = hi - quarters * COMMON_QUARTER_HIGH;
    double part = quarters * COMMON_QUARTER_LOW, near = rough - part;
    double low = ((rough - near) - part) + (lo - quarters * COMMON_QUARTER_REST);
    double r = near + low, rest = low - (r - near);

    double square = r * r, half = 0.5 * square, most = 1 - half;
    both sum = {common_sine_terms[0][0], common_sine_terms[0][1]};
    for (int i = 1; i < COMMON_SINE_TERMS; i++) {
        const both term = {common_sine_terms[i][0], common_sine_terms[i][1]};
        sum = sum * square + term;
    }
    sum = sum * (both){r * square, square * square} + rest * (both){most, -r};
    double s = r + sum[0];
    double c = most + (((1 - most) - half) + sum[1]);

    int turn = (int)((int64_t)quarters & 3);
    double a = turn & 1 ? c : s;
    double b = turn & 1 ? s : c;
    *sine = turn & 2 ? -a : a;
    *cosine = turn == 1 || turn == 2 ? -b : b;
}

#endif
