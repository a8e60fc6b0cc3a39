/* filter.h - cheap certain rejections, several queries at a time.
 *
 * Room:     engine. May include: query.h.
 * Does:     reject queries that certainly have no contact: by separation along the six
 *           face-diagonal directions, then by the sign of the coplanarity cubic.
 * Does not: test x, y and z: the feature boxes have done that.
 * Threads:  [any].
 * Source:   query.h; the margins are derived in BOUNDS.md.
 */
#ifndef ENG_FILTER_H
#define ENG_FILTER_H

#include "query.h"

/* Two doubles are one register of the baseline (SSE2, NEON); with more lanes than a
 * register holds the compiler goes through memory (measured: 1.8 times the time with
 * four). */
#define ENG_LANES 2

/* The same query coordinates lane by lane: x[end][point][axis][lane]. */
struct eng_lanes {
    _Alignas(16) double x[2][4][3][ENG_LANES];
};

static inline void eng_lanes_set(struct eng_lanes *lanes, unsigned lane,
                                 const struct eng_query *query)
{
    for (int i = 0; i < 24; i++) {
        lanes->x[i / 12][i / 3 % 4][i % 3][lane] = query->x[i / 12][i / 3 % 4][i % 3];
    }
}

/* Bit i of the result is set if lane i may have a contact. Lanes are independent. */
uint32_t eng_filter(enum eng_kind kind, const struct eng_lanes *lanes);

#endif
