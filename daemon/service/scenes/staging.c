/* staging.c - the positions of a step, from a slot to its scene. */
#include "staging.h"

#include <stdlib.h>
#include <string.h>

#include "coordinates.h"
#include "invariant.h"
#include "proto_limits.h"

/* ---- a copy for journals ----------------------------------------------------------- */

/* Room for so many bytes more. */
static int reserve_sent(struct srv_sent *sent, uint64_t bytes)
{
    if (bytes > sent->bytes_max - sent->bytes) {
        return PCCD_E_LIMIT;
    }
    uint64_t need = sent->bytes + bytes;
    if (need > sent->room) {
        uint64_t room = need + need / 2;
        uint8_t *slot = realloc(sent->slot, room);
        if (slot == NULL) {
            return PCCD_E_NOMEM;
        }
        sent->slot = slot;
        sent->room = room;
    }
    return 0;
}

void srv_sent_begin(struct srv_sent *sent, uint64_t segments_max, uint64_t bytes_max)
{
    uint64_t table_bytes = segments_max * sizeof(struct proto_segment);
    srv_sent_end(sent);
    sent->bytes_max = bytes_max;
    sent->segments_max = segments_max;
    sent->status = segments_max > PROTO_SEGMENTS_MAX ? PCCD_E_LIMIT
                                                     : reserve_sent(sent, table_bytes);
    if (sent->status == 0 && table_bytes > 0) {
        memset(sent->slot, 0, table_bytes);
        sent->bytes = table_bytes;
    }
}

/* Append what `*part` points to, and point to the copy. Returns its offset. */
static uint64_t append_sent(struct srv_sent *sent, const uint8_t **part, uint64_t bytes)
{
    uint64_t offset = sent->bytes;
    uint64_t padded = (bytes + 7) / 8 * 8;
    uint8_t *to = sent->slot + offset;
    memcpy(to, *part, bytes);
    memset(to + bytes, 0, padded - bytes);
    *part = to;
    sent->bytes += padded;
    return offset;
}

static void add_entry(struct srv_sent *sent, const struct proto_segment *entry)
{
    PCCD_ASSERT(sent->segments < sent->segments_max);
    memcpy(sent->slot + sent->segments++ * sizeof *entry, entry, sizeof *entry);
}

void srv_sent_add(struct srv_sent *sent, const struct proto_segment *segment,
                  uint64_t bytes, const uint8_t *parts[2])
{
    struct proto_segment copy = *segment;
    if (sent->status == 0) {
        sent->status = reserve_sent(sent, 2 * (bytes + 8));
    }
    if (sent->status != 0) {
        return;
    }
    copy.offset0 =
        segment->kind == PROTO_SEGMENT_X1 ? 0 : append_sent(sent, &parts[0], bytes);
    copy.offset1 = append_sent(sent, &parts[1], bytes);
    add_entry(sent, &copy);
}

/* Copy a table of joints whose head was read, and return the offset of the copy; then
 * *joints points there, if it fits. */
static uint64_t copy_joints(struct srv_sent *sent, const struct proto_joints *head,
                            const uint8_t **joints)
{
    const uint8_t *first = (const uint8_t *)head;
    uint64_t bytes = head->count * sizeof(struct pccd_joint);
    if (sent->status == 0) {
        sent->status = reserve_sent(sent, sizeof *head + bytes);
    }
    if (sent->status != 0) {
        return 0;
    }
    uint64_t offset = append_sent(sent, &first, sizeof *head);
    (void)append_sent(sent, joints, bytes);
    return offset;
}

void srv_sent_end(struct srv_sent *sent)
{
    free(sent->slot);
    *sent = (struct srv_sent){.slot = NULL};
}

/* ---- staging ----------------------------------------------------------------------- */

/* Return whether [offset, offset + bytes) lies between the table and the end of the
 * payload. */
static bool is_inside(const struct srv_staging *staging, uint64_t offset, uint64_t bytes)
{
    return offset % 8 == 0 && offset >= staging->tables_bytes &&
           offset <= staging->payload_bytes && bytes <= staging->payload_bytes - offset;
}

/* Everything of segment `at` that does not need the object. *bytes: of each of its
 * parts. */
