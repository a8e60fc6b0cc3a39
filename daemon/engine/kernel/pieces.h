/* pieces.h - cuts the step where a cubic turns, so that each piece has at most one root.
 *
 * Threads: [any]; inline only. Included by files of this folder alone.
 * Source: BOUNDS.md.
 */
#ifndef ENG_PIECES_H
#define ENG_PIECES_H

#include "interval.h"

/* Where a cubic turns, and what it is there. */
struct turn {
    eng_d t;
    struct eng_cubic_at at;
};

/* Is the cubic certainly positive over all of [0, t], or [t, 1]? */
ENG_INLINE eng_dm is_clear_before(const struct eng_cubic *cubic, const struct turn *turn)
{
    const struct eng_cubic_at *at = &turn->at;
    return all_above(cubic->f[0], at->quad[0], at->line[0], at->value, cubic->error);
}

ENG_INLINE eng_dm is_clear_behind(const struct eng_cubic *cubic, const struct turn *turn)
{
    const struct eng_cubic_at *at = &turn->at;
    return all_above(cubic->f[3], at->quad[2], at->line[1], at->value, cubic->error);
}

/* Certainly negative over all of [t, 1]? */
ENG_INLINE eng_dm is_below_behind(const struct eng_cubic *cubic, const struct turn *turn)
{
    const struct eng_cubic_at *at = &turn->at;
    return all_above(-cubic->f[3], -at->quad[2], -at->line[1], -at->value, cubic->error);
}

/* Cut the step where the cubic turns; the first interval begins at 0 or, if there is no
 * root before, at the maximum; it ends at the minimum if there are more roots than one,
 * or none behind. */
ENG_INLINE void set_pieces(struct lanes *lanes, eng_dm sure)
{
    const eng_d zero = {0};
    const eng_d one = zero + 1;
    const struct eng_cubic *cubic = &lanes->cubic;
    const eng_d *f = cubic->f;
    eng_d e = cubic->error;
    uint32_t all = (1u << lanes->count) - 1;
    struct turn low;
    struct turn high;
    eng_cubic_turns(cubic, &low.t, &high.t);
    eng_dm has_low = eng_dm_and(eng_d_less(zero, low.t), eng_d_less(low.t, one));
    eng_dm has_both = eng_dm_and(
        has_low, eng_dm_and(eng_d_at_most(low.t, high.t), eng_d_less(high.t, one)));
    low.t = eng_d_select(has_low, low.t, zero + 0.5);
    high.t = eng_d_select(has_both, high.t, one);
    low.at = eng_cubic_at(cubic, low.t);
    high.at = eng_cubic_at(cubic, high.t);
    eng_d between[2];
    eng_cubic_between(&low.at, high.t, between);
    eng_dm falls = eng_dm_and(sure, eng_d_less(f[3], -e));
    eng_dm returns = eng_dm_and(sure, eng_d_less(e, f[3]));
    eng_dm before = is_clear_before(cubic, &low);
    eng_dm misses = eng_dm_and(returns, eng_dm_and(before, is_clear_behind(cubic, &low)));
    eng_dm dips = eng_d_less(low.at.value, -e);
    eng_dm rises = eng_dm_and(has_both, eng_d_less(e, high.at.value));
    eng_dm falls_late = eng_dm_and(eng_dm_and(falls, rises), before);
    falls_late = eng_dm_and(falls_late, eng_d_less(e, eng_d_min(between[0], between[1])));
    eng_dm falls_early = eng_dm_and(eng_dm_and(falls, dips), has_both);
    falls_early = eng_dm_and(falls_early, is_below_behind(cubic, &high));
    falls_early =
        eng_dm_and(falls_early, eng_d_less(eng_d_max(between[0], between[1]), -e));
    eng_dm twice = eng_dm_and(returns, dips);
    eng_dm thrice = eng_dm_and(eng_dm_and(falls, rises), dips);
    eng_dm ends_low = eng_dm_or(eng_dm_or(twice, thrice), falls_early);
    lanes->bends[0] = eng_dm_or(twice, thrice);
    lanes->bends[1] = thrice;
    lanes->l = eng_d_select(falls_late, high.t, zero);
    lanes->f_l = eng_d_select(falls_late, high.at.value, f[0]);
    lanes->r = eng_d_select(ends_low, low.t, one);
    lanes->f_r = eng_d_select(ends_low, low.at.value, f[3]);
    lanes->cut[0] = low.t;
    lanes->at_cut[0] = low.at.value;
    lanes->cut[1] = eng_d_select(thrice, high.t, one);
    lanes->at_cut[1] = eng_d_select(thrice, high.at.value, f[3]);
    lanes->flat_l = falls_late;
    lanes->flat_r = ends_low;
    lanes->done = eng_dm_bits(misses) & all;
    lanes->wanted = eng_dm_bits(eng_dm_or(twice, falls)) & all;
}

/* On to the next interval; the cubic is turned so that it is positive at its begin. */
ENG_INLINE void set_next(struct lanes *lanes, int piece)
{
    const eng_d zero = {0};
    eng_d sign = piece == 1 ? zero - 1 : zero + 1;
    lanes->l = lanes->cut[piece - 1];
    lanes->f_l = sign * lanes->at_cut[piece - 1];
    lanes->r = piece == 1 ? lanes->cut[1] : (eng_d)(zero + 1);
#pragma GCC unroll 4
    for (int i = 0; i < 4; i++) {
        lanes->cubic.f[i] = -lanes->cubic.f[i];
    }
    lanes->flat_l = piece == 1 ? eng_dm_not(lanes->bends[1]) : lanes->bends[1];
    lanes->flat_r = eng_dm_and(lanes->flat_l, eng_dm_not(lanes->flat_l)); /* none */
    lanes->f_r = piece == 1 ? (eng_d)(sign * lanes->at_cut[1]) : lanes->cubic.f[3];
}

#endif
