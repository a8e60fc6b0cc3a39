/* target_slot.c - any bytes in the memory that client and server share. */
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "fuzz_target.h"
#include "host.h"
#include "raw.h"

#define VERTICES     9u
#define TRIANGLES    8u
#define SLOT_BYTES   16384u
#define SEGMENTS_MAX 8u
#define INPUTS_MAX   512 /* of one session */

static struct test_raw raw;
static uint32_t scene;
static uint32_t mesh;    /* committed */
static uint32_t growing; /* announced, and filled by inputs */
static uint32_t objects[2];
static uint64_t released; /* of the result region */

/* Check what a session begins with, which must succeed. */
static void need(int status)
{
    if (status != 0) {
        fprintf(stderr, "%s: %s\n", proto_status_name(status), raw.error.text);
    }
    FUZZ_CHECK(status == 0);
}

static void open_session(void)
{
    static const uint32_t triangles[TRIANGLES][3] = {{0, 1, 3}, {1, 4, 3}, {1, 2, 4},
                                                     {2, 5, 4}, {3, 4, 6}, {4, 7, 6},
                                                     {4, 5, 7}, {5, 8, 7}};
    const struct proto_SCENE_CREATE_request create = {0};
    const struct proto_MESH_CREATE_request announce = {.vertex_count = 200,
                                                       .triangle_count = 300};
    struct proto_SCENE_CREATE_result created;
    struct proto_MESH_CREATE_result announced;
    struct proto_SCENE_ADD_request add = {0};
    struct proto_SCENE_ADD_result added;
    float x[VERTICES][3];
    for (uint32_t i = 0; i < VERTICES; i++) {
        x[i][0] = (float)(i % 3);
        x[i][1] = (float)(i / 3);
        x[i][2] = (float)(i * i % 4) / 8;
    }
    FUZZ_CHECK(test_raw_open(&raw, fuzz_host_socket()));
    need(test_raw_hello(&raw));
    need(test_raw_attach(&raw, 2, SLOT_BYTES));
    need(
        test_raw_mesh(&raw, (const float(*)[3])x, VERTICES, triangles, TRIANGLES, &mesh));
    need(test_raw_call(&raw, PROTO_METHOD_SCENE_CREATE, &create, &created));
    need(test_raw_call(&raw, PROTO_METHOD_MESH_CREATE, &announce, &announced));
    scene = created.scene;
    growing = announced.mesh;
    released = 0;
    add.scene = scene;
    add.mesh = mesh;
    for (int i = 0; i < 2; i++) {
        need(test_raw_call(&raw, PROTO_METHOD_SCENE_ADD, &add, &added));
        objects[i] = added.object;
    }
}

/* A session, made anew now and then, and after its connection was lost. */
static void need_session(void)
{
    static int inputs;
    static bool is_open;
    fuzz_host_start();
    if (is_open && ++inputs < INPUTS_MAX && raw.socket >= 0) {
        return;
    }
    fuzz_scarcity_pause();
    if (is_open) {
        test_raw_close(&raw);
        if (inputs >= INPUTS_MAX) {
            fuzz_host_check();
        }
    }
    open_session();
    inputs = 0;
    is_open = true;
    fuzz_scarcity_resume();
}

static bool is_explained(int status)
{
    switch (status) {
    case 0:
    case PCCD_E_SEGMENT:
    case PCCD_E_HANDLE:
    case PCCD_E_NOTFINITE:
    case PCCD_E_INDEX:
    case PCCD_E_INVAL:
    case PCCD_E_STATE:
    case PCCD_E_SLOT_STALE:
    case PCCD_E_LIMIT:
        return true;
    default:
        if (fuzz_scarcity_hits() > 0 &&
            (status == PCCD_E_NOMEM || status == PCCD_E_DISCONNECTED)) {
            return true;
        }
        fprintf(stderr, "%s: %s\n", proto_status_name(status), raw.error.text);
        return false;
    }
}

static uint64_t take_offset(struct fuzz_input *input, uint64_t table_bytes)
{
    uint8_t choice = fuzz_take_u8(input);
    switch (choice % 4) {
    case 0:
        return 0;
    case 1:
        return table_bytes + choice / 4 * 8u;
    case 2:
        return fuzz_take_u16(input);
    default:
        return fuzz_take_u64(input);
    }
}

static void take_segment(struct fuzz_input *input, uint64_t table_bytes,
                         struct proto_segment *segment)
{
    uint8_t choice = fuzz_take_u8(input);
    segment->object = choice % 4 < 2 ? objects[choice % 2] : fuzz_take_u32(input);
    segment->kind = choice < 240 ? choice / 4 % 3 : fuzz_take_u16(input);
    segment->format = choice < 240 ? choice / 16 % 2 : fuzz_take_u16(input);
    uint8_t range = fuzz_take_u8(input);
    segment->first = range < 192 ? 0 : range < 224 ? range % 8u : fuzz_take_u32(input);
    segment->count = range < 128   ? VERTICES
                     : range < 224 ? range % 16u
                                   : fuzz_take_u32(input);
    segment->offset0 = take_offset(input, table_bytes);
    segment->offset1 = take_offset(input, table_bytes);
    if (choice >= 224 && choice < 240) { /* all hangs on a joint */
        segment->kind = PROTO_SEGMENT_TURNING;
        segment->format = choice % 16 < 14 ? PCCD_FORMAT_F64 : PCCD_FORMAT_F32;
        segment->count = range < 240 ? VERTICES : segment->count;
    }
}

