/* client/ctl/record/world.c - what a recorded session had, and where it was.
 *
 * Room:     client/ctl.
 * Does:     the bookkeeping of handles, and the arithmetic of segments.
 * Does not: trust a chunk in what other chunks must have said.
 * Threads:  one.
 * Source:   world.h; lengths and ranges were judged by client/record/judge.c.
 */
#include "world.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "oracle_scene.h"
#include "pccd_types.h"

static int no_memory(struct ctl_error *error)
{
    return ctl_error_set(error, PCCD_E_NOMEM, "no memory for what was recorded");
}

static int unknown(struct ctl_error *error, const char *what, uint32_t handle)
{
    return ctl_error_set(error, PCCD_E_FORMAT,
                         "the recording names %s 0x%" PRIx32 ", which there is not", what,
                         handle);
}

/* `count` positions of a format, which are not aligned. */
static void widen(double (*to)[3], const uint8_t *from, uint32_t format, uint32_t count)
{
    if (format == PCCD_FORMAT_F64) {
        memcpy(to, from, count * sizeof(*to));
        return;
    }
    for (uint32_t i = 0; i < count; i++) {
        float x[3];
        memcpy(x, from + i * sizeof(x), sizeof(x));
        for (uint32_t k = 0; k < 3; k++) {
            to[i][k] = (double)x[k];
        }
    }
}

/* Each operation rounded once, as the protocol wants it. */
static void transform(const double m[12], double (*x)[3], uint32_t count, double (*to)[3])
{
    for (uint32_t i = 0; i < count; i++) {
        for (uint32_t row = 0; row < 3; row++) {
            const double *r = m + 4 * row;
            to[i][row] = ((r[0] * x[i][0] + r[1] * x[i][1]) + r[2] * x[i][2]) + r[3];
        }
    }
}

/* ---- meshes ------------------------------------------------------------------------ */

struct world_mesh *world_mesh(const struct world *world, uint32_t handle)
{
    for (struct world_mesh *mesh = world->meshes; mesh != NULL; mesh = mesh->next) {
        if (mesh->handle == handle && !mesh->is_gone) {
            return mesh;
        }
    }
    return NULL;
}

static void empty_mesh(struct world_mesh *mesh)
{
    free(mesh->x);
    free(mesh->triangles);
    free(mesh->edges);
    mesh->x = NULL;
    mesh->triangles = NULL;
    mesh->edges = NULL;
}

/* Forget a mesh that is gone, once no object is made of it. */
static void settle_mesh(struct world *world, struct world_mesh *mesh)
{
    struct world_mesh **link = &world->meshes;
    if (!mesh->is_gone || mesh->user_count > 0) {
        return;
    }
    while (*link != mesh) {
        link = &(*link)->next;
    }
    *link = mesh->next;
    empty_mesh(mesh);
    free(mesh);
}

static void append_mesh(struct world *world, struct world_mesh *mesh)
{
    struct world_mesh **link = &world->meshes;
    while (*link != NULL) {
        link = &(*link)->next;
    }
    *link = mesh;
}

/* Where its mesh was registered. */
static int place_anew(struct world_object *object)
{
    size_t bytes = object->mesh->vertex_count * sizeof(*object->x0);
    double(*x0)[3] = malloc(bytes);
    double(*x1)[3] = malloc(bytes);
    if (x0 == NULL || x1 == NULL) {
        free(x0);
        free(x1);
        return PCCD_E_NOMEM;
    }
    free(object->x0);
    free(object->x1);
    memcpy(x0, object->mesh->x, bytes);
    memcpy(x1, object->mesh->x, bytes);
    object->x0 = x0;
    object->x1 = x1;
    object->has_moved = false;
    return PCCD_OK;
}

/* Objects of a mesh that was replaced stand where the new one was registered. */
static int place_users(const struct world *world, const struct world_mesh *mesh)
{
    int status = PCCD_OK;
    for (struct world_scene *scene = world->scenes; scene != NULL; scene = scene->next) {
        for (uint32_t i = 0; i < scene->object_count && status == PCCD_OK; i++) {
            if (scene->objects[i].mesh == mesh) {
                status = place_anew(&scene->objects[i]);
            }
        }
    }
    return status;
}

