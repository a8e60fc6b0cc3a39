/* test_rec_format.c - recordings as files: written, cut, damaged, read.
 *
 * More than 600 lines: what a reader refuses of every kind of chunk,
 * on one fixture.
 */
#include "cases.h"

#include <unistd.h>

#include "object_attributes.h"
#include "payload.h"
#include "reader.h"

#define CHUNKS_MAX 16

static char path[] = "/tmp/pccd-test-rec-XXXXXX";
static uint8_t file[65536];
static uint64_t file_bytes;
static uint64_t starts[CHUNKS_MAX + 1]; /* of the chunks; then of the end */
static uint32_t chunk_count;

/* A mesh whose vertices compress, a step of it, an answer, and the end. */
static const float x[64][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
static const uint32_t triangles[2][3] = {{0, 1, 2}, {2, 1, 63}};

static void add(struct record_writer *writer, enum record_kind kind, const void *head,
                size_t head_bytes, const void *rest, size_t rest_bytes)
{
    const struct record_part parts[2] = {{head, head_bytes}, {rest, rest_bytes}};

    starts[chunk_count++] = writer->bytes;
    assert_int_equal(record_writer_add(writer, kind, 7, parts, rest != NULL ? 2 : 1), 0);
}

static void write_file(int level)
{
    struct record_writer writer = {.fd = -1, .level = level};
    struct record_begin begin = {.pid = 3, .library = "0.1.0"};
    struct record_mesh mesh = {.mesh = 1, .vertex_count = 64, .triangle_count = 2};
    struct record_scene scene = {.scene = 5};
    struct record_object object = {5, 1, 9, 0};
    struct record_frame frame = {.step = 1, .scene = 5, .segment_count = 1};
    struct record_answer answer = {.step = 1, .total = 4};
    struct record_end end = {.reason = RECORD_STOPPED};
    struct {
        struct record_segment segment;
        float x[64][3];
    } slot = {{9, RECORD_X1, PCCD_FORMAT_F32, 0, 64, 0, sizeof(struct record_segment)},
              {{0}}};
    struct {
        float x[64][3];
        uint32_t triangles[2][3];
    } body;

    memcpy(body.x, x, sizeof x);
    memcpy(body.triangles, triangles, sizeof triangles);
    chunk_count = 0;
    (void)unlink(path);
    assert_int_equal(record_writer_open(&writer, path), 0);
    add(&writer, RECORD_BEGIN, &begin, sizeof begin, NULL, 0);
    add(&writer, RECORD_MESH, &mesh, sizeof mesh, &body, sizeof body);
    add(&writer, RECORD_SCENE, &scene, sizeof scene, NULL, 0);
    add(&writer, RECORD_OBJECT, &object, sizeof object, NULL, 0);
    add(&writer, (enum record_kind)31, "of another release", 18, NULL, 0);
    add(&writer, RECORD_FRAME, &frame, sizeof frame, &slot, sizeof slot);
    add(&writer, RECORD_ANSWER, &answer, sizeof answer, NULL, 0);
    add(&writer, RECORD_END, &end, sizeof end, NULL, 0);
    starts[chunk_count] = writer.bytes;
    assert_int_equal(record_writer_close(&writer), 0);
    record_writer_deinit(&writer);
}

static void load_file(void)
{
    FILE *from = fopen(path, "rb");

    assert_non_null(from);
    file_bytes = fread(file, 1, sizeof file, from);
    assert_int_equal(fclose(from), 0);
    assert_int_equal(file_bytes, starts[chunk_count]);
}

static int set_up(void **state)
{
    int fd = mkstemp(path);

    (void)state;
    if (fd < 0 || close(fd) != 0) {
        return -1;
    }
    write_file(1);
    load_file();
    return 0;
}

static int tear_down(void **state)
{
    (void)state;
    return unlink(path);
}

/* Chunks of `bytes` bytes of the file, up to its end or a failure; *status says which. */
static uint32_t read_all(const uint8_t *from, uint64_t bytes, int *status,
                         enum record_ending *ending)
{
    struct record_reader reader;
    struct record_view view;
    uint32_t count = 0;

    *status = record_reader_open_memory(&reader, from, bytes);
    while (*status == 0 && (*status = record_reader_next(&reader, &view)) == 1) {
        *status = 0;
        count++;
    }
    *ending = reader.ending;
    record_reader_deinit(&reader);
    return count;
}

/* If this failed, what was recorded would not be what is read. */
CASE(chunks__come_back_as_they_were)
{
    static const uint16_t kinds[] = {RECORD_BEGIN,  RECORD_MESH,  RECORD_SCENE,
                                     RECORD_OBJECT, RECORD_FRAME, RECORD_ANSWER,
                                     RECORD_END};

    for (int level = 0; level <= 3; level += 3) {
        struct record_reader reader;
        struct record_view view;
        struct record_mesh mesh;

        write_file(level);
        load_file();
        assert_int_equal(record_reader_open(&reader, path), 0);
        for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; i++) {
            assert_int_equal(record_reader_next(&reader, &view), 1);
            assert_int_equal(view.kind, kinds[i]);
            assert_int_equal(view.time_ns, 7);
            if (view.kind == RECORD_MESH) {
                memcpy(&mesh, view.payload, sizeof mesh);
                assert_int_equal(mesh.vertex_count, 64);
                assert_memory_equal((const uint8_t *)view.payload + sizeof mesh, x,
                                    sizeof x);
            }
        }
        assert_int_equal(record_reader_next(&reader, &view), 0);
        assert_int_equal(reader.ending, RECORD_ENDING_WHOLE);
        record_reader_deinit(&reader);
    }
    write_file(1);
    load_file();
}

