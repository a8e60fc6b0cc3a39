/* lanes.h - arithmetic on vectors as wide as the instruction set allows, with the same
 * result in each lane whatever the width.
 *
 * eng_d: ENG_D_LANES doubles, eng_f: ENG_F_LANES floats. A mask, eng_dm or eng_fm, is a
 * register of bits with AVX-512 and a vector of all-ones and zeros elsewhere: only the
 * functions below touch one. Comparisons with NaN are false. struct eng_v is three
 * coordinates of as many lanes.
 *
 * The three versions say the same: that without vectors is the reference for the others.
 *
 * Threads: [any]; inline only. Included by files of this folder, and by those of
 * elementary/ that ask the kernels' computations of one pair.
 */
#ifndef ENG_LANES_H
#define ENG_LANES_H

/* ---- types ----------------------------------------------------------------------- */

#include <stdint.h>
#include <string.h>

/* Read without the flags of an instruction set, it is the reference. */
#ifndef ENG_ISA
#define ENG_ISA          scalar
#define ENG_VECTOR_BYTES 8
#endif

/* The header of all sets takes most of the time in which a short kernel is compiled. */
#ifdef __AVX__
#include <immintrin.h>
#elif defined __SSE4_1__
#include <smmintrin.h>
#elif defined __SSE2__
#include <emmintrin.h>
#elif defined __ARM_NEON && ENG_VECTOR_BYTES == 16
#include <arm_neon.h>
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

/* Return the lanes that have these bits. */
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
typedef float eng_float4 __attribute__((vector_size(16), may_alias));
typedef int32_t eng_bits4 __attribute__((vector_size(16), may_alias));

/* Return a > b ? a : b of each lane. */
static inline __attribute__((always_inline)) eng_float4 eng_float4_max(eng_float4 a,
                                                                       eng_float4 b)
{
    eng_bits4 is_a = a > b;
    return (eng_float4)((is_a & (eng_bits4)a) | (~is_a & (eng_bits4)b));
}

/* ---- AVX-512: a mask is a register of bits --------------------------------------- */

#if ENG_VECTOR_BYTES == 64

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

/* Return the mask as bits; bit i is lane i's. */
ENG_INLINE uint32_t eng_dm_bits(eng_dm m)
{
    return m;
}

ENG_INLINE uint32_t eng_fm_bits(eng_fm m)
{
    return m;
}

/* Return a where the mask is set, else b. */
ENG_INLINE eng_d eng_d_select(eng_dm m, eng_d a, eng_d b)
{
    return (eng_d)_mm512_mask_blend_pd(m, (__m512d)b, (__m512d)a);
}

/* Return a < b ? a : b of each lane. */
ENG_INLINE eng_d eng_d_min(eng_d a, eng_d b)
{
    return (eng_d)_mm512_min_pd((__m512d)a, (__m512d)b);
}

ENG_INLINE eng_d eng_d_max(eng_d a, eng_d b)
{
    return (eng_d)_mm512_max_pd((__m512d)a, (__m512d)b);
}

/* Return the larger magnitude. */
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

/* ---- without vectors: one number at a time --------------------------------------- */

#elif ENG_VECTOR_BYTES == 8

/* Numbers stay in the registers for numbers, masks included: vectors of one integer would
 * travel to the other registers and back. */

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

/* ---- SSE2 to AVX2, NEON: a mask is a vector of all-ones and zeros ---------------- */

#else

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
#elif defined __SSE2__
    return (uint32_t)_mm_movemask_pd((__m128d)m);
#else
    const uint64x2_t bit = {1, 2};
    return (uint32_t)vaddvq_u64(vandq_u64((uint64x2_t)m, bit));
#endif
}

ENG_INLINE uint32_t eng_fm_bits(eng_fm m)
{
#if ENG_VECTOR_BYTES == 32
    return (uint32_t)_mm256_movemask_ps((__m256)m);
#elif defined __SSE2__
    return (uint32_t)_mm_movemask_ps((__m128)m);
#else
    const uint32x4_t bit = {1, 2, 4, 8};
    return vaddvq_u32(vandq_u32((uint32x4_t)m, bit));
#endif
}

ENG_INLINE eng_d eng_d_select(eng_dm m, eng_d a, eng_d b)
{
#if defined __SSE4_1__ && ENG_VECTOR_BYTES == 16
    return (eng_d)_mm_blendv_pd((__m128d)b, (__m128d)a, (__m128d)m);
#else
    return (eng_d)((m & (eng_di)a) | (~m & (eng_di)b));
#endif
}

ENG_INLINE eng_d eng_d_min(eng_d a, eng_d b)
{
#if ENG_VECTOR_BYTES == 32
    return (eng_d)_mm256_min_pd((__m256d)a, (__m256d)b);
#elif defined __SSE2__
    return (eng_d)_mm_min_pd((__m128d)a, (__m128d)b);
#else
    return eng_d_select(a < b, a, b);
#endif
}

