/* srv_step.c - a step, or a question about what is near, while it is computed. */
#include "srv_step.h"

#include <string.h>

#include "held.h"
#include "invariant.h"
#include "names.h"
#include "now.h"
#include "numbers.h"
#include "service.h"
#include "session.h"
#include "shared.h"
#include "srv_journal.h"
#include "tracing.h"

#define NS_PER_MS         1000000u
#define TOLERANCE_DEFAULT 1e-6
#define DISTANCE_NONE     2e18 /* distance_min of no records */

/* ---- what is asked ----------------------------------------------------------------- */

/* The fields that all have, and those that are of a step. */
#define COMMON(of)                                                                       \
    .slot = SRV_SLOT_OF(of), .method = (of)->method, .threads = (of)->threads,           \
    .deadline_ns = (of)->deadline_ns, .step = (of)->step, .tuning = (of)->tuning
#define OF_STEP(of)                                                                      \
    .mode = (of)->mode, .tolerance = (of)->tolerance, .separation = (of)->separation,    \
    .approach = (of)->approach, .touching = (of)->touching,                              \
    .resolution = (of)->resolution

struct srv_step_params srv_step_params_of(int method, const union srv_params *params)
{
    const struct proto_FRAME_SUBMIT_request *frame = &params->FRAME_SUBMIT;
    const struct proto_SCENE_NEAR_request *near = &params->SCENE_NEAR;
    const struct proto_BATCH_SUBMIT_request *batch = &params->BATCH_SUBMIT;
    PCCD_ASSERT(srv_is_step(method));
    switch (method) {
    case PROTO_METHOD_SCENE_NEAR:
        return (struct srv_step_params){COMMON(near), .scene = near->scene,
                                        .is_near = true};
    case PROTO_METHOD_BATCH_SUBMIT:
        return (struct srv_step_params){COMMON(batch), OF_STEP(batch),
                                        .scenes = batch->scenes};
    default:
        return (struct srv_step_params){
            COMMON(frame),         OF_STEP(frame),
            .scene = frame->scene, .tells_start = frame->tells_start,
            .holds = frame->hold,  .places = frame->place};
    }
}

uint64_t srv_step_deadline(uint64_t budget_ns, uint64_t arrival_ns)
{
    if (budget_ns == 0) {
        return 0;
    }
    return budget_ns > UINT64_MAX - arrival_ns ? UINT64_MAX : arrival_ns + budget_ns;
}

/* The sooner one of the client's deadline and what the daemon lets a step compute; 0:
 * none. */
static uint64_t end_of(const struct srv_request *request, uint64_t budget_ns)
{
    uint64_t own_ns = srv_step_deadline(budget_ns, request->arrival_ns);
    uint64_t max_ms = request->session->service->options->step_max_ms;
    bool has_begun = request->begin_ns != 0;
    uint64_t max_ns =
        max_ms == 0 || !has_begun ? 0 : request->begin_ns + max_ms * NS_PER_MS;
    return own_ns == 0 || (max_ns != 0 && max_ns < own_ns) ? max_ns : own_ns;
}

/* Set what the message asks for, as the engine has it. */
static void choose(const struct srv_request *request,
                   const struct srv_step_params *params, struct eng_question *question)
{
    char why[ENG_TUNING_WHY_BYTES];
    *question = (struct eng_question)ENG_QUESTION_DEFAULT;
    int status = eng_tuning_read(params->tuning, &question->tuning, why);
    PCCD_ASSERT(status == PCCD_OK); /* it was checked */
    question->method = (enum pccd_method)params->method;
    if (params->is_near) {
        const struct proto_SCENE_NEAR_request *near = &request->params.SCENE_NEAR;
        question->verb = near->what;
        question->distance = near->distance;
        question->gap = near->gap;
        question->end = near->end;
        question->objects[0] = near->object_a;
        question->objects[1] = near->object_b;
        question->tells_crossings = near->tells_crossings;
        return;
    }
    question->mode = (enum pccd_mode)params->mode;
    question->tolerance =
        params->tolerance == 0.0 ? TOLERANCE_DEFAULT : params->tolerance;
    question->distance = params->separation;
    question->approach = params->approach;
    question->touching = (enum pccd_touching)params->touching;
    question->resolution = params->resolution;
    question->tells_start = params->tells_start;
    question->no_hash = request->session->service->write != NULL;
}

