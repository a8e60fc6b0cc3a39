/* registry.c - what a client has told a daemon: meshes, scenes and the objects in
 * them.
 */
#include "registry.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "coordinates.h"

#define OBJECTS_MIN 8u /* room of a scene's first */

/* ---- meshes ------------------------------------------------------------------------ */

static void free_arrays(struct registry_mesh *mesh)
{
    free(mesh->x);
    free(mesh->triangles);
    free(mesh->radii);
    free(mesh->edges);
    free(mesh->is_free_edge);
    free(mesh->is_free_vertex);
    free(mesh->named_edges);
    free(mesh->named_points);
}

void registry_mesh_free(struct registry_mesh *mesh)
{
    if (mesh != NULL) {
        free_arrays(mesh);
        free(mesh);
    }
}

/* A copy of `bytes` bytes; of none NULL. *failed: there is no memory for it. */
static void *copy_of(const void *from, size_t bytes, bool *failed)
{
    void *copy = bytes > 0 ? malloc(bytes) : NULL;

    if (copy != NULL) {
        memcpy(copy, from, bytes);
    }
    *failed |= bytes > 0 && copy == NULL;
    return copy;
}

struct registry_mesh *registry_mesh_copy(const struct registry_shape *shape)
{
    size_t radii = shape->radii != NULL ? shape->vertex_count * sizeof(double) : 0;
    struct registry_mesh *made = calloc(1, sizeof *made);
    bool failed = false;

    if (made == NULL) {
        return NULL;
    }
    made->format = shape->format;
    made->vertex_count = shape->vertex_count;
    made->triangle_count = shape->triangle_count;
    made->named_edge_count = shape->edge_count;
    made->named_point_count = shape->point_count;
    made->x = copy_of(shape->x, shape->vertex_count * common_vertex_bytes(shape->format),
                      &failed);
    made->triangles =
        copy_of(shape->triangles, shape->triangle_count * sizeof(uint32_t[3]), &failed);
    made->named_edges =
        copy_of(shape->edges, shape->edge_count * sizeof(uint32_t[2]), &failed);
    made->named_points =
        copy_of(shape->points, shape->point_count * sizeof(uint32_t), &failed);
    made->radii = copy_of(shape->radii, radii, &failed);
    if (failed) {
        registry_mesh_free(made);
        return NULL;
    }
    return made;
}

struct registry_shape registry_mesh_shape(const struct registry_mesh *mesh)
{
    return (struct registry_shape){.format = mesh->format,
                                   .vertex_count = mesh->vertex_count,
                                   .triangle_count = mesh->triangle_count,
                                   .edge_count = mesh->named_edge_count,
                                   .point_count = mesh->named_point_count,
                                   .x = mesh->x,
                                   .triangles = mesh->triangles,
                                   .edges = mesh->named_edges,
                                   .points = mesh->named_points,
                                   .radii = mesh->radii};
}

struct registry_mesh *registry_mesh(const struct registry *registry, uint32_t handle)
{
    struct registry_mesh *mesh = registry->meshes;

    while (mesh != NULL && (mesh->handle != handle || mesh->is_destroyed)) {
        mesh = mesh->next;
    }
    return mesh;
}

/* The last: the order in which they were made. */
static void append_mesh(struct registry *registry, struct registry_mesh *mesh)
{
    struct registry_mesh **link = &registry->meshes;

    while (*link != NULL) {
        link = &(*link)->next;
    }
    mesh->next = NULL;
    *link = mesh;
}

/* Forget a mesh that was destroyed, once no object is made of it any more. */
static void settle_mesh(struct registry *registry, struct registry_mesh *mesh)
{
    struct registry_mesh **link = &registry->meshes;

    if (!mesh->is_destroyed || mesh->object_count > 0) {
        return;
    }
    while (*link != mesh) {
        assert(*link != NULL);
        link = &(*link)->next;
    }
    *link = mesh->next;
    registry_mesh_free(mesh);
}

void registry_destroy_mesh(struct registry *registry, struct registry_mesh *mesh)
{
    assert(!mesh->is_destroyed);
    mesh->is_destroyed = true;
    settle_mesh(registry, mesh);
}

