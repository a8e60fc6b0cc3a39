/* frame.c - the positions of a step, written into a slot. */
#include <assert.h>
#include <stdatomic.h>
#include <string.h>

#include "attach.h"
#include "connection.h"
#include "coordinates.h"
#include "step.h"

#define RANGES_SLACK 16u /* bytes that the alignment of a segment's ranges can take */
#define PAYLOAD_MAX  (1ull << 48) /* more than any memory: sums do not wrap */
/* The `slot` of a frame is the number of a slot and, above these bits, that of the frame
 * among all of the process, so that a copy of a frame that is over is no other frame. */
#define SLOT_BITS 4u
static_assert(1u << SLOT_BITS >= PROTO_SLOTS_MAX, "the number of every slot");
/* The slot of a frame that was committed or aborted; who aborts it again loses no text.
 */
#define SLOT_GIVEN_BACK UINT32_MAX

static uint64_t table_bytes(uint32_t segment_max)
{
    return cli_round_up((uint64_t)segment_max * sizeof(struct proto_segment),
                        CLI_PAYLOAD_ALIGN);
}

uint64_t pccd_frame_bytes(uint32_t segment_max, uint64_t payload_bytes)
{
    uint64_t payload = payload_bytes < PAYLOAD_MAX ? payload_bytes : PAYLOAD_MAX;

    return table_bytes(segment_max) + (uint64_t)segment_max * RANGES_SLACK +
           cli_round_up(payload, CLI_RANGE_ALIGN);
}

/* ---- segments ---------------------------------------------------------------------- */

/* Return the bytes of either end of what a segment moves. */
static uint64_t bytes_of(const struct proto_segment *segment)
{
    switch (segment->kind) {
    case PROTO_SEGMENT_TURNING:
        return 0; /* it leads to joints */
    case PROTO_SEGMENT_RIGID:
        return PROTO_RIGID_BYTES;
    default:
        return segment->count * common_vertex_bytes(segment->format);
    }
}

static bool has_start(const struct proto_segment *segment)
{
    return segment->kind == PROTO_SEGMENT_X0X1 || segment->kind == PROTO_SEGMENT_RIGID;
}

uint64_t cli_segment_place(struct proto_segment *segment, uint64_t used)
{
    uint64_t bytes = cli_round_up(bytes_of(segment), CLI_RANGE_ALIGN);

    if (segment->kind == PROTO_SEGMENT_TURNING) {
        return used;
    }
    segment->offset0 = has_start(segment) ? used : 0;
    segment->offset1 = has_start(segment) ? used + bytes : used;
    return segment->offset1 + bytes;
}

void cli_segment_write(uint8_t *payload, const struct proto_segment *segment,
                       const void *x0, const void *x1)
{
    uint64_t bytes = bytes_of(segment);

    if (has_start(segment)) {
        memcpy(payload + segment->offset0, x0, bytes);
    }
    memcpy(payload + segment->offset1, x1, bytes);
}

/* ---- frames ------------------------------------------------------------------------ */

int cli_step_slot(struct pccd_client *client, uint64_t bytes, uint32_t *slot)
{
    uint64_t deadline_ns = cli_deadline(client, -1);
    int status = cli_step_check(client);

    if (status == 0) {
        status = cli_ring_reserve(client, bytes, deadline_ns);
    }
    return status != 0 ? status : cli_slot_begin(client, deadline_ns, slot);
}

/* Begin a slot for a step of `scene`. */
static int begin(struct pccd_client *client, uint32_t scene, uint32_t segment_max,
                 uint64_t payload_bytes, uint32_t *slot)
{
    uint64_t bytes = pccd_frame_bytes(segment_max, payload_bytes);
    struct cli_slot *own;
    int status;

    if (segment_max > PROTO_SEGMENTS_MAX) {
        return cli_fail(client, PCCD_E_LIMIT, "a step has at most %u segments, not %u",
                        PROTO_SEGMENTS_MAX, segment_max);
    }
    if (payload_bytes > PAYLOAD_MAX) {
        return cli_fail(client, PCCD_E_LIMIT, "a step of %llu bytes",
                        (unsigned long long)payload_bytes);
    }
    status = cli_step_slot(client, bytes, slot);
    if (status != 0) {
        return status;
    }
    own = &client->ring.slots[*slot];
    own->scene = scene;
    own->segment_max = segment_max;
    own->used_bytes = table_bytes(segment_max);
    own->limit_bytes = bytes;
    return 0;
}