static int check_segment(const struct srv_staging *staging,
                         const struct proto_segment *segment, uint32_t at,
                         uint64_t *bytes)
{
    struct proto_error *error = staging->error;
    if (segment->kind >= PROTO_SEGMENT_KIND_COUNT) {
        return proto_error_set(error, PCCD_E_SEGMENT, "segment %u: unknown kind %u", at,
                               segment->kind);
    }
    bool rigid = segment->kind == PROTO_SEGMENT_RIGID;
    bool turning = segment->kind == PROTO_SEGMENT_TURNING;
    if (segment->format >= PCCD_FORMAT_COUNT ||
        ((rigid || turning) && segment->format != PCCD_FORMAT_F64)) {
        return proto_error_set(error, PCCD_E_SEGMENT, "segment %u: unknown format %u", at,
                               segment->format);
    }
    if (segment->count == 0) {
        return proto_error_set(error, PCCD_E_SEGMENT, "segment %u: no vertices", at);
    }
    *bytes = turning ? sizeof(struct proto_joints) /* what it says comes behind it */
             : rigid ? PROTO_RIGID_BYTES
                     : segment->count * common_vertex_bytes(segment->format);
    bool start_ok = segment->kind == PROTO_SEGMENT_X1
                        ? segment->offset0 == 0
                        : is_inside(staging, segment->offset0, *bytes);
    bool end_ok =
        turning ? segment->offset1 == 0 : is_inside(staging, segment->offset1, *bytes);
    if (!start_ok || !end_ok) {
        return proto_error_set(
            error, PCCD_E_SEGMENT,
            "segment %u: offsets %llu and %llu with %llu bytes each do not fit in the "
            "slot's bytes %llu to %llu, or are no multiples of 8",
            at, (unsigned long long)segment->offset0,
            (unsigned long long)segment->offset1, (unsigned long long)*bytes,
            (unsigned long long)staging->tables_bytes,
            (unsigned long long)staging->payload_bytes);
    }
    return 0;
}

/* Copy the positions of a checked segment of `object`, whose parts have `bytes` each,
 * into the scene's staging. Returns an engine status. */
static int copy_segment(const struct srv_staging *staging,
                        const struct srv_placed *object,
                        const struct proto_segment *segment, uint64_t bytes)
{
    struct eng_scene *engine = staging->scene->engine;
    const uint8_t *parts[2] = {staging->payload + segment->offset0,
                               staging->payload + segment->offset1};
    enum pccd_format format = (enum pccd_format)segment->format;
    uint32_t idx = object->engine_idx;
    if (staging->scene->journals != NULL) {
        srv_sent_add(&staging->scene->sent, segment, bytes, parts);
    }
    switch ((enum proto_segment_kind)segment->kind) {
    case PROTO_SEGMENT_X1:
        return eng_stage_x1(engine, idx, format, segment->first, segment->count,
                            parts[1]);
    case PROTO_SEGMENT_X0X1:
        return eng_stage_x0x1(engine, idx, format, segment->first, segment->count,
                              parts[0], parts[1]);
    case PROTO_SEGMENT_RIGID:
        return eng_stage_rigid(engine, idx, segment->first, segment->count, parts[0],
                               parts[1]);
    case PROTO_SEGMENT_TURNING:
    case PROTO_SEGMENT_KIND_COUNT:
        break;
    }
    srv_assert_failed("the kind was checked", __FILE__, __LINE__);
}

/* Stage the table of joints of segment `at`, unless that of the last such segment is the
 * same; any other lies behind that, so that nothing is copied twice. */
