/* fuzz_range.h - arithmetic on ranges of numbers, rounded outward.
 *
 * Room:     tests/fuzz. May include: the C library.
 * Does:     sum, difference and product of ranges, in long double.
 * Threads:  [any]; inline only.
 *
 * Each end is computed once, to nearest: it is off by at most 2^-64 of itself (2^-53
 * where a long double is a double), or by less than the least normal number. It is moved
 * outward by twice that. So the result contains every value that the operation has for
 * members of its operands.
 */
#ifndef FUZZ_RANGE_H
#define FUZZ_RANGE_H

#include <float.h>
#include <math.h>
#include <stdbool.h>

struct range {
    long double lo;
    long double hi;
};

static inline struct range range_widened(long double lo, long double hi)
{
    return (struct range){lo - fabsl(lo) * LDBL_EPSILON - LDBL_MIN,
                          hi + fabsl(hi) * LDBL_EPSILON + LDBL_MIN};
}

static inline struct range range_of(double x)
{
    return (struct range){(long double)x, (long double)x};
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
    long double p = a.lo * b.lo;
    long double q = a.lo * b.hi;
    long double r = a.hi * b.lo;
    long double s = a.hi * b.hi;
    long double lo0 = p < q ? p : q;
    long double lo1 = r < s ? r : s;
    long double hi0 = p > q ? p : q;
    long double hi1 = r > s ? r : s;
    return range_widened(lo0 < lo1 ? lo0 : lo1, hi0 > hi1 ? hi0 : hi1);
}

static inline struct range range_unite(struct range a, struct range b)
{
    return (struct range){a.lo < b.lo ? a.lo : b.lo, a.hi > b.hi ? a.hi : b.hi};
}

/* Of every member: 1, -1, or 0 if they differ or are not known. */
static inline int range_sign(struct range a)
{
    return a.lo > 0 ? 1 : a.hi < 0 ? -1 : 0;
}

#endif
