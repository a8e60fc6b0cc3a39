/* test_int_session.c - sessions with a real daemon: start, agree, share, end. */
#include "cases.h"

#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include "crossing.h"
#include "daemon.h"
#include "fixture.h"
#include "grid.h"
#include "must.h"
#include "pccd.h"
#include "raw.h"

static struct test_daemon shared; /* for the tests that need no options of their own */

static int start_shared(void **state)
{
    (void)state;
    return test_daemon_start(&shared, NULL) ? 0 : -1;
}

static int stop_shared(void **state)
{
    (void)state;
    return test_daemon_finish(&shared) ? 0 : -1;
}

/* If it failed, a client could not tell which daemon it talks to, or not at all. */
CASE(session__hello_and_ping_reach_the_daemon)
{
    struct pccd_client *client = test_client_at(shared.url);
    uint64_t round_trip_ns = 0;

    assert_int_equal(pccd_daemon_pid(client), shared.pid);
    assert_string_equal(pccd_url(client), shared.url);
    assert_true(pccd_fd(client) >= 0);
    assert_ok(pccd_ping(client, &round_trip_ns));
    assert_true(round_trip_ns > 0 && round_trip_ns < 10000000000u);
    assert_ok(pccd_ping(client, NULL));
    assert_string_equal(pccd_error_text(client), "");
    pccd_close(client);
}

/* If it failed, a client of another protocol would be half understood. */
CASE(session__unknown_version_is_refused)
{
    static struct test_raw raw;

    assert_true(test_raw_open(&raw, shared.socket));
    assert_int_equal(RAW_CALL(&raw, HELLO, NULL, .version_min = PROTO_VERSION_MAX + 1,
                              .version_max = PROTO_VERSION_MAX + 3),
                     PCCD_E_VERSION);
    assert_true(raw.error.fatal);
    assert_int_equal(test_raw_receive(&raw), PCCD_E_DISCONNECTED);
    test_raw_close(&raw);
}

/* If it failed, a newer client that still speaks our version would be turned away. */
CASE(session__version_range_that_overlaps_is_agreed)
{
    struct proto_HELLO_result result;
    static struct test_raw raw;

    assert_true(test_raw_open(&raw, shared.socket));
    assert_ok(RAW_CALL(&raw, HELLO, &result, .version_min = PROTO_VERSION_MIN,
                       .version_max = PROTO_VERSION_MAX + 7));
    assert_int_equal(result.version, PROTO_VERSION_MAX);
    assert_int_equal(result.pid, shared.pid);
    test_raw_close(&raw);
}

/* If it failed, a peer could use the daemon without having agreed on a version. */
CASE(session__requests_before_hello_are_refused)
{
    struct proto_PING_result pong;
    uint32_t scene;
    static struct test_raw raw;

    assert_true(test_raw_open(&raw, shared.socket));
    assert_ok(RAW_CALL(&raw, PING, &pong, .token = 77));
    assert_int_equal(pong.token, 77);
    assert_int_equal(test_raw_scene(&raw, "", &scene), PCCD_E_NOHELLO);
    assert_ok(test_raw_hello(&raw));
    assert_int_equal(test_raw_hello(&raw), PCCD_E_STATE);
    assert_ok(test_raw_scene(&raw, "", &scene));
    test_raw_close(&raw);
}

static void count_stat(void *context, const char *name, uint64_t value, const char *text)
{
    (void)value;
    assert_true(name[0] != '\0' && text[0] != '\0');
    (*(unsigned *)context)++;
}

