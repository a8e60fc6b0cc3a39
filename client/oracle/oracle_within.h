/* oracle_within.h - how near two features of thick objects are to be, exactly.
 *
 * Find the radius of a feature, and whether a pair is left thin for where it is at rest;
 * decide whether it is within a distance and its radii at a moment.
 *
 * Source: proto/PROTOCOL.md, "How thick objects are".
 */
#ifndef ORACLE_ORACLE_WITHIN_H
#define ORACLE_ORACLE_WITHIN_H

#include "oracle_scene.h"

/* The largest of its vertices'. */
double oracle_radius(const struct oracle_object *object, const uint32_t *v,
                     uint32_t points);

/* Do at most `rings` edges lead from a vertex of a to one of b? Ends the process where
 * memory ends. */
bool oracle_are_joined(const uint32_t (*edges)[2], uint32_t edge_count,
                       uint32_t vertex_count, const uint32_t *a, uint32_t points_a,
                       const uint32_t *b, uint32_t points_b, uint32_t rings);

/* x: the points of a vertex and a face or, points_a 2, of two edges; of fewer points the
 * last is repeated. Is the distance below d? */
bool oracle_is_nearer(uint32_t points_a, const double x[4][3], double d);

/* Is it at most the exact sum of d and both radii? */
bool oracle_is_within(uint32_t points_a, const double x[4][3], const double radius[2],
                      double d);

#endif
