/* daemon/engine/kernel/boxes.h - moving boxes in rows of sixteen.
 *
 * Room:     engine. May include: the C library.
 * Does:     name the two forms of a box at both ends of a step, and what two blocks of
 *           boxes are joined with.
 * Threads:  [any].
 *
 * A bound is kept as its distance outward: minus the lower, plus the upper. So a union is
 * a maximum everywhere, and two boxes are apart along an axis, one below the other, where
 * -lower(a) + upper(b) < 0: the sign of a sum is exact, whatever it was rounded to.
 */
#ifndef ENG_BOXES_H
#define ENG_BOXES_H

#include <stdbool.h>
#include <stdint.h>

/* Boxes of a block, for every instruction set: 2^ENG_WIDE_BITS. */
#define ENG_WIDE      16u
#define ENG_WIDE_BITS 4u

/* The sides of a moving box. */
enum eng_side { ENG_LOW0, ENG_LOW1, ENG_HIGH0, ENG_HIGH1, ENG_SIDES };

/* Outward distances of no box: |x| <= 1e18 < 2^60. It meets none, itself included, and is
 * neutral to unions. */
#define ENG_NOWHERE (-0x1p100f)

/* One box: [side][axis], the fourth of each side is not looked at. A cache line. */
struct eng_extents {
    _Alignas(64) float side[ENG_SIDES][4];
};

/* Sixteen boxes: [side][axis][lane]. */
struct eng_wide_block {
    _Alignas(64) float row[ENG_SIDES][3][ENG_WIDE];
};

/* Boxes in whole numbers of 16 bits, two to a lane: [end][axis][lane], each an outward
 * distance below (bits 0 .. 15) and one above (bits 16 .. 31), in cells of a grid. Larger
 * than the boxes by a cell or so, and compared by half as many operations. */
struct eng_narrow_block {
    _Alignas(64) uint32_t row[2][3][ENG_WIDE];
};

/* One of them: [end][2 axis]: above, [end][2 axis + 1]: below; the last two are 0. */
struct eng_narrow_box {
    _Alignas(32) int16_t half[2][8];
};

/* From the distances in a float box to cells: x scale[axis] + below or above[axis]. The
 * two, which are the origin and its opposite, add up to ENG_NARROW_ROUND or more. */
struct eng_narrowing {
    float scale[4]; /* powers of two; the fourth of all is 0 */
    float below[4];
    float above[4];
};

/* Makes up for what two conversions are off by (narrow.c). */
#define ENG_NARROW_ROUND 0x1.08p0f

/* The most cells that a bound may be away from the origin: so that the numbers of no box,
 * INT16_MIN, meet none, with what narrow.h adds. */
#define ENG_NARROW_REACH 32700

/* How two boxes are compared. */
enum eng_join_boxes {
    ENG_JOIN_MOVING, /* can each axis bring them together before or at t_end? */
    ENG_JOIN_NEAR,   /* does what they cover up to t_end, which is near, overlap? Weaker,
                      * and half the work. */
    ENG_JOIN_SWEPT   /* do they overlap? Both ends are the same. */
};

#define ENG_JOIN_NO_BLOCK UINT32_MAX

/* Two lists of blocks whose boxes are tested against each other. Pairs of boxes are named
 * by ENG_WIDE times the block plus the lane. */
struct eng_join {
    const struct eng_wide_block *a;
    const struct eng_wide_block *b;
    const struct eng_extents *b_boxes; /* around each block of b */
    /* The same in whole numbers, compared in the place of a, b and b_boxes; or NULL.
     * Only of features that move. */
    const struct eng_narrow_block *a_narrow;
    const struct eng_narrow_block *b_narrow;
    const struct eng_narrow_box *b_narrow_boxes;
    /* Of features: three (faces) or two (edges) arrays of the vertices of each; vertices
     * stand for themselves: NULL. Pairs that share one are left out. */
    const uint32_t *a_corner[3];
    const uint32_t *b_corner[3];
    enum eng_join_boxes boxes;
    float t_end;         /* 0 .. 1; swept boxes: not looked at */
    bool in_time;        /* of moving boxes, those that no time brings together on all
                             * axes are left out, too */
    uint32_t near_block; /* of a, which `near` holds; ENG_JOIN_NO_BLOCK after t_end was
                             * set */
    union {
        struct eng_wide_block block;
        struct eng_narrow_block narrow;
    } near;
    uint64_t tests;         /* counts: one box against a block */
    uint64_t apart_in_time; /* counts: pairs left out for in_time */
};

/* Pairs that the boxes of two blocks make at most, and the places behind the last one
 * that a kernel may write to. */
#define ENG_JOIN_MAX   (ENG_WIDE * ENG_WIDE)
#define ENG_JOIN_SPARE ENG_WIDE

#endif
