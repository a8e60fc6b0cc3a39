/* crossing.h - where an edge passes through a face.
 *
 * Threads: one thread for one struct eng_numbers. Allocates nothing.
 * Source: elementary/BOUNDS.md, "Where an edge passes through".
 *
 * x: the ends of an edge, which lie strictly on different sides of the plane of a face,
 * and the corners of that; magnitudes at most 1e18.
 */
#ifndef ENG_CROSSING_H
#define ENG_CROSSING_H

#include "number.h"

/* eng_distance_crossing by doubles. False: they do not know. */
bool eng_crossing_quickly(const double x[5][3], double *position);
/* The same of the points that are loaded. Sets is_unsure where it does not know. */
double eng_crossing_position(struct eng_numbers *numbers);

#endif
