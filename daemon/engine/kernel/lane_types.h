/* lane_types.h - the vector types that the kernels compute with, and how they are loaded
 * and stored.
 *
 * Threads: [any]; inline only. Included by files of this folder alone.
 */
#ifndef ENG_LANE_TYPES_H
#define ENG_LANE_TYPES_H

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

/* A vector of four floats on every instruction set: one side of one box. */
typedef float eng_four __attribute__((vector_size(16), may_alias));
typedef int32_t eng_four_bits __attribute__((vector_size(16), may_alias));

/* a > b ? a : b */
static inline __attribute__((always_inline)) eng_four eng_four_max(eng_four a, eng_four b)
{
    eng_four_bits is_a = a > b;
    return (eng_four)((is_a & (eng_four_bits)a) | (~is_a & (eng_four_bits)b));
}

#endif
