/* sift.c - cheap certain rejections in floats, a pair to each lane.
 *
 * What filter.c does, from points on a grid: twice as many pairs at a time, at margins
 * that hold what the grid and the floats round off. Leaves in a while only where features
 * are small beside the grid.
 *
 * Source: the margins are derived in BOUNDS.md.
 */
#include "sift.h"
#include "axes.h"
#include "table.h"

/* Do x, y and z together leave no time up to t_end? A true gap is less than two units
 * smaller than the one on the grid. */
ENG_INLINE uint32_t never_together(enum pccd_kind kind, const struct eng_g d[2][3],
                                   eng_f t_end)
{
    const eng_f zero = {0};
    struct span span = {zero, zero + 1, -t_end, zero - 1};
#pragma GCC unroll 3
    for (int axis = 0; axis < 3; axis++) {
        eng_f gaps[2][2];
#pragma GCC unroll 2
        for (int end = 0; end < 2; end++) {
            eng_fi x[3];
            eng_fi g[2];
#pragma GCC unroll 3
            for (int k = 0; k < 3; k++) {
                x[k] = coordinate(d[end][k], axis);
            }
            gaps_of(kind, x, g);
            gaps[end][0] = rounded(g[0] - 2);
            gaps[end][1] = rounded(g[1] - 2);
        }
        cut(&span, gaps[0], gaps[1]);
    }
    return eng_fm_bits(
        eng_f_less(span.from_n * span.to_d, span.to_n * span.from_d * SLACK));
}

/* Separated along x+-y, y+-z or z+-x? Halves of coordinates, rounded down, so that their
 * sums fit; a gap of four in them is one. */
ENG_INLINE uint32_t separated(enum pccd_kind kind, const struct eng_g d[2][3])
{
    const eng_fi zero = {0};
    eng_fi widest = zero;
#pragma GCC unroll 6
    for (int direction = 0; direction < 6; direction++) {
        eng_fi gaps[2][2];
#pragma GCC unroll 2
        for (int end = 0; end < 2; end++) {
            eng_fi s[3];
#pragma GCC unroll 3
            for (int k = 0; k < 3; k++) {
                eng_fi first = coordinate(d[end][k], direction / 2) >> 1;
                eng_fi second = coordinate(d[end][k], direction / 2 + 1) >> 1;
                s[k] = direction % 2 ? first - second : first + second;
            }
            gaps_of(kind, s, gaps[end]);
        }
        widest = eng_fi_max(widest, eng_fi_min(gaps[0][0], gaps[1][0]));
        widest = eng_fi_max(widest, eng_fi_min(gaps[0][1], gaps[1][1]));
    }
    return eng_fi_no_signs(widest - 4);
}

ENG_INLINE eng_f mix(eng_f s, eng_f a, eng_f t, eng_f b)
{
    return s * a + t * b;
}

/* Bernstein coefficients over [0, t] of those over [0, 1], the middle ones times three
 * in both. */
ENG_INLINE void cut_cubic(eng_f f[4], eng_f t)
{
    eng_f s = 1 - t;
    eng_f b[3] = {f[1] * (1 / 3.0f), f[2] * (1 / 3.0f), f[3]};
    eng_f line[3] = {mix(s, f[0], t, b[0]), mix(s, b[0], t, b[1]), mix(s, b[1], t, b[2])};
    eng_f quad[2] = {mix(s, line[0], t, line[1]), mix(s, line[1], t, line[2])};
    f[1] = 3 * line[0];
    f[2] = 3 * quad[0];
    f[3] = mix(s, quad[0], t, quad[1]);
}

/* Bernstein coefficients of the cubic up to t_end, the middle ones times three, all
 * beyond their error on one side? */
ENG_INLINE uint32_t one_sided(const struct eng_g d[2][3], bool is_cut, eng_f t_end)
{
    struct vector p[3];
    struct vector q[3];
#pragma GCC unroll 3
    for (int k = 0; k < 3; k++) {
        p[k] = vector_of(d[0][k]);
        q[k] = vector_of(d[1][k]);
    }
    eng_f a = reach(p[0], q[0]);
    eng_f b = reach(p[1], q[1]);
    eng_f c = reach(p[2], q[2]);
    eng_f volume = a * b * c;
    eng_f areas = a * b + (a + b) * c;
    eng_f e = (is_cut ? 144 * U24 : 64 * U24) * volume + 7 * areas;
    struct vector n00 = cross(p[1], p[2]);
    struct vector n11 = cross(q[1], q[2]);
    struct vector mixed = add(cross(p[1], q[2]), cross(q[1], p[2]));
    eng_f f[4] = {dot(p[0], n00), dot(q[0], n00) + dot(p[0], mixed),
                  dot(p[0], n11) + dot(q[0], mixed), dot(q[0], n11)};
    if (is_cut) {
        cut_cubic(f, t_end);
    }
    eng_f e3 = 3 * e;
    eng_fm above = eng_fm_and(eng_f_less(e, eng_f_min(f[0], f[3])),
                              eng_f_less(e3, eng_f_min(f[1], f[2])));
    eng_fm below = eng_fm_and(eng_f_less(eng_f_max(f[0], f[3]), -e),
                              eng_f_less(eng_f_max(f[1], f[2]), -e3));
    return eng_fm_bits(eng_fm_or(above, below));
}

