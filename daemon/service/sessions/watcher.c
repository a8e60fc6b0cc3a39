/* watcher.c - clients that are told of steps. */
#include "watcher.h"

#include <stdlib.h>

#include "host.h"
#include "invariant.h"
#include "service.h"
#include "session.h"

int srv_watcher_start(struct srv_session *session, uint64_t of_session, uint32_t of_scene)
{
    srv_assert_loop();
    struct srv_watcher *watcher = session->watcher;
    if (watcher == NULL) {
        watcher = calloc(1, sizeof *watcher);
        if (watcher == NULL) {
            return PCCD_E_NOMEM;
        }
        watcher->session = session;
        watcher->next = session->service->watchers;
        session->service->watchers = watcher;
        session->watcher = watcher;
    }
    watcher->of_session = of_session;
    watcher->of_scene = of_scene;
    watcher->lost = 0;
    watcher->lost_now = 0;
    watcher->count = 0;
    return 0;
}

uint64_t srv_watcher_stop(struct srv_session *session)
{
    srv_assert_loop();
    struct srv_watcher *watcher = session->watcher;
    if (watcher == NULL) {
        return 0;
    }
    struct srv_watcher **link = &session->service->watchers;
    while (*link != watcher) {
        link = &(*link)->next;
    }
    *link = watcher->next;
    uint64_t lost = watcher->lost;
    session->watcher = NULL;
    free(watcher);
    return lost;
}

void srv_watcher_flush(struct srv_session *session)
{
    srv_assert_loop();
    struct srv_watcher *watcher = session->watcher;
    struct srv_conn *conn = session->conn;
    /* Ends: what cannot be sent now waits. */
    while (watcher != NULL && conn != NULL && watcher->count > 0 &&
           srv_conn_is_free(conn)) {
        struct proto_STEP_request *step = &watcher->ring[watcher->first];
        step->lost = watcher->lost_now;
        watcher->lost_now = 0;
        int status =
            proto_encode_notification(session->service->encoder, PROTO_NOTE_STEP, step);
        PCCD_ASSERT(status == 0);
        watcher->first = (watcher->first + 1) % PROTO_WATCH_ROOM;
        watcher->count--;
        srv_conn_send(conn, session->service->encoder, NULL, 0);
    }
}

void srv_watcher_step(const struct srv_service *service,
                      const struct proto_STEP_request *step)
{
    srv_assert_loop();
    for (struct srv_watcher *at = service->watchers; at != NULL; at = at->next) {
        if ((at->of_session != 0 && at->of_session != step->session) ||
            (at->of_scene != 0 && at->of_scene != step->scene)) {
            continue;
        }
        if (at->count == PROTO_WATCH_ROOM) {
            at->lost++;
            at->lost_now++;
            continue;
        }
        at->ring[(at->first + at->count++) % PROTO_WATCH_ROOM] = *step;
        srv_watcher_flush(at->session);
    }
}