/* ---- scenes ------------------------------------------------------------------------ */

struct registry_scene *registry_scene(const struct registry *registry, uint32_t handle)
{
    uint64_t found = 0;

    (void)registry_map_get(&registry->scene_map, handle, &found);
    return (struct registry_scene *)(uintptr_t)found;
}

struct registry_scene *registry_add_scene(struct registry *registry, uint32_t handle,
                                          const struct registry_settings *settings)
{
    struct registry_scene *made = calloc(1, sizeof *made);

    assert(registry_scene(registry, handle) == NULL);
    if (made == NULL ||
        registry_map_put(&registry->scene_map, handle, (uintptr_t)made) != 0) {
        free(made);
        return NULL;
    }
    made->handle = handle;
    made->settings = *settings;
    made->prev = registry->last_scene;
    if (made->prev != NULL) {
        made->prev->next = made;
    } else {
        registry->scenes = made;
    }
    registry->last_scene = made;
    return made;
}

/* Free what an object has of its own; its mesh goes with the last one. */
static void empty_object(struct registry *registry, struct registry_object *object)
{
    registry_free_positions(object);
    assert(object->mesh->object_count > 0);
    object->mesh->object_count--;
    settle_mesh(registry, object->mesh);
}

void registry_remove_scene(struct registry *registry, struct registry_scene *scene)
{
    for (uint32_t i = 0; i < scene->object_count; i++) {
        empty_object(registry, &scene->objects[i]);
        free(scene->objects[i].name);
    }
    if (scene->prev != NULL) {
        scene->prev->next = scene->next;
    } else {
        registry->scenes = scene->next;
    }
    if (scene->next != NULL) {
        scene->next->prev = scene->prev;
    } else {
        registry->last_scene = scene->prev;
    }
    registry_map_remove(&registry->scene_map, scene->handle);
    registry_pairs_deinit(&scene->pairs);
    free(scene->objects);
    free(scene);
}

/* ---- objects ----------------------------------------------------------------------- */

/* Index of the first object whose handle is not less. */
static uint32_t object_index(const struct registry_scene *scene, uint32_t handle)
{
    uint32_t first = 0;
    uint32_t end = scene->object_count;

    if (end > 0 && scene->objects[end - 1].handle < handle) {
        return end; /* as they come, most often */
    }
    while (first < end) {
        uint32_t middle = first + (end - first) / 2;

        if (scene->objects[middle].handle < handle) {
            first = middle + 1;
        } else {
            end = middle;
        }
    }
    return first;
}

struct registry_object *registry_object(const struct registry_scene *scene,
                                        uint32_t handle)
{
    uint32_t index = object_index(scene, handle);

    return index < scene->object_count && scene->objects[index].handle == handle
               ? &scene->objects[index]
               : NULL;
}

static int make_room(struct registry_scene *scene)
{
    uint32_t room = scene->object_room == 0 ? OBJECTS_MIN : scene->object_room * 2;
    struct registry_object *objects;

    if (scene->object_count < scene->object_room) {
        return 0;
    }
    objects = realloc(scene->objects, room * sizeof *objects);
    if (objects == NULL) {
        return PCCD_E_NOMEM;
    }
    scene->objects = objects;
    scene->object_room = room;
    return 0;
}

struct registry_object *registry_add_object(struct registry_scene *scene,
                                            struct registry_mesh *mesh, uint32_t handle,
                                            uint64_t step)
{
    struct registry_object *object;
    uint32_t index;

    if (make_room(scene) != 0) {
        return NULL;
    }
    index = object_index(scene, handle);
    object = scene->objects + index;
    assert(index == scene->object_count || object->handle != handle);
    memmove(object + 1, object, (scene->object_count - index) * sizeof *object);
    *object = (struct registry_object){.handle = handle,
                                       .mesh = mesh,
                                       .since = step,
                                       .attributes = COMMON_ATTRIBUTES_AT_FIRST};
    scene->object_count++;
    mesh->object_count++;
    return object;
}

struct registry_object *registry_put_guest(struct registry *registry,
                                           struct registry_scene *scene, uint32_t handle,
                                           struct registry_mesh *copy)
{
    struct registry_object *object = registry_object(scene, handle);

