/* aabb.h - bounding boxes of things that move: one axis-aligned box at the beginning of
 * the step and one at its end.
 *
 * Threads: [any]; inline only.
 *
 * Every record that has boxes begins with the 64 bytes of struct eng_box: four groups of
 * three floats. The fourth word of each group is free for links of the record. A group is
 * one vector of four lanes; lane 3, which holds that word, is compared with the others,
 * and its result is ignored.
 *
 * Why the test is right: every vertex below a node stays above lerp(lo0, lo1) and below
 * lerp(hi0, hi1). This holds at both ends of the step, and all of it is linear in t, so
 * it holds in between. If lo0(a) > hi0(b) and lo1(a) > hi1(b) along one axis, the gap
 * between the two boxes is positive at both ends, and so in between.
 */
#ifndef ENG_AABB_H
#define ENG_AABB_H

#include <assert.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include "box_frame.h"

typedef float eng_f4 __attribute__((vector_size(16), may_alias));
typedef int32_t eng_i4 __attribute__((vector_size(16), may_alias));

struct __attribute__((may_alias)) eng_box { /* also names nodes, edges and vertices */
    _Alignas(64) float lo0[3];              /* at t = 0 */
    uint32_t word0;
    float hi0[3];
    uint32_t word1;
    float lo1[3]; /* at t = 1 */
    uint32_t word2;
    float hi1[3];
    uint32_t word3;
};

static_assert(sizeof(struct eng_box) == 64, "a box is one cache line");

/* Return the largest float <= x + rest, for |x| <= 1e18 and a rest of at most half a unit
 * in the last place of x: the nearest float of x, moved by one unit where it lies on the
 * wrong side. Its distance from x is exact, and more than the rest unless it is 0. */
static inline float eng_round_down_sum(double x, double rest)
{
    float f = (float)x;
    int32_t bits;
    memcpy(&bits, &f, sizeof bits);
    bits += ((double)f - x) - rest > 0 ? (bits < 0 ? 1 : -1) : 0;
    memcpy(&f, &bits, sizeof f);
    return f;
}

/* Return the smallest float >= x + rest, on the same conditions. */
static inline float eng_round_up_sum(double x, double rest)
{
    float f = (float)x;
    int32_t bits;
    memcpy(&bits, &f, sizeof bits);
    bits += ((double)f - x) - rest < 0 ? (bits < 0 ? -1 : 1) : 0;
    memcpy(&f, &bits, sizeof f);
    return f;
}

/* Return the largest float <= x, for |x| <= 1e18. (A zero with the wrong sign cannot
 * occur: the nearest float of a negative x is -0, of a positive x +0.) */
static inline float eng_round_down(double x)
{
    return eng_round_down_sum(x, 0);
}

/* Return the smallest float >= x, on the same condition. */
static inline float eng_round_up(double x)
{
    return eng_round_up_sum(x, 0);
}

/* Write the bounds of a coordinate x in a frame, whose origin for it is number `at`; or,
 * if that is NULL, of x as it is. */
static inline void eng_bounds_of(float *lo, float *hi, double x,
                                 const struct eng_box_frame *frame, int at)
{
    double y = frame ? (x - frame->origin[at]) * frame->scale : x;
    double rest = frame ? eng_rest_of_difference(x, frame->origin[at]) * frame->scale : 0;
    *lo = eng_round_down_sum(y, rest);
    *hi = eng_round_up_sum(y, rest);
}

/* Write the box of one vertex, in a frame or, if that is NULL, as it is. Words are left
 * alone. */
static inline void eng_box_of_point(struct eng_box *box,
                                    const struct eng_box_frame *frame, const double x0[3],
                                    const double x1[3])
{
    for (int k = 0; k < 3; k++) {
        eng_bounds_of(&box->lo0[k], &box->hi0[k], x0[k], frame, k);
        eng_bounds_of(&box->lo1[k], &box->hi1[k], x1[k], frame, 4 + k);
    }
}

static inline eng_f4 eng_min4(eng_f4 a, eng_f4 b)
{
#ifdef __SSE__
    return __builtin_ia32_minps(a, b); /* the same, and one instruction */
#else
    return (eng_f4)(((eng_i4)a & (a < b)) | ((eng_i4)b & ~(a < b)));
#endif
}

static inline eng_f4 eng_max4(eng_f4 a, eng_f4 b)
{
#ifdef __SSE__
    return __builtin_ia32_maxps(a, b);
#else
    return (eng_f4)(((eng_i4)a & (a > b)) | ((eng_i4)b & ~(a > b)));
#endif
}

