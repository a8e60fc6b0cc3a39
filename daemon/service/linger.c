/* linger.c - sessions that wait for their client to come back.
 *
 * Room:     service. See linger.h.
 * Does:     one timer for all sessions that wait, stopped while none does: an idle daemon
 *           is not woken.
 * Does not: tell a wrong secret from a session that is over: both get a new session.
 * Threads:  [loop]
 */
#include "linger.h"

#include <errno.h>
#include <signal.h>
#include <sys/random.h>

#include "host.h"
#include "invariant.h"
#include "loop.h"
#include "now.h"
#include "replies.h"
#include "session.h"
#include "shared.h"

#define TICK_MS 50u /* between looks at the sessions that wait */

/* Of the engine for a triangle of a mesh while that is committed (twice the 40 that
 * stay, four times where all meet at a vertex), or of an object; on the safe side, as
 * nothing depends on it but whether a session that waits makes room before a refusal or
 * after it. */
#define TRIANGLE_BYTES 512u

void srv_linger_enable(struct srv_session *session)
{
    uint64_t token[2] = {0, 0};
    if (session->loop->options->linger_s == 0 ||
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

static void end(struct srv_session *session, const char *why)
{
    struct srv_loop *loop = session->loop;
    PCCD_ASSERT(session->state == SRV_SESSION_WAITING && loop->linger.count > 0);
    srv_log(SRV_LOG_INFO, session->id, "ended: %s", why);
    if (--loop->linger.count == 0) {
        srv_timer_stop(loop->linger.timer);
    }
    srv_session_detach(session);
}

/* Whether nobody can come back: the process has gone. One that is dead and was not waited
 * for by its parent still counts as there, as does one of another namespace. */
static bool is_gone(const struct srv_session *session)
{
    return session->pid > 0 && kill(session->pid, 0) != 0 && errno == ESRCH;
}

static void on_tick(void *context)
{
    struct srv_loop *loop = context;
    uint64_t patience_ns = (uint64_t)loop->options->linger_s * 1000000000u;
    uint64_t now_ns = srv_now_ns();
    for (struct srv_session *session = loop->sessions; session != NULL;) {
        struct srv_session *next = session->next; /* one that ends may free itself */
        if (session->state == SRV_SESSION_WAITING && is_gone(session)) {
            end(session, "its process is gone");
        } else if (session->state == SRV_SESSION_WAITING &&
                   now_ns - session->lost_ns >= patience_ns) {
            end(session, "nobody came back");
        }
        session = next;
    }
}

int srv_linger_init(struct srv_loop *loop)
{
    loop->linger.timer = srv_timer_new(loop, on_tick, loop);
    return loop->linger.timer != NULL ? 0 : PCCD_E_NOMEM;
}

void srv_linger_deinit(struct srv_loop *loop)
{
    srv_timer_free(loop->linger.timer);
    loop->linger.timer = NULL;
}

static bool may_wait(const struct srv_session *session)
{
    return session->state == SRV_SESSION_OPEN && session->replies != NULL &&
           !session->replies->is_broken && !session->is_ending &&
           session->loop->phase == SRV_PHASE_RUNNING;
}

void srv_linger_lost(struct srv_session *session)
{
    srv_assert_loop();
    struct srv_loop *loop = session->loop;
    if (!may_wait(session)) {
        srv_session_detach(session);
        return;
    }
    srv_session_hold(session);
    session->conn = NULL;
    session->state = SRV_SESSION_WAITING;
    session->lost_ns = srv_now_ns();
    loop->metrics.counters.sessions_waiting_now++;
    if (loop->linger.count++ == 0) {
        srv_timer_start(loop->linger.timer, TICK_MS, TICK_MS);
    }
    srv_log(SRV_LOG_DEBUG, session->id, "waits for its client");
}

bool srv_linger_evict(struct srv_loop *loop, const struct srv_quota_user *user)
{
    struct srv_session *oldest = NULL;
    for (struct srv_session *at = loop->sessions; at != NULL; at = at->next) {
        if (at->state == SRV_SESSION_WAITING && at->user == user &&
            (oldest == NULL || at->lost_ns < oldest->lost_ns)) {
            oldest = at;
        }
    }
    if (oldest != NULL) {
        end(oldest, "its user needs the place");
    }
    return oldest != NULL;
}

static bool one_waits(const struct srv_loop *loop, const struct srv_quota_user *user)
{
    const struct srv_session *at = loop->linger.count > 0 ? loop->sessions : NULL;
    while (at != NULL && (at->state != SRV_SESSION_WAITING || at->user != user)) {
        at = at->next;
    }
    return at != NULL;
}

bool srv_linger_make_room(const struct srv_session *session)
{
    struct srv_loop *loop = session->loop;
    return !loop->quota.is_beyond &&
           (session->user->leaving > 0 || srv_linger_evict(loop, session->user));
}

bool srv_linger_is_tight(const struct srv_session *session, uint64_t triangles)
{
    const struct srv_loop *loop = session->loop;
    const struct srv_quota_user *user = session->user;
    uint64_t limit = loop->options->engine_bytes_max;
    uint64_t wanted =
        triangles < limit / TRIANGLE_BYTES ? triangles * TRIANGLE_BYTES : limit;
    int64_t used = atomic_load_explicit(&user->engine.bytes, memory_order_relaxed);
    return used > 0 && (uint64_t)used > limit - wanted &&
           (user->leaving > 0 || one_waits(loop, user));
}

void srv_linger_end_all(struct srv_loop *loop)
{
    for (struct srv_session *session = loop->sessions; session != NULL;) {
        struct srv_session *next = session->next;
        if (session->state == SRV_SESSION_WAITING) {
            end(session, "the daemon is shutting down");
        }
        session = next;
    }
}

/* ---- coming back ------------------------------------------------------------------- */

struct srv_session *srv_linger_find(struct srv_loop *loop,
                                    const struct proto_HELLO_request *request,
                                    const struct srv_quota_user *user)
{
    if (request->resume_session == 0 || request->resume_epoch != loop->epoch) {
        return NULL;
    }
    struct srv_session *at = loop->sessions;
    while (at != NULL && at->id != request->resume_session) {
        at = at->next;
    }
    if (at == NULL || at->user != user || at->replies == NULL || at->is_ending ||
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
    struct srv_loop *loop = session->loop;
    struct srv_conn *conn = fresh->conn;
    PCCD_ASSERT(conn != NULL && session != fresh);
    if (session->conn != NULL) {
        srv_conn_orphan(session->conn); /* its end has not been noticed yet */
        srv_session_hold(session);
    }
    if (session->state == SRV_SESSION_WAITING) {
        loop->metrics.counters.sessions_waiting_now--;
        if (--loop->linger.count == 0) {
            srv_timer_stop(loop->linger.timer);
        }
    }
    session->state = SRV_SESSION_OPEN;
    session->conn = conn;
    session->pid = fresh->pid;
    srv_conn_adopt(conn, session);
    srv_conn_established(conn);
    loop->metrics.counters.sessions_resumed++;
    srv_shared_resumed(session);
    srv_session_detach(fresh);
}