void srv_step_ask(struct srv_request *request, struct eng_question *question)
{
    const struct srv_step_params params =
        srv_step_params_of(request->method, &request->params);
    const struct srv_service *service = request->session->service;
    uint32_t threads_max = eng_payer_threads(service->options->threads_max);
    choose(request, &params, question);
    question->threads = params.threads == 0 || params.threads > threads_max
                            ? threads_max
                            : params.threads;
    question->deadline_ns = end_of(request, params.deadline_ns);
    question->cancel = &request->job.cancel;
    question->is_stopped = service->is_stopped;
    question->asked = service->asked;
    question->weigh = service->weigh;
    question->weigher = service->weigher;
    question->contact_max = service->options->contacts_max;
    question->brief = srv_request_state(request) == SRV_REQUEST_BRIEF;
    question->alone = request->is_alone;
    if (service->is_pinned) {
        question->affinity =
            srv_workspace_of_thread(request->session->service->workspaces)->affinity;
    }
}

/* ---- what is answered -------------------------------------------------------------- */

static uint32_t record_bytes_of(const struct eng_step_result *result, bool is_near)
{
    if (is_near) {
        return result->what == PCCD_NEAR_VERTICES ? (uint32_t)sizeof(double)
                                                  : (uint32_t)sizeof(struct pccd_near);
    }
    return result->mode == PCCD_MODE_PAIRS ? (uint32_t)sizeof(struct pccd_pair)
                                           : (uint32_t)sizeof(struct pccd_contact);
}

/* Describe what the engine says, in the terms of the message, but for the page. */
static void describe(const struct eng_step_result *result, bool is_near, uint64_t step,
                     struct proto_answer *answer)
{
    *answer = (struct proto_answer){.step = step,
                                    .total = result->count,
                                    .record_bytes = record_bytes_of(result, is_near)};
#define PUT(unused, type, name, of_step, of_near, member, meaning)                       \
    answer->name = result->member;
    COMMON_NUMBERS(PUT, )
#undef PUT
}

/* The hash of no records is that of a step without any; with a gap there is none. */
void srv_step_nothing(const struct srv_request *request, enum pccd_incomplete why,
                      struct proto_answer *answer)
{
    const struct srv_step_params params =
        srv_step_params_of(request->method, &request->params);
    struct eng_question question;
    struct eng_step_result nothing;
    choose(request, &params, &question);
    eng_step_empty_result(&question, &nothing);
    nothing.incomplete = why;
    if (params.is_near) {
        nothing.what = (enum pccd_near_what)question.verb;
        nothing.toi_first = 0; /* it has none */
        nothing.distance_min = DISTANCE_NONE;
    }
    if (question.verb == PCCD_NEAR_NEAREST && question.gap > 0.0) {
        nothing.hash[0] = nothing.hash[1] = 0;
    }
    describe(&nothing, params.is_near, params.step, answer);
}

int srv_step_keep(const struct srv_request *request, uint8_t **copy, uint64_t *bytes,
                  struct proto_error *error)
{
    const struct srv_step_params params =
        srv_step_params_of(request->method, &request->params);
    struct srv_quota_user *user = request->session->owner.user;
    struct srv_ring *ring = request->plan.ring;
    uint64_t most =
        ring->slot_stride < SRV_KEPT_BYTES ? ring->slot_stride : SRV_KEPT_BYTES;
    uint64_t used = 0;
    struct srv_slot_ref slot = params.slot;
    slot.scenes_bytes = params.scenes * sizeof(struct proto_batch_scene);
    int status = srv_quota_charge_shared(user, most, error);
    if (status != 0) {
        return status;
    }
    status = srv_stage_keep(ring, &slot, most, copy, &used, error);
    if (status != 0) {
        srv_quota_refund(user, SRV_QUOTA_SHM_BYTES, most);
    }
    *bytes = most;
    return status;
}

