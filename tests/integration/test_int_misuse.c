/* test_int_misuse.c - calls in an order that few programs have them in, and with NULL. */
#include "cases.h"

#include <pthread.h>
#include <stdatomic.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "fixture.h"
#include "must.h"

#define PAGES 300 /* more than the library keeps account of */

/* ---- answers that are held --------------------------------------------------------- */

/* A turn of the crossing whose answer is held: it has records. */
static void turn(struct test_crossing *crossing, struct pccd_answer *answer)
{
    float x[3][3];

    crossing->z = -crossing->z;
    test_crossing_positions(x, crossing->z);
    assert_ok(test_crossing_step(crossing, x, NULL, answer));
    assert_true(answer->count > 0);
}

/* If it failed, who shows edges or boxes while an answer is held would be told of a
 * daemon that talks nonsense; or the answer to a step be lost to it. */
CASE_CROSSING(misuse__pages_that_are_held_take_no_step_its_answer)
{
    struct test_crossing *crossing = *state;
    struct pccd_client *client = crossing->client;
    struct pccd_edge edges[3];
    struct pccd_answer held = PCCD_ANSWER_INIT;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    uint64_t step = 0;
    char text[64];
    int status = 0;

    turn(crossing, &held);
    for (int i = 0; i < PAGES && status == 0; i++) {
        status = pccd_mesh_edges(client, crossing->mesh, edges, 3);
    }
    assert_int_equal(status, PCCD_E_BUSY);
    (void)snprintf(text, sizeof text, "the answer to step %llu, release it",
                   (unsigned long long)held.step);
    assert_non_null(strstr(pccd_error_text(client), text));
    pccd_answer_release(client, &held);
    assert_int_equal(held.count, 0);
    assert_ok(pccd_mesh_edges(client, crossing->mesh, edges, 3));

    turn(crossing, &held);
    assert_ok(pccd_submit_still(client, crossing->scene, NULL, &step));
    for (int i = 0; i < PAGES; i++) {
        uint32_t count = 0;
        struct pccd_box box;

        (void)pccd_scene_boxes(client, crossing->scene, PCCD_TREE_FACES, 0, &box, 1,
                               &count);
        (void)pccd_mesh_edges(client, crossing->mesh, edges, 3);
    }
    assert_ok(pccd_wait(client, step, -1, &answer));
    pccd_answer_release(client, &answer);
    pccd_answer_release(client, &held);
    assert_true(test_crossing_turn(crossing));
}

/* If it failed, a step that is refused would make the records lost that its answer still
 * had, and a loop that goes on would end by it some hundred steps later. */
CASE_CROSSING(misuse__a_step_that_fails_leaves_the_records_of_its_answer)
{
    struct test_crossing *crossing = *state;
    struct pccd_client *client = crossing->client;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    uint64_t step = 0;

    const struct pccd_motion huge = {
        .object = crossing->object, .count = UINT32_MAX, .x1 = test_floor_x};

    /* No slot may have so many: nothing is read, and the daemon does not hear of it. */
    assert_int_equal(pccd_submit(client, crossing->scene, &huge, 1, NULL, &step),
                     PCCD_E_QUOTA);
    for (int i = 0; i < PAGES; i++) {
        turn(crossing, &answer);
        const struct pccd_contact first = answer.contacts[0];
        const struct pccd_motion wrong = {.object = crossing->object,
                                          .first = 3,
                                          .count = 1,
                                          .x1 = test_floor_x};

        assert_ok(pccd_submit(client, crossing->scene, &wrong, 1, NULL, &step));
        assert_int_equal(pccd_wait(client, step, -1, &answer), PCCD_E_SEGMENT);
        assert_int_equal(answer.status, PCCD_E_SEGMENT);
        assert_int_equal(answer.step, step);
        assert_memory_equal(&answer.contacts[0], &first, sizeof first);
        pccd_answer_release(client, &answer);
    }
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
CASE_CROSSING(misuse__a_forked_copy_touches_nothing)
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
    assert_ok(pccd_frame_begin(client, crossing->scene, 2, sizeof x, &frame));
    assert_ok(pccd_frame_x1(&frame, crossing->object, PCCD_FORMAT_F32, 0, 3, &to));
    assert_ok(pccd_submit_still(client, crossing->scene, NULL, &still));
    child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        test_end_with_parent();
        _exit(misuse_copy(crossing, &frame, still, &held));
    }
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFEXITED(status));
    assert_int_equal(WEXITSTATUS(status), 0);
    assert_ok(pccd_wait(client, still, -1, &answer));
    pccd_answer_release(client, &answer);
    memcpy(to, x, sizeof x);
    assert_ok(pccd_frame_commit(&frame, NULL, &step));
    assert_ok(pccd_wait(client, step, -1, &answer));
    assert_true(test_crossing_is_right(crossing, &answer));
    pccd_answer_release(client, &held);
}

