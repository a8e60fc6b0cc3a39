/* animals_data.c - hostile clients: what is in the shared memory. */
#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <string.h>
#include <sys/mman.h>

#include "animals.h"
#include "crossing.h"

#define SLOT_BYTES 65536u
#define ROUNDS     50

static struct test_raw raw;

static int step(const struct proto_FRAME_SUBMIT_request *submit,
                struct proto_FRAME_SUBMIT_result *answer)
{
    return test_raw_call(&raw, PROTO_METHOD_FRAME_SUBMIT, submit, answer);
}

/* Submits, and writes over the slot before the answer comes: a right answer, or torn, or
 * stale, or what nonsense gets; never anything else, and right again when it is left in
 * peace. */
bool zoo_rewrites_submitted_slots(struct zoo_cage *cage)
{
    struct test_raw_crossing scene;

    EXPECT(cage, zoo_enter(cage, &raw, SLOT_BYTES));
    EXPECT(cage, test_raw_build(&raw, "", test_triangle_x, &scene) == 0);
    for (int round = 0; round < ROUNDS; round++) {
        struct proto_FRAME_SUBMIT_request submit = test_raw_turn(&raw, 0, &scene, -1);
        struct proto_FRAME_SUBMIT_result answer = {.total = 0};
        uint32_t id = test_raw_request(&raw, PROTO_METHOD_FRAME_SUBMIT, &submit);
        int status;

        EXPECT(cage, id != 0);
        for (int i = 0; i < 20; i++) {
            memset(test_raw_payload(&raw, 0), round + i, 4096);
            (void)test_raw_publish(&raw, 0);
        }
        status = test_raw_answer(&raw, id, PROTO_METHOD_FRAME_SUBMIT, &answer);
        EXPECT(cage, status == 0 || status == PCCD_E_SLOT_STALE ||
                         status == PCCD_E_SLOT_TORN || status == PCCD_E_SEGMENT ||
                         status == PCCD_E_HANDLE || status == PCCD_E_NOTFINITE);
        submit = test_raw_turn(&raw, 0, &scene, -1);
        EXPECT(cage, step(&submit, &answer) == 0);
        submit = test_raw_turn(&raw, 0, &scene, 1); /* through the floor */
        EXPECT(cage, step(&submit, &answer) == 0);
        EXPECT(cage, answer.vf == 3 && answer.incomplete == PCCD_COMPLETE);
        test_raw_release(&raw, answer.release);
    }
    test_raw_close(&raw);
    return true;
}

#define BATCH_SCENES 12u

/* A batch of scenes of which all but the last are nonsense: unknown, or empty and with
 * segments that lead anywhere. */
static struct proto_BATCH_SUBMIT_request
write_batch(const struct test_raw_crossing *scene, const uint32_t *empty, int round,
            float z)
{
    const uint32_t tables =
        BATCH_SCENES * (sizeof(struct proto_batch_scene) + sizeof(struct proto_segment));
    uint8_t *payload = test_raw_payload(&raw, 0);
    struct proto_batch_scene entries[BATCH_SCENES];
    struct proto_segment segments[BATCH_SCENES];
    float x[3][3];

    for (uint32_t i = 0; i < BATCH_SCENES; i++) {
        bool is_last = i + 1 == BATCH_SCENES;

        entries[i] = (struct proto_batch_scene){
            is_last                ? scene->scene
            : i < BATCH_SCENES / 2 ? empty[i]
                                   : scene->scene + 100 * i * (uint32_t)(round + 1),
            1};
        segments[i] = (struct proto_segment){
            .object = scene->object,
            .count = is_last ? 3 : UINT32_MAX - i,
            .offset1 = is_last ? tables : UINT64_MAX - 8 * (uint64_t)(i + 1)};
    }
    test_crossing_positions(x, z);
    memcpy(payload, entries, sizeof entries);
    memcpy(payload + sizeof entries, segments, sizeof segments);
    memcpy(payload + tables, x, sizeof x);
    return (struct proto_BATCH_SUBMIT_request){.slot = 0,
                                               .seq = test_raw_publish(&raw, 0),
                                               .scenes = BATCH_SCENES,
                                               .segments = BATCH_SCENES};
}

/* Submits batches of nonsense, and writes over the slot before the answer comes, so that
 * several threads read what changes. What makes sense is answered rightly, when it is
 * left in peace; the rest gets its error, scene by scene. */
