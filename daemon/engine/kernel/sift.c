/* sift.c - rejects pairs by their marks, in floats, a pair to each lane: twice as many at
 * a time as by doubles, at margins that hold what the grid and the floats round off.
 * Leaves in a while only where features are small beside the grid.
 *
 * `sift`: pairs that do not meet. `sift_thick`: pairs that stay farther apart than a
 * reach all over the step.
 *
 * Source: BOUNDS.md, the chapters that begin with "The sieve".
 */
#define ENG_IN_FLOATS
#include <assert.h>

#include "reject.h"
#include "table.h"

/* Pairs are taken ENG_F_LANES at a time, the last of them again where there are fewer. */
ENG_INLINE void repeat_last(uint32_t *a, uint32_t *b, uint32_t count)
{
    _Static_assert(ENG_SIEVE_SPARE == 16, "eng_fill16 writes so many");
    if (count > 0) {
        eng_fill16(a + count, a[count - 1]);
        eng_fill16(b + count, b[count - 1]);
    }
}

/* ---- axes of swept pairs ----------------------------------------------------------- */

/* Marks are compared in the layout that they have in memory, for the many pairs whose
 * features an axis separates for the whole step: what reject_axes.c does, from half the
 * bytes. A gap of two units at both ends is one all the time. */

/* Pairs whose comparisons are kept as bytes and looked at afterwards: moving each to a
 * register of its own takes longer, and so does to wait for it. */
#define AXES_BYTES 256u

/* A byte for each pair, bits x0 y0 z0 word x1 y1 z1 word: b lies above a there by two
 * units or more; a lies above b. */
struct axes {
    uint8_t below[AXES_BYTES];
    uint8_t above[AXES_BYTES];
};

#if ENG_VECTOR_BYTES == 8

/* Smallest and largest coordinate of marks first .. last - 1. */
ENG_INLINE void extent_of(const struct eng_corners *pair, int first, int last, int end,
                          int axis, int32_t *low, int32_t *high)
{
    for (int i = first; i < last; i++) {
        const struct eng_mark *mark = pair->mark[i];
        int32_t x = end ? mark->q1[axis] : mark->q0[axis];
        *low = i == first || x < *low ? x : *low;
        *high = i == first || x > *high ? x : *high;
    }
}

ENG_INLINE void compare_axes(enum pccd_kind kind, const struct eng_sieve *sieve,
                             const uint32_t *a, const uint32_t *b, uint8_t *below,
                             uint8_t *above)
{
    struct eng_corners pair = eng_corners_of(kind, sieve, *a, *b);
    const int split = kind == PCCD_VF ? 1 : 2;
    *below = *above = 0;
    for (int i = 0; i < 6; i++) {
        int32_t low[2] = {0, 0};
        int32_t high[2] = {0, 0};
        extent_of(&pair, 0, split, i / 3, i % 3, &low[0], &high[0]);
        extent_of(&pair, split, 4, i / 3, i % 3, &low[1], &high[1]);
        uint8_t bit = (uint8_t)(1u << (i + i / 3));
        *below = (uint8_t)(*below | (low[1] > high[0] + 1 ? bit : 0));
        *above = (uint8_t)(*above | (low[0] > high[1] + 1 ? bit : 0));
    }
}

#else

/* Marks as they lie in memory: two pairs', one's, or one's at one end. */
#if ENG_VECTOR_BYTES == 64
#define AXES_PAIRS 2u
#else
#define AXES_PAIRS 1u
#endif

ENG_INLINE eng_fi mark_of(const struct eng_corners *pairs, int corner, int end)
{
#if ENG_VECTOR_BYTES == 64
    (void)end;
    return (eng_fi)eng_marks_two(pairs[0].mark[corner], pairs[1].mark[corner]);
#else
    return eng_fi_of(end ? pairs->mark[corner]->q1 : pairs->mark[corner]->q0);
#endif
}

/* The lanes of a > b + 1. */
ENG_INLINE uint32_t is_above(eng_fi a, eng_fi b)
{
#if ENG_VECTOR_BYTES == 64
    return _mm512_cmpgt_epi32_mask((__m512i)a, (__m512i)(b + 1));
#else
    return eng_fm_bits(a > b + 1);
#endif
}

