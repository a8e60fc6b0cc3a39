/* make_boxes.c - boxes of points, features and blocks. */
#include "table.h"

typedef float half __attribute__((vector_size(ENG_D_LANES * 4), may_alias));
typedef int32_t half_bits __attribute__((vector_size(ENG_D_LANES * 4), may_alias));

/* The coordinates of a point, without its words: as doubles these would be denormal, and
 * arithmetic on one takes a hundred times as long. */
static const int64_t is_coordinate[8] = {-1, -1, -1, 0, -1, -1, -1, 0};

/* All bits of the lanes in which a < b. */
ENG_INLINE eng_di where_less(eng_d a, eng_d b)
{
#if ENG_D_LANES == 1
    return (eng_di){-(int64_t)(a < b)};
#else
    return (eng_di)(a < b);
#endif
}

/* The nearest float of each lane, and by how much it lies above x. The difference is
 * exact: both are doubles, and one is the other rounded. */
ENG_INLINE half nearest_floats(eng_d x, eng_d *above)
{
    float rounded[ENG_D_LANES];
    half nearest;
    eng_d_quantised(rounded, x);
    memcpy(&nearest, rounded, sizeof nearest);
    *above = eng_d_widen(rounded) - x;
    return nearest;
}

/* Outward distances of coordinates, rounded outward: the nearest float, moved by one unit
 * where it lies on the wrong side, as eng_round_down and eng_round_up do (aabb.h). Zeros
 * lose their sign (-0 + 0 is 0): the join takes the sum of two that meet for a gap if it
 * has one, and -0 + -0 has. */
ENG_INLINE void round_out(half nearest, eng_d above, half *low, half *high)
{
    const eng_d zero = {0};
    half_bits unit = ((half_bits)nearest >> 31) | 1;
    half_bits is_above = __builtin_convertvector(where_less(zero, above), half_bits);
    half_bits is_below = __builtin_convertvector(where_less(above, zero), half_bits);
    *low = (half)(((half_bits)nearest - (unit & is_above)) ^ INT32_MIN) + 0.0f;
    *high = (half)((half_bits)nearest + (unit & is_below)) + 0.0f;
}

/* The box of a coordinate as it is. */
ENG_INLINE void box_plain(eng_d x, half *low, half *high)
{
    eng_d above;
    half nearest = nearest_floats(x, &above);
    round_out(nearest, above, low, high);
}

/* The box of (x - origin) scale, exactly: of the rounded difference and what it leaves
 * out. That is at most half a unit of the difference's last place, less than any distance
 * but 0 between it and a float: so the sum of the two has the right sign. */
ENG_INLINE void box_framed(eng_d x, eng_d origin, double scale, half *low, half *high)
{
    eng_d difference = x - origin;
    eng_d subtracted = difference - x;
    eng_d rest = (x - (difference - subtracted)) - (origin + subtracted);
    eng_d above;
    half nearest = nearest_floats(difference * scale, &above);
    round_out(nearest, above - rest * scale, low, high);
}

/* The same box at both ends: around both. */
ENG_INLINE void unite_ends(struct eng_extents *box)
{
#pragma GCC unroll 2
    for (int side = 0; side < ENG_SIDES; side += 2) {
        eng_float4 end[2];
        memcpy(end, box->side[side], sizeof end);
        end[0] = end[1] = eng_float4_max(end[0], end[1]);
        memcpy(box->side[side], end, sizeof end);
    }
}

ENG_INLINE void box_points(const struct eng_point *points, uint32_t count,
                           const struct eng_box_frame *frame, bool swept,
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
            if (frame) {
                box_framed(eng_d_of(bits & mask), eng_d_load(frame->origin + k),
                           frame->scale, &box[0], &box[1]);
            } else {
                box_plain(eng_d_of(bits & mask), &box[0], &box[1]);
            }
            memcpy(low + 4 * k, &box[0], sizeof box[0]);
            memcpy(high + 4 * k, &box[1], sizeof box[1]);
        }
        if (swept) {
            unite_ends(&boxes[i]);
        }
    }
}

void ENG_KERNEL(box_points)(const struct eng_point *points, uint32_t count,
                            const struct eng_box_frame *frame, bool swept,
                            struct eng_extents *boxes)
{
    if (frame) {
        box_points(points, count, frame, swept, boxes);
    } else {
        box_points(points, count, NULL, swept, boxes);
    }
}

/* From one side of a block that is written to the next: of swept boxes those at one end,
 * half of the bytes. */