    if (object == NULL) {
        object = registry_add_object(scene, copy, handle, 0);
        if (object == NULL) {
            return NULL;
        }
    } else {
        empty_object(registry, object);
        object->placing = REGISTRY_AS_REGISTERED;
        object->is_told = false;
        object->mesh = copy;
        copy->object_count = 1;
    }
    copy->is_destroyed = true; /* it goes with the object */
    append_mesh(registry, copy);
    return object;
}

void registry_remove_object(struct registry *registry, struct registry_scene *scene,
                            struct registry_object *object)
{
    assert(object >= scene->objects && object < scene->objects + scene->object_count);
    registry_pairs_forget(&scene->pairs, object->handle);
    empty_object(registry, object);
    free(object->name);
    scene->object_count--;
    memmove(object, object + 1,
            (size_t)(scene->objects + scene->object_count - object) * sizeof *object);
}

/* ---- a mesh, with the objects that are made of it ---------------------------------- */

/* Objects of a mesh that was replaced stand where the new one was registered; one without
 * memory for that goes, rather than to have arrays of the old size. */
static int reset_objects(struct registry *registry, const struct registry_mesh *mesh,
                         uint64_t step)
{
    int status = 0;

    for (struct registry_scene *scene = registry->scenes; scene != NULL;
         scene = scene->next) {
        for (uint32_t i = scene->object_count; i-- > 0;) {
            struct registry_object *object = &scene->objects[i];

            if (object->mesh == mesh && registry_reset(object, step) != 0) {
                registry_remove_object(registry, scene, object);
                status = PCCD_E_NOMEM;
            }
        }
    }
    return status;
}

int registry_put_mesh(struct registry *registry, uint32_t handle,
                      struct registry_mesh *copy, uint64_t step)
{
    struct registry_mesh *mesh = registry_mesh(registry, handle);

    assert(copy->object_count == 0 && copy->edges == NULL);
    if (mesh == NULL) {
        copy->handle = handle;
        append_mesh(registry, copy);
        return 0;
    }
    free_arrays(mesh);
    mesh->format = copy->format;
    mesh->vertex_count = copy->vertex_count;
    mesh->triangle_count = copy->triangle_count;
    mesh->x = copy->x;
    mesh->triangles = copy->triangles;
    mesh->radii = copy->radii;
    mesh->named_edge_count = copy->named_edge_count;
    mesh->named_point_count = copy->named_point_count;
    mesh->named_edges = copy->named_edges;
    mesh->named_points = copy->named_points;
    mesh->edges = NULL;
    mesh->is_free_edge = NULL;
    mesh->is_free_vertex = NULL;
    mesh->is_told = false;
    free(copy);
    return reset_objects(registry, mesh, step);
}

/* ---- what may meet ----------------------------------------------------------------- */

void registry_set_object(struct registry_object *object, uint32_t what,
                         const struct common_attributes *given)
{
    object->what |= what;
    object->is_told = false;
    common_attributes_set(&object->attributes, what, given);
}

int registry_name_object(struct registry_object *object, const char *name, size_t bytes)
{
    char *copy = bytes > 0 ? strndup(name, bytes) : NULL;

    if (bytes > 0 && copy == NULL) {
        return PCCD_E_NOMEM;
    }
    free(object->name);
    object->name = copy;
    return 0;
}

bool registry_may_meet(const struct registry_scene *scene,
                       const struct registry_object *a, const struct registry_object *b)
{
    const struct registry_pair *pair;

    if (a == b) {
        return a->attributes.self_collision;
    }
    pair = registry_pairs_find(&scene->pairs, a->handle, b->handle);
    return common_attributes_may_meet(&a->attributes, &b->attributes) &&
           (pair == NULL || !pair->ignored);
}

void registry_deinit(struct registry *registry)
{
    while (registry->scenes != NULL) {
        registry_remove_scene(registry, registry->scenes);
    }
    while (registry->meshes != NULL) {
        struct registry_mesh *mesh = registry->meshes;

        registry->meshes = mesh->next;
        registry_mesh_free(mesh);
    }
    registry_map_deinit(&registry->scene_map);
}