/* ---- news of shared scenes --------------------------------------------------------- */

static uint32_t share(struct pccd_client *client, const char *name)
{
    const struct pccd_scene_settings settings = {.name = name, .share = PCCD_SHARE_OPEN};
    uint32_t scene = 0;

    assert_ok(pccd_scene_create(client, &settings, &scene));
    return scene;
}

/* A step that another client is told of. */
static void step(struct pccd_client *client, uint32_t scene)
{
    struct pccd_answer answer = PCCD_ANSWER_INIT;

    test_still(client, scene, NULL, &answer);
    pccd_answer_release(client, &answer);
}

/* If it failed, a handle that is not there, as of a scene that could not be made, would
 * take news of other scenes along. */
CASE(misuse__a_scene_that_is_not_there_has_nothing_to_forget)
{
    struct pccd_client *reader = test_client_at(test_shared.url);
    struct pccd_client *writer = test_client_at(test_shared.url);
    struct pccd_scene_news news;
    uint32_t scene;

    scene = share(reader, "news");
    step(writer, share(writer, "news"));
    assert_ok(pccd_ping(reader, NULL)); /* the news have come */
    assert_int_equal(pccd_scene_destroy(reader, 0), PCCD_E_HANDLE);
    assert_ok(pccd_scene_wait(reader, scene, 0, &news));
    assert_int_equal(news.number, 1);
    pccd_close(writer);
    pccd_close(reader);
}

/* If it failed, a client that takes part in one scene after the other would hear of no
 * more steps in the end. */
CASE(misuse__scenes_that_are_left_while_others_step_are_forgotten)
{
    struct pccd_client *reader = test_client_at(test_shared.url);
    struct pccd_client *writer = test_client_at(test_shared.url);
    struct pccd_scene_news news;
    char name[16];

    for (int i = 0; i < 80; i++) {
        uint32_t scene;
        uint32_t theirs;

        (void)snprintf(name, sizeof name, "left %d", i);
        scene = share(reader, name);
        theirs = share(writer, name);
        step(writer, theirs); /* what it says is not taken in yet */
        assert_ok(pccd_scene_destroy(reader, scene));
        assert_ok(pccd_scene_destroy(writer, theirs));
    }
    {
        uint32_t scene = share(reader, "last");

        step(writer, share(writer, "last"));
        assert_ok(pccd_scene_wait(reader, scene, -1, &news));
        assert_int_equal(news.number, 1);
    }
    pccd_close(writer);
    pccd_close(reader);
}

/* ---- twice, or too late ------------------------------------------------------------ */

/* If it failed, a frame that was copied, as by a struct around it, could send or give
 * back what another one has begun. */
CASE_CROSSING(misuse__a_copy_of_a_frame_is_over_when_it_is)
{
    struct test_crossing *crossing = *state;
    struct pccd_client *client = crossing->client;
    struct pccd_frame frame;
    struct pccd_frame copy;
    struct pccd_frame next;
    uint64_t step = 0;
    void *to = NULL;
    float x[3][3];

    for (int i = 0; i < 40; i++) { /* more often than there are slots */
        assert_ok(pccd_frame_begin(client, crossing->scene, 1, 512, &frame));
        copy = frame;
        pccd_frame_abort(&frame);
        pccd_frame_abort(&frame);
        assert_ok(pccd_frame_begin(client, crossing->scene, 1, 512, &next));
        assert_int_equal(
            pccd_frame_x1(&copy, crossing->object, PCCD_FORMAT_F32, 0, 3, &to),
            PCCD_E_INVAL);
        pccd_frame_abort(&copy);
        assert_int_equal(pccd_frame_commit(&copy, NULL, &step), PCCD_E_INVAL);
        assert_non_null(strstr(pccd_error_text(client), "not begun"));
        crossing->z = -crossing->z;
        test_crossing_positions(x, crossing->z);
        assert_ok(pccd_frame_x1(&next, crossing->object, PCCD_FORMAT_F32, 0, 3, &to));
        memcpy(to, x, sizeof x);
        assert_ok(pccd_frame_commit(&next, NULL, &step));
        assert_int_equal(pccd_frame_commit(&next, NULL, &step), PCCD_E_INVAL);
        {
            struct pccd_answer answer = PCCD_ANSWER_INIT;

            assert_ok(pccd_wait(client, step, -1, &answer));
            assert_true(test_crossing_is_right(crossing, &answer));
        }
    }
}

