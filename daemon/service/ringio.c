/* ringio.c - the daemon's side of the upload ring and of the result region.
 *
 * Room:     service. See ringio.h.
 * Does:     bounds checks on values that were copied out of the shared memory first.
 * Does not: lock or wait on anything in shared memory.
 * Threads:  [compute], but for creation and the two counters.
 * Source:   the slot protocol is written at the top of proto/shm.h.
 */
#include "ringio.h"

#include <stdlib.h>
#include <string.h>

#include "invariant.h"
#include "loop.h"
#include "session.h"
#include "wire.h"

/* The result region takes memory in such steps; once it has many, in larger ones. */
#define STEP_BYTES       (64ull << 10)
#define STEP_BYTES_LARGE (1ull << 20)

#define REQUEST_BYTES_MAX (1ull << 40) /* of one slot or of the result region */

/* ---- life -------------------------------------------------------------------------- */

static void ring_free_memory(struct srv_job *job)
{
    struct srv_ring *ring = (struct srv_ring *)job;
    proto_memory_deinit(&ring->upload);
    proto_memory_deinit(&ring->results);
}

static void ring_free_rest(struct srv_job *job)
{
    struct srv_ring *ring = (struct srv_ring *)job;
    struct srv_session *session = ring->resource.session;
    srv_quota_refund(&session->loop->quota, session->user, SRV_QUOTA_SHM_BYTES,
                     srv_ring_bytes(ring));
    free(ring);
    srv_session_reaped(session);
}

static uint64_t taken_first(uint64_t result_bytes)
{
    uint64_t first = PROTO_SHM_PAGE + PROTO_RESULT_BYTES_MIN;
    return result_bytes < first ? result_bytes : first;
}

uint64_t srv_ring_bytes_first(const struct proto_SHM_ATTACH_result *sizes)
{
    return sizes->upload_bytes + taken_first(sizes->result_bytes);
}

uint64_t srv_ring_bytes(const struct srv_ring *ring)
{
    return ring->upload_bytes +
           atomic_load_explicit(&ring->result_taken, memory_order_relaxed);
}

struct srv_ring *srv_ring_new(struct srv_session *session,
                              const struct proto_SHM_ATTACH_result *sizes)
{
    struct srv_ring *ring = calloc(1, sizeof *ring);
    if (ring == NULL) {
        return NULL;
    }
    srv_resource_init(&ring->resource, session, ring_free_memory, ring_free_rest);
    ring->resource.is_ring = true;
    ring->upload = (struct proto_memory)PROTO_MEMORY_NONE;
    ring->results = (struct proto_memory)PROTO_MEMORY_NONE;
    ring->slot_count = sizes->slot_count;
    ring->inflight_max = sizes->inflight_max;
    ring->slot_stride = sizes->slot_stride;
    ring->upload_bytes = sizes->upload_bytes;
    ring->result_bytes = sizes->result_bytes;
    ring->result_taken = taken_first(ring->result_bytes);
    srv_region_init_sparse(&ring->region, ring->result_bytes - PROTO_SHM_PAGE,
                           ring->result_taken - PROTO_SHM_PAGE);
    return ring;
}

static uint64_t round_to_pages(uint64_t bytes)
{
    return (bytes + PROTO_SHM_PAGE - 1) / PROTO_SHM_PAGE * PROTO_SHM_PAGE;
}

int srv_ring_sizes(const struct proto_SHM_ATTACH_request *request,
                   struct proto_SHM_ATTACH_result *sizes, struct proto_error *error)
{
    if (request->slot_count < 1 || request->slot_count > PROTO_SLOTS_MAX) {
        return proto_error_set(error, PCCD_E_INVAL, "slot_count is %u, not 1 to %u",
                               request->slot_count, PROTO_SLOTS_MAX);
    }
    if (request->slot_bytes < PROTO_SLOT_BYTES_MIN) {
        return proto_error_set(error, PCCD_E_INVAL, "slot_bytes is %llu, less than %u",
                               (unsigned long long)request->slot_bytes,
                               PROTO_SLOT_BYTES_MIN);
    }
    if (request->result_bytes < PROTO_RESULT_BYTES_MIN) {
        return proto_error_set(error, PCCD_E_INVAL, "result_bytes is %llu, less than %u",
                               (unsigned long long)request->result_bytes,
                               PROTO_RESULT_BYTES_MIN);
    }
    if (request->slot_bytes > REQUEST_BYTES_MAX ||
        request->result_bytes > REQUEST_BYTES_MAX) {
        return proto_error_set(error, PCCD_E_LIMIT,
                               "slot_bytes and result_bytes are at most %llu",
                               REQUEST_BYTES_MAX);
    }
    sizes->slot_count = request->slot_count;
    sizes->slot_stride = round_to_pages(request->slot_bytes);
    sizes->upload_bytes =
        sizeof(struct proto_upload) + request->slot_count * sizes->slot_stride;
    sizes->result_bytes = PROTO_SHM_PAGE + round_to_pages(request->result_bytes);
    return 0;
}

