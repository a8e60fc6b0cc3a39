/* witness.c - an honest client that watches while another one misbehaves. */
#include "witness.h"

#include <dirent.h>
#include <stdio.h>

#include "cases.h"
#include "prng.h"

#define SOUP      1000 /* triangles of the long step */
#define PROMPT_MS 5000
#define FDS_MAX   4096

struct test_witness test_witness;

int test_witness_start(void **state)
{
    static const char *const options[] = {"--scenes-max", "64", NULL};
    struct pccd_client *client;

    (void)state;
    if (test_is_direct()) {
        test_daemon_direct(&test_witness.daemon, NULL);
    } else if (!test_daemon_start(&test_witness.daemon, options)) {
        return -1;
    }
    client = test_connect_slim(test_witness.daemon.url);
    return client != NULL && test_crossing_make(client, &test_witness.crossing) == 0 ? 0
                                                                                     : -1;
}

int test_witness_stop(void **state)
{
    (void)state;
    pccd_close(test_witness.crossing.client);
    return test_is_direct() || test_daemon_finish(&test_witness.daemon) ? 0 : -1;
}

void test_witness_turn(void)
{
    uint64_t begin_ms = test_now_ms();

    assert_true(test_crossing_turn(&test_witness.crossing));
    assert_true(test_now_ms() - begin_ms < PROMPT_MS);
}

void test_witness_open_raw(struct test_raw *raw, uint64_t slot_bytes)
{
    assert_ok(test_raw_session(raw, test_witness.daemon.socket, 2, slot_bytes));
}

uint32_t test_witness_long_step(struct test_raw *raw)
{
    static float x[3 * SOUP][3];
    static uint32_t triangles[SOUP][3];
    struct prng prng = {SOUP};
    uint32_t scene, mesh, object, id;

    for (uint32_t i = 0; i < 3 * SOUP; i++) {
        x[i][0] = (float)prng_between(&prng, 0.0, 1.0);
        x[i][1] = (float)prng_between(&prng, 0.0, 1.0);
        triangles[i / 3][i % 3] = i;
    }
    assert_ok(
        test_raw_mesh(raw, x, 3 * SOUP, (const uint32_t(*)[3])triangles, SOUP, &mesh));
    assert_ok(test_raw_scene(raw, "", &scene));
    assert_ok(test_raw_add(raw, scene, mesh, &object));
    id = RAW_SEND(raw, FRAME_SUBMIT, .scene = scene);
    assert_int_not_equal(id, 0);
    return id;
}

int test_witness_fd_count(void)
{
    char path[64];
    DIR *entries;
    int count = 0;

    (void)snprintf(path, sizeof path, "/proc/%ld/fd", (long)test_witness.daemon.pid);
    entries = opendir(path);
    assert_non_null(entries);
    while (count < FDS_MAX && readdir(entries) != NULL) {
        count++;
    }
    (void)closedir(entries);
    return count;
}
