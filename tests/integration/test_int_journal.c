/* test_int_journal.c - scene.journal: what is done to a shared scene. */
#include "cases.h"
#include "crossing.h"
#include "daemon.h"
#include "raw.h"

#define MIB (1ull << 20)

static struct test_daemon daemon_;
static struct test_raw raw;
static uint32_t scene, mesh, object;
static uint64_t steps;

/* A user may have 64 MiB of shared memory. */
static int setup(void **state)
{
    static const char *const options[] = {"--shm-max-mib", "64", NULL};

    (void)state;
    steps = 0;
    return test_daemon_start(&daemon_, options) &&
                   test_raw_session(&raw, daemon_.socket, 2, 65536) == 0 &&
                   test_raw_mesh(&raw, test_triangle_x, 3, test_triangle, 1, &mesh) ==
                       0 &&
                   test_raw_scene(&raw, "journal", &scene) == 0
               ? 0
               : -1;
}

static int teardown(void **state)
{
    (void)state;
    test_raw_close(&raw);
    return test_daemon_finish(&daemon_) ? 0 : -1;
}

static int ask(uint64_t cursor, uint64_t begin, bool stop,
               struct proto_SCENE_JOURNAL_result *result)
{
    return RAW_CALL(&raw, SCENE_JOURNAL, result, .scene = scene, .cursor = cursor,
                    .begin = begin, .stop = stop);
}

static void add(void)
{
    assert_ok(test_raw_add(&raw, scene, mesh, &object));
}

/* The object goes to the height z, by a step of its session. */
static void step(float z)
{
    const struct test_raw_crossing crossing = {.scene = scene, .object = object};
    struct proto_FRAME_SUBMIT_request request = test_raw_turn(&raw, 0, &crossing, z);

    request.step = ++steps;
    assert_ok(test_raw_call(&raw, PROTO_METHOD_FRAME_SUBMIT, &request, NULL));
}

static const uint8_t *page(const struct proto_SCENE_JOURNAL_result *result)
{
    return (const uint8_t *)raw.result.base + result->offset;
}

/* If it failed, a reader would be told something else than what was done. */
CASE_WITH(journal__tells_what_is_done_in_order, setup, teardown)
{
    static const int methods[] = {PROTO_METHOD_SCENE_ADD, PROTO_METHOD_FRAME_SUBMIT,
                                  PROTO_METHOD_FRAME_SUBMIT, PROTO_METHOD_SCENE_REMOVE};
    struct proto_SCENE_JOURNAL_result result, again;
    union {
        struct proto_SCENE_ADD_request add;
        struct proto_FRAME_SUBMIT_request submit;
        struct proto_SCENE_REMOVE_request gone;
    } told;
    struct proto_segment segment;
    const uint8_t *at, *payload;
    float z;

    add();
    step(-1);
    assert_ok(ask(0, MIB, false, &result)); /* object, where it is */
    assert_true(result.count > 0 && result.end == result.count && !result.full);
    step(0.5f);
    assert_ok(RAW_CALL(&raw, SCENE_REMOVE, NULL, .scene = scene, .object = object));
    assert_ok(ask(0, 0, false, &result)); /* nothing was taken: all of it */
    at = page(&result);
    for (size_t i = 0; i < sizeof methods / sizeof methods[0]; i++) {
        assert_int_equal(test_raw_entry(&raw, &at, &told, &payload), methods[i]);
        if (i == 2) { /* as it was sent: floats, of the end alone */
            memcpy(&segment, payload, sizeof segment);
            memcpy(&z, payload + segment.offset1 + 2 * sizeof z, sizeof z);
            assert_int_equal(told.submit.step, 2);
            assert_int_equal(told.submit.segments, 1);
            assert_int_equal(segment.object, object);
            assert_int_equal(segment.kind, PROTO_SEGMENT_X1);
            assert_int_equal(segment.format, PCCD_FORMAT_F32);
            assert_true(z == 0.5f);
        } else if (i != 1) {
            assert_int_equal(i == 0 ? told.add.want : told.gone.object, object);
        }
        assert_int_equal(i == 0 ? told.add.scene : told.gone.scene, scene);
    }
    assert_ptr_equal(at, page(&result) + result.count);
    /* Once more, from the middle of an entry, and the same bytes. */
    assert_ok(ask(result.end - 20, 0, false, &again));
    assert_int_equal(again.count, 20);
    assert_memory_equal(page(&again), page(&result) + result.end - 20, 20);
    assert_ok(ask(result.end, 0, false, &again));
    assert_int_equal(again.count, 0);
    assert_int_equal(ask(0, 0, false, &again), PCCD_E_INVAL); /* was forgotten */
    assert_int_equal(ask(result.end + 1, 0, false, &again), PCCD_E_INVAL);
}

