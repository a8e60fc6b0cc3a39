/* test_int_taken.c - shared memory is charged as it is taken.
 *
 * Room:     tests/integration. May include: pccd.h, tests/support.
 * Does:     many clients with default settings within the quota of one user; answers
 *           larger than what the result region has taken; a quota that refuses more of
 *           it. What the daemon says is compared with what the kernel says. PCCD_CLIENTS
 *           is how many clients connect (100).
 * Threads:  one.
 */
#include <dirent.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

#include "crossing.h"
#include "daemon.h"
#include "grid.h"

#define CLIENTS     100u
#define CLIENTS_MAX 1000u
#define SIDE_SMALL  4u
#define SIDE_LARGE  300u /* 90 000 contacts of 64 bytes */

/* Bytes that the kernel has taken for the memories that this process holds, all of which
 * are shared with the daemon. */
static uint64_t bytes_of_kernel(void)
{
    DIR *folder = opendir("/proc/self/fd");
    uint64_t bytes = 0;

    assert_non_null(folder);
    for (struct dirent *entry = readdir(folder); entry != NULL; entry = readdir(folder)) {
        char path[300];
        char target[64] = "";
        struct stat info;

        (void)snprintf(path, sizeof(path), "/proc/self/fd/%s", entry->d_name);
        if (readlink(path, target, sizeof(target) - 1) > 0 &&
            strncmp(target, "/memfd:pccd-", 12) == 0 && stat(path, &info) == 0) {
            bytes += (uint64_t)info.st_blocks * 512;
        }
    }
    closedir(folder);
    return bytes;
}

/* A client with default settings. */
static struct pccd_client *connect_by_default(const char *url)
{
    struct pccd_options options;
    struct pccd_client *client = NULL;

    memset(&options, 0, sizeof(options));
    options.url = url;
    assert_int_equal(pccd_connect(&options, &client), 0);
    return client;
}

static void turn(struct test_grid *grid)
{
    uint64_t step = 0;

    assert_int_equal(test_grid_submit(grid, NULL, &step), 0);
    assert_int_equal(test_grid_await(grid, step), 0);
}

/* If it failed, the eighth client of a user would be refused for memory that nobody
 * uses. */
static void clients__with_small_scenes_take_little(void **state)
{
    static const char *const options[] = {"--clients-max", "1002", "--connections-max",
                                          "2000", "--meshes-max", "2000", NULL};
    static struct test_grid grids[CLIENTS_MAX];
    const char *chosen = getenv("PCCD_CLIENTS");
    uint32_t count = chosen != NULL ? (uint32_t)atoi(chosen) : CLIENTS;
    struct test_daemon daemon;
    struct rlimit files;

    (void)state;
    assert_true(count >= 1 && count <= CLIENTS_MAX);
    assert_int_equal(getrlimit(RLIMIT_NOFILE, &files), 0);
    files.rlim_cur = files.rlim_max;
    assert_int_equal(setrlimit(RLIMIT_NOFILE, &files), 0);
    assert_true(test_daemon_start(&daemon, options));
    for (uint32_t i = 0; i < count; i++) {
        struct pccd_client *client = connect_by_default(daemon.url);

        assert_int_equal(test_grid_make(client, SIDE_SMALL, &grids[i]), 0);
        turn(&grids[i]);
    }
    for (int round = 0; round < 20; round++) {
        turn(&grids[0]); /* answers that are released do not walk through the region */
    }
    uint64_t told = test_stat(grids[0].client, "shm_bytes_now");

    print_message("# %u clients: %llu KiB of shared memory\n", count,
                  (unsigned long long)(told >> 10));
    assert_int_equal(told, bytes_of_kernel());
    assert_true(told / count < (512u << 20) / CLIENTS_MAX);
    for (uint32_t i = 0; i < count; i++) {
        struct pccd_client *client = grids[i].client;

        test_grid_free(&grids[i]);
        pccd_close(client);
    }
    assert_true(test_daemon_finish(&daemon));
}