/* If it failed, a program that ends in the order in which things came to it, its client
 * first, would end by a signal. */
CASE(misuse__a_batch_outlives_its_client)
{
    struct pccd_client *client = test_client_at(test_shared.url);
    struct test_crossing crossing;
    struct pccd_batch *batches[3] = {NULL};
    struct pccd_batch_answer answer = PCCD_BATCH_ANSWER_INIT;
    struct pccd_batch_part part = {.format = PCCD_FORMAT_F32, .count = 3};
    const float x[3][3] = {{0}};
    const void *from[1] = {x};
    void *x1[1] = {NULL};
    uint64_t step = 0;

    assert_ok(test_crossing_make(client, &crossing));
    part.scene = crossing.scene;
    part.object = crossing.object;
    for (int i = 0; i < 3; i++) {
        assert_ok(pccd_batch_create(client, &part, 1, &batches[i]));
    }
    pccd_batch_destroy(batches[1]); /* between the others */
    assert_ok(pccd_batch_begin(batches[0], NULL, x1));
    assert_int_equal(pccd_batch_begin(batches[0], NULL, x1), PCCD_E_STATE);
    assert_int_equal(pccd_batch_commit(batches[2], NULL, &step), PCCD_E_STATE);
    pccd_batch_abort(batches[2]);
    pccd_close(client);
    assert_int_equal(pccd_batch_begin(batches[0], NULL, x1), PCCD_E_DISCONNECTED);
    assert_non_null(strstr(pccd_error_text(NULL), "closed"));
    assert_int_equal(pccd_batch_commit(batches[0], NULL, &step), PCCD_E_DISCONNECTED);
    assert_int_equal(pccd_batch_submit(batches[2], NULL, from, NULL, &step),
                     PCCD_E_DISCONNECTED);
    assert_int_equal(pccd_batch_step(batches[2], NULL, from, NULL, &answer),
                     PCCD_E_DISCONNECTED);
    assert_int_equal(pccd_batch_scenes(batches[0]), 1);
    pccd_batch_abort(batches[0]);
    pccd_batch_destroy(batches[0]);
    pccd_batch_destroy(batches[2]);
}

static void close_there(void *context, const char *name, uint64_t value, const char *text)
{
    (void)name, (void)value, (void)text;
    pccd_close(context);
}

/* If it failed, a function that the library calls could take the client away from under
 * it. */
CASE_CROSSING(misuse__a_callback_does_not_close_its_client)
{
    struct test_crossing *crossing = *state;

    assert_ok(pccd_stats(crossing->client, close_there, crossing->client));
    assert_true(test_crossing_turn(crossing));
}

/* If it failed, positions that pccd_step_safe writes over what it reads would be taken
 * for where the body came from. */
CASE_CROSSING(misuse__step_safe_wants_memory_of_its_own)
{
    struct test_crossing *crossing = *state;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    float x0[4][3] = {{0}};
    float x1[4][3] = {{0}};
    const struct pccd_motion motion = {.object = crossing->object,
                                       .count = 3,
                                       .format = PCCD_FORMAT_F32,
                                       .x0 = x0,
                                       .x1 = x1};
    void *const wrong[] = {x0, x1, x0[2], x1[2]};
    double part = 0;

    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        assert_int_equal(pccd_step_safe(crossing->client, crossing->scene, &motion, 1,
                                        NULL, &wrong[i], &part, &answer),
                         PCCD_E_INVAL);
        assert_non_null(strstr(pccd_error_text(crossing->client), "lies in"));
    }
    assert_true(test_crossing_turn(crossing));
}

/* ---- several threads --------------------------------------------------------------- */

static double now(void)
{
    struct timespec at;

    (void)clock_gettime(CLOCK_MONOTONIC, &at);
    return (double)at.tv_sec + 1e-9 * (double)at.tv_nsec;
}