static int take_joints(struct srv_staging *staging, const struct proto_segment *segment,
                       uint32_t at)
{
    struct srv_joints *joints = &staging->joints;
    struct srv_scene *scene = staging->scene;
    struct proto_error *error = staging->error;
    struct proto_joints head;
    struct eng_bad_joint bad = {0, NULL};
    const uint8_t *from = staging->payload + segment->offset0;
    if (segment->offset0 == joints->offset) {
        return 0;
    }
    if (segment->offset0 < joints->end) {
        return proto_error_set(error, PCCD_E_SEGMENT,
                               "segment %u: a table of joints at %llu, which is neither "
                               "the last one nor behind it",
                               at, (unsigned long long)segment->offset0);
    }
    memcpy(&head, from,
           sizeof head); /* the one read of the head, and below of the rest */
    if (head.count == 0 || head.count > PROTO_JOINTS_MAX || head.reserved != 0 ||
        !is_inside(staging, segment->offset0, PROTO_JOINTS_BYTES(head.count)) ||
        segment->offset0 + PROTO_JOINTS_BYTES(head.count) > staging->joints_end) {
        return proto_error_set(
            error, PCCD_E_SEGMENT,
            "segment %u: a table of %u joints (and %u, not 0) at %llu does not end by "
            "%llu, where the slot ends or a table of the next scenes begins, or is not "
            "of 1 to %u joints",
            at, head.count, head.reserved, (unsigned long long)segment->offset0,
            (unsigned long long)staging->joints_end, PROTO_JOINTS_MAX);
    }
    from += sizeof head;
    if (scene->journals != NULL) {
        joints->sent_from = copy_joints(&scene->sent, &head, &from);
    }
    int status = eng_stage_joints(scene->engine, from, head.count, &joints->base, &bad);
    if (status == PCCD_E_INVAL && bad.why != NULL) {
        return proto_error_set(error, PCCD_E_SEGMENT,
                               "segment %u (object 0x%x): joint %u of its table: %s", at,
                               segment->object, bad.joint, bad.why);
    }
    if (status != 0) {
        return proto_error_set(error, status, "segment %u: %u joints: %s", at, head.count,
                               proto_status_text(status));
    }
    joints->offset = segment->offset0;
    joints->end = segment->offset0 + PROTO_JOINTS_BYTES(head.count);
    joints->count = head.count;
    staging->copied += PROTO_JOINTS_BYTES(head.count);
    return 0;
}

/* Check and stage a segment of an object that turns. */
static int take_turning(struct srv_staging *staging, const struct proto_segment *segment,
                        const struct srv_placed *object, uint32_t at)
{
    struct srv_scene *scene = staging->scene;
    if (segment->count != object->vertex_count) {
        return proto_error_set(staging->error, PCCD_E_SEGMENT,
                               "segment %u: %u vertices turn, object 0x%x has %u "
                               "(generation %u of its mesh): all do or none",
                               at, segment->count, segment->object, object->vertex_count,
                               object->generation);
    }
    int status = take_joints(staging, segment, at);
    if (status != 0) {
        return status;
    }
    if (segment->first >= staging->joints.count) {
        return proto_error_set(staging->error, PCCD_E_SEGMENT,
                               "segment %u: object 0x%x hangs on joint %u, the table has "
                               "%u",
                               at, segment->object, segment->first,
                               staging->joints.count);
    }
    if (scene->journals != NULL && scene->sent.status == 0) {
        struct proto_segment copy = *segment;
        copy.offset0 = staging->joints.sent_from;
        add_entry(&scene->sent, &copy);
    }
    status = eng_stage_turning(scene->engine, object->engine_idx,
                               staging->joints.base + segment->first);
    return status == 0
               ? 0
               : proto_error_set(staging->error, status,
                                 "segment %u (object 0x%x on joint %u): %s", at,
                                 segment->object, segment->first,
                                 status == PCCD_E_LIMIT
                                     ? "more than 128 joints between it and the world"
                                     : proto_status_text(status));
}

static uint32_t handle_of(const struct srv_scene *scene, uint32_t engine_idx)
{
    for (uint32_t i = 0; i < scene->placed_count; i++) {
        if (scene->placed[i].handle != 0 && scene->placed[i].engine_idx == engine_idx) {
            return scene->placed[i].handle;
        }
    }
    return 0;
}

int srv_stage_explain_stray(const struct srv_scene *scene, struct proto_error *error)
{
    static const char *const ends[3] = {" at t = 0", " at t = 1", ""};
    struct eng_stage_fault stray;
    return eng_stage_stray(scene->engine, &stray)
               ? proto_error_set(error, PCCD_E_NOTFINITE,
                                 "object 0x%x: %c of vertex %u is %.17g%s, not finite or "
                                 "beyond 1e18",
                                 handle_of(scene, stray.object_idx),
                                 (int)"xyz"[stray.axis], stray.vertex, stray.x,
                                 ends[stray.end])
               : proto_error_set(error, PCCD_E_NOTFINITE, "a coordinate of a segment: %s",
                                 proto_status_text(PCCD_E_NOTFINITE));
}

