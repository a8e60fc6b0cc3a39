/* points.h - loads the points of several pairs into vectors, one pair in each lane.
 *
 * Load the same point of as many pairs as there are lanes. A record is one cache line;
 * loading lines and transposing them takes half the time of gathering single numbers.
 *
 * Threads: [any]; inline only. Included by files of this folder alone.
 */
#ifndef ENG_POINTS_H
#define ENG_POINTS_H

#include "kernel.h"
#include "lanes.h"

/* Three numbers of each of ENG_D_LANES places; the fourth may be read too. */
#if ENG_VECTOR_BYTES == 64

ENG_INLINE eng_d eng_points_halves(const double *low, const double *high)
{
    return (eng_d)_mm512_insertf64x4(_mm512_castpd256_pd512(_mm256_loadu_pd(low)),
                                     _mm256_loadu_pd(high), 1);
}

ENG_INLINE struct eng_v eng_points_turn(const double *const at[ENG_D_LANES])
{
    const __m512i first = _mm512_setr_epi64(0, 1, 8, 9, 4, 5, 12, 13);
    const __m512i second = _mm512_setr_epi64(2, 3, 10, 11, 6, 7, 14, 15);
    __m512d a0 = (__m512d)eng_points_halves(at[0], at[4]);
    __m512d a1 = (__m512d)eng_points_halves(at[1], at[5]);
    __m512d a2 = (__m512d)eng_points_halves(at[2], at[6]);
    __m512d a3 = (__m512d)eng_points_halves(at[3], at[7]);
    __m512d xz01 = _mm512_unpacklo_pd(a0, a1);
    __m512d xz23 = _mm512_unpacklo_pd(a2, a3);
    __m512d y01 = _mm512_unpackhi_pd(a0, a1);
    __m512d y23 = _mm512_unpackhi_pd(a2, a3);
    return (struct eng_v){(eng_d)_mm512_permutex2var_pd(xz01, first, xz23),
                          (eng_d)_mm512_permutex2var_pd(y01, first, y23),
                          (eng_d)_mm512_permutex2var_pd(xz01, second, xz23)};
}

/* Turn the other way: out[lane] has that lane of each in[..]. */
ENG_INLINE void eng_points_turn_back(const eng_d in[8], eng_d out[8])
{
#pragma GCC unroll 2
    for (int odd = 0; odd < 2; odd++) {
        __m512d two[4]; /* numbers 2 k and 2 k + 1 of every second lane */
#pragma GCC unroll 4
        for (int k = 0; k < 4; k++) {
            __m512d a = (__m512d)in[2 * k];
            __m512d b = (__m512d)in[2 * k + 1];
            two[k] = odd ? _mm512_unpackhi_pd(a, b) : _mm512_unpacklo_pd(a, b);
        }
        __m512d low01 = _mm512_shuffle_f64x2(two[0], two[1], 0x44);
        __m512d high01 = _mm512_shuffle_f64x2(two[0], two[1], 0xee);
        __m512d low23 = _mm512_shuffle_f64x2(two[2], two[3], 0x44);
        __m512d high23 = _mm512_shuffle_f64x2(two[2], two[3], 0xee);
        out[odd] = (eng_d)_mm512_shuffle_f64x2(low01, low23, 0x88);
        out[odd + 2] = (eng_d)_mm512_shuffle_f64x2(low01, low23, 0xdd);
        out[odd + 4] = (eng_d)_mm512_shuffle_f64x2(high01, high23, 0x88);
        out[odd + 6] = (eng_d)_mm512_shuffle_f64x2(high01, high23, 0xdd);
    }
}

#elif ENG_VECTOR_BYTES == 32

/* Load two numbers of each place, into the halves. */
ENG_INLINE __m256d eng_points_halves(const double *low, const double *high)
{
    return _mm256_insertf128_pd(_mm256_castpd128_pd256(_mm_loadu_pd(low)),
                                _mm_loadu_pd(high), 1);
}