static void sleep_ms(long ms)
{
    (void)nanosleep(&(struct timespec){ms / 1000, ms % 1000 * 1000000}, NULL);
}

#define IN_CALL_MS 700 /* long enough for all that the others do meanwhile */

struct in_call {
    struct pccd_client *client;
    uint32_t scene;
    int status;
};

static void *be_in_a_call(void *context)
{
    struct in_call *call = context;
    struct pccd_scene_news news;

    call->status = pccd_scene_wait(call->client, call->scene, IN_CALL_MS, &news);
    return NULL;
}

/* If it failed, a second thread would break what the first is at, and not be told. */
CASE(misuse__a_second_thread_is_refused_or_waits)
{
    struct pccd_client *client = test_client_at(test_shared.url);
    struct in_call call = {.client = client};
    struct test_crossing crossing;
    struct pccd_answer held = PCCD_ANSWER_INIT;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    struct pccd_batch_part part = {.format = PCCD_FORMAT_F32, .count = 3};
    struct pccd_batch *batch = NULL;
    struct pccd_frame frame;
    uint64_t step = 0;
    void *to = NULL;
    pthread_t thread;

    assert_ok(test_crossing_make(client, &crossing));
    call.scene = share(client, "threads");
    turn(&crossing, &held);
    part.scene = crossing.scene;
    part.object = crossing.object;
    assert_ok(pccd_batch_create(client, &part, 1, &batch));
    assert_ok(pccd_frame_begin(client, crossing.scene, 1, 64, &frame));
    double begin = now();
    assert_int_equal(pthread_create(&thread, NULL, be_in_a_call, &call), 0);
    sleep_ms(IN_CALL_MS / 4);
    assert_int_equal(pccd_ping(client, NULL), PCCD_E_BUSY);
    assert_non_null(strstr(pccd_error_text(client), "another thread"));
    assert_int_equal(pccd_poll(client, &answer), PCCD_E_BUSY);
    assert_int_equal(pccd_submit_still(client, crossing.scene, NULL, &step), PCCD_E_BUSY);
    assert_int_equal(pccd_frame_x1(&frame, crossing.object, PCCD_FORMAT_F32, 0, 1, &to),
                     PCCD_E_BUSY);
    assert_int_equal(pccd_batch_begin(batch, NULL, &to), PCCD_E_BUSY);
    assert_int_equal(pccd_record_stop(client, NULL), PCCD_E_BUSY);
    pccd_answer_release(client, &held); /* has no status, and waits */
    assert_true(now() - begin >= 0.9e-3 * IN_CALL_MS);
    assert_int_equal(pthread_join(thread, NULL), 0);
    assert_int_equal(call.status, PCCD_E_TIMEOUT);
    assert_ok(pccd_ping(client, NULL));
    pccd_frame_abort(&frame);
    assert_true(test_crossing_turn(&crossing));

    assert_int_equal(pthread_create(&thread, NULL, be_in_a_call, &call), 0);
    sleep_ms(IN_CALL_MS / 4);
    pccd_close(client); /* has no status, and waits */
    assert_int_equal(pthread_join(thread, NULL), 0);
    assert_int_equal(call.status, PCCD_E_TIMEOUT);
    pccd_batch_destroy(batch);
}

#define THREADS 4
#define TURNS   300

struct crowd {
    struct test_crossing crossing;
    atomic_uint done, busy, wrong;
};

static void *crowd_in(void *context)
{
    struct crowd *crowd = context;
    struct pccd_client *client = crowd->crossing.client;

    for (int i = 0; i < TURNS; i++) {
        struct pccd_answer answer = PCCD_ANSWER_INIT;
        struct pccd_frame frame;
        float x0[3][3];
        float x1[3][3];
        int status;

        test_crossing_positions(x0, 1);
        test_crossing_positions(x1, -1);
        status = pccd_step_x0x1(client, crowd->crossing.scene, crowd->crossing.object, x0,
                                x1, PCCD_FORMAT_F32, 3, NULL, &answer);
        if (status == 0) {
            (void)atomic_fetch_add(&crowd->done, 1);
            (void)atomic_fetch_add(&crowd->wrong, answer.total != 3);
        } else {
            (void)atomic_fetch_add(status == PCCD_E_BUSY ? &crowd->busy : &crowd->wrong,
                                   1);
        }
        pccd_answer_release(client, &answer);
        if (pccd_frame_begin(client, crowd->crossing.scene, 1, 64, &frame) == 0) {
            pccd_frame_abort(&frame);
        }
        (void)pccd_ping(client, NULL);
    }
    return NULL;
}

