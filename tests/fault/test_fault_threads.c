/* test_fault_threads.c - a daemon that the system gives no thread. */
#include "cases.h"

#include <grp.h>
#include <signal.h>
#include <sys/resource.h>
#include <unistd.h>

#include "daemon.h"
#include "grid.h"
#include "must.h"

#define USER 61367u /* nobody's; the bound counts all threads of a user */
#define SIDE 60u    /* of a grid that a step shares among threads */

static bool is_alone; /* as that user */

/* Be the user from now on. */
static int change_user(void **state)
{
    (void)state;
    is_alone = geteuid() == 0 && setgroups(0, NULL) == 0 && setgid(USER) == 0 &&
               setuid(USER) == 0 && access(getenv("PCCDD"), X_OK) == 0;
    return 0;
}

static void bound(pid_t pid, rlim_t most)
{
    struct rlimit limit;
    assert_int_equal(prlimit(pid, RLIMIT_NPROC, NULL, &limit), 0);
    limit.rlim_cur = most < limit.rlim_max ? most : limit.rlim_max;
    assert_int_equal(prlimit(pid, RLIMIT_NPROC, &limit, NULL), 0);
}

/* A step with so many threads. Returns how many it had; 0: no or a wrong answer. */
static uint32_t step(struct test_grid *grid, uint32_t threads)
{
    struct pccd_step_settings settings = {
        .struct_bytes = sizeof(struct pccd_step_settings), .threads = threads};
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    uint64_t number = 0;
    uint32_t had = 0;
    if (test_grid_submit(grid, &settings, &number) == 0 &&
        pccd_wait(grid->client, number, 60000, &answer) == 0) {
        had = test_grid_is_right(grid, &answer) ? answer.threads : 0;
        pccd_answer_release(grid->client, &answer);
    }
    return had;
}

/* If it failed, a daemon in a container with few threads would die at its start, again
 * and again, where it could serve with those it gets. */
CASE(threads__that_are_granted_are_enough)
{
    static const char *const options[] = {"--threads", "8", NULL};
    struct test_daemon daemon;
    struct test_grid grid;
    if (!is_alone || TEST_HAS_FOREIGN_THREAD) {
        test_skip("only root can become another user, and a sanitizer has a thread");
    }
    bound(0, 2 + 6); /* this one, the daemon, and six more: its guard may be one */
    assert_true(test_daemon_start(&daemon, options));
    bound(0, RLIM_INFINITY);
    struct pccd_client *client = test_client_at(daemon.url);
    assert_true(test_daemon_logged(&daemon, " threads instead of 8: "));
    assert_ok(test_grid_make(client, SIDE, &grid));
    assert_in_range(step(&grid, 8), 3, 4);
    pccd_close(client);
    test_grid_free(&grid);
    assert_true(test_daemon_finish(&daemon));
}

/* If it failed, a moment without a thread or memory for OpenMP's runtime, which ends the
 * process then, would be an error to clients, or nobody would know what has happened. */
CASE(threads__that_are_refused_cost_a_restart)
{
    static const char *const options[] = {"--supervise", "--threads", "4", NULL};
    struct test_daemon daemon;
    struct test_grid grid;
    if (!is_alone) {
        test_skip("only root can become another user");
    }
    assert_true(test_daemon_start(&daemon, options));
    struct pccd_client *client = test_client_at(daemon.url);
    assert_ok(test_grid_make(client, SIDE, &grid));
    assert_int_equal(step(&grid, 4), 4);
    assert_int_equal(step(&grid, 2), 2); /* two threads of the team may go */
    pid_t worker = (pid_t)pccd_daemon_pid(client);
    bound(worker, 1);
    assert_int_equal(step(&grid, 4), 4);
    if ((pid_t)pccd_daemon_pid(client) != worker) { /* the runtime had let them go */
        assert_true(test_daemon_logged(&daemon, "frame.submit of session"));
        assert_true(test_daemon_logged(&daemon, "worker "));
    } else {
        print_message("# the runtime keeps the threads of a team that shrinks\n");
        bound(worker, RLIM_INFINITY); /* a sanitizer has a thread of its own at the end */
    }
    pccd_close(client);
    test_grid_free(&grid);
    assert_true(test_daemon_finish(&daemon));
}

CASES_WITH(change_user, NULL);
