/* sine.c - sines and cosines by the first terms of their series. */
#include "sine.h"

#include <stdint.h>

/* Half pi in three parts; multiples of the first two by numbers up to 2^23 are
 * doubles. */
#define QUARTER_HIGH 0x1.921fb54p+0
#define QUARTER_LOW  0x1.10b46118p-30
#define QUARTER_REST 0x1.313198a2e037p-61

#define QUARTERS_OF_ONE 0x1.45f306dc9c883p-1 /* 2 / pi */

/* Added and taken away again, this rounds a number to the nearest whole one. */
#define WHOLE 0x1.8p52

typedef double d2 __attribute__((vector_size(16)));

/* Terms of the sine and of the cosine: from the last to those behind r and 1 - z / 2. */
static const d2 terms[] = {
    {0x1.952c77030ad4ap-49, -0x1.6827863b97d97p-53},
    {-0x1.ae7f3e733b81fp-41, 0x1.ae7f3e733b81fp-45},
    {0x1.6124613a86d09p-33, -0x1.93974a8c07c9dp-37},
    {-0x1.ae64567f544e4p-26, 0x1.1eed8eff8d898p-29},
    {0x1.71de3a556c734p-19, -0x1.27e4fb7789f5cp-22},
    {-0x1.a01a01a01a01ap-13, 0x1.a01a01a01a01ap-16},
    {0x1.1111111111111p-7, -0x1.6c16c16c16c17p-10},
    {-0x1.5555555555555p-3, 0x1.5555555555555p-5},
};

void eng_sine(double hi, double lo, double *sine, double *cosine)
{
    double quarters = (hi * QUARTERS_OF_ONE + WHOLE) - WHOLE;
    double r = ((hi - quarters * QUARTER_HIGH) - quarters * QUARTER_LOW) +
               (lo - quarters * QUARTER_REST);
    double z = r * r;
    d2 sum = terms[0];
    for (int i = 1; i < 8; i++) {
        sum = sum * z + terms[i];
    }
    double s = r + r * (z * sum[0]);
    double c = (1 - 0.5 * z) + (z * z) * sum[1];
    int turn = (int)((int64_t)quarters & 3);
    double a = turn & 1 ? c : s;
    double b = turn & 1 ? s : c;
    *sine = turn & 2 ? -a : a;
    *cosine = turn == 1 || turn == 2 ? -b : b;
}
