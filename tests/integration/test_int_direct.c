/* test_int_direct.c - the url direct:, a service in the process of its client. */
#include "cases.h"

#include <signal.h>

#include <dirent.h>
#include <poll.h>
#include <pthread.h>
#include <sys/wait.h>
#include <unistd.h>

#include "allocations.h"
#include "crossing.h"
#include "daemon.h"
#include "fixture.h"
#include "grid.h"
#include "must.h"
#include "pccd.h"
#include "prng.h"

static struct pccd_client *connect_to(const char *url)
{
    struct pccd_client *client = NULL;

    return pccd_connect(&(struct pccd_options){.url = url}, &client) == 0 ? client : NULL;
}

static struct pccd_client *connect_direct(void)
{
    return connect_to(TEST_DIRECT_URL);
}

static uint32_t count_entries(const char *path)
{
    uint32_t count = 0;
    DIR *entries = opendir(path);

    assert_non_null(entries);
    while (readdir(entries) != NULL) {
        count++;
    }
    (void)closedir(entries);
    return count;
}

/* ---- before OpenMP has a team, which does not survive a fork ----------------------- */

/* The rest of this program has had a team by then, so it is looked at in a fresh one. */
static bool has_only_its_own_thread(void)
{
    struct pccd_step_settings settings = {
        .struct_bytes = sizeof(struct pccd_step_settings), .threads = 1};
    uint32_t own = count_entries("/proc/self/task"); /* a thread sanitizer's, too */
    struct pccd_client *client = connect_direct();
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    struct test_grid grid;
    uint64_t step = 0;
    bool good = client != NULL && test_grid_make(client, 60, &grid) == 0;

    for (int i = 0; good && i < 5; i++) {
        good = test_grid_submit(&grid, &settings, &step) == 0 &&
               pccd_wait(client, step, -1, &answer) == 0 &&
               test_grid_is_right(&grid, &answer) &&
               count_entries("/proc/self/task") == own;
        pccd_answer_release(client, &answer);
    }
    return good;
}

/* If it failed, a game would find threads in its process that it did not ask for. */
CASE(direct__starts_no_thread_for_a_step_of_one)
{
    int status = 0;
    pid_t child;

    (void)setenv("OMP_NUM_THREADS", "1", 1); /* meshes and hierarchies, too */
    child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        test_end_with_parent();
        _exit(has_only_its_own_thread() ? 0 : 1);
    }
    assert_int_equal(waitpid(child, &status, 0), child);
    (void)unsetenv("OMP_NUM_THREADS");
    assert_int_equal(status, 0);
}

/* If it failed, nobody would know what to install. */
CASE(direct__missing_library_is_said)
{
    struct pccd_options options;
    struct pccd_client *client = NULL;

    pccd_options_init(&options);
    options.url = "direct:";
    (void)setenv("PCCD_DIRECT", "/nonexistent/libpccd-direct.so.0", 1);
    assert_int_equal(pccd_connect(&options, &client), PCCD_E_SYSTEM);
    assert_non_null(strstr(pccd_error_text(NULL), "/nonexistent/libpccd-direct.so.0"));
    assert_non_null(strstr(pccd_error_text(NULL), "PCCD_DIRECT"));
    (void)setenv("PCCD_DIRECT", "libgmp.so.10", 1); /* a library, but another one */
    assert_int_equal(pccd_connect(&options, &client), PCCD_E_VERSION);
    (void)unsetenv("PCCD_DIRECT");
    (void)setenv("PCCD_CPU", "abacus", 1);
    assert_int_equal(pccd_connect(&options, &client), PCCD_E_INVAL);
    assert_non_null(strstr(pccd_error_text(NULL), "abacus"));
    (void)unsetenv("PCCD_CPU");
    options.url = "direct:4";
    assert_int_equal(pccd_connect(&options, &client), PCCD_E_INVAL);
    options.url = "direct:";
    assert_ok(pccd_connect(&options, &client));
    pccd_close(client);
}

/* If it failed, PCCD_URL=direct: would start a daemon for a program that wants one of its
 * own, and nobody would hear of it; or another daemon would pass for its own. */
CASE(direct__serves_who_asks_for_a_private_daemon)
{
    struct pccd_options options;
    struct pccd_client *client = NULL;

    pccd_options_init(&options);
    options.private_daemon = true;
    (void)setenv("PCCD_URL", "direct:", 1);
    assert_ok(pccd_connect(&options, &client));
    assert_string_equal(pccd_url(client), "direct:");
    assert_int_equal(pccd_daemon_pid(client), getpid());
    pccd_close(client);
    (void)setenv("PCCD_URL", "unix:/nonexistent/pccd.sock", 1);
    assert_ok(pccd_connect(&options, &client));
    assert_int_equal(strncmp(pccd_url(client), "unix:", 5), 0);
    assert_int_not_equal(pccd_daemon_pid(client), getpid());
    pccd_close(client);
    (void)unsetenv("PCCD_URL");
}

