/* boxes.h - moving boxes stored sixteen at a time, a row for each bound, ready for vector
 * instructions.
 *
 * A bound is stored as its distance outward: minus the lower bound, plus the upper. So a
 * union is a maximum everywhere. Two boxes are apart along an axis, one below the other,
 * where -lower(a) + upper(b) < 0. The sign of such a sum is exact, however it was
 * rounded.
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
struct eng_quantised_block {
    _Alignas(64) uint32_t row[2][3][ENG_WIDE];
};

/* One of them: [end][2 axis]: above, [end][2 axis + 1]: below; the last two are 0. */
struct eng_quantised_box {
    _Alignas(32) int16_t half[2][8];
};

/* From the distances in a float box to cells: x scale[axis] + below or above[axis]. The
 * two, which are the origin and its opposite, add up to ENG_QUANTISED_ROUND or more. */
struct eng_quantising {
    float scale[4]; /* powers of two; the fourth of all is 0 */
    float below[4];
    float above[4];
};

/* Makes up for what two conversions are off by (make_quantised.c). */
#define ENG_QUANTISED_ROUND 0x1.08p0f

/* The most cells that a bound may be away from the origin: so that the numbers of no box,
 * INT16_MIN, meet none, with what quantised.h adds. */
#define ENG_QUANTISED_REACH 32700

#endif
