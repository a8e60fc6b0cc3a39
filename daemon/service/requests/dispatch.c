/* dispatch.c - from a message to an answer, and the end of a session. */
#include "dispatch.h"

#include "answer.h"
#include "call.h"
#include "crash_context.h"
#include "host.h"
#include "invariant.h"
#include "linger.h"
#include "meshes.h"
#include "now.h"
#include "printable.h"
#include "replies.h"
#include "request.h"
#include "ringio.h"
#include "service.h"
#include "session.h"
#include "shared.h"
#include "srv_scene.h"
#include "tracing.h"
#include "watcher.h"

/* ---- the table --------------------------------------------------------------------- */

#define ENTRY(ID, name, since, flags, text) [PROTO_METHOD_##ID] = srv_on_##ID,
static int (*const handlers[PROTO_METHOD_COUNT])(struct srv_call *call) = {
    PROTO_METHODS(ENTRY)};
#undef ENTRY

/* ---- the end of a connection ------------------------------------------------------- */

void srv_dispatch_violation(struct srv_session *session, int code, const char *text)
{
    srv_assert_loop();
    struct proto_error error = {.fatal = true};
    proto_error_set(&error, code, "%s", text);
    error.fatal = true;
    srv_log(SRV_LOG_WARN, session->id, "dropped: %s", error.text);
    session->service->metrics.counters.sessions_dropped++;
    srv_answer_refuse(session, &error);
}

void srv_dispatch_goaway(struct srv_service *service, int code, const char *text)
{
    srv_assert_loop();
    struct proto_GOAWAY_request note = {.code = (uint32_t)-code};
    size_t length = 0;
    for (; text[length] != '\0' && length < PROTO_STR_MAX; length++) {
        note.text[length] = text[length];
    }
    int status = proto_encode_notification(service->encoder, PROTO_NOTE_GOAWAY, &note);
    PCCD_ASSERT(status == 0);
    srv_conn_send_all(service, service->encoder);
}

/* ---- refusals, in their order ------------------------------------------------------ */

static int deny_stranger(struct srv_session *session, struct proto_error *error)
{
    if (!session->is_stranger) {
        return 0;
    }
    session->service->metrics.counters.sessions_refused++;
    session->service->metrics.counters.sessions_denied++;
    proto_error_set(error, PCCD_E_ACCESS,
                    "user %u is not in the lists of this daemon (pccdd --allow-uid, "
                    "--allow-gid)",
                    (unsigned)session->owner.user->uid);
    error->fatal = true;
    srv_log(SRV_LOG_WARN, session->id, "refused: %s", error->text);
    return PCCD_E_ACCESS;
}

static int refuse_stranger(struct srv_call *call)
{
    return deny_stranger(call->session, &call->error);
}

static int refuse_beyond_quota(struct srv_call *call)
{
    if (call->session->state != SRV_SESSION_REFUSED ||
        call->method == PROTO_METHOD_HELLO) { /* may find a place (handlers_hello.c) */
        return 0;
    }
    return srv_dispatch_refuse_quota(call->session, &call->error);
}

int srv_dispatch_refuse_quota(struct srv_session *session, struct proto_error *error)
{
    struct srv_service *service = session->service;
    const struct srv_quota_user *user = session->owner.user;
    service->metrics.counters.sessions_refused++;
    if (session->came_when_full && srv_host_is_full(service)) {
        proto_error_set(error, PCCD_E_QUOTA,
                        "the daemon has as many connections as it may (%u: pccdd "
                        "--connections-max)",
                        service->options->connections_max);
    } else {
        proto_error_set(
            error, PCCD_E_QUOTA, "user %u has %llu %s already, the quota is %llu",
            (unsigned)user->uid, (unsigned long long)user->used[SRV_QUOTA_CLIENTS],
            proto_plural(user->used[SRV_QUOTA_CLIENTS], "client", "clients"),
            (unsigned long long)service->quota.limit[SRV_QUOTA_CLIENTS]);
    }
    error->fatal = true;
    srv_log(SRV_LOG_WARN, session->id, "refused: %s", error->text);
    return PCCD_E_QUOTA;
}

void srv_dispatch_refuse_silent(struct srv_session *session)
{
    struct proto_error error = {.fatal = true};
    srv_assert_loop();
    if (deny_stranger(session, &error) == 0) {
        srv_dispatch_refuse_quota(session, &error);
    }
    srv_answer_refuse(session, &error);
}

