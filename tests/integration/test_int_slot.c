/* test_int_slot.c - nonsense in the memory that is shared with a real daemon. */
#include "cases.h"

#include <fcntl.h>
#include <pthread.h>
#include <sys/mman.h>
#include <unistd.h>

#include "witness.h"

#define SLOT_BYTES 65536u

static struct test_raw raw;

/* The smallest scene, built by hand in the raw session. */
static uint32_t scene;
static uint32_t mesh;
static uint32_t object;
static uint32_t removed; /* an object that is not there any more */

static int open_raw(void **state)
{
    (void)state;
    test_witness_open_raw(&raw, SLOT_BYTES);
    assert_ok(test_raw_scene(&raw, "", &scene));
    assert_ok(test_raw_mesh(&raw, test_triangle_x, 3, test_triangle, 1, &mesh));
    assert_ok(test_raw_add(&raw, scene, mesh, &removed));
    assert_ok(RAW_CALL(&raw, SCENE_REMOVE, NULL, .scene = scene, .object = removed));
    assert_ok(test_raw_add(&raw, scene, mesh, &object));
    return 0;
}

static int close_raw(void **state)
{
    (void)state;
    test_raw_close(&raw);
    test_witness_turn();
    return 0;
}

/* ---- sequence numbers -------------------------------------------------------------- */

static int submit(uint32_t slot, uint64_t seq, uint32_t segments)
{
    return RAW_CALL(&raw, FRAME_SUBMIT, NULL, .scene = scene, .slot = slot, .seq = seq,
                    .segments = segments);
}

/* A step that is right: the triangle at its registered place. Returns the sequence
 * number. */
static uint64_t write_good_step(void)
{
    return test_raw_move(&raw, 0, scene, object, test_triangle_x, 3).seq;
}

static void expect_good_step(void)
{
    assert_int_equal(submit(0, write_good_step(), 1), 0);
}

/* If it failed, a step would be computed from what another one left in the slot. */
CASE_WITH(slot__stale_sequence_numbers_are_refused, open_raw, close_raw)
{
    struct pccd_client *client = test_witness.crossing.client;
    uint64_t stale = test_stat(client, "slots_stale");
    uint64_t seq = write_good_step();

    assert_int_equal(submit(0, seq, 1), 0);
    assert_int_equal(submit(0, seq - 2, 1), PCCD_E_SLOT_STALE);
    assert_int_equal(submit(0, seq + 2, 1), PCCD_E_SLOT_STALE);
    assert_int_equal(submit(1, seq, 1), PCCD_E_SLOT_STALE);
    assert_int_equal(test_stat(client, "slots_stale"), stale + 3);
    /* Being written: an odd number, in the message or in the slot. */
    assert_int_not_equal(submit(0, seq + 1, 1), 0);
    atomic_store(&test_raw_upload(&raw)->slots[0].seq, seq + 1);
    assert_int_equal(submit(0, seq, 1), PCCD_E_SLOT_STALE);
    assert_int_not_equal(submit(0, seq + 1, 1), 0);
    assert_int_equal(submit(2, seq, 1), PCCD_E_INVAL); /* there are two slots */
    assert_int_equal(submit(UINT32_MAX, seq, 1), PCCD_E_INVAL);
    assert_false(raw.error.fatal);
    expect_good_step();
}

/* If it failed, the answer to a step could overtake that to an earlier one of the same
 * session, and pages of results go back in another order than they came. */
CASE_WITH(slot__answers_come_in_the_order_of_the_steps, open_raw, close_raw)
{
    struct proto_FRAME_SUBMIT_request stale = {.scene = scene, .seq = 2, .segments = 1};
    struct proto_FRAME_SUBMIT_request good = {
        .scene = scene, .segments = 1, .method = PCCD_METHOD_PAPER}; /* not the loop's */

    stale.seq = write_good_step() + 2;
    good.seq = stale.seq - 2;
    for (int i = 0; i < 200; i++) {
        uint32_t first = test_raw_request(&raw, PROTO_METHOD_FRAME_SUBMIT, &stale);
        uint32_t second = test_raw_request(&raw, PROTO_METHOD_FRAME_SUBMIT, &good);

        assert_ok(test_raw_receive(&raw));
        assert_int_equal(raw.envelope.id, first);
        assert_ok(test_raw_receive(&raw));
        assert_int_equal(raw.envelope.id, second);
    }
}