/* If this failed, a crash would cost more than the chunk that was being written, or what
 * is left would be taken for damaged. */
CASE(files__are_read_up_to_any_cut)
{
    for (uint64_t bytes = RECORD_HEAD_BYTES; bytes <= file_bytes; bytes++) {
        enum record_ending ending;
        uint32_t whole = 0;
        int status;
        uint32_t count = read_all(file, bytes, &status, &ending);

        for (uint32_t i = 0; i < chunk_count; i++) {
            /* The one of an unknown kind is not shown; the zeros behind a chunk may be
             * missing. */
            struct record_chunk chunk;
            memcpy(&chunk, file + starts[i], sizeof chunk);
            whole += i != 4 && starts[i] + sizeof chunk + chunk.stored_bytes <= bytes;
        }
        assert_int_equal(status, 0);
        assert_int_equal(count, whole);
        assert_int_not_equal(ending, RECORD_ENDING_UNKNOWN);
        for (uint32_t i = 0; i < chunk_count; i++) {
            if (bytes == starts[i]) {
                assert_int_equal(ending, RECORD_ENDING_OPEN);
            }
        }
    }
}

/* If this failed, a byte that has changed on a disk would be played as if it were right,
 * or chunks before it would be lost. */
CASE(files__show_the_change_of_any_byte)
{
    for (uint64_t at = 0; at < file_bytes; at++) {
        enum record_ending ending;
        struct record_chunk chunk;
        uint32_t before = 0;
        int status;

        for (uint32_t i = 0; i < chunk_count; i++) {
            memcpy(&chunk, file + starts[i], sizeof chunk);
            if (at >= starts[i] + sizeof chunk + chunk.stored_bytes) {
                before += i != 4;
            }
        }
        memcpy(&chunk, file + starts[4], sizeof chunk);
        bool is_unread = at >= starts[4] + sizeof chunk && at < starts[5];
        bool is_padding = false;
        for (uint32_t i = 0; i < chunk_count; i++) {
            memcpy(&chunk, file + starts[i], sizeof chunk);
            is_padding =
                is_padding || (at >= starts[i] + sizeof chunk + chunk.stored_bytes &&
                               at < starts[i + 1]);
        }
        file[at] ^= 0x40;
        uint32_t count = read_all(file, file_bytes, &status, &ending);
        file[at] ^= 0x40;
        if (at >= 12 && at < RECORD_HEAD_BYTES) {
            continue; /* says nothing */
        }
        if (is_padding || is_unread) {
            assert_true(status == 0 || status == PCCD_E_FORMAT);
        } else {
            assert_int_equal(status, PCCD_E_FORMAT);
            assert_int_equal(count, at < RECORD_HEAD_BYTES ? 0 : before);
        }
    }
}

/* If this failed, a recording of another format would be misread, and its reader blame
 * the daemon; or who gets one would not know which release reads it. */
