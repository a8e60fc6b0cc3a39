/* reject.h - what certainly keeps the two features of a pair apart, over the step or at
 * one end of it, a pair to each lane.
 *
 * A template for two kinds of numbers. Doubles: reject.c, and decide.c with
 * one lane. Marks, in files that define ENG_IN_FLOATS: sift.c and sift_near.c; what lies
 * between two features is a whole number there, and exact, and products of three are
 * floats. A *reach* is how far features have to stay apart; 0: they must not meet.
 *
 * Each test is asked of three or four differences between points of a pair; whether there
 * is a reach, and which end is meant, are constants of the code where it is called.
 *
 * Threads: [any]; inline only. Included by files of this folder alone.
 * Source: BOUNDS.md derives each margin.
 */
#ifndef ENG_REJECT_H
#define ENG_REJECT_H

#include "lanes.h"
#include "query.h"
#ifdef ENG_IN_FLOATS
#include "marks.h"
#endif

/* Factors that make up for what the products of a comparison round off. */
#define ENG_SLACK (1 + 32 * ENG_N_U)

#ifdef ENG_IN_FLOATS

/* Marks 1, 2, 3 of a pair less mark 0: VF the corners less the vertex, EE a1, b0 and b1
 * less a0. */
#define DIFFERENCES 3
typedef eng_fi gap_t;
typedef struct eng_g difference_t;

#define gap_min eng_fi_min
#define gap_max eng_fi_max

/* A gap on the grid, less so many cells, is less than the true one: along an axis, and
 * along a diagonal, where it is half as wide. */
#define CELLS_AXIS     2
#define CELLS_DIAGONAL 3
/* The length of a diagonal in these gaps, or more: 1 / sqrt(2). */
#define DIAGONAL 0x1.6a09e8p-1f
/* A coordinate of a difference is off by less. */
#define OFF_GRID 2
/* Nothing falls below the normal range. */
#define LOST_TIME   0
#define LOST_SQUARE 0

ENG_INLINE eng_f number_of(gap_t v)
{
    return __builtin_convertvector(v, eng_f);
}

ENG_INLINE struct eng_v vector_of(difference_t v)
{
    return (struct eng_v){number_of(v.x), number_of(v.y), number_of(v.z)};
}

/* Return half of v, rounded down, so that sums of two fit. */
ENG_INLINE gap_t half_of(gap_t v)
{
    return v >> 1;
}

#else

/* Points of b less points of a: VF the corners less the vertex, EE b0 - a0, b1 - a0,
 * b0 - a1, b1 - a1. */
#define DIFFERENCES 4
typedef eng_d gap_t;
typedef struct eng_v difference_t;

#define gap_min        eng_d_min
#define gap_max        eng_d_max
#define CELLS_AXIS     0
#define CELLS_DIAGONAL 0
#define DIAGONAL       0x1.6a09e667f3bcdp0 /* more than sqrt(2) */
#define LOST_TIME      ENG_TINY
#define LOST_SQUARE    0x1p-900

ENG_INLINE eng_d number_of(gap_t v)
{
    return v;
}

ENG_INLINE struct eng_v vector_of(difference_t v)
{
    return v;
}

ENG_INLINE gap_t half_of(gap_t v)
{
    return v; /* sums fit as they are */
}

#endif

ENG_INLINE int differences_of(enum pccd_kind kind)
{
    return kind == PCCD_VF ? 3 : DIFFERENCES;
}

#ifndef ENG_IN_FLOATS

/* Subtract points of the pairs at one end. With a vertex first, all kinds are of a vertex
 * and a face: points are repeated. */
ENG_INLINE void subtract(enum pccd_kind kind, const struct eng_v x[4],
                         struct eng_v d[DIFFERENCES])
{
#pragma GCC unroll 4
    for (int k = 0; k < differences_of(kind); k++) {
        d[k] = kind == PCCD_VF ? eng_v_sub(x[1 + k], x[0])
                               : eng_v_sub(x[2 + k % 2], x[k / 2]);
    }
}

