/* sift.h - what sieves compute with: floats made of marks, a pair to each lane.
 *
 * Threads: [any]; inline only. Included by files of this folder alone.
 */
#ifndef ENG_SIFT_H
#define ENG_SIFT_H

#include "marks.h"

#define U24   0x1p-24f /* of floats, what u is of doubles */
#define SLACK (1 + 32 * U24)

struct vector {
    eng_f x, y, z;
};

ENG_INLINE struct vector cross(struct vector a, struct vector b)
{
    return (struct vector){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z,
                           a.x * b.y - a.y * b.x};
}

ENG_INLINE struct vector add(struct vector a, struct vector b)
{
    return (struct vector){a.x + b.x, a.y + b.y, a.z + b.z};
}

ENG_INLINE struct vector minus(struct vector a, struct vector b)
{
    return (struct vector){a.x - b.x, a.y - b.y, a.z - b.z};
}

ENG_INLINE eng_f dot(struct vector a, struct vector b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

/* More than the largest coordinate of two, on the grid and off it. */
ENG_INLINE eng_f reach(struct vector a, struct vector b)
{
    eng_f x = eng_f_max_abs(a.x, b.x);
    eng_f y = eng_f_max_abs(a.y, b.y);
    eng_f z = eng_f_max_abs(a.z, b.z);
    return eng_f_max_abs(eng_f_max_abs(x, y), z) + 2;
}

ENG_INLINE eng_f rounded(eng_fi v)
{
    return __builtin_convertvector(v, eng_f);
}

ENG_INLINE struct vector vector_of(struct eng_g g)
{
    return (struct vector){rounded(g.x), rounded(g.y), rounded(g.z)};
}

ENG_INLINE eng_fi coordinate(struct eng_g g, int axis)
{
    return axis % 3 == 0 ? g.x : axis % 3 == 1 ? g.y : g.z;
}

/* By how much b lies above a and a above b, of marks 1, 2, 3 minus mark 0 along a
 * direction; negative where they overlap. */
ENG_INLINE void gaps_of(enum pccd_kind kind, const eng_fi d[3], eng_fi gaps[2])
{
    const eng_fi zero = {0};
    eng_fi low = eng_fi_min(d[1], d[2]);
    eng_fi high = eng_fi_max(d[1], d[2]);
    if (kind == PCCD_VF) {
        gaps[0] = eng_fi_min(d[0], low);
        gaps[1] = -eng_fi_max(d[0], high);
    } else {
        gaps[0] = low - eng_fi_max(d[0], zero);
        gaps[1] = eng_fi_min(d[0], zero) - high;
    }
}

/* Times as fractions n / d: when the pair can touch first and last. Both terms of
 * `from` are >= 0, both of `to` <= 0. */
struct span {
    eng_f from_n, from_d;
    eng_f to_n, to_d;
};

/* Gaps along an axis at t = 0 and at t = 1: cut() of filter.c, for both orders at once,
 * as only one of them can have a gap at an end. With gaps at both ends `from` is 1 and
 * `to` is 0. */
ENG_INLINE void cut(struct span *span, const eng_f gaps0[2], const eng_f gaps1[2])
{
    const eng_f zero = {0};
    eng_fm above = eng_f_less(zero, gaps0[0]);
    eng_f n = eng_f_max(eng_f_max(gaps0[0], gaps0[1]), zero);
    eng_f d = n - eng_f_min(eng_f_select(above, gaps1[0], gaps1[1]), zero);
    eng_fm later = eng_f_less(span->from_n * d, n * span->from_d);
    span->from_n = eng_f_select(later, n, span->from_n);
    span->from_d = eng_f_select(later, d, span->from_d);
    above = eng_f_less(zero, gaps1[0]);
    n = eng_f_min(eng_f_select(above, gaps0[0], gaps0[1]), zero);
    d = n - eng_f_max(eng_f_max(gaps1[0], gaps1[1]), zero);
    eng_fm sooner = eng_f_less(n * span->to_d, span->to_n * d);
    span->to_n = eng_f_select(sooner, n, span->to_n);
    span->to_d = eng_f_select(sooner, d, span->to_d);
}

/* A group that is short of pairs repeats its first. */
ENG_INLINE void fill(const uint32_t *a, const uint32_t *b, uint32_t n,
                     uint32_t full[2][ENG_F_LANES])
{
    for (uint32_t lane = 0; lane < ENG_F_LANES; lane++) {
        full[0][lane] = a[lane < n ? lane : 0];
        full[1][lane] = b[lane < n ? lane : 0];
    }
}

/* Differences of the pairs a[n], b[n]. */
ENG_INLINE void load(enum pccd_kind kind, const struct eng_sieve *sieve,
                     const uint32_t *a, const uint32_t *b, uint32_t n,
                     struct eng_g d[2][3])
{
    if (n == ENG_F_LANES) {
        eng_marks_load(kind, sieve, a, b, d);
        return;
    }
    uint32_t full[2][ENG_F_LANES];
    fill(a, b, n, full);
    eng_marks_load(kind, sieve, full[0], full[1], d);
}

#endif
