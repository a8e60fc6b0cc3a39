/* handlers_step.c - frame.submit, scene.near and batch.submit. */
#include <math.h>
#include <stdlib.h>

#include "hold.h"
#include "invariant.h"
#include "names.h"
#include "now.h"
#include "service.h"
#include "session.h"
#include "shared.h"
#include "srv_batch.h"
#include "srv_step.h"

#define TOLERANCE_MIN 1e-12
#define TOLERANCE_MAX 1.0

/* ---- what is asked ----------------------------------------------------------------- */

/* Check how it is to be computed: 0, or why not, whatever its scene holds. */
static int check_how(struct srv_call *call, const struct srv_step_params *params)
{
    struct eng_tuning tuning = {0};
    char why[ENG_TUNING_WHY_BYTES];
    int status = srv_check_choice(call, "method", params->method, PCCD_METHOD_COUNT);
    if (status == 0 && eng_tuning_read(params->tuning, &tuning, why) != PCCD_OK) {
        status = proto_error_set(&call->error, PCCD_E_INVAL, "tuning: %s", why);
    }
    if (status == 0 && params->slot.segments > PROTO_SEGMENTS_MAX) {
        status = proto_error_set(&call->error, PCCD_E_LIMIT,
                                 "%u segments, a step has at most %u",
                                 params->slot.segments, PROTO_SEGMENTS_MAX);
    }
    return status;
}

static int check_step(struct srv_call *call, const struct srv_step_params *params)
{
    int status = srv_check_choice(call, "mode", params->mode, PCCD_MODE_COUNT);
    if (status != 0) {
        return status;
    }
    status = srv_check_choice(call, "touching", params->touching, PCCD_TOUCHING_COUNT);
    if (status != 0) {
        return status;
    }
    /* Written so that NaN is refused. */
    if (params->tolerance != 0.0 &&
        !(params->tolerance >= TOLERANCE_MIN && params->tolerance <= TOLERANCE_MAX)) {
        return proto_error_set(&call->error, PCCD_E_INVAL,
                               "tolerance is %g, not 0 or %g to %g", params->tolerance,
                               TOLERANCE_MIN, TOLERANCE_MAX);
    }
    if (!(params->approach >= 0.0 && params->approach < 1.0)) {
        return proto_error_set(&call->error, PCCD_E_INVAL,
                               "approach is %g, not 0 or between 0 and 1",
                               params->approach);
    }
    status = srv_check_length(call, "resolution", params->resolution);
    return status != 0 ? status
                       : srv_check_length(call, "separation", params->separation);
}

static int check_near(struct srv_call *call)
{
    const struct proto_SCENE_NEAR_request *asked = &call->params.SCENE_NEAR;
    bool is_nearest = asked->what == PCCD_NEAR_NEAREST;
    int status = srv_check_choice(call, "what", asked->what, PCCD_NEAR_COUNT);
    if (status == 0) {
        status = srv_check_choice(call, "end", asked->end, 2);
    }
    if (status == 0 && common_near_has_distance(asked->what)) {
        status = is_nearest && asked->distance == INFINITY
                     ? 0
                     : srv_check_length(call, "distance", asked->distance);
    }
    if (status == 0 && is_nearest) {
        status = srv_check_length(call, "gap", asked->gap);
    }
    if (status == 0 && common_near_is_of_objects(asked->what) && asked->object_a != 0 &&
        asked->object_a == asked->object_b) {
        status = proto_error_set(&call->error, PCCD_E_INVAL,
                                 "object_a and object_b are both 0x%x", asked->object_a);
    }
    const uint32_t objects[2] = {asked->object_a, asked->object_b};
    for (int side = common_near_names_objects(asked->what); side < 2 && status == 0;
         side++) {
        if (objects[side] != 0) {
            status = proto_error_set(&call->error, PCCD_E_INVAL,
                                     "object_%c is 0x%x, and what = %u is asked of all",
                                     "ab"[side], objects[side], asked->what);
        }
    }
    return status;
}

static int check_tables(struct srv_call *call, const struct srv_ring *ring,
                        const struct srv_step_params *params)
{
    uint64_t bytes = params->scenes * sizeof(struct proto_batch_scene) +
                     params->slot.segments * sizeof(struct proto_segment);
    if (params->scenes == 0) {
        return proto_error_set(&call->error, PCCD_E_INVAL, "a batch of no scenes");
    }
    if (params->scenes > PROTO_BATCH_MAX) {
        return proto_error_set(&call->error, PCCD_E_LIMIT,
                               "%u scenes, a batch has at most %u", params->scenes,
                               PROTO_BATCH_MAX);
    }
    if (bytes > ring->slot_stride) {
        return proto_error_set(&call->error, PCCD_E_SEGMENT,
                               "tables of %u scenes and %u segments do not fit in %llu "
                               "bytes of a slot",
                               params->scenes, params->slot.segments,
                               (unsigned long long)ring->slot_stride);
    }
    uint64_t room = ring->result_bytes - PROTO_SHM_PAGE;
    if (params->scenes > room / sizeof(struct pccd_scene_answer)) {
        return proto_error_set(&call->error, PCCD_E_LIMIT,
                               "the answers of %u scenes do not fit in a result region "
                               "of %llu bytes",
                               params->scenes, (unsigned long long)room);
    }
    return 0;
}

