/* oracle_thick.h - the exact answer to one test of thick features: do they come within a
 * distance of each other, and when?
 *
 * Decide by the definition, on the binary inputs and without rounding, whether and when
 * two vertices, a vertex and an edge, a vertex and a triangle or two edges are at most a
 * distance apart.
 *
 * Threads: [any]; no global state.
 */
#ifndef ORACLE_ORACLE_THICK_H
#define ORACLE_ORACLE_THICK_H

#include "oracle.h"

struct oracle_thick {
    /* Points of the first and of the second feature: 1 a vertex, 2 an edge, 3 a triangle;
     * together at most 4, and no triangle against anything but a vertex, which is the
     * first. */
    int points_a;
    int points_b;
    /* As in oracle.h: points at t = 0, those of the first feature first, and from p[4] on
     * at t = 1. Points beyond the features' are not looked at. */
    const double (*p)[3];
    double radius[3]; /* r is their exact sum; each is 0 or more */
    double approach;  /* 0 < s < 1, or 0: see below */
};

/* Is the distance at t = 0 at most r? */
bool oracle_thick_is_inside(const struct oracle_thick *thick);

/* The first time at which the distance is at most r; NULL: there is none. With approach
 * s, of a pair whose distance d at t = 0 is at most r: at most s d. Freed by the
 * caller. */
struct oracle_first *oracle_thick_first_new(const struct oracle_thick *thick);

#endif