int srv_stage_explain_twice(const struct srv_scene *scene,
                            const struct srv_staging *staging, struct proto_error *error)
{
    const struct eng_stage_fault twice = eng_stage_twice(scene->engine);
    uint32_t object = handle_of(scene, twice.object_idx);
    uint32_t count = 0;
    uint32_t at[2] = {0, 0};
    uint32_t segments = staging->tables_bytes > 0 ? staging->slot.segments : 0;
    for (uint32_t i = 0; i < segments && count < 2; i++) {
        const struct proto_segment *segment = &staging->table[i];
        bool is_whole = segment->kind == PROTO_SEGMENT_TURNING;
        if (segment->object == object &&
            (is_whole || (twice.vertex >= segment->first &&
                          twice.vertex - segment->first < segment->count))) {
            at[count++] = i;
        }
    }
    return count == 2 ? proto_error_set(error, PCCD_E_SEGMENT,
                                        "vertex %u of object 0x%x is moved twice, by the "
                                        "segments %u and %u of the step, from 0",
                                        twice.vertex, object, at[0], at[1])
                      : proto_error_set(error, PCCD_E_SEGMENT,
                                        "vertex %u of object 0x%x is moved twice",
                                        twice.vertex, object);
}

static bool may_move(const struct srv_staging *staging, const struct srv_placed *object)
{
    return staging->member == NULL || object->member == staging->member;
}

/* Check and stage segment `at` of a table that was copied already. */
static int take_segment(struct srv_staging *staging, const struct proto_segment *segment,
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
    if (!may_move(staging, object)) {
        return proto_error_set(staging->error, PCCD_E_ACCESS,
                               "segment %u: object 0x%x is another session's", at,
                               segment->object);
    }
    if (segment->kind == PROTO_SEGMENT_TURNING) {
        return take_turning(staging, segment, object, at);
    }
    if (segment->first >= object->vertex_count ||
        segment->count > object->vertex_count - segment->first) {
        return proto_error_set(staging->error, PCCD_E_SEGMENT,
                               "segment %u: %u vertices from %u on, object 0x%x has %u "
                               "(generation %u of its mesh)",
                               at, segment->count, segment->first, segment->object,
                               object->vertex_count, object->generation);
    }
    status = copy_segment(staging, object, segment, bytes);
    if (status == PCCD_E_NOTFINITE && segment->kind != PROTO_SEGMENT_RIGID) {
        return srv_stage_explain_stray(staging->scene, staging->error);
    }
    if (status != 0) {
        return proto_error_set(
            staging->error, status, "segment %u (object 0x%x, vertices from %u): %s", at,
            segment->object, segment->first, proto_status_text(status));
    }
    staging->copied += segment->kind == PROTO_SEGMENT_X1 ? bytes : 2 * bytes;
    return 0;
}

/* Segments that are not staged any more: their objects count as if they had stood still,
 * as all that the request names. */
static void forget_from(const struct srv_staging *staging, uint32_t first)
{
    for (uint32_t at = first; at < staging->slot.segments; at++) {
        const struct srv_placed *object =
            srv_scene_find(staging->scene, staging->table[at].object);
        if (object != NULL && may_move(staging, object)) {
            eng_stage_unmap(staging->scene->engine, object->engine_idx);
        }
    }
}

static int refuse_table(const struct srv_staging *staging)
{
    return proto_error_set(staging->error, PCCD_E_SEGMENT,
                           "a table of %u segments does not fit in %llu bytes of a slot",
                           staging->slot.segments,
                           (unsigned long long)staging->payload_bytes);
}

static int read_table(struct srv_staging *staging)
{
    staging->tables_bytes = staging->slot.segments * sizeof *staging->table;
    if (staging->tables_bytes > staging->payload_bytes) {
        return refuse_table(staging);
    }
    memcpy(staging->table, staging->payload, staging->tables_bytes); /* the one read */
    staging->copied = staging->tables_bytes;
    return 0;
}

static int stage_segments(struct srv_staging *staging)
{
    for (uint32_t at = 0; at < staging->slot.segments; at++) {
        int status = take_segment(staging, &staging->table[at], at);
        if (status != 0) { /* what is before it was staged, and will be aborted */
            forget_from(staging, at);
            return status;
        }
    }
    return 0;
}

