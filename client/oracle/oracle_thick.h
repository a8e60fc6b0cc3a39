/* oracle_thick.h - the exact answer to one test of thick features.
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
#include "oracle_scene.h"

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

/* Return whether the distance at t = 0 is at most r. */
bool oracle_thick_is_inside(const struct oracle_thick *thick);

/* Find the first time at which the distance is at most r; NULL: there is none. With
 * approach s, of a pair whose distance d at t = 0 is at most r: at most s d. Freed by the
 * caller. */
struct oracle_first *oracle_thick_first_new(const struct oracle_thick *thick);

/* ---- How near two features of thick objects are to be, exactly.
 *
 * Find the radius of a feature, and whether a pair is left thin for where it is at rest;
 * decide whether it is within a distance and its radii at a moment. */

/* Return the largest of its vertices' radii; 0 without any. */
double oracle_radius(const struct oracle_object *object, const uint32_t *v,
                     uint32_t points);

/* Return whether at most `rings` edges lead from one of the vertices v[0], of which there
 * are points[0], to one of v[1]. Ends the
 * process where memory ends. */
bool oracle_are_joined(const uint32_t (*edges)[2], uint32_t edge_count,
                       uint32_t vertex_count, const uint32_t *const v[2],
                       const uint32_t points[2], uint32_t rings);

/* Return whether the distance is below d. x: the points of a vertex and a face or,
 * points_a 2, of two edges; of fewer points the last is repeated. */
bool oracle_is_nearer(uint32_t points_a, const double x[4][3], double d);

/* Return whether it is at most the exact sum of d and both radii. */
bool oracle_is_within(uint32_t points_a, const double x[4][3], const double radius[2],
                      double d);

#endif