/* The bits of ENG_F_LANES pairs. */
ENG_INLINE void compare_axes(enum pccd_kind kind, const struct eng_sieve *sieve,
                             const uint32_t *a, const uint32_t *b, uint8_t *below,
                             uint8_t *above)
{
#pragma GCC unroll 8
    for (uint32_t i = 0; i < ENG_F_LANES; i += AXES_PAIRS) {
        struct eng_corners pairs[AXES_PAIRS];
        uint32_t bits[2] = {0, 0};
#pragma GCC unroll 2
        for (uint32_t k = 0; k < AXES_PAIRS; k++) {
            pairs[k] = eng_corners_of(kind, sieve, a[i + k], b[i + k]);
        }
#pragma GCC unroll 2
        for (int end = 0; end < (ENG_F_LANES == 4 ? 2 : 1); end++) {
            eng_fi mark[4];
#pragma GCC unroll 4
            for (int k = 0; k < 4; k++) {
                mark[k] = mark_of(pairs, k, end);
            }
            eng_fi low = eng_fi_min(mark[2], mark[3]);
            eng_fi high = eng_fi_max(mark[2], mark[3]);
            if (kind == PCCD_VF) {
                low = eng_fi_min(mark[1], low);
                high = eng_fi_max(mark[1], high);
                bits[0] |= is_above(low, mark[0]) << 4 * end;
                bits[1] |= is_above(mark[0], high) << 4 * end;
            } else {
                bits[0] |= is_above(low, eng_fi_max(mark[0], mark[1])) << 4 * end;
                bits[1] |= is_above(eng_fi_min(mark[0], mark[1]), high) << 4 * end;
            }
        }
        memcpy(below + i, &bits[0], AXES_PAIRS);
        memcpy(above + i, &bits[1], AXES_PAIRS);
    }
}

#endif

/* Return, for ENG_F_LANES pairs, bit i if pair i has an axis with both ends. */
ENG_INLINE uint32_t axes_between(const uint8_t *below, const uint8_t *above)
{
#if ENG_VECTOR_BYTES == 64
    __m128i up = _mm_loadu_si128((const __m128i *)(const void *)below);
    __m128i down = _mm_loadu_si128((const __m128i *)(const void *)above);
    __m128i both = _mm_or_si128(_mm_and_si128(up, _mm_srli_epi16(up, 4)),
                                _mm_and_si128(down, _mm_srli_epi16(down, 4)));
    return _mm_test_epi8_mask(both, _mm_set1_epi8(7));
#elif ENG_VECTOR_BYTES == 32
    uint64_t up;
    uint64_t down;
    memcpy(&up, below, sizeof up);
    memcpy(&down, above, sizeof down);
    uint64_t both = (up & up >> 4) | (down & down >> 4);
    /* 1 to 7 and 127 set the highest bit, and carry nothing into the next byte. */
    both = (both & 0x0707070707070707u) + 0x7f7f7f7f7f7f7f7fu;
    return (uint32_t)_pext_u64(both, 0x8080808080808080u);
#elif ENG_VECTOR_BYTES == 16
    uint32_t up;
    uint32_t down;
    memcpy(&up, below, sizeof up);
    memcpy(&down, above, sizeof down);
    uint32_t both = (up & up >> 4) | (down & down >> 4);
    both = (both & 0x07070707u) + 0x7f7f7f7fu; /* as with AVX2 */
    return ((both >> 7 & 0x01010101u) * 0x01020408u) >> 24;
#else
    uint32_t bits = 0;
    for (uint32_t i = 0; i < ENG_F_LANES; i++) {
        uint32_t both = (below[i] & below[i] >> 4) | (above[i] & above[i] >> 4);
        bits |= (uint32_t)((both & 7u) != 0) << i;
    }
    return bits;
#endif
}

