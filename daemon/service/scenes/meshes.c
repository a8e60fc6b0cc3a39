/* meshes.c - what the handle of a mesh stands for. */
#include "meshes.h"

#include "enginemem.h"
#include "invariant.h"

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
