/* separate.c - fixed directions between two features. */
#include "separate.h"

#include "kinds.h"

#ifdef __SSE2__
#include <emmintrin.h>
#endif

#define INLINE static inline __attribute__((always_inline))

typedef double ends __attribute__((vector_size(16)));

#ifdef __SSE2__

INLINE ends least(ends a, ends b)
{
    return (ends)_mm_min_pd((__m128d)a, (__m128d)b);
}

INLINE ends most(ends a, ends b)
{
    return (ends)_mm_max_pd((__m128d)a, (__m128d)b);
}

/* At both ends? 1 or 0: answers are brought together without a branch. */
INLINE unsigned is_less(ends a, ends b)
{
    return _mm_movemask_pd(_mm_cmplt_pd((__m128d)a, (__m128d)b)) == 3;
}

#else

INLINE ends least(ends a, ends b)
{
    return (ends){a[0] < b[0] ? a[0] : b[0], a[1] < b[1] ? a[1] : b[1]};
}

INLINE ends most(ends a, ends b)
{
    return (ends){a[0] > b[0] ? a[0] : b[0], a[1] > b[1] ? a[1] : b[1]};
}

INLINE unsigned is_less(ends a, ends b)
{
    return a[0] < b[0] && a[1] < b[1];
}

#endif

/* One feature's points on a line. */
struct extent {
    ends low, high;
};

INLINE struct extent extent_of(const ends *x, int first, int last)
{
    struct extent extent = {x[first], x[first]};
#pragma GCC unroll 3
    for (int i = first + 1; i < last; i++) {
        extent.low = least(extent.low, x[i]);
        extent.high = most(extent.high, x[i]);
    }
    return extent;
}

/* By comparisons alone. *size: no less than any coordinate of a difference between points
 * of both. */
INLINE bool axis_separates(const ends x[3][4], int split, double *size)
{
    unsigned apart = 0;
    ends far = {0, 0};
#pragma GCC unroll 3
    for (int axis = 0; axis < 3; axis++) {
        struct extent a = extent_of(x[axis], 0, split);
        struct extent b = extent_of(x[axis], split, 4);
        apart |= is_less(b.high, a.low) | is_less(a.high, b.low);
        far = most(far, most(a.high - b.low, b.high - a.low));
    }
    *size = far[0] > far[1] ? far[0] : far[1];
    return apart != 0;
}

/* Is one above the other along x + y or x - y? */
INLINE bool diagonal_separates(const ends x[4], const ends y[4], int split, ends margin)
{
    struct extent sum;
    struct extent rest;
#pragma GCC unroll 2
    for (int a = 0; a < split; a++) {
#pragma GCC unroll 3
        for (int b = split; b < 4; b++) {
            bool is_first = a == 0 && b == split;
            ends dx = x[b] - x[a];
            ends dy = y[b] - y[a];
            ends s = dx + dy;
            ends d = dx - dy;
            sum.low = is_first ? s : least(sum.low, s);
            sum.high = is_first ? s : most(sum.high, s);
            rest.low = is_first ? d : least(rest.low, d);
            rest.high = is_first ? d : most(rest.high, d);
        }
    }
    return (is_less(margin, sum.low) | is_less(margin, rest.low) |
            is_less(sum.high, -margin) | is_less(rest.high, -margin)) != 0;
}

INLINE bool separates(const struct eng_query *query, int split)
{
    ends x[3][4];
    double size;
#pragma GCC unroll 3
    for (int axis = 0; axis < 3; axis++) {
#pragma GCC unroll 4
        for (int i = 0; i < 4; i++) {
            x[axis][i] = (ends){query->x[0][i][axis], query->x[1][i][axis]};
        }
    }
    if (axis_separates((const ends(*)[4])x, split, &size)) {
        return true;
    }
    /* Of what the axes leave more than half ends here, at a fraction of the time of the
     * cubic. */
    const ends margin = 8 * ENG_U * (ends){size, size};
    return diagonal_separates(x[0], x[1], split, margin) ||
           diagonal_separates(x[1], x[2], split, margin) ||
           diagonal_separates(x[2], x[0], split, margin);
}

bool eng_query_separates(const struct eng_query *query)
{
    return common_kinds[query->kind].points[0] == 1 ? separates(query, 1)
                                                    : separates(query, 2);
}
