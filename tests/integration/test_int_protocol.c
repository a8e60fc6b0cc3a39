/* test_int_protocol.c - sentences of PROTOCOL.md, held against a real daemon. */
#include "cases.h"
#include "fixture.h"
#include "prng.h"
#include "raw.h"

#define SLOT_BYTES 65536u
#define MIB        (1u << 20)
#define SCENES_MAX 64u

static struct test_raw raw;
static uint32_t scene, objects[2];

static void call(int method, const void *request, void *result)
{
    int status = test_raw_call(&raw, method, request, result);
    if (status != 0) {
        print_error("%s: %s\n", proto_messages[method].name, raw.error.text);
    }
    assert_int_equal(status, 0);
}

/* Refused, by a sentence that names what was wrong, and the session goes on. */
static void refused(int status, int code, const char *word)
{
    struct proto_PING_result pong;
    assert_int_equal(status, code);
    assert_false(raw.error.fatal);
    if (strstr(raw.error.text, word) == NULL) {
        fail_msg("\"%s\" does not say %s", raw.error.text, word);
    }
    assert_ok(RAW_CALL(&raw, PING, &pong, .token = 77));
    assert_int_equal(pong.token, 77);
}

static int open_raw(void **state)
{
    (void)state;
    return test_raw_open(&raw, test_shared.socket) ? 0 : -1;
}

static int close_raw(void **state)
{
    (void)state;
    test_raw_close(&raw);
    return 0;
}

/* A scene of that name ("": of this session alone), and two objects: a large triangle at
 * height 0, and a small one. */
static void make_scene_with(const char *name, const float (*small)[3])
{
    struct test_raw_crossing made;
    assert_ok(test_raw_hello(&raw));
    assert_ok(test_raw_attach(&raw, 2, SLOT_BYTES));
    assert_ok(test_raw_build(&raw, name, small, &made));
    scene = made.scene;
    objects[0] = made.floor;
    objects[1] = made.object;
}

/* The small one at height 1. */
static void make_scene(const char *name)
{
    make_scene_with(name, test_triangle_x);
}

/* ---- hello ------------------------------------------------------------------------- */

/* If it failed, a client that mixes up its two versions would be told that there is no
 * common one, and be dropped, or one that says hello twice would lose its session. */
CASE_WITH(hello__upside_down_or_twice_is_refused_and_nothing_is_lost, open_raw, close_raw)
{
    refused(RAW_CALL(&raw, HELLO, NULL, .version_min = 2, .version_max = 1), PCCD_E_INVAL,
            "version_min 2");
    make_scene("");
    refused(RAW_CALL(&raw, HELLO, NULL, .version_min = 1, .version_max = 1), PCCD_E_STATE,
            "already");
    assert_ok(RAW_CALL(&raw, SCENE_DESTROY, NULL, .scene = scene));
}

/* ---- statuses ---------------------------------------------------------------------- */

static int attach(struct proto_SCENE_CREATE_result *result)
{
    return RAW_CALL(&raw, SCENE_CREATE, result, .name = "later",
                    .share = PCCD_SHARE_ATTACH);
}

static int announce(uint32_t want, uint32_t *made)
{
    struct proto_MESH_CREATE_result result = {.mesh = 0};
    int status = RAW_CALL(&raw, MESH_CREATE, &result, .vertex_count = 3,
                          .triangle_count = 1, .want = want);
    *made = result.mesh;
    return status;
}

/* If it failed, who waits for another session's scene could not tell that from a mistake
 * of its own. */
CASE_WITH(status__a_shared_scene_that_is_not_there_is_again, open_raw, close_raw)
{
    struct proto_SCENE_CREATE_result result;
    struct test_raw other;
    assert_ok(test_raw_hello(&raw));
    refused(attach(&result), PCCD_E_AGAIN, "later");
    assert_ok(test_raw_session(&other, test_shared.socket, 0, 0));
    assert_ok(test_raw_scene(&other, "later", &scene));
    assert_ok(attach(&result));
    assert_true(result.existed);
    test_raw_close(&other);
}