/* A sequence number for the slot; seldom another one than it holds. */
static uint64_t publish(struct fuzz_input *input, uint32_t slot)
{
    uint8_t choice = fuzz_take_u8(input);
    uint64_t seq = test_raw_publish(&raw, slot);
    return choice < 248 ? seq : fuzz_take_u64(input);
}

/* Any of the words before the slots, and where the results are released. */
static void disturb_header(struct fuzz_input *input, uint8_t choices)
{
    uint64_t head = released;
    if (choices % 4 == 1) {
        size_t at = fuzz_take_u16(input) % offsetof(struct proto_upload, slots);
        uint8_t bytes[32];
        size_t count = fuzz_take_bytes(input, bytes, sizeof bytes);
        memcpy((uint8_t *)raw.upload.base + at, bytes, count);
    }
    if (choices / 4 % 8 == 7) {
        head = fuzz_take_u64(input);
    }
    atomic_store(&test_raw_upload(&raw)->result_head.value, head);
}

static void submit(struct fuzz_input *input, uint8_t choices)
{
    uint32_t count = fuzz_take_u8(input);
    struct proto_segment table[SEGMENTS_MAX] = {{0}};
    struct proto_FRAME_SUBMIT_request request = {.scene = scene,
                                                 .slot = choices / 32 % 2};
    struct proto_FRAME_SUBMIT_result answer;
    uint8_t *payload = test_raw_payload(&raw, request.slot);
    request.segments = count < 240 ? count % (SEGMENTS_MAX + 1) : fuzz_take_u32(input);
    uint32_t written = request.segments < SEGMENTS_MAX ? request.segments : SEGMENTS_MAX;
    for (uint32_t i = 0; i < written; i++) {
        take_segment(input, request.segments * sizeof table[0], &table[i]);
    }
    memcpy(payload, table, written * sizeof table[0]);
    size_t at = written * sizeof table[0];
    at += fuzz_take_bytes(input, payload + at, SLOT_BYTES - at);
    memset(payload + at, 0, SLOT_BYTES - at);
    request.mode = fuzz_take_u8(input) % PCCD_MODE_COUNT;
    request.method = fuzz_take_u8(input) % PCCD_METHOD_COUNT;
    request.deadline_ns = 50000000; /* what turns may take long to decide */
    request.seq = publish(input, request.slot);
    int status = test_raw_call(&raw, PROTO_METHOD_FRAME_SUBMIT, &request, &answer);
    FUZZ_CHECK(is_explained(status));
    if (status == 0) {
        FUZZ_CHECK(answer.first == 0 && answer.count <= answer.total);
        FUZZ_CHECK(answer.count == 0 ||
                   (answer.offset >= PROTO_SHM_PAGE &&
                    answer.offset + answer.count * answer.record_bytes <=
                        raw.ring.result_bytes));
        FUZZ_CHECK(answer.release >= released);
        released = answer.release;
    }
    if (status == PCCD_E_DISCONNECTED) {
        close(raw.socket);
        raw.socket = -1;
    }
}

static void send_chunk(struct fuzz_input *input, uint8_t choices)
{
    struct proto_MESH_DATA_request request = {.mesh = growing,
                                              .slot = choices / 32 % 2,
                                              .part = choices / 64 % 2,
                                              .format = choices / 128 % 2};
    uint8_t *payload = test_raw_payload(&raw, request.slot);
    request.first = fuzz_take_u8(input);
    request.count = fuzz_take_u8(input);
    if (request.count == 255) {
        request.first = fuzz_take_u32(input);
        request.count = fuzz_take_u32(input);
    }
    request.seq = publish(input, request.slot);
    size_t at = fuzz_take_bytes(input, payload, SLOT_BYTES);
    memset(payload + at, 0, SLOT_BYTES - at);
    int status = test_raw_call(&raw, PROTO_METHOD_MESH_DATA, &request, NULL);
    FUZZ_CHECK(is_explained(status));
    if (status == PCCD_E_DISCONNECTED) {
        close(raw.socket);
        raw.socket = -1;
    }
}

void fuzz_slot(const uint8_t *data, size_t bytes)
{
    struct fuzz_input input = {data, bytes};
    need_session();
    uint8_t choices = fuzz_take_u8(&input);
    disturb_header(&input, choices);
    if (choices % 4 == 3) {
        send_chunk(&input, choices);
    } else {
        submit(&input, choices);
    }
    fuzz_scarcity_pause();
}