ENG_INLINE struct eng_v eng_points_turn(const double *const at[ENG_D_LANES])
{
    __m256d xy02 = eng_points_halves(at[0], at[2]);
    __m256d xy13 = eng_points_halves(at[1], at[3]);
    __m256d z02 = eng_points_halves(at[0] + 2, at[2] + 2);
    __m256d z13 = eng_points_halves(at[1] + 2, at[3] + 2);
    return (struct eng_v){(eng_d)_mm256_unpacklo_pd(xy02, xy13),
                          (eng_d)_mm256_unpackhi_pd(xy02, xy13),
                          (eng_d)_mm256_unpacklo_pd(z02, z13)};
}

#elif ENG_VECTOR_BYTES == 16

ENG_INLINE struct eng_v eng_points_turn(const double *const at[ENG_D_LANES])
{
    return (struct eng_v){
        {at[0][0], at[1][0]}, {at[0][1], at[1][1]}, {at[0][2], at[1][2]}};
}

#else

ENG_INLINE struct eng_v eng_points_turn(const double *const at[ENG_D_LANES])
{
    return (struct eng_v){at[0][0], at[0][1], at[0][2]};
}

#endif

/* The pairs in the lanes: points[quads[pairs[lane]][..]]. A group that is short of pairs
 * repeats its first. */
struct eng_group {
    const struct eng_point *points;
    const uint32_t *quad[ENG_D_LANES];
};

ENG_INLINE struct eng_group eng_group_of(const struct eng_point *points,
                                         const uint32_t (*quads)[4],
                                         const uint32_t *pairs, uint32_t count)
{
    struct eng_group group = {.points = points};
#pragma GCC unroll 8
    for (uint32_t lane = 0; lane < ENG_D_LANES; lane++) {
        group.quad[lane] = quads[pairs[lane < count ? lane : 0]];
    }
    return group;
}

/* The difference of two points as they lie in memory: x, y, z and, of the words behind
 * these, something without a meaning; at t = 0, then at t = 1. Four points have three
 * differences, and so there is less to turn. */
struct eng_difference {
    eng_d part[8 / ENG_D_LANES];
};

/* Return a less b. */
ENG_INLINE struct eng_difference eng_points_less(const struct eng_point *a,
                                                 const struct eng_point *b)
{
    struct eng_difference d;
    _Static_assert(sizeof d == sizeof *a, "of whole points");
#pragma GCC unroll 8
    for (int i = 0; i < 8 / ENG_D_LANES; i++) {
        d.part[i] = eng_d_load((const double *)(const void *)a + i * ENG_D_LANES) -
                    eng_d_load((const double *)(const void *)b + i * ENG_D_LANES);
    }
    return d;
}

