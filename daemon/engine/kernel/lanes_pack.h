/* lanes_pack.h - moves the results of vector comparisons into lists: signs become bits,
 * and set bits become numbers.
 *
 * Threads: [any]; inline only. Included by files of this folder alone.
 */
#ifndef ENG_LANES_PACK_H
#define ENG_LANES_PACK_H

#include "lanes.h"

ENG_INLINE eng_fi eng_fi_load(const uint32_t *x)
{
    eng_fi v;
    memcpy(&v, x, sizeof v);
    return v;
}

ENG_INLINE eng_fi eng_fi_of(const int32_t *x)
{
    eng_fi v;
    memcpy(&v, x, sizeof v);
    return v;
}

ENG_INLINE eng_fi eng_fi_all(uint32_t x)
{
    return (int32_t)x - (eng_fi){0};
}

/* a | (b & c), one operation with AVX-512 where gcc 12 makes two. */
ENG_INLINE eng_fi eng_fi_or_and(eng_fi a, eng_fi b, eng_fi c)
{
#if ENG_VECTOR_BYTES == 64
    return (eng_fi)_mm512_ternarylogic_epi32((__m512i)a, (__m512i)b, (__m512i)c, 0xf8);
#else
    return a | (b & c);
#endif
}

/* a | b | c. */
ENG_INLINE eng_fi eng_fi_or_or(eng_fi a, eng_fi b, eng_fi c)
{
#if ENG_VECTOR_BYTES == 64
    return (eng_fi)_mm512_ternarylogic_epi32((__m512i)a, (__m512i)b, (__m512i)c, 0xfe);
#else
    return a | b | c;
#endif
}

/* The lanes that are left over: bits with AVX-512; elsewhere those without a sign, so
 * that they become bits once. */
#if ENG_VECTOR_BYTES == 64
typedef __mmask16 eng_left;
#else
typedef eng_fi eng_left;
#endif

/* Those that are not negative. */
ENG_INLINE eng_left eng_left_of(eng_fi v)
{
#if ENG_VECTOR_BYTES == 64
    return _mm512_testn_epi32_mask((__m512i)v, _mm512_set1_epi32(INT32_MIN));
#else
    return v;
#endif
}

/* All of them. */
ENG_INLINE eng_left eng_left_all(void)
{
#if ENG_VECTOR_BYTES == 64
    return (eng_left)0xffff;
#else
    return (eng_left){0};
#endif
}

/* Without those that are the same in a and b. */
ENG_INLINE eng_left eng_left_unequal(eng_left left, eng_fi a, eng_fi b)
{
#if ENG_VECTOR_BYTES == 64
    return _mm512_mask_cmpneq_epi32_mask(left, (__m512i)a, (__m512i)b);
#elif ENG_VECTOR_BYTES == 8
    return left | (eng_fi){-(int32_t)(a[0] == b[0])}; /* see lanes.h */
#else
    return left | (a == b);
#endif
}

/* Bit i is lane i's. */
ENG_INLINE uint32_t eng_left_bits(eng_left left)
{
#if ENG_VECTOR_BYTES == 64
    return left;
#elif ENG_VECTOR_BYTES == 32
    return ~(uint32_t)_mm256_movemask_ps((__m256)left) & ENG_F_ALL;
#elif defined __SSE2__ && ENG_VECTOR_BYTES == 16
    return ~(uint32_t)_mm_movemask_ps((__m128)left) & ENG_F_ALL;
#else
    return ~eng_fm_bits(left >> 31) & ENG_F_ALL;
#endif
}

/* Bit i: lane i is not negative. */
ENG_INLINE uint32_t eng_fi_no_signs(eng_fi v)
{
    return eng_left_bits(eng_left_of(v));
}

#if ENG_VECTOR_BYTES == 32
/* The numbers of the set bits of eight, ascending, a byte each: by a table, as pdep and
 * pext, which could make them, take AMD's Zen 1 and 2 hundreds of cycles. Each line puts
 * a number, or none, before those that are greater. */
