/* handlers_admin.c - ping, stats, stats.histogram, cancel, shm.attach and shm.take. */
#include <string.h>
#include <unistd.h>

#include "call.h"
#include "invariant.h"
#include "log.h"
#include "now.h"
#include "request.h"
#include "service.h"
#include "session.h"
#include "stray.h"

int srv_on_PING(struct srv_call *call)
{
    call->result.PING.token = call->params.PING.token;
    call->result.PING.uptime_ns = call->arrival_ns - call->session->service->start_ns;
    return 0;
}

int srv_on_STATS(struct srv_call *call)
{
    struct srv_service *service = call->session->service;
    struct proto_STATS_result *result = &call->result.STATS;
    *result = service->metrics.counters;
    result->uptime_ns = call->arrival_ns - service->start_ns;
    result->pid = (uint64_t)getpid();
    result->threads_max = service->options->threads_max;
    result->meshes_now = service->quota.total[SRV_QUOTA_MESHES];
    result->triangles_now = service->quota.total[SRV_QUOTA_TRIANGLES];
    result->shm_bytes_now =
        atomic_load_explicit(&service->quota.shared, memory_order_relaxed);
    result->jobs_queued_now =
        srv_compute_queued(&service->compute) + srv_compute_queued(&service->pages);
    result->allocs = eng_alloc_count();
    result->engine_bytes_now = eng_alloc_bytes();
    result->memory_bytes_max = service->options->memory_total_max;
    result->memory_refusals = service->quota.refusals;
    result->log_lines_lost = srv_log_lost();
    strcpy(result->cpu, eng_kernels_name(eng_kernels()));
    return 0;
}

int srv_on_STATS_HISTOGRAM(struct srv_call *call)
{
    const struct srv_metrics *metrics = &call->session->service->metrics;
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
    struct srv_request *request = srv_request_find(call->session, call->params.CANCEL.id);
    call->result.CANCEL.found = request != NULL;
    if (request != NULL) {
        srv_request_cancel(request);
    }
    return 0;
}

/* ---- shm.attach -------------------------------------------------------------------- */

static int work_attach(struct srv_request *request)
{
    if (request->plan.replaced != NULL) {
        /* What the client does not need any more is there before the new one is made; if
         * that fails, it gets memory anew (shm.take). */
        srv_ring_give_back_slots(request->plan.replaced);
    }
    int status = srv_ring_charge(request->plan.attached, &request->error);
    if (status != 0) {
        return status;
    }
    return srv_ring_create(request->plan.attached, request->session->service->epoch,
                           &request->error);
}

/* The answer takes the descriptors along. Copies stay where clients are looked after
 * (stray.h); else the mappings are all the daemon needs. */
static bool give_descriptors(struct srv_request *request, struct srv_ring *ring)
{
    bool looks = srv_stray_looks(request->session->service);
    int kept[2] = {looks ? proto_memory_share(&ring->upload) : -1,
                   looks ? proto_memory_share(&ring->results) : -1};
    request->fds[0] = ring->upload.fd;
    request->fds[1] = ring->results.fd;
    ring->upload.fd = kept[0];
    ring->results.fd = kept[1];
    if (!looks || (kept[0] >= 0 && kept[1] >= 0)) {
        return true;
    }
    for (int i = 0; i < 2; i++) {
        (void)close(request->fds[i]);
        request->fds[i] = -1;
    }
    request->status = proto_error_set(&request->error, PCCD_E_SYSTEM,
                                      "the daemon has no descriptors for a ring");
    return false;
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
    if (!give_descriptors(request, ring)) {
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
    if (session->ring != NULL) {
        srv_resource_drop(&session->ring->resource);
    }
    session->ring = ring;
    srv_stray_use(session->service);
}

int srv_on_SHM_ATTACH(struct srv_call *call)
{
    struct srv_session *session = call->session;
    struct srv_service *service = session->service;
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
    uint32_t slots_now = call->params.SHM_ATTACH.slots_now;
    if (slots_now == 0 || slots_now > sizes.slot_count) {
        slots_now = sizes.slot_count;
    }
    sizes.inflight_max = sizes.slot_count < service->options->inflight_max
                             ? sizes.slot_count
                             : service->options->inflight_max;
    /* What could never be taken is refused at once. */
    uint64_t whole = sizes.upload_bytes + sizes.result_bytes;
    if (srv_quota_is_beyond(&service->quota, SRV_QUOTA_SHM_BYTES, whole)) {
        status = srv_quota_charge(session->owner.user, SRV_QUOTA_SHM_BYTES, whole,
                                  &call->error);
        PCCD_ASSERT(status != 0);
        return status;
    }
    struct srv_ring *ring = srv_ring_new(&session->owner, &sizes, slots_now);
    if (ring == NULL) {
        return proto_error_set(&call->error, PCCD_E_NOMEM, "no memory for a ring");
    }
    /* Where sessions that wait for their clients can make room, they do (dispatch.c).
     * Else the ring that is replaced can: then the charge comes after that. */
    const struct srv_quota_user *user = session->owner.user;
    status = srv_ring_charge(ring, &call->error);
    if (status != 0 &&
        (session->ring == NULL || user->waiting > 0 || user->leaving > 0)) {
        srv_resource_drop(&ring->resource);
        return status;
    }
    struct srv_plan plan = {.work = work_attach,
                            .finish = finish_attach,
                            .makes_pages = true,
                            .attached = ring,
                            .replaced = session->ring};
    status = srv_request_start(call, &plan);
    if (status < 0) {
        srv_resource_drop(&ring->resource);
        return status;
    }
    session->attaching = true;
    return status;
}

/* ---- shm.take ---------------------------------------------------------------------- */

static int work_take(struct srv_request *request)
{
    return srv_ring_take_slot(request->plan.ring, request->params.SHM_TAKE.slot,
                              &request->error);
}

static void finish_take(struct srv_request *request)
{
    request->result.SHM_TAKE.done = request->status == 0;
}

int srv_on_SHM_TAKE(struct srv_call *call)
{
    struct srv_ring *ring = NULL;
    uint32_t slot = call->params.SHM_TAKE.slot;
    int status = srv_admit_ring(call, &ring);
    if (status != 0) {
        return status;
    }
    if (slot >= ring->slot_count) {
        return proto_error_set(&call->error, PCCD_E_INVAL, "slot is %u, the ring has %u",
                               slot, ring->slot_count);
    }
    struct srv_plan plan = {
        .work = work_take, .finish = finish_take, .makes_pages = true, .ring = ring};
    return srv_request_start(call, &plan);
}
