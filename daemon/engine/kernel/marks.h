/* marks.h - loads points that were rounded to a grid (marks), several at once, for the
 * sieve.
 *
 * Threads: [any]; inline only. Included by files of this folder alone.
 */
#ifndef ENG_MARKS_H
#define ENG_MARKS_H

#include "kernel.h"
#include "lanes_pack.h"
#include "query.h"

/* ---- turning marks as they lie in memory ----------------------------------------- */

/* Turn points that were rounded to a grid (marks), as they lie in memory,
 * to a vector for each coordinate. */

/* Three whole numbers in every lane. */
struct eng_g {
    eng_fi x, y, z;
};

#if ENG_VECTOR_BYTES >= 32

ENG_INLINE __m256i eng_marks_one(const struct eng_mark *mark)
{
    return _mm256_load_si256((const __m256i *)(const void *)mark);
}

ENG_INLINE __m256i eng_marks_ends(const int32_t *low, const int32_t *high)
{
    return _mm256_inserti128_si256(
        _mm256_castsi128_si256(_mm_load_si128((const __m128i *)(const void *)low)),
        _mm_load_si128((const __m128i *)(const void *)high), 1);
}

#endif

#if ENG_VECTOR_BYTES == 64

ENG_INLINE __m512i eng_marks_two(const struct eng_mark *first,
                                 const struct eng_mark *second)
{
    return _mm512_inserti64x4(
        _mm512_castsi256_si512(_mm256_load_si256((const __m256i *)(const void *)first)),
        _mm256_load_si256((const __m256i *)(const void *)second), 1);
}

/* Turn records x0 y0 z0 word x1 y1 z1 word of four times two pairs into x, y, z. */
ENG_INLINE void eng_marks_turn(const __m512i a[4], __m512i out[3])
{
    __m512i xy01 = _mm512_unpacklo_epi32(a[0], a[1]);
    __m512i xy23 = _mm512_unpacklo_epi32(a[2], a[3]);
    __m512i zw01 = _mm512_unpackhi_epi32(a[0], a[1]);
    __m512i zw23 = _mm512_unpackhi_epi32(a[2], a[3]);
    out[0] = _mm512_unpacklo_epi64(xy01, xy23);
    out[1] = _mm512_unpackhi_epi64(xy01, xy23);
    out[2] = _mm512_unpacklo_epi64(zw01, zw23);
}

/* Turn the records of sixteen pairs at one end: 0, 4, 8, 12 in the first, and so on. */
ENG_INLINE struct eng_g eng_marks_turn_at(const eng_fi a[4])
{
    __m512i in[4] = {(__m512i)a[0], (__m512i)a[1], (__m512i)a[2], (__m512i)a[3]};
    __m512i out[3];
    eng_marks_turn(in, out);
    return (struct eng_g){(eng_fi)out[0], (eng_fi)out[1], (eng_fi)out[2]};
}

/* Return the fourth number, behind x, y, z. */
ENG_INLINE eng_fi eng_marks_fourth(const eng_fi a[4])
{
    __m512i zw01 = _mm512_unpackhi_epi32((__m512i)a[0], (__m512i)a[1]);
    __m512i zw23 = _mm512_unpackhi_epi32((__m512i)a[2], (__m512i)a[3]);
    return (eng_fi)_mm512_unpackhi_epi64(zw01, zw23);
}

#elif ENG_VECTOR_BYTES == 32

ENG_INLINE struct eng_g eng_marks_turn(const __m256i a[4])
{
    __m256i xy01 = _mm256_unpacklo_epi32(a[0], a[1]);
    __m256i xy23 = _mm256_unpacklo_epi32(a[2], a[3]);
    __m256i zw01 = _mm256_unpackhi_epi32(a[0], a[1]);
    __m256i zw23 = _mm256_unpackhi_epi32(a[2], a[3]);
    return (struct eng_g){(eng_fi)_mm256_unpacklo_epi64(xy01, xy23),
                          (eng_fi)_mm256_unpackhi_epi64(xy01, xy23),
                          (eng_fi)_mm256_unpacklo_epi64(zw01, zw23)};
}

ENG_INLINE struct eng_g eng_marks_turn_at(const eng_fi a[4])
{
    const __m256i in[4] = {(__m256i)a[0], (__m256i)a[1], (__m256i)a[2], (__m256i)a[3]};
    return eng_marks_turn(in);
}

ENG_INLINE eng_fi eng_marks_fourth(const eng_fi a[4])
{
    __m256i zw01 = _mm256_unpackhi_epi32((__m256i)a[0], (__m256i)a[1]);
    __m256i zw23 = _mm256_unpackhi_epi32((__m256i)a[2], (__m256i)a[3]);
    return (eng_fi)_mm256_unpackhi_epi64(zw01, zw23);
}

#elif ENG_VECTOR_BYTES == 16

