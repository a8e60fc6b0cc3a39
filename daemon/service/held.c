/* held.c - frames that wait for the step of another session.
 *
 * Room:     service. See held.h.
 * Does:     what is held was staged once when it came, and taken back: so that a step by
 *           somebody else does not fail for it.
 * Threads:  as marked in held.h.
 */
#include "held.h"

#include <stdlib.h>

#include "frame.h"
#include "invariant.h"
#include "loop.h"
#include "now.h"
#include "ringio.h"
#include "session.h"
#include "shared.h"

/* ---- on the way in ----------------------------------------------------------------- */

/* Charges plan->held_bytes. */
static int admit(struct srv_call *call, struct srv_plan *plan)
{
    struct srv_session *session = call->session;
    uint64_t bytes = plan->ring->slot_stride;
    if (plan->seat == NULL) {
        return proto_error_set(&call->error, PCCD_E_INVAL,
                               "only a frame of a shared scene can be held");
    }
    if (call->params.FRAME_SUBMIT.segments == 0) {
        return proto_error_set(&call->error, PCCD_E_INVAL,
                               "a frame that moves nothing cannot be held");
    }
    if (call->params.FRAME_SUBMIT.place) {
        return proto_error_set(&call->error, PCCD_E_INVAL,
                               "a frame is held, or placed, not both");
    }
    if (plan->seat->holds) {
        return proto_error_set(&call->error, PCCD_E_BUSY,
                               "the frame held before waits for a step of the scene");
    }
    int status = srv_quota_charge(&session->loop->quota, session->user,
                                  SRV_QUOTA_SHM_BYTES, bytes, &call->error);
    if (status == 0) {
        plan->seat->holds = true;
        plan->held_bytes = bytes;
    }
    return status;
}

static void refund(struct srv_seat *seat, uint64_t bytes)
{
    struct srv_session *session = seat->session;
    srv_quota_refund(&session->loop->quota, session->user, SRV_QUOTA_SHM_BYTES, bytes);
    seat->holds = false;
}

/* [compute] */
static struct proto_segment *table_of(const struct srv_held *held)
{
    return srv_desk_of_thread(held->seat->session->loop->desks)->segments;
}

/* Whether the scene takes it as it is now; nothing moves. [compute] */
static int try(struct srv_held *held, struct srv_scene *scene, struct proto_error *error)
{
    struct eng_scene *engine = NULL;
    uint64_t bytes = 0;
    int status = srv_scene_engine(scene, &engine);
    if (status != 0) {
        return proto_error_set(error, status, "no memory for the scene");
    }
    eng_stage_begin(engine);
    status = srv_ring_stage_copy(held->copy, held->bytes, &held->submit, held->seat,
                                 scene, table_of(held), &bytes, error);
    if (status == 0 && eng_stage_overlaps(engine)) {
        status = proto_error_set(error, PCCD_E_SEGMENT,
                                 "a vertex is written twice in this step");
    }
    eng_stage_abort(engine);
    held->changes = scene->changes;
    return status;
}

/* [compute] */
static int work_hold(struct srv_request *request)
{
    const struct proto_FRAME_SUBMIT_request *submit = &request->params.FRAME_SUBMIT;
    struct srv_scene *scene = request->plan.scene;
    struct srv_held *held = calloc(1, sizeof *held);
    if (held == NULL) {
        return proto_error_set(&request->error, PCCD_E_NOMEM, "no memory to hold it");
    }
    *held = (struct srv_held){.request = request,
                              .seat = request->plan.seat,
                              .submit = *submit,
                              .charge = request->plan.held_bytes};
    int status =
        srv_ring_copy_slot(request->plan.ring, submit, request->plan.ring->slot_stride,
                           &held->copy, &held->bytes, &request->error);
    srv_request_return_slot(request);
    if (status == 0) {
        status = try(held, scene, &request->error);
    }
    if (status != 0) {
        free(held->copy);
        free(held);
        return status;
    }
    request->upload_bytes = held->bytes;
    struct srv_held **end = &scene->held;
    while (*end != NULL) {
        end = &(*end)->next;
    }
    *end = held;
    request->held = held;
    request->plan.held_bytes = 0; /* are the frame's from now on */
    return 0;
}

static void finish_hold(struct srv_request *request)
{
    if (request->plan.held_bytes > 0) {
        refund(request->plan.seat, request->plan.held_bytes);
    }
}

int srv_held_start(struct srv_call *call, struct srv_plan *plan)
{
    srv_assert_loop();
    plan->work = work_hold;
    plan->finish = finish_hold;
    plan->answer_early = NULL; /* it is copied in its turn */
    int status = admit(call, plan);
    if (status != 0) {
        return status;
    }
    status = srv_request_start(call, plan);
    if (status < 0) {
        refund(plan->seat, plan->held_bytes);
    }
    return status;
}

/* ---- with a step ------------------------------------------------------------------- */

/* Move the entry at *at to the request. */
static void take(struct srv_request *request, struct srv_held **at)
{
    struct srv_held *held = *at;
    *at = held->next;
    held->next = request->taken;
    request->taken = held;
}