/* If it failed, the counters that every other test relies on would be wrong. */
CASE(session__stats_count_what_happens)
{
    struct pccd_client *client = test_client_at(shared.url);
    struct test_crossing crossing;
    unsigned count = 0;
    uint64_t steps;
    uint64_t contacts;

    assert_ok(pccd_stats(client, count_stat, &count));
    assert_true(count >= 30);
    assert_int_equal(test_stat(client, "pid"), shared.pid);
    assert_int_equal(test_stat_await(client, "sessions_now", 1), 1);
    assert_ok(test_crossing_make(client, &crossing));
    assert_int_equal(test_stat(client, "meshes_now"), 2);
    assert_int_equal(test_stat(client, "scenes_now"), 1);
    assert_int_equal(test_stat(client, "objects_now"), 2);
    steps = test_stat(client, "steps");
    contacts = test_stat(client, "contacts");
    for (int i = 0; i < 5; i++)
        assert_true(test_crossing_turn(&crossing));
    assert_int_equal(test_stat(client, "steps"), steps + 5);
    assert_int_equal(test_stat(client, "contacts"), contacts + 15);
    assert_in_range(test_stat(client, "survivors"), 1, test_stat(client, "candidates"));
    pccd_close(client);
    client = test_connect(shared.url);
    assert_int_equal(test_stat_await(client, "meshes_now", 0), 0);
    assert_int_equal(test_stat_await(client, "shm_bytes_now", 0), 0);
    pccd_close(client);
}

/* If it failed, two daemons would fight over one path, or the user not learn who has
 * it. */
CASE(session__second_daemon_says_who_holds_the_path)
{
    struct pccd_client *client = test_client_at(shared.url);
    char pid[32];

    (void)snprintf(pid, sizeof pid, "%ld", (long)shared.pid);
    assert_int_not_equal(test_daemon_start_second(&shared), 0);
    assert_true(test_daemon_logged(&shared, pid));
    assert_ok(pccd_ping(client, NULL));
    pccd_close(client);
}

/* If it failed, one client's objects could be seen or moved by another. */
CASE(session__handles_of_another_client_are_refused)
{
    struct pccd_client *owner = test_client_at(shared.url);
    struct pccd_client *stranger = test_client_at(shared.url);
    struct test_crossing crossing;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    uint32_t object = 0;
    uint32_t scene = 0;

    assert_ok(test_crossing_make(owner, &crossing));
    assert_int_equal(pccd_mesh_destroy(stranger, crossing.mesh), PCCD_E_HANDLE);
    assert_int_equal(pccd_scene_destroy(stranger, crossing.scene), PCCD_E_HANDLE);
    assert_int_equal(pccd_scene_remove(stranger, crossing.scene, crossing.object),
                     PCCD_E_HANDLE);
    assert_int_equal(pccd_scene_add(stranger, crossing.scene, crossing.mesh, &object),
                     PCCD_E_HANDLE);
    assert_int_equal(pccd_step_x1(stranger, crossing.scene, crossing.object,
                                  test_triangle_x, PCCD_FORMAT_F32, 3, NULL, &answer),
                     PCCD_E_HANDLE);
    scene = test_scene(stranger);
    assert_int_equal(pccd_scene_add(stranger, scene, crossing.mesh, &object),
                     PCCD_E_HANDLE);
    assert_int_equal(pccd_step_x1(stranger, scene, crossing.object, test_triangle_x,
                                  PCCD_FORMAT_F32, 3, NULL, &answer),
                     PCCD_E_HANDLE);
    /* Nor is what is of one kind taken for another. */
    assert_int_equal(pccd_scene_add(owner, crossing.mesh, crossing.scene, &object),
                     PCCD_E_HANDLE);
    assert_non_null(strstr(pccd_error_text(owner), ", it is a mesh"));
    assert_int_equal(pccd_mesh_destroy(owner, crossing.scene), PCCD_E_HANDLE);
    assert_non_null(strstr(pccd_error_text(owner), ", it is a scene"));
    assert_int_equal(pccd_scene_destroy(owner, crossing.object), PCCD_E_HANDLE);
    assert_int_equal(pccd_scene_remove(owner, crossing.scene, crossing.mesh),
                     PCCD_E_HANDLE);
    assert_int_equal(pccd_step_x1(owner, crossing.scene, crossing.scene, test_triangle_x,
                                  PCCD_FORMAT_F32, 3, NULL, &answer),
                     PCCD_E_HANDLE);
    assert_true(test_crossing_turn(&crossing));
    pccd_close(stranger);
    assert_true(test_crossing_turn(&crossing));
    pccd_close(owner);
}