CASE(heads__say_what_a_reader_must_know)
{
    const struct record_begin begin = {.pid = 1, .library = "7.8.9"};
    struct record_writer writer = {.fd = -1};
    struct record_reader reader;

    assert_int_equal(unlink(path), 0);
    assert_int_equal(record_writer_open(&writer, path), 0);
    chunk_count = 0;
    add(&writer, RECORD_BEGIN, &begin, sizeof begin, NULL, 0);
    starts[chunk_count] = writer.bytes;
    record_writer_deinit(&writer);
    load_file();
    for (uint32_t version = 1; version <= 4; version++) {
        memcpy(file + 8, &version, sizeof version);
        for (int i = 0; i < 2; i++) { /* in the other turn nobody tells who wrote it */
            assert_int_equal(record_reader_open_memory(
                                 &reader, file, i == 0 ? file_bytes : RECORD_HEAD_BYTES),
                             version == RECORD_VERSION ? 0 : PCCD_E_FORMAT);
            assert_true(version == RECORD_VERSION ||
                        (strstr(reader.text, "and this program reads 3") != NULL &&
                         (i == 1) == (strstr(reader.text, "by pccd 7.8.9") == NULL)));
            record_reader_deinit(&reader);
        }
    }
    (void)unlink(path);
    write_file(1);
    load_file();
}

/* If this failed, a recording could be written over by the next one. */
CASE(files__are_never_written_over)
{
    struct record_writer writer = {.fd = -1};

    assert_int_equal(record_writer_open(&writer, path), PCCD_E_SYSTEM);
    record_writer_deinit(&writer);
}

/* A payload with one of its words changed, and its kind's judgement. */
static int judge_with(uint16_t kind, const void *payload, size_t bytes, size_t at,
                      uint32_t word)
{
    uint8_t copy[1024];
    char text[RECORD_TEXT_BYTES] = "";
    int status;

    memcpy(copy, payload, bytes);
    memcpy(copy + at, &word, sizeof word);
    status = record_payload_judge(kind, copy, bytes, text);
    assert_true(status == 0 || text[0] != '\0');
    return status;
}

/* If this failed, a reader would follow an index or a range out of its memory. */
CASE(payloads__are_refused_with_indices_out_of_range)
{
    struct {
        struct record_mesh head;
        float x[4][3];
        uint32_t triangles[1][3];
    } mesh = {{.mesh = 1, .vertex_count = 4, .triangle_count = 1}, {{0}}, {{0, 1, 2}}};
    struct {
        struct record_frame head;
        struct record_segment segment;
        float x[4][3];
    } frame = {{.step = 1, .segment_count = 1},
               {1, RECORD_X1, PCCD_FORMAT_F32, 0, 4, 0, sizeof(struct record_segment)},
               {{0}}};
    struct {
        struct record_pairs head;
        struct record_pair pairs[2];
    } pairs = {{.scene = 1, .count = 2},
               {{.a = 1, .b = 2, .said = RECORD_IGNORED}, {.a = 3, .b = 2}}};
    const size_t second = sizeof pairs.head + sizeof pairs.pairs[0];
    const struct record_filter filter = {.what = PCCD_OBJECT_ALL};
    const struct {
        struct record_name head;
        char text[8];
    } name = {{.scene = 1, .object = 2, .bytes = 6}, "sleeve"};
    const size_t segment = sizeof frame.head;

    assert_int_equal(judge_with(RECORD_PAIRS, &pairs, sizeof pairs, 0, 1), 0);
    for (uint32_t count = 1; count <= 3; count += 2) { /* there are two */
        assert_int_not_equal(judge_with(RECORD_PAIRS, &pairs, sizeof pairs, 4, count), 0);
    }
    assert_int_not_equal(judge_with(RECORD_PAIRS, &pairs, sizeof pairs, second, 2), 0);
    assert_ok(judge_with(RECORD_PAIRS, &pairs, sizeof pairs, second + 8, 2));
    assert_int_not_equal(judge_with(RECORD_PAIRS, &pairs, sizeof pairs, second + 8, 3),
                         0);
    assert_int_not_equal(
        judge_with(RECORD_PAIRS, &pairs, sizeof pairs, second + 20, 0xbff00000u), 0);
    assert_int_equal(judge_with(RECORD_NAME, &name, sizeof name.head + 6, 4, 3), 0);
    assert_int_not_equal(judge_with(RECORD_NAME, &name, sizeof name.head + 6, 8, 7), 0);
    assert_int_not_equal(judge_with(RECORD_NAME, &name, sizeof name.head + 7, 8, 7), 0);
    assert_int_equal(judge_with(RECORD_FILTER, &filter, sizeof filter, 8, 7), 0);
    assert_int_not_equal(
        judge_with(RECORD_FILTER, &filter, sizeof filter, 8, COMMON_OBJECT_KNOWN + 1), 0);
    assert_int_not_equal(judge_with(RECORD_FILTER, &filter, 12, 8, 7), 0);
    assert_int_equal(judge_with(RECORD_MESH, &mesh, sizeof mesh, 0, 1), 0);
    assert_int_not_equal(judge_with(RECORD_MESH, &mesh, sizeof mesh, 8, 5), 0);
    assert_int_not_equal(judge_with(RECORD_MESH, &mesh, sizeof mesh, 12, 2), 0);
    assert_int_not_equal(judge_with(RECORD_MESH, &mesh, sizeof mesh, 4, 2), 0);
    assert_int_not_equal(judge_with(RECORD_MESH, &mesh, sizeof mesh, sizeof mesh - 4, 4),
                         0);
    assert_int_equal(judge_with(RECORD_FRAME, &frame, sizeof frame, segment, 1), 0);
    assert_int_not_equal(judge_with(RECORD_FRAME, &frame, sizeof frame, segment + 12, 5),
                         0);
    assert_int_not_equal(judge_with(RECORD_FRAME, &frame, sizeof frame, segment + 24, 40),
                         0);
    assert_int_not_equal(
        judge_with(RECORD_FRAME, &frame, sizeof frame, segment + 24, 0xfffffff8u), 0);
    assert_int_not_equal(judge_with(RECORD_FRAME, &frame, sizeof frame, segment + 4, 3),
                         0);
    assert_int_not_equal(judge_with(RECORD_FRAME, &frame, sizeof frame,
                                    offsetof(struct record_frame, segment_count), 4),
                         0);
}