static int follow_mesh(struct world *world, const struct record_view *view,
                       struct ctl_error *error)
{
    const uint8_t *at = (const uint8_t *)view->payload + sizeof(struct record_mesh);
    struct record_mesh head;
    memcpy(&head, view->payload, sizeof(head));
    struct world_mesh *mesh = world_mesh(world, head.mesh);
    double(*x)[3] = malloc(head.vertex_count * sizeof(*x));
    uint32_t(*triangles)[3] = malloc(head.triangle_count * sizeof(*triangles));
    if (mesh == NULL) {
        mesh = calloc(1, sizeof(*mesh));
        if (mesh != NULL) {
            mesh->handle = head.mesh;
            append_mesh(world, mesh);
        }
    }
    if (mesh == NULL || x == NULL || triangles == NULL) {
        free(x);
        free(triangles);
        return no_memory(error);
    }
    size_t each = head.format == PCCD_FORMAT_F64 ? sizeof(double[3]) : sizeof(float[3]);
    widen(x, at, head.format, head.vertex_count);
    memcpy(triangles, at + (head.vertex_count * each + 7) / 8 * 8,
           head.triangle_count * sizeof(*triangles));
    empty_mesh(mesh);
    mesh->format = head.format;
    mesh->vertex_count = head.vertex_count;
    mesh->triangle_count = head.triangle_count;
    mesh->x = x;
    mesh->triangles = triangles;
    return place_users(world, mesh) == PCCD_OK ? PCCD_OK : no_memory(error);
}

int world_edges(struct world_mesh *mesh, struct ctl_error *error)
{
    const struct oracle_object object = {.vertex_count = mesh->vertex_count,
                                         .triangle_count = mesh->triangle_count,
                                         .triangles =
                                             (const uint32_t(*)[3])mesh->triangles};
    if (mesh->edges == NULL) {
        mesh->edges = oracle_edges(&object, &mesh->edge_count);
    }
    return mesh->edges != NULL ? PCCD_OK : no_memory(error);
}

/* ---- scenes and objects ------------------------------------------------------------ */

struct world_scene *world_scene(const struct world *world, uint32_t handle)
{
    struct world_scene *scene = world->scenes;
    while (scene != NULL && scene->handle != handle) {
        scene = scene->next;
    }
    return scene;
}

struct world_object *world_object(const struct world_scene *scene, uint32_t handle)
{
    for (uint32_t i = 0; i < scene->object_count; i++) {
        if (scene->objects[i].handle == handle) {
            return &scene->objects[i];
        }
    }
    return NULL;
}

static int follow_scene(struct world *world, const struct record_view *view,
                        struct ctl_error *error)
{
    struct record_scene settings;
    struct world_scene **link = &world->scenes;
    memcpy(&settings, view->payload, sizeof(settings));
    if (world_scene(world, settings.scene) != NULL) {
        return ctl_error_set(error, PCCD_E_FORMAT,
                             "the recording makes scene 0x%" PRIx32 " twice",
                             settings.scene);
    }
    struct world_scene *scene = calloc(1, sizeof(*scene));
    if (scene == NULL) {
        return no_memory(error);
    }
    while (*link != NULL) {
        link = &(*link)->next;
    }
    scene->handle = settings.scene;
    scene->settings = settings;
    *link = scene;
    return PCCD_OK;
}

static int make_room(struct world_scene *scene)
{
    uint32_t room = scene->object_room == 0 ? 8 : scene->object_room * 2;
    if (scene->object_count < scene->object_room) {
        return PCCD_OK;
    }
    struct world_object *objects = realloc(scene->objects, room * sizeof(*objects));
    if (objects == NULL) {
        return PCCD_E_NOMEM;
    }
    scene->objects = objects;
    scene->object_room = room;
    return PCCD_OK;
}

