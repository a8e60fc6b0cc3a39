/* lanes_vector.h - the version of lanes.h for SSE 4.2, AVX2 and NEON: a mask is a vector
 * of all-ones and zeros.
 *
 * Threads: [any]; inline only.
 */
#ifndef ENG_LANES_VECTOR_H
#define ENG_LANES_VECTOR_H

#include "lane_types.h"

#if ENG_VECTOR_BYTES > 8 && ENG_VECTOR_BYTES < 64 /* so that the header compiles alone */

typedef eng_di eng_dm;
typedef eng_fi eng_fm;

ENG_INLINE eng_dm eng_d_less(eng_d a, eng_d b)
{
    return a < b;
}

ENG_INLINE eng_dm eng_d_at_most(eng_d a, eng_d b)
{
    return a <= b;
}

ENG_INLINE eng_fm eng_f_less(eng_f a, eng_f b)
{
    return a < b;
}

ENG_INLINE eng_dm eng_dm_and(eng_dm a, eng_dm b)
{
    return a & b;
}

ENG_INLINE eng_dm eng_dm_or(eng_dm a, eng_dm b)
{
    return a | b;
}

ENG_INLINE eng_dm eng_dm_not(eng_dm a)
{
    return ~a;
}

ENG_INLINE eng_fm eng_fm_and(eng_fm a, eng_fm b)
{
    return a & b;
}

ENG_INLINE eng_fm eng_fm_or(eng_fm a, eng_fm b)
{
    return a | b;
}

ENG_INLINE uint32_t eng_dm_bits(eng_dm m)
{
#if ENG_VECTOR_BYTES == 32
    return (uint32_t)_mm256_movemask_pd((__m256d)m);
#elif defined __SSE2__ && ENG_VECTOR_BYTES == 16
    return (uint32_t)_mm_movemask_pd((__m128d)m);
#else
    uint32_t bits = 0;
    for (unsigned i = 0; i < ENG_D_LANES; i++) {
        bits |= (m[i] ? 1u : 0u) << i;
    }
    return bits;
#endif
}

ENG_INLINE uint32_t eng_fm_bits(eng_fm m)
{
#if ENG_VECTOR_BYTES == 32
    return (uint32_t)_mm256_movemask_ps((__m256)m);
#elif defined __SSE2__ && ENG_VECTOR_BYTES == 16
    return (uint32_t)_mm_movemask_ps((__m128)m);
#else
    uint32_t bits = 0;
    for (unsigned i = 0; i < ENG_F_LANES; i++) {
        bits |= (m[i] ? 1u : 0u) << i;
    }
    return bits;
#endif
}

ENG_INLINE eng_d eng_d_select(eng_dm m, eng_d a, eng_d b)
{
    return (eng_d)((m & (eng_di)a) | (~m & (eng_di)b));
}

ENG_INLINE eng_d eng_d_min(eng_d a, eng_d b)
{
#if ENG_VECTOR_BYTES == 32
    return (eng_d)_mm256_min_pd((__m256d)a, (__m256d)b);
#elif defined __SSE2__ && ENG_VECTOR_BYTES == 16
    return (eng_d)_mm_min_pd((__m128d)a, (__m128d)b);
#else
    return eng_d_select(a < b, a, b);
#endif
}

ENG_INLINE eng_d eng_d_max(eng_d a, eng_d b)
{
#if ENG_VECTOR_BYTES == 32
    return (eng_d)_mm256_max_pd((__m256d)a, (__m256d)b);
#elif defined __SSE2__ && ENG_VECTOR_BYTES == 16
    return (eng_d)_mm_max_pd((__m128d)a, (__m128d)b);
#else
    return eng_d_select(a > b, a, b);
#endif
}

/* The larger magnitude. */
ENG_INLINE eng_d eng_d_max_abs(eng_d a, eng_d b)
{
    return eng_d_max((eng_d)((eng_di)a & INT64_MAX), (eng_d)((eng_di)b & INT64_MAX));
}

ENG_INLINE eng_f eng_f_select(eng_fm m, eng_f a, eng_f b)
{
    return (eng_f)((m & (eng_fi)a) | (~m & (eng_fi)b));
}

ENG_INLINE eng_f eng_f_max(eng_f a, eng_f b)
{
#if ENG_VECTOR_BYTES == 32
    return (eng_f)_mm256_max_ps((__m256)a, (__m256)b);
#elif defined __SSE2__ && ENG_VECTOR_BYTES == 16
    return (eng_f)_mm_max_ps((__m128)a, (__m128)b);
#else
    return eng_f_select(a > b, a, b);
#endif
}

ENG_INLINE eng_f eng_f_min(eng_f a, eng_f b)
{
#if ENG_VECTOR_BYTES == 32
    return (eng_f)_mm256_min_ps((__m256)a, (__m256)b);
#elif defined __SSE2__ && ENG_VECTOR_BYTES == 16
    return (eng_f)_mm_min_ps((__m128)a, (__m128)b);
#else
    return eng_f_select(a < b, a, b);
#endif
}

ENG_INLINE eng_f eng_f_max_abs(eng_f a, eng_f b)
{
    return eng_f_max((eng_f)((eng_fi)a & INT32_MAX), (eng_f)((eng_fi)b & INT32_MAX));
}

ENG_INLINE eng_fi eng_fi_min(eng_fi a, eng_fi b)
{
#if ENG_VECTOR_BYTES == 32
    return (eng_fi)_mm256_min_epi32((__m256i)a, (__m256i)b);
#elif defined __SSE4_1__ && ENG_VECTOR_BYTES == 16
    return (eng_fi)_mm_min_epi32((__m128i)a, (__m128i)b);
#else
    eng_fi less = a < b;
    return (less & a) | (~less & b);
#endif
}

ENG_INLINE eng_fi eng_fi_max(eng_fi a, eng_fi b)
{
#if ENG_VECTOR_BYTES == 32
    return (eng_fi)_mm256_max_epi32((__m256i)a, (__m256i)b);
#elif defined __SSE4_1__ && ENG_VECTOR_BYTES == 16
    return (eng_fi)_mm_max_epi32((__m128i)a, (__m128i)b);
#else
    eng_fi more = a > b;
    return (more & a) | (~more & b);
#endif
}

ENG_INLINE eng_d eng_d_sqrt(eng_d a)
{
#if ENG_VECTOR_BYTES == 32
    return (eng_d)_mm256_sqrt_pd((__m256d)a);
#elif defined __SSE2__ && ENG_VECTOR_BYTES == 16
    return (eng_d)_mm_sqrt_pd((__m128d)a);
#else
    for (unsigned i = 0; i < ENG_D_LANES; i++) {
        a[i] = __builtin_sqrt(a[i]);
    }
    return a;
#endif
}

ENG_INLINE eng_f eng_f_sqrt(eng_f a)
{
#if ENG_VECTOR_BYTES == 32
    return (eng_f)_mm256_sqrt_ps((__m256)a);
#elif defined __SSE2__ && ENG_VECTOR_BYTES == 16
    return (eng_f)_mm_sqrt_ps((__m128)a);
#else
    for (unsigned i = 0; i < ENG_F_LANES; i++) {
        a[i] = __builtin_sqrtf(a[i]);
    }
    return a;
#endif
}

#endif

#endif
