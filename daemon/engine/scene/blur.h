/* blur.h - how near to each other points of a mesh must lie so that an object which moves
 * by two poses might bring them together.
 *
 * Source: elementary/BOUNDS.md, "Objects that move by poses".
 *
 * A vertex p of such an object goes on a straight line from A0 p + c0 to A1 p + c1, both
 * rounded. Between the two the object is not rigid: it shrinks, for a turn by an angle a
 * to cos(a / 2) of its size at worst. As long as it does not shrink to nothing, points
 * that are apart stay apart, but for the rounding: that alone may close a small distance.
 * The blur is that distance, in the coordinates of the mesh.
 */
#ifndef ENG_BLUR_H
#define ENG_BLUR_H

#include "box_frame.h"

/* Of any vector of the mesh: no less than this part of its length is left at any time
 * between the poses m0 and m1 (coordinates.h). 1 for shifts, cos(a / 2) or somewhat less
 * for a turn by an angle a. 0: nothing is certain, for example if the object turns by 180
 * degrees, or is pressed flat. The numbers of a pose are at most 1e18. */
double eng_blur_shrink(const double m0[12], const double m1[12]);

/* No vertex within the bounds is farther from where the pose takes it than that, as its
 * coordinates are rounded. Greater than 0. */
double eng_blur_error(const double m[12], const struct eng_bounds *bounds);

/* Two features of a mesh whose distance, as registered, is greater than what this returns
 * do not touch each other at any time of a step that takes each vertex from where m0
 * transforms it to where m1 does, both rounded. `bounds` are around the features, as
 * registered. Greater than 0; INFINITY: nothing is certain. */
double eng_blur(const double m0[12], const double m1[12],
                const struct eng_bounds *bounds);

#endif
