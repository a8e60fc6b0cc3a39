/* keep.c - what another daemon would have to be told: meshes, scenes, objects.
 *
 * Room:     client/lib. May include: keep.h, place.h.
 * Does:     follow the answers: what was made is kept, what was destroyed is forgotten.
 * Does not: know where objects are (place.c).
 * Threads:  [owner].
 */
#include "keep.h"

#include <stdlib.h>
#include <string.h>

#include "place.h"

/* ---- meshes ------------------------------------------------------------------------ */

static size_t vertices_bytes(uint32_t format, uint32_t vertex_count)
{
    return (size_t)vertex_count *
           (format == PCCD_FORMAT_F64 ? sizeof(double[3]) : sizeof(float[3]));
}

void cli_keep_copy_free(struct cli_kept_mesh *copy)
{
    if (copy != NULL) {
        free(copy->x);
        free(copy->triangles);
        free(copy);
    }
}

struct cli_kept_mesh *cli_keep_copy(const void *x, uint32_t format, uint32_t vertex_count,
                                    const uint32_t (*triangles)[3],
                                    uint32_t triangle_count)
{
    size_t bytes = vertices_bytes(format, vertex_count);
    struct cli_kept_mesh *made = calloc(1, sizeof(*made));

    if (made == NULL) {
        return NULL;
    }
    made->format = format;
    made->vertex_count = vertex_count;
    made->triangle_count = triangle_count;
    made->x = malloc(bytes);
    made->triangles = malloc(triangle_count * sizeof(*triangles));
    if (made->x == NULL || made->triangles == NULL) {
        cli_keep_copy_free(made);
        return NULL;
    }
    memcpy(made->x, x, bytes);
    memcpy(made->triangles, triangles, triangle_count * sizeof(*triangles));
    return made;
}

static struct cli_kept_mesh **find_mesh(struct pccd_client *client, uint32_t handle)
{
    struct cli_kept_mesh **link = &client->kept_meshes;

    while (*link != NULL && ((*link)->handle != handle || (*link)->is_destroyed)) {
        link = &(*link)->next;
    }
    return link;
}

/* Forget a mesh that was destroyed, once no object is made of it any more. */
static void settle_mesh(struct pccd_client *client, struct cli_kept_mesh *mesh)
{
    struct cli_kept_mesh **link = &client->kept_meshes;

    if (!mesh->is_destroyed || mesh->object_count > 0) {
        return;
    }
    while (*link != mesh) {
        link = &(*link)->next;
    }
    *link = mesh->next;
    cli_keep_copy_free(mesh);
}

/* Objects of a mesh that was replaced stand where the new one was registered. */
static void replace_objects(struct pccd_client *client, const struct cli_kept_mesh *mesh)
{
    for (struct cli_kept_scene *scene = client->kept_scenes; scene != NULL;
         scene = scene->next) {
        for (uint32_t i = 0; i < scene->object_count; i++) {
            if (scene->objects[i].mesh == mesh) {
                cli_place_reset(&scene->objects[i], client->next_step);
            }
        }
    }
}

void cli_keep_mesh(struct pccd_client *client, uint32_t handle,
                   struct cli_kept_mesh *copy)
{
    struct cli_kept_mesh **link = find_mesh(client, handle);
    struct cli_kept_mesh *mesh = *link;

    if (mesh == NULL) {
        copy->handle = handle;
        *link = copy; /* the last: the order in which they were made */
        return;
    }
    free(mesh->x);
    free(mesh->triangles);
    mesh->format = copy->format;
    mesh->vertex_count = copy->vertex_count;
    mesh->triangle_count = copy->triangle_count;
    mesh->x = copy->x;
    mesh->triangles = copy->triangles;
    free(copy);
    replace_objects(client, mesh);
}

/* ---- scenes and objects ------------------------------------------------------------ */

static struct cli_kept_scene **find_scene(struct pccd_client *client, uint32_t handle)
{
    struct cli_kept_scene **link = &client->kept_scenes;

    while (*link != NULL && (*link)->handle != handle) {
        link = &(*link)->next;
    }
    return link;
}

/* Index of the first object whose handle is not less. */
static uint32_t object_index(const struct cli_kept_scene *scene, uint32_t handle)
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

struct cli_kept_object *cli_keep_object(struct cli_kept_scene *scene, uint32_t handle)
{
    uint32_t index = object_index(scene, handle);

    return index < scene->object_count && scene->objects[index].handle == handle
               ? &scene->objects[index]
               : NULL;
}

struct cli_kept_scene *cli_keep_scene(struct pccd_client *client, uint32_t handle)
{
    return *find_scene(client, handle);
}

static void forget_object(struct pccd_client *client, struct cli_kept_object *object)
{
    free(object->x);
    object->mesh->object_count--;
    settle_mesh(client, object->mesh);
}

static void add_scene(struct pccd_client *client, const struct cli_call *call)
{
    const struct proto_SCENE_CREATE_result *result = call->result;
    struct cli_kept_scene *made = calloc(1, sizeof(*made));

    if (made == NULL) {
        client->keeps = false; /* what is incomplete is of no use */
        return;
    }
    made->handle = result->scene;
    made->settings = call->params.SCENE_CREATE;
    if (made->settings.name[0] != '\0' && made->settings.share == PCCD_SHARE_CREATE) {
        made->settings.share = PCCD_SHARE_OPEN; /* others may be faster next time */
    }
    *find_scene(client, result->scene) = made;
}

