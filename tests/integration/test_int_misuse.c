/* test_int_misuse.c - calls in an order that few programs have them in.
 *
 * Room:     tests/integration. May include: pccd.h, tests/support.
 * Does:     hold on to answers while others are asked for; name scenes that are not
 *           there. It is an error or nothing, and what others asked for stays right.
 * Threads:  one.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "fixture.h"

#define PAGES 300 /* more than the library keeps account of */

/* ---- answers that are held --------------------------------------------------------- */

/* A turn of the crossing whose answer is held: it has records. */
static void turn(struct test_crossing *crossing, struct pccd_answer *answer)
{
    float x[3][3];

    crossing->z = -crossing->z;
    test_crossing_positions(x, crossing->z);
    assert_int_equal(pccd_step_x1(crossing->client, crossing->scene, crossing->object, x,
                                  PCCD_FORMAT_F32, 3, NULL, answer),
                     0);
    assert_true(answer->count > 0);
}

/* If it failed, who shows edges or boxes while an answer is held would be told of a
 * daemon that talks nonsense; or the answer to a step be lost to it. */
static void misuse__pages_that_are_held_take_no_step_its_answer(void **state)
{
    struct test_crossing *crossing = *state;
    struct pccd_client *client = crossing->client;
    struct pccd_edge edges[3];
    struct pccd_answer held;
    struct pccd_answer answer;
    uint64_t step = 0;
    int rc = 0;

    turn(crossing, &held);
    for (int i = 0; i < PAGES && rc == 0; i++) {
        rc = pccd_mesh_edges(client, crossing->mesh, edges, 3);
    }
    assert_int_equal(rc, PCCD_E_BUSY);
    assert_non_null(strstr(pccd_error_text(client), "release"));
    pccd_answer_release(client, &held);
    assert_int_equal(pccd_mesh_edges(client, crossing->mesh, edges, 3), 0);

    turn(crossing, &held);
    assert_int_equal(pccd_submit_still(client, crossing->scene, NULL, &step), 0);
    for (int i = 0; i < PAGES; i++) {
        uint32_t count = 0;
        struct pccd_box box;

        (void)pccd_scene_boxes(client, crossing->scene, PCCD_TREE_FACES, 0, &box, 1,
                               &count);
        (void)pccd_mesh_edges(client, crossing->mesh, edges, 3);
    }
    assert_int_equal(pccd_wait(client, step, -1, &answer), 0);
    pccd_answer_release(client, &answer);
    pccd_answer_release(client, &held);
    assert_true(test_crossing_turn(crossing));
}

/* ---- news of shared scenes --------------------------------------------------------- */

static uint32_t share(struct pccd_client *client, const char *name)
{
    const struct pccd_scene_settings settings = {.name = name, .share = PCCD_SHARE_OPEN};
    uint32_t scene = 0;

    assert_int_equal(pccd_scene_create(client, &settings, &scene), 0);
    return scene;
}

/* A step that another client is told of. */
static void step(struct pccd_client *client, uint32_t scene)
{
    struct pccd_answer answer;
    uint64_t number = 0;

    assert_int_equal(pccd_submit_still(client, scene, NULL, &number), 0);
    assert_int_equal(pccd_wait(client, number, -1, &answer), 0);
    pccd_answer_release(client, &answer);
}

/* If it failed, a handle that is not there, as of a scene that could not be made, would
 * take news of other scenes along. */
static void misuse__a_scene_that_is_not_there_has_nothing_to_forget(void **state)
{
    struct pccd_client *reader = test_connect(test_shared.url);
    struct pccd_client *writer = test_connect(test_shared.url);
    struct pccd_scene_news news;
    uint32_t scene;

    (void)state;
    assert_non_null(reader);
    assert_non_null(writer);
    scene = share(reader, "news");
    step(writer, share(writer, "news"));
    assert_int_equal(pccd_ping(reader, NULL), 0); /* the news have come */
    assert_int_equal(pccd_scene_destroy(reader, 0), PCCD_E_HANDLE);
    assert_int_equal(pccd_scene_wait(reader, scene, 0, &news), 0);
    assert_int_equal(news.number, 1);
    pccd_close(writer);
    pccd_close(reader);
}

/* If it failed, a client that takes part in one scene after the other would hear of no
 * more steps in the end. */
static void misuse__scenes_that_are_left_while_others_step_are_forgotten(void **state)
{
    struct pccd_client *reader = test_connect(test_shared.url);
    struct pccd_client *writer = test_connect(test_shared.url);
    struct pccd_scene_news news;
    char name[16];

    (void)state;
    assert_non_null(reader);
    assert_non_null(writer);
    for (int i = 0; i < 80; i++) {
        uint32_t scene;
        uint32_t theirs;

        (void)snprintf(name, sizeof(name), "left %d", i);
        scene = share(reader, name);
        theirs = share(writer, name);
        step(writer, theirs); /* what it says is not taken in yet */
        assert_int_equal(pccd_scene_destroy(reader, scene), 0);
        assert_int_equal(pccd_scene_destroy(writer, theirs), 0);
    }
    {
        uint32_t scene = share(reader, "last");

        step(writer, share(writer, "last"));
        assert_int_equal(pccd_scene_wait(reader, scene, -1, &news), 0);
        assert_int_equal(news.number, 1);
    }
    pccd_close(writer);
    pccd_close(reader);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(
            misuse__pages_that_are_held_take_no_step_its_answer, test_crossing_open,
            test_crossing_close),
        cmocka_unit_test(misuse__a_scene_that_is_not_there_has_nothing_to_forget),
        cmocka_unit_test(misuse__scenes_that_are_left_while_others_step_are_forgotten),
    };

    return cmocka_run_group_tests_name("misuse", tests, test_shared_start,
                                       test_shared_stop);
}
