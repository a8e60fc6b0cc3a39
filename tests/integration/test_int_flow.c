/* test_int_flow.c - how steps flow: slots, pages, time limits, residence. */
#include "cases.h"

#include <signal.h>

#include "fixture.h"
#include "grid.h"
#include "must.h"
#include "pccd.h"
#include "record_hash.h"

/* Submit a turn of the smallest scene without waiting. */
static uint64_t submit_turn(struct test_crossing *crossing)
{
    struct pccd_frame frame;
    uint64_t step = 0;
    void *x1 = NULL;

    assert_ok(pccd_frame_begin(crossing->client, crossing->scene, 1, 36, &frame));
    assert_ok(pccd_frame_x1(&frame, crossing->object, PCCD_FORMAT_F32, 0, 3, &x1));
    crossing->z = -crossing->z;
    test_crossing_positions(x1, crossing->z);
    assert_ok(pccd_frame_commit(&frame, NULL, &step));
    return step;
}

/* If it failed, answers would be mixed up, or the result region run full although
 * everything is released. */
CASE_CROSSING(flow__answers_can_be_taken_and_released_in_any_order)
{
    static const int order[4] = {3, 0, 2, 1};
    static const int release[4] = {1, 3, 0, 2};
    struct test_crossing crossing;

    struct pccd_client *client = test_client(&(struct pccd_options){
        .url = test_shared.url,
        .result_bytes = 65536}); /* 4 * 192 bytes a round: goes round every 85 rounds */
    assert_ok(test_crossing_make(client, &crossing));
    for (int round = 0; round < 400; round++) {
        struct pccd_answer answers[4] = {PCCD_ANSWER_INIT, PCCD_ANSWER_INIT,
                                         PCCD_ANSWER_INIT, PCCD_ANSWER_INIT};
        uint64_t steps[4];

        for (int i = 0; i < 4; i++) {
            steps[i] = submit_turn(&crossing);
        }
        for (int i = 0; i < 4; i++) {
            assert_ok(pccd_wait(client, steps[order[i]], -1, &answers[order[i]]));
            assert_int_equal(answers[order[i]].step, steps[order[i]]);
            assert_int_equal(answers[order[i]].count, 3);
        }
        for (int i = 0; i < 4; i++) {
            assert_true(test_crossing_is_right(&crossing, &answers[release[i]]));
        }
    }
    pccd_close(client);
}

/* If it failed, a loop that polls would miss answers or see them twice. */
CASE_CROSSING(flow__poll_gives_each_answer_once_oldest_first)
{
    struct test_crossing *crossing = *state;
    struct pccd_client *client = crossing->client;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    uint64_t steps[12];
    uint64_t until_ms = test_now_ms() + 10000;
    int taken = 0;

    for (int i = 0; i < 12; i++) { /* more than slots: begin waits for one to come back */
        steps[i] = submit_turn(crossing);
    }
    while (taken < 12 && test_now_ms() < until_ms) {
        int status = pccd_poll(client, &answer);

        if (status == PCCD_E_AGAIN) {
            continue;
        }
        assert_int_equal(status, 0);
        assert_int_equal(answer.step, steps[taken]);
        assert_true(test_crossing_is_right(crossing, &answer));
        taken++;
    }
    assert_int_equal(taken, 12);
    assert_int_equal(pccd_poll(client, &answer), PCCD_E_AGAIN);
    assert_int_equal(pccd_wait(client, steps[0], -1, &answer), PCCD_E_INVAL);
}

/* If it failed, a client that never takes its answers would hang or grow without
 * bound. */
CASE_CROSSING(flow__answers_that_nobody_takes_are_bounded)
{
    struct test_crossing *crossing = *state;
    struct pccd_client *client = crossing->client;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    struct pccd_frame frame;
    int taken = 0;

    for (int i = 0; i < 32; i++) {
        (void)submit_turn(crossing);
    }
    assert_int_equal(pccd_frame_begin(client, crossing->scene, 1, 36, &frame),
                     PCCD_E_BUSY);
    assert_non_null(strstr(pccd_error_text(client), "poll or wait"));
    for (uint64_t until_ms = test_now_ms() + 10000;
         taken < 32 && test_now_ms() < until_ms;) {
        if (pccd_poll(client, &answer) == 0) {
            assert_true(test_crossing_is_right(crossing, &answer));
            taken++;
        }
    }
    assert_int_equal(taken, 32);
    assert_true(test_crossing_turn(crossing));
}

