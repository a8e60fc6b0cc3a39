/* request.c - a request on its way through the compute thread. */
#include "request.h"

#include <sched.h>
#include <stdlib.h>
#include <string.h>

#include "answer.h"
#include "crash_context.h"
#include "enginemem.h"
#include "host.h"
#include "invariant.h"
#include "linger.h"
#include "meshes.h"
#include "now.h"
#include "service.h"
#include "session.h"
#include "stray.h"
#include "tracing.h"

/* A reference to each thing that the plan names, and back. [loop] */
static void acquire(const struct srv_plan *plan)
{
    if (plan->ring != NULL) {
        srv_resource_acquire(&plan->ring->resource);
    }
    if (plan->shape != NULL) {
        srv_resource_acquire(&plan->shape->resource);
    }
    if (plan->scene != NULL) { /* list.pair's may be another session's: that stays */
        srv_resource_acquire(&plan->scene->resource);
        srv_owner_keep(plan->scene->resource.owner);
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
        struct srv_owner *owner = plan->scene->resource.owner;
        srv_resource_drop(&plan->scene->resource);
        srv_owner_release(owner);
    }
    if (plan->tracing != NULL) {
        srv_resource_drop(&plan->tracing->resource);
    }
}

#define SPARES_MAX 4u /* of a session */

bool srv_is_step(int method)
{
    return method == PROTO_METHOD_FRAME_SUBMIT || method == PROTO_METHOD_SCENE_NEAR ||
           method == PROTO_METHOD_BATCH_SUBMIT;
}

#define FROM(state) (1u << SRV_REQUEST_##state)

void srv_request_move(struct srv_request *request, enum srv_request_state to)
{
    static const uint16_t from[SRV_REQUEST_STATES] = {
        [SRV_REQUEST_QUEUED] = FROM(NEW),
        [SRV_REQUEST_BRIEF] = FROM(NEW),
        [SRV_REQUEST_MOVED] = FROM(BRIEF),
        [SRV_REQUEST_EARLY] = FROM(QUEUED),
        [SRV_REQUEST_OWED] = FROM(QUEUED) | FROM(BRIEF) | FROM(MOVED),
        [SRV_REQUEST_TRIED] = FROM(QUEUED) | FROM(MOVED),
        [SRV_REQUEST_REPLIED] = FROM(QUEUED) | FROM(MOVED),
        [SRV_REQUEST_WAITING] = FROM(OWED),
        [SRV_REQUEST_OVER] = FROM(QUEUED) | FROM(MOVED) | FROM(EARLY) | FROM(OWED) |
                             FROM(TRIED) | FROM(REPLIED) | FROM(WAITING),
    };
    PCCD_ASSERT((from[to] >> srv_request_state(request) & 1u) != 0);
    atomic_store_explicit(&request->state, to, memory_order_relaxed);
}

static bool is_early(const struct srv_request *request)
{
    return srv_request_state(request) == SRV_REQUEST_EARLY;
}

/* Go on from OPEN. False: it is not, or was not any more. [any] */
static bool leave_open(struct srv_request *request, enum srv_request_state to)
{
    enum srv_request_state open = SRV_REQUEST_OPEN;
    return atomic_compare_exchange_strong(&request->state, &open, to);
}

void srv_request_open(struct srv_request *request)
{
    enum srv_request_state queued = SRV_REQUEST_QUEUED;
    if (request->plan.answer_early != NULL) { /* pairs with the load in answer_early */
        (void)atomic_compare_exchange_strong(&request->state, &queued, SRV_REQUEST_OPEN);
    }
}

bool srv_request_claim(struct srv_request *request)
{
    return leave_open(request, SRV_REQUEST_QUEUED) || !is_early(request);
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
    if (request->plan.ring != NULL && !is_early(request)) {
        srv_ring_done(request->plan.ring);
    }
}

/* Answers of what a session has computed keep its order, as pages of the result region go
 * back in that in which they came: not while the loop is to send an earlier one. */
static bool may_reply(const struct srv_request *request)
{
    return request->outlet != NULL && request->status == 0 &&
           srv_request_state(request) != SRV_REQUEST_BRIEF &&
           request->item.taken == NULL && atomic_load(&request->session->owed_count) == 0;
}

