/* test_int_record.c - sessions that are recorded, and repeated by another daemon. */
#include "cases.h"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "crossing.h"
#include "daemon.h"
#include "farm.h"
#include "grid.h"
#include "must.h"
#include "recording.h"
#include "run_ctl.h"

static struct test_daemon daemon_;

static int set_up(void **state)
{
    static const char *const options[] = {"--supervise", "--crashes-max", "1000", NULL};

    (void)state;
    if (!test_recording_begin() || !test_daemon_start(&daemon_, options)) {
        return -1;
    }
    return 0;
}

static int tear_down(void **state)
{
    (void)state;
    (void)test_daemon_end(&daemon_, SIGTERM, 10000);
    (void)test_daemon_finish(&daemon_);
    return test_recording_end() ? 0 : -1;
}

static struct pccd_client *open_client(void)
{
    return test_client_at(daemon_.url);
}

/* ---- a session with everything in it --------------------------------------------- */

/* A body that is moved in every way that there is, and its scene. */
struct stage {
    struct pccd_client *client;
    uint32_t scene, mesh, floor_mesh, floor, body, second;
    uint64_t steps;
};

static void take(struct stage *stage, struct pccd_frame *frame)
{
    const struct pccd_step_settings settings = {
        .struct_bytes = sizeof(struct pccd_step_settings),
        .mode = (enum pccd_mode)(stage->steps % PCCD_MODE_COUNT),
        .tuning = stage->steps % 2 == 0 ? "scheduler=paper,refit=paper" : NULL};
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    uint64_t step = 0;

    assert_ok(pccd_frame_commit(frame, &settings, &step));
    assert_ok(pccd_wait(stage->client, step, -1, &answer));
    pccd_answer_release(stage->client, &answer);
    stage->steps++;
}

static void make_stage(struct pccd_client *client, struct stage *stage)
{
    *stage = (struct stage){.client = client};
    stage->scene = test_scene(client);
    stage->floor_mesh =
        test_mesh(client, test_floor_x, PCCD_FORMAT_F32, 3, test_triangle, 1);
    stage->mesh =
        test_mesh(client, test_triangle_x, PCCD_FORMAT_F32, 3, test_triangle, 1);
    stage->floor = test_object(client, stage->scene, stage->floor_mesh);
    stage->body = test_object(client, stage->scene, stage->mesh);
    stage->second = test_object(client, stage->scene, stage->mesh);
}

/* x1 in float, x0 and x1 in double, a part, a transform, all objects at once, nothing. */
static void move_stage(struct stage *stage, float z)
{
    const double turned[12] = {0.8, -0.6, 0, 0.125, 0.6, 0.8, 0, 0, 0, 0, 1, -1.5};
    const double as_it_was[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, (double)z};
    struct pccd_frame frame;
    float(*x1)[3];
    double(*d0)[3], (*d1)[3];
    float at[3][3];
    struct pccd_answer answer = PCCD_ANSWER_INIT;

    test_crossing_positions(at, z);
    assert_ok(pccd_frame_begin(stage->client, stage->scene, 2, 512, &frame));
    assert_ok(pccd_frame_x1(&frame, stage->body, PCCD_FORMAT_F32, 0, 3, (void **)&x1));
    memcpy(x1, at, sizeof at);
    assert_ok(pccd_frame_x0x1(&frame, stage->second, PCCD_FORMAT_F64, 0, 3, (void **)&d0,
                              (void **)&d1));
    for (int i = 0; i < 9; i++) {
        d0[i / 3][i % 3] = (double)at[i / 3][i % 3] + 0.1;
        d1[i / 3][i % 3] = -(double)at[i / 3][i % 3] / 3;
    }
    take(stage, &frame);
    assert_ok(pccd_frame_begin(stage->client, stage->scene, 2, 512, &frame));
    assert_ok(pccd_frame_rigid(&frame, stage->body, 0, 3, as_it_was, turned));
    assert_ok(pccd_frame_x1(&frame, stage->second, PCCD_FORMAT_F32, 1, 1, (void **)&x1));
    x1[0][0] = 0.25f;
    x1[0][1] = -0.25f;
    x1[0][2] = z;
    take(stage, &frame);
    test_still(stage->client, stage->scene, NULL, &answer);
    pccd_answer_release(stage->client, &answer);
    stage->steps++;
}

/* Everything but steps: a mesh replaced, one destroyed under its objects, an object and a
 * scene that go, one that comes. */
