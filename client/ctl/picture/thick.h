/* thick.h - draws what has a thickness: all that is within a radius of a point, an edge
 * or a triangle.
 *
 * Threads: one per canvas.
 */
#ifndef CTL_THICK_H
#define CTL_THICK_H

#include "picture_canvas.h"
#include "raster.h"

/* How many pixels thick_segment will look at. */
uint64_t thick_pixels(const struct picture_canvas *canvas, const float from[3],
                      const float to[3], double radius);
/* What is within `radius` of the segment between two points, which may be one. Nothing of
 * it is behind the eye. */
void thick_segment(struct picture_canvas *canvas, const float from[3], const float to[3],
                   double radius, const struct raster_surface *surface);
/* The same of a triangle. The corners have their normals, for shading. */
void thick_triangle(struct picture_canvas *canvas, const float *const x[3],
                    const float normals[3][3], double radius,
                    const struct raster_surface *surface);

#endif
