/* test_int_overdue.c - steps that have to end before their turn. */
#include "cases.h"

#include <dirent.h>
#include <sys/ptrace.h>
#include <sys/wait.h>
#include <unistd.h>

#include "crossing.h"
#include "farm.h"
#include "fixture.h"
#include "grid.h"
#include "must.h"
#include "raw.h"

#define SIDE         250u /* a step of 20 ms and more; its slot is copied: 750 KB */
#define SIDE_LARGE   320u /* one that is not: 1.2 MB */
#define DEADLINE_NS  1000000u
#define RESULT_BYTES (32u << 20)
#define GENEROUS_US  250000 /* the aim is 2 ms, of a machine that is left alone */
#define TRIES        20

static struct test_grid grid;
static struct pccd_client *client;

static int start_with(void **state, uint32_t side)
{
    return test_shared_connect(state, RESULT_BYTES, &client) == 0
               ? test_grid_make(client, side, &grid)
               : -1;
}

static int start(void **state)
{
    return start_with(state, SIDE);
}

static int start_large(void **state)
{
    return start_with(state, SIDE_LARGE);
}

static int teardown(void **state)
{
    pccd_close(client);
    test_grid_free(&grid);
    return test_shared_stop(state);
}

static void take(uint64_t step, struct pccd_answer *answer)
{
    assert_ok(pccd_wait(client, step, 60000, answer));
    assert_int_equal(answer->status, 0);
}

static void expect_nothing(uint64_t step, enum pccd_incomplete why)
{
    struct pccd_answer answer = PCCD_ANSWER_INIT;

    take(step, &answer);
    assert_int_equal(answer.incomplete, why);
    assert_int_equal(answer.total, 0);
    assert_int_equal(answer.count, 0);
    assert_true(answer.contacts == NULL);
    pccd_answer_release(client, &answer);
}

static bool is_answered(uint64_t step)
{
    struct pccd_answer answer = PCCD_ANSWER_INIT;

    if (pccd_wait(client, step, 0, &answer) == PCCD_E_AGAIN) {
        return false;
    }
    fail_msg("a long step was answered before one that need not be computed");
    return true;
}

/* If it failed, a client that shares the daemon with long steps would get no answer when
 * it can still use it; or would find later that a motion was lost. */
CASE_WITH(overdue__step_is_answered_at_its_deadline, start, teardown)
{
    const struct pccd_step_settings settings = {
        .struct_bytes = sizeof(struct pccd_step_settings), .deadline_ns = DEADLINE_NS};
    uint64_t before[2];
    uint64_t overdue;
    uint64_t after;
    uint64_t begin_us;

    for (int i = 0; i < 3; i++) {
        assert_ok(test_grid_submit(&grid, NULL, &before[0]));
        assert_ok(test_grid_submit(&grid, NULL, &before[1]));
        assert_ok(test_grid_submit(&grid, &settings, &overdue));
        begin_us = test_now_us();
        expect_nothing(overdue, PCCD_INCOMPLETE_DEADLINE);
        begin_us += DEADLINE_NS / 1000;
        printf("# answered %lld us after its deadline\n",
               (long long)(test_now_us() - begin_us));
        assert_false(is_answered(before[1]));
        assert_true((int64_t)(test_now_us() - begin_us) <= GENEROUS_US);
        /* Through a slot that was free again, and from where the motion has led. */
        assert_ok(test_grid_submit(&grid, NULL, &after));
        test_grid_expect(&grid, before[0]);
        test_grid_expect(&grid, before[1]);
        test_grid_expect(&grid, after);
    }
}

/* The same for a client that changes its mind. */
CASE_WITH(overdue__step_is_answered_when_it_is_cancelled, start, teardown)
{
    uint64_t before[2];
    uint64_t cancelled;
    uint64_t after;

    assert_ok(test_grid_submit(&grid, NULL, &before[0]));
    assert_ok(test_grid_submit(&grid, NULL, &before[1]));
    assert_ok(test_grid_submit(&grid, NULL, &cancelled));
    assert_ok(pccd_cancel(client, cancelled));
    expect_nothing(cancelled, PCCD_INCOMPLETE_CANCELLED);
    assert_false(is_answered(before[1]));
    assert_ok(test_grid_submit(&grid, NULL, &after));
    test_grid_expect(&grid, before[0]);
    test_grid_expect(&grid, before[1]);
    test_grid_expect(&grid, after);
}