/* A file of one chunk whose payload is zeros but for its first `head_bytes`, read.
 * Returns what the reader says; *room: memory that it has taken for payloads. */
static int read_zeros(uint16_t kind, const void *head, size_t head_bytes, size_t bytes,
                      char text[256], size_t *room)
{
    struct record_writer writer = {.fd = -1, .level = 1};
    struct record_reader reader;
    struct record_view view;
    uint8_t *payload = test_room(bytes + 1);
    const struct record_part part = {payload, bytes};
    int status;

    memcpy(payload, head, head_bytes);
    (void)unlink(path);
    assert_int_equal(record_writer_open(&writer, path), 0);
    assert_int_equal(record_writer_add(&writer, (enum record_kind)kind, 7, &part, 1), 0);
    record_writer_deinit(&writer);
    free(payload);
    assert_int_equal(record_reader_open(&reader, path), 0);
    status = record_reader_next(&reader, &view);
    (void)snprintf(text, 256, "%s", status < 0 ? reader.text : "");
    *room = reader.payload_room;
    record_reader_deinit(&reader);
    return status;
}

/* If this failed, a file of a hundred kilobytes would take gigabytes of memory, for a
 * chunk that says nothing so long. */
CASE(chunks__take_no_more_memory_than_they_count)
{
    const size_t large = (size_t)64 << 20;
    const struct record_mesh mesh = {.mesh = 1, .vertex_count = 4, .triangle_count = 1};
    const struct record_mesh guest = {
        .vertex_count = 4, .edge_count = 1, .point_count = 1, .has_radii = 1};
    const struct record_pairs pairs = {.scene = 1, .count = 1};
    const struct record_records records = {.step = 1, .count = 1, .record_bytes = 64};
    const struct record_records nears = {.step = 1, .count = 1, .record_bytes = 64};
    const struct record_place place = {1, 1, RECORD_PLACED_FREELY, PCCD_FORMAT_F32};
    const struct record_frame frame = {.step = 1, .scene = 1, .segment_count = 2};
    const struct record_name name = {.scene = 1, .object = 1, .bytes = 8};
    const struct record_frame many = {.step = 1, .scene = 1, .segment_count = 65537};
    const struct record_frame near = {.step = 1, .scene = 1, .segment_count = 1};
    const struct {
        uint16_t kind;
        const void *head;
        size_t bytes;
    } counted[] = {{RECORD_MESH, &mesh, sizeof mesh},
                   {RECORD_GUEST, &guest, sizeof guest},
                   {RECORD_PAIRS, &pairs, sizeof pairs},
                   {RECORD_NAME, &name, sizeof name},
                   {RECORD_RECORDS, &records, sizeof records},
                   {RECORD_RECORDS, &nears, sizeof nears},
                   {RECORD_FRAME, &frame, sizeof frame},
                   {RECORD_FRAME, &many, sizeof many},
                   {RECORD_MOVE, &frame, sizeof frame},
                   {RECORD_NEAR, &near, sizeof near}};
    char text[256];
    size_t room;

    if (!record_has_zstd()) {
        return; /* nothing is longer than its file */
    }
    for (uint16_t kind = 0; kind < RECORD_KINDS_MAX; kind++) {
        bool is_counted = kind == RECORD_PLACE || record_kind_name(kind) == NULL;
        for (size_t i = 0; i < sizeof counted / sizeof counted[0]; i++) {
            is_counted = is_counted || kind == counted[i].kind;
        }
        if (!is_counted) { /* of fixed size: not a byte more */
            assert_int_equal(read_zeros(kind, "", 0, 1024, text, &room), PCCD_E_FORMAT);
            assert_non_null(strstr(text, "too long for its kind"));
            assert_int_equal(room, 0);
        }
    }
    for (size_t i = 0; i < sizeof counted / sizeof counted[0]; i++) {
        assert_int_equal(read_zeros(counted[i].kind, counted[i].head, counted[i].bytes,
                                    large, text, &room),
                         PCCD_E_FORMAT);
        assert_non_null(strstr(text, "67108864 bytes, and what it counts takes "));
        assert_int_equal(room, 0);
    }
    assert_int_equal(read_zeros(RECORD_PLACE, &place, sizeof place, large, text, &room),
                     PCCD_E_FORMAT);
    assert_non_null(strstr(text, "a place of more vertices than a mesh has"));
    assert_int_equal(room, 0);
    assert_int_equal(read_zeros(31, "", 0, large, text, &room), 0); /* is let by */
    assert_int_equal(room, 0);
    (void)unlink(path);
    write_file(1);
    load_file();
}