/* If it failed, a copy of the process would hang, or take the client's memory along. */
CASE(direct__copy_of_the_process_is_refused)
{
    struct pccd_client *client = connect_direct();
    int status = 0;
    pid_t child;

    assert_non_null(client);
    child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        struct pccd_client *another = connect_direct();
        bool good = another == NULL && strstr(pccd_error_text(NULL), "forked") != NULL &&
                    pccd_ping(client, NULL) == PCCD_E_DISCONNECTED;

        pccd_close(client);
        _exit(good ? 0 : 1);
    }
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_int_equal(status, 0);
    assert_ok(pccd_ping(client, NULL));
    pccd_close(client);
}

/* If it failed, the threads of a step would be more than the environment allows. */
CASE(direct__heeds_omp_num_threads)
{
    static const struct {
        const char *text;
        uint32_t threads;
    } cases[] = {{"1", 1}, {"3", 3}, {"2,4", 2}};

    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct pccd_client *client;

        (void)setenv("OMP_NUM_THREADS", cases[i].text, 1);
        client = connect_direct();
        assert_non_null(client);
        assert_int_equal(test_stat(client, "threads_max"), cases[i].threads);
        pccd_close(client);
    }
    (void)unsetenv("OMP_NUM_THREADS");
}

/* ---- the same answers -------------------------------------------------------------- */

/* Results of the same play, wherever it is computed. */
struct told {
    uint64_t hash[2];
    uint64_t total;
    uint64_t vf;
    uint64_t ee;
};

#define SHEETS 3u
#define SIDE   24u
#define FRAMES 12u

/* A crumpled sheet; the same for the same numbers. */
static void crumple(float (*x)[3], uint32_t sheet, uint32_t frame)
{
    struct prng prng = {1 + sheet * 1000 + frame};

    for (uint32_t i = 0; i < SIDE * SIDE; i++) {
        x[i][0] = (float)(i % SIDE) * 0.1f;
        x[i][1] = (float)(i / SIDE) * 0.1f;
        x[i][2] = (float)sheet * 0.1f + (float)prng_below(&prng, 1000) * 0.0003f;
    }
}

static void fill_triangles(uint32_t (*triangles)[3])
{
    uint32_t at = 0;

    for (uint32_t y = 0; y + 1 < SIDE; y++) {
        for (uint32_t x = 0; x + 1 < SIDE; x++) {
            uint32_t corner = y * SIDE + x;
            uint32_t a[3] = {corner, corner + 1, corner + SIDE};
            uint32_t b[3] = {corner + 1, corner + SIDE + 1, corner + SIDE};

            memcpy(triangles[at++], a, sizeof a);
            memcpy(triangles[at++], b, sizeof b);
        }
    }
}

static void play(struct pccd_client *client, enum pccd_mode mode, struct told *told)
{
    static float x[SIDE * SIDE][3];
    static uint32_t triangles[2 * (SIDE - 1) * (SIDE - 1)][3];
    struct pccd_step_settings settings = {
        .struct_bytes = sizeof(struct pccd_step_settings), .mode = mode};
    uint32_t mesh[SHEETS];
    uint32_t object[SHEETS];

    fill_triangles(triangles);
    uint32_t scene = test_scene(client);
    for (uint32_t i = 0; i < SHEETS; i++) {
        crumple(x, i, 0);
        mesh[i] = test_mesh(client, x, PCCD_FORMAT_F32, SIDE * SIDE, triangles,
                            2 * (SIDE - 1) * (SIDE - 1));
        object[i] = test_object(client, scene, mesh[i]);
    }
    for (uint32_t frame = 0; frame < FRAMES; frame++) {
        struct pccd_frame writing;
        struct pccd_answer answer = PCCD_ANSWER_INIT;
        uint64_t step = 0;
        void *x1 = NULL;

        assert_ok(pccd_frame_begin(client, scene, SHEETS, (uint64_t)SHEETS * sizeof x,
                                   &writing));
        for (uint32_t i = 0; i < SHEETS; i++) {
            assert_ok(
                pccd_frame_x1(&writing, object[i], PCCD_FORMAT_F32, 0, SIDE * SIDE, &x1));
            crumple(x1, i, frame + 1);
        }
        assert_ok(pccd_frame_commit(&writing, &settings, &step));
        assert_ok(pccd_wait(client, step, 60000, &answer));
        assert_int_equal(answer.incomplete, PCCD_COMPLETE);
        memcpy(told[frame].hash, answer.hash, sizeof answer.hash);
        told[frame].total = answer.total;
        told[frame].vf = answer.counts[PCCD_VF];
        told[frame].ee = answer.counts[PCCD_EE];
        pccd_answer_release(client, &answer);
        if (frame == FRAMES / 2) { /* a body that is replaced, an object that goes */
            crumple(x, 0, 99);
            assert_ok(pccd_mesh_replace(client, mesh[0], x, PCCD_FORMAT_F32, SIDE * SIDE,
                                        (const uint32_t(*)[3])triangles,
                                        (SIDE - 1) * (SIDE - 1), NULL));
            assert_ok(pccd_scene_remove(client, scene, object[2]));
            object[2] = test_object(client, scene, mesh[2]);
        }
    }
    assert_ok(pccd_scene_destroy(client, scene));
}

