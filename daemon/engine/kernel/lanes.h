/* lanes.h - arithmetic on vectors as wide as the instruction set allows, with the same
 * result in each lane whatever the width.
 *
 * Threads: [any]; inline only. Included by files of this folder alone.
 *
 * eng_d: ENG_D_LANES doubles, eng_f: ENG_F_LANES floats. A mask, eng_dm or eng_fm, is a
 * register of bits with AVX-512 and a vector of all-ones and zeros elsewhere: only the
 * functions below touch one. Comparisons with NaN are false.
 */
#ifndef ENG_LANES_H
#define ENG_LANES_H

#include "lane_types.h"

#if ENG_VECTOR_BYTES == 64
#include "lanes_avx512.h"
#elif ENG_VECTOR_BYTES == 8
#include "lanes_scalar.h"
#else
#include "lanes_vector.h"
#endif

/* ENG_D_LANES floats, exactly. */
ENG_INLINE eng_d eng_d_widen(const float *x)
{
#if ENG_VECTOR_BYTES == 8
    return *x;
#else
    typedef float half __attribute__((vector_size(ENG_D_LANES * 4), may_alias));
    half v;
    memcpy(&v, x, sizeof v);
    return __builtin_convertvector(v, eng_d);
#endif
}

/* ENG_D_LANES floats, the nearest. */
ENG_INLINE void eng_d_quantised(float *x, eng_d v)
{
#if ENG_VECTOR_BYTES == 8
    *x = (float)v;
#else
    typedef float half __attribute__((vector_size(ENG_D_LANES * 4), may_alias));
    half h = __builtin_convertvector(v, half);
    memcpy(x, &h, sizeof h);
#endif
}

/* The sign bit cleared. */
ENG_INLINE eng_d eng_d_abs(eng_d a)
{
#if ENG_VECTOR_BYTES == 8
    return __builtin_fabs(a);
#else
    return (eng_d)((eng_di)a & INT64_MAX);
#endif
}

ENG_INLINE eng_f eng_f_abs(eng_f a)
{
    return (eng_f)((eng_fi)a & INT32_MAX);
}

#endif
