/* handlers_near.c - scene.near. */
#include <math.h>
#include <string.h>

#include "admission.h"
#include "call.h"
#include "engine.h"
#include "frame.h"
#include "invariant.h"
#include "now.h"
#include "request.h"
#include "service.h"
#include "session.h"
#include "shared.h"
#include "srv_journal.h"
#include "stepping.h"
#include "tracing.h"

#define DISTANCE_NONE 2e18 /* distance_min of no records */

/* ---- computed ---------------------------------------------------------------------- */

static void describe(const struct eng_step_result *near, struct proto_answer *answer)
{
    srv_answer_describe(near,
                        near->what == PCCD_NEAR_VERTICES
                            ? (uint32_t)sizeof(double)
                            : (uint32_t)sizeof(struct pccd_near),
                        answer);
}

/* What the engine has found fault with. [compute] */
static int explain(struct srv_request *request, int status,
                   const struct eng_step_result *near)
{
    if (status == PCCD_E_INVAL && near->has_free) {
        return proto_error_set(
            &request->error, status,
            "the mesh of object 0x%x has free edges or points: %s is answered for meshes "
            "of triangles alone",
            near->open_object, near->what == PCCD_NEAR_DEPTH ? "depth" : "nearest");
    }
    if (status == PCCD_E_INVAL && near->open_object != 0) {
        return proto_error_set(
            &request->error, status,
            "the mesh of object 0x%x is not closed: %u of its faces run along the edge "
            "from vertex %u to %u, and %u back",
            near->open_object, near->open_runs[0], near->open_edge[0], near->open_edge[1],
            near->open_runs[1]);
    }
    if (status == PCCD_E_LIMIT) {
        return proto_error_set(&request->error, status,
                               "distance and the radii of a pair are together beyond %g",
                               PROTO_COORDINATE_MAX);
    }
    return proto_error_set(&request->error, status, "scene.near: %s",
                           proto_status_text(status));
}

/* The objects that are named are in the scene by now, or are not. [compute] */
static int check_objects(struct srv_request *request)
{
    const struct proto_SCENE_NEAR_request *asked = &request->params.SCENE_NEAR;
    const uint32_t objects[2] = {asked->object_a, asked->object_b};
    for (int side = 0; side < 2; side++) {
        if (objects[side] != 0 &&
            srv_scene_find(request->plan.scene, objects[side]) == NULL) {
            return proto_error_set(&request->error, PCCD_E_HANDLE,
                                   "object_%c 0x%x is not in the scene", "ab"[side],
                                   objects[side]);
        }
    }
    return 0;
}

/* Another daemon was told where everything is, but not where it came from. [compute] */
static int check_end(struct srv_request *request)
{
    const struct proto_SCENE_NEAR_request *asked = &request->params.SCENE_NEAR;
    if (asked->end == 0 && asked->segments == 0 && request->plan.scene->is_placed) {
        return proto_error_set(&request->error, PCCD_E_STATE,
                               "where the last step of scene 0x%x began is not known: "
                               "it was brought back to this daemon, and no step since",
                               asked->scene);
    }
    return 0;
}

/* Ask the engine, and keep its answer in the scene. [compute] */
static int compute_near(struct srv_request *request, struct eng_scene *engine)
{
    const struct proto_SCENE_NEAR_request *asked = &request->params.SCENE_NEAR;
    struct srv_scene *scene = request->plan.scene;
    struct eng_question question = srv_stepping_settings(request);
    struct eng_step_result near = {.open_object = 0};
    scene->near.is_there = false; /* it takes the memory of the last one's records */
    question.verb = asked->what;
    question.distance = asked->distance;
    question.gap = asked->gap;
    question.end = asked->end;
    question.objects[0] = asked->object_a;
    question.objects[1] = asked->object_b;
    question.tells_crossings = asked->tells_crossings;
    atomic_store_explicit(&request->job.end_ns, question.deadline_ns,
                          memory_order_relaxed);
    question.trace = srv_tracing_lend();
    int status = eng_near(engine, &question, &near);
    srv_tracing_return(question.trace);
    if (status != 0) {
        return explain(request, status, &near);
    }
    describe(&near, &scene->near.answer);
    eng_tuning_used(&question, &near, scene->near.answer.tuning);
    scene->near.answer.step = asked->step;
    scene->near.asker = request->session->id;
    scene->near.records = near.records;
    scene->near.is_there = true;
    PCCD_ASSERT(near.count == 0 || near.record_bytes == scene->near.answer.record_bytes);
    return 0;
}

/* Move what it moves, then ask: both or neither. [compute] */
static int move_and_ask(struct srv_request *request)
{
    struct srv_scene *scene = request->plan.scene;
    bool moves = request->params.SCENE_NEAR.segments > 0;
    struct eng_scene *engine = NULL;
    int status = srv_scene_engine(scene, &engine);
    if (status != 0) {
        return proto_error_set(&request->error, status, "no memory for the scene");
    }
    srv_shared_hide(scene);
    status = check_objects(request);
    status = status != 0 ? status : check_end(request);
    if (status == 0 && moves) {
        srv_stepping_open(request, engine);
        status = srv_stepping_stage(request);
    }
    status = status != 0 ? status : compute_near(request, engine);
    if (status != 0) {
        eng_stage_abort(engine);
        return status;
    }
    scene->is_placed = scene->is_placed && !moves;
    srv_journal_near(scene, &request->params.SCENE_NEAR, request->plan.member);
    return 0;
}