/* The number of another frame, in the bits where it stands. */
static uint32_t number_frame(void)
{
    static _Atomic uint32_t begun;
    const uint32_t numbers = UINT32_MAX >> SLOT_BITS; /* 0 is none's, the last is none */

    return (atomic_fetch_add(&begun, 1) % (numbers - 1) + 1) << SLOT_BITS;
}

int pccd_frame_begin(struct pccd_client *client, uint32_t scene, uint32_t segment_max,
                     uint64_t payload_bytes, struct pccd_frame *frame)
{
    uint32_t slot = 0;
    int status;

    CLI_ENTER_OR_RETURN(client);
    if (frame == NULL) {
        return cli_fail(client, PCCD_E_INVAL, "frame is NULL");
    }
    status = begin(client, scene, segment_max, payload_bytes, &slot);
    if (status == 0) {
        client->ring.slots[slot].frame = number_frame() | slot;
        *frame = (struct pccd_frame){.client = client,
                                     .scene = scene,
                                     .slot = client->ring.slots[slot].frame,
                                     .segment_max = segment_max,
                                     .used_bytes = client->ring.slots[slot].used_bytes};
    }
    return status;
}

/* Keep a copy of a segment, if another daemon may have to be told of it. */
static int keep_segment(struct pccd_client *client, struct cli_slot *own,
                        const struct proto_segment *segment)
{
    if (!client->keeps) {
        return 0;
    }
    if (cli_slot_room(own, own->segment_count + 1, 0) != 0) {
        return cli_fail(client, PCCD_E_NOMEM, "no memory for %u segments",
                        own->segment_count + 1);
    }
    own->segments[own->segment_count] = *segment;
    return 0;
}

static uint32_t slot_of(const struct pccd_frame *frame)
{
    return frame->slot % (1u << SLOT_BITS);
}

/* The client of a frame; NULL: there is none. */
static struct pccd_client *client_of(const struct pccd_frame *frame)
{
    return frame != NULL ? frame->client : NULL;
}

/* The slot of a frame that is being written. The library's own account of it counts, not
 * the public struct's. */
static int find_slot(const struct pccd_frame *frame, struct cli_slot **own)
{
    uint32_t slot = slot_of(frame);

    if (frame->slot == SLOT_GIVEN_BACK) {
        return cli_fail(
            frame->client, PCCD_E_INVAL,
            "the frame was committed or aborted; pccd_frame_begin begins one");
    }
    if (slot >= frame->client->ring.slot_count ||
        frame->client->ring.slots[slot].state != CLI_SLOT_BEGUN ||
        frame->client->ring.slots[slot].frame != frame->slot) {
        return cli_fail(frame->client, PCCD_E_INVAL, "the frame is not begun");
    }
    if (cli_is_copy(frame->client)) {
        return cli_alive(frame->client); /* the slot is another process's */
    }
    *own = &frame->client->ring.slots[slot];
    return 0;
}

/* Copy joints into a slot that is begun, which has none yet. */
static int put_joints(struct pccd_client *client, uint32_t slot, struct cli_joints joints)
{
    struct cli_slot *own = &client->ring.slots[slot];
    const struct proto_joints head = {.count = joints.count};
    uint8_t *to = cli_slot_payload(&client->ring, slot) + own->used_bytes;

    if (joints.count > PROTO_JOINTS_MAX ||
        PROTO_JOINTS_BYTES(joints.count) > own->limit_bytes - own->used_bytes) {
        return cli_fail(client, PCCD_E_LIMIT,
                        "%u joints, and there is room for %llu bytes of the announced "
                        "%llu; %u at most",
                        joints.count,
                        (unsigned long long)(own->limit_bytes - own->used_bytes),
                        (unsigned long long)own->limit_bytes, PROTO_JOINTS_MAX);
    }
    memcpy(to, &head, sizeof head);
    memcpy(to + sizeof head, joints.items, joints.count * sizeof *joints.items);
    own->joints_at = own->used_bytes;
    own->joint_count = joints.count;
    own->used_bytes += PROTO_JOINTS_BYTES(joints.count);
    static_assert(PROTO_JOINTS_BYTES(1) % CLI_RANGE_ALIGN == 0,
                  "what follows is aligned");
    return 0;
}

