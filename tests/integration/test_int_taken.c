/* test_int_taken.c - shared memory is charged as it is taken, and given back when
 * idle. */
#include "cases.h"

#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>

#include "crossing.h"
#include "daemon.h"
#include "fixture.h"
#include "grid.h"
#include "must.h"
#include "taken.h"

#define CLIENTS     100u
#define CLIENTS_MAX 1000u
#define SIDE_SMALL  4u
#define SIDE_LARGE  300u /* 90 000 contacts of 64 bytes */
#define SOUP        1000u
#define IDLE_MS     2000u
#define HOARD_BYTES (70ull << 20)

/* A client with default settings. */
static struct pccd_client *connect_by_default(const char *url)
{
    struct pccd_options options;
    struct pccd_client *client = NULL;

    memset(&options, 0, sizeof options);
    options.url = url;
    assert_ok(pccd_connect(&options, &client));
    return client;
}

static void turn(struct test_grid *grid)
{
    uint64_t step = 0;

    assert_ok(test_grid_submit(grid, NULL, &step));
    assert_ok(test_grid_await(grid, step));
}

/* If it failed, the eighth client of a user would be refused for memory that nobody
 * uses. */
CASE_DAEMON(clients__with_small_scenes_take_little, "--clients-max", "1002",
            "--connections-max", "2000", "--meshes-max", "2000")
{
    static struct test_grid grids[CLIENTS_MAX];
    const char *chosen = getenv("PCCD_CLIENTS");
    uint32_t count = chosen != NULL ? (uint32_t)atoi(chosen) : CLIENTS;
    struct rlimit files;

    assert_true(count >= 1 && count <= CLIENTS_MAX);
    assert_int_equal(getrlimit(RLIMIT_NOFILE, &files), 0);
    files.rlim_cur = files.rlim_max;
    assert_int_equal(setrlimit(RLIMIT_NOFILE, &files), 0);
    for (uint32_t i = 0; i < count; i++) {
        struct pccd_client *client = connect_by_default(test_own.url);

        assert_ok(test_grid_make(client, SIDE_SMALL, &grids[i]));
        turn(&grids[i]);
    }
    for (int round = 0; round < 20; round++) {
        turn(&grids[0]); /* answers that are released do not walk through the region */
    }
    uint64_t told = test_stat(grids[0].client, "shm_bytes_now");

    print_message("# %u clients: %llu KiB of shared memory\n", count,
                  (unsigned long long)(told >> 10));
    assert_int_equal(told, test_taken_bytes());
    assert_true(told / count < (512u << 20) / CLIENTS_MAX);
    for (uint32_t i = 0; i < count; i++) {
        struct pccd_client *client = grids[i].client;

        test_grid_free(&grids[i]);
        pccd_close(client);
    }
}

/* If it failed, the first frame of a mesh would attach larger slots: both rings are there
 * for a while, and the client waits for it. */
CASE_DAEMON(slots__hold_a_frame_of_the_first_mesh, NULL)
{
    static double x[3 * SOUP][3];
    static uint32_t triangles[SOUP][3];
    struct pccd_answer answer = PCCD_ANSWER_INIT;

    for (uint32_t i = 0; i < 3 * SOUP; i++) {
        x[i][0] = i / 3 * 4 + i % 3; /* they do not meet */
        x[i][1] = i % 3 == 1;
        triangles[i / 3][i % 3] = i;
    }
    struct pccd_client *client = connect_by_default(test_own.url);

    uint32_t mesh = test_mesh(client, x, PCCD_FORMAT_F64, 3 * SOUP, triangles, SOUP);
    uint64_t before = test_stat(client, "shm_bytes_now");

    uint32_t scene = test_scene(client);
    uint32_t object = test_object(client, scene, mesh);
    assert_ok(
        pccd_step_x1(client, scene, object, x, PCCD_FORMAT_F64, 3 * SOUP, NULL, &answer));
    pccd_answer_release(client, &answer);
    assert_int_equal(test_stat(client, "shm_bytes_now"), before);
    assert_true(before < (512u << 20) / CLIENTS_MAX);
    pccd_close(client);
}

/* If it failed, an answer that needs memory which the region has not taken would be lost,
 * or be charged to nobody. */