static void change_stage(struct stage *stage)
{
    static const float larger[4][3] = {{-1, -1, 1}, {2, 0, 1}, {0, 2, 1}, {1, 1, 2}};
    static const uint32_t two[2][3] = {{0, 1, 2}, {1, 2, 3}};

    uint32_t scene = test_scene(stage->client);
    assert_ok(pccd_mesh_replace(stage->client, stage->mesh, larger, PCCD_FORMAT_F32, 4,
                                two, 2, NULL));
    assert_ok(pccd_mesh_destroy(stage->client, stage->floor_mesh));
    assert_ok(pccd_scene_remove(stage->client, stage->scene, stage->second));
    stage->second = test_object(stage->client, stage->scene, stage->mesh);
    assert_ok(pccd_scene_destroy(stage->client, scene));
}

/* Steps that the daemon must refuse leave everything where it was. The second is refused
 * for its tuning, so that a replay without it would answer otherwise. */
static void fail_steps(struct stage *stage)
{
    const struct pccd_step_settings settings = {
        .struct_bytes = sizeof(struct pccd_step_settings), .tuning = "refit=none"};
    float at[3][3];
    struct pccd_answer answer = PCCD_ANSWER_INIT;

    test_crossing_positions(at, 1);
    at[2][1] = (float)(0.0 / (double)(at[0][0] - at[0][0]));
    assert_int_equal(pccd_step_x1(stage->client, stage->scene, stage->body, at,
                                  PCCD_FORMAT_F32, 3, NULL, &answer),
                     PCCD_E_NOTFINITE);
    test_crossing_positions(at, 1);
    assert_int_equal(pccd_step_x1(stage->client, stage->scene, stage->body, at,
                                  PCCD_FORMAT_F32, 3, &settings, &answer),
                     PCCD_E_INVAL);
    stage->steps += 2;
}

/* If this failed, a kind of request would be missing in recordings, or mean something
 * else when it is repeated. */
CASE(record__holds_every_kind_of_request)
{
    struct pccd_client *client = open_client();
    struct pccd_record_info info;
    struct stage stage;

    test_recording_clear();
    assert_ok(pccd_record_start(client, test_recording, NULL));
    make_stage(client, &stage);
    move_stage(&stage, -1);
    fail_steps(&stage);
    move_stage(&stage, 1);
    change_stage(&stage);
    move_stage(&stage, -0.5f);
    assert_ok(pccd_record_stop(client, &info));
    assert_int_equal(info.frames, stage.steps);
    assert_int_equal(info.answers, stage.steps);
    assert_int_equal(info.status, 0);
    pccd_close(client);
    test_recording_repeats("--json", test_recording, stage.steps);
}

/* If this failed, a recording could only be made from the beginning: what was there
 * before, and where, would be missing. */
CASE(record__begins_with_what_there_is)
{
    struct pccd_client *client = open_client();
    struct stage stage;
    uint64_t before;

    test_recording_clear();
    make_stage(client, &stage);
    move_stage(&stage, -1);
    change_stage(&stage);
    move_stage(&stage, 1);
    before = stage.steps;
    assert_ok(pccd_record_start(client, test_recording, NULL));
    move_stage(&stage, -0.5f);
    move_stage(&stage, 0.25f);
    assert_ok(pccd_record_stop(client, NULL));
    move_stage(&stage, 1);
    pccd_close(client);
    test_recording_repeats("--json", test_recording, stage.steps - 3 - before);
}

/* If this failed, the death of a daemon would end a recording, or leave a gap in it. */
CASE(record__goes_on_when_the_daemon_is_killed)
{
    struct pccd_client *client = open_client();
    struct stage stage;

    test_recording_clear();
    assert_ok(pccd_record_start(client, test_recording, NULL));
    make_stage(client, &stage);
    for (int round = 0; round < 3; round++) {
        move_stage(&stage, round % 2 == 0 ? -1.0f : 1.0f);
        assert_int_equal(kill((pid_t)pccd_daemon_pid(client), SIGKILL), 0);
    }
    change_stage(&stage);
    assert_int_equal(kill((pid_t)pccd_daemon_pid(client), SIGKILL), 0);
    move_stage(&stage, 0.5f);
    pccd_close(client);
    test_recording_repeats("--json", test_recording, stage.steps);
}

/* If this failed, the steps of a batch could not be repeated or verified, or those that
 * failed would be left out. */
