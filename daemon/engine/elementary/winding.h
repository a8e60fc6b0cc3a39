/* winding.h - how often a closed surface winds around a point, face by face.
 *
 * Say what one face adds to the winding number of a point: the faces that a ray from the
 * point along +x passes through, each with the side it is passed from. Exactly, by
 * doubles where they are sure, else by pairs of doubles, else by integers.
 *
 * Threads: one thread for one struct eng_numbers. Allocates nothing.
 * Source: Edelsbrunner, Mücke: Simulation of Simplicity, 1990; elementary/BOUNDS.md,
 * "Inside".
 *
 * The ray does not begin at p but at p + (0, e, e^2), for an e > 0 that is less than any
 * number. So it meets no vertex and no edge, whatever their coordinates, and there are no
 * special cases. Where p is not on the surface this changes no winding number.
 */
#ifndef ENG_WINDING_H
#define ENG_WINDING_H

#include "number.h"

/* Return what a face adds: 0 if the ray misses it, 1 or -1 if the ray passes it.
 * ENG_UNSURE: p is on the face; of a face in a plane with the ray, p on it may also be
 * answered by 0. Magnitudes at most 1e18. */
enum eng_sign eng_winding(struct eng_numbers *numbers, const double p[3],
                          const double face[3][3]);

/* ---- where an edge passes through a face, for distance.c --------------------------- */

/* x: the ends of an edge, which lie strictly on different sides of the plane of a face,
 * and the corners of that; magnitudes at most 1e18. Source: BOUNDS.md, "Where an edge
 * passes through". */

/* Set *position as eng_distance_crossing, by doubles. False: they do not know. */
bool eng_crossing_quickly(const double x[5][3], double *position);
/* Return the same position, of the points that are loaded. Set is_unsure where it is not
 * known. */
double eng_crossing_position(struct eng_numbers *numbers);

#endif
