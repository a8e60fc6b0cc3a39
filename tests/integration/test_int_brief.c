/* test_int_brief.c - steps that the loop computes itself. */
#include "cases.h"
#include "crossing.h"
#include "daemon.h"
#include "fixture.h"
#include "grid.h"
#include "must.h"

#define TURNS 200

static uint64_t brief(const struct test_crossing *crossing)
{
    return test_stat(crossing->client, "steps_brief");
}

/* Long enough for the loop to have had its break after the last one. */
static void rest(void)
{
    test_sleep_ms(1);
}

static struct pccd_step_settings by(enum pccd_method method)
{
    return (struct pccd_step_settings){.struct_bytes = sizeof(struct pccd_step_settings),
                                       .method = method};
}

/* Take the triangle to a height by a step, and return its answer, released. */
static struct pccd_answer move(struct test_crossing *crossing, float z,
                               const struct pccd_step_settings *settings)
{
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    float x[3][3];

    crossing->z = z;
    test_crossing_positions(x, z);
    assert_ok(test_crossing_step(crossing, x, settings, &answer));
    pccd_answer_release(crossing->client, &answer);
    rest();
    return answer;
}

/* The same way by both methods, of which the loop has one; back each time. */
static struct pccd_answer move_by_both(struct test_crossing *crossing, float z)
{
    struct pccd_step_settings wide = by(PCCD_METHOD_WIDE);
    struct pccd_step_settings paper = by(PCCD_METHOD_PAPER);
    float from = crossing->z;
    struct pccd_answer a = move(crossing, z, &wide);
    struct pccd_answer b = PCCD_ANSWER_INIT;

    move(crossing, from, &wide);
    b = move(crossing, z, &paper);
    assert_int_equal(a.incomplete, PCCD_COMPLETE);
    assert_int_equal(b.incomplete, PCCD_COMPLETE);
    assert_true(a.total == b.total);
    assert_memory_equal(a.hash, b.hash, sizeof a.hash);
    return a;
}

/* If it failed: a small step would wait for processors to wake; or its answer would
 * depend on who has computed it. */
CASE_CROSSING(brief__small_steps_are_answered_by_the_loop)
{
    struct test_crossing *crossing = *state;
    uint64_t before = brief(crossing);
    uint64_t there;

    for (int i = 0; i < TURNS; i++) {
        assert_true(move_by_both(crossing, -crossing->z).total > 0);
    }
    there = brief(crossing) - before;
    if (test_is_direct()) {
        assert_int_equal(there, 0);
    } else {
        assert_true(there <= 2 * TURNS);
#ifndef PCCD_SANITIZED /* which takes ten times as long */
        assert_true(there > 0);
#endif
    }
}

/* If it failed: what the loop must not do, and leaves to the compute thread, would be
 * lost, or moved twice. Triangles in one plane take exact arithmetic. */
CASE_CROSSING(brief__what_takes_longer_goes_on_elsewhere)
{
    struct test_crossing *crossing = *state;
    struct pccd_step_settings wide = by(PCCD_METHOD_WIDE);

    for (int i = 0; i < TURNS / 10; i++) {
        uint64_t before;
        struct pccd_answer rests = PCCD_ANSWER_INIT;

        for (int k = 0; k < 8; k++) { /* known to be short once more */
            move(crossing, 1 + (float)(k % 2), &wide);
        }
        before = brief(crossing);
        assert_true(move_by_both(crossing, 0).total > 0);
        rests = move_by_both(crossing, 0);
        assert_true(rests.initial > 0 && rests.initial == rests.total);
        assert_true(rests.counters.exact > 0);
        assert_true(brief(crossing) - before <= 1); /* the one way back */
    }
}

/* If it failed: everybody would wait while the loop computes; or a large scene in which
 * nothing moves would wait for processors to wake. */
CASE_CROSSING(brief__large_scenes_are_the_loops_at_rest_alone)
{
    struct test_crossing *crossing = *state;
    struct pccd_step_settings still = by(PCCD_METHOD_WIDE);
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    struct test_grid grid;
    struct pccd_client *other = test_client_at(test_shared.url);
    uint64_t before = brief(crossing);
    uint64_t step;

    assert_ok(test_grid_make(crossing->client, 12, &grid));
    for (int i = 0; i < TURNS; i++) {
        assert_ok(test_grid_submit(&grid, NULL, &step));
        assert_ok(test_grid_await(&grid, step));
        rest();
    }
    assert_int_equal(brief(crossing), before);
    for (int i = 0; i < TURNS; i++) {
        uint64_t hash[2] = {answer.hash[0], answer.hash[1]};

        test_still(grid.client, grid.scene, &still, &answer);
        pccd_answer_release(grid.client, &answer);
        assert_int_equal(answer.incomplete, PCCD_COMPLETE);
        assert_true(i < 2 || memcmp(hash, answer.hash, sizeof hash) == 0);
        rest();
    }
    if (!test_is_direct()) {
        assert_true(brief(crossing) > before);
    }
    test_grid_free(&grid);
    pccd_close(other);
}

