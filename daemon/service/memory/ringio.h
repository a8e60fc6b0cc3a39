/* ringio.h - the daemon's side of the memory shared with a client: positions come in,
 *
 * Create the upload ring and the result region; read the positions in a slot as shm.h
 * says (sequence check, one copy by the caller, second sequence check); hand out result
 * pages; tell the client what is done.
 */
#ifndef SRV_RINGIO_H
#define SRV_RINGIO_H

#include <stdbool.h>
#include <stdint.h>

#include "codec.h"
#include "compute.h"
#include "memfd.h"
#include "resource.h"
#include "shm.h"

/* ---- Gives the memory of large answers back to the system when the client is
 * idle.
 *
 * For example, an answer of 6 MiB is followed by silence: half a second to a second
 * later the result region (ringio.h) is back at its first 64 KiB, the slots that the
 * client does not need have no memory, and the user's quota says so. */

struct srv_service;
struct srv_timer;

/* Memory that somebody has to give back: part of a resource. */
struct srv_reclaimed {
    struct srv_job job; /* first: gives it back */
    struct srv_resource *resource;
    struct srv_reclaim *list; /* that it is in; NULL: none */
    struct srv_reclaimed *prev;
    struct srv_reclaimed *next;
    bool is_page_job; /* on [pages], else on [compute] */
    bool was_used;    /* since the timer last fired */
    bool is_idle;     /* within the timer's function */
};

/* Zeroed before; until srv_reclaim_init nothing is given back. */
struct srv_reclaim {
    struct srv_timer *timer;
    struct srv_reclaimed *first; /* what has memory to give back; the timer is set */
};

/* Give back from now on what is not used. Returns 0 or PCCD_E_NOMEM. Only for a host
 * whose timers fire by themselves. */
int srv_reclaim_init(struct srv_reclaim *reclaim, struct srv_service *service);
/* Free the timer. Does nothing a second time. */
void srv_reclaim_deinit(struct srv_reclaim *reclaim);

/* Prepare a resource's part: `give_back` is run in the turn of the resource's owner, on
 * [pages] or [compute]. */
void srv_reclaimed_init(struct srv_reclaimed *reclaimed, struct srv_resource *resource,
                        bool is_page_job, srv_job_fn give_back);
/* Give back now, in that turn, whether it was used or not. [loop] */
void srv_reclaimed_start(struct srv_reclaimed *reclaimed);
/* Note that it has memory to give back, and was used now. [loop] */
void srv_reclaimed_use(struct srv_reclaimed *reclaimed, struct srv_reclaim *reclaim);
/* Forget it, as it is going to be freed. */
void srv_reclaimed_forget(struct srv_reclaimed *reclaimed);

/* ---- Chooses where in the result region, a ring buffer in shared memory, the next
 * page of records goes.
 *
 * Hand out contiguous pages of a ring of bytes. Positions are counters that never wrap,
 * so that their difference is the fill; a page never wraps around the end of the ring. */

#define SRV_PAGE_ALIGN 64u /* pages begin on cache lines */

struct srv_region {
    uint64_t capacity; /* bytes, a multiple of SRV_PAGE_ALIGN */
    uint64_t tail;     /* bytes handed out, skipped ones included */
    uint64_t head;     /* bytes released, as last believed */
    uint64_t origin;   /* where the counters stood when position 0 was handed out last */
    uint64_t taken;    /* bytes from the start that have memory; the owner raises it */
    uint64_t limit;    /* bytes from the start that pages may use: taken .. capacity */
};

struct srv_page {
    uint64_t position; /* bytes from the start of the data */
    uint64_t count;    /* items that fit, 0 .. wanted */
    uint64_t release;  /* the head that releases this page and all before it */
};

void srv_region_init(struct srv_region *region, uint64_t capacity);

/* Make a ring whose bytes have no memory yet, but for the first `taken`. A page may then
 * end beyond them, and the owner gives it memory, or sets `limit` and reserves anew. */
void srv_region_init_sparse(struct srv_region *region, uint64_t capacity, uint64_t taken);

/* Reserve a page for up to `wanted` items of `item_bytes`, given the client's `head`: as
 * many as the longest free stretch holds, the stretch at hand preferred, but for one that
 * has no memory where the start has. An empty page takes no space. Returns 0, or
 * PCCD_E_INVAL when `head` went backwards or beyond what was handed out: then nothing
 * changes. */
int srv_region_reserve(struct srv_region *region, uint64_t head, uint32_t item_bytes,
                       uint64_t wanted, struct srv_page *page);

/* Return how many bytes from the start the pages that the client has not released reach,
 * given its `head`: what lies behind is not used. All of them when `head` makes no sense.
 */
uint64_t srv_region_used(const struct srv_region *region, uint64_t head);

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

