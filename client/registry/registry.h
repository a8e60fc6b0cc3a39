/* registry.h - remembers what a client has registered with a daemon: meshes, scenes and
 * objects.
 *
 * A mesh that is destroyed stays for as long as objects are made of it:
 *
 *     registry_put_mesh(7) -> registry_add_object(mesh 7) -> registry_destroy_mesh(7)
 *         -> no mesh has handle 7 any more -> registry_remove_object() frees its arrays
 *
 * Where objects are is registry_positions.h.
 */
#ifndef REGISTRY_H
#define REGISTRY_H

#include "registry_types.h"

/* A copy of a mesh, which no registry has yet; NULL: no memory. */
struct registry_mesh *registry_mesh_copy(const struct registry_shape *shape);
/* What it is made of; the arrays are the mesh's. */
struct registry_shape registry_mesh_shape(const struct registry_mesh *mesh);
/* A mesh that no registry has; NULL is allowed. */
void registry_mesh_free(struct registry_mesh *mesh);

/* The mesh `handle` is made, or gets other contents: those of `copy`, which is taken
 * over. Objects of one that is replaced stand where the new one was registered; steps
 * before `step` say nothing of them any more. Returns 0 or PCCD_E_NOMEM: objects whose
 * both ends could not be followed any more (registry_positions.h) are gone. */
int registry_put_mesh(struct registry *registry, uint32_t handle,
                      struct registry_mesh *copy, uint64_t step);
/* NULL: there is none of that handle. */
struct registry_mesh *registry_mesh(const struct registry *registry, uint32_t handle);
void registry_destroy_mesh(struct registry *registry, struct registry_mesh *mesh);

/* NULL: no memory. There is no scene of that handle before. */
struct registry_scene *registry_add_scene(struct registry *registry, uint32_t handle,
                                          const struct registry_settings *settings);
struct registry_scene *registry_scene(const struct registry *registry, uint32_t handle);
void registry_remove_scene(struct registry *registry, struct registry_scene *scene);

/* An object that stands where its mesh was registered, and may meet all. NULL: no memory.
 * There is no object of that handle in the scene before. */
struct registry_object *registry_add_object(struct registry_scene *scene,
                                            struct registry_mesh *mesh, uint32_t handle,
                                            uint64_t step);
/* An object with a shape that no other has: of a mesh that is destroyed already. One that
 * is there gets the shape and keeps what it may meet. Takes `copy` over unless it returns
 * NULL: no memory. */
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
/* Whether anything was ever set of what its objects may meet, and not taken back; its
 * pairs may have to be settled before. */
bool registry_is_filtered(const struct registry_scene *scene);
/* Whether these two objects, or this one and itself, are tested against each other. The
 * scene's pairs are settled. */
bool registry_may_meet(const struct registry_scene *scene,
                       const struct registry_object *a, const struct registry_object *b);

void registry_deinit(struct registry *registry);

#endif
