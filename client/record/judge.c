/* judge.c - whether a payload is what its kind says. */
#include <assert.h>
#include <inttypes.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include "chunk.h"

#include "coordinates.h"
#include "joints.h"
#include "payload.h"
#include "proto_limits.h"

/* The layout of the file, whatever the compiler. */
static_assert(sizeof(struct record_chunk) == 48, "chunk");
static_assert(sizeof(struct record_begin) == 56, "begin");
static_assert(sizeof(struct record_mesh) == 40, "mesh");
static_assert(sizeof(struct record_scene) == 8, "scene");
static_assert(sizeof(struct record_object) == 16, "object");
static_assert(sizeof(struct record_place) == 16, "place");
static_assert(sizeof(struct record_frame) == 176, "frame");
static_assert(sizeof(struct record_joints) == 8, "joints");
static_assert(sizeof(struct record_segment) == 32, "segment");
static_assert(sizeof(struct record_answer) == 168, "answer");
static_assert(sizeof(struct record_records) == 32, "records");
static_assert(sizeof(struct record_filter) == 16 + 8 * COMMON_WORDS, "filter");
static_assert(offsetof(struct record_filter, words) == RECORD_FILTER_BYTES, "filter");
static_assert(sizeof(struct record_pairs) == 8, "pairs");
static_assert(sizeof(struct record_pair) == 24, "pair");
static_assert(sizeof(struct record_name) == 16, "name");

#define COUNT_MAX   2147483647u
#define RIGID_BYTES (12 * sizeof(double))

static int bad(char text[RECORD_TEXT_BYTES], const char *why)
{
    (void)snprintf(text, RECORD_TEXT_BYTES, "%s", why);
    return PCCD_E_FORMAT;
}

static bool is_length(double length)
{
    return length >= 0.0 && length <= PROTO_COORDINATE_MAX;
}

static uint64_t padded(uint64_t bytes)
{
    return (bytes + 7) / 8 * 8;
}

static int judge_vertices(const void *x, uint32_t format, uint32_t count,
                          char text[RECORD_TEXT_BYTES])
{
    uint64_t stray = common_first_stray(x, format, count);

    if (stray == count) {
        return PCCD_OK;
    }
    (void)snprintf(text, RECORD_TEXT_BYTES,
                   "vertex %" PRIu64 " is not finite or beyond 1e18", stray);
    return PCCD_E_FORMAT;
}

static int judge_triangles(const uint8_t *triangles, uint32_t triangle_count,
                           uint32_t vertex_count, char text[RECORD_TEXT_BYTES])
{
    for (uint64_t i = 0; i < 3 * (uint64_t)triangle_count; i++) {
        uint32_t vertex;

        memcpy(&vertex, triangles + i * sizeof vertex, sizeof vertex);
        if (vertex >= vertex_count) {
            (void)snprintf(text, RECORD_TEXT_BYTES,
                           "triangle %" PRIu64 " names vertex %" PRIu32 " of %" PRIu32,
                           i / 3, vertex, vertex_count);
            return PCCD_E_FORMAT;
        }
    }
    return PCCD_OK;
}

/* Judge the radii, edges and points of a shape. */
static int judge_features(const uint8_t *payload, const struct record_mesh *head,
                          char text[RECORD_TEXT_BYTES])
{
    const struct record_shape at = record_shape_of(head);

    for (uint64_t i = at.radii; i < at.triangles; i += sizeof(double)) {
        double radius;

        memcpy(&radius, payload + i, sizeof radius);
        if (!is_length(radius)) {
            return bad(text, "a radius that cannot be one");
        }
    }
    for (uint64_t i = at.edges; i < at.end; i += sizeof(uint32_t)) {
        uint32_t vertex;

        memcpy(&vertex, payload + i, sizeof vertex);
        if (vertex >= head->vertex_count) {
            return bad(text, "an edge or a point of a vertex that there is not");
        }
    }
    return PCCD_OK;
}