/* Return the bytes that it has taken, and the owner's user is charged for. [loop] */
uint64_t srv_ring_bytes(const struct srv_ring *ring);
/* Make a ring of these sizes, without its memories; at first its first `slots_now` slots
 * have memory. NULL: no memory. [loop] */
struct srv_ring *srv_ring_new(struct srv_owner *owner,
                              const struct proto_SHM_ATTACH_result *sizes,
                              uint32_t slots_now);
/* Compute what a request comes to, in whole pages: all members of *sizes but
 * inflight_max. Returns 0, or PCCD_E_INVAL or PCCD_E_LIMIT with *error set. [any] */
int srv_ring_sizes(const struct proto_SHM_ATTACH_request *request,
                   struct proto_SHM_ATTACH_result *sizes, struct proto_error *error);
/* Charge the owner's user for what the ring will take at first, unless that is done.
 * Returns 0, or PCCD_E_QUOTA with *error set. [loop], and [pages] before create */
int srv_ring_charge(struct srv_ring *ring, struct proto_error *error);
/* Create, populate and seal the memories of a ring that is charged. On failure what
 * exists goes with the ring. [pages] */
int srv_ring_create(struct srv_ring *ring, uint64_t epoch, struct proto_error *error);

/* Return whether a slot has memory: the daemon reads no slot that has none. [loop] */
bool srv_ring_has_slot(const struct srv_ring *ring, uint32_t slot);
/* Take memory for a slot, and charge it, unless it has some. Returns 0, or PCCD_E_QUOTA
 * or PCCD_E_NOMEM with *error set: then nothing has changed. [pages] */
int srv_ring_take_slot(struct srv_ring *ring, uint32_t slot, struct proto_error *error);
/* Give back every slot that the client says is free, as another ring will take the place
 * of this one. [pages] */
void srv_ring_give_back_slots(struct srv_ring *ring);

/* Give *payload the payload of a slot that holds `seq`. Returns 0, or PCCD_E_SLOT_STALE
 * with *error set: it holds another one. [any] */
int srv_ring_open_slot(struct srv_ring *ring, uint32_t slot, uint64_t seq,
                       const uint8_t **payload, struct proto_error *error);
/* Check after the last read of the payload whether the slot has changed. Returns 0, or
 * PCCD_E_SLOT_TORN with *error set: then everything read from it is worth nothing.
 * [any] */
int srv_ring_check_slot(struct srv_ring *ring, uint32_t slot, uint64_t seq,
                        struct proto_error *error);

/* Reserve a page for up to `wanted` items in the result region; *data is where they go,
 * and page->position becomes the offset that the client uses. Memory is taken and charged
 * as pages need it; while that is refused the region is as large as what it has taken,
 * and a page holds less than `wanted`. Returns 0, or PCCD_E_INVAL with *error set: the
 * client's result_head makes no sense. [compute] */
int srv_ring_reserve(struct srv_ring *ring, uint32_t item_bytes, uint64_t wanted,
                     struct srv_page *page, void **data, struct proto_error *error);

/* Reserve a page for all that is wanted, or nothing. Returns as srv_ring_reserve, and
 * PCCD_E_BUSY with *error set, when there is no room for it until the client releases
 * pages. [compute] */
int srv_ring_reserve_all(struct srv_ring *ring, uint32_t item_bytes, uint64_t wanted,
                         struct srv_page *page, void **data, struct proto_error *error);

/* Return where the next page will begin, if it is of so many items and the client
 * releases none until then; nobody uses that memory so long. *bytes: how much there is;
 * 0: nothing. [compute] */
void *srv_ring_next(struct srv_ring *ring, uint32_t item_bytes, uint64_t wanted,
                    uint64_t *bytes);

/* Give back, and refund, at once what the result region has taken beyond what it began
 * with and behind all pages that the client has not released. [compute] */
void srv_ring_give_back(struct srv_ring *ring);
/* Give back and refund, unless another request follows soon: what the result region has
 * taken beyond what it began with and behind all pages that the client has not released;
 * and the slots that the client says are free, but for the last slot that has memory.
 * After a request was answered. [loop] */
void srv_ring_trim_if_idle(struct srv_ring *ring, struct srv_reclaim *reclaim);

/* Look at what both memories hold beyond what was given: a client can write to slots that
 * it has not taken, and read where no record is yet. It is charged to the owner's user
 * until the next look, and freed. Returns 0, or PCCD_E_QUOTA with *error set: it did so
 * before the last look, too, and the quota does not bear it. [loop] */
int srv_ring_look(struct srv_ring *ring, struct proto_error *error);

/* Return a slot to the client, as it has been read, or will not be. [any] */
void srv_ring_return_slot(struct srv_ring *ring);
/* Tell the client that a request on this ring has its answer; call before the answer is
 * sent. [any] */
void srv_ring_done(struct srv_ring *ring);

#endif
