/* hold.c - requests that wait for the step of another session. */
#include "hold.h"

#include <stdlib.h>

#include "held.h"
#include "invariant.h"
#include "now.h"
#include "service.h"
#include "session.h"
#include "shared.h"
#include "srv_step.h"

/* ---- the end of waiting ------------------------------------------------------------ */

/* Leave out the page of what moves along and is answered without records of its own:
 * frame.fetch has them. */
static void leave_out_page(const struct srv_request *request, struct proto_answer *answer)
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
    request->plan.member->held_step = 0;
}

/* It ends before a step has taken it along. */
static void say_nothing_yet(struct srv_request *request, enum pccd_incomplete why)
{
    struct proto_answer *answer = &request->result.answer;
    srv_step_nothing(request, why, answer);
    leave_out_page(request, answer);
    part(request);
}

/* Return whether a request that has run goes on to wait. If its deadline has come, or it
 * was cancelled, or its client is gone, or the daemon ends: no, and its result says so.
 */
static bool waits(struct srv_request *request)
{
    srv_assert_loop();
    if (request->held == NULL) {
        return false;
    }
    if (request->session->state == SRV_SESSION_CLOSED ||
        request->session->service->phase != SRV_PHASE_RUNNING ||
        atomic_load_explicit(&request->job.cancel, memory_order_relaxed)) {
        say_nothing_yet(request, PCCD_INCOMPLETE_CANCELLED);
    } else if (request->deadline.at_ns != 0 &&
               common_now_ns() >= request->deadline.at_ns) {
        say_nothing_yet(request, PCCD_INCOMPLETE_DEADLINE);
    } else {
        srv_request_move(request, SRV_REQUEST_WAITING);
        srv_shared_waits(request->plan.member, request->params.FRAME_SUBMIT.step);
    }
    return srv_request_state(request) == SRV_REQUEST_WAITING;
}

static void stop_waiting(struct srv_request *request, enum pccd_incomplete why)
{
    srv_assert_loop();
    PCCD_ASSERT(srv_request_state(request) == SRV_REQUEST_WAITING);
    say_nothing_yet(request, why);
    srv_request_conclude(request);
}

/* Its session leaves the scene. */
static void cancel(struct srv_request *request)
{
    stop_waiting(request, PCCD_INCOMPLETE_CANCELLED);
}

void srv_hold_answer(struct srv_held_frame *taken, const struct proto_answer *step)
{
    srv_assert_loop();
    for (struct srv_held_frame *held = taken; held != NULL; held = held->next) {
        struct srv_request *waiting = held->request;
        if (waiting == NULL) {
            continue;
        }
        waiting->status = held->error.code;
        waiting->error = held->error;
        if (waiting->status == 0) {
            waiting->result.answer = *step;
            leave_out_page(waiting, &waiting->result.answer);
        }
        part(waiting);
        srv_request_conclude(waiting);
    }
    srv_held_frame_free(taken);
}

void srv_hold_end_all(struct srv_service *service)
{
    srv_assert_loop();
    for (struct srv_session *session = service->sessions; session != NULL;
         session = session->next) {
        for (struct srv_request *request = session->requests; request != NULL;) {
            struct srv_request *next = request->next;
            if (srv_request_state(request) == SRV_REQUEST_WAITING) {
                stop_waiting(request, PCCD_INCOMPLETE_CANCELLED);
            }
            request = next;
        }
    }
}

/* ---- the beginning ----------------------------------------------------------------- */

/* Charges plan->held_bytes. */
static int admit(struct srv_call *call, struct srv_plan *plan)
{
    uint64_t bytes = plan->ring->slot_stride;
    if (plan->member == NULL) {
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
    if (call->params.FRAME_SUBMIT.tells_start) {
        return proto_error_set(&call->error, PCCD_E_INVAL,
                               "tells_start: another step answers a frame that is held");
    }
    if (plan->member->holds) {
        return proto_error_set(&call->error, PCCD_E_BUSY,
                               "the frame held before waits for a step of the scene");
    }
    int status = srv_held_frame_charge(plan->member, bytes, &call->error);
    if (status == 0) {
        plan->held_bytes = bytes;
    }
    return status;
}

/* [compute] */
static int work_hold(struct srv_request *request)
{
    const struct proto_FRAME_SUBMIT_request *submit = &request->params.FRAME_SUBMIT;
    struct srv_held_frame *held = calloc(1, sizeof *held);
    if (held == NULL) {
        return proto_error_set(&request->error, PCCD_E_NOMEM, "no memory to hold it");
    }
    *held = (struct srv_held_frame){.request = request,
                                    .left = cancel,
                                    .member = request->plan.member,
                                    .submit = *submit,
                                    .charge = request->plan.held_bytes};
    int status = srv_stage_keep(request->plan.ring, &SRV_SLOT_OF(submit),
                                request->plan.ring->slot_stride, &held->copy,
                                &held->bytes, &request->error);
    srv_request_return_slot(request);
    if (status == 0) {
        status = srv_held_frame_add(held, request->plan.scene, &request->error);
    }
    if (status != 0) {
        free(held->copy);
        free(held);
        return status;
    }
    request->upload_bytes = held->bytes;
    request->held = held;
    request->plan.held_bytes = 0; /* are the frame's from now on */
    return 0;
}

static void finish_hold(struct srv_request *request)
{
    if (request->plan.held_bytes > 0) {
        srv_held_frame_refund(request->plan.member, request->plan.held_bytes);
    }
}

int srv_hold_start(struct srv_call *call, struct srv_plan *plan)
{
    srv_assert_loop();
    plan->work = work_hold;
    plan->finish = finish_hold;
    plan->waits = waits;
    plan->stop_waiting = stop_waiting;
    plan->answer_early = NULL; /* it is copied in its turn */
    int status = admit(call, plan);
    if (status != 0) {
        return status;
    }
    status = srv_request_start(call, plan);
    if (status < 0) {
        srv_held_frame_refund(plan->member, plan->held_bytes);
    }
    return status;
}
