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
#include <stdint.h>

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

/* ---- the same of thick features: do they come within a distance? ------------------- */

struct eng_thick_query {
    /* Coordinates are finite, of magnitude at most 1e18. */
    struct eng_query query;
    double radius[3]; /* each 0 .. 1e18: of feature a, of feature b, the separation */
    double approach;  /* 0, or 0 < approach < 1 */
};

/* Return the sum of the three, off by at most 2 u of it. */
static inline double eng_thick_sum(const double radius[3])
{
    return radius[0] + radius[1] + radius[2];
}

/* Return a distance that is not below the sum of the three. */
static inline double eng_thick_reach(const double radius[3])
{
    return eng_thick_sum(radius) * (1 + 4 * ENG_U);
}

/* ---- what is said of the distance of two features ---------------------------------- */

/* The parts of two features that are nearest. */
enum eng_nearest {
    ENG_NEAREST_VF = 0,
    ENG_NEAREST_EE = 1,
    ENG_NEAREST_VE = 2,
    ENG_NEAREST_VV = 3
};

struct eng_distance {
    /* The distance, rounded down and up to doubles of at most 33 significant bits: equal
     * where it is one. */
    double lo;
    double hi;
    /* Where: VF weights of the second and the third corner, EE positions on the first and
     * the second edge, 0 at its first end. 0 .. 1. The nearest multiples of 2^-32, halves
     * to even. */
    double param[2];
    /* Of length 1, from the second feature to the first, each coordinate a
     * multiple of 2^-32 as above; zeros at distance 0. */
    double direction[3];
    /* The one of the fewest points between which the distance is. Among equals, of two
     * vertices those of the least lower rank, then of the least higher one; of a vertex
     * and an edge those of the least rank of the vertex, then of the edge's higher, then
     * of its lower end. Parallel edges are VV or VE, never EE. */
    enum eng_nearest type;
    uint32_t points; /* bit i: point i of the pair is one of them */
};

/* The detail that is wanted of a pair that is near enough. */
enum eng_distance_wanted {
    ENG_DISTANCE_WITHIN, /* that it is: no number */
    ENG_DISTANCE_LENGTH, /* lo and hi */
    ENG_DISTANCE_WHOLE   /* all of it */
};

#endif
