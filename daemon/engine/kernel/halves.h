/* halves.h - vector arithmetic on pairs of 16-bit numbers that share a 32-bit lane, for
 * quantised boxes.
 *
 * Threads: [any]; inline only. Included by files of this folder alone.
 */
#ifndef ENG_HALVES_H
#define ENG_HALVES_H

#include "lanes_pack.h"

#if defined __ARM_NEON && ENG_VECTOR_BYTES == 16
#include <arm_neon.h>
#endif

ENG_INLINE int32_t quantised_clamped(int32_t x)
{
    return x < INT16_MIN ? INT16_MIN : x > INT16_MAX ? INT16_MAX : x;
}

/* a + b of each half, saturated. */
ENG_INLINE eng_fi eng_fi_add_halves(eng_fi a, eng_fi b)
{
#if ENG_VECTOR_BYTES == 64
    return (eng_fi)_mm512_adds_epi16((__m512i)a, (__m512i)b);
#elif ENG_VECTOR_BYTES == 32
    return (eng_fi)_mm256_adds_epi16((__m256i)a, (__m256i)b);
#elif defined __SSE2__ && ENG_VECTOR_BYTES == 16
    return (eng_fi)_mm_adds_epi16((__m128i)a, (__m128i)b);
#elif defined __ARM_NEON && ENG_VECTOR_BYTES == 16
    return (eng_fi)vqaddq_s16((int16x8_t)a, (int16x8_t)b);
#else
    for (uint32_t i = 0; i < ENG_F_LANES; i++) {
        int32_t low = quantised_clamped((int16_t)a[i] + (int16_t)b[i]);
        int32_t high = quantised_clamped((a[i] >> 16) + (b[i] >> 16));
        a[i] = (int32_t)((uint32_t)high << 16 | (uint16_t)low);
    }
    return a;
#endif
}

/* The larger of each half. */
ENG_INLINE eng_fi eng_fi_max_halves(eng_fi a, eng_fi b)
{
#if ENG_VECTOR_BYTES == 64
    return (eng_fi)_mm512_max_epi16((__m512i)a, (__m512i)b);
#elif ENG_VECTOR_BYTES == 32
    return (eng_fi)_mm256_max_epi16((__m256i)a, (__m256i)b);
#elif defined __SSE2__ && ENG_VECTOR_BYTES == 16
    return (eng_fi)_mm_max_epi16((__m128i)a, (__m128i)b);
#elif defined __ARM_NEON && ENG_VECTOR_BYTES == 16
    return (eng_fi)vmaxq_s16((int16x8_t)a, (int16x8_t)b);
#else
    for (uint32_t i = 0; i < ENG_F_LANES; i++) {
        int16_t low = (int16_t)a[i] > (int16_t)b[i] ? (int16_t)a[i] : (int16_t)b[i];
        int32_t high = a[i] >> 16 > b[i] >> 16 ? a[i] >> 16 : b[i] >> 16;
        a[i] = (int32_t)((uint32_t)high << 16 | (uint16_t)low);
    }
    return a;
#endif
}

