/* handlers_scene.c - scene.create, destroy, add, remove and boxes. */
#include "call.h"
#include "invariant.h"
#include "meshes.h"
#include "now.h"
#include "request.h"
#include "service.h"
#include "session.h"
#include "shared.h"
#include "srv_journal.h"

int srv_on_SCENE_CREATE(struct srv_call *call)
{
    struct srv_session *session = call->session;
    struct eng_scene_settings settings = ENG_SCENE_SETTINGS_DEFAULT;
    settings.threads = session->service->options->threads_max;
    const struct proto_SCENE_CREATE_request *request = &call->params.SCENE_CREATE;
    if (request->name[0] == '\0' &&
        (request->share != 0 || request->rights != 0 || request->owner != 0)) {
        return proto_error_set(&call->error, PCCD_E_INVAL,
                               "share, rights and owner are of scenes that have a name");
    }
    /* Those it has, and as many that wait to be freed: while a long step runs nothing
     * is. */
    if (session->scene_count / 2 >= session->scenes.max) {
        return proto_error_set(&call->error, PCCD_E_BUSY,
                               "%u scenes wait to be freed behind what is computed now",
                               session->scene_count - session->scenes.count);
    }
    if (request->name[0] != '\0') {
        return srv_shared_open(session, request, &settings, &call->result.SCENE_CREATE,
                               &call->error);
    }
    struct srv_scene *scene = srv_scene_new(session, &settings, &call->error);
    if (scene == NULL) {
        return call->error.code;
    }
    uint32_t *handle = &call->result.SCENE_CREATE.scene;
    *handle = call->params.SCENE_CREATE.want;
    int status = srv_session_handle(session, &session->scenes, "scene", scene, handle,
                                    &call->error);
    if (status != 0) {
        srv_resource_drop(&scene->resource);
        return status;
    }
    srv_scene_name(scene, *handle);
    return 0;
}

int srv_on_SCENE_DESTROY(struct srv_call *call)
{
    uint32_t handle = call->params.SCENE_DESTROY.scene;
    struct srv_scene *scene = srv_admit_scene(call, call->session, handle);
    if (scene == NULL) {
        return PCCD_E_HANDLE;
    }
    srv_handles_remove(&call->session->scenes, handle);
    if (scene->shared != NULL) {
        srv_shared_leave(call->session, scene);
    } else {
        srv_scene_unlink_of(scene, NULL);
        srv_resource_drop(&scene->resource);
    }
    call->result.SCENE_DESTROY.done = true;
    return 0;
}

/* ---- add --------------------------------------------------------------------------- */

static int work_add(struct srv_request *request)
{
    struct srv_scene *scene = request->plan.scene;
    struct eng_mesh *mesh = request->plan.shape->engine;
    struct eng_scene *engine = NULL;
    uint32_t handle = request->plan.object;
    if (mesh == NULL || !eng_mesh_is_committed(mesh)) {
        return proto_error_set(&request->error, PCCD_E_STATE,
                               "mesh 0x%x is not committed",
                               request->params.SCENE_ADD.mesh);
    }
    int status = srv_scene_engine(scene, &engine);
    if (status == 0) {
        status = srv_scene_reserve(scene, handle);
    }
    uint64_t start_ns = common_now_ns();
    uint32_t idx = 0;
    if (status == 0) {
        status = eng_scene_add(engine, mesh, handle, &idx);
    }
    if (status != 0) {
        return proto_error_set(&request->error, status, "mesh 0x%x into scene 0x%x: %s",
                               request->params.SCENE_ADD.mesh,
                               request->params.SCENE_ADD.scene,
                               proto_status_text(status));
    }
    scene->placed[srv_handle_index(handle)] =
        (struct srv_placed){.handle = handle,
                            .engine_idx = idx,
                            .vertex_count = request->plan.shape->counts.vertices,
                            .generation = request->plan.generation,
                            .mesh_number = request->plan.mesh_number,
                            .member = request->plan.member,
                            .attributes = COMMON_ATTRIBUTES_AT_FIRST};
    srv_journal_add(scene, &scene->placed[srv_handle_index(handle)]);
    request->result.SCENE_ADD.object = handle;
    request->result.SCENE_ADD.build_ns = common_now_ns() - start_ns;
    return 0;
}

static void finish_add(struct srv_request *request)
{
    if (request->status != 0) {
        srv_scene_forget(request->plan.scene, request->plan.object);
    } else {
        request->session->service->metrics.counters.builds++;
    }
}

#define ASIDE_TRIES 8

/* The object that is wanted; of any, where clients may come back, one aside if there is
 * one. */
static int admit(struct srv_plan *plan, struct srv_session *session,
                 struct srv_mesh *mesh, struct srv_call *call)
{
    bool is_any = plan->object == 0;
    int status = PCCD_E_HANDLE;
    for (int i = 0; i < ASIDE_TRIES && is_any && status == PCCD_E_HANDLE; i++) {
        plan->object = srv_shared_aside(plan->member);
        status = srv_scene_admit(plan->scene, session, plan->member, mesh, &plan->object,
                                 &call->error);
    }
    if (is_any && status != PCCD_E_HANDLE && status != PCCD_E_LIMIT) {
        return status;
    }
    plan->object = is_any ? 0 : plan->object;
    return srv_scene_admit(plan->scene, session, plan->member, mesh, &plan->object,
                           &call->error);
}