/* The pairs that no axis separates move to the front; returns how many. */
ENG_INLINE uint32_t pass_axes(enum pccd_kind kind, const struct eng_sieve *sieve,
                              uint32_t *a, uint32_t *b, uint32_t count)
{
    struct axes axes;
    uint32_t kept = 0;
    repeat_last(a, b, count);
    for (uint32_t first = 0; first < count; first += AXES_BYTES) {
        uint32_t n = count - first < AXES_BYTES ? count - first : AXES_BYTES;
        uint32_t *a_in = a + first;
        uint32_t *b_in = b + first;
        for (uint32_t i = 0; i < n; i += ENG_F_LANES) {
            compare_axes(kind, sieve, a_in + i, b_in + i, axes.below + i, axes.above + i);
        }
        for (uint32_t i = 0; i < n; i += ENG_F_LANES) {
            uint32_t out = axes_between(axes.below + i, axes.above + i);
            uint32_t lanes = n - i < ENG_F_LANES ? (1u << (n - i)) - 1 : ENG_F_ALL;
            kept +=
                eng_compress_pairs(a + kept, b + kept, a_in + i, b_in + i, lanes & ~out);
        }
    }
    return kept;
}

/* ---- planes ------------------------------------------------------------------------ */

/* The question about the pairs; but for the numbers, constants of the code. */
struct question {
    enum pccd_kind kind;
    bool is_thick; /* there is a reach */
    bool is_cut;   /* t_end < 1 */
    eng_f t_end;
    eng_f reach; /* in cells, ENG_SLACK times as much */
};

ENG_INLINE struct eng_g less(struct eng_g a, struct eng_g b)
{
    return (struct eng_g){a.x - b.x, a.y - b.y, a.z - b.z};
}

