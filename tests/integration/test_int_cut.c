/* test_int_cut.c - answers that are cut, and how long they are kept, with a real
 * daemon. */
#include "cases.h"
#include "fixture.h"
#include "grid.h"
#include "must.h"
#include "pccd.h"

#define SIDE  60u
#define LIMIT 2000u

static struct pccd_client *client;

static int open_client(void **state)
{
    struct pccd_options options;
    (void)state;
    pccd_options_init(&options);
    options.url = test_shared.url;
    return pccd_connect(&options, &client);
}

static int close_client(void **state)
{
    (void)state;
    pccd_close(client);
    return 0;
}

/* All pages of the answer, in `records`. Returns how many of them. */
static uint64_t read_all(const struct test_grid *grid, struct pccd_answer *answer,
                         struct pccd_contact *records)
{
    enum pccd_incomplete incomplete = answer->incomplete;
    uint64_t got = 0;
    for (;;) {
        memcpy(records + got, answer->contacts, answer->count * sizeof *records);
        got += answer->count;
        uint64_t step = answer->step;
        uint64_t cursor = answer->cursor;
        assert_int_equal(cursor, got);
        pccd_answer_release(grid->client, answer);
        if (cursor == answer->total) {
            return got;
        }
        assert_ok(pccd_fetch(grid->client, grid->scene, step, cursor, answer));
        /* Full pages end, what was cut stays so. */
        assert_int_equal(answer->incomplete,
                         answer->cursor == answer->total &&
                                 incomplete == PCCD_INCOMPLETE_RESULT_FULL
                             ? PCCD_COMPLETE
                             : incomplete);
    }
}

static void fall(struct test_grid *grid, enum pccd_method method,
                 struct pccd_answer *answer)
{
    const struct pccd_step_settings settings = {
        .struct_bytes = sizeof(struct pccd_step_settings), .method = method};
    uint64_t step = 0;
    assert_ok(test_grid_submit(grid, &settings, &step));
    assert_ok(pccd_wait(grid->client, step, -1, answer));
}

/* If it failed, what an answer with too many records keeps would be left to chance, or
 * could not be read to its end, or the scene would not have moved on. */
CASE_WITH(incomplete__at_the_limit_keeps_the_first_records_in_order, open_client,
          close_client)
{
    struct pccd_contact *whole = malloc(SIDE * SIDE * sizeof *whole);
    struct pccd_contact *kept = malloc(LIMIT * sizeof *kept);
    struct pccd_client *usual = client;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    struct test_grid grid;
    assert_true(whole != NULL && kept != NULL);
    client = test_client(&(struct pccd_options){
        .url = test_shared.url, .result_bytes = 65536}); /* 1024 records */
    assert_ok(test_grid_make(client, SIDE, &grid));
    for (enum pccd_method method = PCCD_METHOD_PAPER; method < PCCD_METHOD_COUNT;
         method++) {
        fall(&grid, method, &answer);
        assert_int_equal(answer.incomplete, PCCD_INCOMPLETE_RESULT_FULL);
        assert_int_equal(read_all(&grid, &answer, whole), SIDE * SIDE);
        fall(&grid, method, &answer); /* back */
        pccd_answer_release(client, &answer);
        assert_ok(pccd_config_set(client, "contacts-max", "2000"));
        fall(&grid, method, &answer); /* the first way once more */
        assert_ok(pccd_config_set(client, "contacts-max", "16777216"));
        assert_int_equal(answer.incomplete, PCCD_INCOMPLETE_CONTACT_LIMIT);
        assert_int_equal(answer.total, LIMIT);
        assert_int_equal(answer.counts[PCCD_VF] + answer.counts[PCCD_EE], LIMIT);
        assert_int_equal(read_all(&grid, &answer, kept), LIMIT);
        assert_memory_equal(kept, whole, LIMIT * sizeof *kept);
        fall(&grid, method, &answer); /* it had moved on: this is the way back */
        assert_int_equal(read_all(&grid, &answer, whole), SIDE * SIDE);
    }
    test_grid_free(&grid);
    pccd_close(client);
    client = usual;
    free(whole);
    free(kept);
}

/* If it failed, mode first at the limit would keep what is not among the earliest, or
 * take itself for whole. */
CASE_WITH(incomplete__at_the_limit_keeps_some_of_the_first, open_client, close_client)
{
    const struct pccd_step_settings settings = {
        .struct_bytes = sizeof(struct pccd_step_settings), .mode = PCCD_MODE_FIRST};
    struct test_crossing crossing; /* its three contacts begin at the same time */
    struct pccd_contact whole[3];
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    float x[3][3];
    assert_ok(test_crossing_make(client, &crossing));
    for (int turn = 0; turn < 3; turn++) {
        crossing.z = -crossing.z;
        test_crossing_positions(x, crossing.z);
        assert_ok(pccd_config_set(client, "contacts-max", turn < 2 ? "16777216" : "2"));
        assert_ok(test_crossing_step(&crossing, x, &settings, &answer));
        if (turn == 0) {
            assert_int_equal(answer.incomplete, PCCD_COMPLETE);
            assert_int_equal(answer.count, 3);
            memcpy(whole, answer.contacts, sizeof whole);
        }
        if (turn < 2) {
            pccd_answer_release(client, &answer);
        }
    }
    assert_ok(pccd_config_set(client, "contacts-max", "16777216"));
    assert_int_equal(answer.incomplete, PCCD_INCOMPLETE_CONTACT_LIMIT);
    assert_int_equal(answer.total, 2);
    for (uint64_t i = 0; i < answer.count; i++) {
        uint32_t vertex = answer.contacts[i].feature_a;
        assert_in_range(vertex, 0, 2);
        assert_memory_equal(&answer.contacts[i], &whole[vertex], sizeof whole[0]);
    }
    pccd_answer_release(client, &answer);
}

/* If it failed, an answer could be read for longer than is said, or not as long. */
CASE_WITH(answer__is_kept_until_a_step_or_until_its_objects_change, open_client,
          close_client)
{
    struct test_crossing crossing;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    struct pccd_answer page = PCCD_ANSWER_INIT;
    uint64_t still = 0;
    uint32_t more = 0;
    float x[3][3];
    assert_ok(test_crossing_make(client, &crossing));
    for (int change = 0; change < 4; change++) {
        crossing.z = -crossing.z;
        test_crossing_positions(x, crossing.z);
        assert_ok(test_crossing_step(&crossing, x, NULL, &answer));
        uint64_t step = answer.step;
        pccd_answer_release(client, &answer);
        if (change == 0) { /* an object that comes takes nothing away */
            more = test_object(client, crossing.scene, crossing.mesh);
        } else if (change == 1) {
            assert_ok(pccd_scene_remove(client, crossing.scene, more));
        } else if (change == 2) {
            assert_ok(pccd_mesh_replace(client, crossing.floor_mesh, test_floor_x,
                                        PCCD_FORMAT_F32, 3, test_triangle, 1, NULL));
        } else {
            assert_ok(pccd_submit_still(client, crossing.scene, NULL, &still));
            assert_ok(pccd_wait(client, still, -1, &answer));
            pccd_answer_release(client, &answer);
        }
        int expected = change == 0 ? PCCD_OK : PCCD_E_STATE;
        assert_int_equal(pccd_fetch(client, crossing.scene, step, 0, &page), expected);
        if (expected == PCCD_OK) {
            assert_int_equal(page.count, 3);
            pccd_answer_release(client, &page);
        }
    }
}

CASES_WITH(test_shared_start, test_shared_stop);
