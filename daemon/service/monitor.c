/* monitor.c - clients that are told of steps.
 *
 * Room:     service. See monitor.h.
 * Does:     a ring for each session that watches, and a list of them: when nobody does, a
 *           step pays for one look at a pointer.
 * Threads:  [loop]
 */
#include "monitor.h"

#include <stdlib.h>

#include "host.h"
#include "invariant.h"
#include "loop.h"
#include "request.h"
#include "session.h"

int srv_monitor_start(struct srv_session *session, uint64_t of_session, uint32_t of_scene)
{
    srv_assert_loop();
    struct srv_monitor *monitor = session->monitor;
    if (monitor == NULL) {
        monitor = calloc(1, sizeof *monitor);
        if (monitor == NULL) {
            return PCCD_E_NOMEM;
        }
        monitor->session = session;
        monitor->next = session->loop->monitors;
        session->loop->monitors = monitor;
        session->monitor = monitor;
    }
    monitor->of_session = of_session;
    monitor->of_scene = of_scene;
    monitor->lost = 0;
    monitor->lost_now = 0;
    monitor->count = 0;
    return 0;
}

uint64_t srv_monitor_stop(struct srv_session *session)
{
    srv_assert_loop();
    struct srv_monitor *monitor = session->monitor;
    if (monitor == NULL) {
        return 0;
    }
    struct srv_monitor **link = &session->loop->monitors;
    while (*link != monitor) {
        link = &(*link)->next;
    }
    *link = monitor->next;
    uint64_t lost = monitor->lost;
    session->monitor = NULL;
    free(monitor);
    return lost;
}

void srv_monitor_flush(struct srv_session *session)
{
    srv_assert_loop();
    struct srv_monitor *monitor = session->monitor;
    struct srv_conn *conn = session->conn;
    /* Ends: what cannot be sent now waits. */
    while (monitor != NULL && conn != NULL && monitor->count > 0 &&
           srv_conn_is_free(conn)) {
        struct proto_STEP_request *step = &monitor->ring[monitor->first];
        step->lost = monitor->lost_now;
        monitor->lost_now = 0;
        int status =
            proto_encode_notification(session->loop->encoder, PROTO_NOTE_STEP, step);
        PCCD_ASSERT(status == 0);
        monitor->first = (monitor->first + 1) % PROTO_WATCH_ROOM;
        monitor->count--;
        srv_conn_send(conn, session->loop->encoder, NULL, 0);
    }
}

static struct proto_STEP_request describe(const struct srv_request *request,
                                          uint64_t number)
{
    const struct proto_FRAME_SUBMIT_result *answer = &request->result.FRAME_SUBMIT;
    struct proto_STEP_request step = {
        .number = number,
        .session = request->session->id,
        .scene = request->params.FRAME_SUBMIT.scene,
        .step = request->params.FRAME_SUBMIT.step,
        .code = (uint32_t)-request->status,
        .mode = request->params.FRAME_SUBMIT.mode,
    };
    if (request->status == 0) {
        step.incomplete = answer->incomplete;
        step.verdict = answer->verdict;
        step.threads = answer->threads;
        step.total = answer->total;
        step.hash_hi = answer->hash_hi;
        step.hash_lo = answer->hash_lo;
        step.ns_queue = answer->ns_queue;
        step.ns_step = answer->ns_step;
    }
    return step;
}

void srv_monitor_step(const struct srv_request *request, uint64_t number)
{
    srv_assert_loop();
    const struct srv_session *session = request->session;
    for (struct srv_monitor *at = session->loop->monitors; at != NULL; at = at->next) {
        if ((at->of_session != 0 && at->of_session != session->id) ||
            (at->of_scene != 0 && at->of_scene != request->params.FRAME_SUBMIT.scene)) {
            continue;
        }
        if (at->count == PROTO_WATCH_ROOM) {
            at->lost++;
            at->lost_now++;
            continue;
        }
        at->ring[(at->first + at->count++) % PROTO_WATCH_ROOM] =
            describe(request, number);
        srv_monitor_flush(at->session);
    }
}