static int refuse_unknown(struct srv_call *call)
{
    if (call->method >= 0 && call->method < PROTO_METHOD_COUNT) {
        return 0;
    }
    if (call->method >= 0) {
        return proto_error_set(&call->error, PCCD_E_NOMETHOD,
                               "%s is a notification of the daemon",
                               proto_messages[call->method].name);
    }
    call->error.code = PCCD_E_NOMETHOD; /* the decoder wrote the text */
    return PCCD_E_NOMETHOD;
}

static int refuse_shutdown(struct srv_call *call)
{
    if (call->session->service->phase == SRV_PHASE_RUNNING) {
        return 0;
    }
    return proto_error_set(&call->error, PCCD_E_SHUTDOWN,
                           "the daemon is shutting down, %s is not begun any more",
                           proto_messages[call->method].name);
}

static int refuse_before_hello(struct srv_call *call)
{
    const struct proto_message_info *info = &proto_messages[call->method];
    if ((info->flags & PROTO_F_BEFORE_HELLO) != 0) {
        return 0;
    }
    if (call->session->state != SRV_SESSION_OPEN) {
        return proto_error_set(&call->error, PCCD_E_NOHELLO, "%s came before hello",
                               info->name);
    }
    if (info->since > call->session->version) {
        return proto_error_set(&call->error, PCCD_E_NOMETHOD,
                               "%s needs protocol version %u, this session has %u",
                               info->name, info->since, call->session->version);
    }
    return 0;
}

/* Return whether an observer may ask it. */
static bool is_for_observers(int method)
{
    switch (method) {
    case PROTO_METHOD_HELLO:
    case PROTO_METHOD_PING:
    case PROTO_METHOD_BYE:
    case PROTO_METHOD_STATS:
    case PROTO_METHOD_STATS_THREAD:
    case PROTO_METHOD_STATS_HISTOGRAM:
    case PROTO_METHOD_LIST_SESSION:
    case PROTO_METHOD_LIST_SCENE:
    case PROTO_METHOD_LIST_OBJECT:
    case PROTO_METHOD_LIST_MESH:
    case PROTO_METHOD_CONFIG_GET:
    case PROTO_METHOD_CONFIG_SET:
    case PROTO_METHOD_WATCH_START:
    case PROTO_METHOD_WATCH_STOP:
        return true;
    default:
        return false;
    }
}

static int refuse_observer(struct srv_call *call)
{
    return !call->session->is_observer || is_for_observers(call->method)
               ? 0
               : proto_error_set(&call->error, PCCD_E_STATE,
                                 "%s is not for a client that said it only observes",
                                 proto_messages[call->method].name);
}

static int refuse_busy(struct srv_call *call)
{
    if ((proto_messages[call->method].flags & PROTO_F_COMPUTE) == 0) {
        return 0;
    }
    uint32_t count = call->session->request_count - call->session->overdue_count;
    if (count >= SRV_REQUESTS_MAX) {
        return proto_error_set(&call->error, PCCD_E_BUSY,
                               "%u requests are in flight, no more than %u may be", count,
                               SRV_REQUESTS_MAX);
    }
    if (srv_request_find(call->session, call->id) != NULL) {
        return proto_error_set(&call->error, PCCD_E_STATE,
                               "a request with message id %u is in flight already",
                               call->id);
    }
    return 0;
}

static int (*const refusals[])(struct srv_call *call) = {
    refuse_stranger,     refuse_beyond_quota, refuse_unknown, refuse_shutdown,
    refuse_before_hello, refuse_observer,     refuse_busy,
};

/* ---- the way through --------------------------------------------------------------- */

/* A request that came before, over a connection that was lost: its answer is sent once
 * more, or comes when it has been computed. False: it did not come, or may run again. */
static bool repeat(struct srv_session *session, uint32_t id)
{
    struct srv_service *service = session->service;
    if (session->replies == NULL || srv_replies_is_new(session->replies, id)) {
        return false;
    }
    struct srv_request *request = srv_request_find(session, id);
    if (request != NULL) {
        request->connection = session->connection;
        return true;
    }
    if (!srv_replies_find(session->replies, id, service->encoder)) {
        return false;
    }
    service->metrics.counters.replies_repeated++;
    srv_conn_send(session->conn, service->encoder, NULL, 0);
    return true;
}

