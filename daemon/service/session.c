/* session.c - what one client has here.
 *
 * Room:     service. See session.h.
 * Does:     the life of a session:
 *
 *     accept --> NEW ----- hello -----> OPEN <-- hello with its secret -- WAITING
 *       |         |                      |  `------ end of file ------------^ |
 *       |         | no hello in time     | bye, violation, shutdown           | time
 *       |         v                      v                                    | is up
 *       `--> REFUSED ----- answer -----> CLOSED <-----------------------------'
 *         (quota full)                   `--> freed
 *           Only the session of a client that asked for it waits (linger.c).
 *           CLOSED waits until request_count = 0 (cancelled ones come back) and
 *           reap_count = 0 (scenes, meshes and ring were freed on the compute thread).
 *
 * Does not: decide whether a session waits.
 * Threads:  [loop]
 */
#include "session.h"

#include <stdlib.h>
#include <unistd.h>

#include "host.h"
#include "invariant.h"
#include "loop.h"
#include "meshes.h"
#include "monitor.h"
#include "now.h"
#include "proto_limits.h"
#include "replies.h"
#include "request.h"
#include "shared.h"

/* In no list yet. NULL: no memory. */
static struct srv_session *new_of_user(struct srv_loop *loop, uid_t uid)
{
    struct srv_session *session = calloc(1, sizeof *session);
    if (session == NULL) {
        return NULL;
    }
    session->user = srv_quota_acquire(&loop->quota, uid);
    if (session->user == NULL) {
        free(session);
        return NULL;
    }
    session->loop = loop;
    session->lane.group = &session->user->jobs;
    session->page_lane.group = &session->user->page_jobs;
    session->id = ++loop->session_last;
    srv_handles_init(&session->scenes, PROTO_SCENES_PER_CLIENT, 0);
    srv_handles_init(&session->meshes, SRV_HANDLE_INDEX_MAX, 0);
    return session;
}

static void enlist(struct srv_session *session)
{
    struct srv_loop *loop = session->loop;
    session->next = loop->sessions;
    if (session->next != NULL) {
        session->next->prev = session;
    }
    loop->sessions = session;
}

struct srv_session *srv_session_new_host(struct srv_loop *loop, uid_t uid)
{
    srv_assert_loop();
    struct srv_session *session = new_of_user(loop, uid);
    if (session != NULL) {
        session->state = SRV_SESSION_HOST;
        session->is_host = true;
        enlist(session);
    }
    return session;
}

struct srv_session *srv_session_new(struct srv_loop *loop, struct srv_conn *conn,
                                    const struct srv_peer *peer)
{
    srv_assert_loop();
    struct srv_session *session = new_of_user(loop, peer->uid);
    if (session == NULL) {
        return NULL;
    }
    session->conn = conn;
    session->pid = peer->pid;
    struct proto_error error = {0};
    session->is_stranger = peer->is_stranger;
    session->counted =
        !peer->is_stranger &&
        srv_quota_charge(&loop->quota, session->user, SRV_QUOTA_CLIENTS, 1, &error) == 0;
    if (!session->counted) {
        session->state = SRV_SESSION_REFUSED;
    }
    enlist(session);
    return session;
}

int srv_session_admit(struct srv_session *session, struct proto_error *error)
{
    struct srv_loop *loop = session->loop;
    PCCD_ASSERT(session->state == SRV_SESSION_REFUSED);
    int status =
        srv_quota_charge(&loop->quota, session->user, SRV_QUOTA_CLIENTS, 1, error);
    if (status == 0) {
        session->counted = true;
        session->state = SRV_SESSION_NEW;
    }
    return status;
}

void srv_session_open(struct srv_session *session, uint32_t version)
{
    PCCD_ASSERT(session->state == SRV_SESSION_NEW);
    session->state = SRV_SESSION_OPEN;
    session->version = version;
    session->open_ns = srv_now_ns();
    session->loop->metrics.counters.sessions_now++;
    session->loop->metrics.counters.sessions_total++;
    srv_conn_established(session->conn);
    srv_host_client_joined(session->loop);
}

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
    (void)srv_monitor_stop(session);
}

void srv_session_detach(struct srv_session *session)
{
    srv_assert_loop();
    PCCD_ASSERT(session->state != SRV_SESSION_CLOSED);
    struct srv_loop *loop = session->loop;
    bool was_waiting = session->state == SRV_SESSION_WAITING;
    bool was_open = session->state == SRV_SESSION_OPEN || was_waiting;
    loop->metrics.counters.sessions_waiting_now -= was_waiting;
    session->conn = NULL;
    session->state = SRV_SESSION_CLOSED;
    session->user->leaving++;
    session->user->hosts_leaving += session->is_host;
    if (session->counted) {
        srv_quota_refund(&loop->quota, session->user, SRV_QUOTA_CLIENTS, 1);
    }
    session->reap_count++; /* keeps the session while requests leave it */
    for (struct srv_request *request = session->requests; request != NULL;) {
        struct srv_request *next = request->next; /* taken back: frees the request */
        srv_request_abandon(request);
        request = next;
    }
    drop_everything(session);
    if (was_open) {
        loop->metrics.counters.sessions_now--;
        srv_host_client_left(loop);
    }
    srv_session_reaped(session);
}