/* Turn the differences of ENG_D_LANES pairs to a vector for each coordinate and end. */
ENG_INLINE void eng_differences_turn(const struct eng_difference d[ENG_D_LANES],
                                     struct eng_v out[2])
{
#if ENG_VECTOR_BYTES == 64
    __m512d xz[4]; /* of two pairs: x, z at t = 0, then at t = 1 */
    __m512d y[4];
#pragma GCC unroll 4
    for (int i = 0; i < 4; i++) {
        __m512d a = (__m512d)d[2 * i].part[0];
        __m512d b = (__m512d)d[2 * i + 1].part[0];
        xz[i] = _mm512_unpacklo_pd(a, b);
        y[i] = _mm512_unpackhi_pd(a, b);
    }
    __m512d xz0[2];
    __m512d xz1[2];
    __m512d y01[2];
#pragma GCC unroll 2
    for (int i = 0; i < 2; i++) {
        xz0[i] = _mm512_shuffle_f64x2(xz[2 * i], xz[2 * i + 1], 0x44);
        xz1[i] = _mm512_shuffle_f64x2(xz[2 * i], xz[2 * i + 1], 0xee);
        y01[i] = _mm512_shuffle_f64x2(y[2 * i], y[2 * i + 1], 0x88);
    }
    out[0].x = (eng_d)_mm512_shuffle_f64x2(xz0[0], xz0[1], 0x88);
    out[0].y = (eng_d)_mm512_shuffle_f64x2(y01[0], y01[1], 0x88);
    out[0].z = (eng_d)_mm512_shuffle_f64x2(xz0[0], xz0[1], 0xdd);
    out[1].x = (eng_d)_mm512_shuffle_f64x2(xz1[0], xz1[1], 0x88);
    out[1].y = (eng_d)_mm512_shuffle_f64x2(y01[0], y01[1], 0xdd);
    out[1].z = (eng_d)_mm512_shuffle_f64x2(xz1[0], xz1[1], 0xdd);
#else
    const int parts = 4 / ENG_D_LANES; /* of an end */
#pragma GCC unroll 2
    for (int end = 0; end < 2; end++) {
        const int at = end * parts;
#if ENG_VECTOR_BYTES == 32
        __m256d xz[2]; /* of two pairs */
        __m256d y[2];
#pragma GCC unroll 2
        for (int i = 0; i < 2; i++) {
            __m256d a = (__m256d)d[2 * i].part[at];
            __m256d b = (__m256d)d[2 * i + 1].part[at];
            xz[i] = _mm256_unpacklo_pd(a, b);
            y[i] = _mm256_unpackhi_pd(a, b);
        }
        out[end].x = (eng_d)_mm256_permute2f128_pd(xz[0], xz[1], 0x20);
        out[end].y = (eng_d)_mm256_permute2f128_pd(y[0], y[1], 0x20);
        out[end].z = (eng_d)_mm256_permute2f128_pd(xz[0], xz[1], 0x31);
#elif ENG_VECTOR_BYTES == 16
        out[end].x = __builtin_shufflevector(d[0].part[at], d[1].part[at], 0, 2);
        out[end].y = __builtin_shufflevector(d[0].part[at], d[1].part[at], 1, 3);
        out[end].z = __builtin_shufflevector(d[0].part[at + 1], d[1].part[at + 1], 0, 2);
#else
        out[end] = (struct eng_v){d->part[at], d->part[at + 1], d->part[at + 2]};
#endif
    }
#endif
}

/* Load the four points of each pair at both ends of the step: x[point][end]. */
ENG_INLINE void eng_group_load(const struct eng_group *group, struct eng_v x[4][2])
{
#pragma GCC unroll 4
    for (int corner = 0; corner < 4; corner++) {
        const double *at0[ENG_D_LANES];
        const double *at1[ENG_D_LANES];
#pragma GCC unroll 8
        for (uint32_t lane = 0; lane < ENG_D_LANES; lane++) {
            const struct eng_point *point = &group->points[group->quad[lane][corner]];
            at0[lane] = point->x0;
            at1[lane] = point->x1;
        }
        x[corner][0] = eng_points_turn(at0);
        x[corner][1] = eng_points_turn(at1);
    }
}

/* Load the four points of each pair at one end, 0 or 1. */
ENG_INLINE void eng_group_load_end(const struct eng_group *group, uint32_t end,
                                   struct eng_v x[4])
{
#pragma GCC unroll 4
    for (int corner = 0; corner < 4; corner++) {
        const double *at[ENG_D_LANES];
#pragma GCC unroll 8
        for (uint32_t lane = 0; lane < ENG_D_LANES; lane++) {
            const struct eng_point *point = &group->points[group->quad[lane][corner]];
            at[lane] = end == 0 ? point->x0 : point->x1;
        }
        x[corner] = eng_points_turn(at);
    }
}

/* Append those of pairs[0 .. n-1] whose bit is set to `kept`, which may be a part of
 * `pairs` at or before it; returns how many. */
ENG_INLINE uint32_t eng_compress(uint32_t *kept, const uint32_t *pairs, uint32_t n,
                                 uint32_t bits)
{
    uint32_t count = 0;
#if ENG_VECTOR_BYTES == 64
    if (n == ENG_D_LANES) {
        __m256i in = _mm256_loadu_si256((const __m256i *)(const void *)pairs);
        _mm256_storeu_si256((__m256i *)(void *)kept,
                            _mm256_maskz_compress_epi32((__mmask8)bits, in));
        return (uint32_t)__builtin_popcount(bits);
    }
#endif
    for (uint32_t lane = 0; lane < n; lane++) {
        kept[count] = pairs[lane];
        count += bits >> lane & 1u;
    }
    return count;
}

#endif
