/* meshes.h - a mesh as clients see it: a handle, its current shape, and perhaps one that
 * is replacing it.
 *
 * Threads: [loop], but for functions marked otherwise.
 *
 * While the commit of a replacement runs, the mesh is busy: requests that name it are
 * refused, because it is not decided yet which shape they would use.
 */
#ifndef SRV_MESHES_H
#define SRV_MESHES_H

#include <stdbool.h>
#include <stdint.h>

#include "codec.h"
#include "engine.h"
#include "resource.h"

struct srv_member;
struct srv_session;

/* A shape that was announced: a mesh, or what will replace one. */
struct srv_shape {
    struct srv_resource resource;
    struct eng_mesh_counts counts;
    struct eng_mesh *engine; /* [compute]; NULL until the first data arrive */
};

/* Make a shape of these counts, charged to the owner's user as one mesh and its
 * triangles. Returns 0, or PCCD_E_INVAL, PCCD_E_QUOTA or PCCD_E_NOMEM with *error set.
 * [loop] */
int srv_shape_admit(struct srv_owner *owner, const struct eng_mesh_counts *counts,
                    struct srv_shape **shape, struct proto_error *error);
/* Return what a mesh of it, or an object, is charged (srv_triangle_charge). [any] */
uint64_t srv_shape_charge(const struct eng_mesh_counts *counts);
/* Give *engine the engine's mesh, made when there is none. Returns a wire status.
 * [compute] */
int srv_shape_engine(struct srv_shape *shape, struct eng_mesh **engine);

/* An object of a scene as the loop sees it. */
struct srv_object {
    uint32_t handle;
    uint64_t triangles;        /* as a mesh like it is charged */
    struct srv_session *owner; /* that added it */
    const struct srv_member
        *member; /* with which it did (shared.h); NULL: its own scene */
    struct common_attributes attributes; /* as was answered last */
    char *name; /* the same, ours: room for any; NULL: it never had one */
    struct srv_shape
        *borrowed_shape;     /* in a scene of another user: kept for as long as the
                              * object, so that each frees what is charged to it; and its
                              * triangles are charged to the owner's user */
    struct srv_mesh *mesh;   /* it is made of; NULL: mesh or scene was destroyed since */
    struct srv_object *prev; /* of the same mesh */
    struct srv_object *next;
};

struct srv_mesh {
    struct srv_quota_user *user; /* who is charged for it */
    struct srv_shape *current;
    struct srv_shape *next;     /* announced and not committed; NULL: none */
    struct srv_object *objects; /* made of it, in the scenes that the session has */
    uint64_t object_count;
    uint32_t handle;     /* 0: none yet, or no more */
    uint64_t number;     /* in this daemon; never another mesh's */
    uint32_t generation; /* of `current`: 1, then one more with each replacement */
    bool is_committed;   /* `current` is */
    bool is_busy;        /* the commit of `next` is in flight */
    bool is_gone;        /* only its objects know it; goes with the last of them */
};

/* Make a mesh of that number and of a shape, whose reference it takes over. NULL, with
 * *error set: no memory, or more than its user may have; the reference stays the
 * caller's. */
struct srv_mesh *srv_mesh_new(uint64_t number, struct srv_shape *shape,
                              struct proto_error *error);
/* Let go of its shapes; objects that are made of it stay. Takes no longer for many. */
void srv_mesh_free(struct srv_mesh *mesh);

/* Refuse a mesh while its replacement is being committed. Returns 0, or PCCD_E_BUSY with
 * *error set. */
int srv_mesh_refuse_busy(const struct srv_mesh *mesh, uint32_t handle,
                         struct proto_error *error);

void srv_mesh_link(struct srv_mesh *mesh, struct srv_object *object);
void srv_object_unlink(struct srv_object *object); /* once or more often */

#endif