static void remove_scene(struct pccd_client *client, uint32_t handle)
{
    struct cli_kept_scene **link = find_scene(client, handle);
    struct cli_kept_scene *scene = *link;

    if (scene == NULL) {
        return;
    }
    for (uint32_t i = 0; i < scene->object_count; i++) {
        forget_object(client, &scene->objects[i]);
    }
    *link = scene->next;
    cli_kept_pairs_deinit(&scene->ignored);
    free(scene->objects);
    free(scene);
}

static int make_room(struct cli_kept_scene *scene)
{
    uint32_t room = scene->object_room == 0 ? 8 : scene->object_room * 2;
    struct cli_kept_object *objects;

    if (scene->object_count < scene->object_room) {
        return 0;
    }
    objects = realloc(scene->objects, room * sizeof(*objects));
    if (objects == NULL) {
        return PCCD_E_NOMEM;
    }
    scene->objects = objects;
    scene->object_room = room;
    return 0;
}

static void add_object(struct pccd_client *client, const struct cli_call *call)
{
    const struct proto_SCENE_ADD_result *result = call->result;
    struct cli_kept_scene *scene = *find_scene(client, call->params.SCENE_ADD.scene);
    struct cli_kept_mesh *mesh = *find_mesh(client, call->params.SCENE_ADD.mesh);
    uint32_t index;

    if (scene == NULL || mesh == NULL || make_room(scene) != 0) {
        client->keeps = false;
        return;
    }
    index = object_index(scene, result->object);
    memmove(scene->objects + index + 1, scene->objects + index,
            (scene->object_count - index) * sizeof(*scene->objects));
    scene->objects[index] = (struct cli_kept_object){
        .handle = result->object, .mesh = mesh, .since = client->next_step};
    scene->object_count++;
    mesh->object_count++;
}

static void remove_object(struct pccd_client *client, uint32_t in, uint32_t handle)
{
    struct cli_kept_scene *scene = *find_scene(client, in);
    struct cli_kept_object *object =
        scene != NULL ? cli_keep_object(scene, handle) : NULL;

    if (object == NULL) {
        return;
    }
    forget_object(client, object);
    cli_kept_pairs_forget(&scene->ignored, handle);
    scene->object_count--;
    memmove(object, object + 1,
            (size_t)(scene->objects + scene->object_count - object) * sizeof(*object));
}

static void set_object(struct pccd_client *client,
                       const struct proto_OBJECT_SET_request *set)
{
    struct cli_kept_scene *scene = *find_scene(client, set->scene);
    struct cli_kept_object *object =
        scene != NULL ? cli_keep_object(scene, set->object) : NULL;

    if (object == NULL) {
        return;
    }
    object->what |= set->what;
    object->group = set->what & PCCD_OBJECT_GROUP ? set->group : object->group;
    object->mask = set->what & PCCD_OBJECT_MASK ? set->mask : object->mask;
    object->self = set->what & PCCD_OBJECT_SELF ? set->self : object->self;
}

static void ignore_pair(struct pccd_client *client,
                        const struct proto_SCENE_IGNORE_request *pair)
{
    struct cli_kept_scene *scene = *find_scene(client, pair->scene);

    if (scene != NULL &&
        cli_kept_pairs_note(&scene->ignored, pair->a, pair->b, pair->ignored) != 0) {
        client->keeps = false;
    }
}

bool cli_keep_is_filtered(const struct cli_kept_scene *scene)
{
    bool any = scene->ignored.count > 0;

    for (uint32_t i = 0; i < scene->object_count && !any; i++) {
        any = scene->objects[i].what != 0;
    }
    return any;
}

static void remove_mesh(struct pccd_client *client, uint32_t handle)
{
    struct cli_kept_mesh *mesh = *find_mesh(client, handle);

    if (mesh != NULL) {
        mesh->is_destroyed = true;
        settle_mesh(client, mesh);
    }
}

void cli_keep_answer(struct pccd_client *client, struct cli_call *call)
{
    client->has_made = client->has_made || call->method == PROTO_METHOD_SCENE_CREATE ||
                       call->method == PROTO_METHOD_MESH_COMMIT;
    if (!client->keeps) {
        return;
    }
    switch (call->method) {
    case PROTO_METHOD_SCENE_CREATE:
        if (call->result != NULL) { /* else nobody knows its handle */
            add_scene(client, call);
        }
        break;
    case PROTO_METHOD_SCENE_DESTROY:
        remove_scene(client, call->params.SCENE_DESTROY.scene);
        break;
    case PROTO_METHOD_SCENE_ADD:
        if (call->result != NULL) {
            add_object(client, call);
        }
        break;
    case PROTO_METHOD_SCENE_REMOVE:
        remove_object(client, call->params.SCENE_REMOVE.scene,
                      call->params.SCENE_REMOVE.object);
        break;
    case PROTO_METHOD_OBJECT_SET:
        set_object(client, &call->params.OBJECT_SET);
        break;
    case PROTO_METHOD_SCENE_IGNORE:
        ignore_pair(client, &call->params.SCENE_IGNORE);
        break;
    case PROTO_METHOD_MESH_DESTROY:
        remove_mesh(client, call->params.MESH_DESTROY.mesh);
        break;
    case PROTO_METHOD_FRAME_SUBMIT:
        if (call->slot != CLI_SLOT_NONE) {
            cli_place_answered(client, call->slot, call->step);
        }
        break;
    default:
        break;
    }
}

void cli_keep_deinit(struct pccd_client *client)
{
    while (client->kept_scenes != NULL) {
        remove_scene(client, client->kept_scenes->handle);
    }
    while (client->kept_meshes != NULL) {
        struct cli_kept_mesh *mesh = client->kept_meshes;

        client->kept_meshes = mesh->next;
        cli_keep_copy_free(mesh);
    }
}