/* If it failed, a method would need the shared memory, or not, against what is said. */
CASE_WITH(status__what_needs_the_ring_is_refused_before_it, open_raw, close_raw)
{
    uint32_t mesh;
    assert_ok(test_raw_hello(&raw));
    assert_ok(test_raw_scene(&raw, "", &scene));
    assert_ok(announce(0, &mesh));
#define NEEDS_RING(METHOD, ...)                                                          \
    refused(RAW_CALL(&raw, METHOD, NULL, __VA_ARGS__), PCCD_E_STATE, "shm.attach")
    NEEDS_RING(MESH_DATA, .mesh = mesh, .seq = 2, .count = 3);
    NEEDS_RING(MESH_EDGES, .mesh = mesh, .count = 1);
    NEEDS_RING(FRAME_SUBMIT, .scene = scene);
    NEEDS_RING(FRAME_FETCH, .scene = scene);
    NEEDS_RING(SCENE_BOXES, .scene = scene, .count = 1);
    refused(RAW_CALL(&raw, TRACE_DUMP, NULL, .count = 1), PCCD_E_STATE, "");
}

/* If it failed, who brings handles back to another daemon would not learn why one cannot
 * be had, or what a scene may have would be said to be something else. */
CASE_WITH(status__a_handle_that_cannot_be_had_says_why, open_raw, close_raw)
{
    uint32_t mesh, other;
    assert_ok(test_raw_hello(&raw));
    assert_ok(announce(0, &mesh));
    refused(announce(mesh, &other), PCCD_E_HANDLE, "place is taken");
    refused(announce(7, &other), PCCD_E_HANDLE, "no such handle"); /* of no generation */
    assert_ok(announce(mesh + 3000, &other));
    assert_int_equal(other, mesh + 3000);
    if (test_is_direct()) {
        return; /* has no options, so as many scenes as there may be */
    }
    for (uint32_t i = 0; i < SCENES_MAX; i++) {
        assert_ok(test_raw_scene(&raw, "", &scene));
    }
    refused(test_raw_scene(&raw, "", &scene), PCCD_E_LIMIT,
            "another scene: there are 64");
}

/* ---- fields that are not needed ---------------------------------------------------- */

/* If it failed, a client would take a counter that is left out for one that the daemon
 * does not have, or wait for one in vain. */
CASE_WITH(stats__leave_out_what_is_zero_and_not_needed, open_raw, close_raw)
{
    const struct proto_fields *fields = &proto_messages[PROTO_METHOD_STATS].result;
    struct proto_STATS_result result;
    uint32_t zeros = 0;
    uint32_t absent = 0;
    assert_ok(test_raw_hello(&raw));
    memset(raw.message, 0, sizeof raw.message); /* nothing of older messages */
    assert_ok(RAW_CALL(&raw, STATS, &result, .reserved = 0));
    for (uint32_t i = 0; i < fields->count; i++) {
        const struct proto_field *field = &fields->items[i];
        uint64_t value = 1; /* of `cpu`, which is never empty */
        uint8_t name[64] = {(uint8_t)(0xa0 | field->name_bytes)}; /* a short string */
        if (field->type == PROTO_TYPE_u64) {
            memcpy(&value, (const char *)&result + field->offset, sizeof value);
        }
        memcpy(name + 1, field->name, field->name_bytes);
        bool is_there =
            memmem(raw.message, sizeof raw.message, name, field->name_bytes + 1u) != NULL;
        assert_int_equal(is_there, field->need == PROTO_NEED_REQ || value != 0);
        zeros += value == 0 && is_there;
        absent += !is_there;
    }
    assert_true(zeros > 0 && absent > 0);
}

/* ---- what is computed -------------------------------------------------------------- */

static uint64_t done_seq(void)
{
    return atomic_load(&test_raw_upload(&raw)->done_seq.value);
}

/* If it failed, a client that watches done_seq would not see that the answer has come,
 * or would count on it where nothing is computed. */
CASE_WITH(done_seq__counts_lists_of_pairs_and_no_other_lists, open_raw, close_raw)
{
    struct proto_LIST_PAIR_result told;
    struct proto_LIST_OBJECT_result listed;
    uint64_t before = 0;
    make_scene("");
    assert_ok(RAW_CALL(&raw, SCENE_IGNORE, NULL, .scene = scene, .a = objects[0],
                       .b = objects[1], .ignored = true));
    before = done_seq();
    assert_ok(RAW_CALL(&raw, LIST_PAIR, &told, .scene = scene));
    assert_true(told.a == objects[0] && told.b == objects[1]);
    assert_int_equal(done_seq(), before + 1);
    assert_ok(RAW_CALL(&raw, LIST_OBJECT, &listed, .scene = scene));
    assert_int_equal(listed.object, objects[0]);
    assert_int_equal(done_seq(), before + 1);
}

/* ---- answers ----------------------------------------------------------------------- */