/* Take a thousand triangles through a floor, and return how many steps the loop did. */
static uint64_t turn_grid(const struct test_crossing *crossing, struct test_grid *grid)
{
    uint64_t before = brief(crossing);

    for (int i = 0; i < TURNS / 2; i++) {
        struct pccd_answer answer = PCCD_ANSWER_INIT;

        assert_ok(test_grid_turn(grid, NULL, &answer));
        assert_true(test_grid_is_right(grid, &answer));
        pccd_answer_release(grid->client, &answer);
    }
    return brief(crossing) - before;
}

/* If it failed: a client that is alone would wait for another thread to wake; or others
 * would for its step, which takes longer than theirs. */
CASE_CROSSING(brief__of_a_client_that_is_alone_may_be_larger)
{
    struct test_crossing *crossing = *state;
    struct test_grid grid;
    struct pccd_client *other;
    uint64_t there;

    assert_ok(test_grid_make(crossing->client, 20, &grid));
    there = turn_grid(crossing, &grid);
#ifndef PCCD_SANITIZED /* which takes ten times as long */
    assert_true(there > 0 || test_is_direct());
#endif
    (void)there;
    other = test_client_at(test_shared.url);
    assert_int_equal(turn_grid(crossing, &grid), 0);
    pccd_close(other);
    test_grid_free(&grid);
}

/* If it failed: two threads would compute at once with what there is one of. */
CASE_CROSSING(brief__nothing_is_the_loops_while_another_step_runs)
{
    struct test_crossing *crossing = *state;
    struct pccd_step_settings wide = by(PCCD_METHOD_WIDE);
    struct pccd_step_settings slow = by(PCCD_METHOD_PAPER);
    struct pccd_client *other = test_client_at(test_shared.url);
    struct test_grid grid;
    uint32_t behind = 0;
    uint64_t step;

    slow.threads = 1; /* so many milliseconds that we go on before it has ended */
    assert_ok(test_grid_make(other, 400, &grid));
    for (int i = 0; i < 10; i++) {
        move(crossing, -crossing->z, &wide);
    }
    /* On a busy machine the large step may have ended when we go on. */
    for (int i = 0; i < (test_is_direct() ? 3 : 100) && behind == 0; i++) {
        uint64_t before = brief(crossing);
        struct pccd_answer answer = PCCD_ANSWER_INIT;

        assert_ok(test_grid_submit(&grid, &slow, &step));
        rest(); /* its positions are copied before it begins */
        answer = move(crossing, -crossing->z, &wide);
        assert_true(answer.total > 0);
        if (brief(crossing) == before) {
            behind += answer.times.queue > 100000;
        }
        assert_ok(test_grid_await(&grid, step));
    }
    assert_true(behind > 0 || test_is_direct());
    test_grid_close(&grid);
}

/* If it failed: a deadline that has passed, or a cancel, would be ignored by the loop, or
 * the step after it would be wrong. */
CASE_CROSSING(brief__deadlines_and_cancels_end_them)
{
    struct test_crossing *crossing = *state;
    struct pccd_step_settings late = by(PCCD_METHOD_WIDE);
    struct pccd_step_settings wide = late;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    uint64_t step;

    late.deadline_ns = 1;
    for (int i = 0; i < TURNS / 10; i++) {
        answer = move(crossing, -crossing->z, &late);
        assert_int_equal(answer.incomplete, PCCD_INCOMPLETE_DEADLINE);
        assert_true(move(crossing, -crossing->z, &wide).total > 0);
        assert_ok(pccd_submit_still(crossing->client, crossing->scene, &wide, &step));
        (void)pccd_cancel(crossing->client, step); /* or it was answered before */
        assert_ok(pccd_wait(crossing->client, step, -1, &answer));
        assert_true(answer.incomplete == PCCD_COMPLETE ||
                    answer.incomplete == PCCD_INCOMPLETE_CANCELLED);
        pccd_answer_release(crossing->client, &answer);
        assert_true(move(crossing, -crossing->z, &wide).total > 0);
    }
}

CASES_WITH(test_shared_start, test_shared_stop);