/* Returns whether the client has its answer. [compute] */
static bool try_reply(struct srv_request *request)
{
    struct srv_service *service = request->session->service;
    struct proto_encoder *encoder = srv_workspace_of_thread(service->workspaces)->encoder;
    int status =
        proto_encode_result(encoder, request->id, request->method, &request->result);
    PCCD_ASSERT(status == 0);
    /* Pairs with the loop's load before it handles what a client has sent: that client
     * may have this answer. */
    atomic_fetch_add(&service->replies_tried, 1);
    bool is_sent = srv_outlet_send(request->outlet, encoder) == 0;
    request->replied_ns = common_now_ns();
    if (is_sent && request->session->replies != NULL &&
        srv_replies_must_keep(request->method)) { /* the encoder is the next request's */
        request->reply = srv_reply_copy(request->id, encoder);
    }
    return is_sent;
}

/* It has run. Waking the loop to answer it is 25 us where processors sleep. What goes
 * wrong, or cannot be sent now, or belongs to others as well, is the loop's. [compute] */
static void reply(struct srv_request *request)
{
    enum srv_request_state to = SRV_REQUEST_OWED;
    if (is_early(request)) {
        return;
    }
    if (may_reply(request)) {
        to = try_reply(request) ? SRV_REQUEST_REPLIED : SRV_REQUEST_TRIED;
    }
    if (to != SRV_REQUEST_REPLIED) {
        atomic_fetch_add(&request->session->owed_count, 1);
    }
    srv_request_move(request, to);
}

static bool is_behind(const struct srv_service *service)
{
    return atomic_load(&service->replies_tried) != service->replies_done;
}

void srv_request_catch_up(struct srv_service *service)
{
    srv_assert_loop();
    while (is_behind(service)) {
        if (srv_compute_drain(&service->compute) == 0) {
            sched_yield(); /* it may have lost its processor to this thread */
        }
    }
}

/* A ring and the memory of its slots are made on a thread of their own, beside what is
 * computed: nothing that a step uses is touched, and nothing of the engine. [pages] */
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
    srv_crash_context_set(proto_messages[request->method].name, request->session->id,
                          request->id);
    struct srv_enginemem memory;
    const struct srv_scene *scene = request->plan.scene; /* may be another user's */
    srv_enginemem_begin(&memory, scene != NULL ? scene->resource.owner->user
                                               : request->session->owner.user);
    request->status =
        srv_enginemem_explain(&memory, request->plan.work(request), &request->error);
    srv_crash_context_set(NULL, 0, 0);
    PCCD_ASSERT(request->status == 0 || request->error.code == request->status);
    PCCD_ASSERT(request->status == 0 || !job->goes_on);
    if (!job->goes_on) {
        conclude(request);
        reply(request);
    }
}

static void drop_copy(struct srv_request *request)
{
    struct srv_session *session = request->session;
    if (request->copy != NULL) {
        srv_quota_refund(session->owner.user, SRV_QUOTA_SHM_BYTES, request->copy_bytes);
        free(request->copy);
        request->copy = NULL;
    }
}

/* Take the memory that the session has freed last: its next step asks the heap for
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

bool srv_request_is_cut_off(const struct srv_request *request)
{
    return request->connection != request->session->connection;
}

/* ---- those of a session ----------------------------------------------------------- */

static void enlist(struct srv_session *session, struct srv_request *request)
{
    PCCD_ASSERT(session->request_count < SRV_REQUESTS_MAX + SRV_OVERDUE_MAX);
    request->prev = NULL;
    request->next = session->requests;
    if (request->next != NULL) {
        request->next->prev = request;
    }
    session->requests = request;
    session->request_count++;
    session->submit_count += srv_is_step(request->method);
    session->service->request_count++;
}

static void unlist(struct srv_session *session, struct srv_request *request)
{
    PCCD_ASSERT(session->request_count > 0);
    if (request->prev != NULL) {
        request->prev->next = request->next;
    } else {
        session->requests = request->next;
    }
    if (request->next != NULL) {
        request->next->prev = request->prev;
    }
    session->request_count--;
    session->overdue_count -= is_early(request);
    session->submit_count -= srv_is_step(request->method) && !is_early(request);
    session->service->request_count--;
}