static int judge_shape(const uint8_t *payload, uint64_t bytes,
                       const struct record_mesh *head, char text[RECORD_TEXT_BYTES])
{
    int status;

    if (head->format >= PCCD_FORMAT_COUNT || head->vertex_count == 0 ||
        head->vertex_count > COUNT_MAX || head->triangle_count > COUNT_MAX ||
        head->has_radii > 1) {
        return bad(text, "a shape without vertices, or of unknown kind");
    }
    const struct record_shape at = record_shape_of(head);
    if (bytes != at.end) {
        return bad(text, "a shape of another length");
    }
    status = judge_vertices(payload + at.x, head->format, head->vertex_count, text);
    status = status != PCCD_OK
                 ? status
                 : judge_triangles(payload + at.triangles, head->triangle_count,
                                   head->vertex_count, text);
    return status != PCCD_OK ? status : judge_features(payload, head, text);
}

static int judge_guest(const void *payload, uint64_t bytes, char text[RECORD_TEXT_BYTES])
{
    struct record_mesh head;

    memcpy(&head, payload, sizeof head);
    return head.object == 0 || head.scene == 0
               ? bad(text, "an object without handle or scene")
               : judge_shape(payload, bytes, &head, text);
}

static int judge_mesh(const void *payload, uint64_t bytes, char text[RECORD_TEXT_BYTES])
{
    struct record_mesh head;

    memcpy(&head, payload, sizeof head);
    return head.mesh == 0 ? bad(text, "a mesh without handle")
                          : judge_shape(payload, bytes, &head, text);
}

static int judge_place(const void *payload, uint64_t bytes, char text[RECORD_TEXT_BYTES])
{
    struct record_place place;
    uint64_t rest = bytes - sizeof place;

    memcpy(&place, payload, sizeof place);
    if (place.format >= PCCD_FORMAT_COUNT) {
        return bad(text, "a place of unknown format");
    }
    if (place.placing == RECORD_PLACED_RIGID) {
        return rest == RIGID_BYTES ? PCCD_OK : bad(text, "a transform of another length");
    }
    if (place.placing != RECORD_PLACED_FREELY) {
        return bad(text, "a place of unknown kind");
    }
    return rest > 0 && rest % common_vertex_bytes(place.format) == 0
               ? PCCD_OK
               : bad(text, "a place that holds no whole vertices");
}

/* `bytes` at `offset` of a slot's payload of `all` bytes. */
static bool is_inside(uint64_t offset, uint64_t bytes, uint64_t all)
{
    return offset % 8 == 0 && offset <= all && bytes <= all - offset;
}

/* Return the bytes of one end of a segment. */
static uint64_t positions_bytes(const struct record_segment *segment)
{
    return segment->kind == RECORD_ON_JOINT ? 0
           : segment->kind == RECORD_RIGID
               ? RIGID_BYTES
               : segment->count * common_vertex_bytes(segment->format);
}

/* Judge the table of joints at `offset` of a slot, `all` bytes. *count: of its joints. */
static bool are_joints(const uint8_t *slot, uint64_t all, uint64_t offset,
                       uint32_t *count)
{
    struct record_joints head;

    if (!is_inside(offset, sizeof head, all)) {
        return false;
    }
    memcpy(&head, slot + offset, sizeof head);
    *count = head.count;
    if (head.count == 0 || head.count > PROTO_JOINTS_MAX || head.reserved != 0 ||
        head.count > (all - offset - sizeof head) / sizeof(struct pccd_joint)) {
        return false;
    }
    for (uint32_t i = 0; i < head.count; i++) {
        struct pccd_joint joint;

        memcpy(&joint, slot + offset + sizeof head + i * sizeof joint, sizeof joint);
        if (common_joint_fault(&joint, i) != NULL) {
            return false;
        }
    }
    return true;
}

/* The payload of a slot, `all` bytes, with a table of `count` segments. `step` is of whom
 * it moves. */
