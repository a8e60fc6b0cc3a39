/* meshes.c - what the handle of a mesh stands for. */
#include "meshes.h"

#include "enginemem.h"
#include "invariant.h"
#include "proto_limits.h"

struct srv_mesh *srv_mesh_new(uint64_t number, struct srv_shape *shape,
                              struct proto_error *error)
{
    srv_assert_loop();
    struct srv_quota_user *user = shape->resource.owner->user;
    struct srv_mesh *mesh = srv_enginemem_new(user, sizeof *mesh, "a mesh", error);
    if (mesh != NULL) {
        mesh->user = user;
        mesh->current = shape;
        mesh->number = number;
        mesh->generation = 1;
    }
    return mesh;
}

static void free_if_done(struct srv_mesh *mesh)
{
    if (mesh->is_gone && mesh->objects == NULL) {
        srv_enginemem_delete(mesh->user, mesh);
    }
}

void srv_mesh_free(struct srv_mesh *mesh)
{
    srv_assert_loop();
    srv_resource_drop(&mesh->current->resource);
    if (mesh->next != NULL) {
        srv_resource_drop(&mesh->next->resource);
    }
    mesh->current = NULL;
    mesh->next = NULL;
    mesh->handle = 0;
    mesh->is_gone = true;
    free_if_done(mesh);
}

int srv_mesh_refuse_busy(const struct srv_mesh *mesh, uint32_t handle,
                         struct proto_error *error)
{
    return mesh->is_busy
               ? proto_error_set(error, PCCD_E_BUSY,
                                 "mesh 0x%x: its replacement is being committed", handle)
               : 0;
}

void srv_mesh_link(struct srv_mesh *mesh, struct srv_object *object)
{
    srv_assert_loop();
    object->mesh = mesh;
    object->prev = NULL;
    object->next = mesh->objects;
    if (object->next != NULL) {
        object->next->prev = object;
    }
    mesh->objects = object;
    mesh->object_count++;
}

void srv_object_unlink(struct srv_object *object)
{
    srv_assert_loop();
    struct srv_mesh *mesh = object->mesh;
    if (mesh == NULL) {
        return;
    }
    if (object->prev != NULL) {
        object->prev->next = object->next;
    } else {
        mesh->objects = object->next;
    }
    if (object->next != NULL) {
        object->next->prev = object->prev;
    }
    mesh->object_count--;
    object->mesh = NULL;
    free_if_done(mesh);
}

/* ---- shapes ------------------------------------------------------------------------ */

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
    srv_quota_refund(owner->user, SRV_QUOTA_TRIANGLES, srv_shape_charge(&shape->counts));
    srv_enginemem_delete(owner->user, shape);
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

static uint64_t named_by(const struct eng_mesh_counts *counts)
{
    return (uint64_t)counts->triangles + counts->edges + counts->points;
}

uint64_t srv_shape_charge(const struct eng_mesh_counts *counts)
{
    return srv_triangle_charge(counts->vertices, named_by(counts));
}

int srv_shape_admit(struct srv_owner *owner, const struct eng_mesh_counts *counts,
                    struct srv_shape **shape, struct proto_error *error)
{
    srv_assert_loop();
    uint64_t named = named_by(counts);
    if (counts->vertices < 1 || counts->vertices > PROTO_COUNT_MAX || named < 1 ||
        named > PROTO_COUNT_MAX) {
        return proto_error_set(
            error, PCCD_E_INVAL,
            "a mesh has 1 to %u vertices, and as many triangles, edges "
            "and points, not %u and %llu",
            PROTO_COUNT_MAX, counts->vertices, (unsigned long long)named);
    }
    uint64_t triangles = srv_shape_charge(counts);
    int status = srv_enginemem_refuse_tight(owner->user, triangles, error);
    if (status == 0) {
        status = charge_shape(owner, triangles, error);
    }
    if (status != 0) {
        return status;
    }
    struct srv_shape *new = srv_enginemem_new(owner->user, sizeof *new, "a mesh", error);
    if (new == NULL) {
        srv_quota_refund(owner->user, SRV_QUOTA_MESHES, 1);
        srv_quota_refund(owner->user, SRV_QUOTA_TRIANGLES, triangles);
        return error->code;
    }
    srv_resource_init(&new->resource, owner, shape_free_engine, shape_free_rest);
    new->counts = *counts;
    *shape = new;
    return 0;
}

int srv_shape_engine(struct srv_shape *shape, struct eng_mesh **engine)
{
    srv_assert_compute();
    int status = 0;
    if (shape->engine == NULL) {
        status = eng_mesh_make(&shape->counts, &shape->engine);
    }
    *engine = shape->engine;
    return status;
}
