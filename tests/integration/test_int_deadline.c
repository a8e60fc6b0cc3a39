/* test_int_deadline.c - how soon a step ends when it must. */
#include "cases.h"

#include <sys/prctl.h>
#include <unistd.h>

#include "fixture.h"
#include "grid.h"
#include "must.h"
#include "prng.h"

#define SIDE       250u /* 124 002 triangles, 62 500 contacts a step */
#define ROUNDS_MAX 100000u

#define RESULT_BYTES (16u << 20) /* for four whole answers */

/* A machine where others build is late for reasons of its own. The aim is 2 ms. */
#define GENEROUS_US 250000

static struct test_grid grid;
static struct pccd_client *client;
static uint32_t rounds = 60;
static int64_t late_us[ROUNDS_MAX];

static int start(void **state)
{
    const char *text = getenv("DEADLINE_ROUNDS");

    (void)prctl(PR_SET_TIMERSLACK, 1, 0, 0, 0); /* pauses are as long as said */
    rounds = text != NULL ? (uint32_t)strtoul(text, NULL, 10) : rounds;
    rounds = rounds > ROUNDS_MAX ? ROUNDS_MAX : rounds;
    return test_shared_connect(state, RESULT_BYTES, &client) == 0
               ? test_grid_make(client, SIDE, &grid)
               : -1;
}

static int teardown(void **state)
{
    pccd_close(client);
    test_grid_free(&grid);
    return test_shared_stop(state);
}

/* A step without a deadline, which must be right. Returns its time. */
static uint64_t whole_step(void)
{
    uint64_t begin_us = test_now_us();
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    uint64_t step = 0;
    uint64_t end_us;

    assert_ok(test_grid_submit(&grid, NULL, &step));
    assert_ok(pccd_wait(client, step, 60000, &answer));
    end_us = test_now_us();
    assert_true(test_grid_is_right(&grid, &answer));
    pccd_answer_release(client, &answer);
    return end_us - begin_us;
}

static int by_value(const void *a, const void *b)
{
    int64_t x = *(const int64_t *)a;
    int64_t y = *(const int64_t *)b;

    return (x > y) - (x < y);
}

static void report(const char *what, uint32_t count, uint64_t step_us)
{
    uint32_t in_time = 0;

    qsort(late_us, count, sizeof *late_us, by_value);
    while (in_time < count && late_us[in_time] <= 2000) {
        in_time++;
    }
    printf("# %s: %u of %u steps of %.1f ms within 2 ms; late by p50 %.2f, p90 %.2f, "
           "p99 %.2f, at most %.2f ms\n",
           what, in_time, count, (double)step_us / 1000,
           (double)late_us[count / 2] / 1000, (double)late_us[count * 9 / 10] / 1000,
           (double)late_us[count - 1 - count / 100] / 1000,
           (double)late_us[count - 1] / 1000);
}

/* The median of a few. */
static uint64_t usual_step(void)
{
    int64_t taken_us[9];

    for (int i = 0; i < 9; i++) {
        taken_us[i] = (int64_t)whole_step();
    }
    qsort(taken_us, 9, sizeof *taken_us, by_value);
    return (uint64_t)taken_us[4];
}

/* If it failed, a client that gives a step so much time and no more would get its answer
 * later than it can use it, or not be told that it is not the whole, or have lost the
 * motion. */
CASE(deadline__answers_come_soon_after_it)
{
    uint64_t step_us = usual_step();
    struct prng prng = {prng_seed()};
    uint32_t count = 0;

    for (uint32_t i = 0; i < rounds; i++) {
        uint64_t budget_us = 1 + prng_below(&prng, step_us);
        struct pccd_step_settings settings = {.struct_bytes =
                                                  sizeof(struct pccd_step_settings),
                                              .deadline_ns = budget_us * 1000};
        struct pccd_answer answer = PCCD_ANSWER_INIT;
        uint64_t begin_us;
        uint64_t step = 0;

        assert_ok(test_grid_submit(&grid, &settings, &step));
        begin_us = test_now_us(); /* the daemon counts from its arrival */
        assert_ok(pccd_wait(client, step, 60000, &answer));
        late_us[count] = (int64_t)(test_now_us() - begin_us) - (int64_t)budget_us;
        if (answer.incomplete == PCCD_COMPLETE) {
            assert_true(test_grid_is_right(&grid, &answer));
        } else {
            assert_int_equal(answer.incomplete, PCCD_INCOMPLETE_DEADLINE);
            assert_true(answer.total <= grid.vertex_count);
            count++;
        }
        pccd_answer_release(client, &answer);
        if (i % 4 == 0) {
            (void)whole_step();
        }
    }
    assert_true(count > 0);
    report("deadline", count, step_us);
    assert_true(late_us[count / 2] <= GENEROUS_US);
}