/* If it failed, threads that share a client by mistake would end the program, hang, or
 * have each other's answers. */
CASE_CROSSING(misuse__threads_that_crowd_are_answered_or_refused)
{
    struct crowd crowd = {.crossing = *(struct test_crossing *)*state};
    pthread_t threads[THREADS];

    for (int i = 0; i < THREADS; i++) {
        assert_int_equal(pthread_create(&threads[i], NULL, crowd_in, &crowd), 0);
    }
    for (int i = 0; i < THREADS; i++) {
        assert_int_equal(pthread_join(threads[i], NULL), 0);
    }
    assert_int_equal(atomic_load(&crowd.wrong), 0);
    assert_true(atomic_load(&crowd.done) > 0);
    assert_int_equal(atomic_load(&crowd.done) + atomic_load(&crowd.busy),
                     THREADS * TURNS);
    assert_ok(pccd_ping(crowd.crossing.client, NULL));
}

/* ---- NULL in the place of a client, or of another argument ------------------------- */

static void count_stat(void *context, const char *name, uint64_t value, const char *text)
{
    (void)context, (void)name, (void)value, (void)text;
}

/* Every function with a client, without one; how many did not say so.
 * More than 70 lines: a line for each function. */
static int call_with_no_client(void)
{
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    struct pccd_batch_answer many = PCCD_BATCH_ANSWER_INIT;
    struct pccd_object_settings settings = {.what = 0};
    struct pccd_mesh_data data = {.x = NULL};
    struct pccd_batch_part part = {.scene = 1};
    struct pccd_batch *batch = NULL;
    struct pccd_frame frame = {.client = NULL};
    struct pccd_rays *rays = NULL;
    struct pccd_ray_hit hit;
    struct pccd_edge edge;
    struct pccd_scene_news news;
    struct pccd_step_event event;
    uint64_t step = 0;
    uint32_t handle = 0;
    uint32_t count = 0;
    double part_of_way = 0;
    void *x[1] = {&step};
    const uint32_t triangle[1][3] = {{0, 1, 2}};
    const double m[12] = {0};
    const int got[] = {
        pccd_link(NULL, NULL),
        pccd_ping(NULL, &step),
        pccd_stats(NULL, count_stat, NULL),
        pccd_stats_thread(NULL, false, 0, count_stat, NULL, NULL),
        pccd_daemon(NULL, NULL),
        pccd_list_sessions(NULL, NULL, NULL),
        pccd_list_scenes(NULL, 0, NULL, NULL),
        pccd_list_objects(NULL, 0, 1, NULL, NULL),
        pccd_list_pairs(NULL, 0, 1, NULL, NULL),
        pccd_list_meshes(NULL, 0, NULL, NULL),
        pccd_histogram(NULL, PCCD_HISTOGRAM_STEPS, NULL),
        pccd_config_get(NULL, NULL, NULL, NULL),
        pccd_config_set(NULL, "a", "b"),
        pccd_watch_start(NULL, 0, 0),
        pccd_watch_next(NULL, 0, &event),
        pccd_watch_stop(NULL),
        pccd_mesh_create(NULL, x, PCCD_FORMAT_F32, 3, triangle, 1, &handle, NULL),
        pccd_mesh_replace(NULL, 1, x, PCCD_FORMAT_F32, 3, triangle, 1, NULL),
        pccd_mesh_put(NULL, &data, &handle, NULL),
        pccd_mesh_edges(NULL, 1, &edge, 1),
        pccd_mesh_destroy(NULL, 1),
        pccd_scene_create(NULL, NULL, &handle),
        pccd_scene_destroy(NULL, 1),
        pccd_scene_join(NULL, 0, "a", &handle),
        pccd_scene_add(NULL, 1, 1, &handle),
        pccd_scene_remove(NULL, 1, 1),
        pccd_scene_boxes(NULL, 1, PCCD_TREE_FACES, 0, NULL, 0, &count),
        pccd_object_set(NULL, 1, 1, &settings),
        pccd_object_get(NULL, 1, 1, &settings),
        pccd_user_data(NULL, 1, NULL, 0, NULL),
        pccd_pair_ignore(NULL, 1, 1, 2, true),
        pccd_scene_wait(NULL, 1, 0, &news),
        pccd_scene_read(NULL, 1, 1, 0, &answer),
        pccd_frame_begin(NULL, 1, 1, 64, &frame),
        pccd_frame_x1(NULL, 1, PCCD_FORMAT_F32, 0, 1, x),
        pccd_frame_x1(&frame, 1, PCCD_FORMAT_F32, 0, 1, x),
        pccd_frame_x0x1(NULL, 1, PCCD_FORMAT_F32, 0, 1, x, x),
        pccd_frame_x0x1(&frame, 1, PCCD_FORMAT_F32, 0, 1, x, x),
        pccd_frame_rigid(NULL, 1, 0, 1, m, m),
        pccd_frame_rigid(&frame, 1, 0, 1, m, m),
        pccd_frame_commit(NULL, NULL, &step),
        pccd_frame_commit(&frame, NULL, &step),
        pccd_frame_commit_near(NULL, NULL, &step),
        pccd_frame_commit_near(&frame, NULL, &step),
        pccd_submit(NULL, 1, NULL, 0, NULL, &step),
        pccd_submit_still(NULL, 1, NULL, &step),
        pccd_poll(NULL, &answer),
        pccd_wait(NULL, 1, 0, &answer),
        pccd_wait_held(NULL, 1, 0),
        pccd_fetch(NULL, 1, 1, 0, &answer),
        pccd_cancel(NULL, 1),
        pccd_step(NULL, 1, NULL, 0, NULL, &answer),
        pccd_step_safe(NULL, 1, NULL, 0, NULL, x, &part_of_way, &answer),
        pccd_step_x1(NULL, 1, 1, x, PCCD_FORMAT_F32, 1, NULL, &answer),
        pccd_step_x0x1(NULL, 1, 1, x, x, PCCD_FORMAT_F32, 1, NULL, &answer),
        pccd_submit_near(NULL, 1, NULL, 0, NULL, &step),
        pccd_ask_near(NULL, 1, NULL, 0, NULL, &answer),
        pccd_rays_begin(NULL, 1, NULL, &rays),
        pccd_rays_cast(NULL, rays, m, m, NULL, &hit),
        pccd_batch_create(NULL, &part, 1, &batch),
        pccd_batch_begin(NULL, x, x),
        pccd_batch_commit(NULL, NULL, &step),
        pccd_batch_submit(NULL, NULL, NULL, NULL, &step),
        pccd_batch_step(NULL, NULL, NULL, NULL, &many),
        pccd_batch_poll(NULL, &many),
        pccd_batch_wait(NULL, 1, 0, &many),
        pccd_record_start(NULL, "a", NULL),
        pccd_record(NULL, NULL),
        pccd_record_stop(NULL, NULL),
        pccd_request_handle(NULL, 1),
        pccd_trace_start(NULL, 0, 0, NULL),
        pccd_trace_stop(NULL, NULL),
        pccd_trace_dump(NULL, NULL, NULL),
    };
    int wrong = 0;

    for (size_t i = 0; i < sizeof got / sizeof got[0]; i++) {
        if (got[i] != PCCD_E_INVAL) {
            print_message("call %zu without a client: %d\n", i, got[i]);
            wrong++;
        }
    }
    pccd_answer_release(NULL, &answer);
    pccd_batch_release(NULL, &many);
    pccd_batch_abort(NULL);
    pccd_batch_destroy(NULL);
    pccd_rays_end(NULL, NULL);
    pccd_frame_abort(NULL);
    pccd_frame_abort(&frame);
    pccd_abandon(NULL, 1);
    pccd_close(NULL);
    return wrong;
}

