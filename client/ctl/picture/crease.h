/* client/ctl/picture/crease.h - directions of a surface at its triangles' corners.
 *
 * Room:     client/ctl. May include: picture.h.
 * Does:     smooth normals where triangles meet at a flat angle, each its own at a
 *           crease: a ball is round, and a box has sides.
 * Does not: need triangles to be wound in the same sense.
 * Threads:  [any]; nothing is shared.
 */
#ifndef CTL_CREASE_H
#define CTL_CREASE_H

#include "picture.h"

/* normals[3 * triangle_count]: unit, one for each corner of each triangle. Lengths are
 * taken in units of 2^octave, as squares of squares have no room in a float. False
 * without memory. */
bool crease_normals(const struct picture_mesh *mesh, int octave, float (*normals)[3]);

#endif