void srv_step_note(struct srv_item *item, const struct proto_answer *answer)
{
    struct proto_STEP_request *event = &item->event;
    event->incomplete = answer->incomplete;
    event->verdict = answer->verdict;
    event->threads = answer->threads;
    event->total = answer->total;
    event->hash_hi = answer->hash_hi;
    event->hash_lo = answer->hash_lo;
    event->ns_step = answer->ns_step;
}

/* ---- one scene --------------------------------------------------------------------- */

static bool moves(const struct srv_step_run *run)
{
    return run->staging.slot.segments > 0;
}

/* Return where the error is left of one that was answered before its turn. */
static struct proto_error *owed_by(const struct srv_item *item)
{
    return item->member != NULL ? &item->member->owed : &item->scene->owed;
}

/* The session hears of it with its next request on the scene. */
static int take_owed(const struct srv_item *item, struct proto_error *error)
{
    struct proto_error *owed = owed_by(item);
    int code = owed->code;
    if (code != 0) {
        *error = *owed;
        owed->code = 0;
    }
    return code;
}

/* The objects that scene.near names are in the scene by now, or are not. And where a step
 * began is not known to a daemon that was only told where everything is. */
static int check_near(const struct srv_step_run *run)
{
    const struct eng_question *question = run->question;
    struct srv_scene *scene = run->item->scene;
    for (int side = 0; side < 2; side++) {
        uint32_t object = question->objects[side];
        if (object != 0 && srv_scene_find(scene, object) == NULL) {
            return proto_error_set(run->staging.error, PCCD_E_HANDLE,
                                   "object_%c 0x%x is not in the scene", "ab"[side],
                                   object);
        }
    }
    if (common_near_reads_begin(question->verb, question->end) && !moves(run) &&
        scene->is_placed) {
        return proto_error_set(run->staging.error, PCCD_E_STATE,
                               "where the last step of scene 0x%x began is not known: "
                               "it was brought back to this daemon, and no step since",
                               run->params->scene);
    }
    return 0;
}

/* Stage what the engine has already (proto_direct.h); nothing of it if something went
 * wrong. */
static int stage_mapped(struct srv_scene *scene, int status, struct proto_error *error)
{
    for (uint32_t i = 0; i < scene->placed_count; i++) {
        struct srv_placed *placed = &scene->placed[i];
        if (placed->handle == 0 || placed->mapped == SRV_MAPPED_NOTHING) {
            continue;
        }
        if (status == 0) {
            status = eng_stage_mapped(scene->engine, placed->engine_idx,
                                      placed->mapped == SRV_MAPPED_X0X1);
            status = status == 0 ? 0
                     : status == PCCD_E_NOTFINITE
                         ? srv_stage_explain_stray(scene, error)
                         : proto_error_set(error, status, "object 0x%x: %s",
                                           placed->handle, proto_status_text(status));
        } else {
            eng_stage_unmap(scene->engine, placed->engine_idx);
        }
        placed->mapped = SRV_MAPPED_NOTHING;
    }
    scene->has_mapped = false;
    return status;
}

