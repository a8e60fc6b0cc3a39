/* test_int_null.c - calls with NULL in the place of a client, or of another argument. */
#include "cases.h"
#include "fixture.h"

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