/* The small triangle goes from height z0 to z1, which is through the floor or not. */
static void fall(float z0, float z1, uint32_t mode,
                 struct proto_FRAME_SUBMIT_result *answer)
{
    const struct proto_segment segment = {
        .object = objects[1], .kind = 1, .count = 3, .offset0 = 32, .offset1 = 72};
    struct proto_FRAME_SUBMIT_request submit = {
        .scene = scene, .segments = 1, .mode = mode};
    uint8_t *payload = test_raw_payload(&raw, 0);
    float x[3][3];
    memcpy(payload, &segment, sizeof segment);
    test_crossing_positions(x, z0);
    memcpy(payload + 32, x, sizeof x);
    test_crossing_positions(x, z1);
    memcpy(payload + 72, x, sizeof x);
    submit.seq = test_raw_publish(&raw, 0);
    call(PROTO_METHOD_FRAME_SUBMIT, &submit, answer);
    assert_int_equal(answer->mode, mode);
    assert_int_equal(answer->incomplete, 0);
    assert_int_equal(answer->total, answer->vf + answer->ee);
    test_raw_release(&raw, answer->release);
}

/* If it failed, a client would read a verdict or a time that the mode does not give. */
CASE_WITH(answer__fields_outside_their_mode_are_as_said, open_raw, close_raw)
{
    struct proto_FRAME_SUBMIT_result answer;
    make_scene("");
    for (uint32_t mode = PCCD_MODE_ALL; mode < PCCD_MODE_COUNT; mode++) {
        bool has_contacts = mode != PCCD_MODE_ANY && mode != PCCD_MODE_PAIRS;
        uint64_t count = mode == PCCD_MODE_FIRST_PER_PAIR ? 1 : 3;
        fall(1, -1, mode, &answer);
        assert_int_equal(answer.verdict,
                         mode == PCCD_MODE_ANY ? PCCD_VERDICT_YES : PCCD_VERDICT_NONE);
        assert_int_equal(answer.vf, mode == PCCD_MODE_ANY ? 0 : count);
        assert_int_equal(answer.record_bytes, mode == PCCD_MODE_PAIRS ? 20 : 64);
        assert_true(has_contacts ? answer.toi_first <= 0.5 && answer.toi_first > 0.499999
                                 : answer.toi_first == 2);
        assert_int_equal(answer.possible, 0);
        fall(0, -1, mode, &answer);
        assert_int_equal(answer.initial, has_contacts ? count : 0);
        fall(1, 2, mode, &answer);
        assert_int_equal(answer.verdict,
                         mode == PCCD_MODE_ANY ? PCCD_VERDICT_NO : PCCD_VERDICT_NONE);
        assert_true(answer.toi_first == 2);
        assert_int_equal(answer.total + answer.vf + answer.ee + answer.initial, 0);
    }
}

/* ---- the journal ------------------------------------------------------------------- */

static void journal(uint64_t begin, struct proto_SCENE_JOURNAL_result *page)
{
    assert_ok(RAW_CALL(&raw, SCENE_JOURNAL, page, .scene = scene, .begin = begin));
}

static uint32_t u32_at(const uint8_t *at)
{
    uint32_t value;
    memcpy(&value, at, sizeof value);
    return value;
}

static uint64_t u64_at(const uint8_t *at)
{
    uint64_t value;
    memcpy(&value, at, sizeof value);
    return value;
}

/* The next entry of a page, whose request, *request, is of that method; *at goes behind
 * it. Returns its payload. */
static const uint8_t *entry_at(const uint8_t **at, int method, void *request)
{
    const uint8_t *entry = *at;
    const uint8_t *payload = NULL;
    assert_int_equal(u64_at(entry) % 8, 0);
    assert_int_equal(u32_at(entry + 0x0c), 0);
    assert_int_equal(test_raw_entry(&raw, at, request, &payload), method);
    assert_ptr_equal(payload, entry + (0x10 + u32_at(entry + 0x08) + 7) / 8 * 8);
    assert_ptr_equal(*at, entry + u64_at(entry));
    return payload;
}

/* Check that an entry for the small triangle, made of test_triangle_x, is as the document
 * says. */
static void check_object(const uint8_t *payload, const uint8_t *end)
{
    double x[3];
    assert_int_equal(end - payload, 0x18 + 3 * 24 + 12 + 4); /* the last are zeros */
    assert_int_equal(u32_at(payload), 3);
    assert_int_equal(u32_at(payload + 0x04), 0); /* radii */
    assert_int_equal(u32_at(payload + 0x08), 1);
    assert_int_equal(u64_at(payload + 0x0c), 0); /* edges, points */
    memcpy(x, payload + 0x18 + 24, sizeof x);
    assert_true(x[0] == 1 && x[1] == 0 && x[2] == 1);
    assert_int_equal(u32_at(payload + 0x18 + 3 * 24 + 4), 1);
}

