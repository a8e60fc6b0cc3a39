/* seeds.c - inputs for fuzzers to begin with, of the targets whose inputs follow the
 * manifest or the format of recordings; those of the others stand in the corpus alone. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "codec.h"
#include "format.h"
#include "messages.h"
#include "payload.h"
#include "shm.h"

static const char *root;
static uint8_t seed[65536];
static size_t length;

static void begin(void)
{
    length = 0;
    seed[length++] = 0; /* no allocation fails */
}

static void put(const void *bytes, size_t count)
{
    if (count <= sizeof seed - length) {
        memcpy(seed + length, bytes, count);
        length += count;
    }
}

static void put_u8(unsigned value)
{
    put(&(uint8_t){(uint8_t)value}, 1);
}

static void put_u16(unsigned value)
{
    put(&(uint16_t){(uint16_t)value}, 2);
}

static void save(const char *target, const char *name)
{
    char path[4096];
    snprintf(path, sizeof path, "%s/%s", root, target);
    mkdir(path, 0777);
    snprintf(path, sizeof path, "%s/%s/%s", root, target, name);
    FILE *file = fopen(path, "wb");
    if (file == NULL || fwrite(seed, 1, length, file) != length || fclose(file) != 0) {
        perror(path);
        exit(1);
    }
}

/* ---- decoder ----------------------------------------------------------------------- */

/* Every field as large as it can be. */
static void fill(const struct proto_fields *fields, char *body)
{
    memset(body, 0, fields->struct_bytes);
    for (uint32_t i = 0; i < fields->count; i++) {
        char *member = body + fields->items[i].offset;
        switch (fields->items[i].type) {
        case PROTO_TYPE_u32:
            memset(member, 0xff, sizeof(uint32_t));
            break;
        case PROTO_TYPE_u64:
            memset(member, 0xff, sizeof(uint64_t));
            break;
        case PROTO_TYPE_f64:
            memcpy(member, &(double){-0.1}, sizeof(double));
            break;
        case PROTO_TYPE_bool:
            memcpy(member, &(bool){true}, sizeof(bool));
            break;
        case PROTO_TYPE_str:
            strcpy(member, "\xc3\xa9");
            break;
        }
    }
}

static void save_message(const struct proto_encoder *encoder, int method,
                         const char *name)
{
    begin();
    put_u8((unsigned)method);
    put(encoder->data, encoder->bytes);
    save("decoder", name);
}

static void make_decoder_seeds(void)
{
    static struct proto_encoder encoder;
    static _Alignas(8) char body[8192];
    char name[128];
    for (int method = 0; method < PROTO_MESSAGE_COUNT; method++) {
        const struct proto_message_info *info = &proto_messages[method];
        fill(&info->request, body);
        if (method < PROTO_METHOD_COUNT) {
            proto_encode_request(&encoder, 1, method, body);
        } else {
            proto_encode_notification(&encoder, method, body);
        }
        snprintf(name, sizeof name, "%s.request", info->name);
        save_message(&encoder, method, name);
        if (method < PROTO_METHOD_COUNT) {
            fill(&info->result, body);
            proto_encode_result(&encoder, 1, method, body);
            snprintf(name, sizeof name, "%s.result", info->name);
            save_message(&encoder, method, name);
        }
    }
    const struct proto_error error = {PCCD_E_QUOTA, true, "no"};
    proto_encode_error(&encoder, UINT32_MAX, &error);
    save_message(&encoder, 0, "error");
}

/* ---- dispatch ---------------------------------------------------------------------- */

/* Choices of peer.c for a field: a small number, or one of these. */
enum {
    HANDLE = 5,
    HANDLE_2 = 6,
    HANDLE_AGAIN = 7, /* the same place, used for the second time */
    PUBLISH_0 = 8,
    PUBLISH_1 = 9,
    BYTE = 10,
    WORD = 14,
    TEXT = 15
};

static void ask(int method, const uint8_t *choices, size_t count)
{
    put_u8(1);
    put_u8((unsigned)method);
    put(choices, count);
    /* Fields that are not chosen: 0. */
    for (size_t i = count; i < proto_messages[method].request.count; i++) {
        put_u8(0);
    }
}