int srv_ring_create(struct srv_ring *ring, uint64_t epoch, struct proto_error *error)
{
    srv_assert_compute();
    int status =
        proto_memory_create(&ring->upload, "pccd-upload", ring->upload_bytes,
                            ring->upload_bytes, false);
    if (status == 0) {
        status =
            proto_memory_create(&ring->results, "pccd-results", ring->result_bytes,
                                taken_first(ring->result_bytes), true);
    }
    if (status != 0) {
        return proto_error_set(error, status, "no shared memory of %llu + %llu bytes",
                               (unsigned long long)ring->upload_bytes,
                               (unsigned long long)ring->result_bytes);
    }
    ring->shared = ring->upload.base;
    ring->shared->header = (struct proto_shm_header){
        .magic = PROTO_UPLOAD_MAGIC,
        .version = PROTO_LAYOUT_VERSION,
        .header_bytes = sizeof(struct proto_upload),
        .size = ring->upload_bytes,
        .slot_count = ring->slot_count,
        .slot_stride = ring->slot_stride,
        .slot0_offset = sizeof(struct proto_upload),
        .epoch = epoch,
    };
    struct proto_shm_header *results = ring->results.base;
    *results = (struct proto_shm_header){
        .magic = PROTO_RESULT_MAGIC,
        .version = PROTO_LAYOUT_VERSION,
        .header_bytes = PROTO_SHM_PAGE,
        .size = ring->result_bytes,
        .epoch = epoch,
    };
    return 0;
}

/* ---- slots ------------------------------------------------------------------------- */

int srv_ring_open_slot(struct srv_ring *ring, uint32_t slot, uint64_t seq,
                       const uint8_t **payload, struct proto_error *error)
{
    PCCD_ASSERT(slot < ring->slot_count);
    /* Acquire: pairs with the client's release store after it wrote the payload. */
    uint64_t stored =
        atomic_load_explicit(&ring->shared->slots[slot].seq, memory_order_acquire);
    if (stored != seq) {
        return proto_error_set(
            error, PCCD_E_SLOT_STALE,
            "slot %u holds sequence number %llu, the request says %llu", slot,
            (unsigned long long)stored, (unsigned long long)seq);
    }
    *payload = (const uint8_t *)ring->upload.base + sizeof(struct proto_upload) +
               slot * ring->slot_stride;
    return 0;
}

int srv_ring_check_slot(struct srv_ring *ring, uint32_t slot, uint64_t seq,
                        struct proto_error *error)
{
    /* Adding 0 is a read that no earlier read of the payload can pass: the release half
     * orders those before it. A plain load has no such order, and a fence is not seen by
     * the thread sanitizer. The word keeps the client's value. */
    uint64_t stored = atomic_fetch_add_explicit(&ring->shared->slots[slot].seq, 0,
                                                memory_order_acq_rel);
    if (stored != seq) {
        return proto_error_set(
            error, PCCD_E_SLOT_TORN,
            "slot %u went from sequence number %llu to %llu while read", slot,
            (unsigned long long)seq, (unsigned long long)stored);
    }
    return 0;
}

void srv_ring_return_slot(struct srv_ring *ring)
{
    /* Release: pairs with the client's acquire load before it writes the slot again. Both
     * threads may return slots, so it is an addition; the sum is never read here. */
    atomic_fetch_add_explicit(&ring->shared->tail.value, 1, memory_order_release);
}

void srv_ring_done(struct srv_ring *ring)
{
    /* seq_cst, as the client's store of client_wait and load of done_seq: one of the two
     * sees the other. The message is always sent, so client_wait is not read here. */
    atomic_fetch_add_explicit(&ring->shared->done_seq.value, 1, memory_order_seq_cst);
}

/* ---- segments ---------------------------------------------------------------------- */

