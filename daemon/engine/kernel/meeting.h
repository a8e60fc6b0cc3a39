/* daemon/engine/kernel/meeting.h - when boxes that move can meet.
 *
 * Room:     engine. May include: lanes_pack.h, overlap.h.
 * Does:     tell pairs of boxes that overlap along each axis, but never along all at a
 *           time.
 * Threads:  [any]; inline only. Included by files of this folder alone.
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
 */
#ifndef ENG_MEETING_H
#define ENG_MEETING_H

#include "lanes_pack.h"
#include "overlap.h"

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
ENG_INLINE void meeting_along(struct bounds box, struct bounds rows, uint32_t axis,
                              uint32_t at, struct fraction *from, struct fraction *to)
{
    eng_f up0 = bound(box, ENG_LOW0, axis) + row_of(rows, ENG_HIGH0, axis, at);
    eng_f up1 = bound(box, ENG_LOW1, axis) + row_of(rows, ENG_HIGH1, axis, at);
    eng_f down0 = bound(box, ENG_HIGH0, axis) + row_of(rows, ENG_LOW0, axis, at);
    eng_f down1 = bound(box, ENG_HIGH1, axis) + row_of(rows, ENG_LOW1, axis, at);
    struct parting first = parting_of(up0, down0, up1, down1);
    struct parting last = parting_of(up1, down1, up0, down0);
    *from = (struct fraction){first.apart, first.apart + first.other};
    *to = (struct fraction){last.other, last.apart + last.other};
}

/* Bit i: no time brings the box and that of lane i together. Only for pairs that
 * overlap. */
ENG_INLINE uint32_t never_together(struct bounds box, struct bounds rows)
{
    uint32_t bits = 0;
    for (uint32_t at = 0; at < ENG_WIDE; at += ENG_F_LANES) {
        struct fraction from[3];
        struct fraction to[3];
#pragma GCC unroll 3
        for (uint32_t axis = 0; axis < 3; axis++) {
            meeting_along(box, rows, axis, at, &from[axis], &to[axis]);
        }
        struct fraction begin = later(later(from[0], from[1]), from[2]);
        struct fraction end = sooner(sooner(to[0], to[1]), to[2]);
        eng_f ends = end.n * begin.d * (1 + 0x1p-19f) + 0x1p-120f;
        bits |= eng_fm_bits(eng_f_less(ends, begin.n * end.d)) << at;
    }
    return bits;
}

#endif
