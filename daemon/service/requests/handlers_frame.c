/* handlers_frame.c - frame.submit. */
#include "call.h"
#include "engine.h"
#include "frame.h"
#include "held.h"
#include "holding.h"
#include "invariant.h"
#include "now.h"
#include "request.h"
#include "service.h"
#include "session.h"
#include "shared.h"
#include "srv_journal.h"
#include "stepping.h"
#include "tracing.h"
#include "watcher.h"

#define TOLERANCE_DEFAULT 1e-6
#define TOLERANCE_MIN     1e-12
#define TOLERANCE_MAX     1.0

/* ---- computed ---------------------------------------------------------------------- */

static void describe(const struct eng_step_result *step, struct proto_answer *answer)
{
    srv_answer_describe(step,
                        step->mode == PCCD_MODE_PAIRS
                            ? (uint32_t)sizeof(struct pccd_pair)
                            : (uint32_t)sizeof(struct pccd_contact),
                        answer);
}

/* The engine's settings for a request that was checked. [compute] */
static struct eng_question settings_of(struct srv_request *request)
{
    struct eng_question settings =
        srv_frame_settings(request, &SRV_WANTED_OF(&request->params.FRAME_SUBMIT));
    settings.no_hash = request->session->service->write != NULL;
    settings.tells_start = request->params.FRAME_SUBMIT.tells_start;
    return settings;
}

/* Whether it was staged before: only what is brief goes on. [compute] */
static bool has_moved(const struct srv_request *request)
{
    return srv_request_state(request) == SRV_REQUEST_MOVED;
}

int srv_frame_compute(struct srv_scene *scene, const struct eng_question *settings,
                      const struct srv_stepper *by, struct eng_step_result *step,
                      struct proto_error *error)
{
    scene->stepped.is_there =
        false; /* the step takes the memory of the last one's records */
    int status = eng_step(scene->engine, settings, step);
    if (status == PCCD_E_AGAIN) {
        return status;
    }
    if (status != 0) {
        return proto_error_set(error, status, "the step: %s", proto_status_text(status));
    }
    describe(step, &scene->stepped.answer);
    eng_tuning_used(settings, step, scene->stepped.answer.tuning);
    scene->stepped.answer.step = by->step;
    scene->is_placed = by->places;
    if (!scene->is_placed) {
        scene->stepped.answer.number = ++scene->number;
    }
    scene->stepped.asker = by->session;
    scene->stepped.records = step->records;
    scene->expected = step->count;
    scene->stepped.is_there = true;
    PCCD_ASSERT(step->count == 0 ||
                step->record_bytes == scene->stepped.answer.record_bytes);
    return 0;
}

/* Records below which a step has memory of its own for what it finds. */
#define LENT_BYTES_MIN (1u << 20)

/* What a step finds lies where its page will, and has gone from there, into order, when
 * that is written: so there is memory for one of the two alone, as long as the page is
 * expected to be. A client that could write there meanwhile would make the
 * engine read what it has not found. [compute] */
static void lend_page(const struct srv_request *request, struct eng_question *settings)
{
    const struct srv_scene *scene = request->plan.scene;
    uint32_t record_bytes =
        scene->stepped.answer.record_bytes; /* 0: there was no step yet */
    if (request->session->service->lends_pages &&
        scene->expected * record_bytes >= LENT_BYTES_MIN) {
        settings->lent = srv_ring_next(request->plan.ring, record_bytes, scene->expected,
                                       &settings->lent_bytes);
    }
}

/* Run the staged step and keep its result in the scene. [compute] */
static int compute_step(struct srv_request *request)
{
    struct srv_scene *scene = request->plan.scene;
    struct eng_question settings = settings_of(request);
    lend_page(request, &settings);
    const struct srv_stepper by = {request->session->id,
                                   request->params.FRAME_SUBMIT.step,
                                   request->params.FRAME_SUBMIT.place};
    struct eng_step_result step;
    atomic_store_explicit(&request->job.end_ns, settings.deadline_ns,
                          memory_order_relaxed);
    settings.trace = srv_tracing_lend();
    int status = srv_frame_compute(scene, &settings, &by, &step, &request->error);
    srv_tracing_return(settings.trace);
    if (status == PCCD_E_AGAIN) {
        srv_request_move(request, SRV_REQUEST_MOVED);
        request->job.goes_on = true;
        return 0;
    }
    if (status != 0) {
        return status;
    }
    request->has_stepped = true;
    request->last_step = srv_laststep_of(&request->session->service->spare_step, &step);
    if (by.places) { /* many scenes may be brought back, and not all be stepped soon */
        eng_step_tidy(scene->engine);
    }
    return 0;
}

