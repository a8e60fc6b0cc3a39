/* filter.c - cheap certain rejections, several queries at a time.
 *
 * Room:     engine.
 * Does:     one lane a query, the same operations in every lane: the compiler makes them
 *           vector instructions of whatever width the target has, with the same bits.
 * Threads:  [any].
 * Source:   query.h; the margins are derived in BOUNDS.md.
 */
#include "filter.h"

#include <string.h>

typedef double lanes_t __attribute__((vector_size(ENG_LANES * 8)));
typedef int64_t mask_t __attribute__((vector_size(ENG_LANES * 8)));

/* How a vector wider than the target's registers crosses a call depends on the target;
 * none does, because every helper is inlined, so the warning about it is moot. */
#pragma GCC diagnostic ignored "-Wpsabi"
#define INLINE static inline __attribute__((always_inline))

INLINE lanes_t select_lanes(mask_t mask, lanes_t a, lanes_t b)
{
    return (lanes_t)((mask & (mask_t)a) | (~mask & (mask_t)b));
}

INLINE lanes_t max_lanes(lanes_t a, lanes_t b)
{
    return select_lanes((mask_t)(a > b), a, b);
}

INLINE lanes_t min_lanes(lanes_t a, lanes_t b)
{
    return select_lanes((mask_t)(a < b), a, b);
}

INLINE lanes_t abs_lanes(lanes_t a)
{
    return max_lanes(a, -a);
}

struct vector {
    lanes_t x, y, z;
};

INLINE struct vector load_difference(const struct eng_lanes *lanes, int end, int a, int b)
{
    lanes_t va[3];
    lanes_t vb[3];
    memcpy(va, lanes->x[end][a], sizeof va);
    memcpy(vb, lanes->x[end][b], sizeof vb);
    return (struct vector){va[0] - vb[0], va[1] - vb[1], va[2] - vb[2]};
}

INLINE lanes_t size_of(struct vector v)
{
    return max_lanes(max_lanes(abs_lanes(v.x), abs_lanes(v.y)), abs_lanes(v.z));
}

INLINE struct vector cross(struct vector a, struct vector b)
{
    return (struct vector){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z,
                           a.x * b.y - a.y * b.x};
}

INLINE lanes_t dot(struct vector a, struct vector b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

INLINE struct vector add(struct vector a, struct vector b)
{
    return (struct vector){a.x + b.x, a.y + b.y, a.z + b.z};
}

/* Differences between the points of the two features: VF vertex - corner, EE b - a. If
 * all have one sign along a direction at both ends, that direction separates for the
 * step. */
#define DIFFERENCES_MAX 4

INLINE int load_differences(enum eng_kind kind, const struct eng_lanes *lanes,
                            struct vector d[2][DIFFERENCES_MAX])
{
    for (int end = 0; end < 2; end++) {
        if (kind == ENG_VF) {
            for (int k = 0; k < 3; k++) {
                d[end][k] = load_difference(lanes, end, 0, 1 + k);
            }
        } else {
            for (int k = 0; k < 4; k++) {
                d[end][k] = load_difference(lanes, end, 2 + k / 2, k % 2);
            }
        }
    }
    return kind == ENG_VF ? 3 : 4;
}

/* Separated along x+-y, y+-z or z+-x? Each sum of two rounded differences is within
 * 4 u size of the true one; the margin is 8 u size. */
INLINE mask_t separated(struct vector d[2][DIFFERENCES_MAX], int count)
{
    lanes_t size = size_of(d[0][0]);
#pragma GCC unroll 8
    for (int i = 1; i < 2 * count; i++) {
        size = max_lanes(size, size_of(d[i / count][i % count]));
    }
    lanes_t margin = 8 * ENG_U * size;
    mask_t apart = {0};
#pragma GCC unroll 6
    for (int direction = 0; direction < 6; direction++) {
        lanes_t low = {0};
        lanes_t high = {0};
#pragma GCC unroll 8
        for (int i = 0; i < 2 * count; i++) {
            struct vector v = d[i / count][i % count];
            lanes_t first = direction < 2 ? v.x : direction < 4 ? v.y : v.z;
            lanes_t second = direction < 2 ? v.y : direction < 4 ? v.z : v.x;
            lanes_t s = direction % 2 ? first - second : first + second;
            low = i == 0 ? s : min_lanes(low, s);
            high = i == 0 ? s : max_lanes(high, s);
        }
        apart |= (mask_t)(low > margin) | (mask_t)(high < -margin);
    }
    return apart;
}

/* Bernstein coefficients of det[p, b, c] over the step, the middle ones times three, all
 * beyond their error on one side? */
INLINE mask_t one_sided(enum eng_kind kind, const struct eng_lanes *lanes)
{
    struct vector p[2];
    struct vector b[2];
    struct vector c[2];
    for (int end = 0; end < 2; end++) {
        if (kind == ENG_VF) {
            p[end] = load_difference(lanes, end, 0, 1);
            b[end] = load_difference(lanes, end, 2, 1);
            c[end] = load_difference(lanes, end, 3, 1);
        } else {
            p[end] = load_difference(lanes, end, 2, 0);
            b[end] = load_difference(lanes, end, 1, 0);
            c[end] = load_difference(lanes, end, 2, 3);
        }
    }
    lanes_t size = max_lanes(size_of(p[0]), size_of(p[1])) *
                   max_lanes(size_of(b[0]), size_of(b[1])) *
                   max_lanes(size_of(c[0]), size_of(c[1]));
    lanes_t e = 64 * ENG_U * size + ENG_TINY;
    struct vector n00 = cross(b[0], c[0]);
    struct vector n11 = cross(b[1], c[1]);
    struct vector mixed = add(cross(b[0], c[1]), cross(b[1], c[0]));
    lanes_t f0 = dot(p[0], n00);
    lanes_t f1 = dot(p[1], n00) + dot(p[0], mixed);
    lanes_t f2 = dot(p[0], n11) + dot(p[1], mixed);
    lanes_t f3 = dot(p[1], n11);
    lanes_t low = min_lanes(f0, f3);
    lanes_t high = max_lanes(f0, f3);
    lanes_t low3 = min_lanes(f1, f2);
    lanes_t high3 = max_lanes(f1, f2);
    mask_t above = (mask_t)(low > e) & (mask_t)(low3 > 3 * e);
    mask_t below = (mask_t)(high < -e) & (mask_t)(high3 < -3 * e);
    return above | below;
}

INLINE uint32_t survivors(enum eng_kind kind, const struct eng_lanes *lanes)
{
    struct vector differences[2][DIFFERENCES_MAX];
    int count = load_differences(kind, lanes, differences);
    mask_t rejected = separated(differences, count) | one_sided(kind, lanes);
    uint32_t bits = 0;
    for (unsigned lane = 0; lane < ENG_LANES; lane++) {
        bits |= (rejected[lane] ? 0u : 1u) << lane;
    }
    return bits;
}

uint32_t eng_filter(enum eng_kind kind, const struct eng_lanes *lanes)
{
    /* Two copies, so that the loops over differences have constant bounds in each. */
    return kind == ENG_VF ? survivors(ENG_VF, lanes) : survivors(ENG_EE, lanes);
}