/* If it failed, a stale handle could reach what took its place. */
CASE(session__handles_die_with_what_they_name)
{
    struct pccd_client *client = test_client_at(shared.url);
    struct test_crossing old;
    struct test_crossing crossing;
    uint32_t object = 0;

    assert_ok(test_crossing_make(client, &old));
    assert_ok(pccd_scene_destroy(client, old.scene));
    assert_ok(pccd_mesh_destroy(client, old.mesh));
    assert_ok(test_crossing_make(client, &crossing));
    assert_int_equal(pccd_scene_destroy(client, old.scene), PCCD_E_HANDLE);
    assert_int_equal(pccd_mesh_destroy(client, old.mesh), PCCD_E_HANDLE);
    assert_int_equal(pccd_scene_add(client, crossing.scene, old.mesh, &object),
                     PCCD_E_HANDLE);
    assert_int_equal(pccd_scene_remove(client, crossing.scene, old.object),
                     PCCD_E_HANDLE);
    assert_true(test_crossing_turn(&crossing));
    pccd_close(client);
}

/* If it failed, clients would share state or starve each other. */
CASE(session__many_clients_take_turns)
{
    enum { CLIENTS = 12, TURNS = 10 };
    struct test_crossing crossings[CLIENTS];

    for (int i = 0; i < CLIENTS; i++) {
        struct pccd_client *client = test_client_at(shared.url);

        assert_ok(test_crossing_make(client, &crossings[i]));
    }
    for (int turn = 0; turn < TURNS; turn++) {
        for (int i = 0; i < CLIENTS; i++)
            assert_true(test_crossing_turn(&crossings[i]));
    }
    for (int i = 0; i < CLIENTS; i++)
        pccd_close(crossings[i].client);
}

/* If it failed, one user could take all connections, or a refusal hurt the others. */
CASE_DAEMON(session__clients_beyond_the_quota_are_refused, "--clients-max", "2")
{
    struct pccd_options connect = {.struct_bytes = 0};
    struct pccd_client *third = NULL;
    struct test_crossing crossing;
    int status = 0;

    struct pccd_client *first = test_client_at(test_own.url);
    struct pccd_client *second = test_client_at(test_own.url);
    assert_ok(test_crossing_make(first, &crossing));
    connect.url = test_own.url;
    for (int i = 0; i < 20; i++) {
        assert_int_equal(pccd_connect(&connect, &third), PCCD_E_QUOTA);
        assert_null(third);
        assert_non_null(strstr(pccd_error_text(NULL), "quota"));
        assert_true(test_crossing_turn(&crossing));
    }
    assert_int_equal(test_stat(first, "sessions_refused"), 20);
    pccd_close(second);
    for (int i = 0; i < 200; i++) { /* the daemon sees the end of file a little later */
        status = pccd_connect(&connect, &third);
        if (status != PCCD_E_QUOTA)
            break;
        test_sleep_ms(5);
    }
    assert_int_equal(status, 0);
    assert_ok(pccd_ping(third, NULL));
    assert_true(test_crossing_turn(&crossing));
    pccd_close(third);
    pccd_close(first);
}