/* The same for a client that changes its mind. */
CASE(cancel__answers_come_soon_after_it)
{
    uint64_t step_us = usual_step();
    struct prng prng = {prng_seed()};
    uint32_t count = 0;

    if (test_is_direct()) {
        test_skip("with direct: it is done before it can be cancelled");
    }
    for (uint32_t i = 0; i < rounds; i++) {
        uint64_t pause_us = prng_below(&prng, step_us);
        struct pccd_answer answer = PCCD_ANSWER_INIT;
        uint64_t begin_us;
        uint64_t step = 0;
        int status;

        assert_ok(test_grid_submit(&grid, NULL, &step));
        (void)usleep((useconds_t)pause_us); /* not in a loop: processors are few */
        begin_us = test_now_us();
        status = pccd_cancel(client, step);
        assert_true(status == 0 || status == PCCD_E_INVAL);
        assert_ok(pccd_wait(client, step, 60000, &answer));
        late_us[count] = (int64_t)(test_now_us() - begin_us);
        if (answer.incomplete == PCCD_COMPLETE) {
            assert_true(test_grid_is_right(&grid, &answer));
        } else {
            assert_int_equal(answer.incomplete, PCCD_INCOMPLETE_CANCELLED);
            count++;
        }
        pccd_answer_release(client, &answer);
        if (i % 4 == 0) {
            (void)whole_step();
        }
    }
    assert_true(count > 0);
    report("cancel", count, step_us);
    assert_true(late_us[count / 2] <= GENEROUS_US);
}

#define SLOW_TRIANGLES 12u

/* Triangles that pass through the origin and through each other, with coordinates as far
 * apart as they may be: every pair takes long integers. */
static struct {
    double x[3 * SLOW_TRIANGLES][3];
    uint32_t scene;
    uint32_t object;
} slow;

static void make_slow(void)
{
    uint32_t triangles[SLOW_TRIANGLES][3];
    struct prng prng = {17};

    for (uint32_t i = 0; i < 9 * SLOW_TRIANGLES; i++) {
        slow.x[i / 3][i % 3] =
            prng_between(&prng, -1, 1) * (prng_below(&prng, 2) ? 0x1p59 : 0x1p-1060);
        triangles[i / 9][i / 3 % 3] = i / 3;
    }
    slow.scene = test_scene(client);
    uint32_t mesh = test_mesh(client, slow.x, PCCD_FORMAT_F64, 3 * SLOW_TRIANGLES,
                              triangles, SLOW_TRIANGLES);
    slow.object = test_object(client, slow.scene, mesh);
}

/* Every point goes to the other side of the origin. */
static uint64_t submit_slow(uint64_t budget_us)
{
    struct pccd_step_settings settings = {.struct_bytes =
                                              sizeof(struct pccd_step_settings),
                                          .deadline_ns = budget_us * 1000};
    struct pccd_frame frame;
    void *x1 = NULL;
    uint64_t step = 0;

    for (uint32_t i = 0; i < 9 * SLOW_TRIANGLES; i++) {
        slow.x[i / 3][i % 3] = -slow.x[i / 3][i % 3];
    }
    assert_ok(pccd_frame_begin(client, slow.scene, 1, sizeof slow.x, &frame));
    assert_ok(
        pccd_frame_x1(&frame, slow.object, PCCD_FORMAT_F64, 0, 3 * SLOW_TRIANGLES, &x1));
    memcpy(x1, slow.x, sizeof slow.x);
    assert_ok(pccd_frame_commit(&frame, &settings, &step));
    return step;
}

static void end_slow(uint64_t step, struct pccd_answer *answer)
{
    assert_ok(pccd_wait(client, step, 60000, answer));
    pccd_answer_release(client, answer); /* the numbers in it stay */
}

/* If it failed, whoever sends such numbers would hold up all others for as long as a
 * decision takes, or a deadline would change what the next step answers. */
CASE(deadline__is_seen_whatever_the_numbers)
{
    struct pccd_answer whole = PCCD_ANSWER_INIT;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    struct prng prng = {prng_seed()};
    uint64_t step_us = test_now_us();
    uint32_t count = 0;

    make_slow();
    end_slow(submit_slow(0), &whole);
    step_us = test_now_us() - step_us;
    assert_int_equal(whole.incomplete, PCCD_COMPLETE);
    for (uint32_t i = 0; i < 20; i++) {
        uint64_t budget_us = 1 + prng_below(&prng, step_us);
        uint64_t step = submit_slow(i % 2 || test_is_direct() ? budget_us : 0);
        uint64_t begin_us = test_now_us();

        if (i % 2 == 0 && !test_is_direct()) {
            (void)usleep((useconds_t)budget_us);
            begin_us = test_now_us();
            (void)pccd_cancel(client, step); /* or it is done */
            budget_us = 0;
        }
        end_slow(step, &answer);
        late_us[count] = (int64_t)(test_now_us() - begin_us) - (int64_t)budget_us;
        assert_true(answer.total <= whole.total);
        assert_true(answer.incomplete != PCCD_COMPLETE || answer.total == whole.total);
        count += answer.incomplete != PCCD_COMPLETE;
    }
    assert_true(count > 0);
    report("slow numbers", count, step_us);
    assert_true(late_us[count / 2] <= GENEROUS_US);
    end_slow(submit_slow(0), &answer);
    assert_int_equal(answer.incomplete, PCCD_COMPLETE);
    assert_int_equal(answer.total, whole.total);
}

CASES_WITH(start, teardown);