/* What the engine has already; nothing of it if something went wrong. [compute] */
static int stage_lent(struct srv_request *request, int status)
{
    struct srv_scene *scene = request->plan.scene;
    for (uint32_t i = 0; scene->has_lent && i < scene->placed_count; i++) {
        struct srv_placed *placed = &scene->placed[i];
        if (placed->handle == 0 || placed->lent == SRV_LENT_NOTHING) {
            continue;
        }
        if (status == 0) {
            status = eng_stage_lent(scene->engine, placed->engine_idx,
                                    placed->lent == SRV_LENT_X0X1);
            status = status == 0
                         ? 0
                         : proto_error_set(&request->error, status, "object 0x%x: %s",
                                           placed->handle, proto_status_text(status));
        } else {
            eng_stage_forget(scene->engine, placed->engine_idx);
        }
        placed->lent = SRV_LENT_NOTHING;
    }
    scene->has_lent = false;
    return status;
}

/* Stage what others hold for this step, and what the step itself moves, out of its slot
 * or of the copy of it. [compute] */
static int stage(struct srv_request *request, struct eng_scene *engine)
{
    struct srv_scene *scene = request->plan.scene;
    bool places = request->params.FRAME_SUBMIT.place;
    srv_shared_hide(scene);
    if (!places) {
        srv_held_check(scene, &request->taken);
    }
    srv_stepping_open(request, engine);
    int status = places ? 0 : srv_held_stage(scene, &request->error);
    if (status != 0) {
        srv_request_return_slot(request);
        return status;
    }
    status = srv_stepping_stage(request);
    return scene->has_lent ? stage_lent(request, status) : status;
}

/* One that goes on was staged before. [compute] */
static int stage_and_step(struct srv_request *request, struct eng_scene *engine)
{
    int status = has_moved(request) ? 0 : stage(request, engine);
    if (status == 0) {
        status = compute_step(request);
    }
    if (status != 0) {
        eng_stage_abort(engine);
        return status;
    }
    if (request->job.goes_on) {
        return 0;
    }
    if (!request->params.FRAME_SUBMIT.place) { /* nothing went along */
        srv_held_take(request->plan.scene, &request->taken);
    }
    srv_journal_step(request->plan.scene, &request->params.FRAME_SUBMIT,
                     request->plan.member, request->taken);
    return 0;
}

/* A step that was answered before its turn: it only moves what it moves. What goes wrong
 * is what the session's next step of the scene is answered. [compute] */
static int move_early(struct srv_request *request)
{
    struct srv_scene *scene = request->plan.scene;
    struct eng_scene *engine = NULL;
    int status = srv_scene_engine(scene, &engine);
    if (status != 0) {
        status = proto_error_set(&request->error, status, "no memory for the scene");
    } else {
        status = stage_and_step(request, engine);
    }
    if (status != 0) {
        *srv_stepping_owed(request) = request->error;
        return status;
    }
    request->result.answer = scene->stepped.answer;
    return 0;
}

/* [compute] */
static int work_submit(struct srv_request *request)
{
    struct srv_scene *scene = request->plan.scene;
    struct eng_scene *engine = NULL;
    uint64_t start_ns = common_now_ns();
    if (!has_moved(request)) {
        request->begin_ns = start_ns;
    }
    if (srv_request_state(request) == SRV_REQUEST_EARLY) {
        return move_early(request);
    }
    int status = has_moved(request) ? 0 : srv_stepping_begin(request);
    if (status != 0) {
        return status;
    }
    status = srv_scene_engine(scene, &engine);
    if (status != 0) {
        return proto_error_set(&request->error, status, "no memory for the scene");
    }
    status = stage_and_step(request, engine);
    if (status != 0 || request->job.goes_on) {
        return status;
    }
    struct proto_answer *answer = &request->result.answer;
    uint64_t copy_ns = common_now_ns();
    status = srv_answer_page(request, &scene->stepped, 0, answer);
    uint64_t end_ns = common_now_ns();
    answer->ns_queue = start_ns - request->arrival_ns;
    answer->ns_merge += end_ns - copy_ns;
    answer->ns_step += end_ns - copy_ns;
    return status;
}

