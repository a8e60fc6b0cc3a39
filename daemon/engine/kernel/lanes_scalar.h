/* lanes_scalar.h - the version of lanes.h without vectors: one number at a time, the
 * reference for all others.
 *
 * Define what lanes.h promises. Numbers stay in the registers for numbers, masks
 * included: vectors of one integer would travel to the other registers and back.
 *
 * Threads: [any]; inline only.
 */
#ifndef ENG_LANES_SCALAR_H
#define ENG_LANES_SCALAR_H

#include "lane_types.h"

#if ENG_VECTOR_BYTES == 8 /* so that the header compiles alone */

/* gcc 12 (tree-vrp) takes what a comparison of one-lane vectors gives for 0 or 1, not for
 * 0 or -1, and then drops operations on it: the lanes are compared as numbers. */

#ifdef __SSE2__

/* All bits of the low half. */
typedef __m128d eng_dm;

ENG_INLINE __m128d eng_d_low(eng_d a)
{
    return _mm_set_sd(a);
}

ENG_INLINE eng_dm eng_d_less(eng_d a, eng_d b)
{
    return _mm_cmplt_sd(eng_d_low(a), eng_d_low(b));
}

ENG_INLINE eng_dm eng_d_at_most(eng_d a, eng_d b)
{
    return _mm_cmple_sd(eng_d_low(a), eng_d_low(b));
}

ENG_INLINE eng_dm eng_dm_and(eng_dm a, eng_dm b)
{
    return _mm_and_pd(a, b);
}

ENG_INLINE eng_dm eng_dm_or(eng_dm a, eng_dm b)
{
    return _mm_or_pd(a, b);
}

ENG_INLINE eng_dm eng_dm_not(eng_dm a)
{
    return _mm_xor_pd(a, _mm_castsi128_pd(_mm_set1_epi32(-1)));
}

ENG_INLINE uint32_t eng_dm_bits(eng_dm m)
{
    return (uint32_t)_mm_movemask_pd(m) & 1;
}

ENG_INLINE eng_d eng_d_select(eng_dm m, eng_d a, eng_d b)
{
    __m128d v = _mm_or_pd(_mm_and_pd(m, eng_d_low(a)), _mm_andnot_pd(m, eng_d_low(b)));
    return v[0];
}

#else

typedef uint32_t eng_dm; /* 0 or 1 */

ENG_INLINE eng_dm eng_d_less(eng_d a, eng_d b)
{
    return a < b;
}

ENG_INLINE eng_dm eng_d_at_most(eng_d a, eng_d b)
{
    return a <= b;
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
    return a ^ 1;
}

ENG_INLINE uint32_t eng_dm_bits(eng_dm m)
{
    return m;
}

ENG_INLINE eng_d eng_d_select(eng_dm m, eng_d a, eng_d b)
{
    return m ? a : b;
}

#endif

typedef eng_fi eng_fm;

ENG_INLINE eng_fm eng_f_less(eng_f a, eng_f b)
{
    return (eng_fm){-(int32_t)(a[0] < b[0])};
}

ENG_INLINE eng_fm eng_fm_and(eng_fm a, eng_fm b)
{
    return a & b;
}

ENG_INLINE eng_fm eng_fm_or(eng_fm a, eng_fm b)
{
    return a | b;
}

ENG_INLINE uint32_t eng_fm_bits(eng_fm m)
{
    return m[0] ? 1 : 0;
}

ENG_INLINE eng_d eng_d_min(eng_d a, eng_d b)
{
    return a < b ? a : b;
}

ENG_INLINE eng_d eng_d_max(eng_d a, eng_d b)
{
    return a > b ? a : b;
}

ENG_INLINE eng_d eng_d_max_abs(eng_d a, eng_d b)
{
    return eng_d_max(__builtin_fabs(a), __builtin_fabs(b));
}

ENG_INLINE eng_f eng_f_select(eng_fm m, eng_f a, eng_f b)
{
    return (eng_f){m[0] ? a[0] : b[0]};
}

ENG_INLINE eng_f eng_f_max(eng_f a, eng_f b)
{
    return (eng_f){a[0] > b[0] ? a[0] : b[0]};
}

ENG_INLINE eng_f eng_f_min(eng_f a, eng_f b)
{
    return (eng_f){a[0] < b[0] ? a[0] : b[0]};
}

ENG_INLINE eng_f eng_f_max_abs(eng_f a, eng_f b)
{
    float x = __builtin_fabsf(a[0]);
    float y = __builtin_fabsf(b[0]);
    return (eng_f){x > y ? x : y};
}

ENG_INLINE eng_fi eng_fi_min(eng_fi a, eng_fi b)
{
    return (eng_fi){a[0] < b[0] ? a[0] : b[0]};
}

ENG_INLINE eng_fi eng_fi_max(eng_fi a, eng_fi b)
{
    return (eng_fi){a[0] > b[0] ? a[0] : b[0]};
}

ENG_INLINE eng_d eng_d_sqrt(eng_d a)
{
    return __builtin_sqrt(a);
}

ENG_INLINE eng_f eng_f_sqrt(eng_f a)
{
    return (eng_f){__builtin_sqrtf(a[0])};
}

#endif

#endif