/* If it failed, a frame could be written beyond its slot, or a slot be lost. */
CASE_CROSSING(flow__frames_keep_to_what_they_announced)
{
    struct test_crossing *crossing = *state;
    struct pccd_client *client = crossing->client;
    struct pccd_frame frames[5];
    struct pccd_frame copy;
    uint64_t step = 0;
    void *x1 = NULL;

    assert_int_equal(pccd_frame_begin(client, crossing->scene, 65537, 36, &frames[0]),
                     PCCD_E_LIMIT);
    assert_int_equal(pccd_frame_begin(client, crossing->scene, 1, UINT64_MAX, &frames[0]),
                     PCCD_E_LIMIT);
    for (int i = 0; i < 4; i++) {
        assert_ok(pccd_frame_begin(client, crossing->scene, 1, 36, &frames[i]));
    }
    assert_int_equal(pccd_frame_begin(client, crossing->scene, 1, 36, &frames[4]),
                     PCCD_E_BUSY);
    assert_int_equal(pccd_frame_begin(client, crossing->scene, 1, 1u << 22, &frames[4]),
                     PCCD_E_BUSY); /* would need a larger ring */
    assert_int_equal(
        pccd_frame_x1(&frames[0], crossing->object, (enum pccd_format)5, 0, 3, &x1),
        PCCD_E_INVAL);
    assert_int_equal(
        pccd_frame_x1(&frames[0], crossing->object, PCCD_FORMAT_F64, 0, 3, &x1),
        PCCD_E_LIMIT);
    assert_int_equal(
        pccd_frame_x1(&frames[0], crossing->object, PCCD_FORMAT_F32, 0, UINT32_MAX, &x1),
        PCCD_E_LIMIT);
    assert_ok(pccd_frame_x1(&frames[0], crossing->object, PCCD_FORMAT_F32, 0, 3, &x1));
    assert_int_equal(
        pccd_frame_x1(&frames[0], crossing->object, PCCD_FORMAT_F32, 0, 1, &x1),
        PCCD_E_LIMIT);
    copy = frames[0];
    pccd_frame_abort(&frames[0]);
    assert_int_equal(pccd_frame_commit(&frames[0], NULL, &step), PCCD_E_INVAL);
    assert_non_null(strstr(pccd_error_text(client), "was committed or aborted"));
    assert_int_equal(pccd_frame_commit(&copy, NULL, &step), PCCD_E_INVAL);
    assert_non_null(strstr(pccd_error_text(client), "the frame is not begun"));
    pccd_frame_abort(&frames[0]);
    assert_non_null(strstr(pccd_error_text(client), "the frame is not begun"));
    for (int i = 1; i < 4; i++) {
        pccd_frame_abort(&frames[i]);
    }
    assert_int_equal(pccd_frame_bytes(0, 0), 0);
    assert_true(pccd_frame_bytes(3, 100) >= 3 * 32 + 100);
    assert_true(test_crossing_turn(crossing));
}

/* If it failed, a scene that outgrows the ring would be stuck, or records that are still
 * read be taken away. */
CASE_CROSSING(flow__ring_grows_while_answers_are_held)
{
    struct test_crossing *crossing = *state;
    struct pccd_client *client = crossing->client;
    struct pccd_answer held = PCCD_ANSWER_INIT;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    struct pccd_frame frame;
    struct test_grid grid;
    uint64_t step = submit_turn(crossing);

    assert_ok(pccd_wait(client, step, -1, &held));
    assert_ok(test_grid_make(client, 160, &grid)); /* 307 200 bytes of positions */
    assert_ok(pccd_frame_begin(client, grid.scene, 1, 307200, &frame));
    pccd_frame_abort(&frame);
    assert_ok(test_grid_submit(&grid, NULL, &step));
    assert_ok(pccd_wait(client, step, -1, &answer));
    assert_int_equal(answer.total, 160 * 160);
    assert_true(test_crossing_is_right(crossing, &held)); /* still readable; releases */
    pccd_answer_release(client, &answer);
    assert_true(test_crossing_turn(crossing));
    test_grid_free(&grid);
}

