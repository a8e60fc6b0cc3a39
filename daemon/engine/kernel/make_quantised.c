/* make_quantised.c - blocks of boxes in whole numbers of 16 bits.
 *
 * x scale is exact, or below the normal range, where it is off by 2^-150. The sum with
 * the origin is off by 2^-24 of itself, 2^-9 at most where it is at most 2^15; the sum
 * with WHOLE, whose lowest bits are a whole number, by 1/2. So two such numbers add up to
 * at least the exact sum, and that of the origins, less 1 + 2^-8: ENG_QUANTISED_ROUND is
 * more. What is below INT16_MIN becomes that, which is outward.
 */
#include "quantised.h"

#include "table.h"

#define WHOLE 0x1.8p23f

/* The number is in the lowest bits. */
ENG_INLINE eng_fi whole_of(const float *x, float scale, float origin)
{
    eng_f y = eng_f_load(x) * scale + origin;
    return (eng_fi)(eng_f_max(y, eng_f_all(-0x1p15f)) + WHOLE);
}

/* Returns the larger of `farthest` and what the numbers grow by: that of whole_of less
 * another is the numbers' own difference. */
ENG_INLINE eng_fi quantised_block(const struct eng_wide_block *block,
                                  const struct eng_quantising *quantising,
                                  eng_fi farthest, struct eng_quantised_block *quantised)
{
#pragma GCC unroll 3
    for (uint32_t k = 0; k < 3; k++) {
        float scale = quantising->scale[k];
        for (uint32_t at = 0; at < ENG_WIDE; at += ENG_F_LANES) {
            eng_fi below[2];
            eng_fi above[2];
#pragma GCC unroll 2
            for (uint32_t end = 0; end < 2; end++) {
                const float *low = block->row[ENG_LOW0 + end][k] + at;
                const float *high = block->row[ENG_HIGH0 + end][k] + at;
                below[end] = whole_of(low, scale, quantising->below[k]);
                above[end] = whole_of(high, scale, quantising->above[k]);
                eng_fi both = (below[end] & 0xffff) | (above[end] << 16);
                memcpy(quantised->row[end][k] + at, &both, sizeof both);
            }
            farthest = eng_fi_max(farthest,
                                  eng_fi_max(below[1] - below[0], above[1] - above[0]));
        }
    }
    return farthest;
}

/* Distances of one side and end, in cells. */
ENG_INLINE eng_float4 cells_of(const float side[4], eng_float4 scale,
                               const float origin[4])
{
    eng_float4 x;
    eng_float4 c;
    memcpy(&x, side, sizeof x);
    memcpy(&c, origin, sizeof c);
    return x * scale + c;
}

ENG_INLINE eng_bits4 whole_float4(eng_float4 y)
{
    return (eng_bits4)(eng_float4_max(y, (eng_float4){0} - 0x1p15f) + WHOLE);
}

/* Returns the larger of `most` and the box's distances, in cells. */
ENG_INLINE eng_float4 quantised_box(const struct eng_extents *box,
                                    const struct eng_quantising *quantising,
                                    eng_float4 most, struct eng_quantised_box *quantised)
{
    eng_float4 scale;
    memcpy(&scale, quantising->scale, sizeof scale);
#pragma GCC unroll 2
    for (uint32_t end = 0; end < 2; end++) {
        eng_float4 below = cells_of(box->side[ENG_LOW0 + end], scale, quantising->below);
        eng_float4 above = cells_of(box->side[ENG_HIGH0 + end], scale, quantising->above);
        eng_bits4 both = (whole_float4(above) & 0xffff) | (whole_float4(below) << 16);
        memcpy(quantised->half[end], &both, sizeof both);
        most = eng_float4_max(most, eng_float4_max(below, above));
    }
    return most;
}

bool ENG_KERNEL(quantised_blocks)(const struct eng_wide_block *blocks,
                                  const struct eng_extents *around, uint32_t count,
                                  const struct eng_quantising *quantising,
                                  struct eng_quantised_block *quantised,
                                  struct eng_quantised_box *quantised_around,
                                  uint32_t *farthest)
{
    eng_float4 most = {0};
    eng_fi grown = {0};
    for (uint32_t i = 0; i < count; i++) {
        grown = quantised_block(&blocks[i], quantising, grown, &quantised[i]);
        most = quantised_box(&around[i], quantising, most, &quantised_around[i]);
    }
    for (uint32_t lane = 0; lane < ENG_F_LANES; lane++) {
        *farthest = (uint32_t)grown[lane] > *farthest ? (uint32_t)grown[lane] : *farthest;
    }
    return most[0] <= ENG_QUANTISED_REACH && most[1] <= ENG_QUANTISED_REACH &&
           most[2] <= ENG_QUANTISED_REACH;
}