/* If this failed, a recording could name the handle of nothing, or have coordinates that
 * are none, and end its reader. */
CASE(payloads__have_handles_and_coordinates)
{
    const struct record_scene scene = {.scene = 5};
    const struct record_object object = {5, 1, 9, 0};
    struct {
        struct record_mesh head;
        double x[4][3], radii[4];
        uint32_t triangles[1][3], edge[2], point[1];
    } guest = {{.format = PCCD_FORMAT_F64,
                .vertex_count = 4,
                .triangle_count = 1,
                .edge_count = 1,
                .point_count = 1,
                .has_radii = 1,
                .scene = 1,
                .object = 1},
               {{0}},
               {0},
               {{0, 1, 2}},
               {2, 3},
               {3}};
    const size_t scene_at = offsetof(struct record_mesh, scene);
    const size_t edge_at = offsetof(struct record_mesh, reserved) + 4 + 96 + 32 + 12;
    struct {
        struct record_mesh head;
        float x[4][3];
        uint32_t triangles[1][3];
    } mesh = {{.mesh = 1, .vertex_count = 4, .triangle_count = 1}, {{0}}, {{0, 1, 2}}};
    const uint32_t nan = 0x7fc00000, high = 0x7ff80000;

    assert_int_equal(judge_with(RECORD_SCENE, &scene, sizeof scene, 0, 5), 0);
    assert_int_not_equal(judge_with(RECORD_SCENE, &scene, sizeof scene, 0, 0), 0);
    assert_int_equal(judge_with(RECORD_OBJECT, &object, sizeof object, 0, 5), 0);
    for (size_t at = 0; at < 12; at += 4) {
        assert_int_not_equal(judge_with(RECORD_OBJECT, &object, sizeof object, at, 0), 0);
    }
    assert_ok(judge_with(RECORD_GUEST, &guest, sizeof guest, scene_at, 1));
    for (size_t at = scene_at; at < scene_at + 8; at += 4) { /* and the object */
        assert_int_not_equal(judge_with(RECORD_GUEST, &guest, sizeof guest, at, 0), 0);
    }
    for (size_t at = edge_at; at < sizeof guest; at += 4) {
        assert_ok(judge_with(RECORD_GUEST, &guest, sizeof guest, at, 2));
        assert_int_not_equal(judge_with(RECORD_GUEST, &guest, sizeof guest, at, 4), 0);
    }
    assert_int_not_equal(judge_with(RECORD_GUEST, &guest, sizeof guest,
                                    sizeof guest.head + 96 + 4, 0xbff00000u),
                         0); /* a radius */
    for (size_t i = 0; i < 12; i++) {
        assert_int_not_equal(
            judge_with(RECORD_MESH, &mesh, sizeof mesh, sizeof mesh.head + 4 * i, nan),
            0);
        assert_int_not_equal(judge_with(RECORD_GUEST, &guest, sizeof guest,
                                        sizeof guest.head + 8 * i + 4, high),
                             0);
    }
}