#endif

/* ---- along fixed directions -------------------------------------------------------- */

#define AXES       3
#define DIRECTIONS 9

/* Return v along one of the directions x, y, z; x + y, x - y, y + z, y - z, z + x, z - x,
 * the diagonal ones by half_of. */
ENG_INLINE gap_t along(difference_t v, int direction)
{
    if (direction < AXES) {
        return direction == 0 ? v.x : direction == 1 ? v.y : v.z;
    }
    int plane = (direction - AXES) / 2;
    gap_t first = half_of(plane == 0 ? v.x : plane == 1 ? v.y : v.z);
    gap_t second = half_of(plane == 0 ? v.y : plane == 1 ? v.z : v.x);
    return direction % 2 ? first + second : first - second;
}

/* Set `gaps` to by how much b lies above a and a above b, of the differences along a
 * direction; negative where they overlap. */
ENG_INLINE void gaps_of(enum pccd_kind kind, const gap_t s[DIFFERENCES], gap_t gaps[2])
{
    const gap_t zero = {0};
    gap_t low = gap_min(s[1], s[2]);
    gap_t high = gap_max(s[1], s[2]);
    if (kind == PCCD_EE && DIFFERENCES == 3) {
        gaps[0] = low - gap_max(s[0], zero);
        gaps[1] = gap_min(s[0], zero) - high;
        return;
    }
    low = gap_min(s[0], low);
    high = gap_max(s[0], high);
    if (kind == PCCD_EE) {
        low = gap_min(low, s[DIFFERENCES - 1]);
        high = gap_max(high, s[DIFFERENCES - 1]);
    }
    gaps[0] = low;
    gaps[1] = -high;
}

/* Set `gaps` in this way from the differences at one end. */
ENG_INLINE void gaps_along(enum pccd_kind kind, const difference_t *d, int direction,
                           gap_t gaps[2])
{
    gap_t s[DIFFERENCES];
#pragma GCC unroll 4
    for (int k = 0; k < differences_of(kind); k++) {
        s[k] = along(d[k], direction);
    }
    gaps_of(kind, s, gaps);
}

/* Return the lanes in which one of these directions keeps all points of one feature more
 * than `least` beyond all of the other, at both ends and so all the time. Diagonals are
 * longer than axes: `least` is DIAGONAL times as much for them. */
ENG_INLINE uint32_t are_beyond(enum pccd_kind kind, const difference_t d[2][DIFFERENCES],
                               int first, int last, eng_n least)
{
    gap_t widest = {0};
#pragma GCC unroll 6
    for (int direction = first; direction < last; direction++) {
        gap_t gaps[2][2];
        gaps_along(kind, d[0], direction, gaps[0]);
        gaps_along(kind, d[1], direction, gaps[1]);
        widest = gap_max(widest, gap_min(gaps[0][0], gaps[1][0]));
        widest = gap_max(widest, gap_min(gaps[0][1], gaps[1][1]));
    }
    widest = widest - (first < AXES ? CELLS_AXIS : CELLS_DIAGONAL);
    return eng_nm_bits(eng_n_less(least, number_of(widest)));
}

#ifndef ENG_IN_FLOATS

/* Return the largest coordinate of all differences. */
ENG_INLINE eng_d size_of_all(enum pccd_kind kind, const struct eng_v d[2][DIFFERENCES])
{
    eng_d size = eng_v_size_of_two(d[0][0], d[1][0]);
#pragma GCC unroll 3
    for (int k = 1; k < differences_of(kind); k++) {
        size = eng_d_max(size, eng_v_size_of_two(d[0][k], d[1][k]));
    }
    return size;
}

/* Return more than sums of two differences are off by; those of marks are exact. */
ENG_INLINE eng_d diagonal_margin(enum pccd_kind kind,
                                 const struct eng_v d[2][DIFFERENCES])
{
    return 8 * ENG_U * size_of_all(kind, d);
}

#endif

/* ---- axes and time ----------------------------------------------------------------- */

