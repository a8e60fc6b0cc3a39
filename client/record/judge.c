/* judge.c - whether a payload is what its kind says.
 *
 * Room:     client/record. May include: chunk.h.
 * Does:     lengths, counts, indices and ranges, on a private copy.
 * Does not: know what other chunks have said: handles are the reader's affair.
 * Threads:  [any].
 */
#include <assert.h>
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "chunk.h"

#include "coordinates.h"
#include "proto_limits.h"

/* The layout of the file, whatever the compiler. */
static_assert(sizeof(struct record_chunk) == 48, "chunk");
static_assert(sizeof(struct record_begin) == 56, "begin");
static_assert(sizeof(struct record_mesh) == 16, "mesh");
static_assert(sizeof(struct record_scene) == 24, "scene");
static_assert(sizeof(struct record_object) == 16, "object");
static_assert(sizeof(struct record_place) == 16, "place");
static_assert(sizeof(struct record_frame) == 56, "frame");
static_assert(sizeof(struct record_tuning) == 64, "tuning");
static_assert(sizeof(struct record_separation) == 16, "separation");
static_assert(sizeof(struct record_radii) == 8, "radii");
static_assert(sizeof(struct record_free) == 16, "edges and points");
static_assert(sizeof(struct record_segment) == 32, "segment");
static_assert(sizeof(struct record_answer) == 280, "answer");
static_assert(sizeof(struct record_records) == 32, "records");
static_assert(sizeof(struct record_near) == 64, "near");
static_assert(sizeof(struct record_near_answer) == 328, "near answer");
static_assert(sizeof(struct record_near_records) == 32, "near records");
static_assert(sizeof(struct record_filter) == 16 + 8 * COMMON_WORDS, "filter");
static_assert(RECORD_FILTER_BYTES == 32, "filter of before");
static_assert(sizeof(struct record_pairs) == 16, "pairs");
static_assert(sizeof(struct record_guest) == 16, "guest");

#define COUNT_MAX   2147483647u
#define RIGID_BYTES (12 * sizeof(double))

static int bad(char text[RECORD_TEXT_BYTES], const char *why)
{
    (void)snprintf(text, RECORD_TEXT_BYTES, "%s", why);
    return PCCD_E_FORMAT;
}

