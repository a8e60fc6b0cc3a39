/* meeting.h - rejects pairs of moving boxes that overlap along each axis at some time,
 * but never along all axes at the same time.
 *
 * Threads: [any]; inline only. Included by files of this folder alone.
 *
 * What moving boxes let through may be apart along x up to some time and along y from an
 * earlier one on. With h0, h1 as in overlap.h boxes can meet along an axis, one way,
 * while (1 - t) h0 + t h1 >= 0: from -h0 / (-h0 + h1) on where h0 < 0, up to h0 / (h0 -
 * h1) where h1 < 0 (both are not: such pairs are gone). At one end of the step boxes are
 * not apart both ways, for the two h0 add up to their sizes: so the lesser is looked at.
 * Where it is not below 0 the first time is to be 0 and the last 1: 0 / (0 + |h1|), and
 * |h0| / (|h0| + 0). Another 2^-100, so that no denominator is 0, makes the first time
 * sooner and the last one later, which rejects less. Numerators have a relative error of
 * 2 u, denominators, sums of terms of one sign, of 3 u. Of several times that which
 * products show to be the latest (soonest) is kept; to take another one rejects less.
 * The last comparison is of two products of a numerator and a denominator each: 2 (2 u +
 * 3 u + u) and u for the factor, and that, 1 + 2^-19, leaves 32 u. 2^-120 covers products
 * below the normal range.
 *
 * In whole numbers (quantised.h) the h of either end are sums of two of 16 bits, exact as
 * floats, and at least those of the boxes, in cells: so is what is between them, and what
 * can meet along an axis can by these numbers, too. Whatever they tell apart is. Here,
 * too, the two h0 add up to no less than the boxes' sizes: so do the two numbers of a box
 * (make_quantised.c). None may be saturated, though: one that is too small at the one end
 * would shorten the time.
 */
#ifndef ENG_MEETING_H
#define ENG_MEETING_H

#include "halves.h"
#include "lanes_pack.h"
#include "overlap.h"

/* The h of both ways, at both ends, of an axis. */
struct gaps {
    eng_f up[2];
    eng_f down[2];
};

ENG_INLINE struct gaps gaps_as_floats(struct bounds box, struct bounds rows,
                                      uint32_t axis, uint32_t at)
{
    struct gaps gaps;
#pragma GCC unroll 2
    for (uint32_t end = 0; end < 2; end++) {
        gaps.up[end] =
            bound(box, ENG_LOW0 + end, axis) + row_of(rows, ENG_HIGH0 + end, axis, at);
        gaps.down[end] =
            bound(box, ENG_HIGH0 + end, axis) + row_of(rows, ENG_LOW0 + end, axis, at);
    }
    return gaps;
}

ENG_INLINE struct gaps gaps_as_pairs(struct bounds box, struct bounds rows, uint32_t axis,
                                     uint32_t at)
{
    struct gaps gaps;
#pragma GCC unroll 2
    for (uint32_t end = 0; end < 2; end++) {
        eng_fi a = eng_fi_all(word_of(box, end, axis));
        eng_fi b = eng_fi_load(place_of(rows, end, axis, at));
        eng_fi up = eng_fi_sum_halves((a & 0xffff) | (b & ~0xffff));
        eng_fi down = eng_fi_sum_halves((b & 0xffff) | (a & ~0xffff));
        gaps.up[end] = __builtin_convertvector(up, eng_f);
        gaps.down[end] = __builtin_convertvector(down, eng_f);
    }
    return gaps;
}

/* A time, n / d. */
struct fraction {
    eng_f n, d;
};

/* Of the two ways of being apart along an axis that which is at one end of the step, if
 * any: how far apart, and the gap that way at the other end. */
struct parting {
    eng_f apart; /* 0 or more */
    eng_f other; /* |.| and 2^-100: more than 0 */
};

ENG_INLINE struct parting parting_of(eng_f up, eng_f down, eng_f other_up,
                                     eng_f other_down)
{
    const eng_f zero = {0};
    eng_f other = eng_f_select(eng_f_less(up, down), other_up, other_down);
    return (struct parting){zero - eng_f_min(eng_f_min(up, down), zero),
                            eng_f_abs(other) + 0x1p-100f};
}

/* The later, or the sooner, of two times. */
ENG_INLINE struct fraction later(struct fraction a, struct fraction b)
{
    eng_fm is_b = eng_f_less(a.n * b.d, b.n * a.d);
    return (struct fraction){eng_f_select(is_b, b.n, a.n), eng_f_select(is_b, b.d, a.d)};
}

ENG_INLINE struct fraction sooner(struct fraction a, struct fraction b)
{
    eng_fm is_b = eng_f_less(b.n * a.d, a.n * b.d);
    return (struct fraction){eng_f_select(is_b, b.n, a.n), eng_f_select(is_b, b.d, a.d)};
}

/* Between which times an axis lets the boxes meet. */
ENG_INLINE void meeting_along(const struct gaps *gaps, struct fraction *from,
                              struct fraction *to)
{
    struct parting first =
        parting_of(gaps->up[0], gaps->down[0], gaps->up[1], gaps->down[1]);
    struct parting last =
        parting_of(gaps->up[1], gaps->down[1], gaps->up[0], gaps->down[0]);
    *from = (struct fraction){first.apart, first.apart + first.other};
    *to = (struct fraction){last.other, last.apart + last.other};
}

/* Bit i: no time brings the box and that of lane i together. Only for pairs that
 * overlap; `quantised`: both are in whole numbers. */
ENG_INLINE uint32_t never_together(struct bounds box, struct bounds rows, bool quantised)
{
    uint32_t bits = 0;
    for (uint32_t at = 0; at < ENG_WIDE; at += ENG_F_LANES) {
        struct fraction from[3];
        struct fraction to[3];
#pragma GCC unroll 3
        for (uint32_t axis = 0; axis < 3; axis++) {
            struct gaps gaps = quantised ? gaps_as_pairs(box, rows, axis, at)
                                         : gaps_as_floats(box, rows, axis, at);
            meeting_along(&gaps, &from[axis], &to[axis]);
        }
        struct fraction begin = later(later(from[0], from[1]), from[2]);
        struct fraction end = sooner(sooner(to[0], to[1]), to[2]);
        eng_f ends = end.n * begin.d * (1 + 0x1p-19f) + 0x1p-120f;
        bits |= eng_fm_bits(eng_f_less(ends, begin.n * end.d)) << at;
    }
    return bits;
}

#endif
