/* test_int_quota.c - the quota of the engine's memory.
 *
 * Room:     tests/integration. May include: pccd.h, tests/support.
 * Does:     meshes and answers that do not fit, and what is left afterwards. Other quotas
 *           are in test_int_session.c and test_int_replace.c.
 * Threads:  one.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "crossing.h"
#include "daemon.h"
#include "grid.h"

#define FLOORS   200u
#define SIDE     40u
#define CONTACTS (FLOORS * SIDE * SIDE)

/* A grid that falls through a stack of floors: little geometry, many contacts. */
struct stack {
    struct test_grid grid;
    uint32_t floors;
};

static int make_stack(struct pccd_client *client, struct stack *stack)
{
    static float x[3 * FLOORS][3];
    static uint32_t triangles[FLOORS][3];
    uint32_t mesh = 0;

    for (uint32_t i = 0; i < 3 * FLOORS; i++) {
        x[i][0] = test_floor_x[i % 3][0];
        x[i][1] = test_floor_x[i % 3][1];
        x[i][2] = -0.5f + (float)(i / 3 + 1) / (float)(FLOORS + 2);
        triangles[i / 3][i % 3] = i;
    }
    if (test_grid_make(client, SIDE, &stack->grid) != 0 ||
        pccd_scene_remove(client, stack->grid.scene, stack->grid.floor) != 0 ||
        pccd_mesh_create(client, x, PCCD_FORMAT_F32, 3 * FLOORS,
                         (const uint32_t(*)[3])triangles, FLOORS, &mesh, NULL) != 0) {
        return -1;
    }
    return pccd_scene_add(client, stack->grid.scene, mesh, &stack->floors);
}

/* A turn through all floors. Returns a status. */
static int fall(struct stack *stack, struct pccd_answer *answer)
{
    uint64_t step = 0;
    int rc = test_grid_submit(&stack->grid, NULL, &step);

    return rc != 0 ? rc : pccd_wait(stack->grid.client, step, 60000, answer);
}

/* If it failed, the records of answers would be memory that nobody is charged for: a few
 * triangles are enough to fill the machine. */
static void memory__of_answers_is_bounded(void **state)
{
    static const char *const options[] = {"--memory-max-mib", "24", NULL};
    struct test_daemon daemon;
    struct pccd_client *client;
    struct pccd_answer answer;
    struct stack stack;
    uint64_t before;

    (void)state;
    assert_true(test_daemon_start(&daemon, options));
    client = test_connect(daemon.url);
    assert_non_null(client);
    before = test_stat(client, "engine_bytes_now");
    assert_int_equal(make_stack(client, &stack), 0);
    for (int i = 0; i < 4; i++) {
        assert_int_equal(fall(&stack, &answer), 0);
        assert_int_equal(answer.incomplete, PCCD_INCOMPLETE_CONTACT_LIMIT);
        assert_true(answer.total < CONTACTS);
        pccd_answer_release(client, &answer);
        assert_true(test_stat(client, "engine_bytes_now") <= before + (24u << 20));
    }
    assert_int_equal(pccd_scene_destroy(client, stack.grid.scene), 0);
    pccd_close(client);
    test_grid_free(&stack.grid);
    client = test_connect(daemon.url);
    assert_non_null(client);
    assert_int_equal(test_stat_await(client, "engine_bytes_now", before), before);
    pccd_close(client);
    assert_true(test_daemon_finish(&daemon));
}

/* If it failed, the quota would refuse what fits, or cut an answer without need. */
static void memory__within_the_quota_answers_are_whole(void **state)
{
    static const char *const options[] = {"--memory-max-mib", "256", NULL};
    struct test_daemon daemon;
    struct pccd_client *client;
    struct pccd_answer answer;
    struct stack stack;

    (void)state;
    assert_true(test_daemon_start(&daemon, options));
    client = test_connect(daemon.url);
    assert_non_null(client);
    assert_int_equal(make_stack(client, &stack), 0);
    for (int i = 0; i < 2; i++) {
        assert_int_equal(fall(&stack, &answer), 0);
        assert_int_equal(answer.total, CONTACTS);
        assert_int_equal(answer.vf, CONTACTS);
        assert_int_not_equal(answer.incomplete, PCCD_INCOMPLETE_CONTACT_LIMIT);
        pccd_answer_release(client, &answer);
    }
    pccd_close(client);
    test_grid_free(&stack.grid);
    assert_true(test_daemon_finish(&daemon));
}

/* If it failed, a mesh could take what its user may not have, or its refusal break what
 * is there, or stay for ever. */
static void memory__of_meshes_and_hierarchies_is_bounded(void **state)
{
    static const char *const options[] = {"--memory-max-mib", "16", NULL};
    struct test_daemon daemon;
    struct pccd_client *client;
    struct pccd_client *other;
    struct test_crossing crossing;
    struct test_grid grid;

    (void)state;
    assert_true(test_daemon_start(&daemon, options));
    other = test_connect(daemon.url);
    client = test_connect(daemon.url);
    assert_non_null(client);
    assert_non_null(other);
    assert_int_equal(test_crossing_make(other, &crossing), 0);
    assert_true(test_crossing_turn(&crossing));
    assert_true(test_crossing_turn(&crossing));
    for (int i = 0; i < 3; i++) {
        uint64_t step = 0;
        int rc = test_grid_make(client, 300, &grid); /* 178 802 triangles */

        if (rc == 0) {
            struct pccd_answer answer;

            rc = test_grid_submit(&grid, NULL, &step);
            rc = rc != 0 ? rc : pccd_wait(client, step, 60000, &answer);
        }
        assert_int_equal(rc, PCCD_E_QUOTA);
        assert_non_null(strstr(pccd_error_text(client), "engine's memory"));
        assert_true(test_crossing_turn(&crossing));
        test_grid_free(&grid);
        pccd_close(client);
        client = test_connect(daemon.url);
        assert_non_null(client);
    }
    /* Everything of the refused ones has been given back. */
    assert_int_equal(test_stat_await(other, "meshes_now", 2), 2);
    assert_int_equal(test_grid_make(client, 30, &grid), 0);
    test_grid_free(&grid);
    pccd_close(client);
    pccd_close(other);
    assert_true(test_daemon_finish(&daemon));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(memory__of_answers_is_bounded),
        cmocka_unit_test(memory__within_the_quota_answers_are_whole),
        cmocka_unit_test(memory__of_meshes_and_hierarchies_is_bounded),
    };

    return cmocka_run_group_tests_name("quota", tests, NULL, NULL);
}