/* The small triangle went from height 1 to -1. */
static void check_step(const struct proto_FRAME_SUBMIT_request *submit,
                       const uint8_t *slot)
{
    float z;
    assert_int_equal(submit->mode, PCCD_MODE_ANY);
    assert_int_equal(submit->segments, 1);
    assert_int_equal(submit->tuning[0], 0);
    assert_int_equal(u32_at(slot), objects[1]);
    assert_int_equal(u32_at(slot + 0x04), PROTO_SEGMENT_X0X1); /* floats */
    memcpy(&z, slot + u64_at(slot + 0x10) + 8, sizeof z);
    assert_true(z == 1);
    memcpy(&z, slot + u64_at(slot + 0x18) + 8, sizeof z);
    assert_true(z == -1);
}

/* If it failed, a reader that was written by the document would take a journal apart at
 * the wrong bytes. */
CASE_WITH(journal__is_laid_out_as_the_document_says, open_raw, close_raw)
{
    struct proto_SCENE_JOURNAL_result page;
    struct proto_FRAME_SUBMIT_result answer;
    struct proto_OBJECT_SET_request set = {.what = 7, .group = 5, .mask = 6};
    struct proto_SCENE_IGNORE_request ignore = {.ignored = true};
    union {
        struct proto_SCENE_ADD_request add;
        struct proto_FRAME_SUBMIT_request submit;
        struct proto_OBJECT_SET_request set;
        struct proto_SCENE_IGNORE_request ignore;
        struct proto_SCENE_REMOVE_request remove;
    } told;
    make_scene("journal");
    set.scene = ignore.scene = scene;
    set.object = ignore.a = objects[1];
    ignore.b = objects[0];
    journal(MIB, &page);
    fall(1, -1, PCCD_MODE_ANY, &answer);
    call(PROTO_METHOD_OBJECT_SET, &set, NULL);
    call(PROTO_METHOD_SCENE_IGNORE, &ignore, NULL);
    assert_ok(RAW_CALL(&raw, SCENE_REMOVE, NULL, .scene = scene, .object = objects[1]));
    journal(0, &page);
    const uint8_t *at = (const uint8_t *)raw.result.base + page.offset;
    const uint8_t *end = at + page.count;
    (void)entry_at(&at, PROTO_METHOD_SCENE_ADD, &told.add);
    assert_int_equal(told.add.want, objects[0]);
    const uint8_t *shape = entry_at(&at, PROTO_METHOD_SCENE_ADD, &told.add);
    assert_int_equal(told.add.want, objects[1]);
    check_object(shape, at);
    const uint8_t *slot = entry_at(&at, PROTO_METHOD_FRAME_SUBMIT, &told.submit);
    check_step(&told.submit, slot);
    (void)entry_at(&at, PROTO_METHOD_OBJECT_SET, &told.set);
    assert_memory_equal(&told.set, &set, sizeof set);
    (void)entry_at(&at, PROTO_METHOD_SCENE_IGNORE, &told.ignore);
    assert_memory_equal(&told.ignore, &ignore, sizeof ignore);
    (void)entry_at(&at, PROTO_METHOD_SCENE_REMOVE, &told.remove);
    assert_int_equal(told.remove.scene, scene);
    assert_int_equal(told.remove.object, objects[1]);
    assert_ptr_equal(at, end);
}

/* ---- rigid segments ---------------------------------------------------------------- */

/* Registered: numbers whose products are rounded. */
static const float rest_x[3][3] = {
    {.1f, .7f, 1.3f}, {-.3f, 1.1f, .9f}, {2.3f, -.6f, .7f}};

/* A coordinate by the sentence of the document: x' = ((r0 x + r1 y) + r2 z) + t, each
 * operation rounded once; volatile, so that none is fused with another. */
static double transformed(const double row[4], const float x[3])
{
    volatile double a = row[0] * (double)x[0];
    volatile double b = row[1] * (double)x[1];
    volatile double c = row[2] * (double)x[2];
    volatile double sum = a + b;
    sum = sum + c;
    return sum + row[3];
}

/* The same, where the processor multiplies and adds at once: other bits. */
static double fused(const double row[4], const float x[3])
{
    return fma(row[2], (double)x[2], fma(row[1], (double)x[1], row[0] * (double)x[0])) +
           row[3];
}

/* The vertices first .. first + count - 1 of the small triangle get a transform for each
 * end: in the slot and, as the document says it, in `expected`. */
