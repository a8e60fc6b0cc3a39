/* quantised.h - quantised boxes: moving boxes whose bounds are whole numbers of 16 bits,
 * half as large as floats and twice as fast to compare.
 *
 * Threads: [any]; inline only. Included by files of this folder alone.
 *
 * make_quantised.c writes q >= x scale + c, where the two c of an axis, for what is below
 * and above, make up for the rounding of both: a sum of two q is at least the gap's other
 * side in the grid's cells, -g(t) of join_blocks.c, at either end. Below 0 at both it
 * says, as there, that boxes are apart; a sum that does not fit keeps its sign, for it
 * saturates.
 *
 * Up to a time t_end, what is reached until then takes the place of the other end: with
 * weights s and w of 15 bits for 1 - t_end and t_end, q0 s + q1 w, each product rounded
 * to the nearest. A weight is off by 2^-16, and by 2^-15 where it should be 1, so a
 * product is off by 1/2 for that, or by 1, and by 1/2 for its rounding: all in all
 * less than 5/2, and 3 are added. Whatever is weighed is linear in time, like the gap.
 */
#ifndef ENG_QUANTISED_H
#define ENG_QUANTISED_H

#include "boxes.h"
#include "lanes_pack.h"

/* ---- pairs of 16-bit numbers in lanes of 32 bits --------------------------------- */

/* Vector arithmetic on pairs of 16-bit numbers that share a 32-bit lane, for
 * quantised boxes. */

ENG_INLINE int32_t quantised_clamped(int32_t x)
{
    return x < INT16_MIN ? INT16_MIN : x > INT16_MAX ? INT16_MAX : x;
}

/* Return a + b of each half, saturated. */
ENG_INLINE eng_fi eng_fi_add_halves(eng_fi a, eng_fi b)
{
#if ENG_VECTOR_BYTES == 64
    return (eng_fi)_mm512_adds_epi16((__m512i)a, (__m512i)b);
#elif ENG_VECTOR_BYTES == 32
    return (eng_fi)_mm256_adds_epi16((__m256i)a, (__m256i)b);
#elif defined __SSE2__ && ENG_VECTOR_BYTES == 16
    return (eng_fi)_mm_adds_epi16((__m128i)a, (__m128i)b);
#elif defined __ARM_NEON && ENG_VECTOR_BYTES == 16
    return (eng_fi)vqaddq_s16((int16x8_t)a, (int16x8_t)b);
#else
    for (uint32_t i = 0; i < ENG_F_LANES; i++) {
        int32_t low = quantised_clamped((int16_t)a[i] + (int16_t)b[i]);
        int32_t high = quantised_clamped((a[i] >> 16) + (b[i] >> 16));
        a[i] = (int32_t)((uint32_t)high << 16 | (uint16_t)low);
    }
    return a;
#endif
}

/* Return the larger of each half. */
ENG_INLINE eng_fi eng_fi_max_halves(eng_fi a, eng_fi b)
{
#if ENG_VECTOR_BYTES == 64
    return (eng_fi)_mm512_max_epi16((__m512i)a, (__m512i)b);
#elif ENG_VECTOR_BYTES == 32
    return (eng_fi)_mm256_max_epi16((__m256i)a, (__m256i)b);
#elif defined __SSE2__ && ENG_VECTOR_BYTES == 16
    return (eng_fi)_mm_max_epi16((__m128i)a, (__m128i)b);
#elif defined __ARM_NEON && ENG_VECTOR_BYTES == 16
    return (eng_fi)vmaxq_s16((int16x8_t)a, (int16x8_t)b);
#else
    for (uint32_t i = 0; i < ENG_F_LANES; i++) {
        int16_t low = (int16_t)a[i] > (int16_t)b[i] ? (int16_t)a[i] : (int16_t)b[i];
        int32_t high = a[i] >> 16 > b[i] >> 16 ? a[i] >> 16 : b[i] >> 16;
        a[i] = (int32_t)((uint32_t)high << 16 | (uint16_t)low);
    }
    return a;
#endif
}