/* If it failed, a game that goes from the daemon to its own process, or back, would see
 * other contacts. */
CASE_DAEMON(direct__answers_as_a_daemon_does, NULL)
{
    static const enum pccd_mode modes[] = {PCCD_MODE_ALL, PCCD_MODE_FIRST, PCCD_MODE_ANY,
                                           PCCD_MODE_PAIRS, PCCD_MODE_FIRST_PER_PAIR};
    struct pccd_client *there;
    struct pccd_client *here = connect_direct();

    there = connect_to(test_own.url);
    assert_non_null(here);
    assert_non_null(there);
    assert_string_equal(pccd_url(here), "direct:");
    assert_int_equal(pccd_daemon_pid(here), getpid());
    assert_string_equal(pccd_daemon_cpu(here), pccd_daemon_cpu(there));
    for (size_t i = 0; i < sizeof modes / sizeof modes[0]; i++) {
        static struct told told[2][FRAMES];

        memset(told, 0, sizeof told);
        play(here, modes[i], told[0]);
        play(there, modes[i], told[1]);
        assert_memory_equal(told[0], told[1], sizeof told[0]);
        uint64_t least = modes[i] == PCCD_MODE_FIRST_PER_PAIR ? 1 : 101;
        assert_true(modes[i] == PCCD_MODE_ANY || told[0][0].total >= least);
    }
    pccd_close(here);
    pccd_close(there);
}

#define RAYS 400u

static void note_scene(void *context, const struct pccd_scene_info *info)
{
    *(struct pccd_scene_info *)context = *info;
}

/* Cast rays through two sheets, a third one that they may not hit, and a mistake. */
static void cast(struct pccd_client *client, uint32_t ends, struct pccd_ray_hit *hits)
{
    static float x[SIDE * SIDE][3];
    static uint32_t triangles[2 * (SIDE - 1) * (SIDE - 1)][3];
    static double ways[2][RAYS * 2][3], radii[RAYS];
    struct pccd_rays_settings settings = PCCD_RAYS_SETTINGS_INIT;
    struct pccd_object_settings hidden = {.what = PCCD_OBJECT_GROUP, .group = 4};
    struct prng prng = {7};
    struct pccd_rays *rays = NULL;
    uint32_t above = 0;
    uint32_t scene = test_scene(client);
    uint32_t object[3];

    fill_triangles(triangles);
    for (uint32_t i = 0; i < 3; i++) {
        crumple(x, i, 0);
        object[i] = test_object(client, scene,
                                test_mesh(client, x, PCCD_FORMAT_F32, SIDE * SIDE,
                                          triangles, 2 * (SIDE - 1) * (SIDE - 1)));
    }
    assert_ok(pccd_object_set(client, scene, object[2], &hidden));
    for (uint32_t i = 0; i < RAYS; i++) {
        radii[i] = 0.001 * ends;
        for (uint32_t k = 0; k < 12; k++) {
            double at = (double)prng_below(&prng, 23000) * 1e-4;
            double up = k % 2 == 0 ? 1 : -1;
            ways[k % 2][i * ends + k / 2 % ends][k / 4] =
                k / 4 == 2 ? up + 0.01 * at : at;
        }
    }
    settings.count = RAYS;
    settings.ends = ends;
    settings.radii = radii;
    settings.mask = 1;
    assert_ok(pccd_rays_begin(client, scene, &settings, &rays));
    ways[1][3][0] = NAN;
    assert_int_equal(pccd_rays_cast(client, rays, *ways[0], *ways[1], NULL, hits),
                     PCCD_E_NOTFINITE);
    assert_non_null(strstr(pccd_error_text(client), "end of ray"));
    ways[1][3][0] = 1;
    assert_ok(pccd_rays_cast(client, rays, *ways[0], *ways[1], NULL, hits));
    for (uint32_t i = 0; i < RAYS; i++) {
        assert_true(hits[i].t > 0.3 && hits[i].t < 0.52 && hits[i].object != object[2]);
        assert_true(hits[i].points == 3 || ends == 2);
        above += hits[i].object == object[1];
    }
    assert_true(above > RAYS / 2);
    pccd_rays_end(client, rays);
    struct pccd_scene_info info = {.scene = 0};
    assert_ok(pccd_list_scenes(client, 0, note_scene, &info));
    assert_int_equal(info.objects, 3);
    assert_ok(pccd_scene_destroy(client, scene));
}