CASE_DAEMON(region__takes_what_an_answer_needs, NULL)
{
    struct test_grid grid;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    uint64_t step = 0;

    struct pccd_client *client = connect_by_default(test_own.url);

    assert_ok(test_grid_make(client, SIDE_LARGE, &grid));
    uint64_t before = test_stat(client, "shm_bytes_now");

    assert_ok(test_grid_submit(&grid, NULL, &step));
    assert_ok(pccd_wait(client, step, 60000, &answer));
    assert_int_equal(answer.incomplete, PCCD_COMPLETE);
    assert_int_equal(answer.total, SIDE_LARGE * SIDE_LARGE);
    assert_int_equal(answer.count, answer.total);
    pccd_answer_release(client, &answer);
    uint64_t told = test_stat(client, "shm_bytes_now");

    assert_true(told > before + (1u << 20));
    assert_int_equal(told, test_taken_bytes());
    test_grid_close(&grid);
    client = connect_by_default(test_own.url);
    assert_int_equal(test_stat_await(client, "shm_bytes_now", 0), 0);
    pccd_close(client);
}

/* Return what is left of the shared memory when nobody has asked anything for a while. */
static uint64_t bytes_when_idle(struct pccd_client *client)
{
    test_sleep_ms(IDLE_MS);
    return test_stat(client, "shm_bytes_now");
}

/* Submit a turn, and take its answer. */
static void ask(struct test_grid *grid, struct pccd_answer *answer)
{
    uint64_t step = 0;

    assert_ok(test_grid_submit(grid, NULL, &step));
    assert_ok(pccd_wait(grid->client, step, 60000, answer));
}

/* If it failed, a client that once had a large answer would hold its memory for as long
 * as it is connected. */
CASE_DAEMON(region__gives_memory_back_when_idle, NULL)
{
    struct test_grid grid;
    struct pccd_answer answer = PCCD_ANSWER_INIT;

    struct pccd_client *client = connect_by_default(test_own.url);

    assert_ok(test_grid_make(client, SIDE_LARGE, &grid));
    turn(&grid); /* slots are as large as they will be */
    uint64_t idle = bytes_when_idle(client);

    for (int round = 0; round < 3; round++) {
        ask(&grid, &answer);
        assert_true(test_grid_is_right(&grid, &answer));
        pccd_answer_release(client, &answer);
        assert_true(test_stat(client, "shm_bytes_now") > idle + (1u << 20));
        assert_int_equal(test_stat_await(client, "shm_bytes_now", idle), idle);
        assert_int_equal(test_taken_bytes(), idle);
    }
    ask(&grid, &answer);
    test_sleep_ms(IDLE_MS);
    assert_true(test_grid_is_right(&grid, &answer)); /* what is held stays */
    assert_true(test_stat(client, "shm_bytes_now") > idle + (1u << 20));
    pccd_answer_release(client, &answer);
    test_grid_close(&grid);
}

/* The answer to a turn, page by page. Returns how many there were. */
static uint32_t ask_by_pages(struct test_grid *grid)
{
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    uint32_t pages = 1;

    ask(grid, &answer);
    uint64_t records = answer.count;

    while (answer.incomplete == PCCD_INCOMPLETE_RESULT_FULL) {
        uint64_t cursor = answer.cursor;
        uint64_t step = answer.step;

        assert_true(answer.count > 0);
        pccd_answer_release(grid->client, &answer);
        assert_ok(pccd_fetch(grid->client, grid->scene, step, cursor, &answer));
        records += answer.count;
        pages++;
    }
    assert_int_equal(answer.incomplete, PCCD_COMPLETE);
    assert_int_equal(records, answer.total);
    pccd_answer_release(grid->client, &answer);
    print_message("# %llu records in %u pages\n", (unsigned long long)records, pages);
    return pages;
}

/* If it failed, a user's quota would lose records, or end the daemon, where the region is
 * larger than what the user may take: the answer comes in pages then. */
CASE_DAEMON(region__is_as_large_as_the_quota_allows, "--shm-max-mib", "76")
{
    struct test_grid other;
    struct test_grid grid;
    struct pccd_options hoard;
    struct pccd_client *hoarder = NULL;

    struct pccd_client *client = connect_by_default(test_own.url);

    assert_ok(test_grid_make(client, SIDE_LARGE, &grid));
    assert_int_equal(ask_by_pages(&grid), 1);
    assert_true(bytes_when_idle(client) < 5u << 20);
    memset(&hoard, 0, sizeof hoard); /* takes what was given back, and more */
    hoard.url = test_own.url;
    hoard.slot_count = 1;
    hoard.slot_bytes = HOARD_BYTES;
    hoard.result_bytes = 1u << 20;
    assert_ok(pccd_connect(&hoard, &hoarder));
    assert_ok(test_grid_make(hoarder, SIDE_SMALL, &other));
    assert_true(ask_by_pages(&grid) > 1);
    assert_true(test_stat(client, "shm_bytes_now") <= 76u << 20);
    turn(&other);
    test_grid_free(&grid);
    test_grid_free(&other);
    pccd_close(client);
    pccd_close(hoarder);
}

#define SLOTS 4u /* of a client that does not say how many (pccd.h) */