/* Times as fractions n / d: when the pair can touch first and last. Both terms of `from`
 * are >= 0, both of `to` <= 0. */
struct span {
    eng_n from_n, from_d;
    eng_n to_n, to_d;
};

/* Cut from the span the times of gaps along an axis, given at t = 0 and at t = 1. A gap
 * is concave in t, so there is one before (after) the root of its chord, g0 / (g0 - g1),
 * if g0 (g1) is positive. For both orders at once, as only one of them can have a gap at
 * an end. With gaps at both ends `from` is 1 and `to` is 0. */
ENG_INLINE void cut_span(struct span *span, const eng_n gaps0[2], const eng_n gaps1[2])
{
    const eng_n zero = {0};
    eng_nm above = eng_n_less(zero, gaps0[0]);
    eng_n n = eng_n_max(eng_n_max(gaps0[0], gaps0[1]), zero);
    eng_n d = n - eng_n_min(eng_n_select(above, gaps1[0], gaps1[1]), zero);
    eng_nm later = eng_n_less(span->from_n * d, n * span->from_d);
    span->from_n = eng_n_select(later, n, span->from_n);
    span->from_d = eng_n_select(later, d, span->from_d);
    above = eng_n_less(zero, gaps1[0]);
    n = eng_n_min(eng_n_select(above, gaps0[0], gaps0[1]), zero);
    d = n - eng_n_max(eng_n_max(gaps1[0], gaps1[1]), zero);
    eng_nm sooner = eng_n_less(n * span->to_d, span->to_n * d);
    span->to_n = eng_n_select(sooner, n, span->to_n);
    span->to_d = eng_n_select(sooner, d, span->to_d);
}

/* Return the lanes in which x, y and z together leave no time up to t_end at which no gap
 * is more than `least`. */
ENG_INLINE uint32_t leave_no_time(enum pccd_kind kind,
                                  const difference_t d[2][DIFFERENCES], eng_n t_end,
                                  eng_n least)
{
    const eng_n zero = {0};
    struct span span = {zero, zero + 1, -t_end, zero - 1};
#pragma GCC unroll 3
    for (int axis = 0; axis < AXES; axis++) {
        eng_n beyond[2][2];
#pragma GCC unroll 2
        for (int end = 0; end < 2; end++) {
            gap_t gaps[2];
            gaps_along(kind, d[end], axis, gaps);
            beyond[end][0] = number_of(gaps[0] - CELLS_AXIS) - least;
            beyond[end][1] = number_of(gaps[1] - CELLS_AXIS) - least;
        }
        cut_span(&span, beyond[0], beyond[1]);
    }
    return eng_nm_bits(eng_n_less(span.from_n * span.to_d,
                                  span.to_n * span.from_d * ENG_SLACK - LOST_TIME));
}

/* ---- planes that turn with the features -------------------------------------------- */

/* w leads from a point of the one feature to one of the other; n = u x v is across both,
 * and where w, u and v lie in a plane, w . n is 0. */
struct sides {
    struct eng_v w[2], u[2], v[2];
};

/* Set f to w . n by its Bernstein coefficients over the step, those in the middle three
 * times; of n, n[1] is twice the one in the middle. */
ENG_INLINE void heights_of(const struct sides *sides, struct eng_v n[3], eng_n f[4])
{
    const struct eng_v *w = sides->w;
    const struct eng_v *u = sides->u;
    const struct eng_v *v = sides->v;
    n[0] = eng_v_cross(u[0], v[0]);
    n[1] = eng_v_add(eng_v_cross(u[0], v[1]), eng_v_cross(u[1], v[0]));
    n[2] = eng_v_cross(u[1], v[1]);
    f[0] = eng_v_dot(w[0], n[0]);
    f[1] = eng_v_dot(w[1], n[0]) + eng_v_dot(w[0], n[1]);
    f[2] = eng_v_dot(w[0], n[2]) + eng_v_dot(w[1], n[1]);
    f[3] = eng_v_dot(w[1], n[2]);
}

/* Return the lanes in which all that lies between low[i] and high[i] is beyond least[i],
 * on one side for all. */