bool zoo_batches_nonsense(struct zoo_cage *cage)
{
    uint32_t empty[BATCH_SCENES / 2];
    struct test_raw_crossing scene;

    EXPECT(cage, zoo_enter(cage, &raw, SLOT_BYTES));
    EXPECT(cage, test_raw_build(&raw, "", test_triangle_x, &scene) == 0);
    for (uint32_t i = 0; i < BATCH_SCENES / 2; i++) {
        EXPECT(cage, test_raw_scene(&raw, "", &empty[i]) == 0);
    }
    for (int round = 0; round < ROUNDS; round++) {
        struct proto_BATCH_SUBMIT_request batch = write_batch(&scene, empty, round, -1);
        struct proto_BATCH_SUBMIT_result answer = {.count = 0};
        uint32_t id = test_raw_request(&raw, PROTO_METHOD_BATCH_SUBMIT, &batch);
        int status;

        EXPECT(cage, id != 0);
        for (int i = 0; i < 20; i++) {
            memset(test_raw_payload(&raw, 0), round + i, 4096);
            (void)test_raw_publish(&raw, 0);
        }
        status = test_raw_answer(&raw, id, PROTO_METHOD_BATCH_SUBMIT, &answer);
        EXPECT(cage, status == 0 || status == PCCD_E_SLOT_STALE ||
                         status == PCCD_E_SLOT_TORN || status == PCCD_E_SEGMENT);
        batch = write_batch(&scene, empty, round, -1);
        EXPECT(cage,
               test_raw_call(&raw, PROTO_METHOD_BATCH_SUBMIT, &batch, &answer) == 0);
        EXPECT(cage, answer.failed == BATCH_SCENES - 1);
        batch = write_batch(&scene, empty, round, 1); /* through the floor */
        EXPECT(cage,
               test_raw_call(&raw, PROTO_METHOD_BATCH_SUBMIT, &batch, &answer) == 0);
        EXPECT(cage, answer.failed == BATCH_SCENES - 1 && answer.total == 3);
        EXPECT(cage, answer.incomplete == 0 && answer.count == BATCH_SCENES);
        test_raw_release(&raw, answer.release);
    }
    test_raw_close(&raw);
    return true;
}

/* Takes the pages of the ring away while the daemon has them mapped: what was there reads
 * as zeros, so a slot is stale; the result region cannot be punched. */
bool zoo_punches_holes(struct zoo_cage *cage)
{
    const int punch = FALLOC_FL_PUNCH_HOLE | FALLOC_FL_KEEP_SIZE;
    struct test_raw_crossing scene;
    struct proto_FRAME_SUBMIT_request submit;
    off_t bytes;

    EXPECT(cage, zoo_enter(cage, &raw, SLOT_BYTES));
    EXPECT(cage, test_raw_build(&raw, "", test_triangle_x, &scene) == 0);
    bytes = (off_t)raw.ring.upload_bytes;
    submit = test_raw_turn(&raw, 0, &scene, -1);
    EXPECT(cage, fallocate(raw.upload.fd, punch, 0, bytes) == 0);
    EXPECT(cage, step(&submit, NULL) == PCCD_E_SLOT_STALE);
    for (int round = 0; round < ROUNDS; round++) { /* and behind the daemon's back */
        uint32_t id;
        int status;

        submit = test_raw_turn(&raw, 0, &scene, round % 2 == 0 ? -1 : 1);
        id = test_raw_request(&raw, PROTO_METHOD_FRAME_SUBMIT, &submit);
        EXPECT(cage, id != 0);
        EXPECT(cage, fallocate(raw.upload.fd, punch, 4096, bytes - 4096) == 0);
        status = test_raw_answer(&raw, id, PROTO_METHOD_FRAME_SUBMIT, NULL);
        /* A table of zeros names no object. */
        EXPECT(cage, status == 0 || status == PCCD_E_SEGMENT || status == PCCD_E_HANDLE ||
                         status == PCCD_E_SLOT_STALE || status == PCCD_E_INVAL);
    }
    EXPECT(cage, fallocate(raw.result.fd, punch, 0, 4096) != 0);
    test_raw_close(&raw);
    return true;
}

/* A request with one number that is not true, and what it gets. */
static int ask_mesh(uint32_t vertices, uint32_t triangles)
{
    return RAW_CALL(&raw, MESH_CREATE, NULL, .vertex_count = vertices,
                    .triangle_count = triangles);
}

static int ask_data(uint32_t mesh, uint32_t slot, uint32_t first, uint32_t count)
{
    return RAW_CALL(&raw, MESH_DATA, NULL, .mesh = mesh, .slot = slot, .first = first,
                    .count = count, .seq = test_raw_publish(&raw, 0));
}

