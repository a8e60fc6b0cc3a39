/* fixture.c - one daemon for all tests of a program, one client for each. */
#include "fixture.h"

#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

struct test_daemon test_shared;
struct test_daemon test_own;

int test_shared_start_with(const char *const *options)
{
    if (test_is_direct()) {
        test_daemon_direct(&test_shared, options);
        return 0;
    }
    return test_daemon_start(&test_shared, options) ? 0 : -1;
}

int test_shared_start(void **state)
{
    (void)state;
    return test_shared_start_with(NULL);
}

int test_shared_stop(void **state)
{
    (void)state;
    return test_is_direct() || test_daemon_finish(&test_shared) ? 0 : -1;
}

int test_own_start(const char *const *options)
{
    return test_daemon_start(&test_own, options) ? 0 : -1;
}

int test_own_stop(void **state)
{
    (void)state;
    return test_daemon_finish(&test_own) ? 0 : -1;
}

int test_shared_connect(void **state, uint64_t result_bytes, struct pccd_client **client)
{
    struct pccd_options options;

    if (test_shared_start(state) != 0) {
        return -1;
    }
    pccd_options_init(&options);
    options.url = test_shared.url;
    options.timeout_ms = 60000;
    options.result_bytes = result_bytes;
    return pccd_connect(&options, client) == 0 ? 0 : -1;
}

struct pccd_client *test_connect_as_other(void)
{
    assert_int_equal(chmod(test_shared.directory, 0755), 0);
    assert_int_equal(chmod(test_shared.socket, 0666), 0);
    assert_int_equal(seteuid(TEST_OTHER_USER), 0);
    struct pccd_client *client = test_connect(test_shared.url);
    assert_int_equal(seteuid(0), 0);
    assert_int_equal(chmod(test_shared.directory, 0700), 0);
    assert_int_equal(chmod(test_shared.socket, 0600), 0);
    return client;
}

int test_take_part(struct pccd_client *client, const char *name, enum pccd_share share,
                   uint32_t rights, uint32_t *scene)
{
    struct pccd_scene_settings settings = {
        .name = name, .share = share, .rights = rights};

    return pccd_scene_create(client, &settings, scene);
}

int test_crossing_open(void **state)
{
    struct test_crossing *crossing = calloc(1, sizeof *crossing);
    struct pccd_client *client = test_connect(test_shared.url);

    *state = crossing;
    return crossing != NULL && client != NULL && test_crossing_make(client, crossing) == 0
               ? 0
               : -1;
}

int test_crossing_close(void **state)
{
    struct test_crossing *crossing = *state;

    pccd_close(crossing->client);
    free(crossing);
    return 0;
}
