/* ringio.c - the daemon's side of the upload ring and of the result region.
 *
 * Threads: [compute], but for the memory of slots, which is [pages], and the two
 * counters.
 */
#include "ringio.h"

#include <stdlib.h>
#include <string.h>

#include "invariant.h"

/* The result region takes memory in such steps; once it has many, in larger ones. */
#define STEP_BYTES       (64ull << 10)
#define STEP_BYTES_LARGE (1ull << 20)

/* And gives it back in such parts, so that no step waits for more than a millisecond. */
#define PART_BYTES (2ull << 20)

#define REQUEST_BYTES_MAX (1ull << 40) /* of one slot or of the result region */

/* ---- life -------------------------------------------------------------------------- */

static bool free_stray_slots(struct srv_ring *ring);
static bool free_stray_results(struct srv_ring *ring);

/* Free a ring's memory: of what stays with a client that keeps it mapped it was given
 * each page. */
static void ring_free_memory(struct srv_job *job)
{
    struct srv_ring *ring = (struct srv_ring *)job;
    (void)free_stray_slots(ring);
    while (free_stray_results(ring)) {
    }
    proto_memory_deinit(&ring->upload);
    proto_memory_deinit(&ring->results);
}

static void ring_free_rest(struct srv_job *job)
{
    struct srv_ring *ring = (struct srv_ring *)job;
    struct srv_owner *owner = ring->resource.owner;
    srv_quota_refund(owner->user, SRV_QUOTA_SHM_BYTES,
                     srv_ring_bytes(ring) + ring->stray_bytes);
    srv_reclaimed_forget(&ring->results_unused);
    srv_reclaimed_forget(&ring->slots_unused);
    free(ring);
    srv_owner_release(owner);
}

static uint64_t taken_first(uint64_t result_bytes)
{
    uint64_t first = PROTO_SHM_PAGE + PROTO_RESULT_BYTES_MIN;
    return result_bytes < first ? result_bytes : first;
}

/* Return where the payload of a slot begins, in the upload ring; of the one behind the
 * last: where the ring ends. */
static uint64_t slot_offset(uint64_t stride, uint32_t slot)
{
    return sizeof(struct proto_upload) + slot * stride;
}

uint64_t srv_ring_bytes(const struct srv_ring *ring)
{
    uint32_t taken = atomic_load_explicit(&ring->slots_taken, memory_order_relaxed);
    if (!ring->is_charged) {
        return 0;
    }
    return slot_offset(ring->slot_stride, (uint32_t)__builtin_popcount(taken)) +
           atomic_load_explicit(&ring->result_taken, memory_order_relaxed);
}

static void give_back(struct srv_job *job);
static void give_back_slots(struct srv_job *job);

struct srv_ring *srv_ring_new(struct srv_owner *owner,
                              const struct proto_SHM_ATTACH_result *sizes,
                              uint32_t slots_now)
{
    PCCD_ASSERT(slots_now >= 1 && slots_now <= sizes->slot_count);
    struct srv_ring *ring = calloc(1, sizeof *ring);
    if (ring == NULL) {
        return NULL;
    }
    srv_resource_init(&ring->resource, owner, ring_free_memory, ring_free_rest);
    ring->resource.is_ring = true;
    ring->upload = (struct proto_memory)PROTO_MEMORY_NONE;
    ring->results = (struct proto_memory)PROTO_MEMORY_NONE;
    ring->slot_count = sizes->slot_count;
    ring->inflight_max = sizes->inflight_max;
    ring->slot_stride = sizes->slot_stride;
    ring->upload_bytes = sizes->upload_bytes;
    ring->result_bytes = sizes->result_bytes;
    ring->result_taken = taken_first(ring->result_bytes);
    ring->slots_taken = (1u << slots_now) - 1;
    srv_reclaimed_init(&ring->results_unused, &ring->resource, false, give_back);
    srv_reclaimed_init(&ring->slots_unused, &ring->resource, true, give_back_slots);
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
    sizes->upload_bytes = slot_offset(sizes->slot_stride, request->slot_count);
    sizes->result_bytes = PROTO_SHM_PAGE + round_to_pages(request->result_bytes);
    return 0;
}