/* Return, for each half, `grown`, but INT16_MIN where a is that. */
ENG_INLINE eng_fi eng_fi_keep_least_halves(eng_fi a, eng_fi grown)
{
#if ENG_VECTOR_BYTES == 64
    const __m512i least = _mm512_set1_epi16(INT16_MIN);
    return (eng_fi)_mm512_mask_mov_epi16(
        (__m512i)grown, _mm512_cmpeq_epi16_mask((__m512i)a, least), least);
#elif ENG_VECTOR_BYTES == 32
    const __m256i least = _mm256_set1_epi16(INT16_MIN);
    return (eng_fi)_mm256_blendv_epi8((__m256i)grown, least,
                                      _mm256_cmpeq_epi16((__m256i)a, least));
#elif defined __SSE2__ && ENG_VECTOR_BYTES == 16
    const __m128i least = _mm_set1_epi16(INT16_MIN);
    __m128i is_least = _mm_cmpeq_epi16((__m128i)a, least);
    return (eng_fi)_mm_or_si128(_mm_and_si128(is_least, least),
                                _mm_andnot_si128(is_least, (__m128i)grown));
#elif defined __ARM_NEON && ENG_VECTOR_BYTES == 16
    const int16x8_t least = vdupq_n_s16(INT16_MIN);
    return (eng_fi)vbslq_s16(vceqq_s16((int16x8_t)a, least), least, (int16x8_t)grown);
#else
    for (uint32_t i = 0; i < ENG_F_LANES; i++) {
        int32_t low = (int16_t)a[i] == INT16_MIN ? INT16_MIN : (int16_t)grown[i];
        int32_t high = a[i] >> 16 == INT16_MIN ? INT16_MIN : grown[i] >> 16;
        a[i] = (int32_t)((uint32_t)high << 16 | (uint16_t)low);
    }
    return a;
#endif
}

/* Return a w / 2^15 of each half, the nearest, up where two are; 0 <= w. */
ENG_INLINE eng_fi eng_fi_weigh_halves(eng_fi a, int16_t w)
{
#if ENG_VECTOR_BYTES == 64
    return (eng_fi)_mm512_mulhrs_epi16((__m512i)a, _mm512_set1_epi16(w));
#elif ENG_VECTOR_BYTES == 32
    return (eng_fi)_mm256_mulhrs_epi16((__m256i)a, _mm256_set1_epi16(w));
#elif defined __SSSE3__ && ENG_VECTOR_BYTES == 16
    return (eng_fi)_mm_mulhrs_epi16((__m128i)a, _mm_set1_epi16(w));
#elif defined __SSE2__ && ENG_VECTOR_BYTES == 16
    /* Twice the upper half of the product, and the highest bit of the lower one: the next
     * bit rounds. */
    __m128i upper = _mm_mulhi_epi16((__m128i)a, _mm_set1_epi16(w));
    __m128i lower = _mm_mullo_epi16((__m128i)a, _mm_set1_epi16(w));
    lower = _mm_add_epi16(_mm_srli_epi16(lower, 14), _mm_set1_epi16(1));
    return (eng_fi)_mm_add_epi16(_mm_slli_epi16(upper, 1), _mm_srli_epi16(lower, 1));
#elif defined __ARM_NEON && ENG_VECTOR_BYTES == 16
    return (eng_fi)vqrdmulhq_n_s16((int16x8_t)a, w);
#else
    for (uint32_t i = 0; i < ENG_F_LANES; i++) {
        int32_t low = ((int16_t)a[i] * w + 0x4000) >> 15;
        int32_t high = ((a[i] >> 16) * w + 0x4000) >> 15;
        a[i] = (int32_t)((uint32_t)high << 16 | (uint16_t)low);
    }
    return a;
#endif
}

/* Return the smaller of each half. */
ENG_INLINE eng_fi eng_fi_min_halves(eng_fi a, eng_fi b)
{
#if ENG_VECTOR_BYTES == 64
    return (eng_fi)_mm512_min_epi16((__m512i)a, (__m512i)b);
#elif ENG_VECTOR_BYTES == 32
    return (eng_fi)_mm256_min_epi16((__m256i)a, (__m256i)b);
#elif defined __SSE2__ && ENG_VECTOR_BYTES == 16
    return (eng_fi)_mm_min_epi16((__m128i)a, (__m128i)b);
#elif defined __ARM_NEON && ENG_VECTOR_BYTES == 16
    return (eng_fi)vminq_s16((int16x8_t)a, (int16x8_t)b);
#else
    for (uint32_t i = 0; i < ENG_F_LANES; i++) {
        int16_t low = (int16_t)a[i] < (int16_t)b[i] ? (int16_t)a[i] : (int16_t)b[i];
        int32_t high = a[i] >> 16 < b[i] >> 16 ? a[i] >> 16 : b[i] >> 16;
        a[i] = (int32_t)((uint32_t)high << 16 | (uint16_t)low);
    }
    return a;
#endif
}

