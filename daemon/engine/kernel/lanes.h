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

/* eng_n: the numbers that vectors.h and reject.h compute with. Doubles, or floats in a
 * file that defines ENG_IN_FLOATS before it includes anything. */
#ifdef ENG_IN_FLOATS
#define ENG_N(name)  eng_f_##name
#define ENG_NM(name) eng_fm_##name
#define ENG_N_U      0x1p-24f /* what u is of doubles */
typedef eng_f eng_n;
typedef eng_fm eng_nm;
#else
#define ENG_N(name)  eng_d_##name
#define ENG_NM(name) eng_dm_##name
#define ENG_N_U      0x1p-53
typedef eng_d eng_n;
typedef eng_dm eng_nm;
#endif

#define eng_n_all     ENG_N(all)
#define eng_n_abs     ENG_N(abs)
#define eng_n_less    ENG_N(less)
#define eng_n_max     ENG_N(max)
#define eng_n_max_abs ENG_N(max_abs)
#define eng_n_min     ENG_N(min)
#define eng_n_select  ENG_N(select)
#define eng_n_sqrt    ENG_N(sqrt)
#define eng_nm_and    ENG_NM(and)
#define eng_nm_bits   ENG_NM(bits)
#define eng_nm_or     ENG_NM(or)

#endif
