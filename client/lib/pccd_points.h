/* pccd_points.h - where the features of a record are: their vertices and weights, points
 * in the world, and at most four points for each two bodies.
 *
 * It needs no client: records come from an answer (pccd.h, pccd_near.h), and what bodies
 * are made of and where they are from whoever moves them. So nothing is asked of the
 * daemon, and positions need not be kept twice.
 *
 *     struct pccd_body bodies[2] = {
 *         {.object = floor, .first = 0, .triangle_count = 2, .triangles = floor_corners,
 *          .edge_count = 5, .edges = floor_edges, .vertex_count = 4, .x0 = floor_x},
 *         {.object = box, .first = 4, ..., .x0 = box_x0, .x1 = box_x1}};
 *     struct pccd_manifold manifolds[8];
 *     uint64_t total;
 *     pccd_manifolds(bodies, 2, answer.contacts, answer.count, 0.01, manifolds, 8,
 *                    &total);
 *
 * A function that returns int returns 0 or a negative status, and pccd_error_text(NULL)
 * says then what was wrong: E_INVAL: a NULL, bodies that are not in the order of their
 * handles, or another argument out of range; E_HANDLE: a record names an object that no
 * body is; E_INDEX: or a feature, or a triangle a vertex, that its body does not have;
 * E_NOMEM. Arrays are written then in part.
 *
 * Threads: any.
 */
#ifndef PCCD_POINTS_H
#define PCCD_POINTS_H

#include <stdint.h>

#include "pccd_types.h"

#ifdef __cplusplus
extern "C" {
#endif

#if defined(__GNUC__)
#pragma GCC visibility push(default)
#endif

/* An object, as whoever moves it knows it. */
struct pccd_body {
    uint32_t object; /* handle; of several bodies in ascending order */
    uint32_t first;  /* number that its first vertex has among those of all bodies */
    uint32_t vertex_count, triangle_count, edge_count;
    const uint32_t *triangles;     /* [triangle_count][3]; NULL: none */
    const struct pccd_edge *edges; /* [edge_count], as pccd_mesh_edges gives them */
    /* Stencils do not look at these. Each vertex goes straight from where it is at t = 0
     * to where it is at t = 1. */
    const double *x0;  /* [vertex_count][3] at t = 0; with m0 and m1: as registered */
    const double *x1;  /* at t = 1; NULL: it stands */
    const double *m0, *m1; /* [12]: rows of [R | t] at both ends, in the place of x1, as
                              pccd_frame_rigid has them; of a body that turns, both where
                              pccd_joints_place has it at the toi; NULL: none */
};

/* Find the four vertices of each record, by their numbers among all, and the weight that
 * the vector from the point of b to that of a gives to each: it is
 * w[0] x[0] + w[1] x[1] + w[2] x[2] + w[3] x[3]. Those of a are first: VF has the
 * weights 1, -w0, -w1, -w2, EE 1 - s, s, -(1 - t), -t. A record of fewer than four
 * vertices repeats its last one, with the weight 0. EF has the edge alone, 1 - s, s, 0,
 * 0: where it passes through the face. vertices[count], weights[count]; either may be
 * NULL. */
int pccd_stencils(const struct pccd_body *bodies, uint32_t body_count,
                  const struct pccd_contact *contacts, uint64_t count,
                  uint32_t (*vertices)[4], double (*weights)[4]);
int pccd_near_stencils(const struct pccd_body *bodies, uint32_t body_count,
                       const struct pccd_near *near, uint64_t count,
                       uint32_t (*vertices)[4], double (*weights)[4]);

/* Find where the points of each record are in the world: points[i][0] on a, points[i][1]
 * on b; of contacts at their toi, of what is near at time t, 0 or 1. They are rounded as
 * the parameters of records are, to 2^-24 of the features' size. EF: twice where it
 * passes through. */
int pccd_points(const struct pccd_body *bodies, uint32_t body_count,
                const struct pccd_contact *contacts, uint64_t count,
                double (*points)[2][3]);
int pccd_near_points(const struct pccd_body *bodies, uint32_t body_count,
                     const struct pccd_near *near, uint64_t count, double t,
                     double (*points)[2][3]);

struct pccd_manifold_point {
    double point[3];  /* half way between the points of both */
    double normal[3]; /* unit, from object_a to object_b, against that of a record, which
                         is from its b to its a; zeros: the record has none */
    double distance;  /* of contacts: of both points at toi, as they are rounded; of what
                         is near: d_lo, how deep it is where DEPTH was asked */
    double toi;       /* of contacts; else 0 */
    uint64_t record;  /* index of the record, which names the features */
};

/* Points between two bodies, or of one with itself. */
struct pccd_manifold {
    uint32_t object_a, object_b; /* object_a <= object_b */
    uint32_t count;              /* 1 .. 4 */
    uint32_t reserved;           /* 0 */
    struct pccd_manifold_point points[4]; /* [count], in the order of their records */
};

/* Choose, for each two bodies, at most four points that span the largest area, seen along
 * the sum of their normals: of the contacts whose toi is at most `time` later than the
 * first of these bodies (not less than the tolerance of the step, within which corners
 * that meet at once have their toi); of what is near and at most `distance` apart, where
 * it is at time t. EF is left out. Where fewer points span anything there
 * are fewer; of those at one place the first record has it. The manifolds are written in
 * the order of their objects: the first `room` of them to manifolds[room]; *total says
 * how many there are. The same bytes everywhere. */
int pccd_manifolds(const struct pccd_body *bodies, uint32_t body_count,
                   const struct pccd_contact *contacts, uint64_t count, double time,
                   struct pccd_manifold *manifolds, uint64_t room, uint64_t *total);
int pccd_near_manifolds(const struct pccd_body *bodies, uint32_t body_count,
                        const struct pccd_near *near, uint64_t count, double distance,
                        double t, struct pccd_manifold *manifolds, uint64_t room,
                        uint64_t *total);

#if defined(__GNUC__)
#pragma GCC visibility pop
#endif

#ifdef __cplusplus
}
#endif

#endif