/* If it failed, a submit without a ring would touch memory that is not there. */
CASE_WITH(slot__without_a_ring_is_refused, open_raw, close_raw)
{
    test_raw_close(&raw);
    test_witness_open_raw(&raw, 0);
    assert_ok(test_raw_scene(&raw, "", &scene));
    assert_int_equal(submit(0, 2, 1), PCCD_E_STATE);
    test_witness_turn();
}

static atomic_bool keep_writing;

/* Publish slot 0 again and again, as a client that does not wait for its answers
 * would. */
static void *write_for_ever(void *context)
{
    struct proto_slot *slot = context;
    uint64_t seq = atomic_load(&slot->seq);

    while (atomic_load(&keep_writing)) {
        atomic_store(&slot->seq, seq + 1);
        atomic_store(&slot->seq, seq); /* the same number: most submits find it */
    }
    return NULL;
}

/* If it failed, a step would be computed from a mixture of two. */
CASE_WITH(slot__torn_while_it_is_read_is_refused, open_raw, close_raw)
{
    struct pccd_client *client = test_witness.crossing.client;
    uint64_t torn_before = test_stat(client, "slots_torn");
    struct proto_slot *slot = &test_raw_upload(&raw)->slots[0];
    uint64_t seq = write_good_step();
    uint64_t torn = 0;
    uint64_t until_ms = test_now_ms() + 10000;
    pthread_t writer;

    atomic_store(&keep_writing, true);
    assert_int_equal(pthread_create(&writer, NULL, write_for_ever, slot), 0);
    for (int i = 0; (i < 300 || torn == 0) && test_now_ms() < until_ms; i++) {
        int status = submit(0, seq, 1);

        if (status != 0 && status != PCCD_E_SLOT_STALE && status != PCCD_E_SLOT_TORN) {
            fail_msg("error %d \"%s\"", status, raw.error.text);
        }
        torn += status == PCCD_E_SLOT_TORN;
        if (i % 50 == 0) {
            test_witness_turn();
        }
    }
    atomic_store(&keep_writing, false);
    assert_int_equal(pthread_join(writer, NULL), 0);
    assert_true(torn > 0);
    assert_int_equal(test_stat(client, "slots_torn"), torn_before + torn);
    expect_good_step();
}

/* ---- segment tables ---------------------------------------------------------------- */

#define X1    PROTO_SEGMENT_X1
#define X0X1  PROTO_SEGMENT_X0X1
#define RIGID PROTO_SEGMENT_RIGID
#define GOOD  1u /* stands for the object's handle */
#define GONE  2u /* for the removed object's */

/* One-segment tables that lie. Positions may begin at byte 32; the slot ends at 65536. */
static const struct {
    const char *what;
    struct proto_segment segment;
    int code;
} lies[] = {
    {"no vertices", {GOOD, X1, 0, 0, 0, 0, 32}, PCCD_E_SEGMENT},
    {"an unknown kind", {GOOD, 4, 0, 0, 3, 0, 32}, PCCD_E_SEGMENT},
    {"a kind far away", {GOOD, 0xffff, 0, 0, 3, 0, 32}, PCCD_E_SEGMENT},
    {"an unknown format", {GOOD, X1, 2, 0, 3, 0, 32}, PCCD_E_SEGMENT},
    {"a rigid segment in float", {GOOD, RIGID, 0, 0, 3, 32, 128}, PCCD_E_SEGMENT},
    {"positions inside the table", {GOOD, X1, 0, 0, 3, 0, 0}, PCCD_E_SEGMENT},
    {"positions that begin in the table", {GOOD, X1, 0, 0, 3, 0, 24}, PCCD_E_SEGMENT},
    {"an offset that is not a multiple of 8", {GOOD, X1, 0, 0, 3, 0, 36}, PCCD_E_SEGMENT},
    {"positions that end behind the slot", {GOOD, X1, 0, 0, 3, 0, 65504}, PCCD_E_SEGMENT},
    {"positions behind the slot", {GOOD, X1, 0, 0, 3, 0, 65536}, PCCD_E_SEGMENT},
    {"positions in the next slot", {GOOD, X1, 0, 0, 3, 0, 65568}, PCCD_E_SEGMENT},
    {"an offset that overflows", {GOOD, X1, 0, 0, 3, 0, UINT64_MAX - 7}, PCCD_E_SEGMENT},
    {"a negative offset", {GOOD, X1, 0, 0, 3, 0, (uint64_t)-65536}, PCCD_E_SEGMENT},
    {"a start where none belongs", {GOOD, X1, 0, 0, 3, 64, 32}, PCCD_E_SEGMENT},
    {"a start inside the table", {GOOD, X0X1, 0, 0, 3, 0, 72}, PCCD_E_SEGMENT},
    {"a start behind the slot", {GOOD, X0X1, 0, 0, 3, 1u << 20, 72}, PCCD_E_SEGMENT},
    {"a transform behind the slot",
     {GOOD, RIGID, 1, 0, 3, 32, 65536 - 88},
     PCCD_E_SEGMENT},
    {"2^32-1 vertices", {GOOD, X1, 1, 0, UINT32_MAX, 0, 32}, PCCD_E_SEGMENT},
    {"more vertices than the object has", {GOOD, X1, 0, 0, 4, 0, 32}, PCCD_E_SEGMENT},
    {"a first vertex beyond the object", {GOOD, X1, 0, 3, 1, 0, 32}, PCCD_E_SEGMENT},
    {"a range that wraps", {GOOD, X1, 0, UINT32_MAX, 2, 0, 32}, PCCD_E_SEGMENT},
    {"a rigid range beyond the object", {GOOD, RIGID, 1, 0, 4, 32, 128}, PCCD_E_SEGMENT},
    {"no object", {0, X1, 0, 0, 3, 0, 32}, PCCD_E_HANDLE},
    {"an object far away", {0xffffffffu, X1, 0, 0, 3, 0, 32}, PCCD_E_HANDLE},
    {"an object that was removed", {GONE, X1, 0, 0, 3, 0, 32}, PCCD_E_HANDLE},
};