enum tests { CUBIC = 1, TIME = 2, DIAGONALS = 4 };

/* The pairs that no axis separates move to the front; returns how many. */
ENG_INLINE uint32_t pass_axes(enum pccd_kind kind, const struct eng_sieve *sieve,
                              uint32_t *a, uint32_t *b, uint32_t count)
{
    struct eng_axes axes;
    uint32_t kept = 0;
    for (uint32_t first = 0; first < count; first += ENG_AXES_BYTES) {
        uint32_t n = count - first < ENG_AXES_BYTES ? count - first : ENG_AXES_BYTES;
        uint32_t *a_in = a + first;
        uint32_t *b_in = b + first;
        uint32_t i = 0;
        for (; i + ENG_F_LANES <= n; i += ENG_F_LANES) {
            eng_axes_look(kind, sieve, a_in + i, b_in + i, axes.below + i,
                          axes.above + i);
        }
        if (i < n) {
            uint32_t full[2][ENG_F_LANES];
            fill(a_in + i, b_in + i, n - i, full);
            eng_axes_look(kind, sieve, full[0], full[1], axes.below + i, axes.above + i);
        }
        for (i = 0; i < n; i += ENG_F_LANES) {
            uint32_t out = eng_axes_apart(axes.below + i, axes.above + i);
            uint32_t lanes = n - i < ENG_F_LANES ? (1u << (n - i)) - 1 : ENG_F_ALL;
            kept += eng_keep_both(a + kept, b + kept, a_in + i, b_in + i, lanes & ~out);
        }
    }
    return kept;
}

/* The pairs that none of `tests` rejects move to the front; returns how many. *gone: how
 * many the first of the tests, of this order, has rejected. */
ENG_INLINE uint32_t pass(enum pccd_kind kind, enum tests tests, bool is_cut,
                         const struct eng_sieve *sieve, uint32_t *a, uint32_t *b,
                         uint32_t count, uint32_t *gone)
{
    uint32_t kept = 0;
    eng_f t_end = eng_f_all(sieve->t_end);
    *gone = 0;
    for (uint32_t i = 0; i < count; i += ENG_F_LANES) {
        uint32_t n = count - i < ENG_F_LANES ? count - i : ENG_F_LANES;
        uint32_t lanes = ENG_F_ALL >> (ENG_F_LANES - n);
        struct eng_g d[2][3];
        load(kind, sieve, a + i, b + i, n, d);
        uint32_t out = tests & CUBIC  ? one_sided(d, is_cut, t_end)
                       : tests & TIME ? never_together(kind, d, t_end)
                                      : 0;
        *gone += (uint32_t)__builtin_popcount(out & lanes);
        if (tests & DIAGONALS) {
            out |= separated(kind, d);
        }
        kept += eng_keep_both(a + kept, b + kept, a + i, b + i, lanes & ~out);
    }
    return kept;
}

/* Which of cubic and time rejects more depends on the scene, nine of ten pairs with balls
 * in flight by the one, with draped cloth by the other: the better one goes first, over
 * all pairs, the second with the diagonals over what that leaves. What is rejected does
 * not depend on the order. */
ENG_INLINE uint32_t sift(enum pccd_kind kind, bool is_cut, struct eng_sieve *sieve,
                         uint32_t *a, uint32_t *b, uint32_t count)
{
    uint32_t first;
    uint32_t second;
    uint32_t left;
    uint32_t kept;
    if (sieve->swept) {
        count = pass_axes(kind, sieve, a, b, count);
    }
    if (sieve->in_time && !is_cut) {
        left = pass(kind, CUBIC, is_cut, sieve, a, b, count, &first);
        return pass(kind, DIAGONALS, is_cut, sieve, a, b, left, &second);
    }
    if (sieve->cubic_first) {
        left = pass(kind, CUBIC, is_cut, sieve, a, b, count, &first);
        kept = pass(kind, TIME | DIAGONALS, is_cut, sieve, a, b, left, &second);
    } else {
        left = pass(kind, TIME, is_cut, sieve, a, b, count, &first);
        kept = pass(kind, CUBIC | DIAGONALS, is_cut, sieve, a, b, left, &second);
    }
    if ((uint64_t)second * count > (uint64_t)first * left) {
        sieve->cubic_first = !sieve->cubic_first;
    }
    return kept;
}

static uint32_t sift_vf(struct eng_sieve *sieve, uint32_t *a, uint32_t *b, uint32_t count)
{
    return sieve->t_end < 1 ? sift(PCCD_VF, true, sieve, a, b, count)
                            : sift(PCCD_VF, false, sieve, a, b, count);
}

static uint32_t sift_ee(struct eng_sieve *sieve, uint32_t *a, uint32_t *b, uint32_t count)
{
    return sieve->t_end < 1 ? sift(PCCD_EE, true, sieve, a, b, count)
                            : sift(PCCD_EE, false, sieve, a, b, count);
}

uint32_t ENG_KERNEL(sift)(enum pccd_kind kind, struct eng_sieve *sieve, uint32_t *a,
                          uint32_t *b, uint32_t count)
{
    return kind == PCCD_VF ? sift_vf(sieve, a, b, count) : sift_ee(sieve, a, b, count);
}