/* If this failed, a reader would follow what it has not judged of a question about what
 * is near, or of its answer. */
CASE(payloads__of_what_is_near_are_judged)
{
    struct {
        struct record_frame head;
        struct record_segment segment;
        double x[4][3];
    } near = {{.step = 1, .segment_count = 1, .what = PCCD_NEAR_DEPTH, .end = 1},
              {1, RECORD_X1, PCCD_FORMAT_F64, 0, 4, 0, sizeof(struct record_segment)},
              {{0}}};
    struct {
        struct record_records head;
        struct pccd_near records[2];
    } records = {{.step = 1, .count = 2, .record_bytes = sizeof(struct pccd_near)},
                 {{0}}};
    const size_t count = offsetof(struct record_records, count);
    const size_t each = offsetof(struct record_records, record_bytes);
    const size_t what = offsetof(struct record_frame, what);
    const size_t end = offsetof(struct record_frame, end);
    const size_t segments = offsetof(struct record_frame, segment_count);

    assert_int_equal(judge_with(RECORD_NEAR, &near, sizeof near, end, 0), 0);
    assert_ok(judge_with(RECORD_NEAR, &near.head, sizeof near.head, segments, 0));
    memset(near.head.tuning, 'x', sizeof near.head.tuning - 1); /* has an end .. */
    assert_ok(judge_with(RECORD_NEAR, &near, sizeof near, end, 0));
    assert_int_not_equal(
        judge_with(RECORD_NEAR, &near, sizeof near, sizeof near.head - 4, 0x78787878),
        0); /* and none */
    assert_int_not_equal(judge_with(RECORD_NEAR, &near, sizeof near, 0, 0), 0);
    assert_int_not_equal(judge_with(RECORD_NEAR, &near, sizeof near, what, 6), 0);
    assert_int_not_equal(judge_with(RECORD_NEAR, &near, sizeof near, end, 2), 0);
    assert_int_not_equal(judge_with(RECORD_NEAR, &near, sizeof near, segments, 5), 0);
    assert_int_not_equal(
        judge_with(RECORD_NEAR, &near, sizeof near, sizeof near.head + 12, 5), 0);
    assert_int_equal(judge_with(RECORD_RECORDS, &records, sizeof records, 0, 1), 0);
    assert_int_not_equal(judge_with(RECORD_RECORDS, &records, sizeof records, count, 1),
                         0);
    assert_int_not_equal(judge_with(RECORD_RECORDS, &records, sizeof records, each, 0),
                         0);
    assert_int_not_equal(judge_with(RECORD_RECORDS, &records, sizeof records, each, 128),
                         0);
    records.head.count = 16; /* bounds of vertices */
    assert_ok(judge_with(RECORD_RECORDS, &records, sizeof records, each, 8));
}

/* If this failed, an object would be repeated with other attributes than it had, or with
 * something else than it has at first where a file says nothing of one. */
CASE(filters__come_back_as_they_were_or_as_at_first)
{
    const struct common_attributes told = {.group = 5, .mask = 6, .radius = 7};
    struct common_attributes read;
    struct record_filter filter, again;

    record_filter_make(&filter, 1, 2, PCCD_OBJECT_ALL, &told);
    assert_int_equal(filter.what, COMMON_OBJECT_KNOWN);
    record_filter_read(&filter, sizeof filter, &again, &read);
    assert_memory_equal(&again, &filter, sizeof filter);
    assert_true(read.group == 5 && read.mask == 6 && !read.self_collision);
    assert_true(read.radius == 7);
    record_filter_read(&filter, offsetof(struct record_filter, words[2]), &again, &read);
    assert_true(read.group == 5 && read.mask == 6 && read.self_collision);
    assert_true(read.radius == 0 && again.scene == 1 && again.object == 2);
}

CASES_WITH(set_up, tear_down);
