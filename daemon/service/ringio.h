/* ringio.h - the daemon's side of the upload ring and of the result region.
 *
 * Room:     service. May include: resource.h, region.h, the protocol's headers.
 * Does:     create both memories; read slots as shm.h says (sequence check, one copy,
 *           second sequence check); hand out result pages; tell the client what is done.
 * Does not: believe a length, an offset or a count that stands in shared memory: lengths
 *           come with the message, and the segment table is copied once and then checked.
 * Threads:  functions say.
 */
#ifndef SRV_RINGIO_H
#define SRV_RINGIO_H

#include "codec.h"
#include "memfd.h"
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
    struct srv_region region; /* [compute] */
};

/* Bytes that a ring of these sizes takes at first: all of the upload ring, and as much of
 * the result region as the smallest has. [any] */
uint64_t srv_ring_bytes_first(const struct proto_SHM_ATTACH_result *sizes);
/* Bytes that it has taken. [loop] */
uint64_t srv_ring_bytes(const struct srv_ring *ring);
/* A ring of these sizes, without its memories; the quota for srv_ring_bytes_first has
 * been charged already. NULL: no memory. [loop] */
struct srv_ring *srv_ring_new(struct srv_session *session,
                              const struct proto_SHM_ATTACH_result *sizes);
/* What a request comes to, in whole pages: all members of *sizes but inflight_max.
 * Returns 0, or PCCD_E_INVAL or PCCD_E_LIMIT with *error set. [any] */
int srv_ring_sizes(const struct proto_SHM_ATTACH_request *request,
                   struct proto_SHM_ATTACH_result *sizes, struct proto_error *error);
/* Create, populate and seal the memories. On failure what exists goes with the ring.
 * [compute] */
int srv_ring_create(struct srv_ring *ring, uint64_t epoch, struct proto_error *error);

/* The payload of a slot that holds `seq`, or PCCD_E_SLOT_STALE. [any] */
int srv_ring_open_slot(struct srv_ring *ring, uint32_t slot, uint64_t seq,
                       const uint8_t **payload, struct proto_error *error);
/* After the last read of the payload: PCCD_E_SLOT_TORN when the slot has changed, then
 * everything read from it is worth nothing. [any] */
int srv_ring_check_slot(struct srv_ring *ring, uint32_t slot, uint64_t seq,
                        struct proto_error *error);

/* Stage the step in a slot: copy and check the segment table, then copy the positions of
 * each segment into `scene`, which has its staging open. On failure the caller aborts it.
 * Only objects that were added with `seat` may be moved (PCCD_E_ACCESS), NULL: all.
 * `table` has room for PROTO_SEGMENTS_MAX. *bytes is what was copied. [compute] */
int srv_ring_stage(struct srv_ring *ring,
                   const struct proto_FRAME_SUBMIT_request *request,
                   const struct srv_seat *seat, struct srv_scene *scene,
                   struct proto_segment *table, uint64_t *bytes,
                   struct proto_error *error);
/* The same out of a copy of a slot. [compute] */
int srv_ring_stage_copy(const uint8_t *copy, uint64_t copy_bytes,
                        const struct proto_FRAME_SUBMIT_request *request,
                        const struct srv_seat *seat, struct srv_scene *scene,
                        struct proto_segment *table, uint64_t *bytes,
                        struct proto_error *error);
/* A copy, of malloc, of what the step uses of its slot, *bytes of at most `bytes_max`.
 * Returns 0, PCCD_E_SLOT_STALE, PCCD_E_SLOT_TORN, PCCD_E_SEGMENT (it uses more, or a
 * segment is not as it must be) or PCCD_E_NOMEM with *error set. [any] */
int srv_ring_copy_slot(struct srv_ring *ring,
                       const struct proto_FRAME_SUBMIT_request *request,
                       uint64_t bytes_max, uint8_t **copy, uint64_t *bytes,
                       struct proto_error *error);

/* A page for up to `wanted` items in the result region; *data is where they go, and
 * page->position becomes the offset that the client uses. Memory is taken and charged as
 * pages need it; while that is refused the region is as large as what it has taken, and a
 * page holds less than `wanted`. PCCD_E_INVAL: the client's
 * result_head makes no sense. [compute] */
int srv_ring_reserve(struct srv_ring *ring, uint32_t item_bytes, uint64_t wanted,
                     struct srv_page *page, void **data, struct proto_error *error);

/* A slot has been read, or will not be. [any] */
void srv_ring_return_slot(struct srv_ring *ring);
/* A request on this ring has its answer; call before the answer is sent. [any] */
void srv_ring_done(struct srv_ring *ring);

#endif