/* If it failed, a ray would hit another thing in the process than by a daemon, or where
 * the answer has several pages; or what is masked, or has ended. */
CASE_DAEMON(direct__casts_as_a_daemon_does, NULL)
{
    struct pccd_ray_hit hits[2][RAYS];
    struct pccd_client *client[2] = {connect_direct(), NULL};

    assert_ok(pccd_connect(
        &(struct pccd_options){.url = test_own.url, .result_bytes = 1u << 16},
        &client[1]));
    for (uint32_t ends = 1; ends <= 2; ends++) {
        memset(hits, 0, sizeof hits);
        cast(client[0], ends, hits[0]);
        cast(client[1], ends, hits[1]);
        assert_memory_equal(hits[0], hits[1], sizeof hits[0]);
    }
    pccd_close(client[0]);
    pccd_close(client[1]);
}

/* ---- threads ----------------------------------------------------------------------- */

struct worker {
    uint32_t side;
    bool good;
};

static void *work(void *context)
{
    struct worker *worker = context;
    struct pccd_client *client = connect_direct();
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    struct test_grid grid;
    uint64_t step = 0;

    worker->good = client != NULL && test_grid_make(client, worker->side, &grid) == 0;
    for (int i = 0; worker->good && i < 100; i++) {
        worker->good = test_grid_submit(&grid, NULL, &step) == 0 &&
                       pccd_wait(client, step, -1, &answer) == 0 &&
                       test_grid_is_right(&grid, &answer);
        pccd_answer_release(client, &answer);
    }
    if (client != NULL) {
        test_grid_free(&grid);
    }
    pccd_close(client);
    return NULL;
}

/* If it failed, two parts of a program that know nothing of each other could not both
 * use the library. */
CASE(direct__clients_of_two_threads_do_not_disturb_each_other)
{
    struct worker workers[2] = {{.side = 20}, {.side = 45}};
    pthread_t threads[2];

    for (int i = 0; i < 2; i++) {
        assert_int_equal(pthread_create(&threads[i], NULL, work, &workers[i]), 0);
    }
    for (int i = 0; i < 2; i++) {
        assert_int_equal(pthread_join(threads[i], NULL), 0);
        assert_true(workers[i].good);
    }
}

/* ---- memory ------------------------------------------------------------------------ */

/* If it failed, a game would allocate in every frame, and stutter when it least can. */
CASE(direct__warm_frames_allocate_nothing)
{
    struct pccd_client *client;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    struct test_grid grid;
    unsigned before = 0;

    if (!TEST_COUNTS_ALLOCATIONS) {
        test_skip("allocations are not counted in this build");
    }
    client = connect_direct();
    assert_non_null(client);
    assert_ok(test_grid_make(client, 50, &grid));
    for (int i = 0; i < 20; i++) {
        before = i == 10 ? test_allocations() : before;
        assert_ok(test_grid_turn(&grid, NULL, &answer));
        assert_int_equal(answer.total, 2500);
        pccd_answer_release(client, &answer);
    }
    assert_int_equal(test_allocations() - before, 0);
    assert_true(before > 0); /* they are counted */
    test_grid_close(&grid);
}

/* If it failed, what a step finds, which lies where its page will, would be written over
 * the answers that the client still reads. */
