/* shm.h - the layout of the memory that a client shares with the daemon: the upload ring
 * and the result region.
 *
 * Threads: every word below names its one writer. All are little-endian and naturally
 * aligned.
 *
 * Upload ring (client read-write)             Result region (client read-only)
 *   0x0000 header, daemon-written, never       0x0000 header, daemon-written
 *          read back by the daemon             0x1000 data: a ring of pages of records;
 *   0x0080 head         client                        a page never wraps
 *   0x0100 tail         daemon
 *   0x0180 done_seq     daemon
 *   0x0200 client_wait  client
 *   0x0280 result_head  client
 *   0x0400 slot descriptors, 64 bytes each
 *   0x1000 slot payloads, slot_stride apart
 *
 * Slot protocol (a sequence lock per slot): the client stores seq = 2k+1 (release fence
 * after it), writes the payload, stores seq = 2k+2 (release) and submits (slot, 2k+2).
 * The daemon loads seq (acquire), copies, checks the copy, loads seq again. The answer
 * that names the step gives the slot back.
 */
#ifndef PROTO_SHM_H
#define PROTO_SHM_H

#include <assert.h>
#include <stdatomic.h>
#include <stddef.h>
#include <stdint.h>

#include "pccd_types.h"
#include "proto_limits.h"

#define PROTO_UPLOAD_MAGIC   0x75636370u /* "pccu" */
#define PROTO_RESULT_MAGIC   0x72636370u /* "pccr" */
#define PROTO_LAYOUT_VERSION 1u
#define PROTO_SHM_PAGE       4096u

/* One word alone in its 128 bytes: two cache lines, because adjacent lines are fetched in
 * pairs. */
struct proto_shm_word {
    _Atomic uint64_t value;
    uint8_t pad[120];
};

struct proto_shm_header {
    uint32_t magic;
    uint16_t version;
    uint16_t header_bytes; /* 0x1000: offset of slot 0, or of the result data */
    uint64_t size;         /* of the whole memory */
    uint32_t slot_count;   /* 0 in the result region */
    uint32_t reserved;
    uint64_t slot_stride;
    uint64_t slot0_offset;
    uint64_t epoch;
    uint8_t pad[80];
};

/* The memory of a slot. The client goes from NEEDED to FREE by a store, and back by an
 * exchange that finds FREE; the daemon goes from FREE to EMPTY by an exchange that finds
 * FREE, then gives the memory back, and from EMPTY to NEEDED when it has taken memory
 * again (shm.take). */
enum proto_slot_memory {
    PROTO_SLOT_NEEDED = 0, /* by the client, or it does not say */
    PROTO_SLOT_FREE = 1,   /* nobody needs what is in the slot */
    PROTO_SLOT_EMPTY = 2   /* it has no memory */
};

/* A slot descriptor. `seq` and `memory` have meaning to the daemon; every length comes
 * with the message. */
struct proto_slot {
    _Atomic uint64_t seq;
    uint64_t user;           /* the client's own */
    _Atomic uint64_t memory; /* enum proto_slot_memory */
    uint8_t pad[40];
};

struct proto_upload {
    struct proto_shm_header header;
    struct proto_shm_word head;        /* client: slots published */
    struct proto_shm_word tail;        /* daemon: slots returned */
    struct proto_shm_word done_seq;    /* daemon: requests answered on this ring */
    struct proto_shm_word client_wait; /* client: 1 = about to block, send the reply */
    struct proto_shm_word result_head; /* client: result bytes released, free-running */
    uint8_t pad[0x400 - 0x300];
    struct proto_slot slots[PROTO_SLOTS_MAX];
    uint8_t pad1[0x1000 - 0x400 - PROTO_SLOTS_MAX * 64];
};

/* Kinds of segment. */
enum proto_segment_kind {
    PROTO_SEGMENT_X1 = 0,      /* end positions; the start is the last step's end */
    PROTO_SEGMENT_X0X1 = 1,    /* start and end positions */
    PROTO_SEGMENT_RIGID = 2,   /* a transform for each end, of the registered positions */
    PROTO_SEGMENT_TURNING = 3, /* on a joint of a table; all vertices */
    PROTO_SEGMENT_KIND_COUNT = 4
};

/* One entry of the segment table, which stands at the start of a slot's payload.
 *
 * Ranges of one object must not overlap within a step. RIGID: offset0 and offset1 each
 * lead to double[12], the rows of [R | t]: x' = R x + t. TURNING: offset0 leads to a
 * struct proto_joints, that of the last such segment of the scene or one behind that;
 * `first` is the joint that the object hangs on, `count` all its vertices. A segment with
 * count = 0 is refused. */
struct proto_segment {
    uint32_t object;  /* handle */
    uint16_t kind;    /* enum proto_segment_kind */
    uint16_t format;  /* enum pccd_format; 1 for RIGID and TURNING */
    uint32_t first;   /* first vertex; TURNING: index of a joint */
    uint32_t count;   /* vertices */
    uint64_t offset0; /* bytes from the start of the payload; X1: must be 0 */
    uint64_t offset1; /* end positions; both offsets are multiples of 8. TURNING: 0 */
};

