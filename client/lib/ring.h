/* ring.h - the memory that a client shares with its daemon: slots for positions, pages of
 * records.
 *
 * Hold the upload slots that positions are written into, and the result region with the
 * pages of records; give a slot to the daemon or back to the library.
 *
 * A slot:  FREE --begin--> BEGUN --publish--> SENT --answer--> KEPT --folded--> FREE
 *                            `--abort--> FREE     `--nothing is kept--> FREE
 */
#ifndef CLI_RING_H
#define CLI_RING_H

#include <stdbool.h>
#include <stdint.h>

#include "memfd.h"
#include "proto_limits.h"
#include "shm.h"

#define CLI_PAGES     256u /* pages of records that are not released */
#define CLI_SLOT_NONE UINT32_MAX

/* KEPT: answered, and the only place where the last positions of an object are. */
enum cli_slot_state { CLI_SLOT_FREE = 0, CLI_SLOT_BEGUN, CLI_SLOT_SENT, CLI_SLOT_KEPT };

struct cli_slot {
    enum cli_slot_state state;
    uint64_t seq;                     /* last value stored in the slot's descriptor */
    uint32_t scene;                   /* BEGUN: of the frame being written */
    uint32_t frame;                   /* BEGUN: which frame that is (frame.c); 0: none */
    uint32_t segment_max;             /* announced */
    uint32_t segment_count;           /* written */
    uint64_t used_bytes;              /* segment table included */
    uint64_t limit_bytes;             /* announced */
    uint64_t joints_at;               /* BEGUN: where its table of joints is; 0: none */
    uint32_t joint_count;             /* of that */
    uint64_t step;                    /* KEPT: that brought it */
    struct proto_segment *segments;   /* a copy of the table */
    uint32_t segment_room;            /* of the copy */
    uint32_t scene_count;             /* of a batch; 0: a frame, of `scene` */
    struct proto_batch_scene *scenes; /* then: a copy of that table */
    uint32_t scene_room;
};

/* One page of the result region. Pages go back to the daemon in the order they came. */
struct cli_page {
    uint64_t release;    /* result_head that gives it back */
    const uint8_t *base; /* of the region that it lies in */
    uint64_t step;       /* that it belongs to; 0: to none */
    bool released;
};

struct cli_ring {
    struct proto_memory upload; /* base NULL: not attached */
    struct proto_memory result;
    uint32_t slot_count;
    uint64_t slot_stride;
    uint32_t inflight_max;
    uint64_t page_first; /* serial of its first page */
    struct cli_slot slots[PROTO_SLOTS_MAX];
};

/* Unmap; nothing is attached afterwards. */
void cli_ring_deinit(struct cli_ring *ring);

/* Return the first byte of a slot's payload. */
uint8_t *cli_slot_payload(const struct cli_ring *ring, uint32_t slot);

/* Mark a slot that is free as being written (state BEGUN): the daemon that reads it would
 * notice. */
void cli_slot_open(struct cli_ring *ring, uint32_t slot);

/* Make room for copies of so many segments and scenes: it stays with the slot. 0, or
 * PCCD_E_NOMEM. */
int cli_slot_room(struct cli_slot *own, uint32_t segments, uint32_t scenes);

/* Publish a begun slot (state SENT). Returns the sequence number for the message. */
uint64_t cli_slot_publish(struct cli_ring *ring, uint32_t slot);

/* Give a slot back without a request in flight. */
void cli_slot_abort(struct cli_ring *ring, uint32_t slot);

/* Tell the daemon that nobody needs what is in a slot that is FREE: it may give back the
 * slot's memory from now on. */
void cli_slot_offer(struct cli_ring *ring, uint32_t slot);
/* Offer all slots that are FREE. */
void cli_slot_offer_all(struct cli_ring *ring);

/* Return whether a slot has memory; one that was offered may lose it at any time. */
bool cli_slot_has_memory(const struct cli_ring *ring, uint32_t slot);
/* Withdraw what cli_slot_offer said, before the slot is written. Return whether the slot
 * still has its memory; if not, the daemon has to give it some (cli_slot_take). */
bool cli_slot_withdraw_offer(struct cli_ring *ring, uint32_t slot);

/* Return the KEPT slot with the oldest step; CLI_SLOT_NONE: none is KEPT. */
uint32_t cli_slot_oldest_kept(const struct cli_ring *ring);

#endif