/* ---- pages ------------------------------------------------------------------------- */

/* All pages of the grid's answer into records[total]. */
static void collect_pages(struct test_grid *grid, struct pccd_answer *answer,
                          struct pccd_contact *records)
{
    uint64_t got = 0;
    uint32_t pages = 1;

    assert_int_equal(answer->incomplete, PCCD_INCOMPLETE_RESULT_FULL);
    for (;;) {
        assert_int_equal(answer->first, got);
        assert_int_equal(answer->cursor, got + answer->count);
        assert_true(answer->count > 0);
        memcpy(records + got, answer->contacts, answer->count * sizeof *records);
        got += answer->count;
        pccd_answer_release(grid->client, answer);
        if (got == answer->total) {
            break;
        }
        assert_ok(pccd_fetch(grid->client, grid->scene, answer->step, got, answer));
        pages++;
    }
    assert_true(pages >= 3);
    assert_int_equal(answer->incomplete, PCCD_COMPLETE);
}

/* If it failed, a small result region would lose, repeat or change contacts. */
CASE_CROSSING(flow__pages_add_up_to_the_whole_answer)
{
    struct test_crossing *crossing = *state;
    struct pccd_answer whole = PCCD_ANSWER_INIT;
    struct pccd_answer page = PCCD_ANSWER_INIT;
    struct pccd_contact *records;
    struct test_grid grids[2];
    uint64_t hash[2];
    uint64_t step = 0;

    struct pccd_client *small = test_client(
        &(struct pccd_options){.url = test_shared.url, .result_bytes = 65536});
    assert_ok(test_grid_make(small, 60, &grids[0]));
    assert_ok(test_grid_make(crossing->client, 60, &grids[1]));
    records = test_room(3600 * sizeof *records);
    for (int round = 0; round < 4; round++) {
        assert_ok(test_grid_turn(&grids[0], NULL, &page));
        assert_int_equal(page.total, 3600);
        collect_pages(&grids[0], &page, records);
        assert_ok(test_grid_submit(&grids[1], NULL, &step));
        assert_ok(pccd_wait(crossing->client, step, -1, &whole));
        assert_true(test_grid_is_right(&grids[1], &whole));
        /* The objects' handles differ between the sessions; all else is the same. */
        for (uint32_t i = 0; i < 3600; i++) {
            struct pccd_contact same = whole.contacts[i];

            same.object_a = grids[0].object;
            same.object_b = grids[0].floor;
            assert_memory_equal(&records[i], &same, sizeof same);
        }
        record_hash_2(records, 3600, sizeof *records, hash);
        assert_memory_equal(hash, page.hash, sizeof hash);
        record_hash_2(whole.contacts, 3600, sizeof *records, hash);
        assert_memory_equal(hash, whole.hash, sizeof hash);
        pccd_answer_release(crossing->client, &whole);
    }
    step = page.step;
    assert_int_equal(pccd_fetch(small, grids[0].scene, step, 3601, &page), PCCD_E_INVAL);
    assert_int_equal(pccd_fetch(small, grids[0].scene, step - 1, 0, &page), PCCD_E_STATE);
    assert_non_null(strstr(pccd_error_text(small), "step"));
    assert_ok(pccd_fetch(small, grids[0].scene, step, 3600, &page));
    assert_int_equal(page.count, 0);
    free(records);
    test_grid_free(&grids[0]);
    test_grid_free(&grids[1]);
    pccd_close(small);
}

/* If it failed, a client that keeps its pages would stop the daemon, or overwrite
 * them. */
