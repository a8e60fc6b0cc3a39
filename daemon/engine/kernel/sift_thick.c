/* sift_thick.c - pairs that stay farther apart than a distance all over the step, by
 * their marks, a pair to each lane.
 *
 * Source: BOUNDS.md, "The sieve: thick features".
 */
#include "directions.h"
#include "sift.h"
#include "table.h"

/* What is compared with r is off by fewer cells, and by so much of the largest
 * coordinate. */
#define CELLS   5.0f
#define ROUNDED (40 * U24)

struct pairs {
    struct vector d[2][3];    /* as eng_marks_load */
    struct vector u[2], v[2]; /* sides of both features */
    struct vector w[2];       /* from one to the other */
    eng_f size;               /* more than the largest coordinate of d */
};

ENG_INLINE struct vector between(struct eng_g a, struct eng_g b)
{
    return vector_of((struct eng_g){a.x - b.x, a.y - b.y, a.z - b.z});
}

ENG_INLINE struct pairs pairs_of(enum pccd_kind kind, const struct eng_g d[2][3])
{
    struct pairs pairs;
    bool is_vf = kind == PCCD_VF;
#pragma GCC unroll 2
    for (int end = 0; end < 2; end++) {
#pragma GCC unroll 3
        for (int k = 0; k < 3; k++) {
            pairs.d[end][k] = vector_of(d[end][k]);
        }
        pairs.u[end] = is_vf ? between(d[end][1], d[end][0]) : pairs.d[end][0];
        pairs.v[end] = between(d[end][2], d[end][is_vf ? 0 : 1]);
        pairs.w[end] = pairs.d[end][is_vf ? 0 : 1];
    }
    pairs.size = eng_f_max(reach(pairs.d[0][0], pairs.d[1][0]),
                           eng_f_max(reach(pairs.d[0][1], pairs.d[1][1]),
                                     reach(pairs.d[0][2], pairs.d[1][2])));
    return pairs;
}

/* gaps_of, of floats. */
ENG_INLINE void gaps_along(enum pccd_kind kind, const eng_f s[3], eng_f gaps[2])
{
    const eng_f zero = {0};
    eng_f low = eng_f_min(s[1], s[2]);
    eng_f high = eng_f_max(s[1], s[2]);
    if (kind == PCCD_VF) {
        gaps[0] = eng_f_min(s[0], low);
        gaps[1] = -eng_f_max(s[0], high);
    } else {
        gaps[0] = low - eng_f_max(s[0], zero);
        gaps[1] = eng_f_min(s[0], zero) - high;
    }
}

/* Do x, y and z together leave no time? */
ENG_INLINE uint32_t never_within(enum pccd_kind kind, const struct pairs *pairs, eng_f r)
{
    const eng_f zero = {0};
    struct span span = {zero, zero + 1, zero - 1, zero - 1};
    eng_f least = r + (CELLS + ROUNDED * pairs->size);
#pragma GCC unroll 3
    for (int axis = 0; axis < 3; axis++) {
        eng_f gaps[2][2];
#pragma GCC unroll 2
        for (int end = 0; end < 2; end++) {
            const struct vector *d = pairs->d[end];
            eng_f s[3];
#pragma GCC unroll 3
            for (int k = 0; k < 3; k++) {
                s[k] = axis == 0 ? d[k].x : axis == 1 ? d[k].y : d[k].z;
            }
            gaps_along(kind, s, gaps[end]);
            gaps[end][0] -= least;
            gaps[end][1] -= least;
        }
        cut(&span, gaps[0], gaps[1]);
    }
    return eng_fm_bits(
        eng_f_less(span.from_n * span.to_d, span.to_n * span.from_d * SLACK));
}

/* Beyond r along x+-y, y+-z or z+-x? Diagonals are sqrt(2) long: the factor is more. */
ENG_INLINE uint32_t beyond_by_diagonals(enum pccd_kind kind, const struct pairs *pairs,
                                        eng_f r)
{
    eng_f widest = -0x1.6a09e8p0f * r;
    eng_f least = 0x1.6a09e8p0f * r + (CELLS + ROUNDED * pairs->size);
#pragma GCC unroll 6
    for (int direction = 0; direction < 6; direction++) {
        eng_f gaps[2][2];
        int plane = direction / 2;
#pragma GCC unroll 2
        for (int end = 0; end < 2; end++) {
            eng_f s[3];
#pragma GCC unroll 3
            for (int k = 0; k < 3; k++) {
                struct vector d = pairs->d[end][k];
                eng_f first = plane == 0 ? d.x : plane == 1 ? d.y : d.z;
                eng_f second = plane == 0 ? d.y : plane == 1 ? d.z : d.x;
                s[k] = direction % 2 ? first - second : first + second;
            }
            gaps_along(kind, s, gaps[end]);
        }
        widest = eng_f_max(widest, eng_f_min(gaps[0][0], gaps[1][0]));
        widest = eng_f_max(widest, eng_f_min(gaps[0][1], gaps[1][1]));
    }
    return eng_fm_bits(eng_f_less(least, widest));
}