CASE(record__has_a_step_for_each_scene_of_a_batch)
{
    const struct pccd_record_settings with_contacts = {.contacts = 1};
    struct pccd_step_settings settings = PCCD_STEP_SETTINGS_INIT;
    struct pccd_client *client = open_client();
    struct pccd_batch_answer answer = PCCD_BATCH_ANSWER_INIT;
    struct pccd_record_info info;
    struct test_farm farm;
    void *x1[6];
    uint64_t step = 0;
    char said[4096];

    test_recording_clear();
    assert_ok(pccd_record_start(client, test_recording, &with_contacts));
    assert_ok(test_farm_make(client, 6, 6, &farm));
    for (uint32_t turn = 1; turn <= 4; turn++) {
        settings.mode = (enum pccd_mode)(turn % PCCD_MODE_COUNT);
        settings.separation = turn == 2 ? 0.125 : 0;
        assert_ok(test_farm_turn(&farm, turn, &settings, &answer));
        assert_int_equal(answer.failed, 0);
        pccd_batch_release(client, &answer);
    }
    assert_int_equal(kill((pid_t)pccd_daemon_pid(client), SIGKILL), 0);
    assert_ok(pccd_batch_begin(farm.batch, NULL, x1));
    for (uint32_t i = 0; i < 6; i++) {
        test_farm_positions(&farm, i, 5, x1[i]);
    }
    ((float *)x1[3])[0] = 1e30f;
    assert_ok(pccd_batch_commit(farm.batch, NULL, &step));
    assert_ok(pccd_batch_wait(client, step, -1, &answer));
    assert_int_equal(answer.failed, 1);
    pccd_batch_release(client, &answer);
    assert_ok(test_farm_turn(&farm, 6, NULL, &answer));
    pccd_batch_release(client, &answer);
    assert_ok(pccd_record(client, &info));
    assert_int_equal(info.status, 0);
    assert_int_equal(info.frames, 36);
    assert_int_equal(info.answers, 36);
    test_farm_free(&farm);
    pccd_close(client);
    test_recording_repeats("--json", test_recording, 36);
    assert_int_equal(test_ctl("verify", "--json", test_recording, said, sizeof said), 0);
    assert_true(test_ctl_number(said, "contacts") > 0);
}

/* ---- a program that is killed ---------------------------------------------------- */

/* Steps for ever, several in flight, with the records of their answers. */
static void run_for_ever(int ready)
{
    const struct pccd_record_settings settings = {.contacts = 1};
    struct pccd_client *client = test_connect(daemon_.url);
    struct test_grid grid;
    uint64_t last = 0;

    test_end_with_parent();
    if (client == NULL || pccd_record_start(client, test_recording, &settings) != 0 ||
        test_grid_make(client, 12, &grid) != 0) {
        _exit(1);
    }
    for (uint64_t i = 0;; i++) {
        struct pccd_answer answer = PCCD_ANSWER_INIT;
        uint64_t step = 0;

        if (test_grid_submit(&grid, NULL, &step) != 0) {
            _exit(1);
        }
        if (last != 0 && pccd_wait(client, last, -1, &answer) == 0) {
            pccd_answer_release(client, &answer);
        }
        last = step;
        if (i == 5 && write(ready, "", 1) != 1) {
            _exit(1);
        }
    }
}

/* If this failed, the recording of a program that crashes could not be read, and that is
 * the one that somebody wants. */
CASE(record__survives_its_program)
{
    for (unsigned round = 0; round < 4; round++) {
        int ready[2];
        char byte;
        char said[4096];
        pid_t child;

        test_recording_clear();
        assert_int_equal(pipe(ready), 0);
        child = fork();
        assert_true(child >= 0);
        if (child == 0) {
            run_for_ever(ready[1]);
        }
        assert_int_equal(read(ready[0], &byte, 1), 1);
        test_sleep_ms(3 * round);
        assert_int_equal(kill(child, SIGKILL), 0);
        assert_int_equal(waitpid(child, NULL, 0), child);
        (void)close(ready[0]);
        (void)close(ready[1]);
        assert_ok(test_ctl("replay", "--json", test_recording, said, sizeof said));
        assert_in_range(test_ctl_number(said, "same"), 4, 1000000);
        assert_int_equal(test_ctl_number(said, "differ"), 0);
        assert_in_range(test_ctl_number(said, "unanswered"), 0, 2);
    }
}

/* ---- bounds ---------------------------------------------------------------------- */

static void turn_grid(struct test_grid *grid, unsigned times)
{
    for (unsigned i = 0; i < times; i++) {
        struct pccd_answer answer = PCCD_ANSWER_INIT;

        assert_ok(test_grid_turn(grid, NULL, &answer));
        pccd_answer_release(grid->client, &answer);
    }
}

static uint64_t bytes_of(const char *file)
{
    struct stat info;

    return stat(file, &info) == 0 ? (uint64_t)info.st_size : 0;
}