/* Of each half: `grown`, but INT16_MIN where a is that. */
ENG_INLINE eng_fi eng_fi_keep_least_halves(eng_fi a, eng_fi grown)
{
#if ENG_VECTOR_BYTES == 64
    const __m512i least = _mm512_set1_epi16(INT16_MIN);
    return (eng_fi)_mm512_mask_mov_epi16(
        (__m512i)grown, _mm512_cmpeq_epi16_mask((__m512i)a, least), least);
#elif ENG_VECTOR_BYTES == 32
    const __m256i least = _mm256_set1_epi16(INT16_MIN);
    return (eng_fi)_mm256_blendv_epi8((__m256i)grown, least,
                                      _mm256_cmpeq_epi16((__m256i)a, least));
#elif defined __SSE2__ && ENG_VECTOR_BYTES == 16
    const __m128i least = _mm_set1_epi16(INT16_MIN);
    __m128i is_least = _mm_cmpeq_epi16((__m128i)a, least);
    return (eng_fi)_mm_or_si128(_mm_and_si128(is_least, least),
                                _mm_andnot_si128(is_least, (__m128i)grown));
#elif defined __ARM_NEON && ENG_VECTOR_BYTES == 16
    const int16x8_t least = vdupq_n_s16(INT16_MIN);
    return (eng_fi)vbslq_s16(vceqq_s16((int16x8_t)a, least), least, (int16x8_t)grown);
#else
    for (uint32_t i = 0; i < ENG_F_LANES; i++) {
        int32_t low = (int16_t)a[i] == INT16_MIN ? INT16_MIN : (int16_t)grown[i];
        int32_t high = a[i] >> 16 == INT16_MIN ? INT16_MIN : grown[i] >> 16;
        a[i] = (int32_t)((uint32_t)high << 16 | (uint16_t)low);
    }
    return a;
#endif
}

/* a w / 2^15 of each half, the nearest, up where two are; 0 <= w. */
ENG_INLINE eng_fi eng_fi_weigh_halves(eng_fi a, int16_t w)
{
#if ENG_VECTOR_BYTES == 64
    return (eng_fi)_mm512_mulhrs_epi16((__m512i)a, _mm512_set1_epi16(w));
#elif ENG_VECTOR_BYTES == 32
    return (eng_fi)_mm256_mulhrs_epi16((__m256i)a, _mm256_set1_epi16(w));
#elif defined __SSSE3__ && ENG_VECTOR_BYTES == 16
    return (eng_fi)_mm_mulhrs_epi16((__m128i)a, _mm_set1_epi16(w));
#elif defined __ARM_NEON && ENG_VECTOR_BYTES == 16
    return (eng_fi)vqrdmulhq_n_s16((int16x8_t)a, w);
#else
    for (uint32_t i = 0; i < ENG_F_LANES; i++) {
        int32_t low = ((int16_t)a[i] * w + 0x4000) >> 15;
        int32_t high = ((a[i] >> 16) * w + 0x4000) >> 15;
        a[i] = (int32_t)((uint32_t)high << 16 | (uint16_t)low);
    }
    return a;
#endif
}

/* The sum of the two halves of each lane, in all of its bits. */
ENG_INLINE eng_fi eng_fi_sum_halves(eng_fi a)
{
#if ENG_VECTOR_BYTES == 64
    return (eng_fi)_mm512_madd_epi16((__m512i)a, _mm512_set1_epi16(1));
#elif ENG_VECTOR_BYTES == 32
    return (eng_fi)_mm256_madd_epi16((__m256i)a, _mm256_set1_epi16(1));
#elif defined __SSE2__ && ENG_VECTOR_BYTES == 16
    return (eng_fi)_mm_madd_epi16((__m128i)a, _mm_set1_epi16(1));
#elif defined __ARM_NEON && ENG_VECTOR_BYTES == 16
    return (eng_fi)vpaddlq_s16((int16x8_t)a);
#else
    for (uint32_t i = 0; i < ENG_F_LANES; i++) {
        a[i] = (int16_t)a[i] + (a[i] >> 16);
    }
    return a;
#endif
}

/* The halves of each lane change places. */
ENG_INLINE eng_fi eng_fi_turn_halves(eng_fi a)
{
#if ENG_VECTOR_BYTES == 64
    return (eng_fi)_mm512_rol_epi32((__m512i)a, 16);
#else
    return (a << 16) | ((a >> 16) & 0xffff);
#endif
}

/* Lanes of which no half is negative. */
ENG_INLINE eng_left eng_left_of_halves(eng_fi v)
{
#if ENG_VECTOR_BYTES == 64
    return _mm512_testn_epi32_mask((__m512i)v, _mm512_set1_epi32((int)0x80008000u));
#else
    return v | (v << 16);
#endif
}

#endif