/* If it failed, a client that could not be connected would end the program later, far
 * from the mistake. */
CASE(null__calls_without_a_client_are_refused)
{
    assert_int_equal(call_with_no_client(), 0);
    assert_non_null(strstr(pccd_error_text(NULL), "NULL"));
}

/* If it failed, an argument that is NULL would end the program, or be refused without a
 * word. */
CASE_CROSSING(null__arguments_that_are_null_are_named)
{
    struct test_crossing *crossing = *state;
    struct pccd_client *client = crossing->client;
    struct pccd_batch_part part = {.scene = crossing->scene};
    struct pccd_batch *batch = NULL;
    struct pccd_frame frame;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    struct pccd_batch_answer many = PCCD_BATCH_ANSWER_INIT;
    struct pccd_motion motion = {.object = crossing->object, .count = 3};
    uint64_t step = 0;
    uint32_t count = 0;
    void *x = NULL;

    assert_ok(pccd_frame_begin(client, crossing->scene, 2, 512, &frame));
    assert_ok(pccd_batch_create(client, &part, 1, &batch));
#define NAMED(call)                                                                      \
    assert_int_equal(call, PCCD_E_INVAL);                                                \
    assert_non_null(strstr(pccd_error_text(client), "NULL"));                            \
    assert_int_not_equal(pccd_config_set(client, "no such setting", ""), 0)
    NAMED(pccd_frame_x1(&frame, crossing->object, PCCD_FORMAT_F32, 0, 3, NULL));
    NAMED(pccd_frame_x0x1(&frame, crossing->object, PCCD_FORMAT_F32, 0, 3, NULL, &x));
    NAMED(pccd_frame_rigid(&frame, crossing->object, 0, 3, NULL, NULL));
    NAMED(pccd_frame_begin(client, crossing->scene, 1, 64, NULL));
    NAMED(pccd_submit(client, crossing->scene, NULL, 1, NULL, &step));
    NAMED(pccd_submit(client, crossing->scene, &motion, 1, NULL, NULL));
    NAMED(pccd_submit_still(client, crossing->scene, NULL, NULL));
    NAMED(pccd_submit_near(client, crossing->scene, NULL, 1, NULL, &step));
    NAMED(pccd_ask_near(client, crossing->scene, NULL, 0, NULL, NULL));
    NAMED(pccd_step(client, crossing->scene, NULL, 0, NULL, NULL));
    NAMED(pccd_step_safe(client, crossing->scene, NULL, 0, NULL, NULL, NULL, &answer));
    NAMED(test_crossing_step(crossing, NULL, NULL, &answer));
    NAMED(pccd_poll(client, NULL));
    NAMED(pccd_wait(client, 1, 0, NULL));
    NAMED(pccd_fetch(client, crossing->scene, 1, 0, NULL));
    NAMED(pccd_scene_read(client, crossing->scene, 1, 0, NULL));
    NAMED(pccd_scene_wait(client, crossing->scene, 0, NULL));
    NAMED(pccd_scene_boxes(client, crossing->scene, PCCD_TREE_FACES, 0, NULL, 1, &count));
    NAMED(pccd_scene_create(client, NULL, NULL));
    NAMED(pccd_scene_add(client, crossing->scene, crossing->mesh, NULL));
    NAMED(pccd_scene_join(client, 0, NULL, &count));
    NAMED(pccd_mesh_put(client, NULL, &count, NULL));
    NAMED(pccd_mesh_edges(client, crossing->mesh, NULL, 3));
    NAMED(pccd_object_set(client, crossing->scene, crossing->object, NULL));
    assert_int_equal(
        pccd_object_get(client, crossing->scene, crossing->object, NULL), PCCD_E_INVAL);
    assert_string_equal(pccd_error_text(client), "object_get: settings is NULL");
    NAMED(pccd_object_get(client, crossing->scene, crossing->object, NULL));
    NAMED(pccd_user_data(client, crossing->scene, NULL, 1, NULL));
    NAMED(pccd_stats(client, NULL, NULL));
    NAMED(pccd_list_scenes(client, 0, NULL, NULL));
    NAMED(pccd_histogram(client, PCCD_HISTOGRAM_STEPS, NULL));
    NAMED(pccd_config_set(client, NULL, NULL));
    NAMED(pccd_watch_next(client, 0, NULL));
    NAMED(pccd_trace_dump(client, NULL, NULL));
    NAMED(pccd_batch_begin(batch, NULL, NULL));
    NAMED(pccd_batch_step(batch, NULL, NULL, NULL, NULL));
    NAMED(pccd_batch_wait(client, 1, 0, NULL));
    NAMED(pccd_batch_poll(client, NULL));
    NAMED(pccd_batch_submit(batch, NULL, NULL, NULL, NULL));
#undef NAMED
    assert_int_equal(pccd_frame_commit(&frame, NULL, NULL), PCCD_E_INVAL);
    assert_non_null(strstr(pccd_error_text(client), "step is NULL"));
    assert_null(pccd_batch_contacts(&many, 0));
    pccd_batch_destroy(batch);
    assert_true(test_crossing_turn(crossing));
}

CASES_WITH(test_shared_start, test_shared_stop);
