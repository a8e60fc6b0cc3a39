/* rigid.h - which objects need not be tested against themselves in a step, because the
 * poses that move them prove that they do not meet themselves.
 *
 * Compare, for each object, what rounding can bring together in this step, its
 * *rounding reach*, with how close its features lie to each other (wide_crowded.h), and
 * enter in the masks what follows.
 *
 * Source: elementary/BOUNDS.md, "Objects that move by poses".
 *
 * A vertex p of an object that two poses move goes on a straight line from A0 p + c0 to
 * A1 p + c1, both rounded. Between the two the object is not rigid: it shrinks, for a
 * turn by an angle a to cos(a / 2) of its size at worst. As long as it does not shrink to
 * nothing, points that are apart stay apart, but for the rounding: that alone may close a
 * small distance. The rounding reach is that distance, in the coordinates of the mesh.
 *
 * An object is eligible while nothing but poses, each of all its vertices, has moved it:
 * both ends of the step are such poses; or it stands where the last one took it; or it
 * never moved. Anything else written to one of its vertices ends that, until the next
 * pose. What is left out has no contact, so answers stay as they are; mode `pairs`, whose
 * records are pairs of boxes, leaves nothing out. Nor is an object eligible if its
 * features meet each other at a distance, which poses do not keep (thickness.h).
 */
#ifndef ENG_RIGID_H
#define ENG_RIGID_H

#include "world.h"

/* Note, before a step, which clearances are known, so that the step goes by these,
 * whatever becomes known meanwhile. [compute] */
void eng_rigid_prepare(struct eng_scene *scene);

/* Find out, when the positions are those of the step, which objects need no tests against
 * themselves. None if not `may_leave_out`. [compute] */
void eng_rigid_choose(struct eng_scene *scene, bool may_leave_out);

/* Return whether a step that writes nothing will find no clearance that has become known,
 * and search for none. [compute] */
bool eng_rigid_is_settled(const struct eng_scene *scene);

/* Return the part of its length that any vector of the mesh keeps, or more, at any time
 * between the poses m0 and m1 (coordinates.h). 1 for shifts, cos(a / 2) or somewhat less
 * for a turn by an angle a. 0: nothing is certain, for example if the object turns by 180
 * degrees, or is pressed flat. The numbers of a pose are at most 1e18. */
double eng_pose_shrink(const double m0[12], const double m1[12]);

/* Return a distance, greater than 0: no vertex within the bounds is farther than that
 * from where the pose takes it, as its coordinates are rounded. */
double eng_rounding_error(const double m[12], const struct eng_bounds *bounds);

/* Return a distance such that two features of a mesh which are farther apart than that,
 * as registered, do not touch each other at any time of a step that takes each vertex
 * from where m0 transforms it to where m1 does, both rounded. `bounds` are around the
 * features, as registered. Greater than 0; INFINITY: nothing is certain. */
double eng_rounding_reach(const double m0[12], const double m1[12],
                          const struct eng_bounds *bounds);

#endif