/* If it failed, an answer that needs memory which the region has not taken would be lost,
 * or be charged to nobody. */
static void region__takes_what_an_answer_needs(void **state)
{
    struct test_daemon daemon;
    struct test_grid grid;
    struct pccd_answer answer;
    uint64_t step = 0;

    (void)state;
    assert_true(test_daemon_start(&daemon, NULL));
    struct pccd_client *client = connect_by_default(daemon.url);

    assert_int_equal(test_grid_make(client, SIDE_LARGE, &grid), 0);
    uint64_t before = test_stat(client, "shm_bytes_now");

    assert_int_equal(test_grid_submit(&grid, NULL, &step), 0);
    assert_int_equal(pccd_wait(client, step, 60000, &answer), 0);
    assert_int_equal(answer.incomplete, PCCD_COMPLETE);
    assert_int_equal(answer.total, SIDE_LARGE * SIDE_LARGE);
    assert_int_equal(answer.count, answer.total);
    pccd_answer_release(client, &answer);
    uint64_t told = test_stat(client, "shm_bytes_now");

    assert_true(told > before + (1u << 20));
    assert_int_equal(told, bytes_of_kernel());
    test_grid_free(&grid);
    pccd_close(client);
    client = connect_by_default(daemon.url);
    assert_int_equal(test_stat_await(client, "shm_bytes_now", 0), 0);
    pccd_close(client);
    assert_true(test_daemon_finish(&daemon));
}

/* If it failed, a user's quota would lose records, or end the daemon, where the region is
 * larger than what the user may take: the answer comes in pages then. */
static void region__is_as_large_as_the_quota_allows(void **state)
{
    static const char *const options[] = {"--shm-max-mib", "72", NULL};
    struct test_daemon daemon;
    struct test_grid other;
    struct test_grid grid;
    struct pccd_answer answer;
    struct pccd_options hoard;
    struct pccd_client *hoarder = NULL;
    uint64_t step = 0;
    uint64_t records = 0;
    uint32_t pages = 0;

    (void)state;
    assert_true(test_daemon_start(&daemon, options));
    memset(&hoard, 0, sizeof(hoard));
    hoard.url = daemon.url;
    hoard.slot_count = 1;
    hoard.slot_bytes = 64u << 20;
    hoard.result_bytes = 1u << 20;
    assert_int_equal(pccd_connect(&hoard, &hoarder), 0);
    assert_int_equal(test_grid_make(hoarder, SIDE_SMALL, &other), 0);
    struct pccd_client *client = connect_by_default(daemon.url);

    assert_int_equal(test_grid_make(client, SIDE_LARGE, &grid), 0);
    assert_int_equal(test_grid_submit(&grid, NULL, &step), 0);
    assert_int_equal(pccd_wait(client, step, 60000, &answer), 0);
    records = answer.count;
    pages = 1;
    while (answer.incomplete == PCCD_INCOMPLETE_RESULT_FULL) {
        uint64_t cursor = answer.cursor;

        assert_true(answer.count > 0);
        pccd_answer_release(client, &answer);
        assert_int_equal(pccd_fetch(client, grid.scene, step, cursor, &answer), 0);
        records += answer.count;
        pages++;
    }
    assert_int_equal(answer.incomplete, PCCD_COMPLETE);
    assert_int_equal(records, answer.total);
    print_message("# %llu records in %u pages\n", (unsigned long long)records, pages);
    assert_true(pages > 1);
    pccd_answer_release(client, &answer);
    assert_true(test_stat(client, "shm_bytes_now") <= 72u << 20);
    turn(&other);
    test_grid_free(&grid);
    test_grid_free(&other);
    pccd_close(client);
    pccd_close(hoarder);
    assert_true(test_daemon_finish(&daemon));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(clients__with_small_scenes_take_little),
        cmocka_unit_test(region__takes_what_an_answer_needs),
        cmocka_unit_test(region__is_as_large_as_the_quota_allows),
    };
    return cmocka_run_group_tests_name("int_taken", tests, NULL, NULL);
}
