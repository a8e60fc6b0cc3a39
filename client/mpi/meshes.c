/* meshes.c - the meshes of a world. */
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "parts.h"
#include "rounding.h"

/* The objects of `before` are made of `mesh` from now on, at its registered positions. */
static int change_objects(struct pccd_mpi *world, struct ranks_mesh *before,
                          struct ranks_mesh *mesh)
{
    size_t bytes = ((size_t)mesh->vertex_count + 1) * sizeof *mesh->x;
    for (uint32_t i = 0; i < world->object_count; i++) {
        struct ranks_object *object = world->objects[i];
        if (object->mesh != before) {
            continue;
        }
        double(*x)[3] = malloc(bytes), (*next)[3] = malloc(bytes);
        if (x == NULL || next == NULL) {
            free(x);
            free(next);
            world->link.broken = PCCD_E_NOMEM; /* some have changed already */
            return ranks_no_memory(world);
        }
        memcpy(x, mesh->x, bytes - sizeof *mesh->x);
        struct ranks_object fresh = {.handle = object->handle,
                                     .mesh = mesh,
                                     .local_mesh = object->local_mesh,
                                     .settings = object->settings,
                                     .x = x,
                                     .next = next,
                                     .begun = (const double(*)[3])x};
        struct ranks_object *old = malloc(sizeof *old);
        if (old != NULL) {
            *old = *object;
        }
        *object = fresh;
        ranks_object_free(old);
        mesh->objects++;
    }
    return PCCD_OK;
}

static int put_mesh(struct pccd_mpi *world, const struct pccd_mpi_part *part,
                    uint32_t *handle, struct pccd_mesh_info *info)
{
    struct ranks_mesh *mesh = NULL, *before = NULL;
    void **meshes = ranks_room_for_one((void **)world->meshes, world->mesh_count);
    int status = meshes == NULL ? ranks_no_memory(world) : PCCD_OK;
    if (meshes != NULL) {
        world->meshes = (struct ranks_mesh **)meshes;
    }
    status = ranks_agree_on(&world->link, status);
    if (status == PCCD_OK) {
        status = ranks_mesh_make(world, part, &mesh);
    }
    if (status != PCCD_OK) {
        return status;
    }
    if (*handle == 0) {
        mesh->handle = ++world->mesh_number;
        mesh->info.generation = 1;
        world->meshes[world->mesh_count++] = mesh;
    } else {
        for (uint32_t i = 0; i < world->mesh_count; i++) {
            if (world->meshes[i] == ranks_find_mesh(world, *handle)) {
                before = world->meshes[i];
                mesh->handle = before->handle;
                mesh->info.generation = before->info.generation + 1;
                world->meshes[i] = mesh;
                break;
            }
        }
        status = ranks_agree_on(&world->link, change_objects(world, before, mesh));
        ranks_mesh_free(before);
        world->is_cut = world->is_covered = false;
    }
    *handle = mesh->handle;
    if (info != NULL) {
        *info = mesh->info;
    }
    return status;
}

/* A part as this library knows it. */
static struct pccd_mpi_part read_part(const struct pccd_mpi_part *part)
{
    struct pccd_mpi_part known = {.struct_bytes = sizeof known};
    if (part == NULL) {
        return known;
    }
    size_t bytes = part->struct_bytes;
    memcpy(&known, part, bytes == 0 || bytes > sizeof known ? sizeof known : bytes);
    return known;
}

int pccd_mpi_mesh_put(struct pccd_mpi *world, const struct pccd_mpi_part *part,
                      uint32_t *mesh, struct pccd_mesh_info *info)
{
    COMMON_ROUNDING_HERE;
    if (world == NULL) {
        return PCCD_E_INVAL;
    }
    struct pccd_mpi_part known = read_part(part);
    const uint32_t same[3] = {known.vertex_total, known.triangle_total,
                              mesh != NULL ? *mesh : 0};
    int status = part == NULL || mesh == NULL
                     ? ranks_missing(&world->link, part == NULL ? "part" : "mesh")
                     : ranks_part_check(world, &known);
    if (status == PCCD_OK && *mesh != 0 && ranks_find_mesh(world, *mesh) == NULL) {
        status =
            ranks_fail(&world->link, PCCD_E_HANDLE, "there is no mesh %" PRIu32, *mesh);
    }
    status = ranks_agree(&world->link, RANKS_MESH_PUT, ranks_hash(0, same, sizeof same),
                         status);
    return status == PCCD_OK ? put_mesh(world, &known, mesh, info) : status;
}

void ranks_forget_mesh(struct pccd_mpi *world, struct ranks_mesh *mesh)
{
    for (uint32_t i = 0; i < world->mesh_count; i++) {
        if (world->meshes[i] == mesh) {
            world->meshes[i] = world->meshes[--world->mesh_count];
            ranks_mesh_free(mesh);
            return;
        }
    }
}

int pccd_mpi_mesh_destroy(struct pccd_mpi *world, uint32_t mesh)
{
    COMMON_ROUNDING_HERE;
    if (world == NULL) {
        return PCCD_E_INVAL;
    }
    struct ranks_mesh *found = ranks_find_mesh(world, mesh);
    int status = found != NULL ? PCCD_OK
                               : ranks_fail(&world->link, PCCD_E_HANDLE,
                                            "there is no mesh %" PRIu32, mesh);
    status = ranks_agree(&world->link, RANKS_MESH_DESTROY, mesh, status);
    if (status == PCCD_OK) {
        found->is_gone = true;
        if (found->objects == 0) {
            ranks_forget_mesh(world, found);
        }
    }
    return status;
}