/* Stage what moves: for a step also what others hold for it. */
static int stage(struct srv_step_run *run)
{
    struct srv_item *item = run->item;
    struct srv_scene *scene = item->scene;
    const struct eng_question *question = run->question;
    bool takes_held =
        item->member != NULL && !run->params->is_near && !run->params->places;
    if (takes_held) {
        srv_held_frame_check(scene, &item->taken);
    }
    if (scene->journals != NULL) {
        srv_journal_open(scene, run->staging.slot.segments);
    }
    eng_stage_begin(scene->engine);
    if (question->threads > 1 && !question->brief) {
        eng_stage_share(scene->engine, question->threads, question->affinity);
    }
    int status = takes_held ? srv_held_frame_stage(scene, run->staging.error) : 0;
    if (status == 0 && moves(run)) {
        run->staging.scene = scene;
        run->staging.member = item->member;
        status = srv_stage(&run->staging);
    }
    if (run->request->plan.batch == NULL) { /* a batch has one slot for all scenes */
        srv_request_return_slot(run->request);
    }
    return scene->has_mapped && !run->params->is_near
               ? stage_mapped(scene, status, run->staging.error)
               : status;
}

/* Explain what the engine has found fault with. */
static int explain(const struct srv_step_run *run, int status)
{
    const struct eng_step_result *found = run->result;
    struct proto_error *error = run->staging.error;
    const char *refused = eng_turning_refuses(run->question);
    if (status == PCCD_E_SEGMENT) {
        return srv_stage_explain_twice(run->item->scene, &run->staging, error);
    }
    if (!run->params->is_near && status == PCCD_E_INVAL && refused != NULL) {
        return proto_error_set(error, status,
                               "the step: %s has no answer where objects turn", refused);
    }
    if (!run->params->is_near && status == PCCD_E_INVAL &&
        eng_step_refuses_start(run->staging.scene->engine, run->question)) {
        return proto_error_set(error, status,
                               "the step: how a step begins, with an approach, has no "
                               "answer where two objects have a clearance");
    }
    if (!run->params->is_near) {
        return proto_error_set(error, status, "the step: %s", proto_status_text(status));
    }
    if (status == PCCD_E_INVAL && found->open_object != 0) {
        return proto_error_set(
            error, status,
            "the mesh of object 0x%x is not closed: %u of its faces run along the edge "
            "from vertex %u to %u, and %u back",
            found->open_object, found->open_runs[0], found->open_edge[0],
            found->open_edge[1], found->open_runs[1]);
    }
    if (status == PCCD_E_LIMIT) {
        return proto_error_set(error, status,
                               "distance and the radii of a pair are together beyond %g",
                               PROTO_COORDINATE_MAX);
    }
    return proto_error_set(error, status, "scene.near: %s", proto_status_text(status));
}

/* Step or ask. Its records take the memory of those of the last one. */
static int compute(struct srv_step_run *run)
{
    const bool is_near = run->params->is_near;
    struct srv_scene *scene = run->item->scene;
    struct srv_kept *kept = is_near ? &scene->near : &scene->stepped;
    int status = 0;
    kept->is_there = false;
    if (is_near) {
        *run->result = (struct eng_step_result){.open_object = 0};
        status = eng_near(scene->engine, run->question, run->result);
    } else if (run->is_answered) {
        status = eng_move(scene->engine, run->question, run->result);
    } else {
        status = eng_step(scene->engine, run->question, run->result);
    }
    if (status != 0) {
        return status == PCCD_E_AGAIN ? status : explain(run, status);
    }
    describe(run->result, is_near, run->step, &kept->answer);
    eng_tuning_used(run->question, run->result, kept->answer.tuning);
    kept->asker = run->request->session->id;
    kept->records = run->result->records;
    kept->is_there = true;
    PCCD_ASSERT(run->result->count == 0 ||
                run->result->record_bytes == kept->answer.record_bytes);
    return 0;
}

/* For those who record a shared scene: the request as it was sent, or as a step of the
 * scene by itself would have been. */