static int judge_segments(const uint8_t *slot, uint64_t all, uint32_t count,
                          uint64_t step, char text[RECORD_TEXT_BYTES])
{
    if (count > all / sizeof(struct record_segment) || count > PROTO_SEGMENTS_MAX) {
        return bad(text, "a movement with less than its segments, or too many");
    }
    uint64_t joints_at = 0; /* of the last that turned; the next may be behind its end */
    uint64_t joints_end = 0;
    uint32_t joint_count = 0;

    for (uint32_t i = 0; i < count; i++) {
        struct record_segment segment;
        bool fits = true;

        memcpy(&segment, slot + i * sizeof segment, sizeof segment);
        uint64_t each = positions_bytes(&segment);
        if (segment.kind == RECORD_ON_JOINT) {
            if (joints_end == 0 || segment.offset0 != joints_at) {
                fits = segment.offset0 >= joints_end &&
                       are_joints(slot, all, segment.offset0, &joint_count);
                joints_at = segment.offset0;
                joints_end = joints_at + sizeof(struct record_joints) +
                             joint_count * sizeof(struct pccd_joint);
            }
            fits = fits && segment.first < joint_count;
        }
        if (!fits || segment.kind > RECORD_ON_JOINT ||
            segment.format >= PCCD_FORMAT_COUNT ||
            !is_inside(segment.offset1, each, all) ||
            (segment.kind != RECORD_X1 && !is_inside(segment.offset0, each, all))) {
            (void)snprintf(text, RECORD_TEXT_BYTES,
                           "segment %" PRIu32 " of frame %" PRIu64 " is malformed", i,
                           step);
            return PCCD_E_FORMAT;
        }
    }
    return PCCD_OK;
}

/* Check a FRAME, MOVE or NEAR. */
static int judge_asked(const void *payload, uint64_t bytes, bool is_numbered,
                       char text[RECORD_TEXT_BYTES])
{
    const uint8_t *slot = (const uint8_t *)payload + sizeof(struct record_frame);
    struct record_frame frame;

    memcpy(&frame, payload, sizeof frame);
    if ((frame.step != 0) != is_numbered || frame.mode >= PCCD_MODE_COUNT ||
        frame.what >= PCCD_NEAR_COUNT || frame.end > 1) {
        return bad(text, "a frame or question without a number, or unknown");
    }
    if (memchr(frame.tuning, '\0', sizeof frame.tuning) == NULL) {
        return bad(text, "a tuning without an end");
    }
    return judge_segments(slot, bytes - sizeof frame, frame.segment_count, frame.step,
                          text);
}

static int judge_frame(const void *payload, uint64_t bytes, char text[RECORD_TEXT_BYTES])
{
    return judge_asked(payload, bytes, true, text);
}

static int judge_move(const void *payload, uint64_t bytes, char text[RECORD_TEXT_BYTES])
{
    return judge_asked(payload, bytes, false, text);
}

static int judge_records(const void *payload, uint64_t bytes,
                         char text[RECORD_TEXT_BYTES])
{
    struct record_records head;
    uint64_t rest = bytes - sizeof head;

    memcpy(&head, payload, sizeof head);
    bool is_known = head.record_bytes == sizeof(struct pccd_contact) ||
                    head.record_bytes == sizeof(struct pccd_pair) ||
                    head.record_bytes == sizeof(double);
    return is_known && head.count == rest / head.record_bytes &&
                   head.count * head.record_bytes == rest
               ? PCCD_OK
               : bad(text, "records of another length");
}

static int judge_filter(const void *payload, uint64_t bytes, char text[RECORD_TEXT_BYTES])
{
    struct record_filter filter;
    struct common_attributes given;

    record_filter_read(payload, bytes, &filter, &given);
    if ((COMMON_OBJECT_BITS(filter.what) & ~COMMON_OBJECT_KNOWN) != 0) {
        return bad(text, "a filter of unknown kind");
    }
    return is_length(given.radius) && is_length(given.rest_distance) &&
                   given.rest_rings <= PROTO_REST_RINGS_MAX
               ? PCCD_OK
               : bad(text, "a thickness that cannot be one");
}

