/* handlers_filter.c - object.set and scene.ignore: which objects are tested, and how
 * thick they are.
 */
#include <inttypes.h>
#include <string.h>

#include "call.h"
#include "enginemem.h"
#include "invariant.h"
#include "request.h"
#include "session.h"
#include "srv_journal.h"

/* Admission: a scene and an object that is in it, or soon will be. In a scene
 * that is shared an object's owner alone says what it may meet. */
static int find_object(struct srv_call *call, uint32_t scene_handle, uint32_t object,
                       struct srv_scene **scene, struct srv_object **item)
{
    struct srv_scene *found = srv_admit_scene(call, call->session, scene_handle);
    if (found == NULL) {
        return call->error.code;
    }
    *item = srv_handles_get(&found->objects, object);
    if (*item == NULL) {
        return proto_error_set(&call->error, PCCD_E_HANDLE,
                               "scene 0x%x has no object 0x%x", scene_handle, object);
    }
    *scene = found;
    return 0;
}

/* The object; or PCCD_E_HANDLE: its removal came before, or its addition failed.
 * [compute] */
static int find_placed(struct srv_request *request, uint32_t object,
                       struct srv_placed **placed)
{
    *placed = srv_scene_find(request->plan.scene, object);
    return *placed != NULL
               ? 0
               : proto_error_set(&request->error, PCCD_E_HANDLE,
                                 "object 0x%x is not in the scene any more", object);
}

static int queue(struct srv_call *call, struct srv_scene *scene,
                 int (*work)(struct srv_request *request),
                 void (*finish)(struct srv_request *request))
{
    struct srv_plan plan = {
        .work = work, .finish = finish, .ring = call->session->ring, .scene = scene};
    return srv_request_start(call, &plan);
}

/* ---- object.set -------------------------------------------------------------------- */

/* Have the lists of vertices that few edges join. The engine charges the owner of the
 * mesh, who has the object, too; all else is for the scene, perhaps another user's. */
static int prepare_rings(struct srv_request *request, const struct srv_placed *placed,
                         uint32_t rest_rings)
{
    struct srv_scene *scene = request->plan.scene;
    struct srv_enginemem memory;
    srv_enginemem_begin(&memory, request->session->owner.user);
    int status = eng_scene_prepare_rings(scene->engine, placed->engine_idx, NULL,
                                         rest_rings, &request->job.cancel);
    status = srv_enginemem_explain(&memory, status, &request->error);
    srv_enginemem_begin(&memory, scene->resource.owner->user);
    return status;
}

/* Have the engine go by the attributes that are given; or none of it is changed. */
static int change(struct srv_request *request, struct srv_placed *placed,
                  const struct common_attributes *given)
{
    const struct proto_OBJECT_SET_request *asked = &request->params.OBJECT_SET;
    struct eng_scene *engine = request->plan.scene->engine;
    struct common_attributes now = placed->attributes;
    common_attributes_set(&now, asked->what, given);
    const struct eng_object_filter filter = {now.group, now.mask, now.self_collision};
    const struct eng_object_thickness thickness = {.has_radius = now.radius > 0,
                                                   .radius = now.radius,
                                                   .rest_distance = now.rest_distance,
                                                   .rest_rings = now.rest_rings};
    int status = prepare_rings(request, placed, now.rest_rings);
    if (status == PCCD_E_QUOTA) {
        return status;
    }
    if (status == 0) {
        status = eng_scene_set_thickness(engine, placed->engine_idx, &thickness);
    }
    if (status == PCCD_E_CANCELLED) {
        return proto_error_set(&request->error, status,
                               "cancelled, object 0x%x is as before", asked->object);
    }
    if (status == PCCD_E_LIMIT) { /* lengths were looked at before */
        return proto_error_set(&request->error, status,
                               "rest_rings is %" PRIu32 ": so many edges join the "
                               "vertices of object 0x%x with more than 256 others each",
                               now.rest_rings, asked->object);
    }
    if (status != 0) {
        return proto_error_set(&request->error, status, "no memory for the thickness");
    }
    status = eng_scene_set_filter(engine, placed->engine_idx, &filter);
    PCCD_ASSERT(status == PCCD_OK); /* the engine has every object that is placed */
    placed->attributes = now;
    return 0;
}

/* Set a copy of what an object is to be called; NULL: it has no name any more. */
static int copy_name(struct srv_request *request, char **copy)
{
    const char *name = request->params.OBJECT_SET.name;
    size_t bytes = strlen(name) + 1;
    *copy = bytes > 1 ? eng_alloc(1, bytes) : NULL;
    if (bytes > 1 && *copy == NULL) {
        return proto_error_set(&request->error, PCCD_E_NOMEM, "no memory for the name");
    }
    if (*copy != NULL) {
        memcpy(*copy, name, bytes);
    }
    return 0;
}

static int work_set(struct srv_request *request)
{
    const struct proto_OBJECT_SET_request *asked = &request->params.OBJECT_SET;
    struct common_attributes given;
    struct srv_placed *placed = NULL;
    char *name = NULL;
    int status = find_placed(request, asked->object, &placed);
    if (status == 0 && asked->has_name) { /* before attributes are changed */
        status = copy_name(request, &name);
    }
    if (status == 0 && asked->what != 0) {
        COMMON_ATTRIBUTES_COPY(&given, asked);
        status = change(request, placed, &given);
    }
    if (status != 0) {
        eng_free(name);
        return status;
    }
    if (asked->has_name) {
        eng_free(placed->name);
        placed->name = name;
    }
    if (asked->what != 0 || asked->has_name) {
        srv_journal_note(request->plan.scene, PROTO_METHOD_OBJECT_SET, asked);
    }
    COMMON_ATTRIBUTES_COPY(&request->result.OBJECT_SET, &placed->attributes);
    return 0;
}

