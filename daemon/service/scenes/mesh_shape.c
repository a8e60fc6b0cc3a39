/* mesh_shape.c - the vertices and triangles of a mesh, as they were announced.
 *
 * Room:     service. See mesh_shape.h.
 * Does:     admission on [loop]; the engine's part comes and goes on [compute].
 * Threads:  [loop] and [compute], as marked.
 */
#include "mesh_shape.h"

#include <stdlib.h>

#include "enginemem.h"
#include "invariant.h"
#include "proto_limits.h"

static void shape_free_engine(struct srv_job *job)
{
    struct srv_shape *shape = (struct srv_shape *)job;
    eng_mesh_release(shape->engine);
    shape->engine = NULL;
}

static void shape_free_rest(struct srv_job *job)
{
    struct srv_shape *shape = (struct srv_shape *)job;
    struct srv_owner *owner = shape->resource.owner;
    srv_quota_refund(owner->user, SRV_QUOTA_MESHES, 1);
    srv_quota_refund(owner->user, SRV_QUOTA_TRIANGLES,
                     srv_triangle_charge(shape->vertex_count, shape->triangle_count));
    free(shape);
    srv_owner_release(owner);
}

/* Charge for one mesh and its triangles, or for nothing. */
static int charge_shape(struct srv_owner *owner, uint64_t triangles,
                        struct proto_error *error)
{
    int status = srv_quota_charge(owner->user, SRV_QUOTA_MESHES, 1, error);
    if (status != 0) {
        return status;
    }
    status = srv_quota_charge(owner->user, SRV_QUOTA_TRIANGLES, triangles, error);
    if (status != 0) {
        srv_quota_refund(owner->user, SRV_QUOTA_MESHES, 1);
    }
    return status;
}

int srv_shape_admit(struct srv_owner *owner, uint32_t vertex_count,
                    uint32_t triangle_count, struct srv_shape **shape,
                    struct proto_error *error)
{
    srv_assert_loop();
    if (vertex_count < 1 || vertex_count > PROTO_COUNT_MAX || triangle_count < 1 ||
        triangle_count > PROTO_COUNT_MAX) {
        return proto_error_set(error, PCCD_E_INVAL,
                               "a mesh has 1 to %u vertices and triangles, not %u and %u",
                               PROTO_COUNT_MAX, vertex_count, triangle_count);
    }
    uint64_t triangles = srv_triangle_charge(vertex_count, triangle_count);
    int status = srv_enginemem_refuse_tight(owner->user, triangles, error);
    if (status == 0) {
        status = charge_shape(owner, triangles, error);
    }
    if (status != 0) {
        return status;
    }
    struct srv_shape *new = calloc(1, sizeof *new);
    if (new == NULL) {
        srv_quota_refund(owner->user, SRV_QUOTA_MESHES, 1);
        srv_quota_refund(owner->user, SRV_QUOTA_TRIANGLES, triangles);
        return proto_error_set(error, PCCD_E_NOMEM, "no memory for a mesh");
    }
    srv_resource_init(&new->resource, owner, shape_free_engine, shape_free_rest);
    new->vertex_count = vertex_count;
    new->triangle_count = triangle_count;
    *shape = new;
    return 0;
}

int srv_shape_engine(struct srv_shape *shape, struct eng_mesh **engine)
{
    srv_assert_compute();
    int status = 0;
    if (shape->engine == NULL) {
        status = eng_mesh_new(shape->vertex_count, shape->triangle_count, &shape->engine);
    }
    *engine = shape->engine;
    return status;
}