void srv_session_enlist(struct srv_session *session, struct srv_request *request)
{
    PCCD_ASSERT(session->request_count < SRV_REQUESTS_MAX + SRV_OVERDUE_MAX);
    request->prev = NULL;
    request->next = session->requests;
    if (request->next != NULL) {
        request->next->prev = request;
    }
    session->requests = request;
    session->request_count++;
    session->submit_count += request->method == PROTO_METHOD_FRAME_SUBMIT;
    session->loop->request_count++;
}

void srv_session_unlist(struct srv_session *session, struct srv_request *request)
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
    session->overdue_count -= request->is_answered;
    session->submit_count -=
        request->method == PROTO_METHOD_FRAME_SUBMIT && !request->is_answered;
    session->loop->request_count--;
}

static int refuse_handle(const struct srv_handles *handles, const char *what,
                         uint32_t want, int status, struct proto_error *error)
{
    if (status == PCCD_E_NOMEM) {
        return proto_error_set(error, status, "no memory for another %s", what);
    }
    if (want == 0) {
        return proto_error_set(error, status, "no room for another %s: there are %u",
                               what, handles->count);
    }
    return proto_error_set(error, status, "%s 0x%x cannot be had: %s", what, want,
                           status == PCCD_E_LIMIT
                               ? "it would leave too many places empty before it"
                               : "its place is taken, or there is no such handle");
}

int srv_session_handle(struct srv_session *session, struct srv_handles *handles,
                       const char *what, void *item, uint32_t want, uint32_t *handle,
                       struct proto_error *error)
{
    uint32_t skipped = 0;
    int status =
        want == 0 ? srv_handles_add(handles, item, handle)
                  : srv_handles_add_at(handles, item, want,
                                       SRV_SKIPPED_MAX - session->skip_count, &skipped);
    if (status != 0) {
        return refuse_handle(handles, what, want, status, error);
    }
    session->skip_count += skipped;
    *handle = want == 0 ? *handle : want;
    return 0;
}

void srv_session_hold(struct srv_session *session)
{
    for (struct srv_request *request = session->requests; request != NULL;
         request = request->next) {
        request->is_held = true;
    }
}

struct srv_request *srv_session_request(const struct srv_session *session, uint32_t id)
{
    struct srv_request *request = session->requests;
    while (request != NULL && (request->id != id || request->is_answered)) {
        request = request->next;
    }
    return request;
}

void srv_session_reaped(struct srv_session *session)
{
    PCCD_ASSERT(session->reap_count > 0);
    session->reap_count--;
    srv_session_settle(session);
}

void srv_session_settle(struct srv_session *session)
{
    if (session->state != SRV_SESSION_CLOSED || session->request_count > 0 ||
        session->reap_count > 0) {
        return;
    }
    struct srv_loop *loop = session->loop;
    PCCD_ASSERT(session->requests == NULL && session->lane.first == NULL);
    PCCD_ASSERT(session->page_lane.first == NULL);
    PCCD_ASSERT(session->scenes.count == 0 && session->meshes.count == 0);
    if (session->prev != NULL) {
        session->prev->next = session->next;
    } else {
        loop->sessions = session->next;
    }
    if (session->next != NULL) {
        session->next->prev = session->prev;
    }
    srv_handles_deinit(&session->scenes);
    srv_handles_deinit(&session->meshes);
    srv_laststep_set(&loop->spare_step, &session->last_step, NULL);
    srv_replies_free(session->replies);
    srv_request_free_spares(session);
    struct srv_quota_user *user = session->user;
    PCCD_ASSERT(user->leaving > 0 && user->hosts_leaving >= session->is_host);
    user->hosts_leaving -= session->is_host;
    free(session);
    user->leaving--;
    srv_conn_room(loop, user); /* whoever has waited for this refers to the user, too */
    srv_quota_release(&loop->quota, user);
}

int srv_session_refuse_stranger(const struct srv_session *session,
                                struct proto_error *error)
{
    uid_t uid = session->user->uid;
    return uid == 0 || uid == geteuid()
               ? 0
               : proto_error_set(error, PCCD_E_ACCESS,
                                 "only the daemon's own user may, not user %u",
                                 (unsigned)uid);
}

void srv_session_cancel_all(struct srv_session *session)
{
    for (struct srv_request *request = session->requests; request != NULL;) {
        struct srv_request *next = request->next;
        srv_request_cancel(request);
        request = next;
    }
}