CASE_CROSSING(flow__full_region_is_said_and_held_pages_stay)
{
    struct test_crossing *crossing = *state;
    struct pccd_client *small = NULL;
    struct pccd_answer held = PCCD_ANSWER_INIT;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    struct pccd_contact copy[1000];
    struct test_grid grid;
    uint64_t step = 0;

    small = test_client(
        &(struct pccd_options){.url = test_shared.url, .result_bytes = 65536});
    assert_ok(test_grid_make(small, 60, &grid));
    assert_ok(test_grid_turn(&grid, NULL, &held));
    assert_true(held.count >= 1000);
    memcpy(copy, held.contacts, sizeof copy);
    for (int i = 0; i < 3; i++) { /* no room: the count is true, the page is empty */
        assert_ok(test_grid_submit(&grid, NULL, &step));
        assert_ok(pccd_wait(small, step, -1, &answer));
        assert_int_equal(answer.incomplete, PCCD_INCOMPLETE_RESULT_FULL);
        assert_int_equal(answer.total, 3600);
        assert_true(answer.count < 100);
        pccd_answer_release(small, &answer);
    }
    assert_memory_equal(copy, held.contacts, sizeof copy);
    assert_true(test_crossing_turn(crossing)); /* another client does not notice */
    pccd_answer_release(small, &held);
    pccd_answer_release(small, &held);
    assert_ok(pccd_fetch(small, grid.scene, step, 0, &answer));
    assert_true(answer.count >= 1000);
    pccd_answer_release(small, &answer);
    test_grid_close(&grid);
}

/* ---- time -------------------------------------------------------------------------- */

/* If it failed, a step could take longer than its client can use it. */
CASE_CROSSING(flow__deadline_gives_an_incomplete_answer)
{
    struct test_crossing *crossing = *state;
    struct pccd_step_settings settings = {
        .struct_bytes = sizeof(struct pccd_step_settings), .deadline_ns = 1};
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    struct test_grid grid;

    assert_ok(test_grid_make(crossing->client, 100, &grid));
    assert_ok(test_grid_turn(&grid, &settings, &answer));
    assert_int_equal(answer.incomplete, PCCD_INCOMPLETE_DEADLINE);
    assert_true(answer.total < 10000);
    pccd_answer_release(grid.client, &answer);
    settings.deadline_ns = 60000000000u;
    assert_ok(test_grid_turn(&grid, &settings, &answer));
    assert_true(test_grid_is_right(&grid, &answer)); /* it had moved on all the same */
    pccd_answer_release(grid.client, &answer);
    test_grid_free(&grid);
}

/* If it failed, a step that nobody wants any more would still be computed. */
CASE_CROSSING(flow__cancel_stops_a_step_and_only_that)
{
    struct test_crossing *crossing = *state;
    struct pccd_client *client = crossing->client;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    struct test_grid grid;
    uint64_t steps[4];

    if (test_is_direct()) {
        test_skip("with direct: it is done before it can be cancelled");
    }
    assert_ok(test_grid_make(client, 100, &grid));
    for (int i = 0; i < 4; i++) {
        assert_ok(test_grid_submit(&grid, NULL, &steps[i]));
    }
    assert_ok(pccd_cancel(client, steps[3]));
    for (int i = 0; i < 3; i++) {
        assert_ok(pccd_wait(client, steps[i], -1, &answer));
        assert_true(test_grid_is_right(&grid, &answer));
        pccd_answer_release(client, &answer);
    }
    assert_ok(pccd_wait(client, steps[3], -1, &answer));
    assert_int_equal(answer.incomplete, PCCD_INCOMPLETE_CANCELLED);
    pccd_answer_release(client, &answer);
    assert_int_equal(pccd_cancel(client, steps[3]), PCCD_E_INVAL);
    assert_ok(test_grid_submit(&grid, NULL, &steps[0]));
    assert_ok(pccd_wait(client, steps[0], -1, &answer));
    assert_true(test_grid_is_right(&grid, &answer));
    pccd_answer_release(client, &answer);
    test_grid_free(&grid);
}

/* If it failed, a daemon that hangs would hang its clients, or a late answer be taken for
 * another one. */
