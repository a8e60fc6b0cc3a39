/* frame.c - a step being written into a slot.
 *
 * Room:     client/lib. May include: attach.h, rpc.h, step.h.
 * Does:     lay out a slot's payload: the segment table at its start, then the positions,
 *           each range at a multiple of 8 bytes; publish it.
 * Does not: read anything back from the slot, or check what the daemon checks.
 * Threads:  [owner].
 */
#include <stdlib.h>
#include <string.h>

#include "attach.h"
#include "client.h"
#include "rpc.h"
#include "step.h"

#define PAYLOAD_ALIGN 64u /* of the first range: a cache line */
#define RANGE_ALIGN   8u  /* of every range: the protocol's */
#define RANGES_SLACK  16u /* bytes that the alignment of a segment's ranges can take */
#define PAYLOAD_MAX   (1ull << 48) /* more than any memory: sums do not wrap */
/* Slot of a frame that was committed or aborted; who aborts it again loses no text. */
#define SLOT_GIVEN_BACK UINT32_MAX

static uint64_t round_up(uint64_t bytes, uint64_t unit)
{
    return (bytes + unit - 1) / unit * unit;
}

static uint64_t table_bytes(uint32_t segment_max)
{
    return round_up((uint64_t)segment_max * sizeof(struct proto_segment), PAYLOAD_ALIGN);
}

uint64_t pccd_frame_bytes(uint32_t segment_max, uint64_t payload_bytes)
{
    uint64_t payload = payload_bytes < PAYLOAD_MAX ? payload_bytes : PAYLOAD_MAX;

    return table_bytes(segment_max) + (uint64_t)segment_max * RANGES_SLACK +
           round_up(payload, RANGE_ALIGN);
}

int pccd_frame_begin(struct pccd_client *client, uint32_t scene, uint32_t segment_max,
                     uint64_t payload_bytes, struct pccd_frame *frame)
{
    uint64_t bytes = pccd_frame_bytes(segment_max, payload_bytes);
    uint64_t deadline_ns;
    struct cli_slot *own;
    uint32_t slot = 0;
    int rc;

    if (client == NULL) {
        return PCCD_E_INVAL;
    }
    if (frame == NULL) {
        return cli_fail(client, PCCD_E_INVAL, "frame is NULL");
    }
    if (segment_max > PROTO_SEGMENTS_MAX) {
        return cli_fail(client, PCCD_E_LIMIT, "a step has at most %u segments, not %u",
                        PROTO_SEGMENTS_MAX, segment_max);
    }
    if (payload_bytes > PAYLOAD_MAX) {
        return cli_fail(client, PCCD_E_LIMIT, "a step of %llu bytes",
                        (unsigned long long)payload_bytes);
    }
    deadline_ns = cli_deadline(client, -1);
    rc = cli_step_check(client);
    if (rc == 0) {
        rc = cli_ring_reserve(client, bytes, deadline_ns);
    }
    if (rc == 0) {
        rc = cli_slot_begin(client, deadline_ns, &slot);
    }
    if (rc != 0) {
        return rc;
    }
    own = &client->ring.slots[slot];
    own->scene = scene;
    own->segment_max = segment_max;
    own->segment_count = 0;
    own->used_bytes = table_bytes(segment_max);
    own->limit_bytes = bytes;
    *frame = (struct pccd_frame){.client = client,
                                 .scene = scene,
                                 .slot = slot,
                                 .segment_max = segment_max,
                                 .used_bytes = own->used_bytes};
    return 0;
}

/* Keep a copy of a segment, if another daemon may have to be told of it. */
static int keep_segment(struct pccd_client *client, struct cli_slot *own,
                        const struct proto_segment *segment)
{
    uint32_t room = own->segment_room == 0 ? 4 : own->segment_room * 2;

    if (!client->keeps) {
        return 0;
    }
    if (own->segment_count == own->segment_room) { /* rare: rooms stay with the slot */
        struct proto_segment *segments = realloc(own->segments, room * sizeof(*segments));

        if (segments == NULL) {
            return cli_fail(client, PCCD_E_NOMEM, "no memory for %u segments", room);
        }
        own->segments = segments;
        own->segment_room = room;
    }
    own->segments[own->segment_count] = *segment;
    return 0;
}

/* The slot of a frame that is being written. The library's own account of it counts, not
 * the public struct's. */
static int find_slot(const struct pccd_frame *frame, struct cli_slot **own)
{
    if (frame == NULL || frame->client == NULL) {
        return PCCD_E_INVAL;
    }
    if (frame->slot == SLOT_GIVEN_BACK) {
        return cli_fail(
            frame->client, PCCD_E_INVAL,
            "the frame was committed or aborted; pccd_frame_begin begins one");
    }
    if (frame->slot >= frame->client->ring.slot_count ||
        frame->client->ring.slots[frame->slot].state != CLI_SLOT_BEGUN) {
        return cli_fail(frame->client, PCCD_E_INVAL, "the frame is not begun");
    }
    if (cli_is_copy(frame->client)) {
        return cli_alive(frame->client); /* the slot is another process's */
    }
    *own = &frame->client->ring.slots[frame->slot];
    return 0;
}

