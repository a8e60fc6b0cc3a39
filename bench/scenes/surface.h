/* surface.h - makes sheets, balls and rings as grids of triangles.
 *
 * Threads: one for one surface.
 */
#ifndef BENCH_SURFACE_H
#define BENCH_SURFACE_H

#include <stdint.h>

#include "bench_scene.h"

#define BENCH_PI 3.14159265358979323846

struct surface {
    uint32_t vertex_count;
    uint32_t triangle_count;
    uint32_t (*triangles)[3];
    double (*x)[3]; /* to be filled in */
};

/* side x side vertices in rows, two triangles a square. */
void surface_sheet(struct surface *surface, uint32_t side);

/* Positions of a sheet as a ground of `length` by `length` around the origin, with waves
 * of `height`. */
void surface_place_ground(double (*x)[3], uint32_t side, double length, double height);

/* 2 `rings` meridians, `rings` - 1 >= 2 parallels and two poles. */
void surface_ball(struct surface *surface, uint32_t rings);
/* Polar angle 0 .. pi and azimuth of vertex v of a ball. */
void surface_ball_angles(uint32_t rings, uint32_t v, double *polar, double *azimuth);

/* Closed both ways: vertex i * around + j is at i / along of the long way and at
 * j / around of the short way. */
void surface_ring(struct surface *surface, uint32_t along, uint32_t around);

void surface_deinit(struct surface *surface);

/* Hand it over as the next object; its positions are forgotten. */
void surface_add(struct surface *surface, struct bench_scene *scene);

#endif