/* If this failed, a recording could fill a disk, or a call would fail because its
 * recording is full. */
CASE(record__keeps_its_bound)
{
    const struct pccd_record_settings settings = {.max_bytes = 65536, .level = -1};
    struct pccd_client *client = open_client();
    struct pccd_record_info info;
    struct test_grid grid;

    test_recording_clear();
    assert_ok(pccd_record_start(client, test_recording, &settings));
    assert_ok(test_grid_make(client, 16, &grid));
    turn_grid(&grid, 40);
    assert_ok(pccd_record(client, &info));
    assert_int_equal(info.status, PCCD_E_LIMIT);
    assert_int_equal(pccd_record_stop(client, NULL), PCCD_E_LIMIT);
    assert_in_range(bytes_of(test_recording), 32768, 65536);
    test_grid_close(&grid);
    test_recording_repeats("--json", test_recording, 8);
}

/* If this failed, the newest part of a long session could not be had without the rest. */
CASE(record__keeps_the_newest_segments)
{
    const struct pccd_record_settings settings = {
        .max_bytes = 3 * 65536, .segments = 3, .level = -1};
    struct pccd_client *client = open_client();
    struct pccd_record_info info;
    struct test_grid grid;
    char name[128];

    test_recording_clear();
    assert_ok(pccd_record_start(client, test_recording, &settings));
    assert_ok(test_grid_make(client, 16, &grid));
    turn_grid(&grid, 200);
    assert_ok(pccd_record_stop(client, &info));
    assert_in_range(info.segments, 4, 100);
    assert_int_equal(info.frames, 200);
    test_recording_repeats("--json", test_recording, 1);
    for (int age = 1; age <= 2; age++) {
        (void)snprintf(name, sizeof name, "%s.%d", test_recording, age);
        assert_in_range(bytes_of(name), 65536, 65536 + 8192);
        test_recording_repeats("--json", name, 8);
    }
    (void)snprintf(name, sizeof name, "%s.3", test_recording);
    assert_int_equal(bytes_of(name), 0);
    test_grid_close(&grid);
}

/* Return the bytes of all files of a ring of three. */
static uint64_t bytes_of_ring(void)
{
    uint64_t bytes = bytes_of(test_recording);
    char name[128];

    for (int age = 1; age <= 3; age++) {
        (void)snprintf(name, sizeof name, "%s.%d", test_recording, age);
        bytes += bytes_of(name);
    }
    return bytes;
}

/* Another shape of the stage's mesh, of `count` vertices: 12 bytes each in a file. */
static void reshape(struct stage *stage, uint32_t count, float by)
{
    static float x[4096][3];

    for (uint32_t i = 0; i < count; i++) {
        x[i][0] = (float)(i % 64) + by;
        x[i][1] = (float)(i / 64);
        x[i][2] = by;
    }
    assert_ok(pccd_mesh_replace(stage->client, stage->mesh, x, PCCD_FORMAT_F32, count,
                                test_triangle, 1, NULL));
}

/* If this failed, a ring of segments would fill a disk with what is made between two
 * steps, or lose what was made when a segment was full. */
CASE(record__meshes_keep_the_bound_of_a_ring)
{
    const struct pccd_record_settings settings = {
        .max_bytes = 3 * 65536, .segments = 3, .level = -1};
    struct pccd_client *client = open_client();
    struct pccd_record_info info;
    struct stage stage;
    char older[128];

    test_recording_clear();
    assert_ok(pccd_record_start(client, test_recording, &settings));
    make_stage(client, &stage);
    for (int i = 0; i < 40; i++) {
        reshape(&stage, 1024, (float)i / 8);
        assert_in_range(bytes_of_ring(), 1, settings.max_bytes);
    }
    move_stage(&stage, -1);
    assert_ok(pccd_record(client, &info));
    assert_int_equal(info.status, 0);
    assert_in_range(info.segments, 4, 20);
    test_recording_repeats("--json", test_recording, 3);
    (void)snprintf(older, sizeof older, "%s.1", test_recording);
    test_recording_repeats("--json", older, 0);
    reshape(&stage, 4096, 0); /* more than half of a segment */
    assert_int_equal(pccd_record_stop(client, NULL), PCCD_E_LIMIT);
    assert_non_null(strstr(pccd_error_text(client), "a segment, max_bytes / segments"));
    assert_in_range(bytes_of_ring(), 1, settings.max_bytes);
    pccd_close(client);
}