/* If it failed, one user could fill the daemon's memory. */
CASE_DAEMON(session__meshes_triangles_and_memory_have_quotas, "--meshes-max", "4",
            "--triangles-max", "1000", "--shm-max-mib", "8")
{
    struct test_crossing crossing;
    struct test_grid grid;
    uint32_t meshes[2] = {0, 0};
    uint32_t extra = 0;

    struct pccd_client *client = test_client_at(test_own.url);
    assert_ok(test_crossing_make(client, &crossing));
    for (int i = 0; i < 2; i++)
        meshes[i] = test_mesh(client, test_floor_x, PCCD_FORMAT_F32, 3, test_triangle, 1);
    assert_int_equal(pccd_mesh_create(client, test_floor_x, PCCD_FORMAT_F32, 3,
                                      test_triangle, 1, &extra, NULL),
                     PCCD_E_QUOTA);
    assert_non_null(strstr(pccd_error_text(client), "meshes"));
    for (int i = 0; i < 2; i++)
        assert_ok(pccd_mesh_destroy(client, meshes[i]));
    assert_int_equal(test_stat_await(client, "meshes_now", 2),
                     2); /* freed a little later */
    assert_int_equal(test_grid_make(client, 40, &grid),
                     PCCD_E_QUOTA); /* 3042 triangles */
    assert_non_null(strstr(pccd_error_text(client), "triangles"));
    test_grid_free(&grid);
    struct pccd_client *greedy = test_client(
        &(struct pccd_options){.url = test_own.url, .result_bytes = 32u << 20});
    assert_int_equal(pccd_mesh_create(greedy, test_floor_x, PCCD_FORMAT_F32, 3,
                                      test_triangle, 1, &extra, NULL),
                     PCCD_E_QUOTA);
    assert_ok(pccd_ping(greedy, NULL));
    pccd_close(greedy);
    assert_true(test_crossing_turn(&crossing));
    pccd_close(client);
}

/* If it failed, a restart would throw away work that clients wait for. */
CASE_DAEMON(session__sigterm_answers_what_is_in_flight, NULL)
{
    enum { STEPS = 4 };
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    struct test_grid grid;
    uint64_t steps[STEPS];
    int status;

    struct pccd_client *client = test_connect_once(test_own.url);
    assert_non_null(client);
    assert_ok(test_grid_make(client, 60, &grid));
    for (int i = 0; i < STEPS; i++)
        assert_ok(test_grid_submit(&grid, NULL, &steps[i]));
    assert_ok(pccd_ping(client, NULL)); /* behind the steps: they have been read */
    assert_int_equal(kill(test_own.pid, SIGTERM), 0);
    for (int i = 0; i < STEPS; i++) {
        assert_ok(pccd_wait(client, steps[i], -1, &answer));
        assert_true(test_grid_is_right(&grid, &answer));
        pccd_answer_release(client, &answer);
    }
    status = test_daemon_end(&test_own, 0, 10000);
    assert_true(WIFEXITED(status));
    assert_int_equal(WEXITSTATUS(status), 0);
    assert_int_not_equal(access(test_own.socket, F_OK), 0);
    assert_int_equal(pccd_ping(client, NULL), PCCD_E_DISCONNECTED);
    assert_true(pccd_error_text(client)[0] != '\0');
    test_grid_close(&grid);
}

/* If it failed, daemons that nobody uses would stay for ever. */
CASE_DAEMON(session__idle_daemon_ends_by_itself, "--idle-exit", "1")
{
    struct pccd_client *client;
    int status;

    client = test_client_at(test_own.url);
    test_sleep_ms(1500);
    assert_ok(pccd_ping(client, NULL)); /* a silent client is a client */
    pccd_close(client);
    status = test_daemon_end(&test_own, 0, 8000);
    assert_true(WIFEXITED(status));
    assert_int_equal(WEXITSTATUS(status), 0);
}

