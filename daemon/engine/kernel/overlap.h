/* overlap.h - compares one box with sixteen others at once.
 *
 * Threads: [any]; inline only. Included by files of this folder alone.
 *
 * One box against sixteen takes, a register of sixteen lanes wide: per axis four sums and
 * two ands of sign bits, 18 operations in all, 9 cycles where two are done at a time (12
 * with compares, of which one is). No box has a zero with a sign (make_boxes.c), so the
 * sum of two bounds that touch is 0 without one. Boxes that stand still take half of
 * that: plain swept ones, and those up to a time that is near (reach.h).
 *
 * Boxes in whole numbers (quantised.h) take half of either: features that move are
 * compared so where the scene allows it.
 *
 * Up to a time. The gap along an axis, g(t) = (1 - t) g0 + t g1, is linear: where g0 > 0,
 * it stays positive up to t_end if g(t_end) > 0. What is computed here is h = -g: h0 and
 * h1 are sums of two floats, with a relative error of u = 2^-24 each. If h1 < 0 as well
 * the boxes are apart for the whole step. Else h0 < 0 <= h1, and
 *     s h0 + t h1 < 0 with s = (1 - t_end) - 2^-20, t = t_end + 2^-20
 * says it, if h0 and h1 are exact: it is the wanted sum and 2^-20 (|h0| + |h1|) more.
 * What is computed is (s / t) h0 + h1, that over t. s is off by 2 u at most, then t, h0,
 * the quotient and the product by u of themselves each: all in all by less than
 * 6 u |h0| / t, and h1 by u |h1|, of 2^-20 (|h0| + |h1|) / t. The sum of the two has the
 * sign that it should have. 2^-120 covers products below the normal range.
 */
#ifndef ENG_OVERLAP_H
#define ENG_OVERLAP_H

#include "boxes.h"
#include "lanes_pack.h"
#include "quantised.h"

#define PARTS (ENG_WIDE / ENG_F_LANES)

/* Before a loop over the parts. One lane at a time, sixteen of them written out in all
 * kinds of joins would be 0.7 MB of code. */
#if ENG_F_LANES == 1
#define UNROLL_PARTS
#else
#define UNROLL_PARTS _Pragma("GCC unroll 16")
#endif

/* What pairs are tested for: moving boxes over the step, or up to a time; boxes that
 * stand still, as they are, or around the way up to a time. In whole numbers: the same
 * but for boxes as they are, and, up to a time, as they begin (begin.h). */
enum rule {
    RULE_STEP,
    RULE_UNTIL,
    RULE_SWEPT,
    RULE_NEAR,
    RULE_QUANTISED_STEP,
    RULE_QUANTISED_UNTIL,
    RULE_QUANTISED_NEAR,
    RULE_QUANTISED_BEGIN
};

ENG_INLINE bool is_quantised(enum rule rule)
{
    return rule >= RULE_QUANTISED_STEP;
}

/* s / t of the comment above. */
ENG_INLINE eng_f until_of(float t_end)
{
    return eng_f_all((1.0f - t_end - 0x1p-20f) / (t_end + 0x1p-20f));
}

/* One box, or rows of sixteen: floats, or the two ends' pairs of whole numbers. Sides and
 * axes are so many numbers of four bytes apart. */
struct bounds {
    const void *x;
    uint32_t side;
    uint32_t axis;
};

/* Where a bound is, that of the box in lane `at`. */
ENG_INLINE const uint32_t *place_of(struct bounds bounds, uint32_t side, uint32_t axis,
                                    uint32_t at)
{
    return (const uint32_t *)bounds.x + (side * bounds.side + axis * bounds.axis + at);
}

ENG_INLINE uint32_t word_of(struct bounds box, uint32_t side, uint32_t axis)
{
    uint32_t word;
    memcpy(&word, place_of(box, side, axis, 0), sizeof word);
    return word;
}

ENG_INLINE eng_f bound(struct bounds box, uint32_t side, uint32_t axis)
{
    uint32_t word = word_of(box, side, axis);
    float x;
    memcpy(&x, &word, sizeof x);
    return eng_f_all(x);
}

ENG_INLINE eng_f row_of(struct bounds rows, uint32_t side, uint32_t axis, uint32_t at)
{
    eng_f row;
    memcpy(&row, place_of(rows, side, axis, at), sizeof row);
    return row;
}

/* Signs: those of `signs`, and where the boxes are apart one way. */
ENG_INLINE eng_fi apart_one_way(eng_fi signs, eng_f h0, eng_f h1, enum rule rule,
                                eng_f until)
{
    if (rule == RULE_UNTIL) {
        h1 = until * h0 + (h1 + 0x1p-120f);
    }
    return eng_fi_or_and(signs, (eng_fi)h0, (eng_fi)h1);
}

/* Signs of the lanes from `at` on that the box does not meet. */
ENG_INLINE eng_fi apart_as_floats(struct bounds box, struct bounds rows, uint32_t at,
                                  enum rule rule, eng_f until)
{
    eng_fi signs = {0};
#pragma GCC unroll 3
    for (uint32_t axis = 0; axis < 3; axis++) {
        eng_f up0 = bound(box, ENG_LOW0, axis) + row_of(rows, ENG_HIGH0, axis, at);
        eng_f down0 = bound(box, ENG_HIGH0, axis) + row_of(rows, ENG_LOW0, axis, at);
        if (rule == RULE_SWEPT || rule == RULE_NEAR) {
            signs = eng_fi_or_or(signs, (eng_fi)up0, (eng_fi)down0);
            continue;
        }
        eng_f up1 = bound(box, ENG_LOW1, axis) + row_of(rows, ENG_HIGH1, axis, at);
        eng_f down1 = bound(box, ENG_HIGH1, axis) + row_of(rows, ENG_LOW1, axis, at);
        signs = apart_one_way(signs, up0, up1, rule, until);
        signs = apart_one_way(signs, down0, down1, rule, until);
    }
    return signs;
}

/* The same in whole numbers, of either half. */
ENG_INLINE eng_fi apart_as_pairs(struct bounds box, struct bounds rows, uint32_t at,
                                 enum rule rule)
{
    eng_fi h0[3];
    eng_fi signs = {0};
#pragma GCC unroll 3
    for (uint32_t axis = 0; axis < 3; axis++) {
        h0[axis] = eng_fi_add_halves(eng_fi_all(word_of(box, 0, axis)),
                                     eng_fi_load(place_of(rows, 0, axis, at)));
        if (rule != RULE_QUANTISED_NEAR) {
            eng_fi h1 = eng_fi_add_halves(eng_fi_all(word_of(box, 1, axis)),
                                          eng_fi_load(place_of(rows, 1, axis, at)));
            signs = eng_fi_or_and(signs, h0[axis], h1);
        }
    }
    return rule == RULE_QUANTISED_NEAR ? eng_fi_or_or(h0[0], h0[1], h0[2]) : signs;
}

/* Bit i: the box may meet that in lane i. */
ENG_INLINE uint32_t overlap(struct bounds box, struct bounds rows, enum rule rule,
                            eng_f until)
{
    uint32_t bits = 0;
    UNROLL_PARTS
    for (uint32_t part = 0; part < PARTS; part++) {
        uint32_t at = part * ENG_F_LANES;
        eng_left left = is_quantised(rule)
                            ? eng_left_of_halves(apart_as_pairs(box, rows, at, rule))
                            : eng_left_of(apart_as_floats(box, rows, at, rule, until));
        bits |= eng_left_bits(left) << at;
    }
    return bits;
}

#endif