/* If this failed, somebody would lose an older recording, or get one with a hole. */
CASE(record__is_refused_where_it_could_not_be_whole)
{
    const struct pccd_record_settings too_small = {.max_bytes = 100};
    const struct pccd_record_settings unbounded = {.segments = 2};
    struct pccd_client *client = open_client();
    struct pccd_client *careless = NULL;
    struct pccd_options options;
    struct stage stage;
    char beside[128];

    test_recording_clear();
    (void)snprintf(beside, sizeof beside, "%s-beside", test_recording);
    assert_int_equal(pccd_record_stop(client, NULL), PCCD_E_STATE);
    assert_int_equal(pccd_record_start(client, test_recording, &too_small), PCCD_E_INVAL);
    assert_int_equal(pccd_record_start(client, test_recording, &unbounded), PCCD_E_INVAL);
    assert_ok(pccd_record_start(client, test_recording, NULL));
    assert_int_equal(pccd_record_start(client, test_recording, NULL), PCCD_E_STATE);
    assert_ok(pccd_record_stop(client, NULL));
    assert_int_equal(pccd_record_start(client, test_recording, NULL), PCCD_E_SYSTEM);
    pccd_options_init(&options);
    options.url = daemon_.url;
    options.no_keep = true;
    assert_ok(pccd_connect(&options, &careless));
    assert_ok(pccd_record_start(careless, beside, NULL)); /* nothing yet */
    make_stage(careless, &stage);
    move_stage(&stage, -1);
    assert_ok(pccd_record_stop(careless, NULL));
    test_recording_repeats("--json", beside, stage.steps);
    pccd_close(careless);
    assert_ok(pccd_connect(&options, &careless));
    make_stage(careless, &stage);
    assert_int_equal(unlink(beside), 0);
    assert_int_equal(pccd_record_start(careless, beside, NULL), PCCD_E_STATE);
    pccd_close(careless);
    pccd_close(client);
}

/* If this failed, a program would have to be changed to be recorded, or two of its
 * clients would write into one file. */
CASE(environment__records_every_client)
{
    struct pccd_client *clients[2];
    struct pccd_options options;
    struct stage stages[2];
    char name[128];

    test_recording_clear();
    pccd_options_init(&options);
    options.url = daemon_.url;
    options.no_keep = true; /* from the beginning on nothing else is needed */
    assert_int_equal(setenv("PCCD_RECORD", test_recording, 1), 0);
    assert_int_equal(setenv("PCCD_RECORD_OPTIONS", "level=-2", 1), 0);
    assert_int_equal(pccd_connect(&options, &clients[0]), PCCD_E_INVAL);
    assert_int_equal(setenv("PCCD_RECORD_OPTIONS", "contacts=1,level=3", 1), 0);
    for (int i = 0; i < 2; i++) {
        assert_ok(pccd_connect(&options, &clients[i]));
    }
    assert_int_equal(unsetenv("PCCD_RECORD"), 0);
    for (int i = 0; i < 2; i++) {
        make_stage(clients[i], &stages[i]);
        move_stage(&stages[i], i == 0 ? -1.0f : 0.5f);
        pccd_close(clients[i]);
    }
    (void)snprintf(name, sizeof name, "%s-2", test_recording);
    test_recording_repeats("--json", test_recording, stages[0].steps);
    test_recording_repeats("--json", name, stages[1].steps);
}

/* If this failed, who has recorded often would be told that there is no memory. */
CASE(environment__says_when_no_name_is_left)
{
    struct pccd_client *client = NULL;
    struct pccd_options options;
    char name[128];

    test_recording_clear();
    pccd_options_init(&options);
    options.url = daemon_.url;
    options.no_keep = true;
    assert_int_equal(setenv("PCCD_RECORD", test_recording, 1), 0);
    for (int i = 1; i <= 999; i++) {
        (void)snprintf(name, sizeof name, i == 1 ? "%s" : "%s-%d", test_recording, i);
        assert_int_equal(close(open(name, O_CREAT | O_WRONLY, 0600)), 0);
    }
    assert_int_equal(pccd_connect(&options, &client), PCCD_E_LIMIT);
    assert_non_null(strstr(pccd_error_text(NULL), "PCCD_RECORD="));
    (void)snprintf(name, sizeof name, "%s-7", test_recording);
    assert_int_equal(unlink(name), 0);
    assert_ok(pccd_connect(&options, &client));
    pccd_close(client);
    assert_int_equal(unsetenv("PCCD_RECORD"), 0);
    for (int i = 1; i <= 999; i++) {
        (void)snprintf(name, sizeof name, i == 1 ? "%s" : "%s-%d", test_recording, i);
        assert_int_equal(unlink(name), 0);
    }
}

CASES_WITH(set_up, tear_down);
