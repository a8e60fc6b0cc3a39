/* fixture.h - starts one daemon for all tests of a program, and one client for each
 * test. */
#ifndef TEST_FIXTURE_H
#define TEST_FIXTURE_H

#include "cases.h"
#include "crossing.h"
#include "daemon.h"

extern struct test_daemon test_shared;

/* Start and stop the daemon of a group; none where test_is_direct. */
int test_shared_start(void **state);
int test_shared_start_with(const char *const *options);
int test_shared_stop(void **state);

/* Start it, and connect a client that waits for a minute, with a result region of so many
 * bytes. Returns 0 or -1. */
int test_shared_connect(void **state, uint64_t result_bytes, struct pccd_client **client);

/* For all cases of the program: that daemon, with these options. */
#define CASES_WITH_DAEMON(...)                                                           \
    static int start_shared(void **state)                                                \
    {                                                                                    \
        (void)state;                                                                     \
        return test_shared_start_with((const char *const[]){__VA_ARGS__, NULL});         \
    }                                                                                    \
    CASES_WITH(start_shared, test_shared_stop)

/* A case with a daemon of its own, with these options; NULL: none. The case fails unless
 * it ends with 0 when it is told to. */
extern struct test_daemon test_own;
int test_own_start(const char *const *options);
int test_own_stop(void **state);
#define CASE_DAEMON(name, ...)                                                           \
    static int start_##name(void **state)                                                \
    {                                                                                    \
        (void)state;                                                                     \
        return test_own_start((const char *const[]){__VA_ARGS__, NULL});                 \
    }                                                                                    \
    CASE_WITH(name, start_##name, test_own_stop)

/* A client of that daemon as TEST_OTHER_USER; only root can. */
#define TEST_OTHER_USER 65534
struct pccd_client *test_connect_as_other(void);

/* Make a scene that is shared, or take part in it. Returns a status. */
int test_take_part(struct pccd_client *client, const char *name, enum pccd_share share,
                   uint32_t rights, uint32_t *scene);

/* Open a client of that daemon for a test, and the smallest scene of its own; *state is a
 * struct test_crossing. */
int test_crossing_open(void **state);
int test_crossing_close(void **state);
#define CASE_CROSSING(name) CASE_WITH(name, test_crossing_open, test_crossing_close)

#endif
