/* request.c - a request on its way through the compute thread.
 *
 * Room:     service. See request.h.
 * Does:     create, run, answer and free requests; each is answered exactly once.
 * Does not: keep any longer than its client asked: at most SRV_REQUESTS_MAX per session.
 * Threads:  [loop], but for `run` and srv_request_return_slot.
 */
#include "request.h"

#include <sched.h>
#include <stdlib.h>
#include <string.h>

#include "crashnote.h"
#include "dispatch.h"
#include "enginemem.h"
#include "held.h"
#include "invariant.h"
#include "linger.h"
#include "loop.h"
#include "meshes.h"
#include "now.h"
#include "overdue.h"
#include "session.h"

#define SPARES_MAX 4u /* of a session */

int srv_request_ring(struct srv_call *call, struct srv_ring **ring)
{
    if (call->session->attaching) {
        return proto_error_set(&call->error, PCCD_E_STATE, "shm.attach is not done yet");
    }
    if (call->session->ring == NULL) {
        return proto_error_set(&call->error, PCCD_E_STATE, "%s needs shm.attach first",
                               proto_messages[call->method].name);
    }
    *ring = call->session->ring;
    return 0;
}

int srv_request_slot(struct srv_call *call, const struct srv_ring *ring, uint32_t slot,
                     uint64_t seq)
{
    if (slot >= ring->slot_count) {
        return proto_error_set(&call->error, PCCD_E_INVAL, "slot is %u, the ring has %u",
                               slot, ring->slot_count);
    }
    if (seq == 0 || seq % 2 != 0) {
        return proto_error_set(&call->error, PCCD_E_INVAL,
                               "seq is %llu, a written slot has an even one from 2 on",
                               (unsigned long long)seq);
    }
    return 0;
}

void srv_request_return_slot(struct srv_request *request)
{
    if (request->plan.takes_slot) {
        request->plan.takes_slot = false;
        srv_ring_return_slot(request->plan.ring);
    }
}

/* The answer is known: give back what the ring lent. [any], but one at a time. */
static void conclude(struct srv_request *request)
{
    srv_request_return_slot(request);
    if (request->plan.ring != NULL && !request->is_answered) {
        srv_ring_done(request->plan.ring);
    }
}

/* Answers of what a session has computed keep its order, as pages of the result region go
 * back in that in which they came: not while the loop is to send an earlier one. */
static bool may_reply(const struct srv_request *request)
{
    return request->outlet != NULL && request->status == 0 && !request->is_answered &&
           !request->is_brief && request->taken == NULL &&
           atomic_load(&request->session->owed_count) == 0;
}

/* Waking the loop for it is 25 us where processors sleep. What goes wrong, or cannot be
 * sent now, or belongs to others as well, is the loop's. [compute] */
static void reply(struct srv_request *request)
{
    struct srv_loop *loop = request->session->loop;
    struct proto_encoder *encoder = srv_desk_of_thread(loop->desks)->encoder;
    if (may_reply(request)) {
        int status =
            proto_encode_result(encoder, request->id, request->method, &request->result);
        PCCD_ASSERT(status == 0);
        request->has_tried = true;
        /* Pairs with the loop's load before it handles what a client has sent: that
         * client may have this answer. */
        atomic_fetch_add(&loop->replies_tried, 1);
        request->is_replied = srv_outlet_send(request->outlet, encoder) == 0;
        request->replied_ns = srv_now_ns();
    }
    if (!request->is_replied) {
        request->is_owed = true;
        atomic_fetch_add(&request->session->owed_count, 1);
    }
}

static bool is_behind(const struct srv_loop *loop)
{
    return atomic_load(&loop->replies_tried) != loop->replies_done;
}

void srv_request_catch_up(struct srv_loop *loop)
{
    srv_assert_loop();
    while (is_behind(loop)) {
        if (srv_compute_drain(&loop->compute) == 0) {
            sched_yield(); /* it may have lost its processor to this thread */
        }
    }
}

/* A ring is made on a thread of its own, beside what is computed: nothing in its session
 * is in flight, and nothing of the engine is touched. [pages] */