/* If it failed, the loop would copy for as long as others wait for it, or the positions
 * of a large step would be lost. */
CASE_WITH(overdue__large_step_is_answered_in_its_turn, start_large, teardown)
{
    const struct pccd_step_settings settings = {
        .struct_bytes = sizeof(struct pccd_step_settings), .deadline_ns = DEADLINE_NS};
    uint64_t before;
    uint64_t overdue;
    uint64_t after;
    struct pccd_answer answer = PCCD_ANSWER_INIT;

    assert_ok(test_grid_submit(&grid, NULL, &before));
    assert_ok(test_grid_submit(&grid, &settings, &overdue));
    take(overdue, &answer);
    assert_int_equal(answer.incomplete, PCCD_INCOMPLETE_DEADLINE);
    pccd_answer_release(client, &answer);
    test_grid_expect(&grid, before);
    assert_ok(test_grid_submit(&grid, NULL, &after));
    test_grid_expect(&grid, after);
}

/* ---- while it is computed ---------------------------------------------------------- */

#define THREADS_MAX 64

static pid_t held[THREADS_MAX];
static int held_count;

/* Hold all threads of the daemon but its loop. */
static void hold_threads(void)
{
    char path[64];
    const struct dirent *entry;

    snprintf(path, sizeof path, "/proc/%ld/task", (long)test_shared.pid);
    DIR *threads = opendir(path);
    assert_non_null(threads);
    held_count = 0;
    while ((entry = readdir(threads)) != NULL && held_count < THREADS_MAX) {
        pid_t thread = atoi(entry->d_name);
        if (thread == 0 || thread == test_shared.pid) {
            continue;
        }
        if (ptrace(PTRACE_SEIZE, thread, 0, 0) != 0) {
            test_skip("threads of a child may not be traced here");
        }
        held[held_count++] = thread;
        assert_int_equal(ptrace(PTRACE_INTERRUPT, thread, 0, 0), 0);
        assert_int_equal(waitpid(thread, NULL, __WALL), thread);
    }
    closedir(threads);
}

static void release_threads(void)
{
    for (int i = 0; i < held_count; i++) {
        assert_int_equal(ptrace(PTRACE_DETACH, held[i], 0, 0), 0);
    }
}

/* If it failed, a step would be as late as what its thread is at, which does not look
 * whether to stop: copies of large bodies, or their trees. The thread is held, so that it
 * cannot look at all. Before it has read the slot, or when it is done, nobody can tell:
 * then that is tried again. */
CASE_WITH(overdue__step_is_answered_while_its_thread_looks_at_nothing, start, teardown)
{
    bool is_answered_meanwhile = false;

    if (test_is_direct()) {
        test_skip("with direct: there is no other thread that could answer");
    }
    for (int i = 0; i < TRIES && !is_answered_meanwhile; i++) {
        const struct pccd_step_settings settings = {.struct_bytes =
                                                        sizeof(struct pccd_step_settings),
                                                    .deadline_ns = 30 * DEADLINE_NS};
        struct pccd_answer answer = PCCD_ANSWER_INIT;
        uint64_t step;

        assert_ok(test_grid_submit(&grid, &settings, &step));
        (void)usleep(1000u * (unsigned)(1 + i));
        hold_threads();
        int before = pccd_wait(client, step, 0, &answer);
        int status = before == PCCD_E_AGAIN ? pccd_wait(client, step, 500, &answer) : 0;
        release_threads();
        if (status == PCCD_E_TIMEOUT) {
            take(step, &answer);
        } else if (before == PCCD_E_AGAIN) {
            assert_ok(status);
            assert_int_equal(answer.incomplete, PCCD_INCOMPLETE_DEADLINE);
            assert_int_equal(answer.total, 0);
            is_answered_meanwhile = true;
        }
        pccd_answer_release(client, &answer);
        assert_ok(test_grid_submit(&grid, NULL, &step)); /* from where that has led */
        test_grid_expect(&grid, step);
    }
    assert_true(is_answered_meanwhile);
}

/* If it failed, a batch would wait for its turn though its client wants no more of it:
 * for scenes that move behind the answer of the batch before, say. No thread can answer
 * the first two. */