/* If it failed, the daemon would read beyond the slot, or move what it should not. */
CASE_WITH(segment__lies_are_refused_one_by_one, open_raw, close_raw)
{
    for (size_t i = 0; i < sizeof lies / sizeof lies[0]; i++) {
        struct proto_segment segment = lies[i].segment;
        int status;

        segment.object = segment.object == GOOD   ? object
                         : segment.object == GONE ? removed
                                                  : segment.object;
        memcpy(test_raw_payload(&raw, 0), &segment, sizeof segment);
        status = submit(0, test_raw_publish(&raw, 0), 1);
        if (status != lies[i].code || raw.error.fatal || raw.error.text[0] == '\0') {
            fail_msg("%s: status %d \"%s\"", lies[i].what, status, raw.error.text);
        }
        test_witness_turn();
    }
    expect_good_step();
}

/* If it failed, one vertex could be written twice in a step, with either result. */
CASE_WITH(segment__overlaps_are_refused, open_raw, close_raw)
{
    static const uint32_t ranges[][4] = {{0, 3, 0, 3}, {0, 2, 1, 2}, {2, 1, 0, 3}};

    assert_ok(test_raw_scene(&raw, "held", &scene)); /* so that frames can be */
    assert_ok(test_raw_add(&raw, scene, mesh, &object));
    struct proto_FRAME_SUBMIT_request held = {
        .scene = scene, .segments = 2, .hold = true};
    for (size_t i = 0; i < sizeof ranges / sizeof ranges[0]; i++) {
        struct proto_segment table[2] = {
            {object, X1, 0, ranges[i][0], ranges[i][1], 0, 64},
            {object, X1, 0, ranges[i][2], ranges[i][3], 0, 64}};

        memcpy(test_raw_payload(&raw, 0), table, sizeof table);
        memcpy(test_raw_payload(&raw, 0) + 64, test_triangle_x, sizeof test_triangle_x);
        assert_int_equal(submit(0, test_raw_publish(&raw, 0), 2), PCCD_E_SEGMENT);
        /* At once, before a step that it would spoil. */
        held.seq = test_raw_publish(&raw, 0);
        assert_int_equal(test_raw_call(&raw, PROTO_METHOD_FRAME_SUBMIT, &held, NULL),
                         PCCD_E_SEGMENT);
    }
    /* Side by side is no overlap. */
    struct proto_segment table[2] = {{object, X1, 0, 0, 2, 0, 64},
                                     {object, X1, 0, 2, 1, 0, 64}};

    memcpy(test_raw_payload(&raw, 0), table, sizeof table);
    assert_int_equal(submit(0, test_raw_publish(&raw, 0), 2), 0);
}

