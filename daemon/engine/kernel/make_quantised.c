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

/* ---- features, of their vertices' numbers ------------------------------------------ */

#define FOUR 4u /* features at a time */
#define ROWS 6u /* of a block */

typedef int16_t numbers __attribute__((vector_size(16), may_alias));
typedef uint32_t both __attribute__((vector_size(16), may_alias));

ENG_INLINE both larger(both a, both b)
{
#if ENG_VECTOR_BYTES >= 32
    return (both)_mm_max_epi16((__m128i)a, (__m128i)b);
#elif ENG_VECTOR_BYTES == 16
    return (both)eng_fi_max_halves((eng_fi)a, (eng_fi)b);
#else
    numbers is_larger = (numbers)a > (numbers)b;
    return (both)(((numbers)a & is_larger) | ((numbers)b & ~is_larger));
#endif
}

/* Return the largest of four on each axis, and 0: an end of a box. */
ENG_INLINE both largest_lanes(both x, both y, both z)
{
    both xy = larger(__builtin_shufflevector(x, y, 0, 1, 4, 5),
                     __builtin_shufflevector(x, y, 2, 3, 6, 7));
    both zz = larger(z, __builtin_shufflevector(z, z, 2, 3, 0, 1));
    both box = larger(__builtin_shufflevector(xy, zz, 0, 2, 4, 4),
                      __builtin_shufflevector(xy, zz, 1, 3, 5, 5));
    return box & (both){UINT32_MAX, UINT32_MAX, UINT32_MAX, 0};
}

/* Return how many numbers are before those of a vertex, the rows of its lane. */
ENG_INLINE size_t place_of(uint32_t slot)
{
    return slot + (size_t)(slot / ENG_WIDE * ENG_WIDE) * (ROWS - 1);
}

ENG_INLINE void unite(const struct eng_quantised_block *points,
                      const uint32_t *const corner[3], uint32_t corners, uint32_t count,
                      struct eng_quantised_block *quantised,
                      struct eng_quantised_box *around)
{
    const uint32_t *numbers_of = &points->row[0][0][0];
    for (uint32_t block = 0; block < count; block++) {
        uint32_t *out = &quantised[block].row[0][0][0];
        both most[ROWS];
        for (uint32_t at = 0; at < ENG_WIDE; at += FOUR) {
            const uint32_t *of[3][FOUR];
#pragma GCC unroll 3
            for (uint32_t k = 0; k < corners; k++) {
#pragma GCC unroll 4
                for (uint32_t i = 0; i < FOUR; i++) {
                    of[k][i] = numbers_of +
                               place_of(corner[k][block * ENG_WIDE + at + i]);
                }
            }
#pragma GCC unroll 6
            for (uint32_t row = 0; row < ROWS; row++) {
                uint32_t lane = row * ENG_WIDE;
                both box;
#pragma GCC unroll 3
                for (uint32_t k = 0; k < corners; k++) {
                    both other = {of[k][0][lane], of[k][1][lane], of[k][2][lane],
                                  of[k][3][lane]};
                    box = k == 0 ? other : larger(box, other);
                }
                memcpy(out + lane + at, &box, sizeof box);
                most[row] = at == 0 ? box : larger(most[row], box);
            }
        }
        for (uint32_t end = 0; end < 2; end++) {
            /* A box has what is above in the lower half, a block what is below. */
            both box =
                largest_lanes(most[3 * end], most[3 * end + 1], most[3 * end + 2]);
            box = box << 16 | box >> 16;
            memcpy(around[block].half[end], &box, sizeof box);
        }
    }
}

void ENG_KERNEL(quantised_unite)(const struct eng_quantised_block *points,
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