/* Decode the parameters and call the handler, unless the request is refused. */
static int handle(struct srv_call *call, const struct proto_envelope *envelope)
{
    for (size_t i = 0; i < sizeof refusals / sizeof refusals[0]; i++) {
        int status = refusals[i](call);
        if (status != 0) {
            return status;
        }
    }
    int status = proto_decode_body(envelope, &proto_messages[call->method].request,
                                   &call->params, &call->error);
    return status != 0 ? status : handlers[call->method](call);
}

/* The user's memory may be held by sessions that only wait for their clients, or are over
 * and not freed yet. Then those that wait end, and the request comes again when they are
 * gone. Each turn ends a session. */
static int handle_in_turn(struct srv_call *call, const struct proto_envelope *envelope,
                          const void *message, size_t bytes)
{
    struct srv_session *session = call->session;
    int status = handle(call, envelope);
    while (status == PCCD_E_QUOTA && !call->error.fatal &&
           srv_linger_make_room(session)) {
        if (session->owner.user->leaving > 0) {
            return srv_conn_put_off(session->conn, message, bytes) == 0 ? SRV_LATER
                                                                        : status;
        }
        status = handle(call, envelope);
    }
    return status;
}

void srv_dispatch(struct srv_session *session, const void *message, size_t bytes)
{
    srv_assert_loop();
    struct srv_service *service = session->service;
    struct srv_call call = {.session = session, .arrival_ns = common_now_ns()};
    struct proto_envelope envelope = {0};
    int status = proto_decode(service->decoder, message, bytes, &envelope, &call.error);
    if (status == PCCD_E_NOMEM) {
        srv_dispatch_violation(session, status, "no memory to decode a message");
        return;
    }
    if (status != 0) {
        srv_dispatch_violation(session, PCCD_E_BADMSG, call.error.text);
        return;
    }
    if (envelope.kind == PROTO_NOTIFICATION) {
        return; /* clients have none in this version; newer ones may, and lose nothing */
    }
    if (envelope.kind == PROTO_RESPONSE) {
        srv_dispatch_violation(session, PCCD_E_BADMSG, "a response to no request");
        return;
    }
    if (repeat(session, envelope.id)) {
        return;
    }
    call.id = envelope.id;
    call.method = envelope.method;
    if (call.method < 0) {
        call.error = envelope.error;
    }
    srv_crash_context_set(call.method < 0 ? "?" : proto_messages[call.method].name,
                          session->id, call.id);
    status = handle_in_turn(&call, &envelope, message, bytes);
    srv_crash_context_set(NULL, 0, 0);
    session = call.session; /* hello may have found an older one */
    const struct srv_question question = {call.arrival_ns, call.id, call.method};
    if (status == 0) {
        srv_answer(session, &question, &call.result, NULL, NULL, 0);
    } else if (status < 0) {
        PCCD_ASSERT(call.error.code == status);
        srv_answer(session, &question, NULL, &call.error, NULL, 0);
    }
    srv_shared_catch_up(session);
    srv_tracing_add(service, PCCD_TRACE_RECEIVE, session, call.arrival_ns, call.method,
                    call.id);
}

/* ---- the end of a session ---------------------------------------------------------- */

/* Drop the session's own references; what requests still use goes with the last of
 * them. */
static void drop_everything(struct srv_session *session)
{
    uint32_t cursor = 0;
    for (struct srv_scene *scene; (scene = srv_handles_pop(&session->scenes, &cursor));) {
        if (scene->shared != NULL) {
            srv_shared_leave(session, scene);
        } else {
            srv_resource_drop(&scene->resource);
        }
    }
    cursor = 0;
    for (struct srv_mesh *mesh; (mesh = srv_handles_pop(&session->meshes, &cursor));) {
        srv_mesh_free(mesh);
    }
    if (session->ring != NULL) {
        srv_resource_drop(&session->ring->resource);
        session->ring = NULL;
    }
    srv_tracing_drop(session);
    (void)srv_watcher_stop(session);
}

void srv_refuse(struct srv_session *session, const struct proto_error *error)
{
    if (session->conn != NULL) {
        srv_dispatch_violation(session, error->code, error->text);
    } else {
        srv_linger_end(session, error->text);
    }
}

void srv_let_go(struct srv_session *session)
{
    srv_request_abandon_all(session);
    drop_everything(session);
}
