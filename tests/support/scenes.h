/* scenes.h - generated meshes with motion, small enough for brute force. */
#ifndef TESTS_SCENES_H
#define TESTS_SCENES_H

#include <stdbool.h>
#include <stdint.h>

#include "prng.h"

enum scenes_kind {
    SCENES_SOUP,        /* unconnected triangles, general position */
    SCENES_CLOTH,       /* a grid that rolls itself up */
    SCENES_SPHERE,      /* a closed surface that crumples */
    SCENES_TWO_SPHERES, /* two that collide */
    SCENES_SNAPPED,     /* random indices on a lattice: touching, coplanar, degenerate */
    SCENES_FAST,        /* a soup that moves by many times its size */
    SCENES_SLIDING,     /* patches that slide in common planes */
    SCENES_DUPLICATES,  /* a cloth with duplicate and degenerate triangles */
    SCENES_STILL,       /* a lattice of which most vertices do not move */
    SCENES_SLIVERS,     /* long thin triangles, almost parallel edges */
    SCENES_FAR,         /* a soup a million lengths from the origin */
    SCENES_TINY,        /* a soup of size 1e-30 */
    SCENES_KINDS
};

struct scenes_mesh {
    uint32_t vertex_count;
    uint32_t triangle_count;
    bool is_f32; /* every coordinate is a float */
    double (*x0)[3];
    double (*x1)[3];
    uint32_t (*triangles)[3];
    /* Of a part: the numbers in the mesh it was cut from. NULL otherwise. */
    uint32_t *vertex_of;
    uint32_t *triangle_of;
};

const char *scenes_name(enum scenes_kind kind);

/* About `triangle_count` triangles; ends the process where memory ends. */
void scenes_make(struct scenes_mesh *mesh, enum scenes_kind kind, uint32_t triangle_count,
                 bool is_f32, uint64_t seed);
void scenes_deinit(struct scenes_mesh *mesh);

/* Start the next step: x0 = x1, and a new x1 in the manner of the kind. */
void scenes_move_on(struct scenes_mesh *mesh, enum scenes_kind kind, struct prng *prng);

/* Cut into at most `count` meshes without cutting through a connected piece: what touches
 * in the whole touches in the parts. The numbers keep their order. Returns how many of
 * parts[] were made; each has at least one triangle. Vertices in no triangle are left
 * out. */
uint32_t scenes_split(const struct scenes_mesh *mesh, uint32_t count,
                      struct scenes_mesh *parts);

#endif
