/* shape.h - makes the meshes of each simulated client, different from all others.
 *
 * Make, from a seed and a client's number, a floor and a sheet that passes through it in
 * LOAD_FRAMES positions, again and again: step n takes it from position n to n + 1, and
 * the answers to n and n + LOAD_FRAMES are the same.
 */
#ifndef LOAD_SHAPE_H
#define LOAD_SHAPE_H

#include <stdbool.h>
#include <stdint.h>

#include "pccd_types.h"

#define LOAD_FRAMES          8u
#define LOAD_SIDE_MAX        708u /* of a sheet: a million triangles */
#define LOAD_FLOOR_SIDE      2u
#define LOAD_FLOOR_VERTICES  ((LOAD_FLOOR_SIDE + 1) * (LOAD_FLOOR_SIDE + 1))
#define LOAD_FLOOR_TRIANGLES (2 * LOAD_FLOOR_SIDE * LOAD_FLOOR_SIDE)

/* X(name, text) */
#define LOAD_SCENES(X)                                                                   \
    X(crumple, "a crumpled sheet jumps through the floor: every vertex hits")            \
    X(wave, "waves run through a sheet; their troughs dip into the floor")               \
    X(apart, "the same waves above the floor: nothing hits")

enum load_scene {
#define LOAD_SCENE_ENUM(name, text) LOAD_SCENE_##name,
    LOAD_SCENES(LOAD_SCENE_ENUM)
#undef LOAD_SCENE_ENUM
        LOAD_SCENE_COUNT
};

struct load_shape {
    uint64_t seed;
    uint32_t client;
    enum load_scene scene;
    uint32_t side; /* the sheet's squares along each of its sides */
};

/* Return a number for each index, well mixed; the same everywhere. */
uint64_t load_mix(uint64_t seed, uint64_t index);
/* Return random bits as a number in [0, 1). */
double load_unit(uint64_t bits);

/* Return the side of a sheet of about so many triangles, floor included. */
uint32_t load_sheet_side(uint32_t triangles);

static inline uint32_t load_sheet_vertices(const struct load_shape *shape)
{
    return (shape->side + 1) * (shape->side + 1);
}

static inline uint32_t load_sheet_triangle_count(const struct load_shape *shape)
{
    return 2 * shape->side * shape->side;
}

/* Write the floor's vertices and triangles; the sheet lies within it. */
void load_floor(const struct load_shape *shape, float (*x)[3], uint32_t (*triangles)[3]);
void load_sheet(const struct load_shape *shape, uint32_t (*triangles)[3]);

/* Write the sheet's vertices at a position, 0 .. LOAD_FRAMES - 1: x[vertices][3]. */
void load_sheet_at(const struct load_shape *shape, uint32_t frame,
                   enum pccd_format format, void *x);

/* Write rows of [R | t], a transform that takes its registered vertices to such a
 * position. */
void load_sheet_pose(const struct load_shape *shape, uint32_t frame, double m[12]);

/* ---- Chooses how many triangles each simulated client has. */

#define LOAD_SIZE_PARTS    16u
#define LOAD_TRIANGLES_MAX 1000000u

struct load_sizes {
    uint32_t count;
    struct load_size_part {
        uint32_t low, high; /* triangles */
        double weight;
    } parts[LOAD_SIZE_PARTS];
};

/* Read sizes from a text. False: it says nothing of the kind; *sizes is as it was. */
bool load_sizes_parse(struct load_sizes *sizes, const char *text);

/* Draw a number of triangles. luck: 64 random bits. */
uint32_t load_sizes_draw(const struct load_sizes *sizes, uint64_t luck);
uint32_t load_sizes_largest(const struct load_sizes *sizes);

#endif
