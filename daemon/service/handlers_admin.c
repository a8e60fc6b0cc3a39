/* handlers_admin.c - ping, stats, stats.histogram, cancel and shm.attach.
 *
 * Room:     service. See call.h.
 * Does:     what concerns the session and the daemon rather than geometry.
 * Does not: send: dispatch.c does.
 * Threads:  [loop], but for functions named work_.
 */
#include <string.h>
#include <unistd.h>

#include "call.h"
#include "invariant.h"
#include "kernel.h"
#include "loop.h"
#include "memory.h"
#include "now.h"
#include "request.h"
#include "session.h"

int srv_on_PING(struct srv_call *call)
{
    call->result.PING.token = call->params.PING.token;
    call->result.PING.uptime_ns = call->arrival_ns - call->session->loop->start_ns;
    return 0;
}

int srv_on_STATS(struct srv_call *call)
{
    struct srv_loop *loop = call->session->loop;
    struct proto_STATS_result *result = &call->result.STATS;
    *result = loop->metrics.counters;
    result->uptime_ns = call->arrival_ns - loop->start_ns;
    result->pid = (uint64_t)getpid();
    result->threads_max = loop->options->threads_max;
    result->meshes_now = loop->quota.total[SRV_QUOTA_MESHES];
    result->triangles_now = loop->quota.total[SRV_QUOTA_TRIANGLES];
    result->shm_bytes_now =
        atomic_load_explicit(&loop->quota.shared, memory_order_relaxed);
    result->jobs_queued_now =
        srv_compute_queued(&loop->compute) + srv_compute_queued(&loop->pages);
    result->allocs = eng_alloc_count();
    result->engine_bytes_now = eng_alloc_bytes();
    result->memory_bytes_max = loop->options->memory_total_max;
    result->memory_refusals = loop->quota.refusals;
    strcpy(result->cpu, eng_kernels()->name);
    return 0;
}

int srv_on_STATS_HISTOGRAM(struct srv_call *call)
{
    const struct srv_metrics *metrics = &call->session->loop->metrics;
    uint32_t kind = call->params.STATS_HISTOGRAM.kind;
    if (kind >= PCCD_HISTOGRAM_COUNT) {
        return proto_error_set(&call->error, PCCD_E_INVAL, "there is no histogram %u",
                               kind);
    }
    call->result.STATS_HISTOGRAM = metrics->histograms[kind];
    return 0;
}

int srv_on_CANCEL(struct srv_call *call)
{
    struct srv_request *request =
        srv_session_request(call->session, call->params.CANCEL.id);
    call->result.CANCEL.found = request != NULL;
    if (request != NULL) {
        srv_request_cancel(request);
    }
    return 0;
}

/* ---- shm.attach -------------------------------------------------------------------- */

static int work_attach(struct srv_request *request)
{
    return srv_ring_create(request->plan.attached, request->session->loop->epoch,
                           &request->error);
}

static void finish_attach(struct srv_request *request)
{
    struct srv_session *session = request->session;
    struct srv_ring *ring = request->plan.attached;
    session->attaching = false;
    if (request->status != 0 || session->conn == NULL) {
        srv_resource_drop(&ring->resource);
        return;
    }
    request->result.SHM_ATTACH = (struct proto_SHM_ATTACH_result){
        .upload_bytes = ring->upload_bytes,
        .result_bytes = ring->result_bytes,
        .slot_count = ring->slot_count,
        .slot_stride = ring->slot_stride,
        .inflight_max = ring->inflight_max,
    };
    /* The answer takes the descriptors along; the mappings are all the daemon needs. */
    request->fds[0] = ring->upload.fd;
    request->fds[1] = ring->results.fd;
    ring->upload.fd = -1;
    ring->results.fd = -1;
    if (session->ring != NULL) {
        srv_resource_drop(&session->ring->resource);
    }
    session->ring = ring;
}

int srv_on_SHM_ATTACH(struct srv_call *call)
{
    struct srv_session *session = call->session;
    struct srv_loop *loop = session->loop;
    struct proto_SHM_ATTACH_result sizes = {0};
    uint32_t unanswered = session->request_count - session->overdue_count;
    if (unanswered > 0) {
        return proto_error_set(&call->error, PCCD_E_STATE,
                               "a ring is attached only while nothing is in flight; %u "
                               "requests are",
                               unanswered);
    }
    int status = srv_ring_sizes(&call->params.SHM_ATTACH, &sizes, &call->error);
    if (status != 0) {
        return status;
    }
    sizes.inflight_max = sizes.slot_count < loop->options->inflight_max
                             ? sizes.slot_count
                             : loop->options->inflight_max;
    /* What could never be taken is refused at once. */
    uint64_t whole = sizes.upload_bytes + sizes.result_bytes;
    uint64_t bytes = srv_quota_is_beyond(&loop->quota, SRV_QUOTA_SHM_BYTES, whole)
                         ? whole
                         : srv_ring_bytes_first(&sizes);
    status = srv_quota_charge(&loop->quota, session->user, SRV_QUOTA_SHM_BYTES, bytes,
                              &call->error);
    if (status != 0) {
        return status;
    }
    struct srv_ring *ring = srv_ring_new(session, &sizes);
    if (ring == NULL) {
        srv_quota_refund(&loop->quota, session->user, SRV_QUOTA_SHM_BYTES, bytes);
        return proto_error_set(&call->error, PCCD_E_NOMEM, "no memory for a ring");
    }
    struct srv_plan plan = {
        .work = work_attach, .finish = finish_attach, .attached = ring};
    status = srv_request_start(call, &plan);
    if (status < 0) {
        srv_resource_drop(&ring->resource);
        return status;
    }
    session->attaching = true;
    return status;
}