ENG_INLINE int sides_apart(bool swept)
{
    return swept ? 2 : 1;
}

#if ENG_F_LANES == 16

/* A box on its way, and those of a block: a register each. */
typedef eng_f way_box;

struct sixteen {
    way_box box[ENG_WIDE];
};

ENG_INLINE void put(struct sixteen *boxes, uint32_t lane, eng_f box)
{
    boxes->box[lane] = box;
}

ENG_INLINE eng_f load(const struct eng_extents *box)
{
    return eng_f_load(&box->side[0][0]);
}

/* Sides of boxes j, j + 4, j + 8 and j + 12, for j = 0 .. 3: first[side][j] has a quarter
 * of each box. */
ENG_INLINE void split_sides(const struct sixteen *boxes, __m512 first[ENG_SIDES][4])
{
#pragma GCC unroll 4
    for (int j = 0; j < 4; j++) {
        __m512 a = (__m512)boxes->box[j];
        __m512 b = (__m512)boxes->box[j + 4];
        __m512 c = (__m512)boxes->box[j + 8];
        __m512 d = (__m512)boxes->box[j + 12];
        __m512 ab01 = _mm512_shuffle_f32x4(a, b, 0x44);
        __m512 ab23 = _mm512_shuffle_f32x4(a, b, 0xee);
        __m512 cd01 = _mm512_shuffle_f32x4(c, d, 0x44);
        __m512 cd23 = _mm512_shuffle_f32x4(c, d, 0xee);
        first[0][j] = _mm512_shuffle_f32x4(ab01, cd01, 0x88);
        first[1][j] = _mm512_shuffle_f32x4(ab01, cd01, 0xdd);
        first[2][j] = _mm512_shuffle_f32x4(ab23, cd23, 0x88);
        first[3][j] = _mm512_shuffle_f32x4(ab23, cd23, 0xdd);
    }
}

/* The box around all, and all of them into rows: 60 shuffles, where four boxes at a time
 * (below) take 112 and three stores for one. */
ENG_INLINE void fold(const struct sixteen *boxes, bool swept,
                     struct eng_wide_block *block, struct eng_extents *around)
{
    eng_f all[ENG_WIDE / 2];
    __m512 side[ENG_SIDES][4];
#pragma GCC unroll 8
    for (uint32_t i = 0; i < ENG_WIDE / 2; i++) {
        all[i] = eng_f_max(boxes->box[i], boxes->box[i + ENG_WIDE / 2]);
    }
#pragma GCC unroll 3
    for (uint32_t n = ENG_WIDE / 4; n > 0; n /= 2) {
#pragma GCC unroll 4
        for (uint32_t i = 0; i < n; i++) {
            all[i] = eng_f_max(all[i], all[i + n]);
        }
    }
    eng_f_store(&around->side[0][0], all[0]);
    split_sides(boxes, side);
#pragma GCC unroll 4
    for (int s = 0; s < ENG_SIDES; s += sides_apart(swept)) {
        __m512 xy01 = _mm512_unpacklo_ps(side[s][0], side[s][1]);
        __m512 xy23 = _mm512_unpacklo_ps(side[s][2], side[s][3]);
        __m512 z01 = _mm512_unpackhi_ps(side[s][0], side[s][1]);
        __m512 z23 = _mm512_unpackhi_ps(side[s][2], side[s][3]);
        _mm512_store_ps(block->row[s][0], _mm512_shuffle_ps(xy01, xy23, 0x44));
        _mm512_store_ps(block->row[s][1], _mm512_shuffle_ps(xy01, xy23, 0xee));
        _mm512_store_ps(block->row[s][2], _mm512_shuffle_ps(z01, z23, 0x44));
    }
}

ENG_INLINE eng_f larger(eng_f a, eng_f b)
{
    return eng_f_max(a, b);
}

#else

typedef struct eng_extents way_box;

struct sixteen {
    way_box box[ENG_WIDE];
};

ENG_INLINE void put(struct sixteen *boxes, uint32_t lane, struct eng_extents box)
{
    boxes->box[lane] = box;
}

ENG_INLINE struct eng_extents load(const struct eng_extents *box)
{
    return *box;
}

