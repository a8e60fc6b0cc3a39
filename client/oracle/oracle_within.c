/* oracle_within.c - how near two features of thick objects are to be. */
#include "oracle_thick.h"

#include <stdlib.h>
#include <string.h>

#include "oracle_distance.h"
#include "oracle_near.h"

double oracle_radius(const struct oracle_object *object, const uint32_t *v,
                     uint32_t points)
{
    double most = 0;
    for (uint32_t i = 0; object->radii && i < points; i++) {
        most = object->radii[v[i]] > most ? object->radii[v[i]] : most;
    }
    return most;
}

/* Mark what one more edge reaches: marks are 1 + how many edges lead there. */
static void grow(const uint32_t (*edges)[2], uint32_t edge_count, uint8_t *marks,
                 uint32_t ring)
{
    for (uint32_t e = 0; e < edge_count; e++) {
        for (int k = 0; k < 2; k++) {
            uint8_t from = marks[edges[e][k]];
            uint8_t *to = &marks[edges[e][1 - k]];
            if (from != 0 && from <= ring && *to == 0) {
                *to = (uint8_t)(ring + 1);
            }
        }
    }
}

bool oracle_are_joined(const uint32_t (*edges)[2], uint32_t edge_count,
                       uint32_t vertex_count, const uint32_t *const v[2],
                       const uint32_t points[2], uint32_t rings)
{
    uint8_t *marks = oracle_grow(NULL, (size_t)vertex_count + 1);
    bool are_joined = false;
    memset(marks, 0, (size_t)vertex_count + 1);
    for (uint32_t i = 0; i < points[0]; i++) {
        marks[v[0][i]] = 1;
    }
    for (uint32_t ring = 1; ring <= rings; ring++) {
        grow(edges, edge_count, marks, ring);
    }
    for (uint32_t i = 0; i < points[1]; i++) {
        are_joined |= marks[v[1][i]] != 0;
    }
    free(marks);
    return are_joined;
}

static enum oracle_kind kind_of(uint32_t points_a)
{
    return points_a == 1 ? ORACLE_VF : ORACLE_EE;
}

bool oracle_is_nearer(uint32_t points_a, const double x[4][3], double d)
{
    const double far[4][3] = {{d}}; /* a vertex, and a face that is a point */
    static const double thin[2] = {0, 0};
    return oracle_distance_compare(kind_of(points_a), x, thin, ORACLE_VF, far, thin) < 0;
}

bool oracle_is_within(uint32_t points_a, const double x[4][3], const double radius[2],
                      double d)
{
    if (radius[0] == 0 && radius[1] == 0) {
        return oracle_distance_within(kind_of(points_a), x, d);
    }
    double p[8][3];
    memcpy(p[0], x[0], 4 * sizeof p[0]);
    memcpy(p[4], x[0], 4 * sizeof p[0]);
    const struct oracle_thick thick = {.points_a = (int)points_a,
                                       .points_b = 4 - (int)points_a,
                                       .p = (const double(*)[3])p,
                                       .radius = {radius[0], radius[1], d}};
    return oracle_thick_is_inside(&thick);
}
