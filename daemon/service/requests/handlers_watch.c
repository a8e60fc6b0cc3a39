/* handlers_watch.c - stats.thread, watch, and trace.start, stop and dump. */
#include <string.h>

#include "call.h"
#include "request.h"
#include "service.h"
#include "session.h"
#include "tracing.h"
#include "watcher.h"

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
        request->any ? session->service->last_step : session->last_step;
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
        .batch = last->batch,
        .ns_ingest = last->answer.ns_ingest,
        .ns_refit = last->answer.ns_refit,
        .ns_low = last->answer.ns_low,
        .ns_high = last->answer.ns_high,
        .ns_merge = last->answer.ns_merge,
        .ns_step = last->answer.ns_step,
    };
    memcpy(result->tuning, last->answer.tuning, sizeof result->tuning);
    const struct eng_thread_record *record = &last->threads[request->thread].record;
    result->scenes = last->threads[request->thread].scenes;
#define COPY(type, name, need, text) result->name = record->name;
    PROTO_THREAD_RECORD(COPY)
#undef COPY
    return 0;
}

/* ---- watch ------------------------------------------------------------------------- */

int srv_on_WATCH_START(struct srv_call *call)
{
    const struct proto_WATCH_START_request *request = &call->params.WATCH_START;
    struct srv_session *watched = NULL;
    int status =
        request->session != 0
            ? srv_session_find(call->session, request->session, &watched, &call->error)
            : srv_session_refuse_stranger(call->session, &call->error);
    if (status != 0) {
        return status;
    }
    if (srv_watcher_start(call->session, request->session, request->scene) != 0) {
        return proto_error_set(&call->error, PCCD_E_NOMEM, "no memory for %u steps",
                               PROTO_WATCH_ROOM);
    }
    call->result.WATCH_START.room = PROTO_WATCH_ROOM;
    return 0;
}

int srv_on_WATCH_STOP(struct srv_call *call)
{
    call->result.WATCH_STOP.lost = srv_watcher_stop(call->session);
    return 0;
}

/* ---- trace.start ------------------------------------------------------------------- */

static int work_start(struct srv_request *request)
{
    struct srv_tracing *tracing = request->plan.tracing;
    int status = srv_tracing_start(tracing);
    if (status != 0) {
        return proto_error_set(&request->error, status,
                               "no memory for %u events of each of %u threads",
                               tracing->capacity, tracing->tracks);
    }
    request->result.TRACE_START = (struct proto_TRACE_START_result){
        .threads = tracing->tracks, .events = tracing->capacity};
    return 0;
}

static void finish_start(struct srv_request *request)
{
    struct srv_tracing *tracing = request->plan.tracing;
    if (request->status == 0) {
        tracing->is_recording = true;
    } else if (request->session->service->tracing == tracing) {
        srv_tracing_drop(request->session);
    }
}

int srv_on_TRACE_START(struct srv_call *call)
{
    const struct proto_TRACE_START_request *start = &call->params.TRACE_START;
    struct srv_session *session = call->session;
    const struct srv_tracing *other = session->service->tracing;
    int status = srv_session_refuse_stranger(session, &call->error);
    if (status != 0) {
        return status;
    }
    if (other != NULL && other->resource.owner != &session->owner) {
        return proto_error_set(
            &call->error, PCCD_E_BUSY, "session %llu is recording",
            (unsigned long long)srv_session_of(other->resource.owner)->id);
    }
    if (other != NULL && !other->is_stopped) {
        return proto_error_set(&call->error, PCCD_E_STATE,
                               "this session is recording already");
    }
    srv_tracing_drop(session); /* one that is over */
    struct srv_plan plan = {
        .work = work_start, .finish = finish_start, .ring = session->ring};
    status = srv_tracing_new(session, start->events, start->min_ns, &plan.tracing,
                             &call->error);
    if (status != 0) {
        return status;
    }
    status = srv_request_start(call, &plan);
    if (status < 0) {
        srv_tracing_drop(session);
    }
    return status;
}

/* ---- trace.stop -------------------------------------------------------------------- */

/* The session's recording; NULL with the error set. */
static struct srv_tracing *find_tracing(struct srv_call *call)
{
    struct srv_tracing *tracing = call->session->service->tracing;
    if (tracing == NULL || tracing->resource.owner != &call->session->owner) {
        proto_error_set(&call->error, PCCD_E_STATE, "this session has no recording");
        return NULL;
    }
    return tracing;
}

static int work_stop(struct srv_request *request)
{
    struct srv_tracing *tracing = request->plan.tracing;
    struct proto_TRACE_STOP_result *result = &request->result.TRACE_STOP;
    srv_tracing_stop(tracing);
    result->events = srv_tracing_count(tracing, &result->lost);
    return 0;
}

/* The loop's own events end here and now; those of steps, when their turn comes. */
int srv_on_TRACE_STOP(struct srv_call *call)
{
    struct srv_tracing *tracing = find_tracing(call);
    if (tracing == NULL) {
        return call->error.code;
    }
    if (!tracing->is_recording && !tracing->is_stopped) {
        return proto_error_set(&call->error, PCCD_E_STATE,
                               "the recording has not begun yet");
    }
    struct srv_plan plan = {
        .work = work_stop, .ring = call->session->ring, .tracing = tracing};
    int status = srv_request_start(call, &plan);
    if (status >= 0) {
        tracing->is_recording = false;
        tracing->is_stopped = true;
    }
    return status;
}

/* ---- trace.dump -------------------------------------------------------------------- */

static int work_dump(struct srv_request *request)
{
    const struct proto_TRACE_DUMP_request *dump = &request->params.TRACE_DUMP;
    const struct srv_tracing *tracing = request->plan.tracing;
    uint64_t lost = 0;
    uint64_t events = srv_tracing_count(tracing, &lost);
    if (dump->cursor > events) {
        return proto_error_set(&request->error, PCCD_E_INVAL,
                               "cursor is %llu, the recording has %llu events",
                               (unsigned long long)dump->cursor,
                               (unsigned long long)events);
    }
    uint64_t left = events - dump->cursor;
    struct srv_page page;
    void *data = NULL;
    int status = srv_ring_reserve(request->plan.ring, sizeof(struct pccd_trace_event),
                                  dump->count < left ? dump->count : left, &page, &data,
                                  &request->error);
    if (status != 0) {
        return status;
    }
    srv_tracing_copy(tracing, dump->cursor, page.count, data);
    request->result.TRACE_DUMP =
        (struct proto_TRACE_DUMP_result){.events = events,
                                         .count = (uint32_t)page.count,
                                         .offset = page.position,
                                         .release = page.release};
    return 0;
}

int srv_on_TRACE_DUMP(struct srv_call *call)
{
    struct srv_tracing *tracing = find_tracing(call);
    if (tracing == NULL) {
        return call->error.code;
    }
    if (!tracing->is_stopped) {
        return proto_error_set(&call->error, PCCD_E_STATE,
                               "the recording is on; trace.stop first");
    }
    struct srv_ring *ring = NULL;
    int status = srv_admit_ring(call, &ring);
    if (status != 0) {
        return status;
    }
    struct srv_plan plan = {.work = work_dump, .ring = ring, .tracing = tracing};
    return srv_request_start(call, &plan);
}
