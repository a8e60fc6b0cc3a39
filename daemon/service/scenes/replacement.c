/* replacement.c - another shape in the place of a mesh's, in every object made of it. */
#include "replacement.h"

#include <stdlib.h>

#include "invariant.h"
#include "service.h"
#include "session.h"
#include "srv_journal.h"

int srv_replacement_begin(struct srv_session *session, struct srv_mesh *mesh,
                          struct srv_replacement **replacement, struct proto_error *error)
{
    srv_assert_loop();
    PCCD_ASSERT(mesh->next != NULL && !mesh->is_busy);
    for (const struct srv_object *object = mesh->objects; object != NULL;
         object = object->next) {
        if (object->borrowed_shape != NULL) {
            return proto_error_set(error, PCCD_E_STATE,
                                   "object 0x%x is in a scene of another user; the mesh "
                                   "cannot be replaced",
                                   object->handle);
        }
    }
    struct srv_replacement *new;
    size_t each = sizeof new->scenes[0] + sizeof new->claims[0];
    new = malloc(sizeof *new + session->scenes.count *each);
    if (new == NULL) {
        return proto_error_set(error, PCCD_E_NOMEM, "no memory for a replacement");
    }
    *new = (struct srv_replacement){
        .mesh_number = mesh->number,
        .generation = mesh->generation + 1,
        .claims = (struct srv_claim **)(void *)(new->scenes + session->scenes.count)};
    uint32_t cursor = 0;
    for (struct srv_scene *scene;
         (scene = srv_handles_next(&session->scenes, &cursor)) != NULL;) {
        srv_resource_acquire(&scene->resource);
        new->claims[new->scene_count] = &scene->claim;
        new->scenes[new->scene_count++] = scene;
    }
    PCCD_ASSERT(new->scene_count == session->scenes.count);
    mesh->is_busy = true;
    *replacement = new;
    return 0;
}

/* Try every object of a scene that is made of the mesh. [compute] */
static int try_scene(struct srv_replacement *replacement, struct srv_scene *scene,
                     struct eng_mesh *mesh, const atomic_bool *cancel,
                     struct proto_error *error)
{
    for (uint32_t i = 0; i < scene->placed_count; i++) {
        struct srv_placed *placed = &scene->placed[i];
        if (placed->handle == 0 || placed->mesh_number != replacement->mesh_number) {
            continue;
        }
        srv_scene_forget_answers(scene);
        int status = eng_scene_prepare_rings(scene->engine, placed->engine_idx, mesh,
                                             placed->attributes.rest_rings, cancel);
        if (status == 0) {
            status = eng_scene_try_replace(scene->engine, placed->engine_idx, mesh);
        }
        if (status != 0) {
            PCCD_ASSERT(status == PCCD_E_NOMEM || status == PCCD_E_LIMIT ||
                        status == PCCD_E_CANCELLED);
            return proto_error_set(error, status,
                                   "object 0x%x cannot be replaced: %s; mesh and objects "
                                   "are as before",
                                   placed->handle, proto_status_text(status));
        }
        replacement->replaced++;
    }
    return 0;
}

/* Settle a scene: what was tried in it holds from now on. [compute] */
static void settle_scene(const struct srv_replacement *replacement,
                         struct srv_scene *scene, uint32_t vertex_count)
{
    eng_scene_settle(scene->engine);
    scene->changes++;
    for (uint32_t i = 0; i < scene->placed_count; i++) {
        struct srv_placed *placed = &scene->placed[i];
        if (placed->handle != 0 && placed->mesh_number == replacement->mesh_number) {
            placed->vertex_count = vertex_count;
            placed->generation = replacement->generation;
            srv_journal_add(scene, placed);
        }
    }
}

int srv_replacement_work(struct srv_replacement *replacement,
                         const struct srv_shape *shape, const atomic_bool *cancel,
                         struct proto_error *error)
{
    srv_assert_compute();
    int status = 0;
    replacement->replaced = 0;
    for (uint32_t i = 0; i < replacement->scene_count && status == 0; i++) {
        status =
            try_scene(replacement, replacement->scenes[i], shape->engine, cancel, error);
    }
    for (uint32_t i = 0; i < replacement->scene_count; i++) {
        struct srv_scene *scene = replacement->scenes[i];
        if (scene->engine == NULL) {
            continue;
        }
        if (status == 0) {
            settle_scene(replacement, scene, shape->counts.vertices);
        } else {
            eng_scene_take_back(scene->engine);
        }
    }
    return status;
}

/* Update what list.object and list.session tell. */
static void tell_objects(struct srv_session *session, struct srv_mesh *mesh)
{
    uint64_t triangles = srv_shape_charge(&mesh->next->counts);
    for (struct srv_object *object = mesh->objects; object != NULL;
         object = object->next) {
        session->stats.triangles += triangles - object->triangles; /* modulo 2^64 */
        object->triangles = triangles;
    }
}

void srv_replacement_finish(struct srv_session *session, struct srv_mesh *mesh,
                            struct srv_replacement *replacement, bool succeeded)
{
    srv_assert_loop();
    if (mesh != NULL) {
        PCCD_ASSERT(mesh->is_busy);
        mesh->is_busy = false;
    }
    if (mesh != NULL && succeeded) {
        tell_objects(session, mesh);
        srv_resource_drop(&mesh->current->resource);
        mesh->current = mesh->next;
        mesh->next = NULL;
        mesh->generation = replacement->generation;
        session->service->metrics.counters.meshes_replaced++;
        session->service->metrics.counters.builds += replacement->replaced;
    }
    for (uint32_t i = 0; i < replacement->scene_count; i++) {
        srv_resource_drop(&replacement->scenes[i]->resource);
    }
    free(replacement);
}