CASE_CROSSING(flow__timeouts_leave_the_client_usable)
{
    struct test_daemon daemon;
    struct pccd_client *client = NULL;
    struct test_crossing crossing;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    float up[3][3];
    float down[3][3];
    uint64_t begin_ms;
    uint64_t step;

    if (test_is_direct()) {
        test_skip("with direct: nobody answers late");
    }
    test_crossing_positions(up, 1);
    test_crossing_positions(down, -1);
    assert_true(test_daemon_start(&daemon, NULL));
    client = test_client(&(struct pccd_options){
        .url = daemon.url,
        .timeout_ms = 1500,
        .result_bytes = 65536}); /* a thousand steps on a busy machine are to meet it */
    assert_ok(test_crossing_make(client, &crossing));
    assert_true(test_crossing_turn(&crossing));
    assert_int_equal(kill(daemon.pid, SIGSTOP), 0);
    step = submit_turn(&crossing);
    begin_ms = test_now_ms();
    assert_int_equal(pccd_wait(client, step, 0, &answer), PCCD_E_AGAIN);
    assert_int_equal(pccd_wait(client, step, 30, &answer), PCCD_E_TIMEOUT);
    assert_int_equal(pccd_step_x0x1(client, crossing.scene, crossing.object, up, down,
                                    PCCD_FORMAT_F32, 3, NULL, &answer),
                     PCCD_E_TIMEOUT);
    assert_int_equal(pccd_ping(client, NULL), PCCD_E_TIMEOUT);
    assert_true(pccd_error_text(client)[0] != '\0');
    assert_true(test_now_ms() - begin_ms >= 3000);
    assert_true(test_now_ms() - begin_ms < 15000);
    assert_int_equal(kill(daemon.pid, SIGCONT), 0);
    assert_ok(pccd_wait(client, step, 10000, &answer)); /* not lost */
    assert_true(test_crossing_is_right(&crossing, &answer));
    /* The page of the abandoned step was released: the region goes round many times. */
    for (int i = 0; i < 1000; i++) {
        assert_ok(pccd_step_x0x1(client, crossing.scene, crossing.object, up, down,
                                 PCCD_FORMAT_F32, 3, NULL, &answer));
        assert_true(test_crossing_is_right(&crossing, &answer));
    }
    assert_int_equal(pccd_poll(client, &answer), PCCD_E_AGAIN);
    pccd_close(client);
    assert_true(test_daemon_finish(&daemon));
}

/* ---- residence --------------------------------------------------------------------- */

/* If it failed, steady simulation would pay again for what it has paid. */
CASE_CROSSING(flow__warm_steps_build_and_allocate_nothing)
{
    struct test_crossing *crossing = *state;
    struct pccd_client *client = crossing->client;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    struct test_grid grid;
    uint64_t upload;
    uint64_t builds;
    uint64_t bytes = 0;

    assert_ok(test_grid_make(client, 50, &grid));
    builds = test_stat(client, "builds");
    for (int i = 0; i < 8; i++) {
        upload = test_stat(client, "upload_bytes");
        assert_ok(test_grid_turn(&grid, NULL, &answer));
        assert_true(test_grid_is_right(&grid, &answer));
        assert_int_equal(answer.counters.builds, 0);
        assert_int_equal(test_stat(client, "step_builds_last"), 0);
        /* One copy: the positions and one segment, nothing else. */
        assert_int_equal(test_stat(client, "upload_bytes") - upload, 2500 * 12 + 32);
        if (i >= 1) {
            assert_int_equal(answer.counters.allocs, 0);
            assert_int_equal(test_stat(client, "step_allocs_last"), 0);
        }
        if (i == 1) {
            bytes = test_stat(client, "engine_bytes_now");
        }
        if (i > 1) {
            assert_int_equal(test_stat(client, "engine_bytes_now"), bytes);
        }
        pccd_answer_release(client, &answer);
    }
    assert_int_equal(test_stat(client, "builds"), builds);
    test_grid_free(&grid);
}

CASES_WITH(test_shared_start, test_shared_stop);