static void run_pages(struct srv_job *job)
{
    struct srv_request *request = (struct srv_request *)job;
    request->status = request->plan.work(request);
    PCCD_ASSERT(request->status == 0 || request->error.code == request->status);
    conclude(request);
}

/* [compute] */
static void run(struct srv_job *job)
{
    struct srv_request *request = (struct srv_request *)job;
    srv_assert_compute();
    srv_crash_note(proto_messages[request->method].name, request->session->id,
                   request->id);
    struct srv_enginemem memory;
    const struct srv_scene *scene = request->plan.scene; /* may be another user's */
    srv_enginemem_begin(
        &memory, scene != NULL ? scene->resource.session->user : request->session->user,
        request->session->loop->options->engine_bytes_max);
    request->status =
        srv_enginemem_explain(&memory, request->plan.work(request), &request->error);
    srv_crash_note(NULL, 0, 0);
    PCCD_ASSERT(request->status == 0 || request->error.code == request->status);
    PCCD_ASSERT(request->status == 0 || !job->goes_on);
    if (!job->goes_on) {
        conclude(request);
        reply(request);
    }
}

static void acquire(const struct srv_plan *plan)
{
    if (plan->ring != NULL) {
        srv_resource_acquire(&plan->ring->resource);
    }
    if (plan->shape != NULL) {
        srv_resource_acquire(&plan->shape->resource);
    }
    if (plan->scene !=
        NULL) { /* list.pair's may be another session's, which then stays */
        srv_resource_acquire(&plan->scene->resource);
        plan->scene->resource.session->reap_count++;
    }
    if (plan->tracing != NULL) {
        srv_resource_acquire(&plan->tracing->resource);
    }
}

static void release(const struct srv_plan *plan)
{
    if (plan->ring != NULL) {
        srv_resource_drop(&plan->ring->resource);
    }
    if (plan->shape != NULL) {
        srv_resource_drop(&plan->shape->resource);
    }
    if (plan->scene != NULL) {
        struct srv_session *owner = plan->scene->resource.session;
        srv_resource_drop(&plan->scene->resource);
        srv_session_reaped(owner);
    }
    if (plan->tracing != NULL) {
        srv_resource_drop(&plan->tracing->resource);
    }
}

static void drop_copy(struct srv_request *request)
{
    struct srv_session *session = request->session;
    if (request->copy != NULL) {
        srv_quota_refund(&session->loop->quota, session->user, SRV_QUOTA_SHM_BYTES,
                         request->copy_bytes);
        free(request->copy);
        request->copy = NULL;
    }
}

/* What a session has freed last it needs again with its next step: it asks the heap for
 * nothing then. */
static struct srv_request *take_memory(struct srv_session *session)
{
    struct srv_request *request = session->spare_requests;
    if (request == NULL) {
        return calloc(1, sizeof *request);
    }
    session->spare_requests = request->next;
    session->spare_count--;
    memset(request, 0, sizeof *request);
    return request;
}

static void give_memory(struct srv_session *session, struct srv_request *request)
{
    if (session->state == SRV_SESSION_CLOSED || session->spare_count >= SPARES_MAX) {
        free(request);
        return;
    }
    request->next = session->spare_requests;
    session->spare_requests = request;
    session->spare_count++;
}

void srv_request_free_spares(struct srv_session *session)
{
    while (session->spare_requests != NULL) {
        struct srv_request *request = session->spare_requests;
        session->spare_requests = request->next;
        session->spare_count--;
        free(request);
    }
}

void srv_request_conclude(struct srv_request *request)
{
    struct srv_session *session = request->session;
    srv_assert_loop();
    srv_overdue_remove(&session->loop->overdue, request);
    if (request->plan.finish != NULL) {
        request->plan.finish(request);
    }
    session->loop->metrics.counters.upload_bytes += request->upload_bytes;
    if (request->status == PCCD_E_QUOTA && session->state == SRV_SESSION_OPEN) {
        (void)srv_linger_evict(session->loop, session->user); /* for the next try */
    }
    if (!request->is_answered) {
        srv_dispatch_answer(session, request);
    }
    session->loop->replies_done += request->has_tried;
    session->loop->metrics.counters.steps_replied += request->is_replied;
    if (request->is_owed) {
        atomic_fetch_sub(&session->owed_count, 1);
    }
    if (request->outlet != NULL) {
        srv_outlet_drop(request->outlet);
    }
    drop_copy(request);
    release(&request->plan);
    srv_session_unlist(session, request);
    give_memory(session, request);
    srv_session_settle(session);
}

