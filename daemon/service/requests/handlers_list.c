/* handlers_list.c - list.session, .scene, .object, .pair and .mesh. */
#include <string.h>

#include "call.h"
#include "meshes.h"
#include "request.h"
#include "ringio.h"
#include "service.h"
#include "session.h"
#include "shared.h"
#include "srv_batch.h"

/* ---- sessions ---------------------------------------------------------------------- */

/* The batch that a session has computed now, of which one job runs at a time. */
static const struct srv_batch *batch_of(const struct srv_session *session)
{
    for (const struct srv_request *at = session->requests; at != NULL; at = at->next) {
        const struct srv_batch *batch = at->plan.batch;
        if (batch != NULL &&
            atomic_load_explicit(&batch->has_begun, memory_order_relaxed)) {
            return batch;
        }
    }
    return NULL;
}

int srv_on_LIST_SESSION(struct srv_call *call)
{
    uint64_t before = call->params.LIST_SESSION.before;
    const struct srv_session *at =
        call->session->service->sessions; /* the newest first */
    while (at != NULL &&
           ((before != 0 && at->id >= before) || !srv_session_is_listed(at) ||
            !srv_session_may_see(call->session, at))) {
        at = at->next;
    }
    if (at == NULL) {
        return 0; /* number 0: none */
    }
    struct proto_LIST_SESSION_result *result = &call->result.LIST_SESSION;
    *result = at->stats;
    result->session = at->id;
    result->uid = (uint32_t)at->owner.user->uid;
    result->pid = (uint32_t)at->pid;
    result->waiting = at->state == SRV_SESSION_WAITING;
    result->ns_open = call->arrival_ns - at->open_ns;
    result->scenes = at->scenes.count;
    result->meshes = at->meshes.count;
    result->requests = at->request_count;
    result->shm_bytes = at->ring != NULL ? srv_ring_bytes(at->ring) : 0;
    const struct srv_batch *batch = batch_of(at);
    if (batch != NULL) {
        result->batch = batch->count;
        result->batch_done = atomic_load_explicit(&batch->done, memory_order_relaxed);
    }
    return 0;
}

/* ---- what a session has ------------------------------------------------------------ */

/* The next item of a table from the place *cursor on; its handle, and the place behind
 * it in *cursor. NULL: there is none. */
static void *next_item(const struct srv_handles *handles, uint32_t *cursor,
                       uint32_t *handle)
{
    void *item = srv_handles_next(handles, cursor);
    *handle = item != NULL ? srv_handles_at(handles, *cursor - 1) : 0;
    return item;
}

int srv_on_LIST_SCENE(struct srv_call *call)
{
    const struct proto_LIST_SCENE_request *request = &call->params.LIST_SCENE;
    struct srv_session *owner = NULL;
    int status = srv_session_find(call->session, request->session, &owner, &call->error);
    if (status != 0) {
        return status;
    }
    uint32_t cursor = request->cursor;
    uint32_t handle = 0;
    struct srv_scene *scene = next_item(&owner->scenes, &cursor, &handle);
    if (scene != NULL) {
        struct proto_LIST_SCENE_result *result = &call->result.LIST_SCENE;
        *result = scene->stats;
        result->scene = handle;
        result->next = cursor;
        result->objects = scene->objects.count;
        result->ignored =
            atomic_load_explicit(&scene->ignored_pairs, memory_order_relaxed);
        srv_shared_tell(scene, owner, result);
    }
    return 0;
}

int srv_on_LIST_OBJECT(struct srv_call *call)
{
    const struct proto_LIST_OBJECT_request *request = &call->params.LIST_OBJECT;
    struct srv_session *owner = NULL;
    int status = srv_session_find(call->session, request->session, &owner, &call->error);
    if (status != 0) {
        return status;
    }
    const struct srv_scene *scene = srv_admit_scene(call, owner, request->scene);
    if (scene == NULL) {
        return call->error.code;
    }
    uint32_t cursor = request->cursor;
    uint32_t handle = 0;
    const struct srv_object *object = next_item(&scene->objects, &cursor, &handle);
    if (object != NULL) {
        call->result.LIST_OBJECT = (struct proto_LIST_OBJECT_result){
            .object = handle,
            .next = cursor,
            .mesh = object->mesh != NULL ? object->mesh->handle : 0,
            .triangles = object->triangles,
            .owner = object->owner->id,
        };
        COMMON_ATTRIBUTES_COPY(&call->result.LIST_OBJECT, &object->attributes);
        if (object->name != NULL) {
            strcpy(call->result.LIST_OBJECT.name, object->name);
        }
    }
    return 0;
}

/* The next pair, by index in the engine, to be told by handle. [compute] */
static int work_pair(struct srv_request *request)
{
    struct eng_scene *engine = request->plan.scene->engine;
    uint32_t cursor = request->params.LIST_PAIR.cursor;
    uint32_t pair[2];
    bool is_there = engine != NULL;
    bool ignored = false;
    double clearance;
    while (is_there && !ignored) { /* others have a clearance */
        is_there = eng_scene_next_pair(engine, &cursor, pair, &ignored, &clearance);
    }
    request->result.LIST_PAIR = (struct proto_LIST_PAIR_result){.a = 0};
    if (is_there) {
        request->result.LIST_PAIR =
            (struct proto_LIST_PAIR_result){.a = eng_scene_object_id(engine, pair[0]),
                                            .b = eng_scene_object_id(engine, pair[1]),
                                            .next = cursor};
    }
    return 0;
}

int srv_on_LIST_PAIR(struct srv_call *call)
{
    const struct proto_LIST_PAIR_request *asked = &call->params.LIST_PAIR;
    struct srv_session *owner = NULL;
    int status = srv_session_find(call->session, asked->session, &owner, &call->error);
    if (status != 0) {
        return status;
    }
    struct srv_scene *scene = srv_admit_scene(call, owner, asked->scene);
    if (scene == NULL) {
        return call->error.code;
    }
    struct srv_plan plan = {
        .work = work_pair, .ring = call->session->ring, .scene = scene};
    return srv_request_start(call, &plan);
}

int srv_on_LIST_MESH(struct srv_call *call)
{
    const struct proto_LIST_MESH_request *request = &call->params.LIST_MESH;
    struct srv_session *owner = NULL;
    int status = srv_session_find(call->session, request->session, &owner, &call->error);
    if (status != 0) {
        return status;
    }
    uint32_t cursor = request->cursor;
    uint32_t handle = 0;
    const struct srv_mesh *mesh = next_item(&owner->meshes, &cursor, &handle);
    if (mesh != NULL) {
        call->result.LIST_MESH = (struct proto_LIST_MESH_result){
            .mesh = handle,
            .next = cursor,
            .vertex_count = mesh->current->counts.vertices,
            .triangle_count = mesh->current->counts.triangles,
            .edge_count = mesh->current->counts.edges,
            .point_count = mesh->current->counts.points,
            .generation = mesh->generation,
            .objects = mesh->object_count,
            .committed = mesh->is_committed,
            .replacing = mesh->next != NULL,
        };
    }
    return 0;
}
