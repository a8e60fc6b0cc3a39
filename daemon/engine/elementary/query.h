/* daemon/engine/elementary/query.h - one elementary test and its answer.
 *
 * Room:     engine. May include: step.h.
 * Does:     name what filter, solver and exact arithmetic pass to each other.
 *
 * Both tests have one form. With difference vectors p, b, c (linear in t):
 *   VF  p = vertex - corner0, b = corner1 - corner0, c = corner2 - corner0
 *   EE  p = b0 - a0, b = a1 - a0, c = b0 - b1   (edge a: a0 a1, edge b: b0 b1)
 * the features meet at time t iff p = beta b + gamma c with (beta, gamma) in
 *   VF  the triangle beta >= 0, gamma >= 0, beta + gamma <= 1
 *   EE  the square 0 <= beta, gamma <= 1
 * A necessary condition is that the cubic det[p, b, c] vanishes. Differences of doubles
 * are rounded once, so every bound below is relative to the pair's own size and a pair
 * far from the origin is decided as well as one near it.
 */
#ifndef ENG_QUERY_H
#define ENG_QUERY_H

#include "step.h"

/* x[end][point][axis]; points: VF vertex, corners 0 1 2; EE a0 a1 b0 b1. */
struct eng_query {
    enum eng_kind kind;
    double x[2][4][3];
};

/* A contact; what its members mean, struct eng_contact says. */
struct eng_hit {
    uint32_t flags; /* enum eng_contact_flag */
    double toi;
    double toi_hi;
    float param[2];
    float normal[3];
};

/* u = 2^-53, half an ulp of 1: the relative error of one rounding. */
#define ENG_U 0x1p-53

/* Above what underflow can add to any quantity that is compared with a
 * margin; BOUNDS.md. */
#define ENG_TINY 0x1p-1000

#endif
