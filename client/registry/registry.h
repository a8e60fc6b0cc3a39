/* registry.h - remembers what a client has registered with a daemon, and where it is.
 *
 * A mesh that is destroyed stays for as long as objects are made of it:
 *
 *     registry_put_mesh(7) -> registry_add_object(mesh 7) -> registry_destroy_mesh(7)
 *         -> no mesh has handle 7 any more -> registry_remove_object() frees its arrays
 *
 * Where objects are is registry_positions.c.
 */
#ifndef REGISTRY_H
#define REGISTRY_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "object_attributes.h"
#include "proto_limits.h"

/* ---- Finds what belongs to a handle, among many. */

/* All zero: empty. */
struct registry_map {
    struct registry_map_entry *entries; /* [room], a power of two; half of it is free */
    uint32_t room;
    uint32_t count;
};

/* Put a value under a handle, which is not 0, in the place of one that is there. 0 or
 * PCCD_E_NOMEM. */
int registry_map_put(struct registry_map *map, uint32_t handle, uint64_t value);
/* Get the value of a handle. False: there is none, and *value is as before. */
bool registry_map_get(const struct registry_map *map, uint32_t handle, uint64_t *value);
/* Remove the value of a handle, if there is one. */
void registry_map_remove(struct registry_map *map, uint32_t handle);
void registry_map_deinit(struct registry_map *map);

/* ---- Remembers which pairs of objects ignore each other, or have a clearance. */

struct registry_pair {
    uint32_t a; /* handles, the lesser first */
    uint32_t b;
    uint32_t order; /* in which they were told */
    bool ignored;
    bool has_clearance; /* in the place of their radii; then they are not ignored */
    double clearance;
};

/* The pairs that were named; the last word on a pair counts. All zero: nothing. */
struct registry_pairs {
    struct registry_pair *said; /* [room] */
    uint32_t count;
    uint32_t room;
    bool is_unsettled; /* the last word on a pair may not be the only one */
};

/* Note what is said of a pair of objects, the lesser of which need not be the first.
 * Returns 0 or PCCD_E_NOMEM: it has not been noted. */
int registry_pairs_note(struct registry_pairs *pairs, const struct registry_pair *said);
/* Forget what was said of an object that is gone. O(count). */
void registry_pairs_forget(struct registry_pairs *pairs, uint32_t object);
/* Leave those that ignore each other or have a clearance, each once, in the order of
 * their handles. Nothing where nothing was told since the last time, else O(count log
 * count). */
void registry_pairs_settle(struct registry_pairs *pairs);
/* Return what is said of two objects; NULL: nothing. O(log count), of pairs that are
 * settled. */
const struct registry_pair *registry_pairs_find(const struct registry_pairs *pairs,
                                                uint32_t a, uint32_t b);
/* Return the clearance of two objects; negative: they have none, or are one. The pairs
 * are settled. */
double registry_pairs_clearance(const struct registry_pairs *pairs, uint32_t a,
                                uint32_t b);
/* Return half of the largest clearance of an object, at least 0. O(count), of pairs that
 * are settled. */
double registry_pairs_half_clearance(const struct registry_pairs *pairs, uint32_t object);
void registry_pairs_deinit(struct registry_pairs *pairs);

/* ---- The structs of a registry: meshes, scenes and objects. */

/* The parts that a mesh is made of. The arrays need not be aligned. */
struct registry_shape {
    uint32_t format; /* enum pccd_format, of x */
    uint32_t vertex_count, triangle_count, edge_count, point_count;
    const void *x;         /* [vertex_count][3] */
    const void *triangles; /* uint32_t [triangle_count][3] */
    const void *edges;  /* uint32_t [edge_count][2]: those that are named by themselves */
    const void *points; /* uint32_t [point_count]: named so */
    const void *radii;  /* double [vertex_count]; NULL: there are none */
};

/* Vertices and what is made of them as they were registered. */
struct registry_mesh {
    struct registry_mesh *next; /* registered later */
    uint32_t handle;
    uint32_t made_handle;  /* the one that another daemon gave it, for whoever tells it */
    uint32_t object_count; /* made of it */
    bool is_destroyed;     /* but objects are left */
    bool is_told;          /* that daemon knows its contents, and that it is destroyed */
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
    uint32_t *named_points;     /* by themselves; NULL: there are none */
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
    double (*x1)[3]; /* are not followed (registry_positions.c) */
    double m[12];
    bool turned;    /* in the last step, where both ends are followed: on this joint of */
    uint32_t joint; /* the step; registry_begin_step forgets it */
    uint64_t since; /* what steps before this one said of its place counts no more */
    uint32_t what;  /* enum pccd_object_what: that was ever set, of the next */
    struct common_attributes attributes;
    char *name;   /* ours: for people; NULL: it has none */
    bool is_made; /* another daemon has one of that handle, and knows of what it is */
    bool is_told; /* ... and its attributes, for whoever tells it */
};

/* Settings of a scene, as when it was made. */
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
    struct registry_pairs pairs;
    bool is_made;   /* another daemon has it, for whoever tells it */
    bool is_told;   /* ... and all its objects */
    bool is_placed; /* ... and knows where they are */
    bool has_begin; /* ... and where the last step began */
};

