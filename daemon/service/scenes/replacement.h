/* replacement.h - replaces the shape of a mesh in every object made of it, in all of them
 * or in none.
 *
 * Threads: [loop], but for functions marked otherwise.
 */
#ifndef SRV_REPLACEMENT_H
#define SRV_REPLACEMENT_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

#include "meshes.h"
#include "srv_scene.h"

/* The work of the commit of a replacement: every scene of the session. */
struct srv_replacement {
    uint64_t mesh_number;
    uint64_t replaced;   /* [compute] objects that did */
    uint32_t generation; /* that the mesh gets */
    uint32_t scene_count;
    struct srv_claim **claims;  /* [scene_count], of the scenes */
    struct srv_scene *scenes[]; /* [scene_count], with a reference each */
};

/* Take the references, and make the mesh busy. Returns 0, or with *error set PCCD_E_STATE
 * (an object is in a scene of another user) or PCCD_E_NOMEM: nothing has changed then. */
int srv_replacement_begin(struct srv_session *session, struct srv_mesh *mesh,
                          struct srv_replacement **replacement,
                          struct proto_error *error);

/* Give every object made of the mesh the committed mesh of `shape`, or none. Returns 0 or
 * a wire status with *error set: everything is as before then. PCCD_E_CANCELLED: *cancel
 * became true. [compute] */
int srv_replacement_work(struct srv_replacement *replacement,
                         const struct srv_shape *shape, const atomic_bool *cancel,
                         struct proto_error *error);

/* End what srv_replacement_begin began, and free it; if it succeeded, the mesh has its
 * new shape from now on. `mesh` NULL: the session has it no more. [loop] */
void srv_replacement_finish(struct srv_session *session, struct srv_mesh *mesh,
                            struct srv_replacement *replacement, bool succeeded);

#endif
