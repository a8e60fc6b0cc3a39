/* test_int_warm.c - what the client library asks of malloc in a warm frame: nothing. */
#include "cases.h"

#include <unistd.h>

#include "allocations.h"
#include "fixture.h"
#include "grid.h"
#include "must.h"

/* A recording's zstd gives memory back after 128 chunks that were smaller than its first,
 * once. */
#define WARM   256
#define FRAMES 200

/* ---- frames ------------------------------------------------------------------------ */

typedef void (*frame_fn)(void *context, int number);

/* Frames after the first ones; how often they asked for memory. */
static void assert_asks_for_nothing(frame_fn frame, void *context)
{
    unsigned before;

    for (int i = 0; i < WARM; i++) {
        frame(context, i);
    }
    before = test_allocations();
    assert_true(before > 0); /* they are counted */
    for (int i = 0; i < FRAMES; i++) {
        frame(context, i);
    }
    assert_int_equal(test_allocations() - before, 0);
}

static struct pccd_client *open_client(void)
{
    if (!TEST_COUNTS_ALLOCATIONS) {
        test_skip("allocations are not counted in this build");
    }
    return test_client_at(test_shared.url);
}

/* Its records, as who reads them does. */
static void read_contacts(const struct pccd_answer *answer)
{
    for (uint64_t i = 0; answer->contacts != NULL && i < answer->count; i++) {
        assert_in_range(answer->contacts[i].kind, PCCD_VF, PCCD_EE);
    }
}

static void wait_for_one(void *context, int number)
{
    struct test_grid *grid = context;
    struct pccd_answer answer = PCCD_ANSWER_INIT;

    (void)number;
    assert_ok(test_grid_turn(grid, NULL, &answer));
    assert_int_equal(answer.total, grid->vertex_count);
    read_contacts(&answer);
    pccd_answer_release(grid->client, &answer);
}

/* If it failed, a game would allocate in every frame, and stutter when it least can. */
CASE(warm__frames_allocate_nothing)
{
    struct test_grid grid;

    assert_ok(test_grid_make(open_client(), 20, &grid));
    assert_asks_for_nothing(wait_for_one, &grid);
    test_grid_close(&grid);
}