int srv_on_SCENE_ADD(struct srv_call *call)
{
    struct srv_session *session = call->session;
    struct srv_scene *scene =
        srv_admit_scene(call, call->session, call->params.SCENE_ADD.scene);
    if (scene == NULL) {
        return PCCD_E_HANDLE;
    }
    uint32_t mesh_handle = call->params.SCENE_ADD.mesh;
    struct srv_mesh *mesh = srv_handles_get(&session->meshes, mesh_handle);
    if (mesh == NULL) {
        return srv_refuse_handle(call, session, "mesh", mesh_handle);
    }
    int status = srv_mesh_refuse_busy(mesh, mesh_handle, &call->error);
    if (status == 0) {
        status = srv_shared_refuse_reader(session, scene, &call->error);
    }
    if (status != 0) {
        return status;
    }
    struct srv_plan plan = {.work = work_add,
                            .finish = finish_add,
                            .ring = session->ring,
                            .shape = mesh->current,
                            .mesh_number = mesh->number,
                            .generation = mesh->generation,
                            .scene = scene,
                            .member = srv_shared_member(scene, session),
                            .object = call->params.SCENE_ADD.want};
    status = admit(&plan, session, mesh, call);
    if (status != 0) {
        return status;
    }
    status = srv_request_start(call, &plan);
    if (status < 0) {
        srv_scene_forget(scene, plan.object);
    }
    return status;
}

/* ---- remove ------------------------------------------------------------------------ */

static int work_remove(struct srv_request *request)
{
    struct srv_scene *scene = request->plan.scene;
    struct srv_placed *placed = srv_scene_find(scene, request->plan.object);
    if (placed == NULL) {
        return proto_error_set(&request->error, PCCD_E_HANDLE,
                               "object 0x%x is not in the scene any more",
                               request->plan.object);
    }
    srv_journal_gone(scene, placed->handle);
    srv_scene_displace(scene, placed);
    request->result.SCENE_REMOVE.done = true;
    return 0;
}

static void finish_remove(struct srv_request *request)
{
    if (request->status == 0) {
        srv_scene_forget(request->plan.scene, request->plan.object);
    }
}

int srv_on_SCENE_REMOVE(struct srv_call *call)
{
    uint32_t object = call->params.SCENE_REMOVE.object;
    struct srv_scene *scene =
        srv_admit_scene(call, call->session, call->params.SCENE_REMOVE.scene);
    if (scene == NULL) {
        return PCCD_E_HANDLE;
    }
    const struct srv_object *item = srv_handles_get(&scene->objects, object);
    if (item == NULL) {
        return proto_error_set(&call->error, PCCD_E_HANDLE,
                               "scene 0x%x has no object 0x%x",
                               call->params.SCENE_REMOVE.scene, object);
    }
    if (item->owner != call->session) {
        return proto_error_set(&call->error, PCCD_E_ACCESS,
                               "object 0x%x is another session's", object);
    }
    struct srv_plan plan = {.work = work_remove,
                            .finish = finish_remove,
                            .ring = call->session->ring,
                            .scene = scene,
                            .object = object};
    return srv_request_start(call, &plan);
}

/* ---- what its hierarchies look like ------------------------------------------------ */

static int work_boxes(struct srv_request *request)
{
    const struct proto_SCENE_BOXES_request *asked = &request->params.SCENE_BOXES;
    const struct eng_scene *engine = request->plan.scene->engine;
    enum pccd_tree tree = (enum pccd_tree)asked->tree;
    uint32_t boxes = 0; /* as long as the scene has had no object and no step */
    if (engine != NULL) {
        boxes = eng_level_boxes(engine, tree, asked->level, 0, 0, NULL);
    }
    uint32_t left = asked->first < boxes ? boxes - asked->first : 0;
    struct srv_page page;
    void *data = NULL;
    int status = srv_ring_reserve(request->plan.ring, sizeof(struct pccd_box),
                                  asked->count < left ? asked->count : left, &page, &data,
                                  &request->error);
    if (status != 0) {
        return status;
    }
    if (page.count > 0) {
        (void)eng_level_boxes(engine, tree, asked->level, asked->first,
                              (uint32_t)page.count, data);
    }
    request->result.SCENE_BOXES =
        (struct proto_SCENE_BOXES_result){.boxes = boxes,
                                          .count = (uint32_t)page.count,
                                          .offset = page.position,
                                          .release = page.release};
    return 0;
}

int srv_on_SCENE_BOXES(struct srv_call *call)
{
    const struct proto_SCENE_BOXES_request *asked = &call->params.SCENE_BOXES;
    struct srv_scene *scene = srv_admit_scene(call, call->session, asked->scene);
    if (scene == NULL) {
        return call->error.code;
    }
    if (asked->tree >= PCCD_TREE_COUNT) {
        return proto_error_set(&call->error, PCCD_E_INVAL, "unknown tree %u",
                               asked->tree);
    }
    struct srv_ring *ring = NULL;
    int status = srv_admit_ring(call, &ring);
    if (status != 0) {
        return status;
    }
    struct srv_plan plan = {.work = work_boxes, .ring = ring, .scene = scene};
    return srv_request_start(call, &plan);
}
