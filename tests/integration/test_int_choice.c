/* test_int_choice.c - the ways to compute that a client may choose between. */
#include "cases.h"
#include "fixture.h"
#include "grid.h"
#include "pccd.h"

#define SIDE       40u  /* of the grid: enough triangles for several threads */
#define SIDE_LARGE 128u /* so much work that threads share it, however fast they are */
#define THREADS    3u

/* Two turns of a grid; *answer is the second's. */
static void turn(struct pccd_client *client, const struct pccd_step_settings *settings,
                 struct pccd_answer *answer)
{
    struct test_grid grid;

    assert_ok(test_grid_make(client, SIDE_LARGE, &grid));
    for (int i = 0; i < 2; i++) {
        assert_ok(test_grid_turn(&grid, settings, answer));
        assert_true(test_grid_is_right(&grid, answer));
        pccd_answer_release(client, answer);
    }
    assert_ok(pccd_scene_destroy(client, grid.scene));
    assert_ok(pccd_mesh_destroy(client, grid.mesh));
    test_grid_free(&grid);
}

/* Append one of them to a tuning, or nothing. */
static void choose(char tuning[PCCD_TUNING_BYTES], const char *first, const char *second,
                   uint32_t which)
{
    size_t used = strlen(tuning);
    if (which > 0) {
        snprintf(tuning + used, PCCD_TUNING_BYTES - used, "%s%s", used > 0 ? "," : "",
                 which == 1 ? first : second);
    }
}

/* The records of different scenes differ in the handles of the objects, so each hash is
 * compared with one of the same scene: turns down, and turns up again. */
static void expect_same_hash(struct pccd_client *client)
{
    struct pccd_step_settings settings = {
        .struct_bytes = sizeof(struct pccd_step_settings), .threads = 1};
    struct test_grid grid;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    uint64_t hash[2][2];

    assert_ok(test_grid_make(client, SIDE, &grid));
    for (uint32_t i = 0; i < 2 + 3 * 3 * 3 * 3 * 2; i++) {
        char tuning[PCCD_TUNING_BYTES] = "";
        uint32_t choice = i < 2 ? 0 : (i - 2) / 2;

        settings.threads = i < 2 ? 1 : THREADS;
        choose(tuning, "scheduler=steal", "scheduler=paper", choice % 3);
        choose(tuning, "high-level=round-robin", "high-level=disjoint", choice / 3 % 3);
        choose(tuning, "refit=even", "refit=paper", choice / 9 % 3);
        settings.tuning = choice % 27 == 0 ? NULL : tuning;
        settings.method = (enum pccd_method)(choice / 27);
        assert_ok(test_grid_turn(&grid, &settings, &answer));
        assert_true(test_grid_is_right(&grid, &answer));
        if (i < 2) {
            memcpy(hash[i], answer.hash, sizeof hash[i]);
        }
        assert_memory_equal(hash[i % 2], answer.hash, sizeof answer.hash);
        pccd_answer_release(client, &answer);
    }
    assert_ok(pccd_scene_destroy(client, grid.scene));
    assert_ok(pccd_mesh_destroy(client, grid.mesh));
    test_grid_free(&grid);
}

/* If it failed, the answer would depend on how it was computed. */
CASE_CROSSING(choice__no_way_to_compute_changes_the_hash)
{
    struct test_crossing *crossing = *state;

    expect_same_hash(crossing->client);
}

/* If it failed, a client could not tell by which way its step was computed. */
CASE_CROSSING(choice__the_answer_says_what_was_used)
{
    struct test_crossing *crossing = *state;
    struct pccd_client *client = crossing->client;
    struct pccd_step_settings settings = {
        .struct_bytes = sizeof(struct pccd_step_settings), .threads = THREADS};
    struct pccd_answer answer = PCCD_ANSWER_INIT;

    turn(client, &settings, &answer);
    assert_int_equal(answer.threads, THREADS);
    assert_string_equal(answer.tuning, "scheduler=steal,refit=even");

    settings.tuning = "refit=even,high-level=disjoint,scheduler=steal";
    turn(client, &settings, &answer); /* stealing has no high-level nodes */
    assert_string_equal(answer.tuning, "scheduler=steal,refit=even");

    settings.tuning = "scheduler=paper,high-level=disjoint,refit=paper";
    turn(client, &settings, &answer);
    assert_string_equal(answer.tuning, settings.tuning);
    settings.tuning = "scheduler=paper";
    turn(client, &settings, &answer);
    assert_string_equal(answer.tuning,
                        "scheduler=paper,high-level=round-robin,refit=even");

    settings.tuning = "scheduler=paper,high-level=disjoint,refit=paper";
    settings.method = PCCD_METHOD_WIDE; /* always steals, refits in one way */
    turn(client, &settings, &answer);
    assert_string_equal(answer.tuning, "scheduler=steal,refit=even");
    settings.method = PCCD_METHOD_DEFAULT;

    settings.threads = 1;
    turn(client, &settings, &answer);
    assert_int_equal(answer.threads, 1);
    assert_string_equal(answer.tuning, "");
    for (int method = PCCD_METHOD_PAPER; method < PCCD_METHOD_COUNT; method++) {
        settings.method = (enum pccd_method)method;
        turn(client, &settings, &answer);
        assert_int_equal(answer.method, method);
    }
}

/* If it failed, a choice that this daemon does not know would be taken for another. */
CASE_CROSSING(choice__unknown_values_are_refused_by_name)
{
    struct test_crossing *crossing = *state;
    struct pccd_client *client = crossing->client;
    const struct {
        struct pccd_step_settings settings;
        const char *text;
    } wrong[] = {
        {{.mode = PCCD_MODE_COUNT}, "unknown mode 5"},
        {{.tuning = "scheduler=fast"},
         "tuning: scheduler: \"fast\" is not steal or paper"},
        {{.tuning = "refit=paper,high-level="}, "high-level: \"\" is not round-robin or"},
        {{.tuning = "refit"}, "\"refit\" is none of scheduler=, high-level=, refit="},
        {{.tuning = "refit=even,"}, "tuning: it ends with a comma"},
        {{.tuning = ",refit=even"}, "tuning: \"\" is none of"},
        {{.tuning = "refit=even,refit=even"}, "refit: \"even\" is a second value, of"},
        {{.tuning = "speed=\xc3\xbc!"}, "tuning: \"speed=\?\?!\" is none of"},
        {{.tuning = "scheduler=paper,high-level=disjoint,refit=paper,scheduler=steal,"},
         "tuning: longer than 63 bytes"},
    };
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    float x1[3][3];

    test_crossing_positions(x1, -1);
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        struct pccd_step_settings settings = wrong[i].settings;

        settings.struct_bytes = sizeof settings;
        assert_int_equal(test_crossing_step(crossing, x1, &settings, &answer),
                         PCCD_E_INVAL);
        assert_non_null(strstr(pccd_error_text(client), wrong[i].text));
    }
    assert_true(test_crossing_turn(crossing)); /* from where it was */
}

CASES_WITH_DAEMON("--threads", "3");