static int follow_object(struct world *world, const struct record_view *view,
                         struct ctl_error *error)
{
    struct record_object head;
    memcpy(&head, view->payload, sizeof(head));
    struct world_scene *scene = world_scene(world, head.scene);
    struct world_mesh *mesh = world_mesh(world, head.mesh);
    if (scene == NULL) {
        return unknown(error, "scene", head.scene);
    }
    if (mesh == NULL) {
        return unknown(error, "mesh", head.mesh);
    }
    if (world_object(scene, head.object) != NULL) {
        return ctl_error_set(error, PCCD_E_FORMAT,
                             "the recording adds object 0x%" PRIx32 " twice",
                             head.object);
    }
    struct world_object object = {.handle = head.object,
                                  .mesh = mesh,
                                  .self = true,
                                  .group = 1,
                                  .mask = UINT64_MAX};
    if (make_room(scene) != PCCD_OK || place_anew(&object) != PCCD_OK) {
        return no_memory(error);
    }
    scene->objects[scene->object_count++] = object;
    mesh->user_count++;
    return PCCD_OK;
}

/* An object with a mesh that nobody else has: one that is gone. */
static int follow_guest(struct world *world, const struct record_view *view,
                        struct ctl_error *error)
{
    const uint8_t *at = (const uint8_t *)view->payload + sizeof(struct record_guest);
    struct record_guest head;
    memcpy(&head, view->payload, sizeof(head));
    struct world_scene *scene = world_scene(world, head.scene);
    if (scene == NULL) {
        return unknown(error, "scene", head.scene);
    }
    struct world_object *known = world_object(scene, head.object);
    struct world_mesh *mesh = calloc(1, sizeof(*mesh));
    size_t x_bytes = head.vertex_count * sizeof(*mesh->x);
    size_t triangle_bytes = head.triangle_count * sizeof(*mesh->triangles);
    if (mesh == NULL) {
        return no_memory(error);
    }
    *mesh = (struct world_mesh){.is_gone = true,
                                .format = PCCD_FORMAT_F64,
                                .vertex_count = head.vertex_count,
                                .triangle_count = head.triangle_count,
                                .x = malloc(x_bytes),
                                .triangles = malloc(triangle_bytes)};
    struct world_object object = {
        .handle = head.object, .self = true, .group = 1, .mask = UINT64_MAX};
    if (known != NULL) {
        object = *known; /* what it may meet stays */
        object.x0 = object.x1 = NULL;
    }
    object.mesh = mesh;
    if (mesh->x != NULL && mesh->triangles != NULL) {
        memcpy(mesh->x, at, x_bytes);
        memcpy(mesh->triangles, at + x_bytes, triangle_bytes);
    }
    if (mesh->x == NULL || mesh->triangles == NULL || make_room(scene) != PCCD_OK ||
        place_anew(&object) != PCCD_OK) {
        empty_mesh(mesh);
        free(mesh);
        return no_memory(error);
    }
    mesh->user_count = 1;
    append_mesh(world, mesh);
    known = world_object(scene, head.object); /* room may have moved them */
    if (known != NULL) {
        free(known->x0);
        free(known->x1);
        known->mesh->user_count--;
        settle_mesh(world, known->mesh);
        *known = object;
    } else {
        scene->objects[scene->object_count++] = object;
    }
    return PCCD_OK;
}

static int follow_place(struct world *world, const struct record_view *view,
                        struct ctl_error *error)
{
    const uint8_t *at = (const uint8_t *)view->payload + sizeof(struct record_place);
    struct record_place place;
    memcpy(&place, view->payload, sizeof(place));
    struct world_scene *scene = world_scene(world, place.scene);
    struct world_object *object =
        scene != NULL ? world_object(scene, place.object) : NULL;
    if (object == NULL) {
        return unknown(error, "object", place.object);
    }
    const struct world_mesh *mesh = object->mesh;
    uint64_t each =
        place.format == PCCD_FORMAT_F64 ? sizeof(double[3]) : sizeof(float[3]);
    if (place.placing == RECORD_PLACED_RIGID) {
        double m[12];
        memcpy(m, at, sizeof(m));
        transform(m, mesh->x, mesh->vertex_count, object->x1);
    } else if (view->bytes - sizeof(place) == mesh->vertex_count * each) {
        widen(object->x1, at, place.format, mesh->vertex_count);
    } else {
        return ctl_error_set(error, PCCD_E_FORMAT,
                             "the recording places object 0x%" PRIx32
                             " with another number of vertices",
                             place.object);
    }
    memcpy(object->x0, object->x1, mesh->vertex_count * sizeof(*object->x0));
    object->has_moved = true;
    return PCCD_OK;
}

