/* vec.h - vectors of three doubles: add, subtract, dot, cross. */
#ifndef ENG_VEC_H
#define ENG_VEC_H

#include <math.h>

/* Return a < b ? a : b, without the call that fmin would be. */
static inline double eng_least(double a, double b)
{
    return a < b ? a : b;
}

static inline double eng_most(double a, double b)
{
    return a > b ? a : b;
}

static inline void eng_sub(double out[3], const double a[3], const double b[3])
{
    out[0] = a[0] - b[0];
    out[1] = a[1] - b[1];
    out[2] = a[2] - b[2];
}

static inline double eng_dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline void eng_cross(double out[3], const double a[3], const double b[3])
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

/* Return the largest coordinate magnitude. */
static inline double eng_size(const double a[3])
{
    double x = fabs(a[0]);
    double y = fabs(a[1]);
    double z = fabs(a[2]);
    x = x > y ? x : y;
    return x > z ? x : z;
}

#endif
