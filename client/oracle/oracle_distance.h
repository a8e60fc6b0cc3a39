/* oracle_distance.h - the exact distance of two features at one moment: of a vertex and a
 * triangle, or of two edges.
 *
 * Find by the definition, in integers, how far two closed features are from each other,
 * between which parts of them that is, and where; whether it grows; whether an edge
 * passes through a triangle.
 *
 * Threads: [any]; no global state.
 */
#ifndef ORACLE_ORACLE_DISTANCE_H
#define ORACLE_ORACLE_DISTANCE_H

#include <stdint.h>

#include "oracle.h"

/* The parts of two features that are nearest. */
enum oracle_nearest {
    ORACLE_NEAREST_VF = 0,
    ORACLE_NEAREST_EE = 1,
    ORACLE_NEAREST_VE = 2,
    ORACLE_NEAREST_VV = 3
};

struct oracle_distance {
    /* The one with the fewest points. Among equals, of two vertices the pair with the
     * least lower rank, then the least higher one; of a vertex and an edge the one with
     * the least rank of the vertex, then of the edge's higher, then of its lower end. */
    enum oracle_nearest type;
    uint32_t points; /* bit i: point i is one of them */
    /* The distance, rounded down and up to doubles of at most 33 significant bits. */
    double lo;
    double hi;
    /* VF: weights of the second and the third corner; EE: positions on the first and the
     * second edge, 0 at its first end. The nearest multiples of 2^-32, halves to even. */
    double param[2];
    /* Of length 1, from the second feature to the first, each coordinate a
     * multiple of 2^-32 as above; zeros at distance 0. */
    double direction[3];
};

/* Find the distance of a pair. p: the points of the kind, as in oracle.h, at one moment,
 * finite. rank: of each point, no two alike. */
void oracle_distance_find(enum oracle_kind kind, const double p[4][3],
                          const uint8_t rank[4], struct oracle_distance *distance);

/* Return whether the distance is at most d >= 0. */
bool oracle_distance_within(enum oracle_kind kind, const double p[4][3], double d);

/* Return whether the distance of a pair falls (-1), stays (0) or rises (1) just after
 * t = 0: on (0, e] for some e > 0. p: as in oracle.h, at both times. */
int oracle_distance_trend(enum oracle_kind kind, const double p[8][3]);

/* Return a number below, equal to or above zero as the distance of one pair, less the
 * exact sum of its radii, is to that of another. */
int oracle_distance_compare(enum oracle_kind kind_a, const double a[4][3],
                            const double radius_a[2], enum oracle_kind kind_b,
                            const double b[4][3], const double radius_b[2]);

/* Return whether the ends p[0], p[1] of an edge lie strictly on different sides of the
 * plane of the triangle p[2..4], and the edge passes strictly through its inside. */
bool oracle_crosses(const double p[5][3]);
/* Return how far along an edge that does that is, 0 at p[0], 1 at p[1]: the nearest
 * multiple of 2^-32, halves to even. */
double oracle_crossing(const double p[5][3]);

#endif