/* A slot while it is being staged. */
struct staging {
    struct srv_scene *scene;
    const struct srv_seat *seat; /* whose objects may be moved; NULL: all */
    const uint8_t *payload;
    uint64_t payload_bytes;
    uint64_t table_bytes; /* at the start of the payload; positions lie behind it */
    uint64_t copied;      /* bytes of positions so far */
    struct proto_error *error;
};

/* Whether [offset, offset + bytes) lies between the table and the end of the payload. */
static bool is_inside(const struct staging *staging, uint64_t offset, uint64_t bytes)
{
    return offset % 8 == 0 && offset >= staging->table_bytes &&
           offset <= staging->payload_bytes && bytes <= staging->payload_bytes - offset;
}

/* Everything of segment `at` that does not need the object. *bytes: of each of its
 * parts. */
static int check_segment(const struct staging *staging,
                         const struct proto_segment *segment, uint32_t at,
                         uint64_t *bytes)
{
    struct proto_error *error = staging->error;
    if (segment->kind >= PROTO_SEGMENT_KIND_COUNT) {
        return proto_error_set(error, PCCD_E_SEGMENT, "segment %u: unknown kind %u", at,
                               segment->kind);
    }
    bool rigid = segment->kind == PROTO_SEGMENT_RIGID;
    if (segment->format >= PCCD_FORMAT_COUNT ||
        (rigid && segment->format != PCCD_FORMAT_F64)) {
        return proto_error_set(error, PCCD_E_SEGMENT, "segment %u: unknown format %u", at,
                               segment->format);
    }
    if (segment->count == 0) {
        return proto_error_set(error, PCCD_E_SEGMENT, "segment %u: no vertices", at);
    }
    *bytes =
        rigid ? PROTO_RIGID_BYTES : segment->count * srv_vertex_bytes(segment->format);
    bool start_ok = segment->kind == PROTO_SEGMENT_X1
                        ? segment->offset0 == 0
                        : is_inside(staging, segment->offset0, *bytes);
    if (!start_ok || !is_inside(staging, segment->offset1, *bytes)) {
        return proto_error_set(
            error, PCCD_E_SEGMENT,
            "segment %u: offsets %llu and %llu with %llu bytes each do not fit in the "
            "slot's bytes %llu to %llu, or are no multiples of 8",
            at, (unsigned long long)segment->offset0,
            (unsigned long long)segment->offset1, (unsigned long long)*bytes,
            (unsigned long long)staging->table_bytes,
            (unsigned long long)staging->payload_bytes);
    }
    return 0;
}

/* Copy the positions of a checked segment of `object` into the scene's staging. Returns
 * an engine status. */
static int copy_segment(const struct staging *staging, const struct srv_placed *object,
                        const struct proto_segment *segment)
{
    struct eng_scene *engine = staging->scene->engine;
    const uint8_t *start = staging->payload + segment->offset0;
    const uint8_t *end = staging->payload + segment->offset1;
    enum eng_format format = (enum eng_format)segment->format;
    uint32_t idx = object->engine_idx;
    switch ((enum proto_segment_kind)segment->kind) {
    case PROTO_SEGMENT_X1:
        return eng_stage_x1(engine, idx, format, segment->first, segment->count, end);
    case PROTO_SEGMENT_X0X1:
        return eng_stage_x0x1(engine, idx, format, segment->first, segment->count, start,
                              end);
    case PROTO_SEGMENT_RIGID:
        return eng_stage_rigid(engine, idx, segment->first, segment->count, start, end);
    case PROTO_SEGMENT_KIND_COUNT:
        break;
    }
    srv_assert_failed("the kind was checked", __FILE__, __LINE__);
}