ENG_INLINE struct eng_g eng_marks_turn_at(const eng_fi r[4])
{
    eng_fi xy01 = __builtin_shufflevector(r[0], r[1], 0, 4, 1, 5);
    eng_fi xy23 = __builtin_shufflevector(r[2], r[3], 0, 4, 1, 5);
    eng_fi zw01 = __builtin_shufflevector(r[0], r[1], 2, 6, 3, 7);
    eng_fi zw23 = __builtin_shufflevector(r[2], r[3], 2, 6, 3, 7);
    return (struct eng_g){__builtin_shufflevector(xy01, xy23, 0, 1, 4, 5),
                          __builtin_shufflevector(xy01, xy23, 2, 3, 6, 7),
                          __builtin_shufflevector(zw01, zw23, 0, 1, 4, 5)};
}

ENG_INLINE eng_fi eng_marks_fourth(const eng_fi r[4])
{
    eng_fi zw01 = __builtin_shufflevector(r[0], r[1], 2, 6, 3, 7);
    eng_fi zw23 = __builtin_shufflevector(r[2], r[3], 2, 6, 3, 7);
    return __builtin_shufflevector(zw01, zw23, 2, 3, 6, 7);
}

#endif

/* ---- pairs of marks -------------------------------------------------------------- */

/* The points of a pair: those of its first feature before the others, of EF a corner of
 * the face before all. */
struct eng_corners {
    const struct eng_mark *mark[5];
};

ENG_INLINE struct eng_corners eng_corners_of(uint32_t kind, const struct eng_sieve *sieve,
                                             uint32_t a, uint32_t b)
{
    const struct eng_mark *marks = sieve->marks;
    if (kind == PCCD_EF) {
        return (struct eng_corners){
            {&marks[sieve->b_corner[0][b]], &marks[sieve->a_corner[0][a]],
             &marks[sieve->a_corner[1][a]], &marks[sieve->b_corner[1][b]],
             &marks[sieve->b_corner[2][b]]}};
    }
    if (kind == PCCD_VF) {
        return (struct eng_corners){{&marks[a], &marks[sieve->b_corner[0][b]],
                                     &marks[sieve->b_corner[1][b]],
                                     &marks[sieve->b_corner[2][b]]}};
    }
    return (struct eng_corners){
        {&marks[sieve->a_corner[0][a]], &marks[sieve->a_corner[1][a]],
         &marks[sieve->b_corner[0][b]], &marks[sieve->b_corner[1][b]]}};
}

/* Copy a group of pairs to `full`; one that is short of pairs repeats its first. */
ENG_INLINE void eng_marks_fill(const uint32_t *a, const uint32_t *b, uint32_t n,
                               uint32_t full[2][ENG_F_LANES])
{
    for (uint32_t lane = 0; lane < ENG_F_LANES; lane++) {
        full[0][lane] = a[lane < n ? lane : 0];
        full[1][lane] = b[lane < n ? lane : 0];
    }
}

/* d[end][k] of pairs 0 .. ENG_F_LANES - 1: the marks 1, 2, 3 minus mark 0. No difference
 * overflows (kernel.h). */
#if ENG_VECTOR_BYTES == 64

ENG_INLINE void eng_marks_load(enum pccd_kind kind, const struct eng_sieve *sieve,
                               const uint32_t *a, const uint32_t *b, struct eng_g d[2][3])
{
    __m512i halves[2][3][3];
#pragma GCC unroll 2
    for (int half = 0; half < 2; half++) {
        __m512i v[3][4];
#pragma GCC unroll 4
        for (int i = 0; i < 4; i++) {
            int lane = 8 * half + i;
            struct eng_corners p = eng_corners_of(kind, sieve, a[lane], b[lane]);
            struct eng_corners q = eng_corners_of(kind, sieve, a[lane + 4], b[lane + 4]);
            __m512i from = eng_marks_two(p.mark[0], q.mark[0]);
#pragma GCC unroll 3
            for (int k = 0; k < 3; k++) {
                v[k][i] =
                    _mm512_sub_epi32(eng_marks_two(p.mark[k + 1], q.mark[k + 1]), from);
            }
        }
#pragma GCC unroll 3
        for (int k = 0; k < 3; k++) {
            eng_marks_turn(v[k], halves[half][k]);
        }
    }
    /* The quarters of a half: four pairs at t = 0, at t = 1, the next four. */
#pragma GCC unroll 3
    for (int k = 0; k < 3; k++) {
        const __m512i *x = halves[0][k];
        const __m512i *y = halves[1][k];
        d[0][k].x = (eng_fi)_mm512_shuffle_i32x4(x[0], y[0], 0x88);
        d[1][k].x = (eng_fi)_mm512_shuffle_i32x4(x[0], y[0], 0xdd);
        d[0][k].y = (eng_fi)_mm512_shuffle_i32x4(x[1], y[1], 0x88);
        d[1][k].y = (eng_fi)_mm512_shuffle_i32x4(x[1], y[1], 0xdd);
        d[0][k].z = (eng_fi)_mm512_shuffle_i32x4(x[2], y[2], 0x88);
        d[1][k].z = (eng_fi)_mm512_shuffle_i32x4(x[2], y[2], 0xdd);
    }
}

