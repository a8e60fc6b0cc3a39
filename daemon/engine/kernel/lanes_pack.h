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

/* Return a | (b & c), by one operation with AVX-512 where gcc 12 makes two. */
ENG_INLINE eng_fi eng_fi_or_and(eng_fi a, eng_fi b, eng_fi c)
{
#if ENG_VECTOR_BYTES == 64
    return (eng_fi)_mm512_ternarylogic_epi32((__m512i)a, (__m512i)b, (__m512i)c, 0xf8);
#else
    return a | (b & c);
#endif
}

/* Return a | b | c. */
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

/* Return the lanes of v that are not negative. */
ENG_INLINE eng_left eng_left_of(eng_fi v)
{
#if ENG_VECTOR_BYTES == 64
    return _mm512_testn_epi32_mask((__m512i)v, _mm512_set1_epi32(INT32_MIN));
#else
    return v;
#endif
}

/* Return all lanes. */
ENG_INLINE eng_left eng_left_all(void)
{
#if ENG_VECTOR_BYTES == 64
    return (eng_left)0xffff;
#else
    return (eng_left){0};
#endif
}

/* Return `left` without the lanes in which a and b are the same. */
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

/* Return the lanes that are left as bits; bit i is lane i's. */
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

/* Return sixteen lanes that are left as bits, in the same way. */
ENG_INLINE uint32_t eng_left_bits16(const eng_left left[16 / ENG_F_LANES])
{
#if ENG_VECTOR_BYTES == 32
    /* Complemented once. */
    return (eng_fm_bits(left[0]) | eng_fm_bits(left[1]) << 8) ^ 0xffff;
#elif ENG_VECTOR_BYTES != 16
    uint32_t bits = 0;
    for (uint32_t part = 0; part < 16 / ENG_F_LANES; part++) {
        bits |= eng_left_bits(left[part]) << (part * ENG_F_LANES);
    }
    return bits;
#elif defined __SSE2__
    /* To 16 and to 8 bits: what does not fit keeps its sign. */
    __m128i low = _mm_packs_epi32((__m128i)left[0], (__m128i)left[1]);
    __m128i high = _mm_packs_epi32((__m128i)left[2], (__m128i)left[3]);
    return ~(uint32_t)_mm_movemask_epi8(_mm_packs_epi16(low, high)) & 0xffff;
#else
    /* The upper halves, and of these the upper halves. */
    const uint8x16_t bit = {1, 2, 4, 8, 16, 32, 64, 128, 1, 2, 4, 8, 16, 32, 64, 128};
    int16x8_t low = vuzp2q_s16((int16x8_t)left[0], (int16x8_t)left[1]);
    int16x8_t high = vuzp2q_s16((int16x8_t)left[2], (int16x8_t)left[3]);
    int8x16_t bytes = vuzp2q_s8((int8x16_t)low, (int8x16_t)high);
    uint8x16_t lanes = vandq_u8(vcgezq_s8(bytes), bit);
    return vaddv_u8(vget_low_u8(lanes)) | (uint32_t)vaddv_u8(vget_high_u8(lanes)) << 8;
#endif
}

/* Return the lanes that are not negative as bits; bit i is lane i's. */
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

/* Return the list of the set bits of `bits`, which is < 2^8, as numbers of 32 bits. */
ENG_INLINE __m256i eng_list_of_bits(uint32_t bits)
{
    return _mm256_cvtepu8_epi32(
        _mm_loadl_epi64((const __m128i *)(const void *)&eng_lists_of_bits[bits]));
}
#endif

/* Count the lanes' bits that are set. */
ENG_INLINE uint32_t eng_count_lanes(uint32_t bits)
{
#if ENG_VECTOR_BYTES == 8
    return bits;
#elif ENG_VECTOR_BYTES == 16 && !defined __POPCNT__
    /* For __builtin_popcount a function would be called. */
    return (uint32_t)(0x4332322132212110u >> 4 * bits) & 7;
#else
    return (uint32_t)__builtin_popcount(bits);
#endif
}

#if ENG_VECTOR_BYTES == 16

/* The bytes of the lanes whose bit is set, and then others. */
#define ENG_LANE(i)           (0x03020100u + (i) * 0x04040404u)
#define ENG_ORDER(a, b, c, d) {ENG_LANE(a), ENG_LANE(b), ENG_LANE(c), ENG_LANE(d)}
static const uint32_t eng_order[16][4] __attribute__((aligned(16))) = {
    ENG_ORDER(0, 1, 2, 3), ENG_ORDER(0, 1, 2, 3), ENG_ORDER(1, 0, 2, 3),
    ENG_ORDER(0, 1, 2, 3), ENG_ORDER(2, 0, 1, 3), ENG_ORDER(0, 2, 1, 3),
    ENG_ORDER(1, 2, 0, 3), ENG_ORDER(0, 1, 2, 3), ENG_ORDER(3, 0, 1, 2),
    ENG_ORDER(0, 3, 1, 2), ENG_ORDER(1, 3, 0, 2), ENG_ORDER(0, 1, 3, 2),
    ENG_ORDER(2, 3, 0, 1), ENG_ORDER(0, 2, 3, 1), ENG_ORDER(1, 2, 3, 0),
    ENG_ORDER(0, 1, 2, 3)};

#if defined __SSSE3__ || defined __ARM_NEON

ENG_INLINE eng_fi eng_bytes_of(eng_fi v, eng_fi order)
{
#ifdef __SSSE3__
    return (eng_fi)_mm_shuffle_epi8((__m128i)v, (__m128i)order);
#else
    return (eng_fi)vqtbl1q_u8((uint8x16_t)v, (uint8x16_t)order);
#endif
}

#endif

#endif

/* Write base + i for every set bit i of `bits` < 2^16, ascending. 16 places are written
 * to. Return how many bits are set. */
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
#elif ENG_VECTOR_BYTES == 16
    uint32_t count = 0;
#pragma GCC unroll 4
    for (uint32_t at = 0; at < 16; at += ENG_F_LANES) {
        uint32_t some = bits >> at & ENG_F_ALL;
        eng_fi lanes = eng_fi_load(eng_order[some]) >> 26;
        lanes += eng_fi_all(base + at);
        memcpy(out + count, &lanes, sizeof lanes);
        count += eng_count_lanes(some);
    }
    return count;
#else
    uint32_t count = 0;
    for (; bits != 0; bits &= bits - 1) {
        out[count++] = base + (uint32_t)__builtin_ctz(bits);
    }
    return count;
#endif
}

/* Copy those of the ENG_F_LANES numbers from a_in and b_in on whose bit is set to a_out
 * and b_out, which may be before them in the same array. ENG_F_LANES places are written
 * to. Return how many bits are set. */
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
#elif ENG_VECTOR_BYTES == 16 && (defined __SSSE3__ || defined __ARM_NEON)
    eng_fi order = eng_fi_load(eng_order[bits]);
    eng_fi a = eng_bytes_of(eng_fi_load(a_in), order);
    eng_fi b = eng_bytes_of(eng_fi_load(b_in), order);
    memcpy(a_out, &a, sizeof a);
    memcpy(b_out, &b, sizeof b);
    return eng_count_lanes(bits);
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

/* Write `x` to 16 places. */
ENG_INLINE void eng_fill16(uint32_t *out, uint32_t x)
{
    for (uint32_t i = 0; i < 16; i += ENG_F_LANES) {
        eng_fi v = eng_fi_all(x);
        memcpy(out + i, &v, sizeof v);
    }
}

#endif
