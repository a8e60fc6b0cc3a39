/* fixture.c - one daemon for all tests of a program, one client for each. */
#include "fixture.h"

#include <stdlib.h>

struct test_daemon test_shared;

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
