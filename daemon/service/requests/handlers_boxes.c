/* handlers_boxes.c - scene.boxes: what a scene's hierarchies look like. */
#include "admission.h"
#include "call.h"
#include "engine.h"
#include "request.h"
#include "session.h"

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
    struct srv_scene *scene = srv_handles_get(&call->session->scenes, asked->scene);
    if (scene == NULL) {
        return proto_error_set(&call->error, PCCD_E_HANDLE, "there is no scene 0x%x",
                               asked->scene);
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