struct srv_request *srv_request_find(const struct srv_session *session, uint32_t id)
{
    struct srv_request *request = session->requests;
    while (request != NULL && (request->id != id || is_early(request))) {
        request = request->next;
    }
    return request;
}

/* ---- answers ----------------------------------------------------------------------- */

static struct srv_question question_of(const struct srv_request *request)
{
    return (struct srv_question){request->arrival_ns, request->id, request->method};
}

/* It has been sent by the thread that computed it, which has copied it for a client that
 * comes back. */
static void note_reply(struct srv_request *request)
{
    struct srv_session *session = request->session;
    if (request->reply.bytes > 0) {
        srv_replies_keep(session->replies, request->reply);
        request->reply.data = NULL;
    }
    srv_metrics_add_duration(&session->service->metrics, PCCD_HISTOGRAM_REQUESTS,
                             request->replied_ns - request->arrival_ns);
}

/* Send the answer; with nobody there any more, only close its descriptors. */
static void answer(struct srv_request *request)
{
    struct srv_session *session = request->session;
    const struct srv_question question = question_of(request);
    const struct proto_error *error = request->status == 0 ? NULL : &request->error;
    int fd_count = error == NULL && request->fds[0] >= 0 ? 2 : 0;
    if (session->state == SRV_SESSION_CLOSED) {
        srv_answer_close_fds(request->fds, fd_count);
    } else if (srv_request_state(request) == SRV_REQUEST_REPLIED) {
        note_reply(request);
    } else if (srv_request_is_cut_off(request)) { /* sent when it is asked for again */
        srv_answer_close_fds(request->fds, fd_count);
        srv_answer_keep(session, &question, &request->result, error);
    } else {
        PCCD_ASSERT(session->state == SRV_SESSION_OPEN);
        srv_answer(session, &question, &request->result, error, request->fds, fd_count);
    }
}

void srv_request_conclude(struct srv_request *request)
{
    struct srv_session *session = request->session;
    const enum srv_request_state state = srv_request_state(request);
    srv_assert_loop();
    srv_deadlines_remove(&session->service->deadlines, &request->deadline);
    if (request->plan.finish != NULL) {
        request->plan.finish(request);
    }
    session->service->metrics.counters.upload_bytes += request->upload_bytes;
    if (request->status == PCCD_E_QUOTA && session->state == SRV_SESSION_OPEN) {
        (void)srv_linger_evict(session->service,
                               session->owner.user); /* for the next try */
    }
    if (state != SRV_REQUEST_EARLY) {
        answer(request);
        free(request->reply.data); /* nobody comes back for it */
    }
    session->service->replies_done +=
        state == SRV_REQUEST_REPLIED || state == SRV_REQUEST_TRIED;
    session->service->metrics.counters.steps_replied += state == SRV_REQUEST_REPLIED;
    if (state == SRV_REQUEST_OWED || state == SRV_REQUEST_TRIED ||
        state == SRV_REQUEST_WAITING) {
        atomic_fetch_sub(&session->owed_count, 1);
    }
    if (request->outlet != NULL) {
        srv_outlet_drop(request->outlet);
    }
    drop_copy(request);
    if (request->plan.ring != NULL) {
        srv_ring_trim_if_idle(request->plan.ring, &session->service->reclaim);
        srv_stray_use(session->service);
    }
    release(&request->plan);
    unlist(session, request);
    srv_request_move(request, SRV_REQUEST_OVER);
    give_memory(session, request);
    srv_session_settle(session);
}

/* [loop] */
static void done(struct srv_job *job)
{
    struct srv_request *request = (struct srv_request *)job;
    if (request->plan.waits == NULL || !request->plan.waits(request)) {
        srv_request_conclude(request);
    }
}

static int enqueue(struct srv_request *request)
{
    struct srv_session *session = request->session;
    return request->plan.makes_pages
               ? srv_compute_push(&session->service->pages, &session->owner.page_job_list,
                                  &request->job)
               : srv_compute_push(&session->service->compute, &session->owner.job_list,
                                  &request->job);
}

/* False: it runs, or has run. */
static bool dequeue(struct srv_request *request)
{
    struct srv_service *service = request->session->service;
    return srv_compute_remove(
        request->plan.makes_pages ? &service->pages : &service->compute, &request->job);
}

