/* reach.h - makes one box that stands still of a moving one: around its way from t = 0 to
 * a time t_end, or as it is at one end of the step, grown by a distance.
 *
 * Threads: [any]; inline only. Included by files of this folder alone.
 *
 * A bound's outward distance goes from x0 to x1: up to t_end it is at most x0 + p with
 * p = t_end (x1 - x0), or x0 if that is less. Difference and product are off by
 * u = 2^-24 of themselves each, which `reach`, t_end and 2^-20 of it more, makes up for;
 * for products below the normal range, and for p < 0, 2^-120 is taken instead. So with
 * exact sums of x0 and p two boxes are apart up to t_end if a + b < 0. The sum is off by
 * u of itself at most. One of the two, a, is made larger for that: by 2^-21 |a| less
 * u |a| of rounding, 7 u |a|, of which 6 u |a| are left after a's own u |a|. If
 * |b| <= 4 |a| they cover the u |b|. Else b < 0, because a + b < 0, and the true sum is
 * less than 1.01 |a| - (1 - u) |b| < 0.
 */
#ifndef ENG_REACH_H
#define ENG_REACH_H

#include "four.h"
#include "join.h"
#include "lanes.h"

/* Of t_end, 0 .. 1. */
ENG_INLINE float reach_of(float t_end)
{
    return t_end * (1 + 0x1p-20f);
}

ENG_INLINE eng_f reached(eng_f x0, eng_f x1, eng_f reach)
{
    return x0 + eng_f_max(reach * (x1 - x0), eng_f_all(0x1p-120f));
}

/* Not NaN, nor infinite. */
ENG_INLINE eng_f larger_by_rounding(eng_f x)
{
    return eng_f_max(x * (1 + 0x1p-21f), x * (1 - 0x1p-21f));
}

/* `wider`: of the one that is made larger. */
ENG_INLINE void near_rows(const struct eng_wide_block *block, float t_end, bool wider,
                          struct eng_near_block *near)
{
    eng_f reach = eng_f_all(reach_of(t_end));
#pragma GCC unroll 6
    for (uint32_t i = 0; i < 6; i++) {
        enum eng_side side = i < 3 ? ENG_LOW0 : ENG_HIGH0;
        for (uint32_t at = 0; at < ENG_WIDE; at += ENG_F_LANES) {
            eng_f x0 = eng_f_load(block->row[side][i % 3] + at);
            eng_f x1 = eng_f_load(block->row[side + 1][i % 3] + at);
            eng_f x = reached(x0, x1, reach);
            eng_f_store(near->row[i / 3][i % 3] + at, wider ? larger_by_rounding(x) : x);
        }
    }
}

/* At one end of the step. Where x + growth is rounded, `larger_by_rounding` makes up for
 * it: so boxes are apart, in sums of two, only if they are farther apart than that. */
ENG_INLINE void rows_at_end(const struct eng_wide_block *block, uint32_t end,
                            float growth, struct eng_near_block *near)
{
    const eng_f more = eng_f_all(growth);
#pragma GCC unroll 6
    for (uint32_t i = 0; i < 6; i++) {
        enum eng_side side = i < 3 ? ENG_LOW0 : ENG_HIGH0;
        for (uint32_t at = 0; at < ENG_WIDE; at += ENG_F_LANES) {
            eng_f x = eng_f_load(block->row[side + end][i % 3] + at);
            eng_f_store(near->row[i / 3][i % 3] + at,
                        growth > 0 ? larger_by_rounding(x + more) : x);
        }
    }
}

/* The same of one box, which does not grow. */
ENG_INLINE void box_at_end(const struct eng_extents *box, uint32_t end,
                           struct eng_extents *near)
{
    memcpy(near->side[ENG_LOW0], box->side[ENG_LOW0 + end], sizeof near->side[0]);
    memcpy(near->side[ENG_HIGH0], box->side[ENG_HIGH0 + end], sizeof near->side[0]);
}

/* The same of one box, made no larger. */
ENG_INLINE void near_box(const struct eng_extents *box, float t_end,
                         struct eng_extents *near)
{
    float reach = reach_of(t_end);
#pragma GCC unroll 2
    for (int side = ENG_LOW0; side < ENG_SIDES; side += 2) {
        eng_four end[2];
        memcpy(end, box->side[side], sizeof end);
        eng_four way = reach * (end[1] - end[0]);
        end[0] += eng_four_max(way, (eng_four){0} + 0x1p-120f);
        memcpy(near->side[side], &end[0], sizeof end[0]);
    }
}

#endif
