/* marks_turn.h - turns points that were rounded to a grid (marks), as they lie in memory,
 * to a vector for each coordinate.
 *
 * Threads: [any]; inline only. Included by files of this folder alone.
 */
#ifndef ENG_MARKS_TURN_H
#define ENG_MARKS_TURN_H

#include "lanes_pack.h"
#include "query.h"
#include "sieve.h"

/* Three whole numbers in every lane. */
struct eng_g {
    eng_fi x, y, z;
};

#if ENG_VECTOR_BYTES >= 32

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

/* Records x0 y0 z0 word x1 y1 z1 word of four times two pairs, to x, y, z. */
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

/* The same of sixteen pairs at one end: 0, 4, 8, 12 in the first, and so on. */
ENG_INLINE struct eng_g eng_marks_turn_at(const eng_fi a[4])
{
    __m512i in[4] = {(__m512i)a[0], (__m512i)a[1], (__m512i)a[2], (__m512i)a[3]};
    __m512i out[3];
    eng_marks_turn(in, out);
    return (struct eng_g){(eng_fi)out[0], (eng_fi)out[1], (eng_fi)out[2]};
}

/* What is behind x, y, z. */
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

#endif
