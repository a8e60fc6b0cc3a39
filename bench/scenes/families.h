/* families.h - the functions that make the benchmark scenes, a file for each family. */
#ifndef BENCH_FAMILIES_H
#define BENCH_FAMILIES_H

#include "bench_scene.h"

/* cloth.c: a cloth that falls over a ball, which spins and winds it up; the
 * same of fewer triangles, for programs that want little; that one, fallen and still. */
void bench_make_cloth(struct bench_scene *scene, bool small);
void bench_make_cloth_20k(struct bench_scene *scene, bool small);
void bench_make_still(struct bench_scene *scene, bool small);

/* sheets.c: a crushed sheet, two that pass through each other, one that jumps. */
void bench_make_crumpled(struct bench_scene *scene, bool small);
void bench_make_fast(struct bench_scene *scene, bool small);
void bench_make_teleport(struct bench_scene *scene, bool small);

/* overlap.c: triangles that all fill the same cube; `count` of which each overlaps some
 * ten others; a single one. */
void bench_make_all_overlap(struct bench_scene *scene, bool small);
void bench_make_soup(struct bench_scene *scene, uint32_t count);
void bench_make_one_triangle(struct bench_scene *scene, bool small);

/* near.c: pairs of triangles of length 1 and width 1e-8; those of a pair are nearer
 * than 2, all else farther apart. */
void bench_make_needles(struct bench_scene *scene, bool small);

/* thin.c: a cloud of a million points (object 0) that comes down on a sheet of a hundred
 * thousand triangles (object 1) by 5 r, so that a tenth of it comes within r; the
 * same where points may meet each other, as may the sheet itself; ten thousand strands of
 * a hundred edges, 4 r apart, of which each goes 2 r its own way. */
void bench_make_points(struct bench_scene *scene, bool small);
void bench_make_points_self(struct bench_scene *scene, bool small);
void bench_make_hair(struct bench_scene *scene, bool small);

/* Two bodies of 9800 triangles, apart at first, one in the other at last. */
void bench_make_passing(struct bench_scene *scene, bool small);

/* A cloth of 392 triangles comes down on a box of 12. */
void bench_make_over_box(struct bench_scene *scene);

/* breaking.c: a body (object 0) hits another (object 1), which breaks into pieces that
 * fly, tumble and fall on the ground (object 2). Until then object 1 is one closed
 * surface, in the place of the pieces' outer sides. */
void bench_make_breaking(struct bench_scene *scene, bool small);

/* exploding.c: a closed surface of many clusters of triangles that fly apart. */
void bench_make_exploding(struct bench_scene *scene, bool small);

/* bodies.c: hundreds of rigid and deforming bodies fall together. */
void bench_make_bodies(struct bench_scene *scene, bool small);

/* layers.c: a stack of `layer_count` waving sheets of side x side vertices, each an
 * object; as many contacts a triangle in any size. The other one has 10 million. */
void bench_make_layers(struct bench_scene *scene, uint32_t layer_count, uint32_t side);
void bench_make_layers_10m(struct bench_scene *scene, bool small);
/* Two sheets, of which `count` vertices of the one pass through the other to and fro. */
void bench_make_crossing(struct bench_scene *scene, uint32_t side, uint32_t count);

/* game.c: a landscape that stands, bodies that move on it, a flag; now and then a large
 * boulder rolls on. Sixty frames are a second. */
void bench_make_game(struct bench_scene *scene, bool small);

/* partial.c: which part of a scene moves. */
enum bench_moving_what {
    BENCH_MOVING_TOLD,     /* as the scene is told */
    BENCH_MOVING_OBJECTS,  /* a share of the objects, spread evenly */
    BENCH_MOVING_PATCH,    /* of the vertices, those around one of the largest object */
    BENCH_MOVING_VERTICES, /* of the vertices, spread evenly */
    BENCH_MOVINGS
};
struct bench_moving {
    enum bench_moving_what what;
    double share; /* 0 .. 1 */
};

/* The objects of `told`. What moves goes to and fro between `frame` and the next one, all
 * else stands where it is at `frame`; for any number of frames. */
void bench_make_partial(struct bench_scene *scene, const struct bench_scene *told,
                        uint32_t frame, struct bench_moving moving);

#endif