/* All zero: nothing was told. */
struct registry {
    struct registry_mesh *meshes; /* in the order in which they were registered */
    struct registry_scene *scenes;
    struct registry_scene *last_scene; /* of these; NULL: there are none */
    struct registry_map scene_map;     /* of pointers to them, by handle */
};

/* Return a mesh that is a copy of a shape, and that no registry has yet; NULL: no
 * memory. */
struct registry_mesh *registry_mesh_copy(const struct registry_shape *shape);
/* Return what it is made of; the arrays are the mesh's. */
struct registry_shape registry_mesh_shape(const struct registry_mesh *mesh);
/* Free a mesh that no registry has; NULL is allowed. */
void registry_mesh_free(struct registry_mesh *mesh);

/* Make the mesh `handle`, or give it other contents: those of `copy`, which is taken
 * over. Objects of one that is replaced stand where the new one was registered; steps
 * before `step` say nothing of them any more. Returns 0 or PCCD_E_NOMEM: objects whose
 * both ends could not be followed any more (registry_positions.c) are gone. */
int registry_put_mesh(struct registry *registry, uint32_t handle,
                      struct registry_mesh *copy, uint64_t step);
/* Return the mesh of a handle; NULL: there is none. */
struct registry_mesh *registry_mesh(const struct registry *registry, uint32_t handle);
void registry_destroy_mesh(struct registry *registry, struct registry_mesh *mesh);

/* Add a scene; there is none of that handle before. NULL: no memory. */
struct registry_scene *registry_add_scene(struct registry *registry, uint32_t handle,
                                          const struct registry_settings *settings);
struct registry_scene *registry_scene(const struct registry *registry, uint32_t handle);
void registry_remove_scene(struct registry *registry, struct registry_scene *scene);

/* Add an object that stands where its mesh was registered, and may meet all. NULL: no
 * memory. There is no object of that handle in the scene before. */
struct registry_object *registry_add_object(struct registry_scene *scene,
                                            struct registry_mesh *mesh, uint32_t handle,
                                            uint64_t step);
/* Put an object with a shape that no other has: of a mesh that is destroyed already. One
 * that is there gets the shape and keeps what it may meet. Takes `copy` over unless it
 * returns NULL: no memory. */
struct registry_object *registry_put_guest(struct registry *registry,
                                           struct registry_scene *scene, uint32_t handle,
                                           struct registry_mesh *copy);
struct registry_object *registry_object(const struct registry_scene *scene,
                                        uint32_t handle);
void registry_remove_object(struct registry *registry, struct registry_scene *scene,
                            struct registry_object *object);

/* Set those of its attributes that `what` names. */
void registry_set_object(struct registry_object *object, uint32_t what,
                         const struct common_attributes *given);
/* Give it a name of so many bytes, in the place of the one it has; of none: no name. 0 or
 * PCCD_E_NOMEM: it has the one of before. */
int registry_name_object(struct registry_object *object, const char *name, size_t bytes);
/* Return whether these two objects, or this one and itself, are tested against each
 * other. The scene's pairs are settled. */
bool registry_may_meet(const struct registry_scene *scene,
                       const struct registry_object *a, const struct registry_object *b);

void registry_deinit(struct registry *registry);

/* ---- Remembers where the objects of a registry are.
 *
 * Follow the positions that steps bring, in one of two ways. libpccd wants the end of the
 * last step in as few bytes as possible (registry_place): a rigid body is 12 numbers,
 * floats stay floats. pccdctl looks at the steps of a recording and wants both ends of
 * the last one, in doubles (registry_follow, registry_begin_step, registry_move). */

/* Some vertices of an object, where a step brings them. Pointers need not be aligned. */
struct registry_motion {
    bool is_rigid;   /* start and end are double[12] and transform what is registered */
    uint32_t format; /* of start and end, if not */
    uint32_t first;  /* the vertices; within the mesh */
    uint32_t count;
    const void *start; /* NULL: where the last step has ended */
    const void *end;
};

/* Find where vertex `v` of a mesh was registered. */
void registry_registered(const struct registry_mesh *mesh, uint32_t v, double x[3]);

/* Let the object stand where its mesh was registered, whatever steps before `step` said.
 * 0, or PCCD_E_NOMEM where both ends are followed. */
int registry_reset(struct registry_object *object, uint64_t step);

/* Return the first vertex that the motion, which is within the object, would take to
 * where no coordinates are, in the beginning or at the end; motion->first + count:
 * none. */
uint32_t registry_first_stray(const struct registry_object *object,
                              const struct registry_motion *motion);

/* Place the object where a motion ends; where it starts does not count. 0 or
 * PCCD_E_NOMEM: then it stays where it was. */
int registry_place(struct registry_object *object, const struct registry_motion *motion);

/* Follow both ends of an object's steps, from where its mesh was registered: x0, x1. 0 or
 * PCCD_E_NOMEM. */
int registry_follow(struct registry_object *object);
/* Begin a step where the last one has ended, for all objects of the scene, which are
 * followed; then some of them move. */
void registry_begin_step(struct registry_scene *scene);
void registry_move(struct registry_object *object, const struct registry_motion *motion);

void registry_free_positions(struct registry_object *object);

#endif
