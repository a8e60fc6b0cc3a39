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
#include <sys/wait.h>
#include <unistd.h>

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
    struct pccd_answer held = PCCD_ANSWER_INIT;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    uint64_t step = 0;
    int status = 0;

    turn(crossing, &held);
    for (int i = 0; i < PAGES && status == 0; i++) {
        status = pccd_mesh_edges(client, crossing->mesh, edges, 3);
    }
    assert_int_equal(status, PCCD_E_BUSY);
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

/* ---- a process that forks ---------------------------------------------------------- */

/* In the copy: how many calls did something. */
static int misuse_copy(struct test_crossing *crossing, struct pccd_frame *frame,
                       uint64_t step, struct pccd_answer *held)
{
    struct pccd_client *client = crossing->client;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    struct pccd_frame another;
    void *to = NULL;
    uint64_t number = 0;
    int wrong = 0;

    wrong += pccd_ping(client, NULL) != PCCD_E_DISCONNECTED;
    wrong += pccd_frame_x1(frame, crossing->floor, PCCD_FORMAT_F32, 0, 1, &to) !=
             PCCD_E_DISCONNECTED;
    wrong += pccd_frame_commit(frame, NULL, &number) != PCCD_E_DISCONNECTED;
    pccd_frame_abort(frame);
    wrong +=
        pccd_frame_begin(client, crossing->scene, 1, 64, &another) != PCCD_E_DISCONNECTED;
    wrong += pccd_wait(client, step, -1, &answer) != PCCD_E_DISCONNECTED;
    wrong += pccd_poll(client, &answer) != PCCD_E_DISCONNECTED;
    pccd_answer_release(client, held);
    pccd_close(client);
    return wrong;
}

/* If it failed, a game that forks while it computes would lose answers to the copy, or
 * have it write into the frame at hand. */
static void misuse__a_forked_copy_touches_nothing(void **state)
{
    struct test_crossing *crossing = *state;
    struct pccd_client *client = crossing->client;
    struct pccd_answer held = PCCD_ANSWER_INIT;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    struct pccd_frame frame;
    void *to = NULL;
    uint64_t still = 0;
    uint64_t step = 0;
    float x[3][3];
    pid_t child;
    int status = 0;

    turn(crossing, &held);
    crossing->z = -crossing->z;
    test_crossing_positions(x, crossing->z);
    assert_int_equal(pccd_frame_begin(client, crossing->scene, 2, sizeof x, &frame), 0);
    assert_int_equal(pccd_frame_x1(&frame, crossing->object, PCCD_FORMAT_F32, 0, 3, &to),
                     0);
    assert_int_equal(pccd_submit_still(client, crossing->scene, NULL, &still), 0);
    child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        test_end_with_parent();
        _exit(misuse_copy(crossing, &frame, still, &held));
    }
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFEXITED(status));
    assert_int_equal(WEXITSTATUS(status), 0);
    assert_int_equal(pccd_wait(client, still, -1, &answer), 0);
    pccd_answer_release(client, &answer);
    memcpy(to, x, sizeof x);
    assert_int_equal(pccd_frame_commit(&frame, NULL, &step), 0);
    assert_int_equal(pccd_wait(client, step, -1, &answer), 0);
    assert_true(test_crossing_is_right(crossing, &answer));
    pccd_answer_release(client, &held);
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
    struct pccd_answer answer = PCCD_ANSWER_INIT;
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

        (void)snprintf(name, sizeof name, "left %d", i);
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
        cmocka_unit_test_setup_teardown(misuse__a_forked_copy_touches_nothing,
                                        test_crossing_open, test_crossing_close),
        cmocka_unit_test(misuse__a_scene_that_is_not_there_has_nothing_to_forget),
        cmocka_unit_test(misuse__scenes_that_are_left_while_others_step_are_forgotten),
    };

    return cmocka_run_group_tests_name("misuse", tests, test_shared_start,
                                       test_shared_stop);
}
