/* crease.h - normals for shading: smooth on a ball, sharp at the edges of a box. */
#ifndef CTL_CREASE_H
#define CTL_CREASE_H

#include "picture_scene.h"

/* normals[3 * triangle_count]: unit, one for each corner of each triangle. Lengths are
 * taken in units of 2^octave, as squares of squares have no room in a float. False
 * without memory. */
bool crease_normals(const struct picture_mesh *mesh, int octave, float (*normals)[3]);

#endif
