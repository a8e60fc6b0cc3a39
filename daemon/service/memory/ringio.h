/* ringio.h - the daemon's side of the memory shared with a client: positions come in,
 * records go out.
 *
 * Create the upload ring and the result region; read the positions in a slot as shm.h
 * says (sequence check, one copy by the caller, second sequence check); hand out result
 * pages; tell the client what is done.
 */
#ifndef SRV_RINGIO_H
#define SRV_RINGIO_H

#include "codec.h"
#include "memfd.h"
#include "reclaim.h"
#include "region.h"
#include "resource.h"
#include "shm.h"

struct srv_ring {
    struct srv_resource resource;
    struct proto_memory upload;
    struct proto_memory results;
    struct proto_upload *shared; /* = upload.base */
    uint32_t slot_count;
    uint32_t inflight_max;
    uint64_t slot_stride; /* = payload bytes of a slot */
    uint64_t upload_bytes;
    uint64_t result_bytes;
    /* Of result_bytes, from the start: what has memory, and is charged. Written on
     * [compute]; the loop may read an older value, relaxed. */
    _Atomic uint64_t result_taken;
    /* A bit a slot: it has memory, and is charged. Written on [pages]; the loop may read
     * an older value, relaxed. */
    _Atomic uint32_t slots_taken;
    bool is_charged;                     /* by srv_ring_charge */
    struct srv_region region;            /* [compute] */
    struct srv_reclaimed results_unused; /* behind all pages */
    struct srv_reclaimed slots_unused;
    uint64_t stray_at; /* [compute] results behind it may be stray; 0: all looked at */
    /* [loop] What the client had touched at the last look without having been given it,
     * charged until the next one. */
    uint64_t stray_bytes;
    bool was_stray; /* [loop] at the last look */
};

/* Bytes that it has taken, and the owner's user is charged for. [loop] */
uint64_t srv_ring_bytes(const struct srv_ring *ring);
/* A ring of these sizes, without its memories; at first its first `slots_now` slots have
 * memory. NULL: no memory. [loop] */
struct srv_ring *srv_ring_new(struct srv_owner *owner,
                              const struct proto_SHM_ATTACH_result *sizes,
                              uint32_t slots_now);
/* What a request comes to, in whole pages: all members of *sizes but inflight_max.
 * Returns 0, or PCCD_E_INVAL or PCCD_E_LIMIT with *error set. [any] */
int srv_ring_sizes(const struct proto_SHM_ATTACH_request *request,
                   struct proto_SHM_ATTACH_result *sizes, struct proto_error *error);
/* Charge the owner's user for what the ring will take at first, unless that is done.
 * Returns 0, or PCCD_E_QUOTA with *error set. [loop], and [pages] before create */
int srv_ring_charge(struct srv_ring *ring, struct proto_error *error);
/* Create, populate and seal the memories of a ring that is charged. On failure what
 * exists goes with the ring. [pages] */
int srv_ring_create(struct srv_ring *ring, uint64_t epoch, struct proto_error *error);

/* Whether a slot has memory: the daemon reads no slot that has none. [loop] */
bool srv_ring_has_slot(const struct srv_ring *ring, uint32_t slot);
/* Take memory for a slot, and charge it, unless it has some. Returns 0, or PCCD_E_QUOTA
 * or PCCD_E_NOMEM with *error set: then nothing has changed. [pages] */
int srv_ring_take_slot(struct srv_ring *ring, uint32_t slot, struct proto_error *error);
/* Another ring will take its place: give back every slot that the client says is free.
 * [pages] */
void srv_ring_give_back_slots(struct srv_ring *ring);

/* The payload of a slot that holds `seq`, or PCCD_E_SLOT_STALE. [any] */
int srv_ring_open_slot(struct srv_ring *ring, uint32_t slot, uint64_t seq,
                       const uint8_t **payload, struct proto_error *error);
/* After the last read of the payload: PCCD_E_SLOT_TORN when the slot has changed, then
 * everything read from it is worth nothing. [any] */
int srv_ring_check_slot(struct srv_ring *ring, uint32_t slot, uint64_t seq,
                        struct proto_error *error);

/* A page for up to `wanted` items in the result region; *data is where they go, and
 * page->position becomes the offset that the client uses. Memory is taken and charged as
 * pages need it; while that is refused the region is as large as what it has taken, and a
 * page holds less than `wanted`. PCCD_E_INVAL: the client's
 * result_head makes no sense. [compute] */
int srv_ring_reserve(struct srv_ring *ring, uint32_t item_bytes, uint64_t wanted,
                     struct srv_page *page, void **data, struct proto_error *error);

/* The same of all that is wanted, or nothing: PCCD_E_BUSY with *error set, when there is
 * no room for it until the client releases pages. [compute] */
int srv_ring_reserve_all(struct srv_ring *ring, uint32_t item_bytes, uint64_t wanted,
                         struct srv_page *page, void **data, struct proto_error *error);

/* Where the next page will begin, if it is of so many items and the client releases none
 * until then; nobody uses that memory so long. *bytes: how much there is; 0: nothing.
 * [compute] */
void *srv_ring_next(struct srv_ring *ring, uint32_t item_bytes, uint64_t wanted,
                    uint64_t *bytes);

/* Give back, and refund, at once what the result region has taken beyond what it began
 * with and behind all pages that the client has not released. [compute] */
void srv_ring_give_back(struct srv_ring *ring);
/* A request has been answered: when no other one follows for a while, the ring gives
 * back, and refunds, what the result region has taken beyond what it began with and
 * behind all pages that the client has not released, and the slots that the client says
 * are free, but for the last slot that has memory. [loop] */
void srv_ring_rest(struct srv_ring *ring, struct srv_reclaim *reclaim);

/* What both memories hold beyond what was given: a client can write to slots that it has
 * not taken, and read where no record is yet. It is charged to the owner's user until the
 * next look, and freed. Returns 0, or PCCD_E_QUOTA with *error set: it did so before the
 * last look, too, and the quota does not bear it. [loop] */
int srv_ring_look(struct srv_ring *ring, struct proto_error *error);

/* A slot has been read, or will not be. [any] */
void srv_ring_return_slot(struct srv_ring *ring);
/* A request on this ring has its answer; call before the answer is sent. [any] */
void srv_ring_done(struct srv_ring *ring);

#endif
