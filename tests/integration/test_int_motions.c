/* test_int_motions.c - many objects in one call, and memory that others look after. */
#include "cases.h"

#include <sys/mman.h>

#include "fixture.h"
#include "must.h"
#include "pccd.h"

static const uint32_t triangle[1][3] = {{0, 1, 2}};
static const double still[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
static const double lowered[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, -2};

/* A floor, and three triangles above it side by side, each to be moved in its own way. */
struct yard {
    uint32_t scene, bodies[3];
    double x0[3][3][3], x1[3][3][3];
};

static void make_yard(struct pccd_client *client, struct yard *yard)
{
    static const double ground[3][3] = {{-9, -9, 0}, {9, -9, 0}, {0, 9, 0}};
    uint32_t mesh;

    yard->scene = test_scene(client);
    mesh = test_mesh(client, ground, PCCD_FORMAT_F64, 3, triangle, 1);
    (void)test_object(client, yard->scene, mesh);
    for (int i = 0; i < 3; i++) {
        const double x[3][3] = {{i, 0, 1}, {i + 0.25, 0, 2}, {i, 0.25, 2}};

        memcpy(yard->x0[i], x, sizeof x);
        memcpy(yard->x1[i], x, sizeof x);
        for (int v = 0; v < 3; v++) {
            yard->x1[i][v][2] -= 2;
        }
        mesh = test_mesh(client, x, PCCD_FORMAT_F64, 3, triangle, 1);
        yard->bodies[i] = test_object(client, yard->scene, mesh);
    }
}

/* If it failed, several objects in one call would go elsewhere than in a frame. */
CASE_CROSSING(motions__give_the_bytes_of_a_frame)
{
    struct pccd_client *client = ((struct test_crossing *)*state)->client;
    struct yard yard;
    struct pccd_frame frame;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    uint64_t step, hash[2];
    void *x0, *x1;

    make_yard(client, &yard);
    assert_ok(pccd_frame_begin(client, yard.scene, 3, 3 * 72 + 192, &frame));
    assert_ok(pccd_frame_x1(&frame, yard.bodies[0], PCCD_FORMAT_F64, 0, 3, &x1));
    memcpy(x1, yard.x1[0], 72);
    assert_ok(pccd_frame_x0x1(&frame, yard.bodies[1], PCCD_FORMAT_F64, 0, 3, &x0, &x1));
    memcpy(x0, yard.x0[1], 72);
    memcpy(x1, yard.x1[1], 72);
    assert_ok(pccd_frame_rigid(&frame, yard.bodies[2], 0, 3, still, lowered));
    assert_ok(pccd_frame_commit(&frame, NULL, &step));
    assert_ok(pccd_wait(client, step, -1, &answer));
    assert_true(answer.total >= 3);
    memcpy(hash, answer.hash, sizeof hash);
    pccd_answer_release(client, &answer);

    const struct pccd_motion back = {
        .object = yard.bodies[0], .count = 3, .format = PCCD_FORMAT_F64, .x1 = yard.x0};
    assert_ok(pccd_step(client, yard.scene, &back, 1, NULL, &answer));
    pccd_answer_release(client, &answer);
    const struct pccd_motion motions[3] = {
        {.object = yard.bodies[0],
         .count = 3,
         .format = PCCD_FORMAT_F64,
         .x1 = yard.x1[0]},
        {.object = yard.bodies[1],
         .count = 3,
         .format = PCCD_FORMAT_F64,
         .x0 = yard.x0[1],
         .x1 = yard.x1[1]},
        {.object = yard.bodies[2], .count = 3, .m0 = still, .m1 = lowered}};
    assert_ok(pccd_step(client, yard.scene, motions, 3, NULL, &answer));
    assert_memory_equal(answer.hash, hash, sizeof hash);
    pccd_answer_release(client, &answer);
    assert_ok(pccd_submit(client, yard.scene, NULL, 0, NULL, &step));
    assert_ok(pccd_wait(client, step, -1, &answer));
    memcpy(hash, answer.hash, sizeof hash);
    pccd_answer_release(client, &answer);
    test_still(client, yard.scene, NULL, &answer);
    assert_memory_equal(answer.hash, hash, sizeof hash);
    pccd_answer_release(client, &answer);
}

/* If it failed, a motion that says nothing, or two things, would be taken for another. */
CASE_CROSSING(motions__in_no_way_or_in_two_are_refused)
{
    struct pccd_client *client = ((struct test_crossing *)*state)->client;
    struct yard yard;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    uint64_t step = 0;

    make_yard(client, &yard);
    const struct pccd_motion bad[] = {
        {.object = yard.bodies[0], .count = 3},
        {.object = yard.bodies[0], .count = 3, .x0 = yard.x0},
        {.object = yard.bodies[0], .count = 3, .m0 = still},
        {.object = yard.bodies[0], .count = 3, .m1 = still},
        {.object = yard.bodies[0], .count = 3, .m0 = still, .m1 = still, .x1 = yard.x1},
        {.object = yard.bodies[0], .count = 3, .m0 = still, .m1 = still, .x0 = yard.x0}};
    static const char *const has[] = {"it has nothing, ", "it has x0, ",
                                      "it has m0, ",      "it has m1, ",
                                      "it has x1 m0 m1,", "it has x0 m0 m1,"};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        assert_int_equal(pccd_submit(client, yard.scene, &bad[i], 1, NULL, &step),
                         PCCD_E_INVAL);
        assert_non_null(strstr(pccd_error_text(client), "motion 0"));
        assert_non_null(strstr(pccd_error_text(client), has[i]));
    }
    assert_int_equal(pccd_submit(client, yard.scene, NULL, 1, NULL, &step), PCCD_E_INVAL);
    assert_int_equal(pccd_submit(client, yard.scene, bad, 1, NULL, NULL), PCCD_E_INVAL);
    assert_int_equal(pccd_submit(NULL, yard.scene, bad, 1, NULL, &step), PCCD_E_INVAL);
    assert_int_equal(pccd_step(client, yard.scene, bad, 1, NULL, NULL), PCCD_E_INVAL);
    assert_int_equal(step, 0);
    assert_ok(pccd_step(client, yard.scene, NULL, 0, NULL, &answer));
    pccd_answer_release(client, &answer); /* the slots of the refused are free */
}