/* Check and stage segment `at` of a table that was copied already. */
static int take_segment(struct staging *staging, const struct proto_segment *segment,
                        uint32_t at)
{
    uint64_t bytes = 0;
    int status = check_segment(staging, segment, at, &bytes);
    if (status != 0) {
        return status;
    }
    const struct srv_placed *object = srv_scene_find(staging->scene, segment->object);
    if (object == NULL) {
        return proto_error_set(staging->error, PCCD_E_HANDLE,
                               "segment %u: object 0x%x is not in the scene", at,
                               segment->object);
    }
    if (staging->seat != NULL && object->seat != staging->seat) {
        return proto_error_set(staging->error, PCCD_E_ACCESS,
                               "segment %u: object 0x%x is another session's", at,
                               segment->object);
    }
    if (segment->first >= object->vertex_count ||
        segment->count > object->vertex_count - segment->first) {
        return proto_error_set(staging->error, PCCD_E_SEGMENT,
                               "segment %u: %u vertices from %u on, object 0x%x has %u "
                               "(generation %u of its mesh)",
                               at, segment->count, segment->first, segment->object,
                               object->vertex_count, object->generation);
    }
    status = srv_wire_status(copy_segment(staging, object, segment));
    if (status != 0) {
        return proto_error_set(
            staging->error, status, "segment %u (object 0x%x, vertices from %u): %s", at,
            segment->object, segment->first,
            status == PCCD_E_SEGMENT ? "a vertex is written twice in this step"
                                     : proto_status_text(status));
    }
    staging->copied += segment->kind == PROTO_SEGMENT_X1 ? bytes : 2 * bytes;
    return 0;
}

/* Copy the table and stage all of it. */
static int stage(struct staging *staging, uint32_t segments, struct proto_segment *table,
                 uint64_t *bytes)
{
    int status = 0;
    memcpy(table, staging->payload, staging->table_bytes); /* the one read of the table */
    for (uint32_t at = 0; at < segments && status == 0; at++) {
        status = take_segment(staging, &table[at], at);
    }
    *bytes = staging->table_bytes + staging->copied;
    return status;
}

static int refuse_table(const struct staging *staging, uint32_t segments)
{
    return proto_error_set(staging->error, PCCD_E_SEGMENT,
                           "a table of %u segments does not fit in %llu bytes of a slot",
                           segments, (unsigned long long)staging->payload_bytes);
}

int srv_ring_stage(struct srv_ring *ring,
                   const struct proto_FRAME_SUBMIT_request *request,
                   const struct srv_seat *seat, struct srv_scene *scene,
                   struct proto_segment *table, uint64_t *bytes,
                   struct proto_error *error)
{
    PCCD_ASSERT(request->segments >= 1 && request->segments <= PROTO_SEGMENTS_MAX);
    struct staging staging = {
        .scene = scene,
        .seat = seat,
        .payload_bytes = ring->slot_stride,
        .table_bytes = (uint64_t)request->segments * sizeof(struct proto_segment),
        .error = error,
    };
    int status =
        srv_ring_open_slot(ring, request->slot, request->seq, &staging.payload, error);
    if (status != 0) {
        return status;
    }
    if (staging.table_bytes > staging.payload_bytes) {
        return refuse_table(&staging, request->segments);
    }
    status = stage(&staging, request->segments, table, bytes);
    /* A slot that changed explains any other complaint. */
    int torn = srv_ring_check_slot(ring, request->slot, request->seq, error);
    return torn != 0 ? torn : status;
}

int srv_ring_stage_copy(const uint8_t *copy, uint64_t copy_bytes,
                        const struct proto_FRAME_SUBMIT_request *request,
                        const struct srv_seat *seat, struct srv_scene *scene,
                        struct proto_segment *table, uint64_t *bytes,
                        struct proto_error *error)
{
    srv_assert_compute();
    struct staging staging = {
        .scene = scene,
        .seat = seat,
        .payload = copy,
        .payload_bytes = copy_bytes,
        .table_bytes = (uint64_t)request->segments * sizeof(struct proto_segment),
        .error = error,
    };
    PCCD_ASSERT(staging.table_bytes <= copy_bytes);
    return stage(&staging, request->segments, table, bytes);
}

/* Where the last segment of a copied table ends; 0: something is wrong with one, and the
 * error is set. */
static uint64_t extent_of(const struct staging *staging, uint32_t segments)
{
    uint64_t extent = staging->table_bytes;
    for (uint32_t at = 0; at < segments; at++) {
        struct proto_segment segment;
        uint64_t bytes = 0;
        memcpy(&segment, staging->payload + at * sizeof segment, sizeof segment);
        if (check_segment(staging, &segment, at, &bytes) != 0) {
            return 0;
        }
        uint64_t end0 = segment.offset0 == 0 ? 0 : segment.offset0 + bytes;
        uint64_t end1 = segment.offset1 + bytes;
        extent = end0 > extent ? end0 : extent;
        extent = end1 > extent ? end1 : extent;
    }
    return extent;
}

