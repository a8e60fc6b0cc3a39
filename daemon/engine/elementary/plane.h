/* plane.h - decides queries in which several points share exactly the same x, y or z, as
 * on a table or in a regular mesh.
 *
 * Decide queries in which three or four points have exactly equal x, y or z at both ends
 * of the step. In that plane a point meets an edge, and rounding would hide whether the
 * point is inside the domain or the points are coplanar at all.
 */
#ifndef ENG_PLANE_H
#define ENG_PLANE_H

#include <stdbool.h>

#include "query.h"

enum eng_plane { ENG_PLANE_UNSURE, ENG_PLANE_MEET, ENG_PLANE_MISS };

/* The cubic of `query` certainly has other signs at l than at r, 0 <= l < r <= 1: do the
 * features meet in the span? ENG_PLANE_UNSURE where they are not as described. */
enum eng_plane eng_plane_look(const struct eng_query *query, double l, double r);

/* The features do not touch at t = 0, and all four points have a coordinate in common, or
 * a point and an edge have one and the fourth point is on one side of them all the time.
 * MEET: the first contact is in [*l, *r], which is at most as long as `tolerance`; MISS:
 * there is none in the step. */
enum eng_plane eng_plane_first(const struct eng_query *query, double tolerance, double *l,
                               double *r);

#endif
