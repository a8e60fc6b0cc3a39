/* meshes.h - what the handle of a mesh stands for.
 *
 * Room:     service. May include: resource.h.
 * Does:     know the shape that serves, the one that will replace it, and the objects
 *           made of the mesh; begin and finish a replacement.
 * Does not: hold vertices: shapes do, on the compute thread.
 * Threads:  [loop], but for functions marked otherwise.
 *
 *     current --mesh.replace--> current and next --mesh.commit--> next becomes current
 *                               ^    mesh.replace (again, or with counts 0): next is
 *                               |    dropped
 *                               `--- mesh.commit failed
 *
 * While the commit of a replacement is in flight the mesh is busy: requests that name it
 * are refused, because what they would meet is not decided yet.
 */
#ifndef SRV_MESHES_H
#define SRV_MESHES_H

#include <stdbool.h>
#include <stdint.h>

#include "resource.h"

struct srv_mesh {
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

/* A mesh of a shape, whose reference it takes over. NULL: no memory; the reference stays
 * the caller's. */
struct srv_mesh *srv_mesh_new(struct srv_session *session, struct srv_shape *shape);
/* Let go of its shapes; objects that are made of it stay. Takes no longer for many. */
void srv_mesh_free(struct srv_mesh *mesh);

/* PCCD_E_BUSY with *error set while its replacement is being committed, else 0. */
int srv_mesh_refuse_busy(const struct srv_mesh *mesh, uint32_t handle,
                         struct proto_error *error);

void srv_mesh_link(struct srv_mesh *mesh, struct srv_object *object);
void srv_object_unlink(struct srv_object *object); /* once or more often */

/* What the commit of a replacement works on: every scene of the session. */
struct srv_replacement {
    uint64_t mesh_number;
    uint64_t charged;    /* triangles, that the new shapes of objects have more */
    uint64_t replaced;   /* [compute] objects that did */
    uint32_t generation; /* that the mesh gets */
    uint32_t scene_count;
    struct srv_claim **claims;  /* [scene_count], of the scenes */
    struct srv_scene *scenes[]; /* [scene_count], with a reference each */
};

/* Charge for the objects, take the references, and make the mesh busy. Returns 0,
 * PCCD_E_QUOTA or PCCD_E_NOMEM with *error set: nothing has changed then. */
int srv_replacement_begin(struct srv_session *session, struct srv_mesh *mesh,
                          struct srv_replacement **replacement,
                          struct proto_error *error);

/* Give every object made of the mesh the committed mesh of `shape`, or none. Returns 0 or
 * a wire status with *error set: everything is as before then. [compute] */
int srv_replacement_work(struct srv_replacement *replacement,
                         const struct srv_shape *shape, struct proto_error *error);

/* The end of what begin began; `mesh` NULL: the session has it no more. */
void srv_replacement_finish(struct srv_session *session, struct srv_mesh *mesh,
                            struct srv_replacement *replacement, bool succeeded);

#endif
