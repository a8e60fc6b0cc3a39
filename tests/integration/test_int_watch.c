/* test_int_watch.c - watching a real daemon work: its threads' records and its trace.
 *
 * Room:     tests/integration. May include: proto, pccd.h, tests/support.
 * Does:     what is recorded agrees with the answer, and nobody sees more than he may.
 * Threads:  one.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmocka.h>

#include "fixture.h"
#include "grid.h"
#include "pccd.h"
#include "raw.h"

#define SIDE    40u /* of a grid that a step shares among threads */
#define THREADS 3u
#define NOBODY  65534

static int start(void **state)
{
    static const char *const options[] = {"--threads", "3", NULL};

    (void)state;
    return test_daemon_start(&test_shared, options) ? 0 : -1;
}

static struct test_grid grid;

static void open_grid(void)
{
    struct pccd_client *client = test_connect(test_shared.url);

    assert_non_null(client);
    assert_int_equal(test_grid_make(client, SIDE, &grid), 0);
}

static void close_grid(void)
{
    pccd_close(grid.client);
    test_grid_free(&grid);
}

/* A turn of the grid by so many threads; *answer has no records any more. */
static void turn(uint32_t threads, struct pccd_answer *answer)
{
    const struct pccd_step_settings settings = {.threads = threads};
    uint64_t step = 0;

    assert_int_equal(test_grid_submit(&grid, &settings, &step), 0);
    assert_int_equal(pccd_wait(grid.client, step, -1, answer), 0);
    assert_true(test_grid_is_right(&grid, answer));
    assert_int_equal(answer->threads, threads);
    pccd_answer_release(grid.client, answer);
}

/* ---- records of threads ------------------------------------------------------------ */

/* What is looked for, and its sum over the threads that were asked for. */
struct sums {
    uint64_t threads, number, task_units, box_tests, tests, ns_step, low_ns;
};

static void add(void *context, const char *name, uint64_t value, const char *text)
{
    struct sums *sums = context;

    assert_true(text[0] != '\0');
#define ADD(field)                                                                       \
    if (strcmp(name, #field) == 0) {                                                     \
        sums->field += value;                                                            \
    }
    ADD(threads)
    ADD(number) ADD(task_units) ADD(box_tests) ADD(tests) ADD(ns_step) ADD(low_ns)
#undef ADD
}

/* If it failed, the records would tell of other work than the step's. */
static void threads__records_add_up_to_the_answer(void **state)
{
    struct pccd_answer answer;
    uint64_t number = 0;

    (void)state;
    open_grid();
    for (uint32_t threads = THREADS; threads >= 1; threads--) {
        struct sums sums = {.threads = 0};

        turn(threads, &answer);
        for (uint32_t i = 0; i < threads; i++) {
            assert_int_equal(pccd_stats_thread(grid.client, i % 2 == 1, i, add, &sums),
                             0);
        }
        assert_int_equal(sums.threads, threads * threads);
        assert_int_equal(sums.number % threads, 0);
        assert_true(sums.number / threads > number);
        number = sums.number / threads;
        assert_int_equal(sums.task_units, answer.counters.task_units);
        assert_int_equal(sums.box_tests, answer.counters.box_tests);
        assert_true(sums.task_units > 0);
        assert_true(sums.ns_step >= answer.times.low * threads);
        assert_true(sums.low_ns > 0);
        assert_int_equal(pccd_stats_thread(grid.client, false, threads, add, &sums),
                         PCCD_E_INVAL);
        assert_int_equal(pccd_stats_thread(grid.client, true, UINT32_MAX, add, &sums),
                         PCCD_E_INVAL);
    }
    close_grid();
}

/* If it failed, a client would be shown somebody else's step for its own, or a record of
 * a step that never was. */
static void threads__records_are_of_the_session_that_asks(void **state)
{
    struct pccd_client *stranger = test_connect(test_shared.url);
    struct pccd_answer answer;
    struct sums own = {.threads = 0};
    struct sums others = {.threads = 0};

    (void)state;
    assert_non_null(stranger);
    open_grid();
    turn(2, &answer);
    assert_int_equal(pccd_stats_thread(stranger, false, 0, add, &own), 0);
    assert_int_equal(own.threads, 0);
    assert_int_equal(own.number, 0);
    assert_int_equal(own.ns_step, 0);
    assert_int_equal(pccd_stats_thread(stranger, false, 1, add, &own), PCCD_E_INVAL);
    assert_int_equal(pccd_stats_thread(stranger, true, 0, add, &others), 0);
    assert_int_equal(others.threads, 2); /* the daemon's user may see it */
    assert_int_equal(pccd_stats_thread(NULL, false, 0, add, &own), PCCD_E_INVAL);
    assert_int_equal(pccd_stats_thread(stranger, false, 0, NULL, &own), PCCD_E_INVAL);
    /* It outlives the session that made it. */
    close_grid();
    others.threads = 0;
    assert_int_equal(pccd_stats_thread(stranger, true, 1, add, &others), 0);
    assert_int_equal(others.threads, 2);
    pccd_close(stranger);
}

/* ---- other users ------------------------------------------------------------------- */

/* In a child of another user: the exit status is 0 when the daemon refuses. */
static int ask_as_nobody(void)
{
    static struct test_raw raw;
    struct proto_STATS_THREAD_request any = {.thread = 0, .any = true};
    struct proto_STATS_THREAD_request own = {.thread = 0, .any = false};
    int rc = 0;

    if (setgid(NOBODY) != 0 || setuid(NOBODY) != 0 ||
        !test_raw_open(&raw, test_shared.socket) || test_raw_hello(&raw) != 0) {
        return 1;
    }
    if (test_raw_call(&raw, PROTO_METHOD_STATS_THREAD, &any, NULL) != PCCD_E_ACCESS) {
        rc |= 2;
    }
    if (test_raw_call(&raw, PROTO_METHOD_STATS_THREAD, &own, NULL) != 0) {
        rc |= 4;
    }
    test_raw_close(&raw);
    return rc;
}

/* If it failed, a user could watch what another one computes. */
static void watch__other_users_are_refused(void **state)
{
    struct pccd_answer answer;
    int status = 0;
    pid_t child;

    (void)state;
    if (geteuid() != 0) {
        skip(); /* nobody else to be */
    }
    open_grid();
    turn(2, &answer);
    assert_int_equal(chmod(test_shared.directory, 0755), 0);
    assert_int_equal(chmod(test_shared.socket, 0666), 0);
    child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        _exit(ask_as_nobody());
    }
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFEXITED(status));
    assert_int_equal(WEXITSTATUS(status), 0);
    assert_int_equal(chmod(test_shared.directory, 0700), 0);
    assert_int_equal(chmod(test_shared.socket, 0600), 0);
    close_grid();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(threads__records_add_up_to_the_answer),
        cmocka_unit_test(threads__records_are_of_the_session_that_asks),
        cmocka_unit_test(watch__other_users_are_refused),
    };

    return cmocka_run_group_tests_name("watch", tests, start, test_shared_stop);
}