int srv_ring_copy_slot(struct srv_ring *ring,
                       const struct proto_FRAME_SUBMIT_request *request,
                       uint64_t bytes_max, uint8_t **copy, uint64_t *bytes,
                       struct proto_error *error)
{
    PCCD_ASSERT(request->slot < ring->slot_count && bytes_max <= ring->slot_stride);
    struct staging staging = {
        .payload_bytes = bytes_max,
        .table_bytes = (uint64_t)request->segments * sizeof(struct proto_segment),
        .error = error,
    };
    const uint8_t *payload = NULL;
    int status = srv_ring_open_slot(ring, request->slot, request->seq, &payload, error);
    if (status != 0) {
        return status;
    }
    if (staging.table_bytes > bytes_max) {
        return refuse_table(&staging, request->segments);
    }
    uint8_t *new = malloc(bytes_max);
    if (new == NULL) {
        return proto_error_set(error, PCCD_E_NOMEM, "no memory to copy a slot");
    }
    memcpy(new, payload, staging.table_bytes); /* the one read of the table */
    staging.payload = new;
    *bytes = extent_of(&staging, request->segments);
    if (*bytes > 0) {
        memcpy(new + staging.table_bytes, payload + staging.table_bytes,
               *bytes - staging.table_bytes);
    }
    /* A slot that changed explains any other complaint. */
    int torn = srv_ring_check_slot(ring, request->slot, request->seq, error);
    if (torn != 0 || *bytes == 0) {
        free(new);
        return torn != 0 ? torn : error->code;
    }
    *copy = new;
    return 0;
}

/* ---- results ----------------------------------------------------------------------- */

/* Charge and take `more` bytes. On failure nothing is charged. */
static int take_more(struct srv_ring *ring, uint64_t more)
{
    struct srv_session *session = ring->resource.session;
    struct srv_region *region = &ring->region;
    struct proto_error error = {0}; /* nobody is told: the answer says what is left out */
    uint64_t taken = region->taken + more;
    int status =
        srv_quota_charge_shared(&session->loop->quota, session->user, more, &error);
    if (status != 0) {
        return status;
    }
    status = proto_memory_take(&ring->results, PROTO_SHM_PAGE + region->taken,
                               PROTO_SHM_PAGE + taken);
    if (status != 0) {
        srv_quota_refund(&session->loop->quota, session->user, SRV_QUOTA_SHM_BYTES, more);
        return status;
    }
    region->taken = taken;
    atomic_store_explicit(&ring->result_taken, PROTO_SHM_PAGE + taken,
                          memory_order_relaxed);
    return 0;
}

/* Take memory, so that the first `needed` bytes of the region's data have it, or part of
 * it where that is refused. */
static void take_results(struct srv_ring *ring, uint64_t needed)
{
    struct srv_region *region = &ring->region;
    uint64_t step = region->taken < STEP_BYTES_LARGE ? STEP_BYTES : STEP_BYTES_LARGE;
    uint64_t taken = (needed + step - 1) / step * step;
    taken = taken < region->capacity ? taken : region->capacity;
    uint64_t more = taken - region->taken;
    while (take_more(ring, more) != 0 && more > STEP_BYTES) {
        more = round_to_pages(more / 2);
    }
}

int srv_ring_reserve(struct srv_ring *ring, uint32_t item_bytes, uint64_t wanted,
                     struct srv_page *page, void **data, struct proto_error *error)
{
    srv_assert_compute();
    /* Acquire: pairs with the client's release store after its last read of the pages. */
    uint64_t head =
        atomic_load_explicit(&ring->shared->result_head.value, memory_order_acquire);
    struct srv_region before = ring->region;
    int status = srv_region_reserve(&ring->region, head, item_bytes, wanted, page);
    if (status != 0) {
        return proto_error_set(
            error, status, "result_head is %llu; it was %llu, and %llu were handed out",
            (unsigned long long)head, (unsigned long long)before.head,
            (unsigned long long)ring->region.tail);
    }
    uint64_t end = page->position + page->count * item_bytes;
    if (page->count > 0 && end > ring->region.taken) {
        take_results(ring, end);
    }
    if (page->count > 0 && end > ring->region.taken) {
        before.taken = ring->region.taken;
        ring->region = before;
        ring->region.limit = before.taken;
        status = srv_region_reserve(&ring->region, head, item_bytes, wanted, page);
        PCCD_ASSERT(status == 0);
        ring->region.limit = before.capacity; /* the next one asks again */
    }
    page->position += PROTO_SHM_PAGE;
    *data = (uint8_t *)ring->results.base + page->position;
    return 0;
}