void srv_frame_nothing(const struct proto_FRAME_SUBMIT_request *submit,
                       enum pccd_incomplete why, struct proto_answer *answer)
{
    struct eng_question settings = ENG_QUESTION_DEFAULT;
    struct eng_step_result nothing;
    char text[ENG_TUNING_WHY_BYTES];
    int status = eng_tuning_read(submit->tuning, &settings.tuning, text);
    PCCD_ASSERT(status == PCCD_OK); /* it was checked */
    settings.mode = (enum pccd_mode)submit->mode;
    settings.method = (enum pccd_method)submit->method;
    eng_step_nothing(&settings, &nothing);
    describe(&nothing, answer);
    answer->incomplete = why;
    answer->step = submit->step;
}

/* Each is a write to all vertices of an object, at most. */
#define BRIEF_SEGMENTS 4u

/* A scene that others share is not: who takes part leaves, and hears of steps, in lists
 * that may be long. [loop] while nothing is computed */
static bool can_be_brief(struct srv_request *request)
{
    const struct srv_scene *scene = request->plan.scene;
    if (scene->shared != NULL || scene->engine == NULL ||
        request->params.FRAME_SUBMIT.segments > BRIEF_SEGMENTS) {
        return false;
    }
    struct eng_question settings = settings_of(request);
    return eng_step_can_be_brief(scene->engine, &settings,
                                 request->params.FRAME_SUBMIT.segments > 0);
}

/* It is to end, and others are still before it: the answer is known. [loop] */
static void answer_submit_early(struct srv_request *request, enum pccd_incomplete why)
{
    struct proto_answer answer;
    srv_frame_nothing(&request->params.FRAME_SUBMIT, why, &answer);
    answer.ns_queue = common_now_ns() - request->arrival_ns;
    srv_stepping_answer_early(request, &answer, &answer.release);
}

/* Count the step where list.session and list.scene look. [loop] */
static void tell_step(const struct srv_request *request, uint64_t number)
{
    const struct proto_answer *answer = &request->result.answer;
    struct proto_LIST_SESSION_result *session = &request->session->told;
    struct proto_LIST_SCENE_result *scene = &request->plan.scene->told;
    session->steps++;
    session->steps_incomplete += answer->incomplete != PCCD_COMPLETE;
    session->contacts += answer->mode == PCCD_MODE_PAIRS ? 0 : answer->total;
    session->upload_bytes += request->upload_bytes;
    session->result_bytes += answer->count * answer->record_bytes;
    session->ns_queue += answer->ns_queue;
    session->ns_ingest += answer->ns_ingest;
    session->ns_refit += answer->ns_refit;
    session->ns_traversal += answer->ns_traversal;
    session->ns_tests += answer->ns_tests;
    session->ns_merge += answer->ns_merge;
    session->ns_step += answer->ns_step;
    scene->steps++;
    scene->number = number;
    scene->total = answer->total;
    scene->hash_hi = answer->hash_hi;
    scene->hash_lo = answer->hash_lo;
    scene->ns_step = answer->ns_step;
}

/* What those who watch are told of a step. */
static struct proto_STEP_request describe_to_watchers(const struct srv_request *request,
                                                      uint64_t number)
{
    const struct proto_answer *answer = &request->result.answer;
    struct proto_STEP_request step = {
        .number = number,
        .session = request->session->id,
        .scene = request->params.FRAME_SUBMIT.scene,
        .step = request->params.FRAME_SUBMIT.step,
        .code = (uint32_t)-request->status,
        .mode = request->params.FRAME_SUBMIT.mode,
    };
    if (request->status == 0) {
        step.incomplete = answer->incomplete;
        step.verdict = answer->verdict;
        step.threads = answer->threads;
        step.total = answer->total;
        step.hash_hi = answer->hash_hi;
        step.hash_lo = answer->hash_lo;
        step.ns_queue = answer->ns_queue;
        step.ns_step = answer->ns_step;
    }
    return step;
}

