/* ingest.h - copies positions and triangles out of memory that another process may be
 * changing, and checks the copy.
 */
#ifndef ENG_INGEST_H
#define ENG_INGEST_H

#include <stddef.h>
#include <stdint.h>

#include "affinity.h"
#include "box_frame.h"
#include "mesh.h"

/* Who copies many positions. */
struct eng_copiers {
    uint32_t threads; /* at least 1, the caller among them */
    const struct eng_affinity *affinity;
};

/* Copy `count` positions of `format` at `source` to double[count][3]. Conversion from
 * float is exact. Bounds, unless NULL, are widened to hold them. Of doubles `source` may
 * be `out`: they are only checked. Returns 0, or PCCD_E_NOTFINITE with part of `out`
 * written. */
int eng_ingest_positions(double (*out)[3], enum pccd_format format, uint32_t count,
                         const void *source, struct eng_bounds *bounds);

/* Copy positions in the same way, where there are enough of them by several threads.
 * [compute] */
int eng_ingest_by_team(double (*out)[3], enum pccd_format format, uint32_t count,
                       const void *source, struct eng_copiers copiers,
                       struct eng_bounds *bounds);

/* Copy `count` triangles to uint32_t[count][3]; every index must be < vertex_count.
 * Returns 0, or PCCD_E_INDEX with *bad_triangle (0 .. count-1) and part of `out`
 * written. */
int eng_ingest_triangles(uint32_t (*out)[3], uint32_t count, uint32_t vertex_count,
                         const void *source, uint32_t *bad_triangle);
/* Copy edges (points 2) or points (1) in the same way, the last vertex of each
 * repeated. */
int eng_ingest_corners(uint32_t (*out)[3], uint32_t points, uint32_t count,
                       uint32_t vertex_count, const void *source, uint32_t *bad);

/* Copy bytes, each of them read once. */
void eng_ingest_bytes(void *out, const void *source, size_t bytes);

/* Copy a transform double[12]: finite and |.| <= 1e18, else PCCD_E_NOTFINITE. */
int eng_ingest_transform(double out[12], const void *source);

#endif