/* ---- what may meet --------------------------------------------------------------- */

bool world_may_meet(const struct world_scene *scene, const struct world_object *a,
                    const struct world_object *b)
{
    if (a == b) {
        return a->self;
    }
    return (a->group & b->mask) != 0 && (b->group & a->mask) != 0 &&
           !world_pairs_has(&scene->ignored, a->handle, b->handle);
}

static int follow_filter(struct world *world, const struct record_view *view,
                         struct ctl_error *error)
{
    struct record_filter filter;
    memcpy(&filter, view->payload, sizeof(filter));
    struct world_scene *scene = world_scene(world, filter.scene);
    struct world_object *object =
        scene != NULL ? world_object(scene, filter.object) : NULL;
    if (object == NULL) {
        return unknown(error, "object", filter.object);
    }
    object->group = filter.what & PCCD_OBJECT_GROUP ? filter.group : object->group;
    object->mask = filter.what & PCCD_OBJECT_MASK ? filter.mask : object->mask;
    object->self = filter.what & PCCD_OBJECT_SELF ? filter.self != 0 : object->self;
    return PCCD_OK;
}

static int follow_pairs(struct world *world, const struct record_view *view,
                        struct ctl_error *error)
{
    const uint8_t *at = (const uint8_t *)view->payload + sizeof(struct record_pairs);
    struct record_pairs head;
    memcpy(&head, view->payload, sizeof(head));
    struct world_scene *scene = world_scene(world, head.scene);
    if (scene == NULL) {
        return unknown(error, "scene", head.scene);
    }
    for (uint32_t i = 0; i < head.count; i++) {
        uint32_t pair[2];
        memcpy(pair, at + i * sizeof(pair), sizeof(pair));
        for (uint32_t k = 0; k < 2; k++) {
            if (world_object(scene, pair[k]) == NULL) {
                return unknown(error, "object", pair[k]);
            }
        }
    }
    return world_pairs_set(&scene->ignored, (const uint32_t(*)[2])(const void *)at,
                           head.count, head.ignored != 0) == PCCD_OK
               ? PCCD_OK
               : no_memory(error);
}

static void remove_object(struct world *world, struct world_scene *scene,
                          struct world_object *object)
{
    object->mesh->user_count--;
    settle_mesh(world, object->mesh);
    free(object->x0);
    free(object->x1);
    world_pairs_forget(&scene->ignored, object->handle);
    scene->object_count--;
    memmove(object, object + 1,
            (size_t)(scene->objects + scene->object_count - object) * sizeof(*object));
}

static void remove_scene(struct world *world, struct world_scene *scene)
{
    struct world_scene **link = &world->scenes;
    world_pairs_deinit(&scene->ignored);
    while (scene->object_count > 0) {
        remove_object(world, scene, &scene->objects[scene->object_count - 1]);
    }
    while (*link != scene) {
        link = &(*link)->next;
    }
    *link = scene->next;
    free(scene->objects);
    free(scene);
}