static void finish_submit(struct srv_request *request)
{
    struct srv_service *service = request->session->service;
    struct srv_laststep *last = request->last_step;
    uint64_t number = 0;
    srv_holding_answer(request->taken, &request->result.answer);
    request->taken = NULL;
    if (request->status == 0 || last != NULL) {
        number = ++service->step_last;
    }
    if (request->status == 0) {
        srv_metrics_add_step(&service->metrics, &request->result.answer);
        tell_step(request, number);
    }
    if ((request->status == 0 || request->has_stepped) &&
        request->plan.scene->shared != NULL && !request->params.FRAME_SUBMIT.place) {
        srv_shared_stepped(request->plan.scene, request->session,
                           &request->result.answer);
    }
    if (last != NULL) {
        last->answer = request->result.answer;
        last->number = number;
        srv_laststep_set(&service->spare_step, &request->session->last_step, last);
        srv_laststep_set(&service->spare_step, &service->last_step, last);
    }
    if (service->monitors != NULL) {
        const struct proto_STEP_request step =
            describe_to_watchers(request, request->status == 0 ? number : 0);
        srv_watcher_step(service, &step);
    }
}

int srv_frame_check(struct srv_call *call, const struct srv_wanted *wanted)
{
    const struct srv_choice mode = {"mode", wanted->mode, PCCD_MODE_COUNT};
    int status = srv_stepping_choose(call, &mode, 1);
    if (status != 0) {
        return status;
    }
    /* Written so that NaN is refused. */
    if (wanted->tolerance != 0.0 &&
        !(wanted->tolerance >= TOLERANCE_MIN && wanted->tolerance <= TOLERANCE_MAX)) {
        return proto_error_set(&call->error, PCCD_E_INVAL,
                               "tolerance is %g, not 0 or %g to %g", wanted->tolerance,
                               TOLERANCE_MIN, TOLERANCE_MAX);
    }
    if (!(wanted->approach >= 0.0 && wanted->approach < 1.0)) {
        return proto_error_set(&call->error, PCCD_E_INVAL,
                               "approach is %g, not 0 or between 0 and 1",
                               wanted->approach);
    }
    return srv_check_length(call, "separation", wanted->separation);
}

struct eng_question srv_frame_settings(struct srv_request *request,
                                       const struct srv_wanted *wanted)
{
    struct eng_question settings = srv_stepping_settings(request);
    settings.mode = (enum pccd_mode)wanted->mode;
    settings.tolerance = wanted->tolerance == 0.0 ? TOLERANCE_DEFAULT : wanted->tolerance;
    settings.distance = wanted->separation;
    settings.approach = wanted->approach;
    return settings;
}

int srv_on_FRAME_SUBMIT(struct srv_call *call)
{
    struct srv_session *session = call->session;
    const struct proto_FRAME_SUBMIT_request *submit = &call->params.FRAME_SUBMIT;
    struct srv_scene *scene = srv_handles_get(&session->scenes, submit->scene);
    if (scene == NULL) {
        return proto_error_set(&call->error, PCCD_E_HANDLE, "there is no scene 0x%x",
                               submit->scene);
    }
    const struct srv_asked asked = srv_asked_of(call->method, &call->params);
    struct srv_ring *ring = NULL;
    int status = srv_stepping_check(call, &asked, &ring);
    if (status == 0) {
        status = srv_frame_check(call, &SRV_WANTED_OF(submit));
    }
    if (status == 0) {
        status = srv_shared_refuse_reader(session, scene, &call->error);
    }
    if (status != 0) {
        return status;
    }
    struct srv_plan plan = {
        .work = work_submit,
        .finish = finish_submit,
        .ring = ring,
        .scene = scene,
        .member = srv_shared_member(scene, session),
        .takes_slot = submit->segments > 0,
        .answer_early = answer_submit_early,
        .can_be_brief = submit->hold ? NULL : can_be_brief,
        .replies = !submit->hold && scene->shared == NULL,
        .deadline_ns = srv_stepping_deadline(submit->deadline_ns, call->arrival_ns)};
    return submit->hold ? srv_holding_start(call, &plan) : srv_request_start(call, &plan);
}
