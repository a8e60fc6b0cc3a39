/* mesh_shape.h - the vertices of a mesh, and what is made of them, while they are
 * uploaded, and their copy in the engine.
 */
#ifndef SRV_MESH_SHAPE_H
#define SRV_MESH_SHAPE_H

#include <stdint.h>

#include "codec.h"
#include "engine.h"
#include "resource.h"

/* What was announced: a mesh, or what will replace one. */
struct srv_shape {
    struct srv_resource resource;
    struct eng_mesh_counts counts;
    struct eng_mesh *engine; /* [compute]; NULL until the first data arrive */
};

/* A shape of these counts, charged to the owner's user as one mesh and its triangles.
 * Returns 0, or PCCD_E_INVAL, PCCD_E_QUOTA or PCCD_E_NOMEM with *error set. [loop] */
int srv_shape_admit(struct srv_owner *owner, const struct eng_mesh_counts *counts,
                    struct srv_shape **shape, struct proto_error *error);
/* What a mesh of it, or an object, is charged (srv_triangle_charge). [any] */
uint64_t srv_shape_charge(const struct eng_mesh_counts *counts);
/* The engine's mesh, made when there is none. Returns a wire status. [compute] */
int srv_shape_engine(struct srv_shape *shape, struct eng_mesh **engine);

#endif