#elif ENG_VECTOR_BYTES == 32

/* Load four pairs, with both ends in a vector: t = 0 in its first half. One record is one
 * load then, and what is computed at both ends is computed once. */
ENG_INLINE void eng_marks_load_four(enum pccd_kind kind, const struct eng_sieve *sieve,
                                    const uint32_t *a, const uint32_t *b,
                                    struct eng_g d[3])
{
    __m256i from[4];
#pragma GCC unroll 4
    for (int i = 0; i < 4; i++) {
        from[i] = eng_marks_one(eng_corners_of(kind, sieve, a[i], b[i]).mark[0]);
    }
#pragma GCC unroll 3
    for (int k = 0; k < 3; k++) {
        __m256i v[4];
#pragma GCC unroll 4
        for (int i = 0; i < 4; i++) {
            const struct eng_mark *to =
                eng_corners_of(kind, sieve, a[i], b[i]).mark[k + 1];
            v[i] = _mm256_sub_epi32(eng_marks_one(to), from[i]);
        }
        d[k] = eng_marks_turn(v);
    }
}

/* Return one end of both fours. */
ENG_INLINE eng_fi eng_marks_of_one_end(eng_fi first, eng_fi second, int end)
{
    return end ? (eng_fi)_mm256_permute2x128_si256((__m256i)first, (__m256i)second, 0x31)
               : (eng_fi)_mm256_permute2x128_si256((__m256i)first, (__m256i)second, 0x20);
}

ENG_INLINE void eng_marks_by_end(const struct eng_g fours[2][3], struct eng_g d[2][3])
{
#pragma GCC unroll 2
    for (int end = 0; end < 2; end++) {
#pragma GCC unroll 3
        for (int k = 0; k < 3; k++) {
            d[end][k].x = eng_marks_of_one_end(fours[0][k].x, fours[1][k].x, end);
            d[end][k].y = eng_marks_of_one_end(fours[0][k].y, fours[1][k].y, end);
            d[end][k].z = eng_marks_of_one_end(fours[0][k].z, fours[1][k].z, end);
        }
    }
}

ENG_INLINE void eng_marks_load(enum pccd_kind kind, const struct eng_sieve *sieve,
                               const uint32_t *a, const uint32_t *b, struct eng_g d[2][3])
{
    struct eng_g fours[2][3];
    eng_marks_load_four(kind, sieve, a, b, fours[0]);
    eng_marks_load_four(kind, sieve, a + 4, b + 4, fours[1]);
    eng_marks_by_end(fours, d);
}

#elif ENG_VECTOR_BYTES == 16

ENG_INLINE void eng_marks_load(enum pccd_kind kind, const struct eng_sieve *sieve,
                               const uint32_t *a, const uint32_t *b, struct eng_g d[2][3])
{
    eng_fi v[2][3][4];
#pragma GCC unroll 4
    for (int i = 0; i < 4; i++) {
        struct eng_corners p = eng_corners_of(kind, sieve, a[i], b[i]);
        eng_fi from0 = eng_fi_of(p.mark[0]->q0);
        eng_fi from1 = eng_fi_of(p.mark[0]->q1);
#pragma GCC unroll 3
        for (int k = 0; k < 3; k++) {
            v[0][k][i] = eng_fi_of(p.mark[k + 1]->q0) - from0;
            v[1][k][i] = eng_fi_of(p.mark[k + 1]->q1) - from1;
        }
    }
#pragma GCC unroll 3
    for (int k = 0; k < 3; k++) {
        d[0][k] = eng_marks_turn_at(v[0][k]);
        d[1][k] = eng_marks_turn_at(v[1][k]);
    }
}

#else

ENG_INLINE void eng_marks_load(enum pccd_kind kind, const struct eng_sieve *sieve,
                               const uint32_t *a, const uint32_t *b, struct eng_g d[2][3])
{
    struct eng_corners p = eng_corners_of(kind, sieve, *a, *b);
    for (int k = 0; k < 3; k++) {
        const struct eng_mark *to = p.mark[k + 1];
        const struct eng_mark *from = p.mark[0];
        d[0][k] = (struct eng_g){{to->q0[0] - from->q0[0]},
                                 {to->q0[1] - from->q0[1]},
                                 {to->q0[2] - from->q0[2]}};
        d[1][k] = (struct eng_g){{to->q1[0] - from->q1[0]},
                                 {to->q1[1] - from->q1[1]},
                                 {to->q1[2] - from->q1[2]}};
    }
}

#endif

#endif