#define ENG_LIST0(more) more, (more) << 8
#define ENG_LIST1(more) ENG_LIST0(more), ENG_LIST0((more) << 8 | 1)
#define ENG_LIST2(more) ENG_LIST1(more), ENG_LIST1((more) << 8 | 2)
#define ENG_LIST3(more) ENG_LIST2(more), ENG_LIST2((more) << 8 | 3)
#define ENG_LIST4(more) ENG_LIST3(more), ENG_LIST3((more) << 8 | 4)
#define ENG_LIST5(more) ENG_LIST4(more), ENG_LIST4((more) << 8 | 5)
#define ENG_LIST6(more) ENG_LIST5(more), ENG_LIST5((more) << 8 | 6)
#define ENG_LIST7(more) ENG_LIST6(more), ENG_LIST6((more) << 8 | 7)
static const uint64_t eng_lists_of_bits[256] = {ENG_LIST7(UINT64_C(0))};

/* The same as numbers of 32 bits; bits < 2^8. */
ENG_INLINE __m256i eng_list_of_bits(uint32_t bits)
{
    return _mm256_cvtepu8_epi32(
        _mm_loadl_epi64((const __m128i *)(const void *)&eng_lists_of_bits[bits]));
}
#endif

/* base + i for every set bit i of `bits` < 2^16, ascending. 16 places are written to.
 * Returns how many bits are set. */
ENG_INLINE uint32_t eng_pack16(uint32_t *out, uint32_t bits, uint32_t base)
{
#if ENG_VECTOR_BYTES == 64
    const __m512i lanes =
        _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
    __m512i all = _mm512_add_epi32(lanes, _mm512_set1_epi32((int)base));
    _mm512_storeu_si512(out, _mm512_maskz_compress_epi32((__mmask16)bits, all));
    return (uint32_t)__builtin_popcount(bits);
#elif ENG_VECTOR_BYTES == 32
    uint32_t low = bits & 0xff;
    __m256i first = _mm256_add_epi32(eng_list_of_bits(low), _mm256_set1_epi32((int)base));
    __m256i second =
        _mm256_add_epi32(eng_list_of_bits(bits >> 8), _mm256_set1_epi32((int)(base + 8)));
    _mm256_storeu_si256((__m256i *)(void *)out, first);
    _mm256_storeu_si256((__m256i *)(void *)(out + __builtin_popcount(low)), second);
    return (uint32_t)__builtin_popcount(bits);
#else
    uint32_t count = 0;
    for (; bits != 0; bits &= bits - 1) {
        out[count++] = base + (uint32_t)__builtin_ctz(bits);
    }
    return count;
#endif
}

/* Those of the ENG_F_LANES numbers from a_in and b_in on whose bit is set, to a_out and
 * b_out, which may be before them in the same array. ENG_F_LANES places are written to.
 * Returns how many bits are set. */
ENG_INLINE uint32_t eng_compress_pairs(uint32_t *a_out, uint32_t *b_out,
                                       const uint32_t *a_in, const uint32_t *b_in,
                                       uint32_t bits)
{
#if ENG_VECTOR_BYTES == 64
    __m512i a = _mm512_loadu_si512(a_in);
    __m512i b = _mm512_loadu_si512(b_in);
    _mm512_storeu_si512(a_out, _mm512_maskz_compress_epi32((__mmask16)bits, a));
    _mm512_storeu_si512(b_out, _mm512_maskz_compress_epi32((__mmask16)bits, b));
    return (uint32_t)__builtin_popcount(bits);
#elif ENG_VECTOR_BYTES == 32
    __m256i lanes = eng_list_of_bits(bits);
    __m256i a = _mm256_loadu_si256((const __m256i *)(const void *)a_in);
    __m256i b = _mm256_loadu_si256((const __m256i *)(const void *)b_in);
    _mm256_storeu_si256((__m256i *)(void *)a_out, _mm256_permutevar8x32_epi32(a, lanes));
    _mm256_storeu_si256((__m256i *)(void *)b_out, _mm256_permutevar8x32_epi32(b, lanes));
    return (uint32_t)__builtin_popcount(bits);
#else
    uint32_t count = 0;
    for (uint32_t lane = 0; lane < ENG_F_LANES; lane++) {
        a_out[count] = a_in[lane];
        b_out[count] = b_in[lane];
        count += bits >> lane & 1u;
    }
    return count;
#endif
}

/* `x` to 16 places. */
ENG_INLINE void eng_fill16(uint32_t *out, uint32_t x)
{
    for (uint32_t i = 0; i < 16; i += ENG_F_LANES) {
        eng_fi v = eng_fi_all(x);
        memcpy(out + i, &v, sizeof v);
    }
}

#endif
