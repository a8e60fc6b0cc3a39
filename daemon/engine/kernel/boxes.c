/* daemon/engine/kernel/boxes.c - boxes of points, features and blocks.
 *
 * Room:     engine.
 * Does:     see kernel.h.
 * Threads:  [any].
 */
#include "table.h"

typedef float half __attribute__((vector_size(ENG_D_LANES * 4), may_alias));
typedef int32_t half_bits __attribute__((vector_size(ENG_D_LANES * 4), may_alias));
typedef float four __attribute__((vector_size(16), may_alias));

/* The coordinates of a point, without its words: as doubles these would be denormal, and
 * arithmetic on one takes a hundred times as long. */
static const int64_t is_coordinate[8] = {-1, -1, -1, 0, -1, -1, -1, 0};

/* Outward distances of coordinates, rounded outward: the nearest float, moved by one unit
 * where it lies on the wrong side, as eng_round_down and eng_round_up do (aabb.h). Zeros
 * lose their sign (-0 + 0 is 0): the join takes the sum of two that meet for a gap if it
 * has one, and -0 + -0 has. */
ENG_INLINE void round_out(eng_d x, half *low, half *high)
{
    half nearest = __builtin_convertvector(x, half);
    eng_d back = __builtin_convertvector(nearest, eng_d);
    half_bits unit = ((half_bits)nearest >> 31) | 1;
    half_bits above = __builtin_convertvector((eng_di)(back > x), half_bits);
    half_bits below = __builtin_convertvector((eng_di)(back < x), half_bits);
    *low = (half)(((half_bits)nearest - (unit & above)) ^ INT32_MIN) + 0.0f;
    *high = (half)((half_bits)nearest + (unit & below)) + 0.0f;
}

/* The same box at both ends: around both. */
static void unite_ends(struct eng_extents *box)
{
    for (int end = 0; end < ENG_SIDES; end += 2) {
        for (int k = 0; k < 3; k++) {
            float x0 = box->side[end][k];
            float x1 = box->side[end + 1][k];
            box->side[end][k] = box->side[end + 1][k] = x0 > x1 ? x0 : x1;
        }
    }
}

void ENG_KERNEL(box_points)(const struct eng_point *points, uint32_t count, bool swept,
                            struct eng_extents *boxes)
{
    for (uint32_t i = 0; i < count; i++) {
        const char *x = (const char *)&points[i];
        char *low = (char *)boxes[i].side[ENG_LOW0];
        char *high = (char *)boxes[i].side[ENG_HIGH0];
        for (size_t k = 0; k < 8; k += ENG_D_LANES) {
            eng_di bits;
            eng_di mask;
            half box[2];
            memcpy(&bits, x + 8 * k, sizeof bits);
            memcpy(&mask, is_coordinate + k, sizeof mask);
            round_out((eng_d)(bits & mask), &box[0], &box[1]);
            memcpy(low + 4 * k, &box[0], sizeof box[0]);
            memcpy(high + 4 * k, &box[1], sizeof box[1]);
        }
        if (swept) {
            unite_ends(&boxes[i]);
        }
    }
}

ENG_INLINE struct eng_extents unite(const struct eng_extents *a,
                                    const struct eng_extents *b)
{
    struct eng_extents box;
    for (size_t i = 0; i < 16; i += ENG_F_LANES) {
        eng_f x = eng_f_load(&a->side[0][0] + i);
        eng_f y = eng_f_load(&b->side[0][0] + i);
        eng_f_store(&box.side[0][0] + i, eng_f_max(x, y));
    }
    return box;
}

/* Four boxes' side into rows, from lane `lane` on. */
ENG_INLINE void turn(const struct eng_extents *boxes, int side, uint32_t lane,
                     struct eng_wide_block *block)
{
    four x[4];
    for (uint32_t i = 0; i < 4; i++) {
        memcpy(&x[i], boxes[lane + i].side[side], sizeof x[i]);
    }
    four xy01 = __builtin_shufflevector(x[0], x[1], 0, 4, 1, 5);
    four xy23 = __builtin_shufflevector(x[2], x[3], 0, 4, 1, 5);
    four zw01 = __builtin_shufflevector(x[0], x[1], 2, 6, 3, 7);
    four zw23 = __builtin_shufflevector(x[2], x[3], 2, 6, 3, 7);
    four out[3] = {__builtin_shufflevector(xy01, xy23, 0, 1, 4, 5),
                   __builtin_shufflevector(xy01, xy23, 2, 3, 6, 7),
                   __builtin_shufflevector(zw01, zw23, 0, 1, 4, 5)};
    for (int k = 0; k < 3; k++) {
        memcpy(&block->row[side][k][lane], &out[k], sizeof out[k]);
    }
}

ENG_INLINE void fold(const struct eng_extents *boxes, struct eng_wide_block *block,
                     struct eng_extents *around)
{
    struct eng_extents all = boxes[0];
    for (uint32_t i = 1; i < ENG_WIDE; i++) {
        all = unite(&all, &boxes[i]);
    }
    *around = all;
    for (int side = 0; side < ENG_SIDES; side++) {
        for (uint32_t lane = 0; lane < ENG_WIDE; lane += 4) {
            turn(boxes, side, lane, block);
        }
    }
}

void ENG_KERNEL(box_fold)(const struct eng_extents *boxes, uint32_t block_count,
                          struct eng_wide_block *blocks, struct eng_extents *around)
{
    for (uint32_t i = 0; i < block_count; i++) {
        fold(boxes + i * ENG_WIDE, &blocks[i], &around[i]);
    }
}

void ENG_KERNEL(box_unite)(const struct eng_extents *points,
                           const uint32_t *const corner[3], uint32_t block_count,
                           struct eng_wide_block *blocks, struct eng_extents *around)
{
    for (uint32_t i = 0; i < block_count; i++) {
        struct eng_extents boxes[ENG_WIDE];
        for (uint32_t lane = 0; lane < ENG_WIDE; lane++) {
            uint32_t slot = i * ENG_WIDE + lane;
            boxes[lane] = unite(&points[corner[0][slot]], &points[corner[1][slot]]);
            if (corner[2]) {
                boxes[lane] = unite(&boxes[lane], &points[corner[2][slot]]);
            }
        }
        fold(boxes, &blocks[i], &around[i]);
    }
}