ENG_INLINE eng_d eng_d_max(eng_d a, eng_d b)
{
#if ENG_VECTOR_BYTES == 32
    return (eng_d)_mm256_max_pd((__m256d)a, (__m256d)b);
#elif defined __SSE2__
    return (eng_d)_mm_max_pd((__m128d)a, (__m128d)b);
#else
    return eng_d_select(a > b, a, b);
#endif
}

/* Return the larger magnitude. */
ENG_INLINE eng_d eng_d_max_abs(eng_d a, eng_d b)
{
    return eng_d_max((eng_d)((eng_di)a & INT64_MAX), (eng_d)((eng_di)b & INT64_MAX));
}

ENG_INLINE eng_f eng_f_select(eng_fm m, eng_f a, eng_f b)
{
#if defined __SSE4_1__ && ENG_VECTOR_BYTES == 16
    return (eng_f)_mm_blendv_ps((__m128)b, (__m128)a, (__m128)m);
#else
    return (eng_f)((m & (eng_fi)a) | (~m & (eng_fi)b));
#endif
}

ENG_INLINE eng_f eng_f_max(eng_f a, eng_f b)
{
#if ENG_VECTOR_BYTES == 32
    return (eng_f)_mm256_max_ps((__m256)a, (__m256)b);
#elif defined __SSE2__
    return (eng_f)_mm_max_ps((__m128)a, (__m128)b);
#else
    return eng_f_select(a > b, a, b);
#endif
}

ENG_INLINE eng_f eng_f_min(eng_f a, eng_f b)
{
#if ENG_VECTOR_BYTES == 32
    return (eng_f)_mm256_min_ps((__m256)a, (__m256)b);
#elif defined __SSE2__
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
#elif defined __SSE4_1__
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
#elif defined __SSE4_1__
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
#elif defined __SSE2__
    return (eng_d)_mm_sqrt_pd((__m128d)a);
#else
    return (eng_d)vsqrtq_f64((float64x2_t)a);
#endif
}

ENG_INLINE eng_f eng_f_sqrt(eng_f a)
{
#if ENG_VECTOR_BYTES == 32
    return (eng_f)_mm256_sqrt_ps((__m256)a);
#elif defined __SSE2__
    return (eng_f)_mm_sqrt_ps((__m128)a);
#else
    return (eng_f)vsqrtq_f32((float32x4_t)a);
#endif
}

#endif

/* ---- all sets -------------------------------------------------------------------- */

/* Load ENG_D_LANES floats, exactly. */
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

/* Store ENG_D_LANES floats, each the nearest. */
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

/* Clear the sign bits. */
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

/* eng_n: the numbers that reject.h and the vectors below compute with. Doubles, or floats
 * in a file that defines ENG_IN_FLOATS before it includes anything. */
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

/* ---- vectors of three coordinates ------------------------------------------------ */

/* Of doubles, or of floats in files that define ENG_IN_FLOATS. */

struct eng_v {
    eng_n x, y, z;
};

ENG_INLINE struct eng_v eng_v_add(struct eng_v a, struct eng_v b)
{
    return (struct eng_v){a.x + b.x, a.y + b.y, a.z + b.z};
}

ENG_INLINE struct eng_v eng_v_sub(struct eng_v a, struct eng_v b)
{
    return (struct eng_v){a.x - b.x, a.y - b.y, a.z - b.z};
}

ENG_INLINE struct eng_v eng_v_cross(struct eng_v a, struct eng_v b)
{
    return (struct eng_v){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z,
                          a.x * b.y - a.y * b.x};
}

ENG_INLINE eng_n eng_v_dot(struct eng_v a, struct eng_v b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

/* Return s a + t b. */
ENG_INLINE struct eng_v eng_v_mix(eng_n s, struct eng_v a, eng_n t, struct eng_v b)
{
    return (struct eng_v){s * a.x + t * b.x, s * a.y + t * b.y, s * a.z + t * b.z};
}

ENG_INLINE struct eng_v eng_v_abs(struct eng_v a)
{
    return (struct eng_v){eng_n_abs(a.x), eng_n_abs(a.y), eng_n_abs(a.z)};
}

/* Return a where the mask is set, else b. */
ENG_INLINE struct eng_v eng_v_select(eng_nm m, struct eng_v a, struct eng_v b)
{
    return (struct eng_v){eng_n_select(m, a.x, b.x), eng_n_select(m, a.y, b.y),
                          eng_n_select(m, a.z, b.z)};
}

/* Return s a. */
ENG_INLINE struct eng_v eng_v_scale(eng_n s, struct eng_v a)
{
    return (struct eng_v){s * a.x, s * a.y, s * a.z};
}

/* Return the largest coordinate magnitude. */
ENG_INLINE eng_n eng_v_size(struct eng_v a)
{
    return eng_n_max_abs(eng_n_max_abs(a.x, a.y), a.z);
}

/* Return the largest coordinate magnitude of two. */
ENG_INLINE eng_n eng_v_size_of_two(struct eng_v a, struct eng_v b)
{
    eng_n x = eng_n_max_abs(a.x, b.x);
    eng_n y = eng_n_max_abs(a.y, b.y);
    eng_n z = eng_n_max_abs(a.z, b.z);
    return eng_n_max(eng_n_max(x, y), z);
}

#endif