#define ASK(method, ...)                                                                 \
    ask(PROTO_METHOD_##method, (const uint8_t[]){__VA_ARGS__},                           \
        sizeof((const uint8_t[]){__VA_ARGS__}))

static void settle(void)
{
    put_u8(7);
}

static void write_ring(unsigned at, const void *bytes, size_t count)
{
    put_u8(4);
    put_u16(at);
    put_u8((unsigned)count);
    put(bytes, count);
}

/* hello, a ring of two slots, a scene, a mesh of a triangle with a fourth vertex. Of a
 * scene that is shared: a name of so many letters; else 0. */
static void enter_scene(uint8_t letters)
{
    static const float x[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    static const uint32_t triangles[2][3] = {{0, 1, 2}, {1, 2, 3}};
    ASK(HELLO, 1, 1, 3);
    ASK(SHM_ATTACH, 2, WORD, WORD);
    settle();
    ASK(SCENE_CREATE, 0, 0, 0, 0, letters, letters > 0);
    ASK(MESH_CREATE, 4, 2);
    write_ring(0x1000, x, sizeof x);
    ASK(MESH_DATA, HANDLE, 0, PUBLISH_0, 0, 0, 0, 4);
    settle();
    write_ring(0x1000, triangles, sizeof triangles);
    ASK(MESH_DATA, HANDLE, 0, PUBLISH_0, 1, 0, 0, 2);
    settle();
    ASK(MESH_COMMIT, HANDLE);
    ASK(SCENE_ADD, HANDLE, HANDLE);
    settle();
}

static void enter(void)
{
    enter_scene(0);
}

static void switch_peers(void)
{
    put_u8(134);
}

/* Slot 0 moves that object to where it is. */
static void write_step(uint32_t object)
{
    const struct proto_segment segment = {
        .object = object, .kind = PROTO_SEGMENT_X1, .count = 4, .offset1 = 32};
    static const float x[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    write_ring(0x1000, &segment, sizeof segment);
    write_ring(0x1020, x, sizeof x);
}

/* Two clients in a scene; the second holds a frame with that deadline, in nanoseconds. */
static void share_and_hold(uint8_t deadline)
{
    begin();
    enter_scene(1);
    switch_peers();
    enter_scene(1);
    write_step((1u << 20) + 1);
    ASK(FRAME_SUBMIT, HANDLE, 0, PUBLISH_0, 1, 0, 0, 0, 0, deadline, 0, 0, 0, 0, 1);
    settle();
}

/* Two scenes, of which one moves an object and the other is not known. */
static void make_batch_seeds(void)
{
    const struct proto_batch_scene scenes[2] = {{1u << 20, 1}, {2u << 20, 0}};
    const struct proto_segment segment = {
        .object = 1u << 20, .kind = PROTO_SEGMENT_X1, .count = 4, .offset1 = 64};
    static const float x[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    begin();
    enter();
    write_ring(0x1000, scenes, sizeof scenes);
    write_ring(0x1000 + sizeof scenes, &segment, sizeof segment);
    write_ring(0x1040, x, sizeof x);
    ASK(BATCH_SUBMIT, 0, PUBLISH_0, 2, 1);
    settle();
    ASK(BATCH_SUBMIT, 0, PUBLISH_0, 2, 1, 0, 0, 0, 0, 1);
    ASK(CANCEL, BYTE, 10);
    ASK(SCENE_DESTROY, HANDLE);
    settle();
    save("dispatch", "batch.submit");
}

static void make_share_seeds(void)
{
    share_and_hold(0);
    switch_peers();
    ASK(FRAME_SUBMIT, HANDLE, 0, 0, 0);
    settle();
    switch_peers();
    ASK(FRAME_FETCH, HANDLE, 0, 0, 1);
    settle();
    save("dispatch", "share.step");
    share_and_hold(0);
    ASK(SCENE_DESTROY, HANDLE); /* and back in one breath */
    ASK(SCENE_CREATE, 0, 0, 0, HANDLE_AGAIN, 1, 2);
    ASK(SCENE_ADD, HANDLE_AGAIN, HANDLE);
    settle();
    save("dispatch", "share.return");
    share_and_hold(1);
    switch_peers();
    ASK(OBJECT_SET, HANDLE, HANDLE_2, 4, 0, 0, 0);
    ASK(SCENE_IGNORE, HANDLE, HANDLE, HANDLE_2, 1);
    ASK(FRAME_SUBMIT, HANDLE, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1);
    switch_peers();
    ASK(MESH_REPLACE, HANDLE, 4, 2);
    ASK(SCENE_REMOVE, HANDLE, HANDLE_2);
    settle();
    save("dispatch", "share.place");
    share_and_hold(0);
    ASK(CANCEL, BYTE, 10); /* a number near that of the frame */
    put_u8(6);             /* come back */
    switch_peers();
    ASK(WATCH_START, 0, 0);
    ASK(FRAME_SUBMIT, HANDLE, 0, 0, 0);
    ASK(LIST_OBJECT, 0, HANDLE, 0);
    ASK(CONFIG_SET, TEXT, 1, TEXT, 5);
    ASK(WATCH_STOP, 0);
    settle();
    ASK(BYE, 0);
    save("dispatch", "share.watch");
}

/* Make inputs about what is near: everything that can be asked, with and without a
 * movement; in a scene that is shared, too, beside a held frame and a journal. */
static void make_near_seeds(void)
{
    begin();
    enter();
    for (uint8_t what = 0; what < PCCD_NEAR_COUNT; what++) {
        ASK(SCENE_NEAR, HANDLE, 0, 0, 0, what, 1, 1);
    }
    settle();
    ASK(NEAR_FETCH, HANDLE, 0, 0);
    write_step(1u << 20);
    ASK(SCENE_NEAR, HANDLE, 0, PUBLISH_0, 1, PCCD_NEAR_PAIRS, 0, 2);
    ASK(FRAME_FETCH, HANDLE, 0, 0);
    ASK(FRAME_SUBMIT, HANDLE, 0, 0, 0);
    ASK(NEAR_FETCH, HANDLE, 0, 1);
    settle();
    save("dispatch", "near");
    share_and_hold(0);
    switch_peers();
    ASK(SCENE_JOURNAL, HANDLE, 0, WORD, 0);
    write_step(1u << 20);
    ASK(SCENE_NEAR, HANDLE, 0, PUBLISH_0, 1, PCCD_NEAR_NEAREST, 1, 4, 1, HANDLE, HANDLE_2,
        0, 0, 1, 3);
    ASK(SCENE_JOURNAL, HANDLE, 0, 0, 0);
    switch_peers();
    ASK(SCENE_NEAR, HANDLE, 0, 0, 0, PCCD_NEAR_VERTICES, 1, 4, 0, HANDLE_2);
    ASK(NEAR_FETCH, HANDLE, 0, 0);
    settle();
    save("dispatch", "share.near");
}

static void make_watch_seed(void)
{
    begin();
    ASK(HELLO, 1, 1, 0, 1);
    ASK(SHM_ATTACH, 1, WORD, WORD);
    settle();
    ASK(TRACE_START, BYTE, 64, 0);
    ASK(STATS, 0);
    settle();
    ASK(TRACE_STOP, 0);
    ASK(TRACE_DUMP, 0, 4);
    ASK(STATS_THREAD, 0, 1);
    ASK(CANCEL, 1);
    save("dispatch", "watch");
}

/* A scene without objects, asked for all that it has; then one without a step. */
static void make_empty_seed(void)
{
    begin();
    ASK(HELLO, 1, 1, 0, 1);
    ASK(SHM_ATTACH, 2, WORD, WORD);
    settle();
    ASK(SCENE_CREATE, 0);
    ASK(SCENE_BOXES, HANDLE, 0, 0, 0, 9);
    ASK(LIST_PAIR, 0, HANDLE, 0);
    ASK(LIST_OBJECT, 0, HANDLE, 0);
    ASK(SCENE_IGNORE, HANDLE, HANDLE, HANDLE, 1);
    ASK(FRAME_FETCH, HANDLE, 0, 0);
    ASK(FRAME_SUBMIT, HANDLE, 0, 0, 0);
    settle();
    ASK(SCENE_BOXES, HANDLE, 3, 0, 0, 9);
    ASK(FRAME_FETCH, HANDLE, 0, 0);
    save("dispatch", "empty");
}

static void make_dispatch_seeds(void)
{
    static const uint8_t nonsense[] = {0x94, 0x00, 0x01, 0xa4, 'n', 'o', 'n', 'e', 0x80};
    begin();
    enter();
    ASK(FRAME_SUBMIT, HANDLE, 0, 0, 0);
    settle();
    ASK(FRAME_FETCH, HANDLE, 0, 0);
    ASK(SCENE_BOXES, HANDLE, 2, 1, 0, 9);
    ASK(MESH_EDGES, HANDLE, 0, BYTE, 9);
    settle();
    save("dispatch", "step");
    begin();
    ASK(HELLO, 1, 1, 0, 1);
    settle();
    ASK(SCENE_CREATE, 0);
    put_u8(6); /* come back */
    ASK(SCENE_CREATE, 0);
    settle();
    ASK(BYE, 0);
    save("dispatch", "resume");
    begin();
    enter();
    ASK(MESH_REPLACE, HANDLE, 4, 2);
    ASK(MESH_COMMIT, HANDLE);
    ASK(MESH_REPLACE, HANDLE, 0, 0);
    ASK(SCENE_REMOVE, HANDLE, HANDLE);
    ASK(SCENE_DESTROY, HANDLE);
    ASK(MESH_DESTROY, HANDLE);
    save("dispatch", "replace");
    begin();
    enter();
    ASK(SCENE_ADD, HANDLE, HANDLE);
    settle();
    ASK(OBJECT_SET, HANDLE, HANDLE, 4, 1, 1, 1);
    ASK(FRAME_SUBMIT, HANDLE, 0, 0, 0);
    ASK(SCENE_IGNORE, HANDLE, HANDLE, HANDLE_2, 1);
    ASK(LIST_PAIR, 0, HANDLE, 0);
    ASK(OBJECT_SET, HANDLE, HANDLE_2, 3, UINT8_MAX, 2, 0);
    ASK(FRAME_SUBMIT, HANDLE, 0, 0, 0);
    ASK(SCENE_IGNORE, HANDLE, HANDLE_2, HANDLE, 0);
    ASK(SCENE_REMOVE, HANDLE, HANDLE);
    settle();
    save("dispatch", "filter");
    make_watch_seed();
    make_empty_seed();
    begin();
    put_u8(0);
    put_u16(sizeof nonsense);
    put(nonsense, sizeof nonsense);
    ASK(PING, 1);
    put_u8(246);
    put_u16(1);
    put_u8(0xc0);
    save("dispatch", "nonsense");
    for (int method = 0; method < PROTO_METHOD_COUNT; method++) {
        begin();
        ASK(HELLO, 1, 1, 3);
        ask(method, NULL, 0);
        settle();
        save("dispatch", proto_messages[method].name);
    }
}

/* ---- record ------------------------------------------------------------------------ */

static void put_chunk(unsigned kind, const void *head, size_t head_bytes,
                      const void *rest, size_t rest_bytes)
{
    put_u8(kind);
    put_u16((unsigned)(head_bytes + rest_bytes));
    put(head, head_bytes);
    put(rest, rest_bytes);
}

/* A triangle that is added, moved in four ways, replaced, and removed. */
static void make_record_seeds(void)
{
    const struct record_begin hello = {.pid = 1};
    const struct record_scene scene = {.scene = 5};
    const struct record_object object = {5, 1, 9, 0};
    const struct record_name name = {.scene = 5, .object = 9, .bytes = 6};
    const struct record_gone gone = {5, 1, 9, 0};
    const struct record_answer answer = {.step = 1};
    const struct record_frame near = {
        .step = 2, .scene = 5, .segment_count = 1, .end = 1, .distance = 0.5};
    const struct record_answer told = {
        .step = 2, .is_near = 1, .total = 1, .counts = {1}};
    const struct record_records records = {
        .step = 2, .count = 1, .record_bytes = sizeof(struct pccd_near)};
    const struct pccd_near record = {.object_a = 9, .object_b = 9, .count = 1};
    const struct {
        struct record_mesh head;
        float x[4][3];
        uint32_t triangle[3];
    } mesh = {
        {.mesh = 1, .vertex_count = 4, .triangle_count = 1}, {{1, 2, 3}}, {0, 1, 3}};
    const struct {
        struct record_place head;
        double m[12];
    } place = {{5, 9, RECORD_PLACED_RIGID, 1}, {1, 0, 0, 2}};
    struct {
        struct record_frame head;
        struct record_segment segment;
        double m[24];
    } frame = {{.step = 1, .scene = 5, .segment_count = 1},
               {9, RECORD_X1, PCCD_FORMAT_F32, 1, 3, 0, 32},
               {1}};
    struct {
        struct record_frame head;
        struct record_segment segment;
        struct record_joints table;
        struct pccd_joint joint;
    } turn = {.head = {.step = 1, .scene = 5, .segment_count = 1, .resolution = 0.5},
              .segment = {9, RECORD_ON_JOINT, PCCD_FORMAT_F64, 0, 4, 32, 0},
              .table = {.count = 1},
              .joint = {.kind = PCCD_JOINT_TURN,
                        .parent = PCCD_NO_JOINT,
                        .rotation = {0, 0, 0, 1},
                        .axis = {0, 0, 1},
                        .to = {1}}};
    begin();
    put_u8(2);
    put_chunk(RECORD_BEGIN, &hello, sizeof hello, "", 0);
    put_chunk(RECORD_SCENE, &scene, sizeof scene, "", 0);
    put_chunk(RECORD_MESH, &mesh.head, sizeof mesh.head, mesh.x, 60);
    put_chunk(RECORD_OBJECT, &object, sizeof object, "", 0);
    put_chunk(RECORD_NAME, &name, sizeof name, "sleeve", name.bytes);
    put_chunk(RECORD_PLACE, &place.head, 16, place.m, 96);
    put_chunk(RECORD_FRAME, &frame.head, sizeof frame.head, &frame.segment, 224);
    frame.segment =
        (struct record_segment){9, RECORD_X0X1, PCCD_FORMAT_F64, 0, 2, 32, 80};
    put_chunk(RECORD_FRAME, &frame.head, sizeof frame.head, &frame.segment, 224);
    frame.segment =
        (struct record_segment){9, RECORD_RIGID, PCCD_FORMAT_F64, 0, 4, 32, 128};
    put_chunk(RECORD_FRAME, &frame.head, sizeof frame.head, &frame.segment, 224);
    put_chunk(RECORD_FRAME, &turn.head, sizeof turn.head, &turn.segment, 176);
    put_chunk(RECORD_ANSWER, &answer, sizeof answer, "", 0);
    put_chunk(RECORD_NEAR, &near, sizeof near, &frame.segment, 224);
    put_chunk(RECORD_ANSWER, &told, sizeof told, "", 0);
    put_chunk(RECORD_RECORDS, &records, sizeof records, &record, sizeof record);
    put_chunk(RECORD_MESH, &mesh.head, sizeof mesh.head, mesh.x, 60);
    put_chunk(RECORD_MESH_GONE, &gone, sizeof gone, "", 0);
    put_chunk(RECORD_OBJECT_GONE, &gone, sizeof gone, "", 0);
    put_chunk(RECORD_SCENE_GONE, &gone, sizeof gone, "", 0);
    save("record", "session");
}

int main(int argc, char **argv)
{
    if (argc != 2) {
        fprintf(stderr, "usage: %s FOLDER\n", argv[0]);
        return 2;
    }
    root = argv[1];
    mkdir(root, 0777);
    make_decoder_seeds();
    make_dispatch_seeds();
    make_batch_seeds();
    make_share_seeds();
    make_near_seeds();
    make_record_seeds();
    return 0;
}
