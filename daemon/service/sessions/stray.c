/* stray.c - memory that clients take without having been given it.
 *
 * Room:     service. See stray.h.
 * Does:     one timer. Nothing tells when a client touches a page, so it is looked; a
 *           microsecond for each session.
 * Threads:  [loop]
 */
#include "stray.h"

#include <stddef.h>

#include "host.h"
#include "invariant.h"
#include "log.h"
#include "now.h"
#include "pccd_types.h"
#include "ringio.h"
#include "service.h"
#include "session.h"

#define SOON_MS   1000u
#define SELDOM_MS 30000u

#define OLDER_MAX 4u  /* rings of a session besides the last; two descriptors each */
#define LEFT_MAX  64u /* sessions that have left a ring; likewise */

/* ---- rings that are not used any more ---------------------------------------------- */

/* At its end the daemon leaves rings as they are: clients take to the next one what they
 * have there. */
static bool empties(const struct srv_service *service)
{
    return srv_stray_looks(service) && service->phase == SRV_PHASE_RUNNING;
}

static void drop_rings(struct srv_session *session)
{
    while (session->ring != NULL) {
        struct srv_ring *ring = session->ring;
        session->ring = ring->older;
        srv_ring_drop(ring, empties(session->service));
    }
}

/* Returns how many earlier rings of the session are still needed; the others go. */
static uint32_t drop_older(struct srv_session *session)
{
    struct srv_ring **at = session->ring != NULL ? &session->ring->older : NULL;
    uint32_t count = 0;
    while (at != NULL && *at != NULL) {
        struct srv_ring *ring = *at;
        if (srv_ring_is_needed(ring)) {
            count++;
            at = &ring->older;
        } else {
            *at = ring->older;
            srv_ring_drop(ring, empties(session->service));
        }
    }
    return count;
}

int srv_stray_may_replace(struct srv_session *session, struct proto_error *error)
{
    srv_assert_loop();
    uint32_t count = drop_older(session);
    return count < OLDER_MAX
               ? 0
               : proto_error_set(error, PCCD_E_BUSY,
                                 "%u earlier rings have pages that are not released: "
                                 "release them first",
                                 count);
}

void srv_stray_replace(struct srv_session *session, struct srv_ring *ring)
{
    srv_assert_loop();
    struct srv_ring *replaced = session->ring;
    session->ring = ring;
    if (replaced != NULL && srv_stray_looks(session->service)) {
        ring->older = replaced;
        srv_ring_end(replaced, false);
        (void)drop_older(session);
    } else if (replaced != NULL) {
        srv_ring_drop(replaced, false);
    }
}

/* ---- sessions that have left a ring ------------------------------------------------ */

/* A client that would come back, and does not know yet that it cannot, has the last
 * positions in its slots, and answers that it reads. */
static bool may_leave(const struct srv_session *session)
{
    return session->is_resumable && !session->is_ending && empties(session->service) &&
           !srv_session_is_gone(session);
}

void srv_stray_let_go(struct srv_session *session)
{
    srv_assert_loop();
    if (session->ring != NULL && may_leave(session)) {
        srv_ring_end(session->ring, true);
    } else {
        drop_rings(session);
    }
}

static bool is_needed(const struct srv_session *session)
{
    bool is_needed = false;
    for (const struct srv_ring *at = session->ring; at != NULL; at = at->older) {
        is_needed = is_needed || srv_ring_is_needed(at);
    }
    return is_needed;
}

void srv_stray_leave(struct srv_session *session)
{
    srv_assert_loop();
    struct srv_service *service = session->service;
    struct srv_quota_user *user = session->owner.user;
    PCCD_ASSERT(session->state == SRV_SESSION_CLOSED && session->ring != NULL);
    if (!may_leave(session) || !is_needed(session)) {
        drop_rings(session);
        return;
    }
    if (service->left_count >= LEFT_MAX && !srv_stray_evict(service, user)) {
        (void)srv_stray_evict(service, NULL);
    }
    srv_log(SRV_LOG_DEBUG, session->id, "is over; its ring stays while it is needed");
    session->state = SRV_SESSION_LEFT;
    session->lost_ns = common_now_ns();
    service->left_count++;
    user->left++;
    user->hosts_leaving -= session->is_host;
    session->is_host = false;
    user->leaving--;
    srv_stray_use(service); /* look whether it is needed for long */
    srv_conn_room(service, user);
}

/* It is CLOSED again until its rings are freed. */
static void end_left(struct srv_session *session)
{
    PCCD_ASSERT(session->state == SRV_SESSION_LEFT);
    session->state = SRV_SESSION_CLOSED;
    session->service->left_count--;
    session->owner.user->left--;
    session->owner.user->leaving++;
    drop_rings(session);
}

bool srv_stray_evict(struct srv_service *service, const struct srv_quota_user *user)
{
    srv_assert_loop();
    struct srv_session *oldest = NULL;
    for (struct srv_session *at = service->sessions; at != NULL; at = at->next) {
        if (at->state == SRV_SESSION_LEFT && (user == NULL || at->owner.user == user) &&
            (oldest == NULL || at->lost_ns < oldest->lost_ns)) {
            oldest = at;
        }
    }
    if (oldest != NULL) {
        end_left(oldest);
    }
    return oldest != NULL;
}

/* ---- looking ----------------------------------------------------------------------- */

/* Returns what srv_ring_look does of one of the rings. *is_stray: one has strays. */
static int look_at(const struct srv_session *session, bool *is_stray,
                   struct proto_error *error)
{
    int status = 0;
    for (struct srv_ring *at = session->ring; at != NULL && status == 0; at = at->older) {
        status = srv_ring_look(at, error);
        *is_stray = *is_stray || at->was_stray;
    }
    return status;
}

static void look(void *context)
{
    struct srv_service *service = context;
    bool has_ring = false;
    bool is_stray = false;
    for (struct srv_session *at = service->sessions; at != NULL;) {
        struct srv_session *next = at->next; /* one that ends may free itself */
        struct proto_error error = {0};
        bool is_left = at->state == SRV_SESSION_LEFT;
        bool is_over = at->state == SRV_SESSION_CLOSED; /* what uses its ring ends */
        has_ring = has_ring || at->ring != NULL;
        if (is_left && (!is_needed(at) || srv_session_is_gone(at))) {
            end_left(at);
        } else if (is_over || look_at(at, &is_stray, &error) == 0) {
            (void)(is_over ? 0 : drop_older(at));
        } else if (is_left) {
            end_left(at);
        } else {
            service->refuse(at, &error);
        }
        at = next;
    }
    service->is_stray_soon = is_stray;
    if (has_ring) {
        srv_timer_start(service->stray, is_stray ? SOON_MS : SELDOM_MS, 0);
    }
}

int srv_stray_init(struct srv_service *service)
{
    service->stray = srv_timer_new(service, look, service);
    return service->stray != NULL ? 0 : PCCD_E_NOMEM;
}

void srv_stray_deinit(struct srv_service *service)
{
    srv_timer_free(service->stray);
    service->stray = NULL;
}

bool srv_stray_looks(const struct srv_service *service)
{
    return service->stray != NULL;
}

void srv_stray_use(struct srv_service *service)
{
    if (service->stray != NULL && !service->is_stray_soon) {
        service->is_stray_soon = true;
        srv_timer_start(service->stray, SOON_MS, 0);
    }
}
