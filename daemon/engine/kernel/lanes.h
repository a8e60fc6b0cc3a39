/* daemon/engine/kernel/lanes.h - vectors of as many numbers as the instruction set holds.
 *
 * Room:     engine. May include: lanes_avx512.h, lanes_scalar.h, lanes_vector.h,
 *           immintrin.h.
 * Does:     doubles, floats and masks lane by lane, with the same result in a lane
 *           whatever the width; + - * / are the compiler's operators on vectors.
 * Threads:  [any]; inline only. Included by files of this folder alone.
 *
 * eng_d: ENG_D_LANES doubles, eng_f: ENG_F_LANES floats. A mask, eng_dm or eng_fm, is a
 * register of bits with AVX-512 and a vector of all-ones and zeros elsewhere: only the
 * functions below touch one. Comparisons with NaN are false.
 */
#ifndef ENG_LANES_H
#define ENG_LANES_H

#include <stdint.h>
#include <string.h>

/* Read without the flags of an instruction set, it is the reference. */
#ifndef ENG_ISA
#define ENG_ISA          scalar
#define ENG_VECTOR_BYTES 8
#endif

#ifdef __x86_64__
#include <immintrin.h>
#endif

/* A vector that is wider than the registers of the target without the flags of this file
 * would cross calls in another way; none crosses one, because everything is inlined. */
#pragma GCC diagnostic ignored "-Wpsabi"
#define ENG_INLINE static inline __attribute__((always_inline))

#define ENG_PASTE2(a, b, c) a##b##_##c
#define ENG_PASTE(a, b, c)  ENG_PASTE2(a, b, c)
/* The name of a kernel of this instruction set: eng_avx2_filter. */
#define ENG_KERNEL(name) ENG_PASTE(eng_, ENG_ISA, name)

#define ENG_D_LANES (ENG_VECTOR_BYTES / 8)
#if ENG_VECTOR_BYTES == 8
#define ENG_F_LANES 1
#else
#define ENG_F_LANES (ENG_VECTOR_BYTES / 4)
#endif

#define ENG_D_ALL ((1u << ENG_D_LANES) - 1)
#define ENG_F_ALL ((1u << ENG_F_LANES) - 1)

#if ENG_VECTOR_BYTES == 8
/* Not a vector: gcc 12 keeps those of one double in the registers of integers. */
typedef double eng_d;
#else
typedef double eng_d __attribute__((vector_size(ENG_D_LANES * 8), may_alias));
#endif
typedef float eng_f __attribute__((vector_size(ENG_F_LANES * 4), may_alias));
typedef int64_t eng_di __attribute__((vector_size(ENG_D_LANES * 8), may_alias));
typedef int32_t eng_fi __attribute__((vector_size(ENG_F_LANES * 4), may_alias));

ENG_INLINE eng_d eng_d_load(const double *x)
{
    eng_d v;
    memcpy(&v, x, sizeof v);
    return v;
}

ENG_INLINE void eng_d_store(double *x, eng_d v)
{
    memcpy(x, &v, sizeof v);
}

/* The same bits. */
ENG_INLINE eng_d eng_d_of(eng_di bits)
{
    eng_d v;
    memcpy(&v, &bits, sizeof v);
    return v;
}

ENG_INLINE eng_di eng_di_of(eng_d v)
{
    eng_di bits;
    memcpy(&bits, &v, sizeof bits);
    return bits;
}

ENG_INLINE eng_f eng_f_load(const float *x)
{
    eng_f v;
    memcpy(&v, x, sizeof v);
    return v;
}

ENG_INLINE void eng_f_store(float *x, eng_f v)
{
    memcpy(x, &v, sizeof v);
}

ENG_INLINE eng_d eng_d_all(double x)
{
    return x - (eng_d){0};
}

ENG_INLINE eng_f eng_f_all(float x)
{
    return x - (eng_f){0};
}

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
ENG_INLINE void eng_d_narrow(float *x, eng_d v)
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