/* Return a / 2 of each half, rounded down. */
ENG_INLINE eng_fi eng_fi_half_of_halves(eng_fi a)
{
#if ENG_VECTOR_BYTES == 64
    return (eng_fi)_mm512_srai_epi16((__m512i)a, 1);
#elif ENG_VECTOR_BYTES == 32
    return (eng_fi)_mm256_srai_epi16((__m256i)a, 1);
#elif defined __SSE2__ && ENG_VECTOR_BYTES == 16
    return (eng_fi)_mm_srai_epi16((__m128i)a, 1);
#elif defined __ARM_NEON && ENG_VECTOR_BYTES == 16
    return (eng_fi)vshrq_n_s16((int16x8_t)a, 1);
#else
    return ((a >> 1) & ~0xffff) | ((a << 16 >> 17) & 0xffff);
#endif
}

/* Return |a| of each half; INT16_MIN stays. */
ENG_INLINE eng_fi eng_fi_abs_halves(eng_fi a)
{
#if ENG_VECTOR_BYTES == 64
    return (eng_fi)_mm512_abs_epi16((__m512i)a);
#elif ENG_VECTOR_BYTES == 32
    return (eng_fi)_mm256_abs_epi16((__m256i)a);
#elif defined __SSE2__ && ENG_VECTOR_BYTES == 16
    __m128i less = _mm_sub_epi16(_mm_setzero_si128(), (__m128i)a);
    return (eng_fi)_mm_max_epi16((__m128i)a, less);
#elif defined __ARM_NEON && ENG_VECTOR_BYTES == 16
    return (eng_fi)vabsq_s16((int16x8_t)a);
#else
    for (uint32_t i = 0; i < ENG_F_LANES; i++) {
        int32_t low = (int16_t)a[i] < 0 ? -(int16_t)a[i] : (int16_t)a[i];
        int32_t high = a[i] < 0 ? -(a[i] >> 16) : a[i] >> 16;
        a[i] = (int32_t)((uint32_t)high << 16 | (uint16_t)low);
    }
    return a;
#endif
}

/* Return the sum of the products of the halves, in all bits of each lane. */
ENG_INLINE eng_fi eng_fi_dot_halves(eng_fi a, eng_fi b)
{
#if ENG_VECTOR_BYTES == 64
    return (eng_fi)_mm512_madd_epi16((__m512i)a, (__m512i)b);
#elif ENG_VECTOR_BYTES == 32
    return (eng_fi)_mm256_madd_epi16((__m256i)a, (__m256i)b);
#elif defined __SSE2__ && ENG_VECTOR_BYTES == 16
    return (eng_fi)_mm_madd_epi16((__m128i)a, (__m128i)b);
#elif defined __ARM_NEON && ENG_VECTOR_BYTES == 16
    int32x4_t low = vmull_s16(vget_low_s16((int16x8_t)a), vget_low_s16((int16x8_t)b));
    return (eng_fi)vpaddq_s32(low, vmull_high_s16((int16x8_t)a, (int16x8_t)b));
#else
    for (uint32_t i = 0; i < ENG_F_LANES; i++) {
        a[i] = (int16_t)a[i] * (int16_t)b[i] + (a[i] >> 16) * (b[i] >> 16);
    }
    return a;
#endif
}

/* Return the low half of a and the high one of b. */
ENG_INLINE eng_fi eng_fi_low_and_high(eng_fi a, eng_fi b)
{
#if ENG_VECTOR_BYTES == 32
    return (eng_fi)_mm256_blend_epi16((__m256i)a, (__m256i)b, 0xaa);
#elif defined __SSE4_1__ && ENG_VECTOR_BYTES == 16
    return (eng_fi)_mm_blend_epi16((__m128i)a, (__m128i)b, 0xaa);
#else
    return (a & 0xffff) | (b & ~0xffff);
#endif
}

/* Return a where `sign` is negative, else b. */
ENG_INLINE eng_fi eng_fi_select_negative(eng_fi sign, eng_fi a, eng_fi b)
{
#if ENG_VECTOR_BYTES == 64
    return (eng_fi)_mm512_mask_blend_epi32(_mm512_movepi32_mask((__m512i)sign),
                                           (__m512i)b, (__m512i)a);
#elif ENG_VECTOR_BYTES == 32
    return (eng_fi)_mm256_blendv_ps((__m256)b, (__m256)a, (__m256)sign);
#elif defined __SSE4_1__ && ENG_VECTOR_BYTES == 16
    return (eng_fi)_mm_blendv_ps((__m128)b, (__m128)a, (__m128)sign);
#else
    eng_fi is_a = sign >> 31;
    return (is_a & a) | (~is_a & b);
#endif
}