CASE(direct__held_answers_stay_while_others_are_found)
{
    enum { CONTACTS = 150 * 150, HELD = 2 };
    static struct pccd_contact copies[HELD][CONTACTS];
    struct pccd_answer held[HELD] = {PCCD_ANSWER_INIT, PCCD_ANSWER_INIT};
    struct test_grid grid;

    struct pccd_client *client = test_client(&(struct pccd_options){
        .url = "direct:",
        .result_bytes = 5u << 20}); /* three pages and a half, so that they go round */
    assert_ok(test_grid_make(client, 150, &grid));
    for (int i = 0; i < 12; i++) {
        struct pccd_answer *oldest = &held[i % HELD];

        pccd_answer_release(client, oldest);
        assert_ok(test_grid_turn(&grid, NULL, oldest));
        assert_int_equal(oldest->total, CONTACTS);
        assert_int_equal(oldest->count, CONTACTS);
        memcpy(copies[i % HELD], oldest->contacts, sizeof copies[0]);
        for (int k = 0; k < HELD && i > 0; k++) {
            assert_memory_equal(held[k].contacts, copies[k], sizeof copies[0]);
        }
    }
    test_grid_close(&grid);
}

/* If it failed, a program that connects now and then would grow. */
CASE(direct__last_client_leaves_nothing)
{
    uint32_t fds = count_entries("/proc/self/fd");

    for (int round = 0; round < 3; round++) {
        struct pccd_client *first = connect_direct();
        struct pccd_client *second = connect_direct();
        struct pccd_answer answer = PCCD_ANSWER_INIT;
        struct test_grid grid;
        uint64_t step = 0;

        assert_non_null(first);
        assert_non_null(second);
        assert_int_equal(test_stat(first, "sessions_now"), 2);
        assert_ok(test_grid_make(first, 50, &grid));
        assert_ok(test_grid_submit(&grid, NULL, &step)); /* nobody takes it */
        assert_true(pccd_fd(first) >= 0);
        assert_true(test_stat(second, "engine_bytes_now") > 0);
        pccd_close(first);
        test_grid_free(&grid);
        assert_int_equal(test_stat(second, "engine_bytes_now"), 0);
        assert_int_equal(test_stat(second, "shm_bytes_now"), 0);
        assert_int_equal(test_stat(second, "sessions_now"), 1);
        assert_int_equal(pccd_poll(second, &answer), PCCD_E_AGAIN);
        pccd_close(second);
    }
    assert_int_equal(count_entries("/proc/self/fd"), fds);
}

/* ---- the descriptor ---------------------------------------------------------------- */

static bool is_readable(int fd)
{
    struct pollfd watched = {.fd = fd, .events = POLLIN};

    return poll(&watched, 1, 0) == 1;
}

/* If it failed, a program with an event loop would miss an answer, or spin. */
CASE(direct__descriptor_is_readable_while_answers_wait)
{
    struct pccd_client *client = connect_direct();
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    struct test_grid grid;
    uint64_t steps[2];

    assert_non_null(client);
    assert_ok(test_grid_make(client, 10, &grid));
    assert_ok(test_grid_submit(&grid, NULL, &steps[0]));
    assert_true(is_readable(pccd_fd(client))); /* asked for after the answer had come */
    assert_ok(pccd_poll(client, &answer));
    assert_int_equal(answer.step, steps[0]);
    pccd_answer_release(client, &answer);
    assert_false(is_readable(pccd_fd(client)));
    for (int i = 0; i < 2; i++) {
        assert_ok(test_grid_submit(&grid, NULL, &steps[i]));
        assert_true(is_readable(pccd_fd(client)));
    }
    for (int i = 0; i < 2; i++) {
        assert_ok(pccd_poll(client, &answer));
        assert_int_equal(answer.step, steps[i]);
        pccd_answer_release(client, &answer);
    }
    assert_false(is_readable(pccd_fd(client)));
    assert_int_equal(pccd_poll(client, &answer), PCCD_E_AGAIN);
    test_grid_close(&grid);
}

/* If it failed, a step would be cut short by the time that its program took to ask. */
CASE(direct__deadline_counts_computing_alone)
{
    struct pccd_step_settings settings = {
        .struct_bytes = sizeof(struct pccd_step_settings), .deadline_ns = 20000000000u};
    struct pccd_client *client = connect_direct();
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    struct test_grid grid;
    uint64_t steps[3];

    assert_non_null(client);
    assert_ok(test_grid_make(client, 60, &grid));
    for (int i = 0; i < 3; i++) {
        settings.deadline_ns = i == 1 ? 1 : 20000000000u;
        assert_ok(test_grid_submit(&grid, &settings, &steps[i]));
        assert_ok(pccd_cancel(client, steps[i])); /* too late: it is done */
    }
    for (int i = 0; i < 3; i++) {
        assert_ok(pccd_wait(client, steps[i], 0, &answer));
        assert_int_equal(answer.incomplete,
                         i == 1 ? PCCD_INCOMPLETE_DEADLINE : PCCD_COMPLETE);
        pccd_answer_release(client, &answer);
    }
    test_grid_close(&grid);
}