/* Lead a segment that turns to the joints of its slot. */
static int lead_to_joints(struct pccd_client *client, const struct cli_slot *own,
                          struct proto_segment *segment)
{
    if (own->joints_at == 0) {
        return cli_fail(client, PCCD_E_STATE,
                        "the frame has no joints; pccd_frame_joints gives it some");
    }
    if (segment->first >= own->joint_count) {
        return cli_fail(
            client, PCCD_E_INVAL,
            "motion %u (object 0x%x): first is %u, its joint; the step has %u "
            "joints, from 0",
            own->segment_count, segment->object, segment->first, own->joint_count);
    }
    segment->offset0 = own->joints_at;
    return 0;
}

/* Enter a segment into the table of a slot that is begun, and give its ends a place. */
static int enter(struct pccd_client *client, uint32_t slot, struct proto_segment *segment)
{
    struct cli_slot *own = &client->ring.slots[slot];
    uint64_t end = cli_segment_place(segment, own->used_bytes);
    int status =
        segment->kind == PROTO_SEGMENT_TURNING ? lead_to_joints(client, own, segment) : 0;

    if (status != 0) {
        return status;
    }
    if (own->segment_count >= own->segment_max) {
        return cli_fail(client, PCCD_E_LIMIT, "more than the announced %u segments",
                        own->segment_max);
    }
    if (end > own->limit_bytes) {
        return cli_fail(client, PCCD_E_LIMIT,
                        "segment %u ends at byte %llu of the announced %llu",
                        own->segment_count, (unsigned long long)end,
                        (unsigned long long)own->limit_bytes);
    }
    assert(own->used_bytes % CLI_RANGE_ALIGN == 0 && end >= own->used_bytes);
    assert(own->limit_bytes <= client->ring.slot_stride);
    status = keep_segment(client, own, segment);
    if (status != 0) {
        return status;
    }
    memcpy(cli_slot_payload(&client->ring, slot) + own->segment_count * sizeof *segment,
           segment, sizeof *segment);
    own->used_bytes = end;
    own->segment_count++;
    return 0;
}

/* The same of a frame, and hand out where its ends are to be written. */
static int add_segment(struct pccd_frame *frame, struct proto_segment segment, void **x0,
                       void **x1)
{
    struct cli_slot *own = NULL;
    int status = find_slot(frame, &own);
    uint8_t *payload;

    if (status == 0) {
        status = enter(frame->client, slot_of(frame), &segment);
    }
    if (status != 0) {
        return status;
    }
    payload = cli_slot_payload(&frame->client->ring, slot_of(frame));
    if (has_start(&segment)) {
        *x0 = payload + segment.offset0;
    }
    *x1 = payload + segment.offset1;
    frame->used_bytes = own->used_bytes;
    frame->segment_count = own->segment_count;
    return 0;
}

/* The same of positions in a format that the caller has chosen. */
static int add_positions(struct pccd_frame *frame, struct proto_segment segment,
                         enum pccd_format format, void **x0, void **x1)
{
    if ((unsigned)format >= PCCD_FORMAT_COUNT) {
        return cli_fail(frame->client, PCCD_E_INVAL, "unknown format %u",
                        (unsigned)format);
    }
    if (x1 == NULL || (has_start(&segment) && x0 == NULL)) {
        return cli_fail(frame->client, PCCD_E_INVAL, "x0 or x1 is NULL");
    }
    segment.format = (uint16_t)format;
    return add_segment(frame, segment, x0, x1);
}

int pccd_frame_x1(struct pccd_frame *frame, uint32_t object, enum pccd_format format,
                  uint32_t first, uint32_t count, void **x1)
{
    const struct proto_segment segment = {
        .object = object, .kind = PROTO_SEGMENT_X1, .first = first, .count = count};

    CLI_ENTER_OR_RETURN(client_of(frame));
    return add_positions(frame, segment, format, NULL, x1);
}