/* Exchange the halves of each lane. */
ENG_INLINE eng_fi eng_fi_turn_halves(eng_fi a)
{
#if ENG_VECTOR_BYTES == 64
    return (eng_fi)_mm512_rol_epi32((__m512i)a, 16);
#elif ENG_VECTOR_BYTES == 32
    const __m128i order =
        _mm_setr_epi8(2, 3, 0, 1, 6, 7, 4, 5, 10, 11, 8, 9, 14, 15, 12, 13);
    return (eng_fi)_mm256_shuffle_epi8((__m256i)a, _mm256_broadcastsi128_si256(order));
#else
    return (a << 16) | ((a >> 16) & 0xffff);
#endif
}

/* Return the lanes of which no half is negative. */
ENG_INLINE eng_left eng_left_of_halves(eng_fi v)
{
#if ENG_VECTOR_BYTES == 64
    return _mm512_testn_epi32_mask((__m512i)v, _mm512_set1_epi32((int)0x80008000u));
#else
    return v | (v << 16);
#endif
}

/* ---- boxes ----------------------------------------------------------------------- */

#define ENG_QUANTISED_REACH_SPARE 3

/* Weights of the two ends at a time. */
struct quantised_weights {
    int16_t begin;
    int16_t end;
};

ENG_INLINE struct quantised_weights quantised_weights_at(float t)
{
    int32_t end = (int32_t)(t * 0x1p15f + 0.5f);
    int32_t begin = 0x8000 - end;
    return (struct quantised_weights){(int16_t)(begin < INT16_MAX ? begin : INT16_MAX),
                                      (int16_t)(end < INT16_MAX ? end : INT16_MAX)};
}

/* ---- up to a time ------------------------------------------------------------------ */

/* Return what is reached of q0 .. q1 by then; `around`: what was reached up to then. */
ENG_INLINE eng_fi quantised_reached(eng_fi q0, eng_fi q1,
                                    struct quantised_weights weights, bool around)
{
    const uint32_t spare = ENG_QUANTISED_REACH_SPARE;
    eng_fi q = eng_fi_add_halves(eng_fi_weigh_halves(q0, weights.begin),
                                 eng_fi_weigh_halves(q1, weights.end));
    q = eng_fi_add_halves(q, eng_fi_all(spare << 16 | spare));
    return around ? eng_fi_max_halves(q, q0) : q;
}

/* Write the rows of both ends with their halves turned: what is below comes to what is
 * above where a box that is not turned is added. */
ENG_INLINE void quantised_rows_turned(const struct eng_quantised_block *block,
                                      struct eng_quantised_block *turned)
{
#pragma GCC unroll 6
    for (uint32_t i = 0; i < 6; i++) {
        for (uint32_t at = 0; at < ENG_WIDE; at += ENG_F_LANES) {
            eng_fi q = eng_fi_turn_halves(eng_fi_load(block->row[i / 3][i % 3] + at));
            memcpy(turned->row[i / 3][i % 3] + at, &q, sizeof q);
        }
    }
}

/* Write the rows of both ends up to a time; `around`: of the first alone, around the way.
 * `turned`: with their halves turned, as above. */
ENG_INLINE void quantised_rows_until(const struct eng_quantised_block *block,
                                     struct quantised_weights weights, bool around,
                                     bool turned, struct eng_quantised_block *until)
{
#pragma GCC unroll 3
    for (uint32_t axis = 0; axis < 3; axis++) {
        for (uint32_t at = 0; at < ENG_WIDE; at += ENG_F_LANES) {
            eng_fi q0 = eng_fi_load(block->row[0][axis] + at);
            eng_fi q1 = eng_fi_load(block->row[1][axis] + at);
            q0 = turned ? eng_fi_turn_halves(q0) : q0;
            q1 = turned ? eng_fi_turn_halves(q1) : q1;
            eng_fi q = quantised_reached(q0, q1, weights, around);
            memcpy(until->row[around ? 0 : 1][axis] + at, &q, sizeof q);
            if (!around) {
                memcpy(until->row[0][axis] + at, &q0, sizeof q0);
            }
        }
    }
}

/* ---- at one end of the step, for what is within a distance ------------------------- */

/* Cells along an axis, for both halves: from INT16_MIN to INT16_MAX it takes three. */
struct quantised_more {
    uint32_t part[3][3];
};