/* All that can be told from the message. */
static int check(struct srv_call *call, const struct srv_step_params *params,
                 struct srv_ring **ring)
{
    const struct srv_session *session = call->session;
    bool is_batch = call->method == PROTO_METHOD_BATCH_SUBMIT;
    int status = srv_admit_ring(call, ring);
    if (status == 0) {
        status = check_how(call, params);
    }
    if (status == 0 && (is_batch || params->slot.segments > 0)) {
        status = srv_admit_slot(call, *ring, params->slot.slot, params->slot.seq);
    }
    if (status == 0 && session->submit_count >= (*ring)->inflight_max) {
        status = proto_error_set(&call->error, PCCD_E_BUSY,
                                 "%u steps are in flight, no more than %u may be",
                                 session->submit_count, (*ring)->inflight_max);
    }
    if (status == 0) {
        status = params->is_near ? check_near(call) : check_step(call, params);
    }
    return status == 0 && is_batch ? check_tables(call, *ring, params) : status;
}

/* ---- before its turn --------------------------------------------------------------- */

/* Each is a write to all vertices of an object, at most. */
#define BRIEF_SEGMENTS 4u

/* A scene that others share is not: who takes part leaves, and hears of steps, in lists
 * that may be long. While nothing is computed. */
static bool can_be_brief(struct srv_request *request)
{
    const struct srv_scene *scene = request->plan.scene;
    uint32_t segments = request->params.FRAME_SUBMIT.segments;
    if (scene->shared != NULL || scene->engine == NULL || segments > BRIEF_SEGMENTS) {
        return false;
    }
    struct eng_question question;
    srv_step_ask(request, &question);
    return eng_step_can_be_brief(scene->engine, &question, segments > 0);
}

/* It is to end, and others are still before it: the answer is known. What it moves is
 * copied for its turn, unless it is OPEN and has been read. */
static bool answer_early(struct srv_request *request, enum pccd_incomplete why)
{
    srv_assert_loop();
    const struct srv_step_params params =
        srv_step_params_of(request->method, &request->params);
    struct srv_service *service = request->session->service;
    struct srv_quota_user *user = request->session->owner.user;
    struct srv_ring *ring = request->plan.ring;
    struct proto_answer answer;
    struct proto_error error = {0};
    bool is_open =
        atomic_load_explicit(&request->state, memory_order_acquire) == SRV_REQUEST_OPEN;
    bool moves = params.slot.segments > 0 && !is_open;
    uint64_t bytes = 0;
    uint8_t *copy = NULL;
    if (moves && srv_step_keep(request, &copy, &bytes, &error) != 0) {
        return true; /* whoever stages it in its turn says why */
    }
    srv_step_nothing(request, why, &answer);
    answer.ns_queue =
        (is_open ? request->begin_ns : common_now_ns()) - request->arrival_ns;
    answer.release = /* storing it changes nothing */
        atomic_load_explicit(&ring->shared->result_head.value, memory_order_relaxed);
    if (!srv_request_answer_early(request, &answer, copy, bytes, NULL)) {
        srv_quota_refund(user, SRV_QUOTA_SHM_BYTES, bytes);
        free(copy);
        return false;
    }
    if (params.is_near) { /* a step is counted when it has moved */
        srv_metrics_add_near(&service->metrics, &answer);
    }
    return true;
}

/* ---- the messages ------------------------------------------------------------------ */

/* A step or question of one scene. */
static int start_one(struct srv_call *call, const struct srv_step_params *params,
                     struct srv_ring *ring, struct srv_scene *scene)
{
    struct srv_session *session = call->session;
    bool is_changed = params->slot.segments > 0 || !params->is_near;
    int status = is_changed ? srv_shared_refuse_reader(session, scene, &call->error) : 0;
    if (status != 0) {
        return status;
    }
    struct srv_plan plan = {
        .work = srv_step_work,
        .finish = srv_step_finish,
        .ring = ring,
        .scene = scene,
        .member = srv_shared_member(scene, session),
        .takes_slot = params->slot.segments > 0,
        .answer_early = answer_early,
        .can_be_brief = params->is_near || params->holds ? NULL : can_be_brief,
        .replies = !params->holds && scene->shared == NULL,
        .deadline_ns = srv_step_deadline(params->deadline_ns, call->arrival_ns)};
    return params->holds ? srv_hold_start(call, &plan) : srv_request_start(call, &plan);
}

/* A step of each of many scenes. */
static int start_batch(struct srv_call *call, const struct srv_step_params *params,
                       struct srv_ring *ring)
{
    struct srv_batch *batch = NULL;
    int status = srv_batch_begin(call, ring, params, &batch);
    if (status != 0) {
        return status;
    }
    struct srv_plan plan = {.work = srv_batch_work,
                            .finish = srv_step_finish,
                            .ring = ring,
                            .batch = batch,
                            .claims = batch->claims,
                            .claim_count = batch->claim_count,
                            .takes_slot = true,
                            .answer_early = srv_batch_answer_early,
                            .replies = batch->shared_count == 0,
                            .deadline_ns =
                                srv_step_deadline(params->deadline_ns, call->arrival_ns)};
    status = srv_request_start(call, &plan);
    if (status < 0) {
        srv_batch_end(batch);
    }
    return status;
}

static int start(struct srv_call *call)
{
    const struct srv_step_params params = srv_step_params_of(call->method, &call->params);
    bool is_batch = call->method == PROTO_METHOD_BATCH_SUBMIT;
    struct srv_scene *scene =
        is_batch ? NULL : srv_admit_scene(call, call->session, params.scene);
    struct srv_ring *ring = NULL;
    if (scene == NULL && !is_batch) {
        return call->error.code;
    }
    int status = check(call, &params, &ring);
    if (status != 0) {
        return status;
    }
    return is_batch ? start_batch(call, &params, ring)
                    : start_one(call, &params, ring, scene);
}

int srv_on_FRAME_SUBMIT(struct srv_call *call)
{
    return start(call);
}

int srv_on_SCENE_NEAR(struct srv_call *call)
{
    return start(call);
}

int srv_on_BATCH_SUBMIT(struct srv_call *call)
{
    return start(call);
}