ENG_INLINE uint32_t are_on_one_side(int count, const eng_n *low, const eng_n *high,
                                    const eng_n *least)
{
    eng_nm above = eng_n_less(least[0], low[0]);
    eng_nm below = eng_n_less(high[0], -least[0]);
#pragma GCC unroll 3
    for (int i = 1; i < count; i++) {
        above = eng_nm_and(above, eng_n_less(least[i], low[i]));
        below = eng_nm_and(below, eng_n_less(high[i], -least[i]));
    }
    return eng_nm_bits(eng_nm_or(above, below));
}

/* Return the lanes in which these coefficients say that there is no plane: those over
 * either half of the step have one sign. They are off by `error`, those in the middle by
 * three times as much. */
ENG_INLINE uint32_t heights_miss(const eng_n f[4], eng_n error)
{
    /* Times six the second of a half, counted from its end of the step, times twelve the
     * third. The fourth is the mean of the two third ones. */
    eng_n middle = f[1] + f[2];
    eng_n second[2] = {3 * f[0] + f[1], 3 * f[3] + f[2]};
    eng_n third[2] = {second[0] + middle, second[1] + middle};
    const eng_n low[3] = {eng_n_min(f[0], f[3]), eng_n_min(second[0], second[1]),
                          eng_n_min(third[0], third[1])};
    const eng_n high[3] = {eng_n_max(f[0], f[3]), eng_n_max(second[0], second[1]),
                           eng_n_max(third[0], third[1])};
    const eng_n least[3] = {error, 6 * error, 12 * error};
    return are_on_one_side(3, low, high, least);
}

/* Return the lanes in which the planes across both features stay farther apart than
 * `reach`, on one side. That is so where w . n, less `error`, is more than `reach` times
 * |n|, which is off by `length_error`. */
ENG_INLINE uint32_t planes_are_beyond(const struct sides *sides, eng_n reach, eng_n error,
                                      eng_n length_error)
{
    struct eng_v n[3];
    eng_n f[4];
    eng_n most[3];
    heights_of(sides, n, f);
#pragma GCC unroll 3
    for (int i = 0; i < 3; i++) {
        most[i] = reach * (eng_n_sqrt(eng_v_dot(n[i], n[i])) + length_error);
    }
    const eng_n least[4] = {most[0] + error, most[0] + most[1] + 3 * error,
                            most[1] + most[2] + 3 * error, most[2] + error};
    return are_on_one_side(4, f, f, least);
}

/* ---- at one end, by squares -------------------------------------------------------- */

/* Return the lanes in which the boxes around the features are farther apart than the root
 * of `square`. `scale`: of the numbers that are squared. */
ENG_INLINE eng_nm boxes_are_beyond(enum pccd_kind kind, const difference_t *d,
                                   eng_n scale, eng_n square)
{
    const gap_t zero = {0};
    eng_n between[AXES];
#pragma GCC unroll 3
    for (int axis = 0; axis < AXES; axis++) {
        gap_t gaps[2];
        gaps_along(kind, d, axis, gaps);
        gap_t widest = gap_max(gaps[0], gaps[1]) - CELLS_AXIS;
        between[axis] = number_of(gap_max(widest, zero)) * scale;
    }
    struct eng_v gap = {between[0], between[1], between[2]};
    return eng_n_less(square, eng_v_dot(gap, gap));
}

/* Return the lanes in which the planes across n, from one of which w leads to the other,
 * are as far apart. w . n is off by `error`, and the square of n by `square_error`. */
ENG_INLINE eng_nm plane_is_beyond(struct eng_v w, struct eng_v n, eng_n error,
                                  eng_n square_error, eng_n square)
{
    const eng_n zero = {0};
    eng_n height = eng_n_abs(eng_v_dot(w, n)) - error;
    eng_n most = square * (eng_v_dot(n, n) + square_error) + LOST_SQUARE;
    return eng_nm_and(eng_n_less(zero, height), eng_n_less(most, height * height));
}

#endif