static int judge_scene(const void *payload, uint64_t bytes, char text[RECORD_TEXT_BYTES])
{
    struct record_scene scene;

    (void)bytes;
    memcpy(&scene, payload, sizeof scene);
    return scene.scene != 0 ? PCCD_OK : bad(text, "a scene without handle");
}

static int judge_object(const void *payload, uint64_t bytes, char text[RECORD_TEXT_BYTES])
{
    struct record_object object;

    (void)bytes;
    memcpy(&object, payload, sizeof object);
    return object.scene != 0 && object.mesh != 0 && object.object != 0
               ? PCCD_OK
               : bad(text, "an object without handle, scene or mesh");
}

static int judge_pairs(const void *payload, uint64_t bytes, char text[RECORD_TEXT_BYTES])
{
    const uint8_t *at = (const uint8_t *)payload + sizeof(struct record_pairs);
    struct record_pairs pairs;

    memcpy(&pairs, payload, sizeof pairs);
    if (bytes != sizeof pairs + pairs.count * sizeof(struct record_pair)) {
        return bad(text, "pairs of another length");
    }
    for (uint32_t i = 0; i < pairs.count; i++) {
        struct record_pair pair;

        memcpy(&pair, at + i * sizeof pair, sizeof pair);
        if (pair.a == pair.b || pair.said > RECORD_CLEARANCE) {
            return bad(text, "a pair of one object, or of which nobody knows what");
        }
        if (!is_length(pair.clearance)) {
            return bad(text, "a clearance that is none");
        }
    }
    return PCCD_OK;
}

static int judge_name(const void *payload, uint64_t bytes, char text[RECORD_TEXT_BYTES])
{
    const char *at = (const char *)payload + sizeof(struct record_name);
    struct record_name name;

    memcpy(&name, payload, sizeof name);
    return name.bytes <= PROTO_STR_MAX && bytes == sizeof name + name.bytes &&
                   memchr(at, '\0', name.bytes) == NULL
               ? PCCD_OK
               : bad(text, "a name of another length");
}

/* Forms of payloads, by kind. */
static const struct form {
    uint64_t head_bytes; /* of the struct that they begin with */
    bool is_all;         /* they end with it */
    int (*judge)(const void *payload, uint64_t bytes, char text[RECORD_TEXT_BYTES]);
} forms[RECORD_KINDS_MAX] = {
#define WHOLE(type, judge) {sizeof(struct record_##type), true, judge}
#define HEAD(type)         {sizeof(struct record_##type), false, judge_##type}
    [RECORD_BEGIN] = WHOLE(begin, NULL),
    [RECORD_SCENE] = WHOLE(scene, judge_scene),
    [RECORD_OBJECT] = WHOLE(object, judge_object),
    [RECORD_ANSWER] = WHOLE(answer, NULL),
    [RECORD_SCENE_GONE] = WHOLE(gone, NULL),
    [RECORD_MESH_GONE] = WHOLE(gone, NULL),
    [RECORD_OBJECT_GONE] = WHOLE(gone, NULL),
    [RECORD_END] = WHOLE(end, NULL),
    [RECORD_MESH] = HEAD(mesh),
    [RECORD_PLACE] = HEAD(place),
    [RECORD_FRAME] = HEAD(frame),
    [RECORD_MOVE] = {sizeof(struct record_frame), false, judge_move},
    [RECORD_GUEST] = {sizeof(struct record_mesh), false, judge_guest},
    [RECORD_RECORDS] = HEAD(records),
    [RECORD_NEAR] = HEAD(frame),
    [RECORD_PAIRS] = HEAD(pairs),
    [RECORD_NAME] = HEAD(name),
    [RECORD_FILTER] = {RECORD_FILTER_BYTES, false, judge_filter},
#undef WHOLE
#undef HEAD
};