int srv_ring_charge(struct srv_ring *ring, struct proto_error *error)
{
    uint32_t slots_now = (uint32_t)__builtin_popcount(ring->slots_taken);
    uint64_t bytes = slot_offset(ring->slot_stride, slots_now) + ring->result_taken;
    int status = ring->is_charged
                     ? 0
                     : srv_quota_charge_shared(ring->resource.owner->user, bytes, error);
    ring->is_charged = status == 0;
    return status;
}

int srv_ring_create(struct srv_ring *ring, uint64_t epoch, struct proto_error *error)
{
    srv_assert_compute();
    PCCD_ASSERT(ring->is_charged);
    uint32_t slots_now = (uint32_t)__builtin_popcount(ring->slots_taken);
    int status = proto_memory_create(&ring->upload, "pccd-upload", ring->upload_bytes,
                                     slot_offset(ring->slot_stride, slots_now), false);
    if (status == 0) {
        status = proto_memory_create(&ring->results, "pccd-results", ring->result_bytes,
                                     taken_first(ring->result_bytes), true);
    }
    if (status != 0) {
        return proto_error_set(error, status, "no shared memory of %llu + %llu bytes",
                               (unsigned long long)ring->upload_bytes,
                               (unsigned long long)ring->result_bytes);
    }
    ring->shared = ring->upload.base;
    for (uint32_t slot = slots_now; slot < ring->slot_count; slot++) {
        ring->shared->slots[slot].memory = PROTO_SLOT_EMPTY;
    }
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
    *payload = (const uint8_t *)ring->upload.base + slot_offset(ring->slot_stride, slot);
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

/* ---- memory of slots --------------------------------------------------------------- */

bool srv_ring_has_slot(const struct srv_ring *ring, uint32_t slot)
{
    PCCD_ASSERT(slot < ring->slot_count);
    uint32_t taken = atomic_load_explicit(&ring->slots_taken, memory_order_relaxed);
    return (taken >> slot & 1) != 0;
}

int srv_ring_take_slot(struct srv_ring *ring, uint32_t slot, struct proto_error *error)
{
    srv_assert_compute();
    struct srv_quota_user *user = ring->resource.owner->user;
    uint64_t from = slot_offset(ring->slot_stride, slot);
    uint64_t to = from + ring->slot_stride;
    if (!srv_ring_has_slot(ring, slot)) {
        int status = srv_quota_charge_shared(user, ring->slot_stride, error);
        if (status != 0) {
            return status;
        }
        status = proto_memory_take(&ring->upload, from, to);
        if (status != 0) {
            (void)proto_memory_give_back(&ring->upload, from, to); /* what was taken */
            srv_quota_refund(user, SRV_QUOTA_SHM_BYTES, ring->slot_stride);
            return proto_error_set(error, status, "no memory for slot %u: %llu bytes",
                                   slot, (unsigned long long)ring->slot_stride);
        }
        atomic_fetch_or_explicit(&ring->slots_taken, 1u << slot, memory_order_relaxed);
    }
    /* The client waits for the answer before it looks. */
    atomic_store_explicit(&ring->shared->slots[slot].memory, PROTO_SLOT_NEEDED,
                          memory_order_release);
    return 0;
}

/* Give the memory of a slot back if the client says that it is free. Returns whether it
 * was, and that is possible on this system. */
static bool give_back_slot(struct srv_ring *ring, uint32_t slot)
{
    uint64_t from = slot_offset(ring->slot_stride, slot);
    uint64_t expected = PROTO_SLOT_FREE;
    /* Acquire: pairs with the client's release store after its last look at the payload.
     * From here on a client that wants the slot asks for memory first, and its request
     * is worked on after this. */
    if (!atomic_compare_exchange_strong_explicit(
            &ring->shared->slots[slot].memory, &expected, PROTO_SLOT_EMPTY,
            memory_order_acq_rel, memory_order_relaxed)) {
        return false;
    }
    atomic_fetch_and_explicit(&ring->slots_taken, ~(1u << slot), memory_order_relaxed);
    if (proto_memory_give_back(&ring->upload, from, from + ring->slot_stride) != 0) {
        atomic_fetch_or_explicit(&ring->slots_taken, 1u << slot, memory_order_relaxed);
        return false; /* shm.take finds that it has memory */
    }
    srv_quota_refund(ring->resource.owner->user, SRV_QUOTA_SHM_BYTES, ring->slot_stride);
    return true;
}

static bool is_one_slot(uint32_t slots)
{
    return (slots & (slots - 1)) == 0;
}

void srv_ring_give_back_slots(struct srv_ring *ring)
{
    srv_assert_compute();
    for (uint32_t slot = 0; slot < ring->slot_count; slot++) {
        if (srv_ring_has_slot(ring, slot)) {
            (void)give_back_slot(ring, slot);
        }
    }
}

/* Free what slots hold that have no memory. Returns whether there was any. [pages] */
static bool free_stray_slots(struct srv_ring *ring)
{
    uint32_t taken = atomic_load_explicit(&ring->slots_taken, memory_order_relaxed);
    uint64_t given = slot_offset(ring->slot_stride, (uint32_t)__builtin_popcount(taken));
    if (proto_memory_held(&ring->upload) <= given) {
        return false;
    }
    for (uint32_t slot = 0; slot < ring->slot_count; slot++) {
        uint64_t from = slot_offset(ring->slot_stride, slot);
        if ((taken >> slot & 1) == 0) {
            (void)proto_memory_give_back(&ring->upload, from, from + ring->slot_stride);
        }
    }
    return true;
}

/* One slot a call, the last ones first: clients take the first that is free. One slot
 * stays, so that a client that nobody gives memory can go on. [pages] */
static void give_back_slots(struct srv_job *job)
{
    srv_assert_compute();
    struct srv_ring *ring =
        (struct srv_ring *)((char *)job - offsetof(struct srv_ring, slots_unused.job));
    uint32_t taken = atomic_load_explicit(&ring->slots_taken, memory_order_relaxed);
    job->goes_on = false;
    (void)free_stray_slots(ring);
    for (uint32_t slot = ring->slot_count; slot-- > 0 && !is_one_slot(taken);) {
        if ((taken >> slot & 1) != 0 && give_back_slot(ring, slot)) {
            job->goes_on = true;
            return;
        }
    }
}

/* ---- results ----------------------------------------------------------------------- */

/* Charge and take `more` bytes. On failure nothing is charged. */
static int take_more(struct srv_ring *ring, uint64_t more)
{
    struct srv_quota_user *user = ring->resource.owner->user;
    struct srv_region *region = &ring->region;
    struct proto_error error = {0}; /* nobody is told: the answer says what is left out */
    uint64_t taken = region->taken + more;
    int status = srv_quota_charge_shared(user, more, &error);
    if (status != 0) {
        return status;
    }
    status = proto_memory_take(&ring->results, PROTO_SHM_PAGE + region->taken,
                               PROTO_SHM_PAGE + taken);
    if (status != 0) {
        srv_quota_refund(user, SRV_QUOTA_SHM_BYTES, more);
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

int srv_ring_reserve_all(struct srv_ring *ring, uint32_t item_bytes, uint64_t wanted,
                         struct srv_page *page, void **data, struct proto_error *error)
{
    struct srv_region before = ring->region;
    struct srv_page got;
    int status = srv_ring_reserve(ring, item_bytes, wanted, &got, data, error);
    if (status != 0) {
        return status;
    }
    if (got.count < wanted) {
        before.taken = ring->region.taken;
        ring->region = before;
        return proto_error_set(error, PCCD_E_BUSY,
                               "the result region has room for %llu of %llu answers: "
                               "release pages first",
                               (unsigned long long)got.count, (unsigned long long)wanted);
    }
    *page = got;
    return 0;
}

void *srv_ring_next(struct srv_ring *ring, uint32_t item_bytes, uint64_t wanted,
                    uint64_t *bytes)
{
    struct srv_region before = ring->region;
    struct srv_page page;
    struct proto_error error;
    void *data = NULL;
    int status = srv_ring_reserve(ring, item_bytes, wanted, &page, &data, &error);
    before.taken = ring->region.taken;
    ring->region = before;
    *bytes = status == 0 ? page.count * item_bytes : 0;
    return *bytes > 0 ? data : NULL;
}

/* Free a part of what the region holds behind what it has taken. Returns whether there is
 * more. [compute], or [pages] when nobody computes with it any more */
static bool free_stray_results(struct srv_ring *ring)
{
    uint64_t given = PROTO_SHM_PAGE + ring->region.taken;
    if (ring->stray_at < given) {
        ring->stray_at = given;
    }
    uint64_t left = ring->result_bytes - ring->stray_at;
    uint64_t part = left < PART_BYTES ? left : PART_BYTES;
    if (part == 0 || proto_memory_held(&ring->results) <= given ||
        proto_memory_give_back(&ring->results, ring->stray_at, ring->stray_at + part) !=
            0) {
        ring->stray_at = 0;
        return false;
    }
    ring->stray_at += part;
    return true;
}

/* Give back a part, or nothing. Returns whether there is more. */
static bool give_back_part(struct srv_ring *ring)
{
    struct srv_region *region = &ring->region;
    /* Acquire: pairs with the client's release store after its last read of the pages. */
    uint64_t head =
        atomic_load_explicit(&ring->shared->result_head.value, memory_order_acquire);
    uint64_t used = round_to_pages(srv_region_used(region, head));
    uint64_t first = taken_first(ring->result_bytes) - PROTO_SHM_PAGE;
    uint64_t kept = used > first ? used : first;
    if (region->taken <= kept) {
        return false;
    }
    uint64_t part = region->taken - kept;
    part = part < PART_BYTES ? part : PART_BYTES;
    uint64_t taken = region->taken - part;
    if (proto_memory_give_back(&ring->results, PROTO_SHM_PAGE + taken,
                               PROTO_SHM_PAGE + region->taken) != 0) {
        return false; /* not on this system */
    }
    region->taken = taken;
    atomic_store_explicit(&ring->result_taken, PROTO_SHM_PAGE + taken,
                          memory_order_relaxed);
    srv_quota_refund(ring->resource.owner->user, SRV_QUOTA_SHM_BYTES, part);
    return taken > kept;
}

/* [compute] */
static void give_back(struct srv_job *job)
{
    srv_assert_compute();
    struct srv_ring *ring =
        (struct srv_ring *)((char *)job - offsetof(struct srv_ring, results_unused.job));
    job->goes_on = give_back_part(ring) || free_stray_results(ring);
}

void srv_ring_give_back(struct srv_ring *ring)
{
    srv_assert_compute();
    while (give_back_part(ring)) {
    }
}

int srv_ring_look(struct srv_ring *ring, struct proto_error *error)
{
    srv_assert_loop();
    struct srv_quota_user *user = ring->resource.owner->user;
    uint64_t held = proto_memory_held(&ring->upload) + proto_memory_held(&ring->results);
    uint64_t given = srv_ring_bytes(ring);
    uint64_t stray = held > given ? held - given : 0;
    bool was_stray = ring->was_stray; /* once may be what is being given now */
    if (ring->stray_bytes > 0) {
        srv_quota_refund(user, SRV_QUOTA_SHM_BYTES, ring->stray_bytes);
    }
    int status =
        stray > 0 ? srv_quota_charge(user, SRV_QUOTA_SHM_BYTES, stray, error) : 0;
    ring->stray_bytes = status == 0 ? stray : 0;
    ring->was_stray = stray > 0;
    if (stray > 0) {
        srv_reclaimed_start(&ring->slots_unused);
        srv_reclaimed_start(&ring->results_unused);
    }
    return was_stray ? status : 0;
}

void srv_ring_trim_if_idle(struct srv_ring *ring, struct srv_reclaim *reclaim)
{
    uint64_t taken = atomic_load_explicit(&ring->result_taken, memory_order_relaxed);
    if (taken > taken_first(ring->result_bytes)) {
        srv_reclaimed_use(&ring->results_unused, reclaim);
    }
    if (!is_one_slot(atomic_load_explicit(&ring->slots_taken, memory_order_relaxed))) {
        srv_reclaimed_use(&ring->slots_unused, reclaim);
    }
}