static uint64_t padded(uint64_t bytes)
{
    return (bytes + 7) / 8 * 8;
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

static int judge_guest(const void *payload, uint64_t bytes, char text[RECORD_TEXT_BYTES])
{
    struct record_guest guest;
    uint64_t x_bytes;

    memcpy(&guest, payload, sizeof guest);
    x_bytes = guest.vertex_count * sizeof(double[3]);
    if (guest.object == 0 || guest.vertex_count == 0 || guest.vertex_count > COUNT_MAX ||
        guest.triangle_count > COUNT_MAX ||
        bytes != sizeof guest + x_bytes + guest.triangle_count * sizeof(uint32_t[3])) {
        return bad(text, "an object of another length, or without handle or shape");
    }
    return judge_triangles((const uint8_t *)payload + sizeof guest + x_bytes,
                           guest.triangle_count, guest.vertex_count, text);
}

static int judge_mesh(const void *payload, uint64_t bytes, char text[RECORD_TEXT_BYTES])
{
    struct record_mesh mesh;
    uint64_t x_bytes;

    memcpy(&mesh, payload, sizeof mesh);
    if (mesh.mesh == 0 || mesh.format >= PCCD_FORMAT_COUNT || mesh.vertex_count == 0 ||
        mesh.vertex_count > COUNT_MAX || mesh.triangle_count > COUNT_MAX) {
        return bad(text, "a mesh without handle or vertices");
    }
    x_bytes = padded(mesh.vertex_count * common_vertex_bytes(mesh.format));
    if (bytes != sizeof mesh + x_bytes + mesh.triangle_count * sizeof(uint32_t[3])) {
        return bad(text, "a mesh of another length");
    }
    return judge_triangles((const uint8_t *)payload + sizeof mesh + x_bytes,
                           mesh.triangle_count, mesh.vertex_count, text);
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

/* The payload of a slot, `all` bytes, with a table of `count` segments. `step` is of whom
 * it moves. */
static int judge_segments(const uint8_t *slot, uint64_t all, uint32_t count,
                          uint64_t step, char text[RECORD_TEXT_BYTES])
{
    if (count > all / sizeof(struct record_segment)) {
        return bad(text, "a movement with less than its segments");
    }
    for (uint32_t i = 0; i < count; i++) {
        struct record_segment segment;
        uint64_t each;

        memcpy(&segment, slot + i * sizeof segment, sizeof segment);
        each = segment.kind == RECORD_RIGID
                   ? RIGID_BYTES
                   : segment.count * common_vertex_bytes(segment.format);
        if (segment.kind > RECORD_RIGID || segment.format >= PCCD_FORMAT_COUNT ||
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

/* Of a FRAME, or of a MOVE, which has no number. */
static int judge_frame(const void *payload, uint64_t bytes, bool is_numbered,
                       char text[RECORD_TEXT_BYTES])
{
    const uint8_t *slot = (const uint8_t *)payload + sizeof(struct record_frame);
    struct record_frame frame;

    memcpy(&frame, payload, sizeof frame);
    if ((frame.step != 0) != is_numbered || frame.mode >= PCCD_MODE_COUNT) {
        return bad(text, "a frame without a number, or of unknown mode");
    }
    return judge_segments(slot, bytes - sizeof frame, frame.segment_count, frame.step,
                          text);
}

static int judge_near(const void *payload, uint64_t bytes, char text[RECORD_TEXT_BYTES])
{
    const uint8_t *slot = (const uint8_t *)payload + sizeof(struct record_near);
    struct record_near near;

    memcpy(&near, payload, sizeof near);
    if (near.step == 0 || near.what >= PCCD_NEAR_COUNT || near.end > 1) {
        return bad(text, "a question about what is near without a number, or unknown");
    }
    return judge_segments(slot, bytes - sizeof near, near.segment_count, near.step, text);
}

static int judge_near_records(const void *payload, uint64_t bytes,
                              char text[RECORD_TEXT_BYTES])
{
    struct record_near_records records;
    uint64_t rest = bytes - sizeof records;

    memcpy(&records, payload, sizeof records);
    if ((records.record_bytes != sizeof(struct pccd_near) &&
         records.record_bytes != sizeof(double)) ||
        records.count != rest / records.record_bytes ||
        records.count * records.record_bytes != rest) {
        return bad(text, "records of what is near of another length");
    }
    return PCCD_OK;
}

static int judge_records(const void *payload, uint64_t bytes,
                         char text[RECORD_TEXT_BYTES])
{
    struct record_records records;
    uint64_t rest = bytes - sizeof records;

    memcpy(&records, payload, sizeof records);
    if ((records.record_bytes != sizeof(struct pccd_contact) &&
         records.record_bytes != sizeof(struct pccd_pair)) ||
        records.count != rest / records.record_bytes ||
        records.count * records.record_bytes != rest) {
        return bad(text, "records of another length");
    }
    return PCCD_OK;
}

static int judge_filter(const void *payload, char text[RECORD_TEXT_BYTES])
{
    struct record_filter filter;

    memcpy(&filter, payload, RECORD_FILTER_BYTES);
    return (COMMON_OBJECT_BITS(filter.what) & ~COMMON_OBJECT_KNOWN) == 0 &&
                   filter.self <= 1
               ? PCCD_OK
               : bad(text, "a filter of unknown kind");
}

static int judge_radii(const void *payload, uint64_t bytes, char text[RECORD_TEXT_BYTES])
{
    const uint8_t *at = (const uint8_t *)payload + sizeof(struct record_radii);
    struct record_radii radii;

    memcpy(&radii, payload, sizeof radii);
    if (bytes != sizeof radii + radii.vertex_count * sizeof(double)) {
        return bad(text, "radii of another length");
    }
    for (uint32_t i = 0; i < radii.vertex_count; i++) {
        double radius;

        memcpy(&radius, at + i * sizeof radius, sizeof radius);
        if (!(radius >= 0.0 && radius <= PROTO_COORDINATE_MAX)) {
            return bad(text, "a radius that cannot be one");
        }
    }
    return PCCD_OK;
}

static int judge_free(const void *payload, uint64_t bytes, char text[RECORD_TEXT_BYTES])
{
    const uint8_t *at = (const uint8_t *)payload + sizeof(struct record_free);
    struct record_free free;
    uint64_t words;

    memcpy(&free, payload, sizeof free);
    words = 2 * (uint64_t)free.edge_count + free.point_count;
    if (bytes != sizeof free + words * sizeof(uint32_t)) {
        return bad(text, "edges and points of another length");
    }
    for (uint64_t i = 0; i < words; i++) {
        uint32_t vertex;

        memcpy(&vertex, at + i * sizeof vertex, sizeof vertex);
        if (vertex >= free.vertex_count) {
            return bad(text, "an edge or a point of a vertex that there is not");
        }
    }
    return PCCD_OK;
}

static int judge_pairs(const void *payload, uint64_t bytes, char text[RECORD_TEXT_BYTES])
{
    const uint8_t *at = (const uint8_t *)payload + sizeof(struct record_pairs);
    struct record_pairs pairs;

    memcpy(&pairs, payload, sizeof pairs);
    if (pairs.ignored > 1 ||
        bytes != sizeof pairs + (uint64_t)pairs.count * sizeof(uint32_t[2])) {
        return bad(text, "pairs of another length");
    }
    for (uint32_t i = 0; i < pairs.count; i++) {
        uint32_t pair[2];

        memcpy(pair, at + i * sizeof pair, sizeof pair);
        if (pair[0] == pair[1]) {
            return bad(text, "a pair of one object");
        }
    }
    return PCCD_OK;
}

/* Of the struct that a payload begins with; 0: any. */
static uint64_t least_bytes(uint16_t kind)
{
    switch (kind) {
    case RECORD_BEGIN:
        return sizeof(struct record_begin);
    case RECORD_MESH:
        return sizeof(struct record_mesh);
    case RECORD_SCENE:
        return sizeof(struct record_scene);
    case RECORD_OBJECT:
        return sizeof(struct record_object);
    case RECORD_PLACE:
        return sizeof(struct record_place);
    case RECORD_LOG:
        return sizeof(struct record_log);
    case RECORD_FRAME:
    case RECORD_MOVE:
        return sizeof(struct record_frame);
    case RECORD_TUNING:
        return sizeof(struct record_tuning);
    case RECORD_SEPARATION:
        return sizeof(struct record_separation);
    case RECORD_RADII:
        return sizeof(struct record_radii);
    case RECORD_FREE:
        return sizeof(struct record_free);
    case RECORD_GUEST:
        return sizeof(struct record_guest);
    case RECORD_ANSWER:
        return sizeof(struct record_answer);
    case RECORD_RECORDS:
        return sizeof(struct record_records);
    case RECORD_NEAR:
        return sizeof(struct record_near);
    case RECORD_NEAR_ANSWER:
        return sizeof(struct record_near_answer);
    case RECORD_NEAR_RECORDS:
        return sizeof(struct record_near_records);
    case RECORD_CANCEL:
        return sizeof(struct record_cancel);
    case RECORD_SCENE_GONE:
    case RECORD_MESH_GONE:
    case RECORD_OBJECT_GONE:
        return sizeof(struct record_gone);
    case RECORD_END:
        return sizeof(struct record_end);
    case RECORD_FILTER:
        return RECORD_FILTER_BYTES;
    case RECORD_PAIRS:
        return sizeof(struct record_pairs);
    default:
        return 0;
    }
}

int record_payload_judge(uint16_t kind, const void *payload, uint64_t bytes,
                         char text[RECORD_TEXT_BYTES])
{
    if (bytes < least_bytes(kind)) {
        return bad(text, "too short for its kind");
    }
    switch (kind) {
    case RECORD_MESH:
        return judge_mesh(payload, bytes, text);
    case RECORD_PLACE:
        return judge_place(payload, bytes, text);
    case RECORD_FRAME:
    case RECORD_MOVE:
        return judge_frame(payload, bytes, kind == RECORD_FRAME, text);
    case RECORD_GUEST:
        return judge_guest(payload, bytes, text);
    case RECORD_RECORDS:
        return judge_records(payload, bytes, text);
    case RECORD_NEAR:
        return judge_near(payload, bytes, text);
    case RECORD_NEAR_RECORDS:
        return judge_near_records(payload, bytes, text);
    case RECORD_FILTER:
        return judge_filter(payload, text);
    case RECORD_PAIRS:
        return judge_pairs(payload, bytes, text);
    case RECORD_RADII:
        return judge_radii(payload, bytes, text);
    case RECORD_FREE:
        return judge_free(payload, bytes, text);
    case RECORD_TUNING:
        return memchr(payload, '\0', sizeof(struct record_tuning)) != NULL
                   ? PCCD_OK
                   : bad(text, "a tuning without an end");
    default:
        return PCCD_OK;
    }
}
