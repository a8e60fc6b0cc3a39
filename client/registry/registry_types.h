/* registry_types.h - the structs of a registry: meshes, scenes and objects. */
#ifndef REGISTRY_TYPES_H
#define REGISTRY_TYPES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "object_attributes.h"
#include "proto_limits.h"
#include "registry_map.h"
#include "registry_pairs.h"

/* What a mesh is made of. The arrays need not be aligned. */
struct registry_shape {
    uint32_t format; /* enum pccd_format, of x */
    uint32_t vertex_count, triangle_count, edge_count, point_count;
    const void *x;         /* [vertex_count][3] */
    const void *triangles; /* uint32_t [triangle_count][3] */
    const void *edges;  /* uint32_t [edge_count][2]: those that are named by themselves */
    const void *points; /* uint32_t [point_count]: likewise */
    const void *radii;  /* double [vertex_count]; NULL: there are none */
};

/* Vertices and what is made of them as they were registered. */
struct registry_mesh {
    struct registry_mesh *next; /* registered later */
    uint32_t handle;
    uint32_t made_handle;  /* the one that another daemon gave it, for whoever tells it */
    uint32_t object_count; /* made of it */
    bool is_destroyed;     /* but objects are left */
    uint32_t format;       /* enum pccd_format */
    uint32_t vertex_count;
    uint32_t triangle_count;
    uint32_t edge_count;
    void *x; /* [vertex_count][3] */
    uint32_t (*triangles)[3];
    double *radii;        /* [vertex_count]; NULL: there are none */
    uint32_t (*edges)[2]; /* as records number them; NULL: nobody has asked yet */
    /* Made with them: 1 for each edge that no triangle has, and for each point that is
     * named and that no triangle and no edge has. */
    uint8_t *is_free_edge;
    uint8_t *is_free_vertex;
    uint32_t named_edge_count;
    uint32_t named_point_count;
    uint32_t (*named_edges)[2]; /* by themselves; NULL: there are none */
    uint32_t *named_points;     /* likewise */
};

enum registry_placing {
    REGISTRY_AS_REGISTERED = 0, /* where the mesh was registered */
    REGISTRY_RIGID,             /* the same, transformed by `m` */
    REGISTRY_FREELY             /* at `x`, or `x1` */
};

struct registry_object {
    uint32_t handle;
    struct registry_mesh *mesh;
    enum registry_placing placing;
    uint32_t format; /* of x */
    void *x;         /* [vertex_count][3]; NULL: none yet */
    double (*x0)[3]; /* at the start of the last step, and at its end; NULL: both ends */
    double (*x1)[3]; /* are not followed (registry_positions.h) */
    double m[12];
    uint64_t since; /* what steps before this one said of its place counts no more */
    uint32_t what;  /* enum pccd_object_what: that was ever set, of the next */
    struct common_attributes attributes;
};

/* Of a scene, as when it was made. */
struct registry_settings {
    uint32_t share; /* enum pccd_share */
    uint32_t rights;
    uint32_t owner;
    char name[PROTO_STR_MAX + 1]; /* "": clients do not share it */
};

struct registry_scene {
    struct registry_scene *next; /* made later */
    struct registry_scene *prev;
    uint32_t handle;
    struct registry_settings settings;
    struct registry_object *objects; /* in the order of their handles */
    uint32_t object_count;
    uint32_t object_room;
    struct registry_pairs ignored;
};

/* All zero: nothing was told. */
struct registry {
    struct registry_mesh *meshes; /* in the order in which they were registered */
    struct registry_scene *scenes;
    struct registry_scene *last_scene; /* of these; NULL: there are none */
    struct registry_map scene_map;     /* of pointers to them, by handle */
    /* Recordings: what the mesh that comes next has, if it has so many vertices. */
    double *next_radii;
    uint32_t next_radii_count;
    uint32_t *next_free; /* the ends of its named edges, then its named points */
    uint32_t next_free_count;
    uint32_t next_edge_count;
    uint32_t next_point_count;
};

#endif