/* If it failed, a program would wait for a daemon that cannot be, or get one unasked. */
CASE(session__no_daemon_is_an_error_with_a_text)
{
    struct pccd_options options;
    struct pccd_client *client = NULL;
    uint64_t begin_ms = test_now_ms();

    assert_int_equal(setenv("XDG_RUNTIME_DIR", "/nonexistent", 1), 0);
    pccd_options_init(&options);
    options.no_autostart = true;
    assert_int_equal(pccd_connect(&options, &client), PCCD_E_NODAEMON);
    assert_non_null(strstr(pccd_error_text(NULL), "/nonexistent"));
    options.no_autostart = false;
    options.daemon = "/nonexistent/pccdd";
    assert_int_equal(pccd_connect(&options, &client), PCCD_E_NODAEMON);
    assert_non_null(strstr(pccd_error_text(NULL), "/nonexistent/pccdd"));
    options.private_daemon = true;
    options.daemon = "/bin/false";
    assert_int_equal(pccd_connect(&options, &client), PCCD_E_NODAEMON);
    assert_non_null(strstr(pccd_error_text(NULL), "ended at once"));
    options.private_daemon = false;
    options.url = "unix:/nonexistent/socket";
    assert_int_equal(pccd_connect(&options, &client), PCCD_E_NODAEMON);
    assert_int_equal(setenv("PCCD_URL", "unix:/nonexistent/other", 1), 0);
    options.url = NULL;
    assert_int_equal(pccd_connect(&options, &client), PCCD_E_NODAEMON);
    assert_non_null(strstr(pccd_error_text(NULL), "/nonexistent/other"));
    assert_int_equal(unsetenv("PCCD_URL"), 0);
    assert_null(client);
    assert_true(test_now_ms() - begin_ms < 5000);
}

/* If it failed, wrong options would be guessed at instead of refused. */
CASE(session__wrong_options_are_refused)
{
    struct pccd_options good;
    struct pccd_options bad;
    struct pccd_client *client = NULL;

    pccd_options_init(&good);
    good.url = shared.url;
    assert_int_equal(pccd_connect(&good, NULL), PCCD_E_INVAL);
#define REFUSED(change)                                                                  \
    do {                                                                                 \
        bad = good;                                                                      \
        change;                                                                          \
        assert_int_equal(pccd_connect(&bad, &client), PCCD_E_INVAL);                     \
        assert_true(pccd_error_text(NULL)[0] != '\0');                                   \
    } while (0)
    REFUSED(bad.struct_bytes = 7);
    REFUSED(bad.struct_bytes = 1u << 20);
    REFUSED(bad.timeout_ms = -1);
    REFUSED(bad.timeout_ms = 3600001);
    REFUSED(bad.slot_count = 17);
    REFUSED(bad.slot_bytes = 100);
    REFUSED(bad.result_bytes = 100);
    REFUSED(bad.spin_us = 1001);
    REFUSED(bad.private_daemon = true);
    REFUSED(bad.url = "tcp:localhost");
    REFUSED(bad.url = "unix:");
    REFUSED(bad.url =
                "unix:/tmp/a/path/that/is/much/too/long/for/a/socket/address/because/"
                "it/has/more/than/one/hundred/and/seven/bytes/in/it");
#undef REFUSED
    assert_null(client);
    assert_ok(pccd_connect(&good, &client));
    assert_string_equal(pccd_error_text(NULL), "");
    pccd_close(client);
    pccd_close(NULL);
}