/* The loop does what is brief itself when the compute thread sleeps: waking it, and being
 * woken by it, is 60 us where processors sleep, ten times such a step. Between two of
 * them it has as long for others, so that many who ask for little are served by the two
 * threads as if there were no brief steps. For a client that is alone there are no
 * others: its steps are brief when they are of some thousand triangles, too. */
#define BREAK_NS_MAX 100000u /* after one that lost its processor */

/* Run a request that is brief, if it can be now: it has been answered then, or goes on in
 * its list. False: nothing was done. */
static bool run_here(struct srv_request *request)
{
    struct srv_session *session = request->session;
    struct srv_service *service = session->service;
    uint64_t begin_ns = common_now_ns();
    request->is_alone = service->client_count == 1;
    bool has_break = begin_ns < service->brief_from_ns && !request->is_alone;
    if (!service->does_brief || request->plan.can_be_brief == NULL || has_break ||
        !srv_compute_is_idle(&service->compute) || !request->plan.can_be_brief(request)) {
        return false;
    }
    srv_request_move(request, SRV_REQUEST_BRIEF);
    srv_thread_enter(SRV_THREAD_COMPUTE);
    run(&request->job);
    srv_thread_enter(SRV_THREAD_LOOP);
    uint64_t end_ns = common_now_ns();
    uint64_t break_ns = end_ns - begin_ns;
    service->brief_from_ns = end_ns + (break_ns < BREAK_NS_MAX ? break_ns : BREAK_NS_MAX);
    if (request->job.goes_on) {
        PCCD_ASSERT(srv_request_state(request) == SRV_REQUEST_MOVED);
        request->plan.answer_early = NULL; /* it has begun */
        srv_compute_push_reap(&service->compute, &session->owner.job_list, &request->job);
        return true;
    }
    service->metrics.counters.steps_brief += request->status == 0;
    done(&request->job);
    return true;
}

/* Scenes are used by requests of several sessions: those that these share, and by
 * list.pair any. */