static struct form form_of(uint16_t kind)
{
    return kind < RECORD_KINDS_MAX ? forms[kind] : (struct form){0, false, NULL};
}

/* ---- how long a payload can be ----------------------------------------------------- */

/* Return the most that lies behind the head of a MESH, GUEST, PAIRS, NAME or records. */
static uint64_t counted_bytes(uint16_t kind, const void *head)
{
    union {
        struct record_mesh mesh;
        struct record_pairs pairs;
        struct record_name name;
        struct record_records records;
    } is;

    memcpy(&is, head, form_of(kind).head_bytes);
    switch (kind) {
    case RECORD_MESH:
    case RECORD_GUEST:
        return record_shape_of(&is.mesh).end - sizeof is.mesh;
    case RECORD_PAIRS:
        return is.pairs.count * sizeof(struct record_pair);
    case RECORD_NAME:
        return is.name.bytes;
    default:
        return is.records.record_bytes > sizeof(struct pccd_contact)
                   ? 0
                   : is.records.count % RECORD_BYTES_MAX * is.records.record_bytes;
    }
}

/* Both ends of each of `count` segments. The table may have had room for more than there
 * are, and each range begins at a multiple of 8, the first of 64. */
static uint64_t moved_bytes(const uint8_t *slot, uint64_t count)
{
    uint64_t bytes = PROTO_SEGMENTS_MAX * sizeof(struct record_segment) + 64;
    uint64_t tables = 0, last = 0; /* of joints */

    for (uint64_t i = 0; i < count; i++) {
        struct record_segment segment;

        memcpy(&segment, slot + i * sizeof segment, sizeof segment);
        uint64_t each = positions_bytes(&segment);
        bytes += padded(each) * (segment.kind == RECORD_X1 ? 1 : 2);
        tables += segment.kind == RECORD_ON_JOINT && segment.offset0 != last;
        last = segment.kind == RECORD_ON_JOINT ? segment.offset0 : last;
    }
    return bytes + tables * (sizeof(struct record_joints) +
                             PROTO_JOINTS_MAX * sizeof(struct pccd_joint));
}

uint64_t record_payload_most(uint16_t kind, const void *begin, uint64_t have,
                             uint64_t *wants)
{
    const struct form form = form_of(kind);
    const uint64_t head = form.head_bytes;
    struct record_frame frame;
    uint64_t count;

    *wants = have;
    if (form.is_all) {
        return head;
    }
    if (kind == RECORD_FILTER) { /* a later release may have a word for each bit */
        return offsetof(struct record_filter, words) + 32 * sizeof(uint64_t);
    }
    if (kind == RECORD_PLACE) { /* the mesh says how many vertices it has */
        return UINT64_MAX;
    }
    if (have < head) {
        *wants = head;
        return UINT64_MAX;
    }
    if (kind != RECORD_FRAME && kind != RECORD_MOVE && kind != RECORD_NEAR) {
        return head + counted_bytes(kind, begin);
    }
    memcpy(&frame, begin, sizeof frame);
    count = frame.segment_count;
    if (count > PROTO_SEGMENTS_MAX) {
        return 0;
    }
    if (have < head + count * sizeof(struct record_segment)) {
        *wants = head + count * sizeof(struct record_segment);
        return UINT64_MAX;
    }
    return head + moved_bytes((const uint8_t *)begin + head, count);
}

int record_payload_judge(uint16_t kind, const void *payload, uint64_t bytes,
                         char text[RECORD_TEXT_BYTES])
{
    const struct form form = form_of(kind);

    if (bytes < form.head_bytes || (form.is_all && bytes > form.head_bytes)) {
        return bad(text, bytes < form.head_bytes ? "too short for its kind"
                                                 : "too long for its kind");
    }
    return form.judge != NULL ? form.judge(payload, bytes, text) : PCCD_OK;
}