/* Sides of both features. */
ENG_INLINE struct sides sides_of(enum pccd_kind kind,
                                 const struct eng_g d[2][DIFFERENCES])
{
    bool is_vf = kind == PCCD_VF;
    struct sides sides;
#pragma GCC unroll 2
    for (int end = 0; end < 2; end++) {
        const struct eng_g *own = d[end];
        sides.w[end] = vector_of(own[is_vf ? 0 : 1]);
        sides.u[end] = vector_of(is_vf ? less(own[1], own[0]) : own[0]);
        sides.v[end] = vector_of(less(own[2], own[is_vf ? 0 : 1]));
    }
    return sides;
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

/* Return more than what a determinant of three vectors is off by, `of_products` of it by
 * the arithmetic. The sizes are their largest coordinates. */
ENG_INLINE eng_f volume_error(const eng_f sizes[3], eng_f of_products)
{
    eng_f a = sizes[0] + OFF_GRID;
    eng_f b = sizes[1] + OFF_GRID;
    eng_f c = sizes[2] + OFF_GRID;
    return of_products * (a * b * c) + 7 * (a * b + (a + b) * c);
}

ENG_INLINE uint32_t thick_planes_reject(const struct question *question,
                                        const struct eng_g d[2][DIFFERENCES])
{
    struct sides sides = sides_of(question->kind, d);
    const eng_f sizes[3] = {eng_v_size_of_two(sides.w[0], sides.w[1]),
                            eng_v_size_of_two(sides.u[0], sides.u[1]),
                            eng_v_size_of_two(sides.v[0], sides.v[1])};
    eng_f b = sizes[1] + OFF_GRID;
    eng_f c = sizes[2] + OFF_GRID;
    eng_f length = 48 * ENG_N_U * (b * c) + 12 * (b + c);
    eng_f error = volume_error(sizes, eng_f_all(72 * ENG_N_U));
    return planes_are_beyond(&sides, question->reach, error, length);
}

/* The cubic: it does not matter which vectors lie in a plane where the features do, so it
 * is of the differences to one vertex. Coefficients as heights_of has them, and the
 * largest coordinates of the three vectors. */
struct cubic {
    eng_f f[4];
    eng_f sizes[3];
};

#if ENG_VECTOR_BYTES == 32

/* Three vectors of eight pairs at both ends are 18 registers, and there are 16: so four
 * pairs go at a time, with both ends in a register. */

ENG_INLINE eng_f of_one_end(eng_f first, eng_f second, int end)
{
    return (eng_f)eng_marks_of_one_end((eng_fi)first, (eng_fi)second, end);
}

ENG_INLINE eng_f other_end(eng_f v)
{
    return (eng_f)_mm256_permute2f128_ps((__m256)v, (__m256)v, 1);
}

ENG_INLINE struct eng_v other_ends(struct eng_v v)
{
    return (struct eng_v){other_end(v.x), other_end(v.y), other_end(v.z)};
}

/* f[0]: the first and the last coefficient, f[1]: the second and the third. */
ENG_INLINE struct cubic cubic_of_four(const struct eng_g d[DIFFERENCES])
{
    struct eng_v w = vector_of(d[0]);
    struct eng_v u = vector_of(d[1]);
    struct eng_v v = vector_of(d[2]);
    struct cubic cubic = {.sizes = {eng_v_size(w), eng_v_size(u), eng_v_size(v)}};
    struct eng_v n = eng_v_cross(u, v);
    struct eng_v mixed = eng_v_cross(u, other_ends(v));
    struct eng_v middle = eng_v_add(mixed, other_ends(mixed));
    cubic.f[0] = eng_v_dot(w, n);
    cubic.f[1] = eng_v_dot(other_ends(w), n) + eng_v_dot(w, middle);
    return cubic;
}

/* Load the pairs, too. */
ENG_INLINE struct cubic cubic_of(enum pccd_kind kind, const struct eng_sieve *sieve,
                                 const uint32_t *a, const uint32_t *b,
                                 struct eng_g d[2][DIFFERENCES])
{
    struct eng_g fours[2][DIFFERENCES];
    struct cubic of[2];
    struct cubic cubic;
#pragma GCC unroll 2
    for (int i = 0; i < 2; i++) {
        eng_marks_load_four(kind, sieve, a + 4 * i, b + 4 * i, fours[i]);
        of[i] = cubic_of_four(fours[i]);
    }
    eng_marks_by_end((const struct eng_g(*)[DIFFERENCES])fours, d);
    cubic.f[0] = of_one_end(of[0].f[0], of[1].f[0], 0);
    cubic.f[1] = of_one_end(of[0].f[1], of[1].f[1], 0);
    cubic.f[2] = of_one_end(of[0].f[1], of[1].f[1], 1);
    cubic.f[3] = of_one_end(of[0].f[0], of[1].f[0], 1);
#pragma GCC unroll 3
    for (int k = 0; k < 3; k++) {
        eng_f first = of[0].sizes[k];
        eng_f second = of[1].sizes[k];
        cubic.sizes[k] =
            eng_f_max(of_one_end(first, second, 0), of_one_end(first, second, 1));
    }
    return cubic;
}

#else

ENG_INLINE struct cubic cubic_of(enum pccd_kind kind, const struct eng_sieve *sieve,
                                 const uint32_t *a, const uint32_t *b,
                                 struct eng_g d[2][DIFFERENCES])
{
    struct sides sides;
    struct eng_v n[3];
    struct cubic cubic;
    eng_marks_load(kind, sieve, a, b, d);
#pragma GCC unroll 2
    for (int end = 0; end < 2; end++) {
        sides.w[end] = vector_of(d[end][0]);
        sides.u[end] = vector_of(d[end][1]);
        sides.v[end] = vector_of(d[end][2]);
    }
    cubic.sizes[0] = eng_v_size_of_two(sides.w[0], sides.w[1]);
    cubic.sizes[1] = eng_v_size_of_two(sides.u[0], sides.u[1]);
    cubic.sizes[2] = eng_v_size_of_two(sides.v[0], sides.v[1]);
    heights_of(&sides, n, cubic.f);
    return cubic;
}

#endif

/* Numbers known of the cubics of pairs: the coefficients; what the first and the last are
 * off by, those in the middle by three times as much; the largest coordinate of all
 * differences. */
enum { ERROR = 4, SIZE, KNOWN };

ENG_INLINE uint32_t planes_reject(const struct question *question, struct cubic cubic,
                                  eng_f known[KNOWN])
{
    if (question->is_cut) {
        cut_cubic(cubic.f, question->t_end);
    }
    eng_f of_products = eng_f_all((question->is_cut ? 216 : 144) * ENG_N_U);
    memcpy(known, cubic.f, sizeof cubic.f);
    known[ERROR] = volume_error(cubic.sizes, of_products);
    known[SIZE] = eng_f_max(eng_f_max(cubic.sizes[0], cubic.sizes[1]), cubic.sizes[2]);
    return heights_miss(cubic.f, known[ERROR]);
}

/* ---- beside each other while they may be in a plane -------------------------------- */

/* Most pairs whose cubic has a root cross there outside of each other: then a direction
 * in the plane of both, across an edge, keeps them apart about that time, though hardly
 * for the whole step. So the time is narrowed down first. */

#define HALVINGS 3

/* Return the lanes in which all four are beyond the error on one side. */
ENG_INLINE eng_fm are_clear(eng_f a, eng_f b, eng_f c, eng_f d, eng_f error)
{
    eng_f low = eng_f_min(eng_f_min(a, b), eng_f_min(c, d));
    eng_f high = eng_f_max(eng_f_max(a, b), eng_f_max(c, d));
    return eng_fm_or(eng_f_less(error, low), eng_f_less(high, -error));
}

/* Set `times` to shares of [0, t_end] outside of which the cubics have no root: a half
 * without one goes, as long as there is such a half. */
ENG_INLINE void shorten_times(const eng_f known[KNOWN], eng_f times[2])
{
    const eng_f zero = {0};
    eng_f f[4] = {known[0], known[1] * (1 / 3.0f), known[2] * (1 / 3.0f), known[3]};
    times[0] = zero;
    times[1] = zero + 1;
#pragma GCC unroll 3
    for (int i = 0; i < HALVINGS; i++) {
        eng_f quad[3] = {0.5f * (f[0] + f[1]), 0.5f * (f[1] + f[2]),
                         0.5f * (f[2] + f[3])};
        eng_f line[2] = {0.5f * (quad[0] + quad[1]), 0.5f * (quad[1] + quad[2])};
        eng_f middle = 0.5f * (line[0] + line[1]);
        eng_f t = 0.5f * (times[0] + times[1]);
        eng_fm before = are_clear(f[0], quad[0], line[0], middle, known[ERROR]);
        eng_fm behind = are_clear(middle, line[1], quad[2], f[3], known[ERROR]);
        times[0] = eng_f_select(before, t, times[0]);
        times[1] = eng_f_select(behind, t, times[1]);
        f[0] = eng_f_select(before, middle, f[0]);
        f[1] = eng_f_select(before, line[1], eng_f_select(behind, quad[0], f[1]));
        f[2] = eng_f_select(before, quad[2], eng_f_select(behind, line[0], f[2]));
        f[3] = eng_f_select(behind, middle, f[3]);
    }
}

/* Return the lanes in which a direction n x side, whatever n is, keeps features apart at
 * both of two times, and so between them. */
ENG_INLINE eng_fm keeps_apart(enum pccd_kind kind, struct eng_v e[2][DIFFERENCES],
                              struct eng_v n, struct eng_v side, eng_f off)
{
    const eng_f zero = {0};
    /* Products of four lengths would not fit. */
    struct eng_v way = eng_v_scale(eng_f_all(0x1p-32f), eng_v_cross(n, side));
    struct eng_v size = eng_v_abs(way);
    eng_f up[2];   /* b above a */
    eng_f down[2]; /* a above b */
#pragma GCC unroll 2
    for (int end = 0; end < 2; end++) {
        eng_f first = eng_v_dot(way, e[end][0]);
        eng_f s[2] = {eng_v_dot(way, e[end][1]), eng_v_dot(way, e[end][2])};
        eng_f low = eng_f_min(s[0], s[1]);
        eng_f high = eng_f_max(s[0], s[1]);
        if (kind == PCCD_VF) {
            up[end] = eng_f_min(first, low);
            down[end] = -eng_f_max(first, high);
        } else {
            up[end] = low - eng_f_max(first, zero);
            down[end] = eng_f_min(first, zero) - high;
        }
    }
    eng_f widest = eng_f_max(eng_f_min(up[0], up[1]), eng_f_min(down[0], down[1]));
    return eng_f_less(off * (size.x + size.y + size.z), widest);
}

/* Return the lanes in which features do not meet while they may be in a plane. */
ENG_INLINE uint32_t are_aside(const struct question *question, const eng_f known[KNOWN],
                              const struct eng_g d[2][DIFFERENCES])
{
    enum pccd_kind kind = question->kind;
    eng_f off = 4 + 40 * ENG_N_U * known[SIZE];
    eng_f times[2];
    struct eng_v e[2][DIFFERENCES]; /* differences at these */
    struct eng_v m[DIFFERENCES];    /* in the middle, twice as large */
    shorten_times(known, times);
    if (question->is_cut) {
        times[0] *= question->t_end;
        times[1] *= question->t_end;
    }
#pragma GCC unroll 3
    for (int k = 0; k < DIFFERENCES; k++) {
        struct eng_v begin = vector_of(d[0][k]);
        struct eng_v way = eng_v_sub(vector_of(d[1][k]), begin);
        e[0][k] = eng_v_add(begin, eng_v_scale(times[0], way));
        e[1][k] = eng_v_add(begin, eng_v_scale(times[1], way));
        m[k] = eng_v_add(e[0][k], e[1][k]);
    }
    bool is_vf = kind == PCCD_VF;
    struct eng_v side[2] = {is_vf ? eng_v_sub(m[1], m[0]) : m[0], eng_v_sub(m[2], m[1])};
    struct eng_v n = eng_v_cross(side[0], is_vf ? side[1] : m[1]);
    eng_fm out = keeps_apart(kind, e, n, side[0], off);
    if (is_vf) {
        out = eng_fm_or(out, keeps_apart(kind, e, n, eng_v_sub(m[0], m[2]), off));
    } else {
        n = eng_v_cross(side[1], m[1]); /* edges may be parallel */
    }
    return eng_fm_bits(eng_fm_or(out, keeps_apart(kind, e, n, side[1], off)));
}

/* ---- one test after the other ------------------------------------------------------ */

enum tests { PLANES = 1, TIME = 2, DIAGONALS = 4, ASIDE = 8 };

/* Floats of the pairs that are left, by their places. */
typedef uint32_t numbers_t[ENG_SIEVE_MAX + ENG_SIEVE_SPARE];

/* The pairs that none of `tests` rejects move to the front; returns how many. *gone: how
 * many planes or time have rejected. Where there is no reach PLANES writes all[KNOWN],
 * which ASIDE reads. */
ENG_INLINE uint32_t pass(const struct question *question, enum tests tests,
                         const struct eng_sieve *sieve, uint32_t *a, uint32_t *b,
                         uint32_t count, numbers_t *all, uint32_t *gone)
{
    bool is_thick = question->is_thick;
    uint32_t kept = 0;
    *gone = count;
    repeat_last(a, b, count);
    for (uint32_t i = 0; i < count; i += ENG_F_LANES) {
        uint32_t n = count - i < ENG_F_LANES ? count - i : ENG_F_LANES;
        uint32_t lanes = ENG_F_ALL >> (ENG_F_LANES - n);
        struct eng_g d[2][DIFFERENCES];
        eng_f known[KNOWN];
        if (tests & PLANES && !is_thick) {
            struct cubic cubic = cubic_of(question->kind, sieve, a + i, b + i, d);
            lanes &= ~planes_reject(question, cubic, known);
        } else {
            eng_marks_load(question->kind, sieve, a + i, b + i, d);
            lanes &= tests & PLANES ? ~thick_planes_reject(question, d) : ~0u;
        }
        if (tests & TIME) {
            lanes &= ~leave_no_time(question->kind, d, question->t_end, question->reach);
        }
        *gone -= eng_count_lanes(lanes);
        if (tests & DIAGONALS) {
            lanes &= ~are_beyond(question->kind, d, AXES, DIRECTIONS,
                                 DIAGONAL * question->reach);
        }
        if (tests & PLANES && !is_thick) {
            uint32_t x[KNOWN][ENG_F_LANES];
            memcpy(x, known, sizeof x);
#pragma GCC unroll 3
            for (int k = 0; k < KNOWN; k += 2) {
                eng_compress_pairs(all[k] + kept, all[k + 1] + kept, x[k], x[k + 1],
                                   lanes);
            }
        }
        if (tests & ASIDE) {
#pragma GCC unroll 6
            for (int k = 0; k < KNOWN; k++) {
                known[k] = (eng_f)eng_fi_load(all[k] + i);
            }
            lanes &= ~are_aside(question, known, (const struct eng_g(*)[DIFFERENCES])d);
        }
        kept += eng_compress_pairs(a + kept, b + kept, a + i, b + i, lanes);
    }
    return kept;
}

/* Which of planes and time rejects more depends on the scene, nine of ten pairs with
 * balls in flight by the one, with draped cloth by the other: the better one goes first,
 * over all pairs, then the second and what takes longest. What is rejected does not
 * depend on the order. */
ENG_INLINE uint32_t sift(const struct question *question, struct eng_sieve *sieve,
                         uint32_t *a, uint32_t *b, uint32_t count)
{
    numbers_t all[KNOWN];
    uint32_t first;
    uint32_t second;
    uint32_t third;
    uint32_t left;
    uint32_t kept;
    bool is_thick = question->is_thick;
    bool is_in_time = sieve->in_time && !question->is_cut;
    assert(count <= ENG_SIEVE_MAX);
    if (is_in_time || sieve->cubic_first) {
        left = pass(question, PLANES, sieve, a, b, count, all, &first);
        if (is_in_time) {
            return pass(question, is_thick ? DIAGONALS : ASIDE, sieve, a, b, left, all,
                        &third);
        }
        kept = pass(question, TIME | (is_thick ? DIAGONALS : ASIDE), sieve, a, b, left,
                    all, &second);
    } else {
        left = pass(question, TIME, sieve, a, b, count, all, &first);
        kept = pass(question, PLANES, sieve, a, b, left, all, &second);
        kept =
            pass(question, is_thick ? DIAGONALS : ASIDE, sieve, a, b, kept, all, &third);
    }
    if ((uint64_t)second * count > (uint64_t)first * left) {
        sieve->cubic_first = !sieve->cubic_first;
    }
    return kept;
}

ENG_INLINE uint32_t sift_thin(enum pccd_kind kind, bool is_cut, struct eng_sieve *sieve,
                              uint32_t *a, uint32_t *b, uint32_t count)
{
    const struct question question = {
        .kind = kind, .is_cut = is_cut, .t_end = eng_f_all(sieve->t_end)};
    if (sieve->swept) {
        count = pass_axes(kind, sieve, a, b, count);
    }
    return sift(&question, sieve, a, b, count);
}

static uint32_t sift_vf(struct eng_sieve *sieve, uint32_t *a, uint32_t *b, uint32_t count)
{
    return sieve->t_end < 1 ? sift_thin(PCCD_VF, true, sieve, a, b, count)
                            : sift_thin(PCCD_VF, false, sieve, a, b, count);
}

static uint32_t sift_ee(struct eng_sieve *sieve, uint32_t *a, uint32_t *b, uint32_t count)
{
    return sieve->t_end < 1 ? sift_thin(PCCD_EE, true, sieve, a, b, count)
                            : sift_thin(PCCD_EE, false, sieve, a, b, count);
}

uint32_t ENG_KERNEL(sift)(enum pccd_kind kind, struct eng_sieve *sieve, uint32_t *a,
                          uint32_t *b, uint32_t count)
{
    return kind == PCCD_VF ? sift_vf(sieve, a, b, count) : sift_ee(sieve, a, b, count);
}

ENG_INLINE uint32_t sift_thick(enum pccd_kind kind, struct eng_sieve *sieve, float reach,
                               uint32_t *a, uint32_t *b, uint32_t count)
{
    const struct question question = {.kind = kind,
                                      .is_thick = true,
                                      .t_end = eng_f_all(1),
                                      .reach = eng_f_all(reach * ENG_SLACK)};
    return sift(&question, sieve, a, b, count);
}

uint32_t ENG_KERNEL(sift_thick)(enum pccd_kind kind, struct eng_sieve *sieve, float reach,
                                uint32_t *a, uint32_t *b, uint32_t count)
{
    return kind == PCCD_VF ? sift_thick(PCCD_VF, sieve, reach, a, b, count)
                           : sift_thick(PCCD_EE, sieve, reach, a, b, count);
}
