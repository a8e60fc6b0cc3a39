/* session.c - what one client has here.
 *
 * The life of a session:
 *
 *     accept --> NEW ----- hello -----> OPEN <-- hello with its secret -- WAITING
 *       |         |                      |  `------ end of file ------------^ |
 *       |         | no hello in time     | bye, violation, shutdown           | time
 *       |         v                      v                                    | is up
 *       `--> REFUSED ----- answer -----> CLOSED <-----------------------------'
 *         (quota full)                   `--> freed
 *           Only the session of a client that asked for it waits (linger.c).
 *           CLOSED waits until request_count = 0 (cancelled ones come back) and
 *           keep_count = 0 (scenes, meshes and ring were freed on the compute thread).
 */
#include "session.h"

#include <stdlib.h>
#include <unistd.h>

#include "enginemem.h"
#include "host.h"
#include "invariant.h"
#include "laststep.h"
#include "now.h"
#include "proto_limits.h"
#include "replies.h"
#include "service.h"

static void settle(struct srv_owner *owner)
{
    srv_session_settle(srv_session_of(owner));
}

/* In no list yet. NULL: no memory. */
static struct srv_session *new_of_user(struct srv_service *service, uid_t uid)
{
    struct srv_session *session = calloc(1, sizeof *session);
    if (session == NULL) {
        return NULL;
    }
    session->owner.user = srv_quota_acquire(&service->quota, uid);
    if (session->owner.user == NULL) {
        free(session);
        return NULL;
    }
    session->service = service;
    session->owner.compute = &service->compute;
    session->owner.pages = &service->pages;
    session->owner.job_list.group = &session->owner.user->jobs;
    session->owner.page_job_list.group = &session->owner.user->page_jobs;
    session->owner.settle = settle;
    session->id = ++service->session_last;
    srv_handles_init(&session->scenes, service->options->scenes_max,
                     SRV_SCENES_GENERATION);
    srv_handles_init(&session->meshes, SRV_HANDLE_INDEX_MAX, SRV_MESHES_GENERATION);
    return session;
}

static void enlist(struct srv_session *session)
{
    struct srv_service *service = session->service;
    session->next = service->sessions;
    if (session->next != NULL) {
        session->next->prev = session;
    }
    service->sessions = session;
}

struct srv_session *srv_session_new_keeper(struct srv_service *service, uid_t uid)
{
    srv_assert_loop();
    struct srv_session *session = new_of_user(service, uid);
    if (session != NULL) {
        session->state = SRV_SESSION_KEEPER;
        session->is_keeper = true;
        enlist(session);
    }
    return session;
}

struct srv_session *srv_session_new(struct srv_service *service, struct srv_conn *conn,
                                    const struct srv_peer *peer)
{
    srv_assert_loop();
    struct srv_session *session = new_of_user(service, peer->uid);
    if (session == NULL) {
        return NULL;
    }
    session->conn = conn;
    session->pid = peer->pid;
    struct proto_error error = {0};
    session->is_stranger = peer->is_stranger;
    session->came_when_full = peer->came_when_full;
    session->counted =
        !peer->is_stranger && !peer->came_when_full &&
        srv_quota_charge(session->owner.user, SRV_QUOTA_CLIENTS, 1, &error) == 0;
    if (!session->counted) {
        session->state = SRV_SESSION_REFUSED;
    }
    enlist(session);
    return session;
}

/* Connections are kept back for these alone: they can let more in. */
static bool finds_connection(const struct srv_session *session)
{
    struct proto_error ignored;
    return !session->came_when_full ||
           srv_session_refuse_stranger(session, &ignored) == 0;
}

bool srv_session_observe(struct srv_session *session)
{
    struct srv_quota_user *user = session->owner.user;
    PCCD_ASSERT(!session->is_observer && session->state != SRV_SESSION_OPEN);
    if (session->is_stranger || user->observers >= SRV_OBSERVERS_MAX ||
        !finds_connection(session)) {
        return false;
    }
    if (session->counted) {
        srv_quota_refund(user, SRV_QUOTA_CLIENTS, 1);
        session->counted = false;
    }
    user->observers++;
    session->is_observer = true;
    session->state = SRV_SESSION_NEW;
    return true;
}

int srv_session_admit(struct srv_session *session, struct proto_error *error)
{
    PCCD_ASSERT(session->state == SRV_SESSION_REFUSED);
    int status = srv_quota_charge(session->owner.user, SRV_QUOTA_CLIENTS, 1, error);
    if (status == 0) {
        session->counted = true;
        session->came_when_full = false;
        session->state = SRV_SESSION_NEW;
    }
    return status;
}

void srv_session_open(struct srv_session *session, uint32_t version)
{
    PCCD_ASSERT(session->state == SRV_SESSION_NEW);
    session->state = SRV_SESSION_OPEN;
    session->version = version;
    session->open_ns = common_now_ns();
    session->service->metrics.counters.sessions_now++;
    session->service->metrics.counters.sessions_total++;
    srv_conn_established(session->conn);
    srv_host_client_joined(session->service);
}