static int follow_gone(struct world *world, const struct record_view *view,
                       struct ctl_error *error)
{
    struct record_gone gone;
    memcpy(&gone, view->payload, sizeof(gone));
    if (view->kind == RECORD_MESH_GONE) {
        struct world_mesh *mesh = world_mesh(world, gone.mesh);
        if (mesh == NULL) {
            return unknown(error, "mesh", gone.mesh);
        }
        mesh->is_gone = true;
        settle_mesh(world, mesh);
        return PCCD_OK;
    }
    struct world_scene *scene = world_scene(world, gone.scene);
    if (scene == NULL) {
        return unknown(error, "scene", gone.scene);
    }
    if (view->kind == RECORD_SCENE_GONE) {
        remove_scene(world, scene);
        return PCCD_OK;
    }
    struct world_object *object = world_object(scene, gone.object);
    if (object == NULL) {
        return unknown(error, "object", gone.object);
    }
    remove_object(world, scene, object);
    return PCCD_OK;
}

int world_follow(struct world *world, const struct record_view *view,
                 struct ctl_error *error)
{
    switch (view->kind) {
    case RECORD_MESH:
        return follow_mesh(world, view, error);
    case RECORD_SCENE:
        return follow_scene(world, view, error);
    case RECORD_OBJECT:
        return follow_object(world, view, error);
    case RECORD_GUEST:
        return follow_guest(world, view, error);
    case RECORD_PLACE:
        return follow_place(world, view, error);
    case RECORD_FILTER:
        return follow_filter(world, view, error);
    case RECORD_PAIRS:
        return follow_pairs(world, view, error);
    case RECORD_SCENE_GONE:
    case RECORD_MESH_GONE:
    case RECORD_OBJECT_GONE:
        return follow_gone(world, view, error);
    default:
        return PCCD_OK;
    }
}

void world_deinit(struct world *world)
{
    while (world->scenes != NULL) {
        remove_scene(world, world->scenes);
    }
    while (world->meshes != NULL) {
        struct world_mesh *mesh = world->meshes;
        world->meshes = mesh->next;
        empty_mesh(mesh);
        free(mesh);
    }
}

/* ---- steps ------------------------------------------------------------------------- */

static void move(struct world_object *object, const struct record_segment *segment,
                 const uint8_t *slot)
{
    double(*x0)[3] = object->x0 + segment->first;
    double(*x1)[3] = object->x1 + segment->first;
    if (segment->kind == RECORD_RIGID) {
        double m0[12], m1[12];
        memcpy(m0, slot + segment->offset0, sizeof(m0));
        memcpy(m1, slot + segment->offset1, sizeof(m1));
        transform(m0, object->mesh->x + segment->first, segment->count, x0);
        transform(m1, object->mesh->x + segment->first, segment->count, x1);
    } else {
        if (segment->kind == RECORD_X0X1) {
            widen(x0, slot + segment->offset0, segment->format, segment->count);
        }
        widen(x1, slot + segment->offset1, segment->format, segment->count);
    }
    object->has_moved = true;
}

int world_step(struct world *world, const struct record_frame *frame, const uint8_t *slot,
               struct ctl_error *error)
{
    struct world_scene *scene = world_scene(world, frame->scene);
    struct record_segment segment;
    if (scene == NULL) {
        return unknown(error, "scene", frame->scene);
    }
    for (uint32_t i = 0; i < frame->segment_count; i++) {
        memcpy(&segment, slot + i * sizeof(segment), sizeof(segment));
        const struct world_object *object = world_object(scene, segment.object);
        if (object == NULL) {
            return unknown(error, "object", segment.object);
        }
        if (segment.first > object->mesh->vertex_count ||
            segment.count > object->mesh->vertex_count - segment.first) {
            return ctl_error_set(error, PCCD_E_FORMAT,
                                 "step %" PRIu64 " moves vertices that object 0x%" PRIx32
                                 " has not",
                                 frame->step, segment.object);
        }
    }
    for (uint32_t i = 0; i < scene->object_count; i++) {
        struct world_object *object = &scene->objects[i];
        memcpy(object->x0, object->x1, object->mesh->vertex_count * sizeof(*object->x0));
    }
    for (uint32_t i = 0; i < frame->segment_count; i++) {
        memcpy(&segment, slot + i * sizeof(segment), sizeof(segment));
        move(world_object(scene, segment.object), &segment, slot);
    }
    return PCCD_OK;
}
