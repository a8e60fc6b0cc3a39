/* lanes_avx512.h - the AVX-512 version of lanes.h: a mask is a register of bits.
 *
 * Threads: [any]; inline only.
 */
#ifndef ENG_LANES_AVX512_H
#define ENG_LANES_AVX512_H

#include "lane_types.h"

#if ENG_VECTOR_BYTES == 64 /* so that the header compiles alone */

typedef __mmask8 eng_dm;
typedef __mmask16 eng_fm;

ENG_INLINE eng_dm eng_d_less(eng_d a, eng_d b)
{
    return _mm512_cmp_pd_mask((__m512d)a, (__m512d)b, _CMP_LT_OQ);
}

ENG_INLINE eng_dm eng_d_at_most(eng_d a, eng_d b)
{
    return _mm512_cmp_pd_mask((__m512d)a, (__m512d)b, _CMP_LE_OQ);
}

ENG_INLINE eng_fm eng_f_less(eng_f a, eng_f b)
{
    return _mm512_cmp_ps_mask((__m512)a, (__m512)b, _CMP_LT_OQ);
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
    return (eng_dm)~a;
}

ENG_INLINE eng_fm eng_fm_and(eng_fm a, eng_fm b)
{
    return a & b;
}

ENG_INLINE eng_fm eng_fm_or(eng_fm a, eng_fm b)
{
    return a | b;
}

/* Bit i is lane i's. */
ENG_INLINE uint32_t eng_dm_bits(eng_dm m)
{
    return m;
}

ENG_INLINE uint32_t eng_fm_bits(eng_fm m)
{
    return m;
}

/* a where the mask is set, else b. */
ENG_INLINE eng_d eng_d_select(eng_dm m, eng_d a, eng_d b)
{
    return (eng_d)_mm512_mask_blend_pd(m, (__m512d)b, (__m512d)a);
}

/* a < b ? a : b */
ENG_INLINE eng_d eng_d_min(eng_d a, eng_d b)
{
    return (eng_d)_mm512_min_pd((__m512d)a, (__m512d)b);
}

ENG_INLINE eng_d eng_d_max(eng_d a, eng_d b)
{
    return (eng_d)_mm512_max_pd((__m512d)a, (__m512d)b);
}

/* The larger magnitude. */
ENG_INLINE eng_d eng_d_max_abs(eng_d a, eng_d b)
{
    return (eng_d)_mm512_range_pd((__m512d)a, (__m512d)b, 0xb);
}

ENG_INLINE eng_f eng_f_max(eng_f a, eng_f b)
{
    return (eng_f)_mm512_max_ps((__m512)a, (__m512)b);
}

ENG_INLINE eng_f eng_f_min(eng_f a, eng_f b)
{
    return (eng_f)_mm512_min_ps((__m512)a, (__m512)b);
}

ENG_INLINE eng_f eng_f_max_abs(eng_f a, eng_f b)
{
    return (eng_f)_mm512_range_ps((__m512)a, (__m512)b, 0xb);
}

ENG_INLINE eng_fi eng_fi_min(eng_fi a, eng_fi b)
{
    return (eng_fi)_mm512_min_epi32((__m512i)a, (__m512i)b);
}

ENG_INLINE eng_fi eng_fi_max(eng_fi a, eng_fi b)
{
    return (eng_fi)_mm512_max_epi32((__m512i)a, (__m512i)b);
}

ENG_INLINE eng_f eng_f_select(eng_fm m, eng_f a, eng_f b)
{
    return (eng_f)_mm512_mask_blend_ps(m, (__m512)b, (__m512)a);
}

ENG_INLINE eng_d eng_d_sqrt(eng_d a)
{
    return (eng_d)_mm512_sqrt_pd((__m512d)a);
}

ENG_INLINE eng_f eng_f_sqrt(eng_f a)
{
    return (eng_f)_mm512_sqrt_ps((__m512)a);
}

#endif

#endif