/* If it failed, a journal that lacks something would look as if it were whole. */
CASE_WITH(journal__says_when_it_is_full, setup, teardown)
{
    struct proto_SCENE_JOURNAL_result result, later;

    add();
    assert_int_equal(ask(0, 64, false, &result), PCCD_E_LIMIT);
    assert_ok(ask(0, 4096, false, &result));
    for (int i = 0; i < 40; i++) {
        step(i % 2 == 0 ? -1.0f : 1.0f);
    }
    assert_ok(ask(0, 0, false, &result));
    assert_true(result.full && result.count <= 4096 && result.count > 2048);
    assert_ok(ask(result.end, 0, false, &later));
    step(1);
    assert_ok(ask(result.end, 0, false, &later));
    assert_true(later.full && later.count == 0 && later.end == result.end);
    assert_ok(ask(0, 0, true, &later));
    assert_int_equal(ask(0, 0, false, &later), PCCD_E_STATE);
    assert_ok(ask(0, 4096, false, &later));
    assert_false(later.full);
    /* To the byte: what fits is kept, and what does not is told with the same step. */
    uint64_t room = 4096, begun;
    step(-1);
    for (int i = 0; i < 3; i++) { /* ample; just enough; too little by a byte */
        assert_ok(ask(0, 0, true, &later));
        step(1);
        assert_ok(ask(0, room, false, &later));
        begun = later.count;
        step(-1);
        assert_ok(ask(0, 0, false, &later));
        assert_int_equal(later.full, i == 2);
        assert_true(i < 2 ? later.count > begun : later.count == begun);
        room = later.count - (i == 1);
    }
}

/* If it failed, journals would cost nothing, or for ever. */
CASE_WITH(journal__is_charged_until_it_ends, setup, teardown)
{
    struct proto_SCENE_JOURNAL_result result;
    uint64_t late = test_now_ms() + 5000;

    assert_int_equal(ask(0, 65 * MIB, false, &result), PCCD_E_QUOTA);
    for (int i = 0; i < 3; i++) {
        assert_ok(ask(0, 60 * MIB, false, &result));
        assert_int_equal(ask(0, 1, false, &result), PCCD_E_STATE); /* there is one */
        assert_ok(ask(0, 0, true, &result));
        add(); /* so that the next one is refused */
        assert_int_equal(ask(0, 1, false, &result), PCCD_E_LIMIT);
    }
    assert_ok(ask(0, 60 * MIB, false, &result));
    assert_ok(RAW_CALL(&raw, SCENE_DESTROY, NULL, .scene = scene));
    assert_ok(test_raw_scene(&raw, "journal", &scene));
    while (ask(0, 60 * MIB, false, &result) == PCCD_E_QUOTA && test_now_ms() < late) {
        test_sleep_ms(1); /* it is freed behind what is computed */
    }
    assert_ok(ask(0, 0, false, &result));
}

/* If it failed, what was refused would be kept, and nobody charged for it. */
CASE_WITH(journal__that_is_refused_is_none, setup, teardown)
{
    struct proto_SCENE_JOURNAL_result result;

    assert_int_equal(ask(1, 60 * MIB, false, &result), PCCD_E_INVAL); /* not its start */
    assert_int_equal(ask(0, 0, false, &result), PCCD_E_STATE);
    assert_ok(ask(0, 60 * MIB, false, &result));
}

/* If it failed, nonsense would be taken for something. */
CASE_WITH(journal__refuses_what_it_is_not_of, setup, teardown)
{
    struct proto_SCENE_JOURNAL_result result;

    assert_int_equal(ask(0, 0, false, &result), PCCD_E_STATE);
    assert_int_equal(ask(0, MIB, true, &result), PCCD_E_INVAL);
    assert_ok(test_raw_scene(&raw, "", &scene));
    assert_int_equal(ask(0, MIB, false, &result), PCCD_E_INVAL);
    scene = 77;
    assert_int_equal(ask(0, MIB, false, &result), PCCD_E_HANDLE);
}