int pccd_frame_x0x1(struct pccd_frame *frame, uint32_t object, enum pccd_format format,
                    uint32_t first, uint32_t count, void **x0, void **x1)
{
    const struct proto_segment segment = {
        .object = object, .kind = PROTO_SEGMENT_X0X1, .first = first, .count = count};

    CLI_ENTER_OR_RETURN(client_of(frame));
    return add_positions(frame, segment, format, x0, x1);
}

int pccd_frame_rigid(struct pccd_frame *frame, uint32_t object, uint32_t first,
                     uint32_t count, const double m0[12], const double m1[12])
{
    const struct proto_segment segment = {.object = object,
                                          .kind = PROTO_SEGMENT_RIGID,
                                          .format = PCCD_FORMAT_F64,
                                          .first = first,
                                          .count = count};
    void *to0 = NULL;
    void *to1 = NULL;
    int status;

    CLI_ENTER_OR_RETURN(client_of(frame));
    if (m0 == NULL || m1 == NULL) {
        return cli_fail(frame->client, PCCD_E_INVAL, "m0 or m1 is NULL");
    }
    status = add_segment(frame, segment, &to0, &to1);
    if (status != 0) {
        return status;
    }
    memcpy(to0, m0, PROTO_RIGID_BYTES);
    memcpy(to1, m1, PROTO_RIGID_BYTES);
    return 0;
}

int pccd_frame_joints(struct pccd_frame *frame, const struct pccd_joint *joints,
                      uint32_t count)
{
    const struct cli_joints given = {joints, count};
    struct cli_slot *own = NULL;
    int status;

    CLI_ENTER_OR_RETURN(client_of(frame));
    status = find_slot(frame, &own);
    if (status != 0) {
        return status;
    }
    if (joints == NULL || count == 0) {
        return cli_fail(frame->client, PCCD_E_INVAL, "%s",
                        joints == NULL ? "joints is NULL" : "a table of no joints");
    }
    if (own->joints_at != 0) {
        return cli_fail(frame->client, PCCD_E_STATE, "the frame has its joints already");
    }
    status = put_joints(frame->client, slot_of(frame), given);
    frame->used_bytes = own->used_bytes;
    return status;
}

int pccd_frame_turning(struct pccd_frame *frame, uint32_t object, uint32_t joint,
                       uint32_t vertex_count)
{
    struct proto_segment segment = {.object = object,
                                    .kind = PROTO_SEGMENT_TURNING,
                                    .format = PCCD_FORMAT_F64,
                                    .first = joint,
                                    .count = vertex_count};
    struct cli_slot *own = NULL;
    int status;

    CLI_ENTER_OR_RETURN(client_of(frame));
    status = find_slot(frame, &own);
    status = status != 0 ? status : enter(frame->client, slot_of(frame), &segment);
    if (status == 0) {
        frame->segment_count = own->segment_count;
    }
    return status;
}

int cli_frame_take(struct pccd_frame *frame, const uint64_t *step, uint32_t *scene,
                   uint32_t *slot)
{
    struct pccd_client *client;
    struct cli_slot *own = NULL;
    int status = find_slot(frame, &own);

    if (status != 0) {
        return status;
    }
    client = frame->client;
    *scene = own->scene;
    *slot = slot_of(frame);
    frame->slot = SLOT_GIVEN_BACK; /* a frame is committed once */
    /* Other steps may have been submitted meanwhile. */
    status = step == NULL ? cli_fail(client, PCCD_E_INVAL, "step is NULL")
                          : cli_step_check(client);
    if (status != 0) {
        cli_slot_abort(&client->ring, *slot);
    }
    return status;
}

void pccd_frame_abort(struct pccd_frame *frame)
{
    CLI_TURN cli_turn = cli_enter_late(client_of(frame));
    struct cli_slot *own = NULL;

    if (client_of(frame) == NULL || frame->slot == SLOT_GIVEN_BACK ||
        find_slot(frame, &own) != 0) {
        return;
    }
    cli_slot_abort(&frame->client->ring, slot_of(frame));
    frame->slot = SLOT_GIVEN_BACK;
}

/* ---- motions ----------------------------------------------------------------------- */