#define ENG_IS_BOUND ((eng_i4){-1, -1, -1, 0})

/* Return lanes 0 .. 2 of `bounds` and lane 3 of `old`. */
static inline eng_f4 eng_keep_word(eng_f4 old, eng_f4 bounds)
{
    return (eng_f4)(((eng_i4)bounds & ENG_IS_BOUND) | ((eng_i4)old & ~ENG_IS_BOUND));
}

/* Return group `i` of a box, with lane 3 zero. The word in lane 3 would be a denormal
 * float as a rule, and arithmetic on one takes a hundred times as long; comparisons do
 * not mind. */
static inline eng_f4 eng_bounds(const struct eng_box *box, int i)
{
    const eng_i4 *groups = (const eng_i4 *)(const void *)box;
    return (eng_f4)(groups[i] & ENG_IS_BOUND);
}

/* Make `out` the union of a and b; the words of `out` are kept. */
static inline void eng_box_unite(struct eng_box *out, const struct eng_box *a,
                                 const struct eng_box *b)
{
    const eng_f4 *va = (const eng_f4 *)(const void *)a;
    const eng_f4 *vb = (const eng_f4 *)(const void *)b;
    eng_f4 *vo = (eng_f4 *)(void *)out;
    vo[0] = eng_keep_word(vo[0], eng_min4(va[0], vb[0]));
    vo[1] = eng_keep_word(vo[1], eng_max4(va[1], vb[1]));
    vo[2] = eng_keep_word(vo[2], eng_min4(va[2], vb[2]));
    vo[3] = eng_keep_word(vo[3], eng_max4(va[3], vb[3]));
}

/* Return whether a and b can meet at some time of the step. false is certain. */
static inline bool eng_box_overlap(const struct eng_box *a, const struct eng_box *b)
{
    const eng_f4 *va = (const eng_f4 *)(const void *)a;
    const eng_f4 *vb = (const eng_f4 *)(const void *)b;
    eng_i4 apart =
        ((va[0] > vb[1]) & (va[2] > vb[3])) | ((vb[0] > va[1]) & (vb[2] > va[3]));
    return (apart[0] | apart[1] | apart[2]) == 0;
}

/* Return whether a and b are within `growth` of each other along each axis, at an end of
 * the step. false is certain: a gap is off by 2^-24 of itself, and is compared with 2^-21
 * more. */
static inline bool eng_box_is_near(const struct eng_box *a, const struct eng_box *b,
                                   uint32_t end, float growth)
{
    const int low = end == 0 ? 0 : 2;
    eng_f4 up = eng_bounds(a, low) - eng_bounds(b, low + 1);
    eng_f4 down = eng_bounds(b, low) - eng_bounds(a, low + 1);
    eng_i4 apart = eng_max4(up, down) > growth * (1 + 0x1p-21f);
    return (apart[0] | apart[1] | apart[2]) == 0;
}

/* Return whether a and b can meet before or at `t_end`, 0 <= t_end <= 1. false is
 * certain.
 *
 * The gap along an axis is linear: g(t) = (1 - t) g0 + t g1. With g0 > 0 it stays
 * positive up to t_end if g(t_end) > 0. Each computed g0, g1 has a relative error of one
 * rounding u, the products and the sum add three more: the sum is off by less than 8 u
 * (|g0| + |g1|). FLT_MIN covers products below the normal range. */
static inline bool eng_box_overlap_until(const struct eng_box *a, const struct eng_box *b,
                                         float t_end)
{
    const float slack = 0x1p-21f;
    float s_end = 1.0f - t_end;
    eng_i4 apart = {0, 0, 0, 0};
    for (int order = 0; order < 2; order++) {
        eng_f4 g0 = order ? eng_bounds(b, 0) - eng_bounds(a, 1)
                          : eng_bounds(a, 0) - eng_bounds(b, 1);
        eng_f4 g1 = order ? eng_bounds(b, 2) - eng_bounds(a, 3)
                          : eng_bounds(a, 2) - eng_bounds(b, 3);
        eng_f4 size = eng_max4(g0, -g0) + eng_max4(g1, -g1);
        apart |= (g0 > 0.0f) & (s_end * g0 + t_end * g1 > slack * size + 0x1p-126f);
    }
    return (apart[0] | apart[1] | apart[2]) == 0;
}

#endif