/* If it failed, a call without a client would crash the program. */
CASE(session__null_arguments_are_refused)
{
    struct pccd_client *client = test_client_at(shared.url);
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    struct pccd_frame frame;
    uint64_t step = 0;
    uint32_t handle = 0;

    assert_int_equal(pccd_ping(NULL, NULL), PCCD_E_INVAL);
    assert_int_equal(pccd_stats(NULL, count_stat, NULL), PCCD_E_INVAL);
    assert_int_equal(pccd_stats(client, NULL, NULL), PCCD_E_INVAL);
    assert_int_equal(pccd_scene_create(NULL, NULL, &handle), PCCD_E_INVAL);
    assert_int_equal(pccd_scene_create(client, NULL, NULL), PCCD_E_INVAL);
    assert_int_equal(pccd_scene_add(client, 1, 1, NULL), PCCD_E_INVAL);
    assert_int_equal(pccd_mesh_create(client, NULL, PCCD_FORMAT_F32, 3, test_triangle, 1,
                                      &handle, NULL),
                     PCCD_E_INVAL);
    assert_int_equal(pccd_mesh_create(client, test_floor_x, (enum pccd_format)9, 3,
                                      test_triangle, 1, &handle, NULL),
                     PCCD_E_INVAL);
    assert_int_equal(pccd_mesh_create(client, test_floor_x, PCCD_FORMAT_F32, 0,
                                      test_triangle, 1, &handle, NULL),
                     PCCD_E_INVAL);
    assert_int_equal(pccd_mesh_edges(client, 1, NULL, 4), PCCD_E_INVAL);
    assert_int_equal(pccd_frame_begin(client, 1, 1, 64, NULL), PCCD_E_INVAL);
    assert_int_equal(pccd_frame_begin(NULL, 1, 1, 64, &frame), PCCD_E_INVAL);
    assert_int_equal(pccd_frame_commit(NULL, NULL, &step), PCCD_E_INVAL);
    assert_int_equal(pccd_submit_still(client, 1, NULL, NULL), PCCD_E_INVAL);
    assert_int_equal(pccd_poll(client, NULL), PCCD_E_INVAL);
    assert_int_equal(pccd_poll(client, &answer), PCCD_E_AGAIN);
    assert_int_equal(pccd_wait(client, 12345, -1, &answer), PCCD_E_INVAL);
    assert_int_equal(pccd_cancel(client, 12345), PCCD_E_INVAL);
    assert_int_equal(pccd_step_x1(client, 1, 1, NULL, PCCD_FORMAT_F32, 3, NULL, &answer),
                     PCCD_E_INVAL);
    pccd_frame_abort(NULL);
    pccd_answer_release(client, NULL);
    assert_int_equal(pccd_fd(NULL), -1);
    assert_int_equal(pccd_daemon_pid(NULL), 0);
    pccd_close(client);
}

/* If it failed, clients would be refused although there is a place now. */
CASE_DAEMON(session__limit_that_is_raised_lets_in_who_waits, "--connections-max", "8")
{
    struct test_raw raw;

    struct pccd_client *client = test_client_at(test_own.url);
    assert_ok(pccd_config_set(client, "connections-max", "1"));
    assert_true(test_raw_open(&raw, test_own.socket)); /* has not said hello */
    assert_ok(pccd_ping(client, NULL));                /* the daemon has looked at it */
    assert_ok(pccd_config_set(client, "connections-max", "2"));
    assert_ok(test_raw_hello(&raw));
    test_raw_close(&raw);
    pccd_close(client);
}

#define MANY 16384u

/* Return whether another client is told how many objects are left while they go. */
static bool is_told_meanwhile(struct pccd_client *other)
{
    struct pccd_client *client = test_client_at(shared.url);
    uint64_t before = test_stat(other, "objects_now");
    uint64_t left;
    uint32_t scene, mesh;
    bool is_told = false;

    scene = test_scene(client);
    mesh = test_mesh(client, test_triangle_x, PCCD_FORMAT_F32, 3, test_triangle, 1);
    for (uint32_t i = 0; i < MANY; i++) {
        (void)test_object(client, scene, mesh);
    }
    pccd_close(client);
    while ((left = test_stat(other, "objects_now")) > before && !is_told) {
        is_told = left < before + MANY;
    }
    return is_told;
}

/* If it failed, all clients would wait until everything of one that leaves is freed: 5 ms
 * for a scene that is full, and there may be 64 of them. */
CASE(session__that_had_much_leaves_by_turns)
{
    struct pccd_client *other = test_client_at(shared.url);
    bool is_told = false;
    for (int i = 0; i < 4 && !is_told; i++) {
        is_told = is_told_meanwhile(other);
    }
    assert_true(is_told);
    pccd_close(other);
}

CASES_WITH(start_shared, stop_shared);
