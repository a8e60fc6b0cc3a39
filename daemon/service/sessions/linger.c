/* linger.c - sessions that wait for their client to come back. */
#include "linger.h"

#include <errno.h>
#include <signal.h>
#include <sys/random.h>

#include "host.h"
#include "invariant.h"
#include "log.h"
#include "now.h"
#include "replies.h"
#include "service.h"
#include "session.h"

#define TICK_MS 50u /* between looks at the sessions that wait */

void srv_linger_enable(struct srv_session *session)
{
    uint64_t token[2] = {0, 0};
    if (session->service->options->linger_s == 0 ||
        getrandom(token, sizeof token, GRND_NONBLOCK) != (ssize_t)sizeof token) {
        return;
    }
    session->replies = srv_replies_new();
    if (session->replies != NULL) {
        session->token[0] = token[0];
        session->token[1] = token[1] == 0 ? 1 : token[1]; /* both 0 means none */
    }
}

/* ---- waiting ----------------------------------------------------------------------- */

/* One session fewer waits. */
static void stop_waiting(struct srv_session *session)
{
    struct srv_service *service = session->service;
    PCCD_ASSERT(session->state == SRV_SESSION_WAITING && service->waiting_count > 0);
    session->owner.user->waiting--;
    if (--service->waiting_count == 0) {
        srv_timer_stop(service->linger);
    }
}

void srv_linger_end(struct srv_session *session, const char *why)
{
    srv_log(SRV_LOG_INFO, session->id, "ended: %s", why);
    stop_waiting(session);
    srv_session_detach(session);
}

/* Return whether nobody can come back: the process has gone. One that is dead and was not
 * waited for by its parent still counts as there, as does one of another namespace. */
static bool is_gone(const struct srv_session *session)
{
    return session->pid > 0 && kill(session->pid, 0) != 0 && errno == ESRCH;
}

static void on_tick(void *context)
{
    struct srv_service *service = context;
    uint64_t patience_ns = (uint64_t)service->options->linger_s * 1000000000u;
    uint64_t now_ns = common_now_ns();
    for (struct srv_session *session = service->sessions; session != NULL;) {
        struct srv_session *next = session->next; /* one that ends may free itself */
        if (session->state == SRV_SESSION_WAITING && is_gone(session)) {
            srv_linger_end(session, "its process is gone");
        } else if (session->state == SRV_SESSION_WAITING &&
                   now_ns - session->lost_ns >= patience_ns) {
            srv_linger_end(session, "nobody came back");
        }
        session = next;
    }
}

int srv_linger_init(struct srv_service *service)
{
    service->linger = srv_timer_new(service, on_tick, service);
    return service->linger != NULL ? 0 : PCCD_E_NOMEM;
}

void srv_linger_deinit(struct srv_service *service)
{
    srv_timer_free(service->linger);
    service->linger = NULL;
}

static bool may_wait(const struct srv_session *session)
{
    return session->state == SRV_SESSION_OPEN && session->replies != NULL &&
           !session->replies->is_broken && !session->is_ending &&
           session->service->phase == SRV_PHASE_RUNNING;
}

void srv_linger_lost(struct srv_session *session)
{
    srv_assert_loop();
    struct srv_service *service = session->service;
    if (!may_wait(session)) {
        srv_session_detach(session);
        return;
    }
    session->connection++; /* what is in flight came with the lost one */
    session->conn = NULL;
    session->state = SRV_SESSION_WAITING;
    session->lost_ns = common_now_ns();
    service->metrics.counters.sessions_waiting_now++;
    session->owner.user->waiting++;
    if (service->waiting_count++ == 0) {
        srv_timer_start(service->linger, TICK_MS, TICK_MS);
    }
    srv_log(SRV_LOG_DEBUG, session->id, "waits for its client");
}

bool srv_linger_evict(struct srv_service *service, const struct srv_quota_user *user)
{
    struct srv_session *oldest = NULL;
    for (struct srv_session *at = service->sessions; at != NULL; at = at->next) {
        if (at->state == SRV_SESSION_WAITING && at->owner.user == user &&
            (oldest == NULL || at->lost_ns < oldest->lost_ns)) {
            oldest = at;
        }
    }
    if (oldest != NULL) {
        srv_linger_end(oldest, "its user needs the place");
    }
    return oldest != NULL;
}

bool srv_linger_make_room(const struct srv_session *session)
{
    struct srv_service *service = session->service;
    return !service->quota.is_beyond && (session->owner.user->leaving > 0 ||
                                         srv_linger_evict(service, session->owner.user));
}

void srv_linger_end_all(struct srv_service *service)
{
    for (struct srv_session *session = service->sessions; session != NULL;) {
        struct srv_session *next = session->next;
        if (session->state == SRV_SESSION_WAITING) {
            srv_linger_end(session, "the daemon is shutting down");
        }
        session = next;
    }
}

/* ---- coming back ------------------------------------------------------------------- */

struct srv_session *srv_linger_find(struct srv_service *service,
                                    const struct proto_HELLO_request *request,
                                    const struct srv_quota_user *user)
{
    if (request->resume_session == 0 || request->resume_epoch != service->epoch) {
        return NULL;
    }
    struct srv_session *at = service->sessions;
    while (at != NULL && at->id != request->resume_session) {
        at = at->next;
    }
    if (at == NULL || at->owner.user != user || at->replies == NULL || at->is_ending ||
        at->replies->is_broken ||
        (at->state != SRV_SESSION_WAITING && at->state != SRV_SESSION_OPEN)) {
        return NULL;
    }
    /* All of it is looked at, so that time tells nothing. */
    uint64_t differs =
        (at->token[0] ^ request->token_hi) | (at->token[1] ^ request->token_lo);
    return differs == 0 ? at : NULL;
}

void srv_linger_resume(struct srv_session *session, struct srv_session *fresh)
{
    srv_assert_loop();
    struct srv_service *service = session->service;
    struct srv_conn *conn = fresh->conn;
    PCCD_ASSERT(conn != NULL && session != fresh);
    if (session->conn != NULL) {
        srv_conn_orphan(session->conn); /* its end has not been noticed yet */
        session->connection++;          /* what is in flight came with the lost one */
    }
    if (session->state == SRV_SESSION_WAITING) {
        service->metrics.counters.sessions_waiting_now--;
        stop_waiting(session);
    }
    session->state = SRV_SESSION_OPEN;
    session->conn = conn;
    session->pid = fresh->pid;
    srv_conn_adopt(conn, session);
    srv_conn_established(conn);
    service->metrics.counters.sessions_resumed++;
    srv_session_detach(fresh);
}