void srv_session_detach(struct srv_session *session)
{
    srv_assert_loop();
    PCCD_ASSERT(session->state != SRV_SESSION_CLOSED);
    struct srv_service *service = session->service;
    bool was_waiting = session->state == SRV_SESSION_WAITING;
    bool was_open = session->state == SRV_SESSION_OPEN || was_waiting;
    service->metrics.counters.sessions_waiting_now -= was_waiting;
    session->conn = NULL;
    session->state = SRV_SESSION_CLOSED;
    session->owner.user->leaving++;
    session->owner.user->observers -= session->is_observer;
    session->owner.user->keepers_leaving += session->is_keeper;
    if (session->counted) {
        srv_quota_refund(session->owner.user, SRV_QUOTA_CLIENTS, 1);
    }
    srv_owner_keep(&session->owner); /* while requests leave it */
    service->let_go(session);
    if (was_open) {
        service->metrics.counters.sessions_now--;
        srv_host_client_left(service);
    }
    srv_owner_release(&session->owner);
}

static int refuse_handle(const struct srv_handles *handles, const char *what,
                         uint32_t want, int status, struct proto_error *error)
{
    if (want == 0) {
        return proto_error_set(error, status, "no room for another %s: there are %u",
                               what, handles->count);
    }
    return proto_error_set(error, status,
                           "%s 0x%x cannot be had: its place is taken, or there is no "
                           "such handle",
                           what, want);
}

/* The slots are the user's, empty ones, too: a handle that is wanted may leave some. */
static int make_slots(struct srv_session *session, struct srv_handles *handles,
                      uint32_t want, struct proto_error *error)
{
    struct srv_quota_user *user = session->owner.user;
    uint32_t count = srv_handles_needs(handles, want);
    if (count <= handles->capacity) {
        return 0;
    }
    struct srv_handle_slot *slots =
        srv_enginemem_new(user, count * sizeof *slots, "a table of handles", error);
    if (slots == NULL) {
        return error->code;
    }
    srv_enginemem_delete(user, srv_handles_move(handles, slots, count));
    return 0;
}

int srv_session_handle(struct srv_session *session, struct srv_handles *handles,
                       const char *what, void *item, uint32_t *handle,
                       struct proto_error *error)
{
    uint32_t want = *handle;
    int status = make_slots(session, handles, want, error);
    if (status != 0) {
        return status;
    }
    status = srv_handles_add(handles, item, want, handle);
    return status != 0 ? refuse_handle(handles, what, want, status, error) : 0;
}

void srv_session_drop_handles(struct srv_session *session, struct srv_handles *handles)
{
    srv_enginemem_delete(session->owner.user, srv_handles_deinit(handles));
}

void srv_session_settle(struct srv_session *session)
{
    if (session->state != SRV_SESSION_CLOSED || session->request_count > 0 ||
        session->owner.keep_count > 0) {
        return;
    }
    struct srv_service *service = session->service;
    PCCD_ASSERT(session->requests == NULL && session->owner.job_list.first == NULL);
    PCCD_ASSERT(session->owner.page_job_list.first == NULL);
    PCCD_ASSERT(session->scenes.count == 0 && session->meshes.count == 0);
    if (session->prev != NULL) {
        session->prev->next = session->next;
    } else {
        service->sessions = session->next;
    }
    if (session->next != NULL) {
        session->next->prev = session->prev;
    }
    srv_session_drop_handles(session, &session->scenes);
    srv_session_drop_handles(session, &session->meshes);
    srv_laststep_set(&service->spare_step, &session->last_step, NULL);
    srv_replies_free(session->replies);
    PCCD_ASSERT(session->spare_requests == NULL);
    struct srv_quota_user *user = session->owner.user;
    PCCD_ASSERT(user->leaving > 0 && user->keepers_leaving >= session->is_keeper);
    user->keepers_leaving -= session->is_keeper;
    free(session);
    user->leaving--;
    srv_conn_room(service,
                  user); /* whoever has waited for this refers to the user, too */
    srv_quota_release(&service->quota, user);
}

int srv_session_refuse_stranger(const struct srv_session *session,
                                struct proto_error *error)
{
    uid_t uid = session->owner.user->uid;
    return uid == 0 || uid == geteuid()
               ? 0
               : proto_error_set(error, PCCD_E_ACCESS,
                                 "only the daemon's own user may, not user %u",
                                 (unsigned)uid);
}

bool srv_session_may_see(const struct srv_session *session,
                         const struct srv_session *other)
{
    struct proto_error ignored;
    return session->owner.user == other->owner.user ||
           srv_session_refuse_stranger(session, &ignored) == 0;
}

bool srv_session_is_listed(const struct srv_session *session)
{
    return session->state == SRV_SESSION_OPEN || session->state == SRV_SESSION_WAITING;
}

int srv_session_find(struct srv_session *session, uint64_t id, struct srv_session **found,
                     struct proto_error *error)
{
    struct srv_session *at = session;
    if (id != 0) {
        at = session->service->sessions;
        while (at != NULL && at->id != id) {
            at = at->next;
        }
    }
    if (at == NULL || !srv_session_is_listed(at) || !srv_session_may_see(session, at)) {
        return proto_error_set(error, PCCD_E_HANDLE, "there is no session %llu",
                               (unsigned long long)id);
    }
    *found = at;
    return 0;
}