static void note(const struct srv_step_run *run)
{
    const struct srv_step_params *params = run->params;
    const union srv_params *sent = &run->request->params;
    struct srv_scene *scene = run->item->scene;
    const struct srv_member *member = run->item->member;
    if (params->is_near) {
        srv_journal_near(scene, &sent->SCENE_NEAR, member);
    } else if (params->scenes == 0) {
        srv_journal_step(scene, &sent->FRAME_SUBMIT, member, run->item->taken);
    } else {
        struct proto_FRAME_SUBMIT_request frame = {.scene = run->item->event.scene,
                                                   .step = run->step,
                                                   .mode = params->mode,
                                                   .method = params->method,
                                                   .threads = params->threads,
                                                   .tolerance = params->tolerance,
                                                   .deadline_ns = params->deadline_ns,
                                                   .separation = params->separation,
                                                   .approach = params->approach,
                                                   .touching = params->touching,
                                                   .resolution = params->resolution};
        memcpy(frame.tuning, params->tuning,
               strnlen(params->tuning, sizeof frame.tuning));
        srv_journal_step(scene, &frame, member, run->item->taken);
    }
}

/* Have the scene and its journals remember it. */
static void remember(struct srv_step_run *run)
{
    const struct srv_step_params *params = run->params;
    struct srv_item *item = run->item;
    struct srv_scene *scene = item->scene;
    if (params->is_near) {
        scene->is_placed = scene->is_placed && !moves(run);
    } else {
        scene->is_placed = params->places;
        scene->stepped.answer.number = params->places ? 0 : ++scene->number;
        scene->expected = run->result->count;
        item->has_stepped = true;
    }
    if (item->member != NULL && !params->is_near && !params->places) {
        srv_held_frame_take(scene, &item->taken);
    }
    if (scene->journals != NULL) {
        note(run);
    }
}

int srv_step_stage(struct srv_step_run *run)
{
    struct srv_item *item = run->item;
    struct srv_scene *scene = item->scene;
    struct proto_error *error = run->staging.error;
    enum srv_request_state state = srv_request_state(run->request);
    bool is_staged = state == SRV_REQUEST_MOVED; /* what is brief goes on */
    bool is_answered = run->is_answered || state == SRV_REQUEST_EARLY;
    struct eng_scene *engine = NULL;
    int status = is_staged || is_answered ? 0 : take_owed(item, error);
    if (status != 0) {
        return status;
    }
    status = srv_scene_engine(scene, &engine);
    if (status != 0) {
        return proto_error_set(error, status, "no memory for the scene");
    }
    if (item->member != NULL) {
        srv_shared_hide(scene);
    }
    if (run->params->is_near) {
        status = check_near(run);
    }
    if (status == 0 && !is_staged && (moves(run) || !run->params->is_near)) {
        status = stage(run);
    }
    if (status != 0) {
        eng_stage_abort(engine);
    }
    return status;
}

int srv_step_compute(struct srv_step_run *run)
{
    int status = compute(run);
    if (status == 0) {
        remember(run);
    } else if (status != PCCD_E_AGAIN) {
        eng_stage_abort(run->item->scene->engine);
    }
    return status;
}

/* ---- a request --------------------------------------------------------------------- */

/* Records below which a step has memory of its own for what it finds. */
#define LENT_BYTES_MIN (1u << 20)

/* Lend the engine the page: what a step finds lies there, and has gone from there, into
 * order, when records are written: so there is memory for one of the two alone, as long
 * as the page is expected to be. A client that could write there meanwhile would make the
 * engine read what it has not found. */
static void lend_page(const struct srv_request *request, struct eng_question *question)
{
    const struct srv_scene *scene = request->plan.scene;
    uint32_t record_bytes =
        scene->stepped.answer.record_bytes; /* 0: there was no step yet */
    if (request->session->service->lends_pages &&
        scene->expected * record_bytes >= LENT_BYTES_MIN) {
        question->scratch_memory = srv_ring_next(
            request->plan.ring, record_bytes, scene->expected, &question->scratch_bytes);
    }
}