/* If it failed, a table longer than its slot would be read. */
CASE_WITH(segment__count_is_bounded, open_raw, close_raw)
{
    uint64_t seq = write_good_step();

    assert_int_equal(submit(0, seq, 65537), PCCD_E_LIMIT);
    assert_int_equal(submit(0, seq, UINT32_MAX), PCCD_E_LIMIT);
    assert_int_equal(submit(0, seq, 65536), PCCD_E_SEGMENT);
    assert_int_equal(submit(0, seq, SLOT_BYTES / 32 + 1), PCCD_E_SEGMENT);
    expect_good_step();
}

/* ---- positions --------------------------------------------------------------------- */

/* If it failed, a position without meaning would get into the scene and stay there. */
CASE_WITH(positions__that_are_not_finite_are_refused, open_raw, close_raw)
{
    static const double bad[] = {NAN, INFINITY, -INFINITY, 1.1e18, -1e300};
    uint8_t *payload = test_raw_payload(&raw, 0);

    for (uint32_t at = 0; at < 9 * 5; at++) {
        double x[9] = {0, 0, 1, 1, 0, 1, 0, 1, 1};
        struct proto_segment segment = {object, X1, 1, 0, 3, 0, 32};

        x[at % 9] = bad[at / 9];
        memcpy(payload, &segment, sizeof segment);
        memcpy(payload + 32, x, sizeof x);
        assert_int_equal(submit(0, test_raw_publish(&raw, 0), 1), PCCD_E_NOTFINITE);
        segment = (struct proto_segment){object, X0X1, 1, 0, 3, 32, 104};
        memcpy(payload, &segment, sizeof segment);
        memcpy(payload + 104, test_triangle_x, sizeof test_triangle_x);
        assert_int_equal(submit(0, test_raw_publish(&raw, 0), 1), PCCD_E_NOTFINITE);
    }
    for (uint32_t at = 0; at < 12 * 5; at++) {
        struct proto_segment segment = {object, RIGID, 1, 0, 3, 32, 128};
        double m[2][12] = {{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0},
                           {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}};

        m[at % 2][at % 12] = bad[at / 12];
        memcpy(payload, &segment, sizeof segment);
        memcpy(payload + 32, m, sizeof m);
        assert_int_equal(submit(0, test_raw_publish(&raw, 0), 1), PCCD_E_NOTFINITE);
    }
    test_witness_turn();
    expect_good_step();
}

/* ---- meshes ------------------------------------------------------------------------ */

static int send_chunk(uint32_t handle, uint32_t part, uint32_t first, uint32_t count)
{
    return RAW_CALL(&raw, MESH_DATA, NULL, .mesh = handle,
                    .seq = test_raw_publish(&raw, 0), .part = part, .first = first,
                    .count = count);
}

static int create_mesh(uint32_t vertex_count, struct proto_MESH_CREATE_result *created)
{
    return RAW_CALL(&raw, MESH_CREATE, created, .vertex_count = vertex_count,
                    .triangle_count = 2);
}

static int commit(uint32_t handle)
{
    return RAW_CALL(&raw, MESH_COMMIT, NULL, .mesh = handle);
}

