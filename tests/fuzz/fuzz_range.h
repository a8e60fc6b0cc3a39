/* fuzz_range.h - interval arithmetic: sums and products of ranges of numbers, rounded
 * outward.
 *
 * Each end is computed once, to nearest: it is off by at most half an epsilon of itself,
 * or by less than the least normal number. It is moved outward by twice that, and by more
 * than the other. So the result contains every value that the operation has for members
 * of its operands.
 */
#ifndef FUZZ_RANGE_H
#define FUZZ_RANGE_H

#include <float.h>
#include <math.h>
#include <stdbool.h>

#ifndef FUZZ_REAL
#define FUZZ_REAL    double
#define FUZZ_EPSILON DBL_EPSILON
#endif

/* Products of four of it are normal numbers still: others take a hundred times as
 * long. */
#define RANGE_LEAST 0x1p-250

struct range {
    FUZZ_REAL lo;
    FUZZ_REAL hi;
};

static inline FUZZ_REAL range_least(FUZZ_REAL a, FUZZ_REAL b)
{
    return a < b ? a : b;
}

static inline FUZZ_REAL range_most(FUZZ_REAL a, FUZZ_REAL b)
{
    return a > b ? a : b;
}

static inline FUZZ_REAL range_size(FUZZ_REAL a)
{
    return range_most(a, -a);
}

static inline struct range range_widened(FUZZ_REAL lo, FUZZ_REAL hi)
{
    return (struct range){lo - (range_size(lo) * FUZZ_EPSILON + RANGE_LEAST),
                          hi + (range_size(hi) * FUZZ_EPSILON + RANGE_LEAST)};
}

static inline struct range range_of(double x)
{
    return (struct range){(FUZZ_REAL)x, (FUZZ_REAL)x};
}

static inline struct range range_add(struct range a, struct range b)
{
    return range_widened(a.lo + b.lo, a.hi + b.hi);
}

static inline struct range range_sub(struct range a, struct range b)
{
    return range_widened(a.lo - b.hi, a.hi - b.lo);
}

static inline struct range range_mul(struct range a, struct range b)
{
    FUZZ_REAL p = a.lo * b.lo;
    FUZZ_REAL q = a.lo * b.hi;
    FUZZ_REAL r = a.hi * b.lo;
    FUZZ_REAL s = a.hi * b.hi;
    return range_widened(range_least(range_least(p, q), range_least(r, s)),
                         range_most(range_most(p, q), range_most(r, s)));
}

static inline struct range range_unite(struct range a, struct range b)
{
    return (struct range){range_least(a.lo, b.lo), range_most(a.hi, b.hi)};
}

/* Return the sign of every member: 1, -1, or 0 if they differ or are not known. */
static inline int range_sign(struct range a)
{
    return a.lo > 0 ? 1 : a.hi < 0 ? -1 : 0;
}

#endif