/* [loop] */
static void done(struct srv_job *job)
{
    struct srv_request *request = (struct srv_request *)job;
    if (!srv_held_waits(request)) {
        srv_request_conclude(request);
    }
}

static int enqueue(struct srv_request *request)
{
    struct srv_session *session = request->session;
    return request->plan.attached != NULL
               ? srv_compute_push(&session->loop->pages, &session->page_lane,
                                  &request->job)
               : srv_compute_push(&session->loop->compute, &session->lane, &request->job);
}

/* False: it runs, or has run. */
static bool dequeue(struct srv_request *request)
{
    struct srv_loop *loop = request->session->loop;
    return srv_compute_remove(
        request->plan.attached != NULL ? &loop->pages : &loop->compute, &request->job);
}

/* The loop does what is brief itself when the compute thread sleeps: waking it, and being
 * woken by it, is 60 us where processors sleep, ten times such a step. Between two of
 * them it has as long for others, so that many who ask for little are served by the two
 * threads as if there were no brief steps. */
#define BREAK_NS_MAX 100000u /* after one that lost its processor */

/* Run a request that is brief, if it can be now: it has been answered then, or goes on in
 * its lane. False: nothing was done. */
static bool run_here(struct srv_request *request)
{
    struct srv_session *session = request->session;
    struct srv_loop *loop = session->loop;
    uint64_t begin_ns = srv_now_ns();
    if (!loop->does_brief || request->plan.can_be_brief == NULL ||
        begin_ns < loop->brief_from_ns || !srv_compute_is_idle(&loop->compute) ||
        !request->plan.can_be_brief(request)) {
        return false;
    }
    request->is_brief = true;
    srv_thread_enter(SRV_THREAD_COMPUTE);
    run(&request->job);
    srv_thread_enter(SRV_THREAD_LOOP);
    request->is_brief = false;
    uint64_t end_ns = srv_now_ns();
    uint64_t break_ns = end_ns - begin_ns;
    loop->brief_from_ns = end_ns + (break_ns < BREAK_NS_MAX ? break_ns : BREAK_NS_MAX);
    if (request->job.goes_on) {
        request->plan.answer_early = NULL; /* it has begun */
        srv_compute_push_reap(&loop->compute, &session->lane, &request->job);
        return true;
    }
    loop->metrics.counters.steps_brief += request->status == 0;
    done(&request->job);
    return true;
}

/* Scenes are used by requests of several sessions: those that these share, and by
 * list.pair any. */
static void claim(struct srv_request *request, const struct srv_plan *plan)
{
    if (plan->replacement != NULL) {
        request->job.claims = plan->replacement->claims;
        request->job.claim_count = plan->replacement->scene_count;
    } else if (plan->scene != NULL) {
        request->claim = &plan->scene->claim;
        request->job.claims = &request->claim;
        request->job.claim_count = 1;
    }
}

/* NULL: the loop answers, as always while it is recorded what it does: what a recording
 * has of a session lies one inside the other, or apart. */
static struct srv_outlet *open_outlet(const struct srv_session *session,
                                      const struct srv_plan *plan)
{
    return plan->replies && session->loop->tracing == NULL
               ? srv_conn_outlet(session->conn)
               : NULL;
}