/* If it failed, a mesh could name vertices that are not there, or be used half-made. */
CASE_WITH(mesh__chunks_that_do_not_fit_are_refused, open_raw, close_raw)
{
    struct proto_MESH_CREATE_result created;
    uint32_t *triangles = (uint32_t *)(void *)test_raw_payload(&raw, 0);
    uint32_t handle;

    memset(triangles, 0, SLOT_BYTES);
    assert_ok(create_mesh(20000, &created));
    handle = created.mesh;
    assert_int_equal(send_chunk(handle, 0, 0, 0), PCCD_E_INVAL);
    assert_int_equal(send_chunk(handle, 0, 0, SLOT_BYTES / 12 + 1), PCCD_E_INVAL);
    assert_int_equal(send_chunk(handle, 0, 19999, 2), PCCD_E_INVAL);
    assert_int_equal(send_chunk(handle, 0, UINT32_MAX, 2), PCCD_E_INVAL);
    assert_int_equal(send_chunk(handle, 3, 0, 1), PCCD_E_INVAL);
    assert_int_equal(send_chunk(handle, 2, 19999, 2), PCCD_E_INVAL); /* radii */
    assert_int_equal(send_chunk(handle, 2, 0, SLOT_BYTES / 8 + 1), PCCD_E_INVAL);
    assert_int_equal(send_chunk(handle, 0, 5, 1), PCCD_E_STATE); /* leaves a gap */
    assert_int_equal(send_chunk(handle + 77, 0, 0, 1), PCCD_E_HANDLE);
    for (uint32_t first = 0; first < 20000; first += 5000) {
        assert_ok(send_chunk(handle, 0, first, 5000));
    }
    assert_int_equal(commit(handle), PCCD_E_STATE);
    assert_int_equal(test_raw_add(&raw, scene, handle, &object), PCCD_E_STATE);
    triangles[5] = 20000;
    assert_int_equal(send_chunk(handle, 1, 0, 2), PCCD_E_INDEX);
    triangles[5] = UINT32_MAX;
    assert_int_equal(send_chunk(handle, 1, 0, 2), PCCD_E_INDEX);
    triangles[5] = 19999;
    assert_ok(send_chunk(handle, 1, 0, 2));
    assert_ok(commit(handle));
    assert_int_equal(commit(handle), PCCD_E_STATE);
    assert_int_equal(send_chunk(handle, 1, 0, 2), PCCD_E_STATE);
    test_witness_turn();
    assert_ok(test_raw_add(&raw, scene, handle, &object));
    assert_int_equal(create_mesh(0, &created), PCCD_E_INVAL);
    assert_int_equal(create_mesh(UINT32_MAX, &created), PCCD_E_INVAL);
    if (!test_is_direct()) { /* where some machines have the memory */
        /* Legal, but beyond any quota. */
        assert_int_equal(create_mesh(INT32_MAX, &created), PCCD_E_QUOTA);
    }
}

/* ---- the memory itself ------------------------------------------------------------- */

/* If it failed, the daemon would believe what clients write into its words. */
CASE_WITH(memory__scribbled_headers_and_counters_do_not_matter, open_raw, close_raw)
{
    struct proto_upload *upload = test_raw_upload(&raw);

    for (int round = 0; round < 8; round++) {
        memset(&upload->header, round % 2 == 0 ? 0xff : 0, sizeof upload->header);
        atomic_store(&upload->head.value, UINT64_MAX - (uint64_t)round);
        atomic_store(&upload->tail.value, (uint64_t)round << 60);
        atomic_store(&upload->done_seq.value, UINT64_MAX);
        atomic_store(&upload->client_wait.value, UINT64_MAX);
        expect_good_step();
    }
    test_witness_turn();
}

/* If it failed, a wrong result_head would make the daemon write over its own pages or
 * beyond the region. */
CASE_WITH(memory__wrong_result_head_is_refused, open_raw, close_raw)
{
    static const uint64_t wrong[] = {1u << 20, UINT64_MAX, UINT64_MAX / 2, 1};
    struct proto_MESH_EDGES_result result;
    struct proto_upload *upload = test_raw_upload(&raw);

    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        atomic_store(&upload->result_head.value, wrong[i]);
        assert_int_equal(RAW_CALL(&raw, MESH_EDGES, &result, .mesh = mesh, .count = 3),
                         PCCD_E_INVAL);
        test_witness_turn();
    }
    atomic_store(&upload->result_head.value, 0);
    assert_ok(RAW_CALL(&raw, MESH_EDGES, &result, .mesh = mesh, .count = 3));
    assert_int_equal(result.count, 3);
    assert_true(result.offset >= PROTO_SHM_PAGE);
    expect_good_step();
}

/* If it failed, a client could write into its answers, or take memory from under the
 * daemon, which would die of it. */
CASE_WITH(memory__cannot_be_shrunk_or_written_where_it_must_not, open_raw, close_raw)
{
    struct proto_upload *upload = test_raw_upload(&raw);

    assert_ptr_equal(mmap(NULL, raw.result.bytes, PROT_READ | PROT_WRITE, MAP_SHARED,
                          raw.result.fd, 0),
                     MAP_FAILED);
    assert_int_equal(pwrite(raw.result.fd, "x", 1, 4096), -1);
    assert_int_equal(ftruncate(raw.result.fd, 0), -1);
    assert_int_equal(ftruncate(raw.upload.fd, 4096), -1);
    assert_int_equal(ftruncate(raw.upload.fd, 1 << 30), -1);
    assert_int_equal(fcntl(raw.upload.fd, F_ADD_SEALS, F_SEAL_WRITE), -1);
    /* A hole reads as zeros: the slot is stale then, and nothing worse. */
    assert_ok(fallocate(raw.upload.fd, FALLOC_FL_PUNCH_HOLE | FALLOC_FL_KEEP_SIZE, 0,
                        (off_t)raw.upload.bytes));
    assert_int_equal(atomic_load(&upload->slots[0].seq), 0);
    assert_int_equal(submit(0, 2, 1), PCCD_E_SLOT_STALE);
    test_witness_turn();
    expect_good_step();
}

