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
#include "halves.h"

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

/* What is reached of q0 .. q1 by then; `around`: what was reached up to then. */
ENG_INLINE eng_fi quantised_reached(eng_fi q0, eng_fi q1,
                                    struct quantised_weights weights, bool around)
{
    const uint32_t spare = ENG_QUANTISED_REACH_SPARE;
    eng_fi q = eng_fi_add_halves(eng_fi_weigh_halves(q0, weights.begin),
                                 eng_fi_weigh_halves(q1, weights.end));
    q = eng_fi_add_halves(q, eng_fi_all(spare << 16 | spare));
    return around ? eng_fi_max_halves(q, q0) : q;
}

/* The rows of both ends with their halves turned: what is below comes to what is above
 * where a box that is not turned is added. */
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

/* The rows of both ends up to a time; `around`: of the first alone, around the way.
 * `turned`: as above. */
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

/* The rows there, larger by some cells along each axis. No box stays none. A sum that is
 * cut to INT16_MAX keeps its sign beside the least that there is. */
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

/* The rows there with their halves turned, and the box around them as it is. */
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

/* The same of one box: numbers as in a vector of lanes, eight at a time. */
ENG_INLINE void quantised_box_until(const struct eng_quantised_box *box,
                                    struct quantised_weights weights, bool around,
                                    struct eng_quantised_box *until)
{
#ifdef __SSSE3__
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