/* Return whether a motion says nothing but a joint of those that there are. */
static bool turns(const struct pccd_motion *motion, struct cli_joints joints)
{
    return joints.count > 0 && motion->x0 == NULL && motion->x1 == NULL &&
           motion->m0 == NULL && motion->m1 == NULL;
}

/* Describe what motion i moves. E_INVAL: it moves in no way, or in two. */
static int describe(struct pccd_client *client, const struct pccd_motion *motion,
                    uint32_t i, struct cli_joints joints, struct proto_segment *segment)
{
    bool is_rigid = motion->m0 != NULL;

    if (turns(motion, joints)) {
        *segment = (struct proto_segment){.object = motion->object,
                                          .kind = PROTO_SEGMENT_TURNING,
                                          .format = PCCD_FORMAT_F64,
                                          .first = motion->first,
                                          .count = motion->count};
        return 0;
    }
    if (is_rigid != (motion->m1 != NULL) || is_rigid != (motion->x1 == NULL) ||
        (is_rigid && motion->x0 != NULL)) {
        return cli_fail(client, PCCD_E_INVAL,
                        "motion %u (object 0x%x): it has%s%s%s%s, and needs one way to "
                        "move: x1, x0 and x1, m0 and m1, or a joint of the step's",
                        i, motion->object, motion->x0 != NULL ? " x0" : "",
                        motion->x1 != NULL ? " x1" : "", motion->m0 != NULL ? " m0" : "",
                        motion->m1 != NULL ? " m1"
                        : motion->x0 == NULL && motion->x1 == NULL && !is_rigid
                            ? " nothing"
                            : "");
    }
    if (!is_rigid && (unsigned)motion->format >= PCCD_FORMAT_COUNT) {
        return cli_fail(client, PCCD_E_INVAL, "motion %u: unknown format %u", i,
                        (unsigned)motion->format);
    }
    *segment = (struct proto_segment){
        .object = motion->object,
        .kind = is_rigid             ? PROTO_SEGMENT_RIGID
                : motion->x0 != NULL ? PROTO_SEGMENT_X0X1
                                     : PROTO_SEGMENT_X1,
        .format = (uint16_t)(is_rigid ? PCCD_FORMAT_F64 : motion->format),
        .first = motion->first,
        .count = motion->count};
    return 0;
}

static int write_motion(struct pccd_client *client, uint32_t slot,
                        const struct pccd_motion *motion, uint32_t i,
                        struct cli_joints joints)
{
    struct proto_segment segment;
    int status = describe(client, motion, i, joints, &segment);

    status = status != 0 ? status : enter(client, slot, &segment);
    if (status == 0 && segment.kind != PROTO_SEGMENT_TURNING) {
        bool is_rigid = motion->m0 != NULL;

        cli_segment_write(cli_slot_payload(&client->ring, slot), &segment,
                          is_rigid ? motion->m0 : motion->x0,
                          is_rigid ? motion->m1 : motion->x1);
    }
    return status;
}

int cli_frame_write(struct pccd_client *client, uint32_t scene,
                    const struct pccd_motion *motions, uint32_t motion_count,
                    struct cli_joints joints, uint32_t *slot)
{
    uint64_t bytes = 0;
    bool has_joints = false;
    int status = 0;

    for (uint32_t i = 0; status == 0 && i < motion_count; i++) {
        struct proto_segment segment;

        status = describe(client, &motions[i], i, joints, &segment);
        has_joints = has_joints || turns(&motions[i], joints);
        bytes += status != 0 ? 0 : bytes_of(&segment) * (has_start(&segment) ? 2 : 1);
    }
    bytes += has_joints ? PROTO_JOINTS_BYTES(joints.count) : 0;
    if (status == 0) {
        status = begin(client, scene, motion_count, bytes, slot);
    }
    if (status != 0) {
        return status;
    }
    status = has_joints ? put_joints(client, *slot, joints) : 0;
    for (uint32_t i = 0; status == 0 && i < motion_count; i++) {
        status = write_motion(client, *slot, &motions[i], i, joints);
    }
    if (status != 0) {
        cli_slot_abort(&client->ring, *slot);
    }
    return status;
}
