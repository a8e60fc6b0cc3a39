/* coordinates.h - how coordinates lie in memory, and how a rigid transform moves them.
 *
 * Give the bytes of a vertex, which numbers are coordinates, and the one formula of a
 * transform. Daemon, library and replay each compute where a rigid object is, and must
 * agree bit for bit.
 */
#ifndef COMMON_COORDINATES_H
#define COMMON_COORDINATES_H

#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#include "pccd_types.h"
#include "proto_limits.h"

/* Return the bytes of one vertex, three coordinates, in that enum pccd_format. */
static inline uint64_t common_vertex_bytes(uint32_t format)
{
    return format == PCCD_FORMAT_F64 ? sizeof(double[3]) : sizeof(float[3]);
}

/* Return whether a number can be a coordinate: it is finite, and not too large. */
static inline bool common_is_coordinate(double x)
{
    return x >= -PROTO_COORDINATE_MAX && x <= PROTO_COORDINATE_MAX;
}

/* Return the coordinate with that index of vertices at `at`, aligned or not. */
static inline double common_coordinate(const void *at, uint32_t format, uint64_t index)
{
    double x;
    float narrow;
    if (format == PCCD_FORMAT_F64) {
        memcpy(&x, (const uint8_t *)at + index * sizeof x, sizeof x);
    } else {
        memcpy(&narrow, (const uint8_t *)at + index * sizeof narrow, sizeof narrow);
        x = (double)narrow;
    }
    return x;
}

/* Return the first of `count` vertices at `at`, aligned or not, with a coordinate that
 * cannot be one; `count`: there is none. */
static inline uint64_t common_first_stray(const void *at, uint32_t format, uint64_t count)
{
    for (uint64_t i = 0; i < 3 * count; i++) {
        if (!common_is_coordinate(common_coordinate(at, format, i))) {
            return i / 3;
        }
    }
    return count;
}

/* Set `to` to where the transform m takes the point x: m has three rows of three
 * factors and a shift. Each operation is rounded by itself, in this order: a
 * multiplication must not be fused with an addition, which is why everything is built
 * with -ffp-contract=off. */
static inline void common_transform(const double m[12], const double x[3], double to[3])
{
#pragma GCC unroll 3
    for (int row = 0; row < 3; row++) {
        const double *r = m + 4 * row;
        to[row] = ((r[0] * x[0] + r[1] * x[1]) + r[2] * x[2]) + r[3];
    }
}

#endif