/* Do the planes across both features, which turn with them, stay farther apart than r, on
 * one side? w . n, n = u x v, by its Bernstein coefficients, those in the middle three
 * times; and what of it is certainly at most r |n|. */
ENG_INLINE uint32_t beyond_by_planes(const struct pairs *pairs, eng_f r)
{
    const struct vector *u = pairs->u;
    const struct vector *v = pairs->v;
    const struct vector *w = pairs->w;
    struct vector n[3] = {cross(u[0], v[0]), add(cross(u[0], v[1]), cross(u[1], v[0])),
                          cross(u[1], v[1])};
    eng_f a = reach(w[0], w[1]);
    eng_f b = reach(u[0], u[1]);
    eng_f c = reach(v[0], v[1]);
    eng_f area = 24 * U24 * (b * c) + 6 * (b + c); /* more than n[..] is off by */
    eng_f margin = 72 * U24 * (a * b * c) + 7 * (a * b + (a + b) * c);
    eng_f most[3];
#pragma GCC unroll 3
    for (int i = 0; i < 3; i++) {
        most[i] = r * (eng_f_sqrt(dot(n[i], n[i])) + 2 * area);
    }
    eng_f value[4] = {dot(w[0], n[0]), dot(w[0], n[1]) + dot(w[1], n[0]),
                      dot(w[1], n[1]) + dot(w[0], n[2]), dot(w[1], n[2])};
    eng_f least[4] = {most[0] + margin, most[0] + most[1] + 3 * margin,
                      most[1] + most[2] + 3 * margin, most[2] + margin};
    eng_fm above = eng_f_less(least[0], value[0]);
    eng_fm below = eng_f_less(value[0], -least[0]);
#pragma GCC unroll 3
    for (int i = 1; i < 4; i++) {
        above = eng_fm_and(above, eng_f_less(least[i], value[i]));
        below = eng_fm_and(below, eng_f_less(value[i], -least[i]));
    }
    return eng_fm_bits(eng_fm_or(above, below));
}

enum tests { PLANES = 1, TIME = 2, DIAGONALS = 4 };

/* The pairs that none of `tests` rejects move to the front; returns how many. *gone: how
 * many the first of the tests, of this order, has rejected. */
ENG_INLINE uint32_t pass(enum pccd_kind kind, enum tests tests,
                         const struct eng_sieve *sieve, float r, uint32_t *a, uint32_t *b,
                         uint32_t count, uint32_t *gone)
{
    uint32_t kept = 0;
    *gone = 0;
    for (uint32_t i = 0; i < count; i += ENG_F_LANES) {
        uint32_t n = count - i < ENG_F_LANES ? count - i : ENG_F_LANES;
        uint32_t lanes = ENG_F_ALL >> (ENG_F_LANES - n);
        struct eng_g d[2][3];
        load(kind, sieve, a + i, b + i, n, d);
        struct pairs pairs = pairs_of(kind, d);
        uint32_t out = tests & PLANES ? beyond_by_planes(&pairs, eng_f_all(r))
                       : tests & TIME ? never_within(kind, &pairs, eng_f_all(r))
                                      : 0;
        *gone += (uint32_t)__builtin_popcount(out & lanes);
        if (tests & DIAGONALS) {
            out |= beyond_by_diagonals(kind, &pairs, eng_f_all(r));
        }
        kept += eng_keep_both(a + kept, b + kept, a + i, b + i, lanes & ~out);
    }
    return kept;
}

/* As sift.c does: what rejects more goes first. */
ENG_INLINE uint32_t sift(enum pccd_kind kind, struct eng_sieve *sieve, float reach_cells,
                         uint32_t *a, uint32_t *b, uint32_t count)
{
    const float r = reach_cells * (1 + 32 * U24);
    uint32_t first;
    uint32_t second;
    uint32_t left;
    uint32_t kept;
    if (sieve->in_time) {
        left = pass(kind, PLANES, sieve, r, a, b, count, &first);
        return pass(kind, DIAGONALS, sieve, r, a, b, left, &second);
    }
    if (sieve->cubic_first) {
        left = pass(kind, PLANES, sieve, r, a, b, count, &first);
        kept = pass(kind, TIME | DIAGONALS, sieve, r, a, b, left, &second);
    } else {
        left = pass(kind, TIME, sieve, r, a, b, count, &first);
        kept = pass(kind, PLANES | DIAGONALS, sieve, r, a, b, left, &second);
    }
    if ((uint64_t)second * count > (uint64_t)first * left) {
        sieve->cubic_first = !sieve->cubic_first;
    }
    return kept;
}

uint32_t ENG_KERNEL(sift_thick)(enum pccd_kind kind, struct eng_sieve *sieve, float reach,
                                uint32_t *a, uint32_t *b, uint32_t count)
{
    return kind == PCCD_VF ? sift(PCCD_VF, sieve, reach, a, b, count)
                           : sift(PCCD_EE, sieve, reach, a, b, count);
}