ENG_INLINE struct quantised_more quantised_more_of(const int32_t cells[3])
{
    struct quantised_more more;
    for (int axis = 0; axis < 3; axis++) {
        int32_t left = cells[axis] < UINT16_MAX ? cells[axis] : UINT16_MAX;
        for (int i = 0; i < 3; i++) {
            int32_t part = left < INT16_MAX ? left : INT16_MAX;
            more.part[axis][i] = (uint32_t)part << 16 | (uint32_t)part;
            left -= part;
        }
    }
    return more;
}

/* Write the rows of an end, larger by some cells along each axis. No box stays none. A
 * sum that is cut to INT16_MAX keeps its sign beside the least that there is. */
ENG_INLINE void quantised_rows_grown(const struct eng_quantised_block *block,
                                     uint32_t end, const struct quantised_more *more,
                                     struct eng_quantised_block *grown)
{
#pragma GCC unroll 3
    for (uint32_t axis = 0; axis < 3; axis++) {
        for (uint32_t at = 0; at < ENG_WIDE; at += ENG_F_LANES) {
            eng_fi q = eng_fi_load(block->row[end][axis] + at);
            eng_fi sum = q;
#pragma GCC unroll 3
            for (int i = 0; i < 3; i++) {
                sum = eng_fi_add_halves(sum, eng_fi_all(more->part[axis][i]));
            }
            sum = eng_fi_keep_least_halves(q, sum);
            memcpy(grown->row[0][axis] + at, &sum, sizeof sum);
        }
    }
}

/* Write the rows of an end with their halves turned. */
ENG_INLINE void quantised_rows_turned_at(const struct eng_quantised_block *block,
                                         uint32_t end, struct eng_quantised_block *turned)
{
#pragma GCC unroll 3
    for (uint32_t axis = 0; axis < 3; axis++) {
        for (uint32_t at = 0; at < ENG_WIDE; at += ENG_F_LANES) {
            eng_fi q = eng_fi_turn_halves(eng_fi_load(block->row[end][axis] + at));
            memcpy(turned->row[0][axis] + at, &q, sizeof q);
        }
    }
}

ENG_INLINE void quantised_box_at(const struct eng_quantised_box *box, uint32_t end,
                                 struct eng_quantised_box *at_end)
{
    memcpy(at_end->half[0], box->half[end], sizeof at_end->half[0]);
}

/* ---- boxes up to a time ------------------------------------------------------------ */

/* Write one box up to a time, as quantised_rows_until: numbers as in a vector of lanes,
 * eight at a time. */
ENG_INLINE void quantised_box_until(const struct eng_quantised_box *box,
                                    struct quantised_weights weights, bool around,
                                    struct eng_quantised_box *until)
{
#if ENG_VECTOR_BYTES == 16
    eng_fi q0;
    eng_fi q1;
    memcpy(&q0, box->half[0], sizeof q0);
    memcpy(&q1, box->half[1], sizeof q1);
    eng_fi q = quantised_reached(q0, q1, weights, around);
    memcpy(until->half[0], around ? &q : &q0, sizeof q);
    memcpy(until->half[1], &q, sizeof q);
#elif defined __SSSE3__
    __m128i q0 = _mm_load_si128((const __m128i *)(const void *)box->half[0]);
    __m128i q1 = _mm_load_si128((const __m128i *)(const void *)box->half[1]);
    __m128i q = _mm_adds_epi16(_mm_mulhrs_epi16(q0, _mm_set1_epi16(weights.begin)),
                               _mm_mulhrs_epi16(q1, _mm_set1_epi16(weights.end)));
    q = _mm_adds_epi16(q, _mm_set1_epi16(ENG_QUANTISED_REACH_SPARE));
    q = around ? _mm_max_epi16(q, q0) : q;
    _mm_store_si128((__m128i *)(void *)until->half[0], around ? q : q0);
    _mm_store_si128((__m128i *)(void *)until->half[1], q);
#else
    for (uint32_t half = 0; half < 8; half++) {
        int32_t q0 = box->half[0][half];
        int32_t q =
            quantised_clamped(((q0 * weights.begin + 0x4000) >> 15) +
                              ((box->half[1][half] * weights.end + 0x4000) >> 15));
        q = quantised_clamped(q + ENG_QUANTISED_REACH_SPARE);
        q = around && q < q0 ? q0 : q;
        until->half[0][half] = (int16_t)(around ? q : q0);
        until->half[1][half] = (int16_t)q;
    }
#endif
}

#endif
