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
    PCCD_ASSERT(sent->segments < sent->segments_max);
    copy.offset0 =
        segment->kind == PROTO_SEGMENT_X1 ? 0 : append_sent(sent, &parts[0], bytes);
    copy.offset1 = append_sent(sent, &parts[1], bytes);
    memcpy(sent->slot + sent->segments++ * sizeof copy, &copy, sizeof copy);
}

void srv_sent_end(struct srv_sent *sent)
{
    free(sent->slot);
    *sent = (struct srv_sent){.slot = NULL};
}

/* ---- staging ----------------------------------------------------------------------- */

/* A slot while it is being staged. */
struct staging {
    struct srv_scene *scene;
    const struct srv_member *member; /* whose objects may be moved; NULL: all */
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
        rigid ? PROTO_RIGID_BYTES : segment->count * common_vertex_bytes(segment->format);
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

/* Copy the positions of a checked segment of `object`, whose parts have `bytes` each,
 * into the scene's staging. Returns an engine status. */
static int copy_segment(const struct staging *staging, const struct srv_placed *object,
                        const struct proto_segment *segment, uint64_t bytes)
{
    struct eng_scene *engine = staging->scene->engine;
    const uint8_t *parts[2] = {staging->payload + segment->offset0,
                               staging->payload + segment->offset1};
    enum pccd_format format = (enum pccd_format)segment->format;
    uint32_t idx = object->engine_idx;
    if (staging->scene->diaries != NULL) {
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
    case PROTO_SEGMENT_KIND_COUNT:
        break;
    }
    srv_assert_failed("the kind was checked", __FILE__, __LINE__);
}

static bool may_move(const struct staging *staging, const struct srv_placed *object)
{
    return staging->member == NULL || object->member == staging->member;
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
    if (!may_move(staging, object)) {
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
    status = copy_segment(staging, object, segment, bytes);
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

/* Segments that are not staged any more: their objects count as if they had stood still,
 * as all that the request names. */
static void forget_rest(const struct staging *staging, uint32_t segments,
                        const struct proto_segment *table)
{
    for (uint32_t at = 0; at < segments; at++) {
        const struct srv_placed *object =
            srv_scene_find(staging->scene, table[at].object);
        if (object != NULL && may_move(staging, object)) {
            eng_stage_forget(staging->scene->engine, object->engine_idx);
        }
    }
}

/* Stage segments of a table that was copied already. */
static int stage_copied(struct staging *staging, uint32_t segments,
                        const struct proto_segment *table)
{
    int status = 0;
    uint32_t at = 0;
    for (; at < segments && status == 0; at++) {
        status = take_segment(staging, &table[at], at);
    }
    if (status != 0) { /* what is named before that was staged, and will be aborted */
        forget_rest(staging, segments - (at - 1), table + at - 1);
    }
    return status;
}

/* Copy the table and stage all of it. */
static int stage(struct staging *staging, uint32_t segments, struct proto_segment *table,
                 uint64_t *bytes)
{
    memcpy(table, staging->payload, staging->table_bytes); /* the one read of the table */
    int status = stage_copied(staging, segments, table);
    *bytes = staging->table_bytes + staging->copied;
    return status;
}

static int refuse_table(const struct staging *staging, uint32_t segments)
{
    return proto_error_set(staging->error, PCCD_E_SEGMENT,
                           "a table of %u segments does not fit in %llu bytes of a slot",
                           segments, (unsigned long long)staging->payload_bytes);
}

int srv_stage_slot(struct srv_ring *ring, const struct srv_cargo *cargo,
                   const struct srv_member *member, struct srv_scene *scene,
                   struct proto_segment *table, uint64_t *bytes,
                   struct proto_error *error)
{
    PCCD_ASSERT(cargo->segments >= 1 && cargo->segments <= PROTO_SEGMENTS_MAX);
    struct staging staging = {
        .scene = scene,
        .member = member,
        .payload_bytes = ring->slot_stride,
        .table_bytes = (uint64_t)cargo->segments * sizeof(struct proto_segment),
        .error = error,
    };
    int status =
        srv_ring_open_slot(ring, cargo->slot, cargo->seq, &staging.payload, error);
    if (status != 0) {
        return status;
    }
    if (staging.table_bytes > staging.payload_bytes) {
        return refuse_table(&staging, cargo->segments);
    }
    status = stage(&staging, cargo->segments, table, bytes);
    /* A slot that changed explains any other complaint. */
    int torn = srv_ring_check_slot(ring, cargo->slot, cargo->seq, error);
    return torn != 0 ? torn : status;
}

int srv_stage_scene(struct srv_ring *ring, const struct srv_cargo *cargo,
                    uint64_t tables_bytes, const struct srv_member *member,
                    struct srv_scene *scene, const struct proto_segment *table,
                    uint64_t *bytes, struct proto_error *error)
{
    PCCD_ASSERT(tables_bytes <= ring->slot_stride);
    struct staging staging = {
        .scene = scene,
        .member = member,
        .payload_bytes = ring->slot_stride,
        .table_bytes = tables_bytes,
        .error = error,
    };
    int status =
        srv_ring_open_slot(ring, cargo->slot, cargo->seq, &staging.payload, error);
    if (status != 0) {
        return status;
    }
    status = stage_copied(&staging, cargo->segments, table);
    *bytes = staging.copied;
    int torn = srv_ring_check_slot(ring, cargo->slot, cargo->seq, error);
    return torn != 0 ? torn : status;
}

int srv_stage_copy(const uint8_t *copy, uint64_t copy_bytes,
                   const struct srv_cargo *cargo, const struct srv_member *member,
                   struct srv_scene *scene, struct proto_segment *table, uint64_t *bytes,
                   struct proto_error *error)
{
    srv_assert_compute();
    struct staging staging = {
        .scene = scene,
        .member = member,
        .payload = copy,
        .payload_bytes = copy_bytes,
        .table_bytes = (uint64_t)cargo->segments * sizeof(struct proto_segment),
        .error = error,
    };
    PCCD_ASSERT(staging.table_bytes <= copy_bytes);
    return stage(&staging, cargo->segments, table, bytes);
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

int srv_stage_keep(struct srv_ring *ring, const struct srv_cargo *cargo,
                   uint64_t bytes_max, uint8_t **copy, uint64_t *bytes,
                   struct proto_error *error)
{
    PCCD_ASSERT(cargo->slot < ring->slot_count && bytes_max <= ring->slot_stride);
    struct staging staging = {
        .payload_bytes = bytes_max,
        .table_bytes = (uint64_t)cargo->segments * sizeof(struct proto_segment),
        .error = error,
    };
    const uint8_t *payload = NULL;
    int status = srv_ring_open_slot(ring, cargo->slot, cargo->seq, &payload, error);
    if (status != 0) {
        return status;
    }
    if (staging.table_bytes > bytes_max) {
        return refuse_table(&staging, cargo->segments);
    }
    uint8_t *new = malloc(bytes_max);
    if (new == NULL) {
        return proto_error_set(error, PCCD_E_NOMEM, "no memory to copy a slot");
    }
    memcpy(new, payload, staging.table_bytes); /* the one read of the table */
    staging.payload = new;
    *bytes = extent_of(&staging, cargo->segments);
    if (*bytes > 0) {
        memcpy(new + staging.table_bytes, payload + staging.table_bytes,
               *bytes - staging.table_bytes);
    }
    /* A slot that changed explains any other complaint. */
    int torn = srv_ring_check_slot(ring, cargo->slot, cargo->seq, error);
    if (torn != 0 || *bytes == 0) {
        free(new);
        return torn != 0 ? torn : error->code;
    }
    *copy = new;
    return 0;
}