/* If it failed, an answer that nobody wants would be handed to who polls, or fill the
 * table of those that wait to be taken. */
CASE_CROSSING(abandon__drops_the_answer)
{
    struct test_crossing *crossing = *state;
    struct pccd_client *client = crossing->client;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    uint64_t step = 0;

    for (int i = 0; i < 100; i++) {
        assert_ok(pccd_submit_still(client, crossing->scene, NULL, &step));
        pccd_abandon(client, step);
    }
    assert_int_equal(pccd_wait(client, step, -1, &answer), PCCD_E_INVAL);
    pccd_abandon(client, step);
    pccd_abandon(NULL, step);
    assert_true(test_crossing_turn(crossing));
    assert_int_equal(pccd_poll(client, &answer), PCCD_E_AGAIN);
}

/* ---- memory ------------------------------------------------------------------------ */

/* Calls of pccd_options.unmap. */
struct orphans {
    int count;
    void *memory[8];
    size_t bytes[8];
};

static void take_orphan(void *context, void *memory, size_t bytes)
{
    struct orphans *orphans = context;

    assert_true(orphans->count < 8);
    orphans->memory[orphans->count] = memory;
    orphans->bytes[orphans->count++] = bytes;
}

static bool is_within(const struct orphans *orphans, const void *at)
{
    for (int i = 0; i < orphans->count; i++) {
        if ((uintptr_t)at - (uintptr_t)orphans->memory[i] < orphans->bytes[i]) {
            return true;
        }
    }
    return false;
}

/* If it failed, a larger step would be refused for an answer that somebody still reads,
 * or take the answer's memory away; and arrays of a garbage-collected language would lead
 * to memory that is gone. */
CASE(memory__outlives_a_growing_ring_and_a_close)
{
    struct orphans orphans = {0};
    struct test_crossing crossing;
    struct pccd_answer held = PCCD_ANSWER_INIT;
    struct pccd_answer other = PCCD_ANSWER_INIT;
    struct pccd_frame frame;
    const struct pccd_contact *contacts;
    struct pccd_contact first;

    struct pccd_client *client = test_client(&(struct pccd_options){
        .url = test_shared.url, .unmap = take_orphan, .unmap_context = &orphans});
    assert_ok(test_crossing_make(client, &crossing));
    float x[3][3];
    test_crossing_positions(x, -crossing.z);
    assert_ok(test_crossing_step(&crossing, x, NULL, &held));
    assert_true(held.count > 0);
    contacts = held.contacts;
    first = contacts[0];
    assert_ok(pccd_frame_begin(client, crossing.scene, 1, 1u << 22, &frame));
    pccd_frame_abort(&frame);
    assert_int_equal(orphans.count, 1); /* the slots; the records are in use */
    assert_memory_equal(&contacts[0], &first, sizeof first);
    test_crossing_positions(x, crossing.z);
    assert_ok(test_crossing_step(&crossing, x, NULL, &other));
    assert_int_equal(other.count, held.count);
    pccd_answer_release(client, &held);
    assert_int_equal(orphans.count, 2);
    assert_true(is_within(&orphans, contacts));
    assert_memory_equal(&contacts[0], &first, sizeof first);
    contacts = other.contacts;
    first = contacts[0];
    pccd_close(client);
    assert_int_equal(orphans.count, 4);
    assert_true(is_within(&orphans, contacts));
    assert_memory_equal(&contacts[0], &first, sizeof first);
    for (int i = 0; i < orphans.count; i++) {
        assert_int_equal(munmap(orphans.memory[i], orphans.bytes[i]), 0);
    }
}

CASES_WITH(test_shared_start, test_shared_stop);
