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
                                  const struct eng_quantised_to *to)
{
    eng_float4 most = {0};
    eng_fi grown = {0};
    for (uint32_t i = 0; i < count; i++) {
        grown = quantised_block(&blocks[i], quantising, grown, &to->blocks[i]);
        most = quantised_box(&around[i], quantising, most, &to->around[i]);
    }
    for (uint32_t lane = 0; lane < ENG_F_LANES; lane++) {
        uint32_t own = (uint32_t)grown[lane];
        *to->farthest = own > *to->farthest ? own : *to->farthest;
    }
    return most[0] <= ENG_QUANTISED_REACH && most[1] <= ENG_QUANTISED_REACH &&
           most[2] <= ENG_QUANTISED_REACH;
}

/* ---- boxes one by one -------------------------------------------------------------- */

/* A box at one end, or at both where a register has room for them. */
#if ENG_VECTOR_BYTES >= 32
#define ENDS 2u
#else
#define ENDS 1u
#endif

typedef float side __attribute__((vector_size(16 * ENDS), may_alias));
typedef int32_t side_bits __attribute__((vector_size(16 * ENDS), may_alias));

ENG_INLINE side twice(const float axes[4])
{
    side both;
    for (uint32_t i = 0; i < ENDS; i++) {
        memcpy((char *)&both + 16 * i, axes, 16);
    }
    return both;
}

ENG_INLINE side_bits whole_side(const float x[4], side scale, side origin)
{
    side y;
    memcpy(&y, x, sizeof y);
    y = y * scale + origin;
#if ENG_VECTOR_BYTES >= 32
    y = (side)_mm256_max_ps((__m256)y, _mm256_set1_ps(-0x1p15f));
#else
    y = (side)eng_float4_max((eng_float4)y, (eng_float4){0} - 0x1p15f);
#endif
    return (side_bits)(y + WHOLE);
}

void ENG_KERNEL(quantised_boxes)(const struct eng_extents *boxes, uint32_t count,
                                 const struct eng_quantising *quantising,
                                 struct eng_quantised_box *quantised)
{
    const side scale = twice(quantising->scale);
    const side below = twice(quantising->below);
    const side above = twice(quantising->above);
    for (uint32_t i = 0; i < count; i++) {
        for (uint32_t end = 0; end < 2; end += ENDS) {
            side_bits low = whole_side(boxes[i].side[ENG_LOW0 + end], scale, below);
            side_bits high = whole_side(boxes[i].side[ENG_HIGH0 + end], scale, above);
            side_bits both = (high & 0xffff) | (low << 16);
            memcpy(quantised[i].half[end], &both, sizeof both);
        }
    }
}

/* ---- features, of their vertices' numbers ------------------------------------------ */

#if ENG_VECTOR_BYTES >= 32
#define UNPACK_LOW(a, b)  __builtin_shufflevector(a, b, 0, 8, 1, 9, 4, 12, 5, 13)
#define UNPACK_HIGH(a, b) __builtin_shufflevector(a, b, 2, 10, 3, 11, 6, 14, 7, 15)
#define JOIN_LOW(a, b)    __builtin_shufflevector(a, b, 0, 1, 8, 9, 4, 5, 12, 13)
#define JOIN_HIGH(a, b)   __builtin_shufflevector(a, b, 2, 3, 10, 11, 6, 7, 14, 15)
#else
#define UNPACK_LOW(a, b)  __builtin_shufflevector(a, b, 0, 4, 1, 5)
#define UNPACK_HIGH(a, b) __builtin_shufflevector(a, b, 2, 6, 3, 7)
#define JOIN_LOW(a, b)    __builtin_shufflevector(a, b, 0, 1, 4, 5)
#define JOIN_HIGH(a, b)   __builtin_shufflevector(a, b, 2, 3, 6, 7)
#endif
#define FOUR 4u /* features at a time */

typedef int16_t numbers __attribute__((vector_size(16 * ENDS), may_alias));
typedef uint32_t both __attribute__((vector_size(16 * ENDS), may_alias));

ENG_INLINE numbers larger(numbers a, numbers b)
{
#if ENG_VECTOR_BYTES == 64
    return (numbers)_mm256_max_epi16((__m256i)a, (__m256i)b);
#elif ENG_VECTOR_BYTES >= 16
    return (numbers)eng_fi_max_halves((eng_fi)a, (eng_fi)b);
#else
    numbers is_larger = a > b;
    return (a & is_larger) | (b & ~is_larger);
#endif
}

/* Four on an axis; a box has what is above in the lower half, a block what is below. */
ENG_INLINE void put_row(both row, struct eng_quantised_block *to, uint32_t end,
                        uint32_t axis, uint32_t at)
{
    row = row << 16 | row >> 16;
    for (uint32_t i = 0; i < ENDS; i++) {
        memcpy(to->row[end + i][axis] + at, (const char *)&row + 16 * i, 16);
    }
}

ENG_INLINE void unite(const struct eng_quantised_box *points,
                      const uint32_t *const corner[3], uint32_t corners, uint32_t count,
                      struct eng_quantised_block *quantised,
                      struct eng_quantised_box *around)
{
    for (uint32_t block = 0; block < count; block++) {
        for (uint32_t end = 0; end < 2; end += ENDS) {
            numbers most = {0};
            for (uint32_t at = 0; at < ENG_WIDE; at += FOUR) {
                uint32_t first = block * ENG_WIDE + at;
                both v[FOUR];
#pragma GCC unroll 4
                for (uint32_t i = 0; i < FOUR; i++) {
                    numbers box;
                    memcpy(&box, points[corner[0][first + i]].half[end], sizeof box);
#pragma GCC unroll 2
                    for (uint32_t k = 1; k < corners; k++) {
                        numbers other;
                        memcpy(&other, points[corner[k][first + i]].half[end],
                               sizeof other);
                        box = larger(box, other);
                    }
                    most = at + i == 0 ? box : larger(most, box);
                    v[i] = (both)box;
                }
                both xy01 = UNPACK_LOW(v[0], v[1]);
                both xy23 = UNPACK_LOW(v[2], v[3]);
                both z01 = UNPACK_HIGH(v[0], v[1]);
                both z23 = UNPACK_HIGH(v[2], v[3]);
                put_row(JOIN_LOW(xy01, xy23), &quantised[block], end, 0, at);
                put_row(JOIN_HIGH(xy01, xy23), &quantised[block], end, 1, at);
                put_row(JOIN_LOW(z01, z23), &quantised[block], end, 2, at);
            }
            memcpy(around[block].half[end], &most, sizeof most);
        }
    }
}

void ENG_KERNEL(quantised_unite)(const struct eng_quantised_box *points,
                                 const uint32_t *const corner[3], uint32_t count,
                                 struct eng_quantised_block *quantised,
                                 struct eng_quantised_box *quantised_around)
{
    if (corner[2] != NULL) {
        unite(points, corner, 3, count, quantised, quantised_around);
    } else {
        unite(points, corner, 2, count, quantised, quantised_around);
    }
}
