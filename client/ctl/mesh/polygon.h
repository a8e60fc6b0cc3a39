/* client/ctl/mesh/polygon.h - cuts a polygon into triangles.
 *
 * Ears are cut off, by exact signs, of the polygon as it is seen along the axis that it
 * faces most; if it is not simple there, along the others. A convex polygon of four
 * corners is cut between its first and its third corner; any other cut depends on where
 * the corners are, not on which is the first.
 *
 * Source: Meisters, "Polygons have ears" (1975).
 */
#ifndef CTL_POLYGON_H
#define CTL_POLYGON_H

#include <stdbool.h>
#include <stdint.h>

/* Fill with {0}. */
struct ctl_cutter {
    uint32_t capacity;  /* corners */
    double (*x)[3];     /* where they are: to be filled; |x| <= 1e18 */
    uint32_t (*cut)[3]; /* count - 2 triangles, by the numbers of corners */
    uint32_t made;      /* of them */
    struct cutter_corner *corners;
    struct cutter_side *sides;
    bool turns; /* somewhere, along an axis */
};

/* Make room for so many corners; false: there is no memory. */
bool ctl_cutter_reserve(struct ctl_cutter *cutter, uint32_t count);
/* Cut the polygon of the first `count` corners of x, at least 3. No triangle has an area
 * of 0, except where two corners that follow each other are at one place, or all are on
 * one line. False: it has no cut, because it is not simple. */
bool ctl_cutter_cut(struct ctl_cutter *cutter, uint32_t count);
void ctl_cutter_deinit(struct ctl_cutter *cutter);

#endif