/* Enter a segment whose ranges have the given bytes (0: none) and hand out the ranges. */
static int add_segment(struct pccd_frame *frame, struct proto_segment segment,
                       uint64_t bytes0, uint64_t bytes1, void **range0, void **range1)
{
    struct cli_slot *own = NULL;
    uint64_t end0;
    uint64_t end1;
    uint8_t *payload;
    int rc = find_slot(frame, &own);

    if (rc != 0) {
        return rc;
    }
    if (own->segment_count >= own->segment_max) {
        return cli_fail(frame->client, PCCD_E_LIMIT,
                        "more than the announced %u segments", own->segment_max);
    }
    end0 = own->used_bytes + round_up(bytes0, RANGE_ALIGN);
    end1 = end0 + round_up(bytes1, RANGE_ALIGN);
    if (end1 > own->limit_bytes) {
        return cli_fail(frame->client, PCCD_E_LIMIT,
                        "segment %u ends at byte %llu of the announced %llu",
                        own->segment_count, (unsigned long long)end1,
                        (unsigned long long)own->limit_bytes);
    }
    payload = cli_slot_payload(frame->client, frame->slot);
    segment.offset0 = bytes0 > 0 ? own->used_bytes : 0;
    segment.offset1 = end0;
    rc = keep_segment(frame->client, own, &segment);
    if (rc != 0) {
        return rc;
    }
    memcpy(payload + own->segment_count * sizeof(segment), &segment, sizeof(segment));
    if (range0 != NULL) {
        *range0 = payload + own->used_bytes;
    }
    *range1 = payload + end0;
    own->used_bytes = end1;
    own->segment_count++;
    frame->used_bytes = own->used_bytes;
    frame->segment_count = own->segment_count;
    return 0;
}

static int check_format(const struct pccd_frame *frame, enum pccd_format format)
{
    if (frame != NULL && frame->client != NULL && (unsigned)format >= PCCD_FORMAT_COUNT) {
        return cli_fail(frame->client, PCCD_E_INVAL, "unknown format %u",
                        (unsigned)format);
    }
    return 0;
}

static uint64_t range_bytes(enum pccd_format format, uint32_t count)
{
    return (uint64_t)count *
           (format == PCCD_FORMAT_F64 ? 3 * sizeof(double) : 3 * sizeof(float));
}

int pccd_frame_x1(struct pccd_frame *frame, uint32_t object, enum pccd_format format,
                  uint32_t first, uint32_t count, void **x1)
{
    struct proto_segment segment = {.object = object,
                                    .kind = PROTO_SEGMENT_X1,
                                    .format = (uint16_t)format,
                                    .first = first,
                                    .count = count};
    int rc = check_format(frame, format);

    if (rc != 0 || x1 == NULL) {
        return PCCD_E_INVAL;
    }
    return add_segment(frame, segment, 0, range_bytes(format, count), NULL, x1);
}

int pccd_frame_x0x1(struct pccd_frame *frame, uint32_t object, enum pccd_format format,
                    uint32_t first, uint32_t count, void **x0, void **x1)
{
    struct proto_segment segment = {.object = object,
                                    .kind = PROTO_SEGMENT_X0X1,
                                    .format = (uint16_t)format,
                                    .first = first,
                                    .count = count};
    int rc = check_format(frame, format);

    if (rc != 0 || x0 == NULL || x1 == NULL) {
        return PCCD_E_INVAL;
    }
    return add_segment(frame, segment, range_bytes(format, count),
                       range_bytes(format, count), x0, x1);
}

int pccd_frame_rigid(struct pccd_frame *frame, uint32_t object, uint32_t first,
                     uint32_t count, const double m0[12], const double m1[12])
{
    struct proto_segment segment = {.object = object,
                                    .kind = PROTO_SEGMENT_RIGID,
                                    .format = PCCD_FORMAT_F64,
                                    .first = first,
                                    .count = count};
    void *range0 = NULL;
    void *range1 = NULL;
    int rc;

    if (m0 == NULL || m1 == NULL) {
        return PCCD_E_INVAL;
    }
    rc = add_segment(frame, segment, PROTO_RIGID_BYTES, PROTO_RIGID_BYTES, &range0,
                     &range1);
    if (rc != 0) {
        return rc;
    }
    memcpy(range0, m0, PROTO_RIGID_BYTES);
    memcpy(range1, m1, PROTO_RIGID_BYTES);
    return 0;
}

int pccd_frame_commit(struct pccd_frame *frame, const struct pccd_step_settings *settings,
                      uint64_t *step)
{
    struct pccd_client *client;
    struct cli_slot *own = NULL;
    uint32_t segment_count;
    uint32_t slot;
    uint64_t seq;
    int rc = find_slot(frame, &own);

    if (rc != 0) {
        return rc;
    }
    client = frame->client;
    slot = frame->slot;
    frame->slot = SLOT_GIVEN_BACK; /* a frame is committed once */
    segment_count = own->segment_count;
    if (step == NULL) {
        cli_slot_abort(client, slot);
        return cli_fail(client, PCCD_E_INVAL, "step is NULL");
    }
    seq = cli_slot_publish(client, slot);
    return cli_step_send(client, own->scene, slot, seq, segment_count, settings, step);
}

void pccd_frame_abort(struct pccd_frame *frame)
{
    struct cli_slot *own = NULL;

    if (frame == NULL || frame->slot == SLOT_GIVEN_BACK || find_slot(frame, &own) != 0) {
        return;
    }
    cli_slot_abort(frame->client, frame->slot);
    frame->slot = SLOT_GIVEN_BACK;
}