#define PROTO_RIGID_BYTES 96u /* double[12] */

/* The head of a table of joints; struct pccd_joint[count] follows. */
struct proto_joints {
    uint32_t count;    /* 1 .. PROTO_JOINTS_MAX */
    uint32_t reserved; /* 0 */
};
/* Return the bytes of a table of joints. */
#define PROTO_JOINTS_BYTES(count)                                                        \
    (sizeof(struct proto_joints) + (uint64_t)(count) * sizeof(struct pccd_joint))

/* One entry of the table of scenes, which stands at the start of the payload of a batch
 * (batch.submit). The table of segments of all scenes follows it: those of the first
 * scene, then those of the next. */
struct proto_batch_scene {
    uint32_t scene;    /* handle */
    uint32_t segments; /* of the table, that are this scene's; 0: it stands still */
};

/* An entry of a journal, which pages of scene.journal bring (PROTOCOL.md, "Journals"): a
 * request as it was sent, and what lay in the slot. */
struct proto_journal_entry {
    uint64_t bytes; /* of all of it, a multiple of 8 */
    uint32_t message_bytes;
    uint32_t reserved;
};
/* Return where its payload begins. */
#define PROTO_JOURNAL_PAYLOAD(message_bytes)                                             \
    ((sizeof(struct proto_journal_entry) + (uint64_t)(message_bytes) + 7) / 8 * 8)

/* The payload of scene.add begins with it. */
struct proto_journal_shape {
    uint32_t vertex_count;
    uint32_t radius_count; /* 0, or as many as vertices */
    uint32_t triangle_count;
    uint32_t edge_count;  /* those of the mesh that are free */
    uint32_t point_count; /* of those that are free */
    uint32_t reserved;
};

static_assert(sizeof(struct proto_shm_word) == 128, "a word has 128 bytes");
static_assert(sizeof(struct proto_shm_header) == 128, "header");
static_assert(offsetof(struct proto_shm_header, size) == 8, "header.size");
static_assert(offsetof(struct proto_shm_header, slot_count) == 16, "header.slot_count");
static_assert(offsetof(struct proto_shm_header, slot_stride) == 24, "header.slot_stride");
static_assert(offsetof(struct proto_shm_header, slot0_offset) == 32,
              "header.slot0_offset");
static_assert(offsetof(struct proto_shm_header, epoch) == 40, "header.epoch");
static_assert(offsetof(struct proto_upload, head) == 0x080, "head");
static_assert(offsetof(struct proto_upload, tail) == 0x100, "tail");
static_assert(offsetof(struct proto_upload, done_seq) == 0x180, "done_seq");
static_assert(offsetof(struct proto_upload, client_wait) == 0x200, "client_wait");
static_assert(offsetof(struct proto_upload, result_head) == 0x280, "result_head");
static_assert(offsetof(struct proto_upload, slots) == 0x400, "slots");
static_assert(sizeof(struct proto_upload) == 0x1000, "slot payloads begin at 0x1000");
static_assert(sizeof(struct proto_slot) == 64, "a slot descriptor has 64 bytes");
static_assert(offsetof(struct proto_slot, memory) == 16, "slot.memory");
static_assert(sizeof(struct proto_segment) == 32, "a segment has 32 bytes");
static_assert(sizeof(struct proto_journal_entry) == 16, "a message behind it is aligned");
static_assert(sizeof(struct proto_journal_shape) == 24, "vertices behind it are aligned");
static_assert(sizeof(struct proto_batch_scene) == 8, "segments behind it are aligned");
static_assert(offsetof(struct proto_segment, kind) == 4, "segment.kind");
static_assert(offsetof(struct proto_segment, first) == 8, "segment.first");
static_assert(offsetof(struct proto_segment, count) == 12, "segment.count");
static_assert(offsetof(struct proto_segment, offset0) == 16, "segment.offset0");
static_assert(offsetof(struct proto_segment, offset1) == 24, "segment.offset1");
static_assert(sizeof(struct proto_joints) == 8, "joints behind it are aligned");
static_assert(sizeof(struct pccd_joint) == 136, "a joint has 136 bytes");
static_assert(offsetof(struct pccd_joint, parent) == 4, "joint.parent");
static_assert(offsetof(struct pccd_joint, position) == 8, "joint.position");
static_assert(offsetof(struct pccd_joint, rotation) == 32, "joint.rotation");
static_assert(offsetof(struct pccd_joint, axis) == 64, "joint.axis");
static_assert(offsetof(struct pccd_joint, from) == 88, "joint.from");
static_assert(offsetof(struct pccd_joint, to) == 112, "joint.to");
static_assert(sizeof(_Atomic uint64_t) == 8, "atomics are plain words");

#endif