ENG_INLINE struct eng_extents larger(struct eng_extents a, struct eng_extents b)
{
    struct eng_extents box;
#if ENG_F_LANES > 1
#pragma GCC unroll 4
#endif
    for (size_t i = 0; i < 16; i += ENG_F_LANES) {
        eng_f x = eng_f_load(&a.side[0][0] + i);
        eng_f y = eng_f_load(&b.side[0][0] + i);
        eng_f_store(&box.side[0][0] + i, eng_f_max(x, y));
    }
    return box;
}

/* Four boxes' side into rows, from lane `lane` on. */
ENG_INLINE void turn(const struct eng_extents *boxes, int side, uint32_t lane,
                     struct eng_wide_block *block)
{
    eng_float4 x[4];
    for (uint32_t i = 0; i < 4; i++) {
        memcpy(&x[i], boxes[lane + i].side[side], sizeof x[i]);
    }
    eng_float4 xy01 = __builtin_shufflevector(x[0], x[1], 0, 4, 1, 5);
    eng_float4 xy23 = __builtin_shufflevector(x[2], x[3], 0, 4, 1, 5);
    eng_float4 zw01 = __builtin_shufflevector(x[0], x[1], 2, 6, 3, 7);
    eng_float4 zw23 = __builtin_shufflevector(x[2], x[3], 2, 6, 3, 7);
    eng_float4 out[3] = {__builtin_shufflevector(xy01, xy23, 0, 1, 4, 5),
                         __builtin_shufflevector(xy01, xy23, 2, 3, 6, 7),
                         __builtin_shufflevector(zw01, zw23, 0, 1, 4, 5)};
    for (int k = 0; k < 3; k++) {
        memcpy(&block->row[side][k][lane], &out[k], sizeof out[k]);
    }
}

ENG_INLINE void fold(const struct sixteen *boxes, bool swept,
                     struct eng_wide_block *block, struct eng_extents *around)
{
    struct eng_extents all = boxes->box[0];
    for (uint32_t i = 1; i < ENG_WIDE; i++) {
        all = larger(all, boxes->box[i]);
    }
    *around = all;
    for (int side = 0; side < ENG_SIDES; side += sides_apart(swept)) {
        for (uint32_t lane = 0; lane < ENG_WIDE; lane += 4) {
            turn(boxes->box, side, lane, block);
        }
    }
}

#endif

ENG_INLINE void box_fold(const struct eng_extents *boxes, uint32_t block_count,
                         bool swept, struct eng_wide_block *blocks,
                         struct eng_extents *around)
{
    for (uint32_t i = 0; i < block_count; i++) {
        struct sixteen sixteen;
#pragma GCC unroll 16
        for (uint32_t lane = 0; lane < ENG_WIDE; lane++) {
            put(&sixteen, lane, load(&boxes[i * ENG_WIDE + lane]));
        }
        fold(&sixteen, swept, &blocks[i], &around[i]);
    }
}

void ENG_KERNEL(box_fold)(const struct eng_extents *boxes, uint32_t block_count,
                          bool swept, struct eng_wide_block *blocks,
                          struct eng_extents *around)
{
    if (swept) {
        box_fold(boxes, block_count, true, blocks, around);
    } else {
        box_fold(boxes, block_count, false, blocks, around);
    }
}

ENG_INLINE void box_unite(const struct eng_extents *points,
                          const uint32_t *const corner[3], uint32_t corners, bool swept,
                          uint32_t block_count, struct eng_wide_block *blocks,
                          struct eng_extents *around)
{
    for (uint32_t i = 0; i < block_count; i++) {
        struct sixteen sixteen;
#pragma GCC unroll 16
        for (uint32_t lane = 0; lane < ENG_WIDE; lane++) {
            uint32_t slot = i * ENG_WIDE + lane;
            way_box box =
                larger(load(&points[corner[0][slot]]), load(&points[corner[1][slot]]));
            if (corners == 3) {
                box = larger(box, load(&points[corner[2][slot]]));
            }
            put(&sixteen, lane, box);
        }
        fold(&sixteen, swept, &blocks[i], &around[i]);
    }
}

void ENG_KERNEL(box_unite)(const struct eng_extents *points,
                           const uint32_t *const corner[3], uint32_t block_count,
                           bool swept, struct eng_wide_block *blocks,
                           struct eng_extents *around)
{
    if (corner[2]) {
        swept ? box_unite(points, corner, 3, true, block_count, blocks, around)
              : box_unite(points, corner, 3, false, block_count, blocks, around);
    } else {
        swept ? box_unite(points, corner, 2, true, block_count, blocks, around)
              : box_unite(points, corner, 2, false, block_count, blocks, around);
    }
}