/* As many turns at once as there are slots. */
static void turn_in_all_slots(struct test_grid *grid)
{
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    uint64_t steps[SLOTS];

    for (uint32_t i = 0; i < SLOTS; i++) {
        assert_ok(test_grid_submit(grid, NULL, &steps[i]));
    }
    for (uint32_t i = 0; i < SLOTS; i++) {
        assert_ok(pccd_wait(grid->client, steps[i], 60000, &answer));
        assert_int_equal(answer.total, SIDE_LARGE * SIDE_LARGE);
        pccd_answer_release(grid->client, &answer);
    }
}

/* If it failed, a client that once had many steps in flight would hold the memory of all
 * its slots for as long as it is connected; or the positions that only a slot holds would
 * be lost with its memory: another daemon would be told zeros. */
CASE_DAEMON(slots__give_memory_back_when_idle, NULL)
{
    const uint64_t slot_bytes = SIDE_LARGE * SIDE_LARGE * sizeof(float[3]);
    struct test_grid grid;
    struct pccd_answer answer = PCCD_ANSWER_INIT;

    struct pccd_client *client = connect_by_default(test_own.url);

    assert_ok(test_grid_make(client, SIDE_LARGE, &grid));
    turn(&grid);
    uint64_t idle = bytes_when_idle(client);

    assert_true(idle < 3 * slot_bytes);
    for (int round = 0; round < 3; round++) {
        turn_in_all_slots(&grid);
        uint64_t told = test_stat(client, "shm_bytes_now");

        assert_true(told > idle + 2 * slot_bytes);
        assert_int_equal(test_taken_bytes(), told);
        assert_true(bytes_when_idle(client) <= idle);
        assert_int_equal(test_taken_bytes(), bytes_when_idle(client));
    }
    assert_true(WIFSIGNALED(test_daemon_end(&test_own, SIGKILL, 10000)));
    assert_true(test_daemon_restart(&test_own, NULL));
    ask(&grid, &answer);
    assert_true(test_grid_is_right(&grid, &answer));
    pccd_answer_release(client, &answer);
    test_grid_close(&grid);
}

/* If it failed, a client would be refused a frame for want of memory, although it has
 * slots that have some. */
CASE_DAEMON(slots__that_have_memory_do_when_more_is_refused, "--shm-max-mib", "76")
{
    struct test_grid other;
    struct test_grid grid;
    struct pccd_options hoard;
    struct pccd_client *hoarder = NULL;

    struct pccd_client *client = connect_by_default(test_own.url);

    assert_ok(test_grid_make(client, SIDE_LARGE, &grid));
    turn(&grid);
    uint64_t idle = bytes_when_idle(client);

    memset(&hoard, 0, sizeof hoard); /* leaves less than a slot */
    hoard.url = test_own.url;
    hoard.slot_count = 1;
    hoard.slot_bytes = (76u << 20) - idle - (512u << 10);
    hoard.result_bytes = 1u << 16;
    assert_ok(pccd_connect(&hoard, &hoarder));
    assert_ok(test_grid_make(hoarder, SIDE_SMALL, &other));
    for (int round = 0; round < 3; round++) {
        assert_true(ask_by_pages(&grid) > 1);
    }
    assert_true(test_stat(client, "shm_bytes_now") <= 76u << 20);
    turn(&other);
    test_grid_free(&grid);
    test_grid_free(&other);
    pccd_close(client);
    pccd_close(hoarder);
}

/* If it failed, a client whose frames grow would be refused larger slots, although the
 * user may have them: old and new ones would be there at the same time. */
CASE_DAEMON(slots__grow_into_the_memory_that_they_give_back, "--shm-max-mib", "76")
{
    struct pccd_options asked;
    struct pccd_frame frame;
    struct pccd_client *client = NULL;
    uint32_t scene = 0;

    memset(&asked, 0, sizeof asked);
    asked.url = test_own.url;
    asked.slot_count = 2;
    asked.result_bytes = 1u << 16;
    assert_ok(pccd_connect(&asked, &client));
    scene = test_scene(client);
    assert_ok(pccd_frame_begin(client, scene, 1, 20u << 20, &frame));
    pccd_frame_abort(&frame);
    assert_true(test_stat(client, "shm_bytes_now") > 40u << 20);
    assert_ok(pccd_frame_begin(client, scene, 1, 30u << 20, &frame));
    pccd_frame_abort(&frame);
    assert_true(test_stat(client, "shm_bytes_now") > 60u << 20);
    /* What is too much is refused, and what was there can be used again. */
    assert_int_equal(pccd_frame_begin(client, scene, 1, 40u << 20, &frame), PCCD_E_QUOTA);
    assert_ok(pccd_frame_begin(client, scene, 1, 30u << 20, &frame));
    pccd_frame_abort(&frame);
    pccd_close(client);
}