CASE_WITH(overdue__batch_is_answered_before_its_turn, start, teardown)
{
    struct pccd_batch_answer all = PCCD_BATCH_ANSWER_INIT;
    struct test_farm farm;
    uint64_t before, cancelled[2];

    if (test_is_direct()) {
        test_skip("with direct: there is no other thread that could answer");
    }
    assert_ok(test_farm_make(client, 3, 4, &farm));
    hold_threads();
    for (uint32_t i = 0; i < 2; i++) {
        assert_ok(test_farm_submit(&farm, i + 1, NULL, &cancelled[i]));
        assert_ok(pccd_cancel(client, cancelled[i]));
        int status = pccd_batch_wait(client, cancelled[i], 5000, &all);
        if (status != 0) {
            release_threads();
        }
        assert_ok(status);
        assert_int_equal(all.failed, 0);
        assert_int_equal(all.incomplete, 3);
        assert_int_equal(all.scenes[2].incomplete, PCCD_INCOMPLETE_CANCELLED);
        assert_int_equal(all.scenes[2].scene, farm.worlds[2].scene);
        pccd_batch_release(client, &all);
    }
    release_threads();
    assert_ok(test_farm_turn(&farm, 3, NULL, &all)); /* from where both have led */
    assert_int_equal(all.incomplete, 0);
    assert_int_equal(all.scenes[2].number, 3);
    pccd_batch_release(client, &all);
    assert_ok(test_grid_submit(&grid, NULL, &before));
    assert_ok(test_farm_submit(&farm, 4, NULL, &cancelled[0]));
    assert_ok(pccd_cancel(client, cancelled[0]));
    assert_ok(pccd_batch_wait(client, cancelled[0], 60000, &all));
    test_grid_expect(&grid, before); /* neither writes to the page of the other */
    for (uint32_t i = 0; i < 3; i++) {
        assert_int_equal(all.scenes[i].scene, farm.worlds[i].scene);
        assert_int_equal(all.scenes[i].incomplete, PCCD_INCOMPLETE_CANCELLED);
    }
    pccd_batch_release(client, &all);
    test_farm_free(&farm);
}

/* ---- what goes wrong later --------------------------------------------------------- */

static struct test_raw raw;

/* A step of an object that a request before it removes. Returns as test_raw_call. */
static int submit_doomed(uint32_t scene, uint32_t object,
                         struct proto_FRAME_SUBMIT_result *result)
{
    struct proto_FRAME_SUBMIT_request submit =
        test_raw_move(&raw, 0, scene, object, test_triangle_x, 3);
    uint32_t id;

    submit.deadline_ns = DEADLINE_NS;
    assert_true(RAW_SEND(&raw, SCENE_REMOVE, .scene = scene, .object = object) != 0);
    id = test_raw_request(&raw, PROTO_METHOD_FRAME_SUBMIT, &submit);
    return test_raw_answer(&raw, id, PROTO_METHOD_FRAME_SUBMIT, result);
}

/* If it failed, a client that was told of the deadline only would go on from positions
 * that the daemon has not. */
CASE_WITH(overdue__what_goes_wrong_later_is_said_by_the_next_step, start, teardown)
{
    struct proto_FRAME_SUBMIT_result result;
    uint32_t scene, mesh, object;
    int status = PCCD_E_HANDLE;

    assert_ok(test_raw_session(&raw, test_shared.socket, 2, 65536));
    assert_ok(test_raw_scene(&raw, "", &scene));
    assert_ok(test_raw_mesh(&raw, test_triangle_x, 3, test_triangle, 1, &mesh));
    /* Once in a while the long step ends at once, and it is told in its turn. */
    for (int i = 0; i < TRIES && status == PCCD_E_HANDLE; i++) {
        uint64_t step;

        assert_ok(test_raw_add(&raw, scene, mesh, &object));
        assert_ok(test_grid_submit(&grid, NULL, &step));
        status = submit_doomed(scene, object, &result);
        test_grid_expect(&grid, step);
    }
    assert_int_equal(status, 0);
    assert_int_equal(result.incomplete, PCCD_INCOMPLETE_DEADLINE);
    assert_int_equal(RAW_CALL(&raw, FRAME_SUBMIT, NULL, .scene = scene), PCCD_E_HANDLE);
    assert_ok(RAW_CALL(&raw, FRAME_SUBMIT, &result, .scene = scene));
    assert_int_equal(result.incomplete, PCCD_COMPLETE);
    test_raw_close(&raw);
}