/* More than there is, of everything: refused by name, and nothing is allocated for it. */
bool zoo_lies_about_counts(struct zoo_cage *cage)
{
    struct test_raw_crossing scene;
    struct proto_FRAME_SUBMIT_request submit;
    struct proto_MESH_CREATE_result created;

    EXPECT(cage, zoo_enter(cage, &raw, SLOT_BYTES));
    EXPECT(cage, test_raw_build(&raw, "", test_triangle_x, &scene) == 0);
    EXPECT(cage, ask_mesh(PROTO_COUNT_MAX, PROTO_COUNT_MAX) == PCCD_E_QUOTA);
    EXPECT(cage, ask_mesh(PROTO_COUNT_MAX + 1, 1) == PCCD_E_INVAL);
    EXPECT(cage, ask_mesh(3, 0) == PCCD_E_INVAL);
    EXPECT(cage, RAW_CALL(&raw, MESH_CREATE, &created, .vertex_count = 100,
                          .triangle_count = 10) == 0);
    EXPECT(cage, ask_data(created.mesh, 0, 0, 101) == PCCD_E_INVAL);
    EXPECT(cage, ask_data(created.mesh, 0, UINT32_MAX, 2) == PCCD_E_INVAL);
    EXPECT(cage, ask_data(created.mesh, 0, 0, UINT32_MAX) == PCCD_E_INVAL);
    EXPECT(cage, ask_data(created.mesh, 2, 0, 100) == PCCD_E_INVAL);
    EXPECT(cage, RAW_CALL(&raw, MESH_COMMIT, NULL, .mesh = created.mesh) == PCCD_E_STATE);
    submit = test_raw_turn(&raw, 0, &scene, -1);
    submit.segments = PROTO_SEGMENTS_MAX; /* 2 MiB of table in a slot of 64 KiB */
    EXPECT(cage, step(&submit, NULL) == PCCD_E_SEGMENT);
    submit.segments = UINT32_MAX;
    EXPECT(cage, step(&submit, NULL) == PCCD_E_LIMIT);
    atomic_store(&test_raw_upload(&raw)->result_head.value, UINT64_MAX);
    submit = test_raw_turn(&raw, 0, &scene, -1);
    EXPECT(cage, step(&submit, NULL) == PCCD_E_INVAL);
    test_raw_close(&raw);
    return true;
}

/* Submit the triangle with its first coordinate at x, as double. */
static int submit_number(const struct test_raw_crossing *scene, double x)
{
    const struct proto_segment segment = {.object = scene->object,
                                          .kind = PROTO_SEGMENT_X1,
                                          .format = PCCD_FORMAT_F64,
                                          .count = 3,
                                          .offset1 = 32};
    const double positions[9] = {x, 0, 1, 1, 0, 1, 0, 1, 1};
    struct proto_FRAME_SUBMIT_request submit = {.scene = scene->scene, .segments = 1};
    struct proto_FRAME_SUBMIT_result answer = {.total = 0};
    int status;

    memcpy(test_raw_payload(&raw, 0), &segment, sizeof segment);
    memcpy(test_raw_payload(&raw, 0) + 32, positions, sizeof positions);
    submit.seq = test_raw_publish(&raw, 0);
    status = step(&submit, &answer);
    return status == 0 && (answer.total != 0 || answer.incomplete != PCCD_COMPLETE)
               ? 1
               : status;
}

/* NaN, infinities and 1e300 are E_NOTFINITE and move nothing; denormals, minus zero and
 * 1e18 are numbers like others. */
bool zoo_sends_wrong_numbers(struct zoo_cage *cage)
{
    static const double wrong[] = {NAN, -NAN, INFINITY, -INFINITY, 1e300, -1e300, 1.1e18};
    static const double right[] = {4.9e-324, -4.9e-324, 1e-310, -0.0, 1e18, -1e18, 1e-45};
    struct test_raw_crossing scene;

    EXPECT(cage, zoo_enter(cage, &raw, SLOT_BYTES));
    EXPECT(cage, test_raw_build(&raw, "", test_triangle_x, &scene) == 0);
    for (int round = 0; round < ROUNDS; round++) {
        EXPECT(cage, submit_number(&scene, wrong[round % 7]) == PCCD_E_NOTFINITE);
        EXPECT(cage, submit_number(&scene, right[round % 7]) == 0);
    }
    test_raw_close(&raw);
    return true;
}

/* Triangles of vertices that are not there: E_INDEX, and no mesh comes of it. */
bool zoo_names_wrong_indices(struct zoo_cage *cage)
{
    static const uint32_t wrong[][1][3] = {
        {{0, 1, 3}}, {{0, 1, UINT32_MAX}}, {{1u << 31, 1, 2}}};
    struct proto_MESH_CREATE_result created;

    EXPECT(cage, zoo_enter(cage, &raw, SLOT_BYTES));
    for (int round = 0; round < ROUNDS; round++) {
        EXPECT(cage, RAW_CALL(&raw, MESH_CREATE, &created, .vertex_count = 3,
                              .triangle_count = 1) == 0);
        EXPECT(cage, test_raw_fill(&raw, created.mesh, test_triangle_x, 3,
                                   wrong[round % 3], 1) == PCCD_E_INDEX);
        EXPECT(cage,
               RAW_CALL(&raw, MESH_COMMIT, NULL, .mesh = created.mesh) == PCCD_E_STATE);
        EXPECT(cage, RAW_CALL(&raw, MESH_DESTROY, NULL, .mesh = created.mesh) == 0);
    }
    test_raw_close(&raw);
    return true;
}
