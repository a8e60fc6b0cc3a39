/* oracle_inside.h - is a point inside a surface of triangles?
 *
 * Count in integers how often a closed surface winds around a point: by the triangles
 * that a ray passes through, in a direction that is drawn at random until the ray meets
 * no edge and no vertex.
 *
 * Threads: [any]; no global state.
 */
#ifndef ORACLE_ORACLE_INSIDE_H
#define ORACLE_ORACLE_INSIDE_H

#include <stdbool.h>
#include <stdint.h>

/* x: finite. False: the point is on one of the triangles, and *winding is 0. */
bool oracle_winding(const double point[3], const double (*x)[3],
                    const uint32_t (*triangles)[3], uint32_t triangle_count,
                    int64_t *winding);

#endif
