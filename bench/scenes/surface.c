/* surface.c - sheets, balls and rings as grids of triangles. */
#include "surface.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static void begin(struct surface *surface, uint32_t vertex_count, uint32_t triangle_count)
{
    surface->vertex_count = vertex_count;
    surface->triangle_count = 0;
    surface->triangles = bench_scene_alloc(triangle_count, sizeof *surface->triangles);
    surface->x = bench_scene_alloc(vertex_count, sizeof *surface->x);
}

static void add(struct surface *surface, uint32_t a, uint32_t b, uint32_t c)
{
    uint32_t *t = surface->triangles[surface->triangle_count++];
    t[0] = a;
    t[1] = b;
    t[2] = c;
}

void surface_sheet(struct surface *surface, uint32_t side)
{
    begin(surface, side * side, 2 * (side - 1) * (side - 1));
    for (uint32_t row = 0; row + 1 < side; row++) {
        for (uint32_t column = 0; column + 1 < side; column++) {
            uint32_t a = row * side + column;
            uint32_t b = a + side;
            add(surface, a, a + 1, b + 1);
            add(surface, a, b + 1, b);
        }
    }
}

void surface_place_ground(double (*x)[3], uint32_t side, double length, double height)
{
    for (uint32_t i = 0; i < side * side; i++) {
        double u = (double)(i % side) / (side - 1) - 0.5;
        double v = (double)(i / side) / (side - 1) - 0.5;
        x[i][0] = length * u;
        x[i][1] = length * v;
        x[i][2] = height * sin(40 * u) * sin(33 * v);
    }
}

void surface_ball(struct surface *surface, uint32_t rings)
{
    uint32_t around = 2 * rings;
    uint32_t count = (rings - 1) * around + 2;
    uint32_t last = (rings - 2) * around;
    begin(surface, count, 2 * around * (rings - 1));
    for (uint32_t j = 0; j < around; j++) {
        uint32_t next_j = (j + 1) % around;
        add(surface, count - 2, j, next_j);
        add(surface, count - 1, last + next_j, last + j);
        for (uint32_t a = 0; a < last; a += around) {
            add(surface, a + j, a + around + j, a + around + next_j);
            add(surface, a + j, a + around + next_j, a + next_j);
        }
    }
}

void surface_ball_angles(uint32_t rings, uint32_t v, double *polar, double *azimuth)
{
    uint32_t around = 2 * rings;
    uint32_t poles = (rings - 1) * around;
    *polar = v >= poles ? (v == poles ? 0 : BENCH_PI)
                        : BENCH_PI * (double)(v / around + 1) / rings;
    *azimuth = v >= poles ? 0 : 2 * BENCH_PI * (double)(v % around) / around;
}

void surface_ring(struct surface *surface, uint32_t along, uint32_t around)
{
    begin(surface, along * around, 2 * along * around);
    for (uint32_t i = 0; i < along; i++) {
        for (uint32_t j = 0; j < around; j++) {
            uint32_t a = i * around;
            uint32_t b = (i + 1) % along * around;
            uint32_t next_j = (j + 1) % around;
            add(surface, a + j, b + j, b + next_j);
            add(surface, a + j, b + next_j, a + next_j);
        }
    }
}

void surface_deinit(struct surface *surface)
{
    free(surface->triangles);
    free(surface->x);
    memset(surface, 0, sizeof *surface);
}

void surface_add(struct surface *surface, struct bench_scene *scene)
{
    bench_scene_add_mesh(scene, surface->vertex_count, surface->triangle_count,
                         (const uint32_t(*)[3])surface->triangles);
    surface_deinit(surface);
}