int srv_request_start(struct srv_call *call, const struct srv_plan *plan)
{
    srv_assert_loop();
    struct srv_session *session = call->session;
    if (plan->deadline_ns != 0 && srv_overdue_reserve(&session->loop->overdue) != 0) {
        return proto_error_set(&call->error, PCCD_E_NOMEM, "no memory for a deadline");
    }
    struct srv_request *request = take_memory(session);
    if (request == NULL) {
        return proto_error_set(&call->error, PCCD_E_NOMEM, "no memory for the request");
    }
    srv_job_init(&request->job, plan->attached != NULL ? run_pages : run, done);
    request->job.heeds_end = call->method == PROTO_METHOD_FRAME_SUBMIT;
    claim(request, plan);
    request->session = session;
    request->plan = *plan;
    request->id = call->id;
    request->method = call->method;
    request->arrival_ns = call->arrival_ns;
    request->params = call->params;
    request->fds[0] = -1;
    request->fds[1] = -1;
    request->deadline_ns = plan->deadline_ns;
    request->overdue_at = SRV_OVERDUE_NOWHERE;
    acquire(plan);
    srv_session_enlist(session, request);
    request->outlet = open_outlet(session, plan);
    if (run_here(request)) {
        return SRV_LATER;
    }
    int status = enqueue(request);
    if (status != 0) {
        if (request->outlet != NULL) {
            srv_outlet_drop(request->outlet);
        }
        srv_session_unlist(session, request);
        release(plan);
        give_memory(session, request);
        return proto_error_set(&call->error, status,
                               "%u requests wait to be computed already",
                               session->loop->options->queue_max);
    }
    if (plan->deadline_ns != 0) {
        srv_overdue_add(&session->loop->overdue, request);
    }
    return SRV_LATER;
}

/* ---- before their turn ------------------------------------------------------------- */

struct early {
    uint8_t *copy;
    uint64_t copy_bytes;
};

/* Locked: it cannot begin. */
static void mark_answered(struct srv_job *job, void *context)
{
    struct srv_request *request = (struct srv_request *)job;
    const struct early *early = context;
    request->is_answered = true;
    request->copy = early->copy;
    request->copy_bytes = early->copy_bytes;
    srv_request_return_slot(request);
}

bool srv_request_answer_early(struct srv_request *request,
                              const struct proto_FRAME_SUBMIT_result *result,
                              uint8_t *copy, uint64_t copy_bytes)
{
    srv_assert_loop();
    struct srv_session *session = request->session;
    struct early early = {copy, copy_bytes};
    if (!srv_compute_amend(&session->loop->compute, &request->job, mark_answered,
                           &early)) {
        return false;
    }
    session->submit_count--;
    session->overdue_count++;
    srv_ring_done(request->plan.ring);
    srv_dispatch_answer_early(session, request, result);
    return true;
}

/* Answer a request that has been taken out of its lane. */
static void take_back(struct srv_request *request)
{
    request->status =
        proto_error_set(&request->error, PCCD_E_CANCELLED,
                        "request %u was cancelled before it was done", request->id);
    conclude(request);
    done(&request->job);
}

static void leave(struct srv_job *job, void *context)
{
    (void)job;
    (void)context;
}

/* Not one that runs: it ends by itself, and its slot would be copied for nothing. */
static void try_early(struct srv_request *request, enum pccd_incomplete why)
{
    struct srv_session *session = request->session;
    if (request->plan.answer_early != NULL && session->state == SRV_SESSION_OPEN &&
        !request->is_held && !request->is_answered &&
        session->overdue_count < SRV_OVERDUE_MAX &&
        srv_compute_amend(&session->loop->compute, &request->job, leave, NULL)) {
        request->plan.answer_early(request, why);
    }
}

void srv_request_overdue(struct srv_request *request)
{
    srv_assert_loop();
    if (request->is_waiting) {
        srv_held_end(request, PCCD_INCOMPLETE_DEADLINE);
        return;
    }
    try_early(request, PCCD_INCOMPLETE_DEADLINE);
}

void srv_request_cancel(struct srv_request *request)
{
    srv_assert_loop();
    atomic_store_explicit(&request->job.cancel, true, memory_order_relaxed);
    if (request->is_waiting) {
        srv_held_end(request, PCCD_INCOMPLETE_CANCELLED);
        return;
    }
    try_early(request, PCCD_INCOMPLETE_CANCELLED);
    if (request->method != PROTO_METHOD_FRAME_SUBMIT && dequeue(request)) {
        take_back(request);
    }
}

void srv_request_abandon(struct srv_request *request)
{
    srv_assert_loop();
    PCCD_ASSERT(request->session->conn == NULL);
    atomic_store_explicit(&request->job.cancel, true, memory_order_relaxed);
    if (request->is_waiting) {
        srv_held_end(request, PCCD_INCOMPLETE_CANCELLED);
    } else if (dequeue(request)) {
        take_back(request);
    }
}
