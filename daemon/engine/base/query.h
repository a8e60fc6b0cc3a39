/* query.h - one elementary test, which asks whether a vertex meets a face or an edge
 * meets an edge, and its result.
 *
 * VF and EE have one form. With difference vectors p, b, c (linear in t):
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

#include <assert.h>

#include "pccd_types.h"

/* x[end][point][axis]: the points of feature a, then those of feature b, in the order of
 * their mesh: VF vertex, corners 0 1 2; EE a0 a1 b0 b1. A kind of fewer than four points
 * repeats the last one. */
struct eng_query {
    enum pccd_kind kind;
    double x[2][4][3];
};

#define ENG_QUERY_FITS(NAME, value, name, points_a, points_b, text)                      \
    static_assert((points_a) + (points_b) <= 4, "x");
PCCD_KIND_LIST(ENG_QUERY_FITS)
#undef ENG_QUERY_FITS

/* A contact; what its members mean, struct pccd_contact says. */
struct eng_hit {
    uint32_t flags; /* enum pccd_contact_flag */
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