/* 0, or PCCD_E_INVAL: the client's result_head makes no sense. */
static int check_head(struct srv_request *request)
{
    struct srv_page page;
    void *data = NULL;
    return srv_ring_reserve(request->plan.ring, 1, 0, &page, &data, &request->error);
}

/* The page of a step that has run, or of a question. */
static int write_page(struct srv_request *request, const struct srv_step_params *params,
                      uint64_t begin_ns)
{
    struct srv_scene *scene = request->plan.scene;
    struct proto_answer *answer = &request->result.answer;
    uint64_t copy_ns = common_now_ns();
    int status = srv_answer_page(
        request, params->is_near ? &scene->near : &scene->stepped, 0, answer);
    uint64_t end_ns = common_now_ns();
    answer->ns_queue = begin_ns - request->arrival_ns;
    answer->ns_merge += end_ns - copy_ns;
    answer->ns_step += end_ns - copy_ns;
    return status;
}

/* One scene, of which a part may be done already. */
static int work(struct srv_request *request, const struct srv_step_params *params,
                struct eng_question *question, uint64_t begin_ns)
{
    struct srv_scene *scene = request->plan.scene;
    enum srv_request_state state = srv_request_state(request);
    bool is_early = state == SRV_REQUEST_EARLY;
    if (is_early && params->is_near && params->slot.segments == 0) {
        return 0; /* nothing is left of it */
    }
    int status = is_early || state == SRV_REQUEST_MOVED ? 0 : check_head(request);
    if (status != 0) {
        return status;
    }
    struct srv_service *service = request->session->service;
    struct eng_step_result result;
    struct srv_step_run run = {
        .request = request,
        .item = &request->item,
        .params = params,
        .question = question,
        .step = params->step,
        .staging = {.ring = is_early ? NULL : request->plan.ring,
                    .slot = params->slot,
                    .payload = request->copy,
                    .payload_bytes = request->copy_bytes,
                    .table = srv_workspace_of_thread(service->workspaces)->segments,
                    .error = &request->error},
        .result = &result};
    if (!params->is_near) {
        lend_page(request, question);
    }
    status = srv_step_stage(&run);
    if (status == 0) {
        srv_request_open(request);
        status = srv_step_compute(&run);
    }
    request->upload_bytes += run.staging.copied;
    if (status == PCCD_E_AGAIN) {
        srv_request_move(request, SRV_REQUEST_MOVED);
        request->job.goes_on = true;
        return 0;
    }
    is_early = !srv_request_claim(request);
    if (status != 0 && is_early) {
        *owed_by(&request->item) = request->error;
    }
    if (status != 0) {
        return status;
    }
    if (!params->is_near) {
        request->last_step = srv_laststep_of(&service->spare_step, &result);
    }
    if (params->places) { /* of many scenes, and not all are stepped soon */
        eng_step_free_scratch(scene->engine);
    }
    if (is_early) {
        request->result.answer = scene->stepped.answer;
    } else {
        status = write_page(request, params, begin_ns);
    }
    srv_step_note(&request->item, &request->result.answer);
    return status;
}

uint64_t srv_step_begin(struct srv_request *request, struct eng_question *question)
{
    srv_assert_compute();
    uint64_t begin_ns = common_now_ns();
    if (srv_request_state(request) != SRV_REQUEST_MOVED) {
        request->begin_ns = begin_ns;
    }
    srv_step_ask(request, question);
    atomic_store_explicit(&request->job.end_ns, question->deadline_ns,
                          memory_order_relaxed);
    question->trace = srv_tracing_lend();
    return begin_ns;
}

int srv_step_work(struct srv_request *request)
{
    const struct srv_step_params params =
        srv_step_params_of(request->method, &request->params);
    struct eng_question question;
    uint64_t begin_ns = srv_step_begin(request, &question);
    int status = work(request, &params, &question, begin_ns);
    srv_tracing_return(question.trace);
    return status;
}
