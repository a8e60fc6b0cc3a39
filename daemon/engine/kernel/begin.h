/* begin.h - compares quantised boxes as they are at the beginning of the step, for a
 * search that ends shortly after t = 0.
 *
 * Threads: [any]; inline only. Included by files of this folder alone.
 *
 * A number (quantised.h) grows by at most `farthest` from the one end of the step to the
 * other, so a sum of two by 2 t_end farthest until t_end. Where that and the sum are
 * negative the boxes are apart all the while. The same holds of a box around others,
 * whose numbers are the largest of theirs.
 */
#ifndef ENG_BEGIN_H
#define ENG_BEGIN_H

#include "overlap.h"
#include "quantised.h"

/* What two boxes around the way up to a time grow by for their rounding alone
 * (quantised.h): as long as they grow by less, boxes that are compared as they begin are
 * the smaller ones. */
#define ENG_QUANTISED_GROWTH_MAX (2 * ENG_QUANTISED_REACH_SPARE)

/* What two numbers that grow by `farthest` or less grow by together until t_end, 0 .. 1,
 * rounded up to a whole number >= 1; 0: more than ENG_QUANTISED_GROWTH_MAX. */
ENG_INLINE uint32_t quantised_growth(uint32_t farthest, float t_end)
{
    float growth = 2 * t_end * (float)farthest; /* off by 2^-23 of itself */
    return growth < ENG_QUANTISED_GROWTH_MAX ? 1 + (uint32_t)growth : 0;
}

/* Bit i: the box may meet that in lane i while numbers grow by `growth` together.
 * `turned`: the box, against rows that are not (quantised.h). */
ENG_INLINE uint32_t overlap_from_begin(struct bounds box, struct bounds rows, bool turned,
                                       uint32_t growth)
{
    eng_fi grown[3];
    uint32_t bits = 0;
#pragma GCC unroll 3
    for (uint32_t axis = 0; axis < 3; axis++) {
        eng_fi words = eng_fi_all(word_of(box, 0, axis));
        words = turned ? eng_fi_turn_halves(words) : words;
        grown[axis] = eng_fi_add_halves(words, eng_fi_all(growth << 16 | growth));
    }
    UNROLL_PARTS
    for (uint32_t part = 0; part < PARTS; part++) {
        uint32_t at = part * ENG_F_LANES;
        eng_fi h[3];
#pragma GCC unroll 3
        for (uint32_t axis = 0; axis < 3; axis++) {
            h[axis] =
                eng_fi_add_halves(grown[axis], eng_fi_load(place_of(rows, 0, axis, at)));
        }
        bits |= eng_left_bits(eng_left_of_halves(eng_fi_or_or(h[0], h[1], h[2]))) << at;
    }
    return bits;
}

#endif