static void write_rigid(struct prng *prng, uint32_t at, uint32_t first, uint32_t count,
                        double expected[2][3][3], uint32_t *others)
{
    const struct proto_segment segment = {.object = objects[1],
                                          .kind = 2,
                                          .format = 1,
                                          .first = first,
                                          .count = count,
                                          .offset0 = 64 + at * 192,
                                          .offset1 = 64 + at * 192 + 96};
    uint8_t *payload = test_raw_payload(&raw, 0);
    memcpy(payload + at * sizeof segment, &segment, sizeof segment);
    for (uint32_t end = 0; end < 2; end++) {
        double m[12];
        for (int i = 0; i < 12; i++) {
            m[i] = prng_between(prng, -2, 2);
        }
        memcpy(payload + segment.offset0 + 96 * end, m, sizeof m);
        for (uint32_t i = 3 * first; i < 3 * (first + count); i++) {
            const float *x = rest_x[i / 3];
            expected[end][i / 3][i % 3] = transformed(m + 4 * (i % 3), x);
            *others += expected[end][i / 3][i % 3] != fused(m + 4 * (i % 3), x);
        }
    }
}

/* The positions at both ends of the last step, of the object that it has moved: a journal
 * begins with them. */
static void read_step(double x[2][3][3])
{
    struct proto_SCENE_JOURNAL_result page;
    struct proto_FRAME_SUBMIT_request told;
    struct proto_SCENE_ADD_request add;
    struct proto_segment segment;
    journal(MIB, &page);
    const uint8_t *at = (const uint8_t *)raw.result.base + page.offset;
    (void)entry_at(&at, PROTO_METHOD_SCENE_ADD, &add);
    (void)entry_at(&at, PROTO_METHOD_SCENE_ADD, &add);
    const uint8_t *slot = entry_at(&at, PROTO_METHOD_FRAME_SUBMIT, &told);
    assert_ptr_equal(at, (const uint8_t *)raw.result.base + page.offset + page.count);
    memcpy(&segment, slot, sizeof segment);
    assert_true(told.place && told.segments == 1);
    assert_true(segment.object == objects[1] && segment.count == 3);
    memcpy(x[0], slot + segment.offset0, sizeof x[0]);
    memcpy(x[1], slot + segment.offset1, sizeof x[1]);
    test_raw_release(&raw, page.release);
    assert_ok(RAW_CALL(&raw, SCENE_JOURNAL, NULL, .scene = scene, .stop = true));
}

/* If it failed, whoever computes rigid motion by the document, as to verify an answer or
 * to place objects again, would have other bits than the daemon. */
CASE_WITH(rigid__has_the_bits_of_the_document_part_by_part, open_raw, close_raw)
{
    struct proto_FRAME_SUBMIT_request submit = {.segments = 2};
    struct proto_FRAME_SUBMIT_result answer;
    struct prng prng = {prng_seed()};
    double expected[2][3][3];
    double found[2][3][3];
    uint32_t others = 0;
    make_scene_with("rigid", rest_x);
    submit.scene = scene;
    for (int i = 0; i < 200; i++) {
        write_rigid(&prng, 0, 0, 2, expected, &others); /* the one part, and the other */
        write_rigid(&prng, 1, 2, 1, expected, &others);
        submit.seq = test_raw_publish(&raw, 0);
        call(PROTO_METHOD_FRAME_SUBMIT, &submit, &answer);
        read_step(found);
        assert_memory_equal(found, expected, sizeof found);
    }
    assert_true(others > 100); /* or the order would not show */
}

/* If it failed, vertices that a rigid segment does not name would be dragged along. */
CASE_WITH(rigid__leaves_the_rest_of_the_object_where_it_is, open_raw, close_raw)
{
    struct proto_FRAME_SUBMIT_request submit = {.segments = 1};
    struct prng prng = {prng_seed()};
    double expected[2][3][3];
    double found[2][3][3];
    uint32_t others = 0;
    make_scene_with("part", rest_x);
    submit.scene = scene;
    for (uint32_t i = 0; i < 9; i++) {
        expected[0][i / 3][i % 3] = expected[1][i / 3][i % 3] =
            (double)rest_x[i / 3][i % 3];
    }
    write_rigid(&prng, 0, 1, 1, expected, &others);
    submit.seq = test_raw_publish(&raw, 0);
    call(PROTO_METHOD_FRAME_SUBMIT, &submit, NULL);
    read_step(found);
    assert_memory_equal(found, expected, sizeof found);
}

CASES_WITH_DAEMON("--scenes-max", "64");
