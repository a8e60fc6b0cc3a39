/* surface.h - makes sheets, balls and rings of triangles, and cuts them into pieces. */
#ifndef BENCH_SURFACE_H
#define BENCH_SURFACE_H

#include <stdint.h>

#include "bench_scene.h"
#include "prng.h"

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

/* ---- Cuts a surface into pieces, for scenes in which something breaks.
 *
 * Grow connected pieces from random triangles; give each piece vertices of its own and,
 * on request, an inner side and walls, so that it is a closed shard. */

struct shards {
    struct surface surface; /* triangles of a piece stand together; x: filled in */
    uint32_t count;         /* pieces */
    uint32_t *piece_of;     /* [surface.vertex_count] */
    uint32_t *vertex_of;    /* [surface.vertex_count]: in the surface that was cut */
    double (*centre)[3];    /* [count]: mean of a piece's vertices */
    double *radius;         /* [count]: of its vertices about the centre, root mean
                             * square */
};

/* Cut `whole` into `count` pieces. inner[whole.vertex_count]: where the inner side is;
 * NULL: pieces are open patches. Vertices move towards the centre of their piece, to
 * `shrink` < 1 of their distance or half as far, so that neighbours stand apart by
 * a hair. */
void shards_init(struct shards *shards, const struct surface *whole, uint32_t count,
                 const double (*inner)[3], double shrink, struct prng *prng);
void shards_deinit(struct shards *shards);

#endif