int srv_stage(struct srv_staging *staging)
{
    const struct srv_slot_ref *slot = &staging->slot;
    bool has_table = staging->tables_bytes > 0;
    int status = 0;
    PCCD_ASSERT(slot->segments >= 1 && slot->segments <= PROTO_SEGMENTS_MAX);
    if (staging->ring != NULL) {
        staging->payload_bytes = staging->ring->slot_stride;
        status = srv_ring_open_slot(staging->ring, slot->slot, slot->seq,
                                    &staging->payload, staging->error);
    }
    if (status == 0 && !has_table) {
        status = read_table(staging);
    }
    if (status != 0) {
        return status;
    }
    if (staging->joints_end == 0) {
        staging->joints_end = staging->payload_bytes;
    }
    status = stage_segments(staging);
    /* A slot that changed explains any other complaint. */
    int torn = staging->ring != NULL ? srv_ring_check_slot(staging->ring, slot->slot,
                                                           slot->seq, staging->error)
                                     : 0;
    return torn != 0 ? torn : status;
}

/* Return where a table of joints ends, as its head says now: whoever stages the copy
 * reads that one. Beyond the payload: where that ends. */
static uint64_t end_of_joints(const struct srv_staging *staging, const uint8_t *payload,
                              uint64_t offset)
{
    struct proto_joints head;
    memcpy(&head, payload + offset, sizeof head);
    uint64_t end = offset + PROTO_JOINTS_BYTES(head.count);
    return end < staging->payload_bytes ? end : staging->payload_bytes;
}

/* Return where the last segment of a copied table ends, of a slot whose payload is not
 * copied yet; 0: something is wrong with one, and the error is set. */
static uint64_t extent_of(const struct srv_staging *staging, const uint8_t *payload)
{
    const uint8_t *table = staging->payload + staging->slot.scenes_bytes;
    uint64_t extent = staging->tables_bytes;
    for (uint32_t at = 0; at < staging->slot.segments; at++) {
        struct proto_segment segment;
        uint64_t bytes = 0;
        memcpy(&segment, table + at * sizeof segment, sizeof segment);
        if (check_segment(staging, &segment, at, &bytes) != 0) {
            return 0;
        }
        uint64_t end0 = segment.offset0 == 0 ? 0 : segment.offset0 + bytes;
        uint64_t end1 = segment.offset1 + bytes;
        if (segment.kind == PROTO_SEGMENT_TURNING) {
            end0 = end1 = end_of_joints(staging, payload, segment.offset0);
        }
        extent = end0 > extent ? end0 : extent;
        extent = end1 > extent ? end1 : extent;
    }
    return extent;
}

int srv_stage_keep(struct srv_ring *ring, const struct srv_slot_ref *slot,
                   uint64_t bytes_max, uint8_t **copy, uint64_t *bytes,
                   struct proto_error *error)
{
    PCCD_ASSERT(slot->slot < ring->slot_count && bytes_max <= ring->slot_stride);
    struct srv_staging staging = {
        .slot = *slot,
        .payload_bytes = bytes_max,
        .tables_bytes =
            slot->scenes_bytes + (uint64_t)slot->segments * sizeof(struct proto_segment),
        .error = error,
    };
    const uint8_t *payload = NULL;
    int status = srv_ring_open_slot(ring, slot->slot, slot->seq, &payload, error);
    if (status != 0) {
        return status;
    }
    if (staging.tables_bytes > bytes_max) {
        return refuse_table(&staging);
    }
    uint8_t *new = malloc(bytes_max);
    if (new == NULL) {
        return proto_error_set(error, PCCD_E_NOMEM, "no memory to copy a slot");
    }
    memcpy(new, payload, staging.tables_bytes); /* the one read of the table */
    staging.payload = new;
    *bytes = extent_of(&staging, payload);
    if (*bytes > 0) {
        memcpy(new + staging.tables_bytes, payload + staging.tables_bytes,
               *bytes - staging.tables_bytes);
    }
    /* A slot that changed explains any other complaint. */
    int torn = srv_ring_check_slot(ring, slot->slot, slot->seq, error);
    if (torn != 0 || *bytes == 0) {
        free(new);
        return torn != 0 ? torn : error->code;
    }
    *copy = new;
    return 0;
}
