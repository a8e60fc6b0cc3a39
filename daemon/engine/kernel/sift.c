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

ENG_INLINE uint32_t planes_reject(const struct question *question, struct cubic cubic)
{
    if (question->is_cut) {
        cut_cubic(cubic.f, question->t_end);
    }
    eng_f of_products = eng_f_all((question->is_cut ? 160 : 80) * ENG_N_U);
    return heights_miss(cubic.f, volume_error(cubic.sizes, of_products));
}

/* ---- one test after the other ------------------------------------------------------ */

enum tests { PLANES = 1, TIME = 2, DIAGONALS = 4 };

/* The pairs that none of `tests` rejects move to the front; returns how many. *gone: how
 * many the first of the tests, of this order, has rejected. */
ENG_INLINE uint32_t pass(const struct question *question, enum tests tests,
                         const struct eng_sieve *sieve, uint32_t *a, uint32_t *b,
                         uint32_t count, uint32_t *gone)
{
    uint32_t kept = 0;
    *gone = 0;
    repeat_last(a, b, count);
    for (uint32_t i = 0; i < count; i += ENG_F_LANES) {
        uint32_t n = count - i < ENG_F_LANES ? count - i : ENG_F_LANES;
        uint32_t lanes = ENG_F_ALL >> (ENG_F_LANES - n);
        uint32_t out = 0;
        struct eng_g d[2][DIFFERENCES];
        if (tests & PLANES && !question->is_thick) {
            out =
                planes_reject(question, cubic_of(question->kind, sieve, a + i, b + i, d));
        } else {
            eng_marks_load(question->kind, sieve, a + i, b + i, d);
        }
        if (tests & PLANES && question->is_thick) {
            out = thick_planes_reject(question, d);
        } else if (tests & TIME) {
            out = leave_no_time(question->kind, d, question->t_end, question->reach);
        }
        *gone += eng_count_lanes(out & lanes);
        if (tests & DIAGONALS) {
            out |= are_beyond(question->kind, d, AXES, DIRECTIONS,
                              DIAGONAL * question->reach);
        }
        kept += eng_compress_pairs(a + kept, b + kept, a + i, b + i, lanes & ~out);
    }
    return kept;
}

/* Which of planes and time rejects more depends on the scene, nine of ten pairs with
 * balls in flight by the one, with draped cloth by the other: the better one goes first,
 * over all pairs, the second with the diagonals over what that leaves. What is rejected
 * does not depend on the order. */
ENG_INLINE uint32_t sift(const struct question *question, struct eng_sieve *sieve,
                         uint32_t *a, uint32_t *b, uint32_t count)
{
    uint32_t first;
    uint32_t second;
    uint32_t left;
    uint32_t kept;
    bool is_in_time = sieve->in_time && !question->is_cut;
    if (is_in_time || sieve->cubic_first) {
        left = pass(question, PLANES, sieve, a, b, count, &first);
        if (is_in_time) {
            return pass(question, DIAGONALS, sieve, a, b, left, &second);
        }
        kept = pass(question, TIME | DIAGONALS, sieve, a, b, left, &second);
    } else {
        left = pass(question, TIME, sieve, a, b, count, &first);
        kept = pass(question, PLANES | DIAGONALS, sieve, a, b, left, &second);
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