/* It was answered before its turn: what is left is to move. What goes wrong is what the
 * session's next request on the scene is answered. [compute] */
static int move_early(struct srv_request *request)
{
    if (request->params.SCENE_NEAR.segments == 0) {
        return 0;
    }
    int status = move_and_ask(request);
    if (status != 0) {
        *srv_stepping_owed(request) = request->error;
        return status;
    }
    return 0;
}

static int work_near(struct srv_request *request)
{
    struct proto_answer *answer = &request->result.answer;
    request->begin_ns = common_now_ns();
    if (srv_request_state(request) == SRV_REQUEST_EARLY) {
        return move_early(request);
    }
    int status = srv_stepping_begin(request);
    if (status == 0) {
        status = move_and_ask(request);
    }
    if (status != 0) {
        return status;
    }
    uint64_t copy_ns = common_now_ns();
    status = srv_answer_page(request, &request->plan.scene->near, 0, answer);
    uint64_t end_ns = common_now_ns();
    answer->ns_queue = request->begin_ns - request->arrival_ns;
    answer->ns_merge += end_ns - copy_ns;
    answer->ns_step += end_ns - copy_ns;
    return status;
}

/* ---- before its turn, and after ---------------------------------------------------- */

/* The hash of no records is that of a step without any; with a gap there is none. */
static void say_nothing(const struct proto_SCENE_NEAR_request *asked,
                        enum pccd_incomplete why, struct proto_answer *answer)
{
    struct eng_question settings = ENG_QUESTION_DEFAULT;
    struct eng_step_result nothing;
    settings.method = (enum pccd_method)asked->method;
    eng_step_nothing(&settings, &nothing);
    nothing.what = (enum pccd_near_what)asked->what;
    nothing.incomplete = why;
    nothing.toi_first = 0; /* it has none */
    nothing.distance_min = DISTANCE_NONE;
    if (asked->what == PCCD_NEAR_NEAREST && asked->gap > 0.0) {
        nothing.hash[0] = nothing.hash[1] = 0;
    }
    describe(&nothing, answer);
    answer->step = asked->step;
}

static void answer_near_early(struct srv_request *request, enum pccd_incomplete why)
{
    struct proto_answer answer;
    say_nothing(&request->params.SCENE_NEAR, why, &answer);
    answer.ns_queue = common_now_ns() - request->arrival_ns;
    srv_stepping_answer_early(request, &answer, &answer.release);
    if (srv_request_state(request) == SRV_REQUEST_EARLY) {
        srv_metrics_add_near(&request->session->service->metrics, &answer);
    }
}

static void finish_near(struct srv_request *request)
{
    const struct proto_answer *answer = &request->result.answer;
    struct srv_session *session = request->session;
    if (request->status == 0) {
        session->told.upload_bytes += request->upload_bytes;
    }
    if (request->status == 0 && srv_request_state(request) != SRV_REQUEST_EARLY) {
        srv_metrics_add_near(&session->service->metrics, answer);
        session->told.result_bytes += answer->count * answer->record_bytes;
    }
}

/* ---- what is asked ----------------------------------------------------------------- */

static bool has_distance(uint32_t what)
{
    return what != PCCD_NEAR_CROSSINGS && what != PCCD_NEAR_DEPTH;
}

static int check_question(struct srv_call *call)
{
    const struct proto_SCENE_NEAR_request *asked = &call->params.SCENE_NEAR;
    const struct srv_choice choices[] = {{"what", asked->what, PCCD_NEAR_COUNT},
                                         {"end", asked->end, 2}};
    bool is_nearest = asked->what == PCCD_NEAR_NEAREST;
    int status = srv_stepping_choose(call, choices, 2);
    if (status == 0 && has_distance(asked->what)) {
        status = is_nearest && asked->distance == INFINITY
                     ? 0
                     : srv_check_length(call, "distance", asked->distance);
    }
    if (status == 0 && is_nearest) {
        status = srv_check_length(call, "gap", asked->gap);
    }
    if (status == 0 && (is_nearest || asked->what == PCCD_NEAR_DEPTH) &&
        asked->object_a != 0 && asked->object_a == asked->object_b) {
        status = proto_error_set(&call->error, PCCD_E_INVAL,
                                 "object_a and object_b are both 0x%x", asked->object_a);
    }
    return status;
}

int srv_on_SCENE_NEAR(struct srv_call *call)
{
    const struct proto_SCENE_NEAR_request *request = &call->params.SCENE_NEAR;
    const struct srv_asked asked = srv_asked_of(call->method, &call->params);
    struct srv_session *session = call->session;
    struct srv_scene *scene = srv_handles_get(&session->scenes, request->scene);
    struct srv_ring *ring = NULL;
    if (scene == NULL) {
        return proto_error_set(&call->error, PCCD_E_HANDLE, "there is no scene 0x%x",
                               request->scene);
    }
    int status = srv_stepping_check(call, &asked, &ring);
    if (status == 0) {
        status = check_question(call);
    }
    if (status == 0 && request->segments > 0) {
        status = srv_shared_refuse_reader(session, scene, &call->error);
    }
    if (status != 0) {
        return status;
    }
    struct srv_plan plan = {
        .work = work_near,
        .finish = finish_near,
        .ring = ring,
        .scene = scene,
        .member = srv_shared_member(scene, session),
        .takes_slot = request->segments > 0,
        .answer_early = answer_near_early,
        .replies = scene->shared == NULL,
        .deadline_ns = srv_stepping_deadline(request->deadline_ns, call->arrival_ns)};
    return srv_request_start(call, &plan);
}