void srv_held_check(struct srv_request *request)
{
    struct srv_scene *scene = request->plan.scene;
    for (struct srv_held **at = &scene->held; *at != NULL;) {
        struct srv_held *held = *at;
        if (held->changes != scene->changes && try(held, scene, &held->error) != 0) {
            take(request, at);
        } else {
            at = &held->next;
        }
    }
}

int srv_held_stage(struct srv_request *request)
{
    struct srv_scene *scene = request->plan.scene;
    int status = 0;
    for (struct srv_held *held = scene->held; held != NULL && status == 0;
         held = held->next) {
        uint64_t bytes = 0;
        status = srv_ring_stage_copy(held->copy, held->bytes, &held->submit, held->seat,
                                     scene, table_of(held), &bytes, &request->error);
    }
    return status;
}

void srv_held_take(struct srv_request *request)
{
    while (!request->params.FRAME_SUBMIT.place && request->plan.scene->held != NULL) {
        take(request, &request->plan.scene->held);
    }
}

struct srv_held *srv_held_remove(struct srv_scene *scene, const struct srv_seat *seat)
{
    srv_assert_compute();
    struct srv_held *removed = NULL;
    for (struct srv_held **at = &scene->held; *at != NULL;) {
        struct srv_held *held = *at;
        if (held->seat == seat) {
            *at = held->next;
            held->next = removed;
            removed = held;
        } else {
            at = &held->next;
        }
    }
    return removed;
}

/* ---- on the way out ---------------------------------------------------------------- */

void srv_held_free(struct srv_held *list)
{
    srv_assert_loop();
    while (list != NULL) {
        struct srv_held *next = list->next;
        if (list->request != NULL) { /* its session leaves the scene */
            srv_held_end(list->request, PCCD_INCOMPLETE_CANCELLED);
        }
        refund(list->seat, list->charge);
        free(list->copy);
        free(list);
        list = next;
    }
}

/* What moves along and is answered without records of its own: frame.fetch has them. */
static void leave_out_page(const struct srv_request *request,
                           struct proto_FRAME_SUBMIT_result *answer)
{
    answer->step = request->params.FRAME_SUBMIT.step;
    answer->first = 0;
    answer->count = 0;
    answer->cursor = 0;
    answer->offset = 0;
    answer->release = /* storing it changes nothing */
        atomic_load_explicit(&request->plan.ring->shared->result_head.value,
                             memory_order_relaxed);
    if (answer->total > 0 && answer->incomplete == PCCD_COMPLETE) {
        answer->incomplete = PCCD_INCOMPLETE_RESULT_FULL;
    }
}

/* The request and the frame know of each other no more. */
static void part(struct srv_request *request)
{
    request->held->request = NULL;
    request->held = NULL;
    request->plan.seat->held_step = 0;
    request->is_waiting = false;
}

void srv_held_answer(struct srv_request *request)
{
    srv_assert_loop();
    for (struct srv_held *held = request->taken; held != NULL; held = held->next) {
        struct srv_request *waiting = held->request;
        if (waiting == NULL) {
            continue;
        }
        waiting->status = held->error.code;
        waiting->error = held->error;
        if (waiting->status == 0) {
            waiting->result.FRAME_SUBMIT = request->result.FRAME_SUBMIT;
            leave_out_page(waiting, &waiting->result.FRAME_SUBMIT);
        }
        part(waiting);
        srv_request_conclude(waiting);
    }
    srv_held_free(request->taken);
    request->taken = NULL;
}

/* It ends before a step has taken it along. */
static void say_nothing_yet(struct srv_request *request, enum pccd_incomplete why)
{
    struct proto_FRAME_SUBMIT_result *answer = &request->result.FRAME_SUBMIT;
    srv_frame_nothing(&request->params.FRAME_SUBMIT, why, answer);
    leave_out_page(request, answer);
    part(request);
}

bool srv_held_waits(struct srv_request *request)
{
    srv_assert_loop();
    if (request->held == NULL) {
        return false;
    }
    if (request->session->state == SRV_SESSION_CLOSED ||
        request->session->loop->phase != SRV_PHASE_RUNNING ||
        atomic_load_explicit(&request->job.cancel, memory_order_relaxed)) {
        say_nothing_yet(request, PCCD_INCOMPLETE_CANCELLED);
    } else if (request->deadline_ns != 0 && srv_now_ns() >= request->deadline_ns) {
        say_nothing_yet(request, PCCD_INCOMPLETE_DEADLINE);
    } else {
        request->is_waiting = true;
        srv_shared_waits(request->plan.seat, request->params.FRAME_SUBMIT.step);
    }
    return request->is_waiting;
}

void srv_held_end(struct srv_request *request, enum pccd_incomplete why)
{
    srv_assert_loop();
    PCCD_ASSERT(request->is_waiting);
    say_nothing_yet(request, why);
    srv_request_conclude(request);
}

void srv_held_end_all(struct srv_loop *loop)
{
    srv_assert_loop();
    for (struct srv_session *session = loop->sessions; session != NULL;
         session = session->next) {
        for (struct srv_request *request = session->requests; request != NULL;) {
            struct srv_request *next = request->next;
            if (request->is_waiting) {
                srv_held_end(request, PCCD_INCOMPLETE_CANCELLED);
            }
            request = next;
        }
    }
}