/* If it failed, sizes that no machine has would be tried, or tiny ones be written
 * over. */
CASE_WITH(memory__rings_of_impossible_sizes_are_refused, open_raw, close_raw)
{
    static const struct {
        struct proto_SHM_ATTACH_request request;
        int code;
    } rings[] = {
        {{.slot_count = 0, .slot_bytes = 65536, .result_bytes = 65536}, PCCD_E_INVAL},
        {{.slot_count = 17, .slot_bytes = 65536, .result_bytes = 65536}, PCCD_E_INVAL},
        {{.slot_count = 2, .slot_bytes = 4095, .result_bytes = 65536}, PCCD_E_INVAL},
        {{.slot_count = 2, .slot_bytes = 65536, .result_bytes = 65535}, PCCD_E_INVAL},
        {{.slot_count = 16, .slot_bytes = 1ull << 40, .result_bytes = 65536},
         PCCD_E_QUOTA}, /* in a process, half the machine's */
        {{.slot_count = 1, .slot_bytes = 65536, .result_bytes = 1ull << 40},
         PCCD_E_QUOTA},
        {{.slot_count = 16, .slot_bytes = UINT64_MAX, .result_bytes = 65536},
         PCCD_E_LIMIT},
        {{.slot_count = 1, .slot_bytes = 65536, .result_bytes = UINT64_MAX},
         PCCD_E_LIMIT},
        {{.slot_count = 1, .slot_bytes = UINT64_MAX - 4095, .result_bytes = 65536},
         PCCD_E_LIMIT},
    };
    uint64_t bytes = test_stat(test_witness.crossing.client, "shm_bytes_now");

    for (size_t i = 0; i < sizeof rings / sizeof rings[0]; i++) {
        assert_int_equal(
            test_raw_call(&raw, PROTO_METHOD_SHM_ATTACH, &rings[i].request, NULL),
            rings[i].code);
        assert_int_equal(test_stat(test_witness.crossing.client, "shm_bytes_now"), bytes);
    }
    expect_good_step(); /* the ring that was there is still the ring */
}

static int take(uint32_t slot)
{
    return RAW_CALL(&raw, SHM_TAKE, NULL, .slot = slot);
}

/* If it failed, the daemon would read, and so fill, memory that nobody is charged for; or
 * a client that says a slot is free, and lies, would harm anybody else. */
CASE_WITH(slot__without_memory_is_refused, open_raw, close_raw)
{
    _Atomic uint64_t *memory = &test_raw_upload(&raw)->slots[1].memory;

    assert_int_equal(take(2), PCCD_E_INVAL); /* there are two slots */
    assert_int_equal(take(1), 0);            /* it has memory */
    expect_good_step();
    if (test_is_direct()) {
        return; /* nobody there to give memory back while nobody calls */
    }
    atomic_store(&test_raw_upload(&raw)->slots[0].memory, PROTO_SLOT_FREE);
    atomic_store(memory, PROTO_SLOT_FREE);
    for (int i = 0; i < 1000 && atomic_load(memory) != PROTO_SLOT_EMPTY; i++) {
        test_sleep_ms(10);
    }
    assert_int_equal(atomic_load(memory), PROTO_SLOT_EMPTY);
    assert_int_equal(submit(1, 2, 1), PCCD_E_STATE);
    atomic_store(memory, PROTO_SLOT_NEEDED); /* a lie */
    assert_int_equal(submit(1, 2, 1), PCCD_E_STATE);
    assert_false(raw.error.fatal);
    expect_good_step(); /* one slot keeps its memory */
    assert_int_equal(take(1), 0);
    assert_int_equal(atomic_load(memory), PROTO_SLOT_NEEDED);
    assert_int_equal(submit(1, 2, 1), PCCD_E_SLOT_STALE);
    expect_good_step();
}

CASES_WITH(test_witness_start, test_witness_stop);