/* Two in flight, of several segments of each kind, collected by polling. */
static void poll_for_two(void *context, int number)
{
    const struct pccd_step_settings settings = {
        .struct_bytes = sizeof(struct pccd_step_settings), .mode = PCCD_MODE_FIRST};
    const double still[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    struct test_grid *grid = context;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    int collected = 0;

    for (int i = 0; i < 2; i++) {
        uint32_t half = grid->vertex_count / 2;
        struct pccd_frame frame;
        void *x0, *x1;
        uint64_t step;

        test_grid_positions(grid, (number + i) % 2 == 0 ? 1.0f : -1.0f);
        assert_ok(pccd_frame_begin(grid->client, grid->scene, 3,
                                   3 * grid->vertex_count * sizeof *grid->x + 192,
                                   &frame));
        assert_ok(pccd_frame_x1(&frame, grid->object, PCCD_FORMAT_F32, 0, half, &x1));
        memcpy(x1, grid->x, half * sizeof *grid->x);
        assert_ok(pccd_frame_x0x1(&frame, grid->object, PCCD_FORMAT_F32, half,
                                  grid->vertex_count - half, &x0, &x1));
        memcpy(x0, grid->x + half, (grid->vertex_count - half) * sizeof *grid->x);
        memcpy(x1, grid->x + half, (grid->vertex_count - half) * sizeof *grid->x);
        assert_ok(pccd_frame_rigid(&frame, grid->floor, 0, 3, still, still));
        assert_ok(pccd_frame_commit(&frame, &settings, &step));
    }
    while (collected < 2) {
        int status = pccd_poll(grid->client, &answer);

        assert_true(status == 0 || status == PCCD_E_AGAIN);
        if (status == 0) {
            assert_int_equal(answer.status, 0);
            read_contacts(&answer);
            pccd_answer_release(grid->client, &answer);
            collected++;
        }
    }
}

/* If it failed, a game that collects in the next frame would allocate, too. */
CASE(warm__polled_frames_allocate_nothing)
{
    struct test_grid grid;

    assert_ok(test_grid_make(open_client(), 20, &grid));
    assert_asks_for_nothing(poll_for_two, &grid);
    test_grid_close(&grid);
}

/* If it failed, a recorded game would not be the game. */
CASE(warm__recorded_frames_allocate_nothing)
{
    const struct pccd_record_settings settings = {.contacts = 1};
    struct pccd_client *client = open_client();
    char folder[] = "/tmp/pccd-test-warm-XXXXXX";
    char path[64];
    struct test_grid grid;

    assert_non_null(mkdtemp(folder));
    (void)snprintf(path, sizeof path, "%s/rec", folder);
    assert_ok(pccd_record_start(client, path, &settings));
    assert_ok(test_grid_make(client, 20, &grid));
    assert_asks_for_nothing(wait_for_one, &grid);
    test_grid_close(&grid);
    assert_int_equal(unlink(path), 0);
    assert_int_equal(rmdir(folder), 0);
}

/* Two clients of a shared scene, a triangle each. */
struct pair {
    struct pccd_client *client[2];
    uint32_t scene[2], object[2];
};

static uint64_t submit(struct pair *pair, int who, float z, bool hold)
{
    const struct pccd_step_settings settings = {
        .struct_bytes = sizeof(struct pccd_step_settings), .hold = hold};
    struct pccd_frame frame;
    float x[3][3];
    uint64_t step;
    void *x1;

    test_crossing_positions(x, z);
    assert_ok(pccd_frame_begin(pair->client[who], pair->scene[who], 1, sizeof x, &frame));
    assert_ok(pccd_frame_x1(&frame, pair->object[who], PCCD_FORMAT_F32, 0, 3, &x1));
    memcpy(x1, x, sizeof x);
    assert_ok(pccd_frame_commit(&frame, &settings, &step));
    return step;
}

static void share(void *context, int number)
{
    float z = number % 2 == 0 ? -1.0f : 1.0f;
    struct pair *pair = context;
    struct pccd_scene_news news;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    uint64_t held = submit(pair, 0, z, true);
    uint64_t step;

    assert_ok(pccd_wait_held(pair->client[0], held, -1));
    step = submit(pair, 1, -z, false);
    assert_ok(pccd_wait(pair->client[1], step, -1, &answer));
    read_contacts(&answer);
    pccd_answer_release(pair->client[1], &answer);
    assert_ok(pccd_wait(pair->client[0], held, -1, &answer));
    assert_ok(pccd_scene_wait(pair->client[0], pair->scene[0], -1, &news));
    assert_int_equal(news.number, answer.number);
    assert_ok(pccd_scene_read(pair->client[0], pair->scene[0], news.number, 0, &answer));
    read_contacts(&answer);
    pccd_answer_release(pair->client[0], &answer);
}

/* If it failed, a game in several processes would allocate in each of them. */
CASE(warm__shared_frames_allocate_nothing)
{
    const struct pccd_scene_settings settings = {.name = "warm",
                                                 .share = PCCD_SHARE_OPEN};
    struct pair pair;
    uint32_t mesh;

    if (test_is_direct()) {
        test_skip("with direct: what is held is copied in this process");
    }
    for (int i = 0; i < 2; i++) {
        pair.client[i] = open_client();
        assert_ok(pccd_scene_create(pair.client[i], &settings, &pair.scene[i]));
        mesh = test_mesh(pair.client[i], test_triangle_x, PCCD_FORMAT_F32, 3,
                         test_triangle, 1);
        pair.object[i] = test_object(pair.client[i], pair.scene[i], mesh);
    }
    assert_asks_for_nothing(share, &pair);
    pccd_close(pair.client[0]);
    pccd_close(pair.client[1]);
}

/* With direct: this process has the engine, too, whose threads ask for room of their own
 * when a step wants them. */
CASES_WITH_DAEMON("--threads", "1");
