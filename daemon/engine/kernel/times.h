/* times.h - when two features can meet, as far as gaps along axes say, a pair to each
 * lane.
 *
 * Threads: [any]; inline only. Included by files of this folder alone.
 * Source: BOUNDS.md, "Axes and time".
 */
#ifndef ENG_TIMES_H
#define ENG_TIMES_H

#include "lanes.h"
#include "query.h"

/* Two fractions of rounded gaps are within 10 u of the true ones; BOUNDS.md. */
#define ENG_TIMES_SLACK (1 + 32 * ENG_U)

/* Times as fractions n / d: when the pair can touch first and last. Both terms of
 * `from` are >= 0, both of `to` <= 0. */
struct eng_times {
    eng_d from_n, from_d;
    eng_d to_n, to_d;
};

/* A gap g0 at t = 0, at least; g1 at t = 1; negative: none. It is concave in t, so there
 * is one before (after) the root of its chord, g0 / (g0 - g1), if g0 (g1) is positive. */
ENG_INLINE void eng_times_cut(struct eng_times *times, eng_d g0, eng_d g1)
{
    const eng_d zero = {0};
    eng_d fall = g0 - g1;
    eng_dm later = eng_dm_and(eng_d_less(zero, g0),
                              eng_d_less(times->from_n * fall, g0 * times->from_d));
    eng_dm sooner = eng_dm_and(eng_d_less(zero, g1),
                               eng_d_less(g0 * times->to_d, times->to_n * fall));
    times->from_n = eng_d_select(later, g0, times->from_n);
    times->from_d = eng_d_select(later, fall, times->from_d);
    times->to_n = eng_d_select(sooner, g0, times->to_n);
    times->to_d = eng_d_select(sooner, fall, times->to_d);
}

/* From 0 to 1. */
ENG_INLINE struct eng_times eng_times_all(void)
{
    const eng_d zero = {0};
    return (struct eng_times){zero, zero + 1, zero - 1, zero - 1};
}

/* Is the first time certainly after the last? */
ENG_INLINE eng_dm eng_times_are_none(const struct eng_times *times)
{
    return eng_d_less(times->from_n * times->to_d,
                      times->to_n * times->from_d * ENG_TIMES_SLACK - ENG_TINY);
}

#endif