static void claim(struct srv_request *request, const struct srv_plan *plan)
{
    if (plan->claims != NULL) {
        request->job.claims = plan->claims;
        request->job.claim_count = plan->claim_count;
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
    return plan->replies && session->service->tracing == NULL
               ? srv_conn_outlet(session->conn)
               : NULL;
}

int srv_request_start(struct srv_call *call, const struct srv_plan *plan)
{
    srv_assert_loop();
    struct srv_session *session = call->session;
    if (plan->deadline_ns != 0 &&
        srv_deadlines_reserve(&session->service->deadlines) != 0) {
        return proto_error_set(&call->error, PCCD_E_NOMEM, "no memory for a deadline");
    }
    struct srv_request *request = take_memory(session);
    if (request == NULL) {
        return proto_error_set(&call->error, PCCD_E_NOMEM, "no memory for the request");
    }
    srv_job_init(&request->job, plan->makes_pages ? run_pages : run, done);
    request->job.heeds_end = srv_is_step(call->method);
    claim(request, plan);
    request->session = session;
    request->connection = session->connection;
    request->plan = *plan;
    request->item = (struct srv_item){
        .scene = plan->scene, .member = plan->member, .answer = &request->result.answer};
    request->id = call->id;
    request->method = call->method;
    request->arrival_ns = call->arrival_ns;
    request->params = call->params;
    request->fds[0] = -1;
    request->fds[1] = -1;
    request->deadline =
        (struct srv_deadline){.at_ns = plan->deadline_ns, .place = SRV_DEADLINE_NOWHERE};
    acquire(plan);
    enlist(session, request);
    request->outlet = open_outlet(session, plan);
    if (run_here(request)) {
        return SRV_LATER;
    }
    srv_request_move(request, SRV_REQUEST_QUEUED);
    int status = enqueue(request);
    if (status != 0) {
        if (request->outlet != NULL) {
            srv_outlet_drop(request->outlet);
        }
        unlist(session, request);
        release(plan);
        give_memory(session, request);
        return proto_error_set(&call->error, status,
                               "%u requests wait to be computed already",
                               session->service->options->queue_max);
    }
    if (plan->deadline_ns != 0) {
        srv_deadlines_add(&session->service->deadlines, &request->deadline);
    }
    return SRV_LATER;
}

/* ---- before their turn ------------------------------------------------------------- */

/* Return whether the next page is that of a request which waits: nobody uses its ring
 * until that begins, and the client has all pages before. Locked. */
static bool may_write(const struct srv_request *request)
{
    const struct srv_session *session = request->session;
    bool is_free = !request->job.list->serving;
    for (const struct srv_request *at = session->requests; at != NULL && !is_free;
         at = at->next) {
        /* A batch that has its answer only moves scenes. */
        is_free =
            at->job.state == SRV_JOB_RUNNING && at->plan.batch != NULL && is_early(at);
    }
    return is_free && atomic_load(&session->owed_count) == 0;
}

struct early {
    uint8_t *copy;
    uint64_t copy_bytes;
    bool (*write)(struct srv_request *request);
    bool is_refused;
};

/* Locked: it cannot begin. */
static void mark_answered(struct srv_job *job, void *context)
{
    struct srv_request *request = (struct srv_request *)job;
    struct early *early = context;
    early->is_refused =
        early->write != NULL && !(may_write(request) && early->write(request));
    if (early->is_refused) {
        return;
    }
    srv_request_move(request, SRV_REQUEST_EARLY);
    job->counts = false; /* its client may ask for the next thing */
    request->copy = early->copy;
    request->copy_bytes = early->copy_bytes;
    srv_request_return_slot(request);
}

static void ask_may_write(struct srv_job *job, void *context)
{
    *(bool *)context = may_write((struct srv_request *)job);
}

bool srv_request_may_write(struct srv_request *request)
{
    bool may = false;
    (void)srv_compute_amend(&request->session->service->compute, &request->job,
                            ask_may_write, &may);
    return may;
}

bool srv_request_answer_early(struct srv_request *request, const void *result,
                              uint8_t *copy, uint64_t copy_bytes,
                              bool (*write)(struct srv_request *request))
{
    srv_assert_loop();
    struct srv_session *session = request->session;
    struct early early = {copy, copy_bytes, write, false};
    bool is_late = copy == NULL && leave_open(request, SRV_REQUEST_EARLY);
    if (!is_late && !srv_compute_amend(&session->service->compute, &request->job,
                                       mark_answered, &early)) {
        return false;
    }
    if (early.is_refused) {
        return false;
    }
    session->submit_count--;
    session->overdue_count++;
    srv_ring_done(request->plan.ring);
    const struct srv_question question = question_of(request);
    srv_answer(session, &question, result, NULL, NULL, 0);
    return true;
}

void srv_request_answer_now(struct srv_request *request)
{
    struct srv_service *service = request->session->service;
    enum srv_request_state queued = SRV_REQUEST_QUEUED;
    (void)atomic_compare_exchange_strong(&request->state, &queued, SRV_REQUEST_OPEN);
    if (service->compute.notify != NULL) { /* else the loop is this thread */
        atomic_store(&service->has_open, true);
        service->compute.notify(service->compute.context);
    }
}

/* Return whether the client of a request can be sent an answer before its work ends. */
static bool can_send(const struct srv_request *request)
{
    return request->session->state == SRV_SESSION_OPEN &&
           !srv_request_is_cut_off(request) && !is_early(request) &&
           request->session->overdue_count < SRV_OVERDUE_MAX;
}

/* Return a batch that is OPEN; NULL: there is none. */
static struct srv_request *find_open(const struct srv_service *service)
{
    for (struct srv_session *session = service->sessions; session != NULL;
         session = session->next) {
        for (struct srv_request *request = session->requests; request != NULL;
             request = request->next) {
            if (request->plan.batch != NULL &&
                srv_request_state(request) == SRV_REQUEST_OPEN && can_send(request)) {
                return request;
            }
        }
    }
    return NULL;
}

void srv_request_send_open(struct srv_service *service)
{
    srv_assert_loop();
    bool has_open = atomic_exchange(&service->has_open, false);
    struct srv_request *request = has_open ? find_open(service) : NULL;
    while (request != NULL &&
           srv_request_answer_early(request, &request->result, NULL, 0, NULL)) {
        request = find_open(service); /* its session may have ended */
    }
}

/* Answer a request that has been taken out of its list. */
static void take_back(struct srv_request *request)
{
    request->status =
        proto_error_set(&request->error, PCCD_E_CANCELLED,
                        "request %u was cancelled before it was done", request->id);
    conclude(request);
    done(&request->job);
}

/* The time in which a step that runs answers by itself when it is to end: it looks at its
 * end, as a rule, some 0.1 ms after it. If it is at something that does not look, such as
 * the copies of a million vertices, the loop answers. */
#define GRACE_NS 500000u

/* Look again at a request that is to end and runs. */
static void look_again(struct srv_request *request)
{
    struct srv_deadlines *deadlines = &request->session->service->deadlines;
    srv_deadlines_remove(deadlines, &request->deadline);
    if (srv_deadlines_reserve(deadlines) == 0) { /* else it answers by itself */
        request->deadline.at_ns = common_now_ns() + GRACE_NS;
        srv_deadlines_add(deadlines, &request->deadline);
    }
}

/* Answer a request that is to end since `end_ns`: at once where it waits, or when the
 * pages before that of a batch are the client's; one that runs after a grace, when it has
 * read its slot. */
static void try_early(struct srv_request *request, enum pccd_incomplete why,
                      uint64_t end_ns)
{
    struct srv_session *session = request->session;
    if (request->plan.answer_early == NULL || !can_send(request)) {
        return;
    }
    bool is_first = request->end_ns == 0;
    request->end_ns = is_first ? end_ns : request->end_ns;
    bool waits = srv_compute_amend(&session->service->compute, &request->job, NULL, NULL);
    bool is_late = srv_request_state(request) == SRV_REQUEST_OPEN &&
                   common_now_ns() - request->end_ns >= GRACE_NS;
    bool is_over = waits; /* then it may be gone, with its session */
    if (waits ? is_first || request->plan.batch != NULL : is_late) {
        is_over = request->plan.answer_early(request, why);
    }
    if (!is_over) {
        look_again(request);
    }
}

void srv_request_overdue(struct srv_deadline *deadline)
{
    struct srv_request *request =
        (struct srv_request *)(void *)((char *)deadline -
                                       offsetof(struct srv_request, deadline));
    srv_assert_loop();
    if (srv_request_state(request) == SRV_REQUEST_WAITING) {
        request->plan.stop_waiting(request, PCCD_INCOMPLETE_DEADLINE);
        return;
    }
    bool is_cancelled = atomic_load_explicit(&request->job.cancel, memory_order_relaxed);
    try_early(request,
              is_cancelled ? PCCD_INCOMPLETE_CANCELLED : PCCD_INCOMPLETE_DEADLINE,
              deadline->at_ns);
}

void srv_request_cancel(struct srv_request *request)
{
    srv_assert_loop();
    atomic_store_explicit(&request->job.cancel, true, memory_order_relaxed);
    if (srv_request_state(request) == SRV_REQUEST_WAITING) {
        request->plan.stop_waiting(request, PCCD_INCOMPLETE_CANCELLED);
        return;
    }
    try_early(request, PCCD_INCOMPLETE_CANCELLED, common_now_ns());
    if (!srv_is_step(request->method) && dequeue(request)) {
        take_back(request);
    }
}

static void abandon(struct srv_request *request)
{
    srv_assert_loop();
    PCCD_ASSERT(request->session->conn == NULL);
    atomic_store_explicit(&request->job.cancel, true, memory_order_relaxed);
    if (srv_request_state(request) == SRV_REQUEST_WAITING) {
        request->plan.stop_waiting(request, PCCD_INCOMPLETE_CANCELLED);
    } else if (dequeue(request)) {
        take_back(request);
    }
}

void srv_request_cancel_all(struct srv_session *session)
{
    for (struct srv_request *request = session->requests; request != NULL;) {
        struct srv_request *next = request->next;
        srv_request_cancel(request);
        request = next;
    }
}

static void free_spares(struct srv_session *session)
{
    while (session->spare_requests != NULL) {
        struct srv_request *request = session->spare_requests;
        session->spare_requests = request->next;
        session->spare_count--;
        free(request);
    }
}

void srv_request_abandon_all(struct srv_session *session)
{
    for (struct srv_request *request = session->requests; request != NULL;) {
        struct srv_request *next = request->next; /* taken back: frees the request */
        abandon(request);
        request = next;
    }
    free_spares(session); /* a session that is over keeps none */
}
