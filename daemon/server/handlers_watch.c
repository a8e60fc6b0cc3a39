/* handlers_watch.c - stats.thread.
 *
 * Room:     server. See call.h.
 * Does:     let clients watch their own steps, and the daemon's user anybody's.
 * Does not: show a client what another user does.
 * Threads:  [loop].
 */
#include "call.h"
#include "loop.h"
#include "session.h"

int srv_on_STATS_THREAD(struct srv_call *call)
{
    const struct proto_STATS_THREAD_request *request = &call->params.STATS_THREAD;
    struct proto_STATS_THREAD_result *result = &call->result.STATS_THREAD;
    const struct srv_session *session = call->session;
    if (request->any) {
        int status = srv_session_refuse_stranger(session, &call->error);
        if (status != 0) {
            return status;
        }
    }
    const struct srv_laststep *last =
        request->any ? session->loop->last_step : session->last_step;
    uint32_t count = last != NULL ? last->thread_count : 0;
    if (request->thread >= count && (count > 0 || request->thread > 0)) {
        return proto_error_set(&call->error, PCCD_E_INVAL,
                               "thread is %u, the last step had %u", request->thread,
                               count);
    }
    if (last == NULL) {
        return 0;
    }
    *result = (struct proto_STATS_THREAD_result){
        .threads = count,
        .number = last->number,
        .scheduler = last->answer.scheduler,
        .high_level = last->answer.high_level,
        .refit = last->answer.refit,
        .ns_ingest = last->answer.ns_ingest,
        .ns_refit = last->answer.ns_refit,
        .ns_low = last->answer.ns_low,
        .ns_high = last->answer.ns_high,
        .ns_merge = last->answer.ns_merge,
        .ns_step = last->answer.ns_step,
    };
    const struct eng_thread_record *record = &last->threads[request->thread];
#define COPY(type, name, need, text) result->name = record->name;
    PROTO_THREAD_RECORD(COPY)
#undef COPY
    return 0;
}