/* For list.object. */
static void finish_set(struct srv_request *request)
{
    struct srv_object *item = request->status == 0
                                  ? srv_handles_get(&request->plan.scene->objects,
                                                    request->params.OBJECT_SET.object)
                                  : NULL;
    if (item == NULL) {
        return; /* it has gone meanwhile */
    }
    COMMON_ATTRIBUTES_COPY(&item->attributes, &request->result.OBJECT_SET);
    if (request->params.OBJECT_SET.has_name && item->name != NULL) {
        strcpy(item->name, request->params.OBJECT_SET.name);
    }
}

/* Check those that are to be set. */
static int check_thickness(struct srv_call *call)
{
    const struct proto_OBJECT_SET_request *asked = &call->params.OBJECT_SET;
    uint32_t what = COMMON_OBJECT_BITS(asked->what);
    int status = 0;
    if ((what & PCCD_OBJECT_RADIUS) != 0) {
        status = srv_check_length(call, "radius", asked->radius);
    }
    if (status == 0 && (what & PCCD_OBJECT_REST_DISTANCE) != 0) {
        status = srv_check_length(call, "rest_distance", asked->rest_distance);
    }
    if (status == 0 && (what & PCCD_OBJECT_REST_RINGS) != 0 &&
        asked->rest_rings > PROTO_REST_RINGS_MAX) {
        status = proto_error_set(&call->error, PCCD_E_LIMIT,
                                 "rest_rings is %" PRIu32 ", more than %u",
                                 asked->rest_rings, PROTO_REST_RINGS_MAX);
    }
    return status;
}

int srv_on_OBJECT_SET(struct srv_call *call)
{
    const struct proto_OBJECT_SET_request *asked = &call->params.OBJECT_SET;
    struct srv_scene *scene = NULL;
    struct srv_object *item = NULL;
    int status = find_object(call, asked->scene, asked->object, &scene, &item);
    if (status != 0) {
        return status;
    }
    if (item->owner != call->session && (asked->what != 0 || asked->has_name)) {
        return proto_error_set(&call->error, PCCD_E_ACCESS,
                               "object 0x%x is another session's", asked->object);
    }
    if ((COMMON_OBJECT_BITS(asked->what) & ~COMMON_OBJECT_KNOWN) != 0) {
        return proto_error_set(&call->error, PCCD_E_INVAL,
                               "what is 0x%x, this daemon knows the bits 0x%x",
                               asked->what, COMMON_OBJECT_KNOWN);
    }
    status = check_thickness(call);
    if (status == 0 && asked->has_name && asked->name[0] != '\0' && item->name == NULL) {
        item->name = srv_enginemem_new(call->session->owner.user, PROTO_STR_MAX + 1,
                                       "a name", &call->error);
        status = item->name == NULL ? call->error.code : 0;
    }
    return status != 0 ? status : queue(call, scene, work_set, finish_set);
}

/* ---- scene.ignore ------------------------------------------------------------------ */

static int work_ignore(struct srv_request *request)
{
    const struct proto_SCENE_IGNORE_request *asked = &request->params.SCENE_IGNORE;
    struct eng_scene *engine = request->plan.scene->engine;
    struct srv_placed *a = NULL;
    struct srv_placed *b = NULL;
    int status = find_placed(request, asked->a, &a);
    if (status == 0) {
        status = find_placed(request, asked->b, &b);
    }
    if (status != 0) {
        return status;
    }
    status = asked->has_clearance
                 ? eng_scene_set_pair_clearance(engine, a->engine_idx, b->engine_idx,
                                                asked->clearance)
                 : eng_scene_ignore(engine, a->engine_idx, b->engine_idx, asked->ignored);
    if (status == PCCD_E_LIMIT) {
        return proto_error_set(&request->error, status,
                               "%u pairs of objects ignore each other, or have a "
                               "clearance, in scene 0x%x, no more than that may",
                               PROTO_IGNORED_PER_SCENE, asked->scene);
    }
    if (status != 0) {
        return proto_error_set(&request->error, status, "no memory for another pair");
    }
    srv_scene_count_ignored(request->plan.scene);
    srv_journal_note(request->plan.scene, PROTO_METHOD_SCENE_IGNORE, asked);
    request->result.SCENE_IGNORE.pairs = eng_scene_ignored_count(engine);
    return 0;
}

int srv_on_SCENE_IGNORE(struct srv_call *call)
{
    const struct proto_SCENE_IGNORE_request *asked = &call->params.SCENE_IGNORE;
    struct srv_scene *scene = NULL;
    struct srv_object *a = NULL, *b = NULL;
    int status = find_object(call, asked->scene, asked->a, &scene, &a);
    if (status == 0) {
        status = find_object(call, asked->scene, asked->b, &scene, &b);
    }
    if (status != 0) {
        return status;
    }
    if (a->owner != call->session && b->owner != call->session) {
        return proto_error_set(&call->error, PCCD_E_ACCESS,
                               "objects 0x%x and 0x%x are other sessions'", asked->a,
                               asked->b);
    }
    if (asked->a == asked->b) {
        return proto_error_set(&call->error, PCCD_E_INVAL,
                               "a pair is of two objects; whether 0x%x may meet itself "
                               "says object.set",
                               asked->a);
    }
    if (asked->has_clearance && asked->ignored) {
        return proto_error_set(&call->error, PCCD_E_INVAL,
                               "objects that ignore each other have no clearance");
    }
    if (asked->has_clearance) {
        status = srv_check_length(call, "clearance", asked->clearance);
    }
    return status != 0 ? status : queue(call, scene, work_ignore, NULL);
}
